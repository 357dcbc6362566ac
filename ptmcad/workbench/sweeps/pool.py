"""This machine's worker processes: each computes one member after another in one interpreter, and
may die.

A pool of the standard library does not say which task a worker has died of: all that are under way
fail together, and a member that is innocent would be blamed. Here each worker has a connection of
its own, so that its death is the failure of the one member that it had.

Guarantee: a worker that dies is replaced; when this process ends, in whatever way, its workers end
too. A worker is started when there is a member for it.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from time import monotonic

from ptmcad.errors import OutputError
from ptmcad.workbench.sweeps.member import Failed, out_of_time
from ptmcad.workbench.sweeps.tasks import Answer, Task

_OVERRUN = 1.0
"""Seconds by which a member may overrun its time limit before its process is killed; it looks at
the clock itself.
"""
_PROGRAM = (
    "import sys; sys.path[:] = sys.argv[4:]; "
    "from ptmcad.workbench.sweeps.sweepworker import main; main(sys.argv[1:4])"
)
_AHEAD = 1
"""Members that a worker has beside the one that it computes, so that it need not wait for this
process.
"""


@dataclass(slots=True)
class _Worker:
    """A worker process with the members that it has, the first being computed."""

    process: subprocess.Popen[bytes]
    connection: Connection
    lifeline: int
    numbers: list[int]
    since: float


class Pool:
    """Worker processes on this machine.

    Parameters
    ----------
    jobs : how many there are.
    """

    def __init__(self, work: Task, jobs: int) -> None:
        self.work = work
        self.jobs = jobs
        self._workers: list[_Worker] = []
        self._done: list[Answer] = []

    @property
    def room(self) -> bool:
        return len(self._workers) < self.jobs or any(
            len(w.numbers) <= _AHEAD for w in self._workers
        )

    @property
    def busy(self) -> bool:
        return bool(self._done) or any(worker.numbers for worker in self._workers)

    def submit(self, number: int) -> None:
        least = min(self._workers, key=lambda worker: len(worker.numbers), default=None)
        if least is None or (least.numbers and len(self._workers) < self.jobs):
            least = self._started()
        self._give(least, number)

    def answers(self, seconds: float | None) -> Sequence[Answer]:
        busy = {worker.connection: worker for worker in self._workers if worker.numbers}
        if not self._done and busy:
            for connection in wait(list(busy), self._patience(seconds)):
                self._read(busy[connection])  # type: ignore[index]
        self._kill_late()
        answered, self._done = self._done, []
        return answered

    def close(self) -> None:
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            _bury(worker)
        self._workers = []

    def _started(self) -> _Worker:
        """A new worker process, which has been told what the work is.

        Raises
        ------
        OutputError
            When the system does not allow another process.
        """
        ours, theirs = socket.socketpair()
        lifeline = os.pipe()
        ends = map(str, (theirs.fileno(), lifeline[0], os.getpid()))
        try:
            process = subprocess.Popen(
                [
                    sys.executable,
                    "-P",
                    "-c",
                    _PROGRAM,
                    *ends,
                    *sys.path,
                ],  # so that it finds what this process finds
                pass_fds=(theirs.fileno(), lifeline[0]),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        except OSError as error:
            os.close(lifeline[1])
            ours.close()
            raise OutputError(f"no worker process can be started: {error.strerror}") from error
        finally:
            theirs.close()
            os.close(lifeline[0])
        worker = _Worker(process, Connection(ours.detach()), lifeline[1], [], monotonic())
        self._workers.append(worker)
        self._send(worker, self.work)
        return worker

    def _give(self, worker: _Worker, number: int) -> None:
        if not worker.numbers:
            worker.since = monotonic()
        worker.numbers.append(number)
        self._send(worker, number)

    def _send(self, worker: _Worker, what: object) -> None:
        try:
            worker.connection.send(what)
        except OSError:  # it has died: reading its answer says so
            return

    def _read(self, worker: _Worker) -> None:
        """Take an answer, or note that the worker has died."""
        try:
            number, outcome, ending = worker.connection.recv()
        except (EOFError, OSError):
            self._died(worker, None)
            return
        worker.numbers.remove(number)
        worker.since = monotonic()
        self._done.append((number, outcome))
        if ending:
            self._ended(worker)

    def _died(self, worker: _Worker, why: str | None) -> None:
        """The first of a worker's members has failed; the others were not begun."""
        first = worker.numbers.pop(0)
        status = self._ended(worker)
        self._done.append((first, Failed(why or _how_ended(status))))

    def _ended(self, worker: _Worker) -> int:
        """Do without a worker; others get its members. Its exit status."""
        self._workers.remove(worker)
        status = _bury(worker)
        for number in worker.numbers:
            self.submit(number)
        return status

    def _patience(self, seconds: float | None) -> float | None:
        """How long to wait for an answer: until a member is late."""
        if self.work.timeout is None:
            return seconds
        first = min(worker.since for worker in self._workers if worker.numbers)
        late = max(0.0, first + self.work.timeout + _OVERRUN - monotonic())
        return late if seconds is None else min(seconds, late)

    def _kill_late(self) -> None:
        """End workers whose member has overrun its limit in code that does not look at the clock."""
        limit = self.work.timeout
        if limit is None:
            return
        for worker in list(self._workers):
            if worker.numbers and monotonic() > worker.since + limit + _OVERRUN:
                worker.process.kill()
                self._died(worker, out_of_time(limit))


def _bury(worker: _Worker) -> int:
    """Close what belongs to a worker that has ended or is to end, and return its exit status."""
    worker.connection.close()
    os.close(worker.lifeline)
    return worker.process.wait()


def _how_ended(status: int) -> str:
    if status >= 0:
        return f"its process ended by itself with status {status}"
    try:
        name = signal.Signals(-status).name
    except ValueError:
        name = f"signal {-status}"
    return f"its process was ended by {name}"
