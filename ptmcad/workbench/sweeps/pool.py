"""This machine's worker processes: each computes one member after another in one interpreter, and
may die.

A pool of the standard library does not say which task a worker has died of: all that are under way
fail together, and a member that is innocent would be blamed. Here each worker has a connection of
its own, so that its death is the failure of the one member that it had.

Guarantee: a worker that dies is replaced; when this process ends, in whatever way, its workers end
too. A worker is started when there is a member for it.

The workers of a Dask scheduler, on this machine or on others.

Guarantee: members go to the scheduler a few more at a time than there are threads to compute them.
A worker that dies costs what it was computing: Dask gives it to another one, and what kills several
workers is that member's failure. The results come back through the scheduler, so that the workers
need no file system in common with this process.
"""

from __future__ import annotations

import logging
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import wait
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any

from ptmcad.errors import ConfigError, OutputError, shown
from ptmcad.extras import require
from ptmcad.workbench.sweeps.member import Failed, out_of_time
from ptmcad.workbench.worker import Task, Worker

_OVERRUN = 1.0
"""Seconds by which a member may overrun its time limit before its process is killed; it looks at
the clock itself.
"""
_AHEAD = 1
"""Members that a worker has besides the one that it computes, so that it need not wait for this
process.
"""


Answer = tuple[int, Any]
"""A member's number and what became of it: what the task returned, or a `Failed`."""


class Pool:
    """Worker processes on this machine.

    Parameters
    ----------
    jobs : how many there are.
    timeout : seconds that a member may take.
    """

    def __init__(self, task: Task, jobs: int, timeout: float | None = None) -> None:
        self.task, self.jobs, self.timeout = task, jobs, timeout
        self._workers: list[Worker] = []
        self._done: list[Answer] = []

    @property
    def room(self) -> bool:
        """Whether one more member is wanted now."""
        return len(self._workers) < self.jobs or any(
            len(w.numbers) <= _AHEAD for w in self._workers
        )

    @property
    def busy(self) -> bool:
        """Whether there are members of which nothing has been returned yet."""
        return bool(self._done) or any(worker.numbers for worker in self._workers)

    def submit(self, number: int) -> None:
        """Have a member computed."""
        least = min(self._workers, key=lambda worker: len(worker.numbers), default=None)
        if least is None or (least.numbers and len(self._workers) < self.jobs):
            least = Worker(self.task)
            self._workers.append(least)
        least.ask(number, number)

    def answers(self, seconds: float | None) -> Sequence[Answer]:
        """What has been answered; waits for an answer, for so many seconds at most."""
        busy = {worker.connection: worker for worker in self._workers if worker.numbers}
        if not self._done and busy:
            for connection in wait(list(busy), self._patience(seconds)):
                self._read(busy[connection])  # type: ignore[index]
        self._kill_late()
        answered, self._done = self._done, []
        return answered

    def close(self) -> None:
        """End at once; what is not answered is lost."""
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            worker.bury()
        self._workers = []

    def _read(self, worker: Worker) -> None:
        """Take an answer, or note that the worker has died."""
        try:
            number, outcome, error = worker.answer()
        except (EOFError, OSError):
            self._died(worker, None)
            return
        self._done.append((number, Failed(error) if error else outcome))
        if error:
            self._ended(worker)

    def _died(self, worker: Worker, why: str | None) -> None:
        """The first of a worker's members has failed; the others were not begun."""
        first = worker.numbers.pop(0)
        status = self._ended(worker)
        self._done.append((first, Failed(why or _how_ended(status))))

    def _ended(self, worker: Worker) -> int:
        """Do without a worker; others get its members. Its exit status."""
        self._workers.remove(worker)
        status = worker.bury()
        for number in worker.numbers:
            self.submit(number)
        return status

    def _patience(self, seconds: float | None) -> float | None:
        """How long to wait for an answer: until a member is late."""
        if self.timeout is None:
            return seconds
        first = min(worker.since for worker in self._workers if worker.numbers)
        late = max(0.0, first + self.timeout + _OVERRUN - monotonic())
        return late if seconds is None else min(seconds, late)

    def _kill_late(self) -> None:
        """End workers whose member has overrun its limit in code that does not look at the clock."""
        limit = self.timeout
        if limit is None:
            return
        for worker in list(self._workers):
            if worker.numbers and monotonic() > worker.since + limit + _OVERRUN:
                worker.process.kill()
                self._died(worker, out_of_time(limit))


