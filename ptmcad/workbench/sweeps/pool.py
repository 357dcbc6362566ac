"""This machine's worker processes: each computes one member after another in one interpreter, and
may die.

A pool of the standard library does not say which task a worker has died of: all that are under way
fail together, and a member that is innocent would be blamed. Here each worker has a connection of
its own, so that its death is the failure of the one member that it had.

Guarantee: a worker that dies is replaced; when this process ends, in whatever way, its workers end
too. A worker is started when there is a member for it.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import wait
from time import monotonic
from typing import TYPE_CHECKING, Any

from ptmcad.workbench.sweeps.member import Failed, out_of_time
from ptmcad.workbench.worker import Task, Worker

if TYPE_CHECKING:
    from ptmcad.workbench.sweeps.cluster import Cluster

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
