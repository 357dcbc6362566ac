"""The workers of a Dask scheduler, on this machine or on others.

Guarantee: members go to the scheduler a few more at a time than there are threads to compute them. A worker that dies
costs what it was computing: Dask gives it to another one, and what kills several workers is that member's failure.

The results come back through the scheduler, so that the workers need no file system in common with this process.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any

from ptmcad.errors import ConfigError, OutputError, shown
from ptmcad.process.extras import require_distributed
from ptmcad.sweeping.member import Failed
from ptmcad.sweeping.tasks import Answer, Task

CONNECT_SECONDS = 15
_LOOK_SECONDS = 2.0
"""Between two looks at the scheduler: whether it is there, and how many threads its workers have."""
_AHEAD = 2
"""Members for each thread: one that is computed and one that waits at the worker."""


class Cluster:
    """A Dask cluster by its scheduler's address.

    Raises
    ------
    ConfigError
        When distributed is not installed, or no scheduler answers at the address.
    """

    def __init__(self, work: Task, address: str) -> None:
        require_distributed()
        import distributed

        client: Any = distributed.Client
        self.work, self.address = work, address
        try:
            self.client: Any = client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = shown(" ".join(str(error).split()), 200)
            raise ConfigError(f"no Dask scheduler answers at {address}: {reason}", key="--scheduler") from error
        self._answers: SimpleQueue[tuple[int, Any]] = SimpleQueue()
        self._under_way: dict[int, Any] = {}
        self._threads = 0
        self._looked = -_LOOK_SECONDS

    @property
    def room(self) -> bool:
        if monotonic() >= self._looked + _LOOK_SECONDS:
            self._looked = monotonic()
            self._threads = sum(self.client.nthreads().values())
        return len(self._under_way) < _AHEAD * max(self._threads, 1)

    @property
    def busy(self) -> bool:
        return bool(self._under_way)

    def submit(self, number: int) -> None:
        future = self.client.submit(_answer, self.work, number, pure=False)
        self._under_way[number] = future
        future.add_done_callback(lambda done: self._answers.put((number, done)))

    def answers(self, seconds: float | None) -> Sequence[Answer]:
        found: list[Answer] = []
        try:
            number, done = self._answers.get(timeout=_LOOK_SECONDS if seconds is None else min(seconds, _LOOK_SECONDS))
            found.append(self._taken(number, done))
            while True:
                number, done = self._answers.get_nowait()
                found.append(self._taken(number, done))
        except Empty:
            if self.client.status not in ("running", "connecting"):
                raise OutputError(
                    f"the scheduler at {self.address} is gone; the same command goes on once there is one again"
                ) from None
            return found

    def _taken(self, number: int, done: Any) -> Answer:
        """What has become of a member; its copy on the cluster is given up."""
        del self._under_way[number]
        if done.status == "finished":
            return number, done.result()
        if done.status == "error":
            error = done.exception()
            if type(error).__name__ == "KilledWorker":  # whose text names the task, which is another one in each run
                return number, Failed("its process ended on one worker of the cluster after another")
            return number, Failed(shown(f"{type(error).__name__}: {error}"))
        return number, Failed(f"the cluster gave it up ({done.status})")

    def close(self) -> None:
        with suppress(OSError, TimeoutError):  # it may be gone already
            self.client.cancel(list(self._under_way.values()))
            self.client.close(timeout=2)


def _answer(work: Task, number: int) -> Any:
    """What a worker of the cluster does."""
    return work.answer(number)