def _how_ended(status: int) -> str:
    if status >= 0:
        return f"its process ended by itself with status {status}"
    try:
        name = signal.Signals(-status).name
    except ValueError:
        name = f"signal {-status}"
    return f"its process was ended by {name}"


def answers_of(
    workers: Pool | Cluster,
    following: Callable[[], int | None],
    patience: Callable[[], float | None],
) -> Iterator[Answer]:
    """The answers of all members, in any order.

    Parameters
    ----------
    following : the number of another member to compute, None while there is none.
    patience : seconds to wait for an answer.
    """
    while True:
        while workers.room and (number := following()) is not None:
            workers.submit(number)
        if not workers.busy:
            return
        yield from workers.answers(patience())


CONNECT_SECONDS = 15
_LOOK_SECONDS = 2.0
"""Between two looks at the scheduler: whether it is there, and how many threads its workers have.
"""
_TASKS_EACH = 2
"""Members for each thread: one that is computed and one that waits at the worker."""


class Cluster:
    """A Dask cluster by its scheduler's address.

    Raises
    ------
    ConfigError
        When distributed is not installed, or no scheduler answers at the address.
    """

    def __init__(self, compute: Callable[[int], Any], address: str) -> None:
        require("distributed", key="--scheduler")
        import distributed

        client: Any = distributed.Client
        self.compute, self.address = compute, address
        try:
            self.client: Any = client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = shown(" ".join(str(error).split()), 200)
            raise ConfigError(
                f"no Dask scheduler answers at {address}: {reason}", key="--scheduler"
            ) from error
        # what it says of a scheduler that is gone is said by this program, once, as an error
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
        self._answers: SimpleQueue[tuple[int, Any]] = SimpleQueue()
        self._under_way: dict[int, Any] = {}
        self._threads = 0
        self._looked = -_LOOK_SECONDS

    @property
    def room(self) -> bool:
        if monotonic() >= self._looked + _LOOK_SECONDS:
            self._looked = monotonic()
            try:
                self._threads = sum(self.client.nthreads().values())
            except (OSError, TimeoutError) as error:
                raise self._gone() from error
        return len(self._under_way) < _TASKS_EACH * max(self._threads, 1)

    @property
    def busy(self) -> bool:
        return bool(self._under_way)

    def submit(self, number: int) -> None:
        future = self._under_way[number] = self.client.submit(self.compute, number, pure=False)
        future.add_done_callback(lambda done: self._answers.put((number, done)))

    def answers(self, seconds: float | None) -> Sequence[Answer]:
        found: list[Answer] = []
        patience = _LOOK_SECONDS if seconds is None else min(seconds, _LOOK_SECONDS)
        try:
            while True:
                number, done = self._answers.get(timeout=0 if found else patience)
                del self._under_way[number]  # its copy on the cluster is given up
                outcome = done.result() if done.status == "finished" else Failed(_why(done))
                found.append((number, outcome))
        except Empty:
            if self.client.status not in ("running", "connecting"):
                raise self._gone() from None
            return found

    def _gone(self) -> OutputError:
        return OutputError(f"the scheduler at {self.address} is gone")

    def close(self) -> None:
        with suppress(OSError, TimeoutError):  # it may be gone already
            self.client.cancel(list(self._under_way.values()))
            self.client.close(timeout=2)


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
