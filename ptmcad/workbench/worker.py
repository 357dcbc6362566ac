"""A worker process: it has one task, and computes jobs of it one after another.

Guarantee: it ends with the process that has started it, in whatever way that ends. Its death is
noticed by whoever reads its answers. An error that is no answer about a job is answered by its
text, and ends the process: nothing of its state is trusted afterwards.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections import deque
from collections.abc import Callable
from multiprocessing.connection import Connection
from time import monotonic
from typing import Any

from ptmcad.errors import OutputError, shown
from ptmcad.process.handover import end_with

_PROGRAM = (
    "import sys; sys.path[:] = sys.argv[4:]; "
    "from ptmcad.workbench.worker import main; main(sys.argv[1:4])"
)
CANCEL = "cancel"
"""In place of a job: the one of that number is no longer wanted."""


class Cancelled(Exception):
    """The job at hand is no longer wanted."""


Task = Callable[[Any, Callable[[], None]], Any]
"""What becomes of a job, in the process that computes it: a function that is sent there. Its second
argument raises `Cancelled` when the job is no longer wanted, where jobs come one by one."""


class Worker:
    """A process with its task.

    Attributes
    ----------
    numbers : the jobs that it has, of which it computes the first.
    since : when that was begun, as far as is known.

    Raises
    ------
    OutputError
        When the system does not allow another process.
    """

    def __init__(self, task: Task) -> None:
        ours, theirs = socket.socketpair()
        read, self._lifeline = os.pipe()
        ends = map(str, (theirs.fileno(), read, os.getpid()))
        try:
            self.process = subprocess.Popen(
                # with this path it finds what this process finds
                [sys.executable, "-P", "-c", _PROGRAM, *ends, *sys.path],
                pass_fds=(theirs.fileno(), read),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        except OSError as error:
            os.close(self._lifeline)
            ours.close()
            raise OutputError(f"no worker process can be started: {error.strerror}") from error
        finally:
            theirs.close()
            os.close(read)
        self.connection = Connection(ours.detach())
        self.numbers: list[int] = []
        self.since = monotonic()
        self._send(task)

    def ask(self, number: int, job: Any) -> None:
        """Have a job computed, after those that it has."""
        if not self.numbers:
            self.since = monotonic()
        self.numbers.append(number)
        self._send((number, job))

    def cancel(self, number: int) -> None:
        """Have a job given up, if it is the one at hand."""
        self._send((number, CANCEL))

    def _send(self, what: object) -> None:
        try:
            self.connection.send(what)
        except OSError:  # it has died: reading its answer says so
            return

    def answer(self) -> tuple[int, Any, str]:
        """The next answer, waited for: a job's number and what the task returned, or the text of an
        error that has ended the process.

        Raises
        ------
        EOFError, OSError
            When the process has died.
        """
        number, outcome, error = self.connection.recv()
        self.numbers.remove(number)
        self.since = monotonic()
        return number, outcome, error

    def bury(self) -> int:
        """Close what belongs to a process that has ended or is to end, and return its exit status."""
        self.connection.close()
        os.close(self._lifeline)
        return self.process.wait()


def _serve(connection: Connection) -> None:
    task, current, later = connection.recv(), -1, deque[tuple[int, Any]]()

    def check() -> None:
        while connection.poll():
            message = connection.recv()
            if message == (current, CANCEL):
                raise Cancelled
            later.append(message)

    while True:
        current, job = later.popleft() if later else connection.recv()
        if job == CANCEL:
            continue  # it came too late: the job is done
        try:
            outcome = task(job, check)
        except BaseException as error:  # raised again, and ends this process
            connection.send((current, None, shown(f"{type(error).__name__}: {error}")))
            raise
        connection.send((current, outcome, ""))


def main(arguments: list[str]) -> None:
    """Be a worker; Ctrl-C is the other process's, which ends this one.

    Parameters
    ----------
    arguments : the descriptors of the connection and of the lifeline, and the other process's
        number.
    """
    connection, lifeline, parent = map(int, arguments)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with(lifeline, parent)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ["MPLBACKEND"], os.environ["MATPLOTLIBRC"] = "agg", os.devnull
    try:
        _serve(Connection(connection))
    except EOFError:  # there are no more jobs
        return
