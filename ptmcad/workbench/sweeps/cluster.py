"""The workers of a Dask scheduler, on this machine or on others.

Guarantee: members go to the scheduler a few more at a time than there are threads to compute them.
A worker that dies costs what it was computing: Dask gives it to another one, and what kills several
workers is that member's failure.

Dask spends milliseconds on a task, whatever it is; so quick members are put together, and given
again one by one where something goes wrong with them. The results come back through the scheduler,
so that the workers need no file system in common with this process.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from contextlib import suppress
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any

from ptmcad.errors import ConfigError, OutputError, shown
from ptmcad.extras import Extra, require
from ptmcad.workbench.sweeps.member import Failed, Work, compute
from ptmcad.workbench.sweeps.pool import Answer

CONNECT_SECONDS = 15
_LOOK_SECONDS = 2.0
"""Between two looks at the scheduler: whether it is there, and how many threads its workers have.
"""
_AHEAD = 2
"""Tasks for each thread: one that is computed and one that waits at the worker."""
_TASK_SECONDS, _MAX_TOGETHER = 4.0, 64
"""What members that are put together take, and how many they are at most."""


class Cluster:
    """A Dask cluster by its scheduler's address.

    Raises
    ------
    ConfigError
        When distributed is not installed, or no scheduler answers at the address.
    """

    def __init__(self, work: Work, address: str) -> None:
        require(Extra.distributed, key="--scheduler")
        import distributed

        client: Any = distributed.Client
        self.work, self.address = work, address
        try:
            self.client: Any = client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = shown(" ".join(str(error).split()), 200)
            raise ConfigError(
                f"no Dask scheduler answers at {address}: {reason}", key="--scheduler"
            ) from error
        # what it says of a scheduler that is gone is said by this program, once, as an error
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
        self._answers: SimpleQueue[tuple[tuple[int, ...], Any]] = SimpleQueue()
        self._under_way: dict[tuple[int, ...], Any] = {}
        self._gathered: list[int] = []
        self._threads = 0
        self._looked = -_LOOK_SECONDS
        self._done, self._seconds = 0, 0.0

    @property
    def room(self) -> bool:
        if monotonic() >= self._looked + _LOOK_SECONDS:
            self._looked = monotonic()
            try:
                self._threads = sum(self.client.nthreads().values())
            except (OSError, TimeoutError) as error:
                raise self._gone() from error
        return len(self._under_way) < _AHEAD * max(self._threads, 1)

    @property
    def busy(self) -> bool:
        return bool(self._under_way or self._gathered)

    def submit(self, number: int) -> None:
        self._gathered.append(number)
        if len(self._gathered) >= self._together():
            self._send_gathered()

    def answers(self, seconds: float | None) -> Sequence[Answer]:
        self._send_gathered()
        found: list[Answer] = []
        try:
            numbers, done = self._answers.get(
                timeout=_LOOK_SECONDS if seconds is None else min(seconds, _LOOK_SECONDS)
            )
            found += self._taken(numbers, done)
            while True:
                numbers, done = self._answers.get_nowait()
                found += self._taken(numbers, done)
        except Empty:
            if self.client.status not in ("running", "connecting"):
                raise self._gone() from None
            return found

    def _gone(self) -> OutputError:
        return OutputError(f"the scheduler at {self.address} is gone")

    def _together(self) -> int:
        """How many members make a task: few at first, so that every thread has some."""
        if not self._seconds:
            return 1
        by_time = int(_TASK_SECONDS * self._done / self._seconds)
        return max(1, min(by_time, 1 + self._done // (8 * max(self._threads, 1)), _MAX_TOGETHER))

    def _send_gathered(self) -> None:
        if self._gathered:
            self._send(tuple(self._gathered))
            self._gathered = []

    def _send(self, numbers: tuple[int, ...]) -> None:
        future = self.client.submit(_answers, self.work, numbers, pure=False)
        self._under_way[numbers] = future
        future.add_done_callback(lambda done: self._answers.put((numbers, done)))

    def _taken(self, numbers: tuple[int, ...], done: Any) -> Sequence[Answer]:
        """What has become of members; their copy on the cluster is given up."""
        del self._under_way[numbers]
        if done.status == "finished":
            outcomes = done.result()
            self._done += len(numbers)
            self._seconds += sum(getattr(outcome, "seconds", 0.0) for outcome in outcomes)
            return list(zip(numbers, outcomes, strict=True))
        if len(numbers) > 1:  # one of them is to blame
            for number in numbers:
                self._send((number,))
            return ()
        return [(numbers[0], Failed(_why(done)))]

    def close(self) -> None:
        with suppress(OSError, TimeoutError):  # it may be gone already
            self.client.cancel(list(self._under_way.values()))
            self.client.close(timeout=2)


def _answers(work: Work, numbers: Sequence[int]) -> list[Any]:
    """What a worker of the cluster does."""
    return [compute(work, number) for number in numbers]


def _why(done: Any) -> str:
    """Why a task has failed, in words that are the same in each run."""
    if done.status != "error":
        return f"the cluster gave it up ({done.status})"
    error = done.exception()
    if (
        type(error).__name__ == "KilledWorker"
    ):  # whose text names the task, which is another one in each run
        return "its process ended on one worker of the cluster after another"
    return shown(f"{type(error).__name__}: {error}")
