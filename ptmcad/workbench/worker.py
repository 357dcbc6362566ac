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
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from threading import Lock
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


class WorkerLost(Exception):
    """A worker has ended without an answer, for the reason in the text."""


Task = Callable[[Any, Callable[[], None]], Any]
"""What becomes of a job, in the process that computes it: a function that is sent there. Its second
argument raises `Cancelled` when the job is no longer wanted.
"""


class _Process:
    """A process with its task, which has one job at a time.

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
        self.number = 0
        self.send(task)

    def send(self, what: object) -> None:
        """Send the task, or a job or `CANCEL` with its number."""
        with suppress(OSError):  # it has died: reading its answer says so
            self.connection.send(what)

    def bury(self) -> int:
        """End it, close what belongs to it, and return its exit status."""
        self.process.kill()
        self.connection.close()
        os.close(self._lifeline)
        return self.process.wait()


class Worker:
    """One process after another for a task: one that has ended is replaced.

    Several threads may use it, of which one at a time computes.
    """

    def __init__(self, task: Task) -> None:
        self._task, self._lock = task, Lock()
        self.current: _Process | None = None
        self._closed = False

    def open(self) -> _Process:
        """The process, another one where it has ended.

        Raises
        ------
        OutputError
            When there can be none.
        WorkerLost
            After `close`.
        """
        with self._lock:
            if self._closed:
                raise WorkerLost("it is closed")
            if self.current is not None and self.current.process.poll() is not None:
                self.current.bury()
                self.current = None
            if self.current is None:
                self.current = _Process(self._task)
            return self.current

    def compute(self, job: Any, seconds: float | None = None) -> Any:
        """What the task returns of a job.

        Raises
        ------
        WorkerLost
            When the process has died, or ended itself by an error.
        TimeoutError
            When there is no answer after so many seconds; the process is killed then.
        """
        found = self.open()
        found.number += 1
        found.send((found.number, job))
        try:
            if not found.connection.poll(seconds):
                raise TimeoutError(f"it took more than {seconds:g} s")
            outcome, error = found.connection.recv()
        except TimeoutError:
            self.end()
            raise
        except (EOFError, OSError) as lost:
            raise WorkerLost(_how_ended(self.end())) from lost
        if error:
            self.end()
            raise WorkerLost(error)
        return outcome

    def cancel(self) -> None:
        """Have the job at hand given up."""
        if (found := self.current) is not None:
            found.send((found.number, CANCEL))

    def end(self) -> int:
        """End the process, which has nothing to tidy up; its exit status."""
        with self._lock:
            found, self.current = self.current, None
        return 0 if found is None else found.bury()

    def close(self) -> None:
        """End it for good."""
        with self._lock:
            self._closed = True
        self.end()


def _how_ended(status: int) -> str:
    if status >= 0:
        return f"its process ended by itself with status {status}"
    try:
        name = signal.Signals(-status).name
    except ValueError:
        name = f"signal {-status}"
    return f"its process was ended by {name}"


def _serve(connection: Connection) -> None:
    task = connection.recv()

    def check() -> None:
        while connection.poll():
            if connection.recv() == (current, CANCEL):
                raise Cancelled

    while True:
        current, job = connection.recv()
        if job == CANCEL:
            continue  # it came too late: the job is done
        try:
            outcome = task(job, check)
        except BaseException as error:  # raised again, and ends this process
            connection.send((None, shown(f"{type(error).__name__}: {error}")))
            raise
        connection.send((outcome, ""))


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
