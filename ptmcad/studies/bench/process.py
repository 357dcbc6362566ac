"""A process that is run once and measured.

Guarantee: the figures are the kernel's for that process and the descendants it waited for (`os.wait4`), so nothing that
the benchmark itself does is counted.

Not guaranteed: a peak below the benchmark's own size, because a forked child starts with its parent's pages counted.
The modules of this package therefore import nothing large.
"""

from __future__ import annotations

import os
import resource
import subprocess
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

_MESSAGE_LENGTH = 300


class Outcome(Enum):
    """How a process ended."""

    DONE = "done"
    FAILED = "failed"
    TIMED_OUT = "timed out"


@dataclass(frozen=True, slots=True)
class Usage:
    """What one run of a process cost.

    Attributes
    ----------
    seconds : wall time from before the fork to after the exit.
    processor_seconds : user and system time.
    peak_mebibytes : largest resident set.
    output : what it wrote to standard output.
    message : the end of what it wrote to standard error, empty when it was done.
    """

    outcome: Outcome
    seconds: float
    processor_seconds: float
    peak_mebibytes: float
    output: str = ""
    message: str = ""


def run(command: Sequence[str], *, text: str = "", timeout: float | None = None) -> Usage:
    """Run a command and measure it.

    Parameters
    ----------
    command : program and arguments.
    text : its standard input.
    timeout : seconds after which it is killed.

    Raises
    ------
    FileNotFoundError
        If there is no such program.

    Examples
    --------
    >>> import sys
    >>> usage = run([sys.executable, "-c", "print(input()[::-1])"], text="stressed")
    >>> usage.outcome, usage.output, usage.peak_mebibytes > 1
    (<Outcome.DONE: 'done'>, 'desserts\\n', True)
    """
    with tempfile.TemporaryFile() as given, tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        given.write(text.encode())
        given.seek(0)
        start = time.perf_counter()
        process = subprocess.Popen(command, stdin=given, stdout=output, stderr=errors)
        resources, expired = _awaited(process, timeout)
        seconds = time.perf_counter() - start
        outcome = Outcome.TIMED_OUT if expired else Outcome.FAILED
        if process.returncode == 0:
            outcome = Outcome.DONE
        output.seek(0)
        errors.seek(0)
        return Usage(
            outcome=outcome,
            seconds=seconds,
            processor_seconds=resources.ru_utime + resources.ru_stime,
            peak_mebibytes=resources.ru_maxrss / 1024,
            output=output.read().decode(errors="replace"),
            message=""
            if outcome is Outcome.DONE
            else errors.read().decode(errors="replace")[-_MESSAGE_LENGTH:].strip(),
        )


def _awaited(process: subprocess.Popen[bytes], timeout: float | None) -> tuple[resource.struct_rusage, bool]:
    """What the process took, and whether it was killed when its time was over; its exit status is set."""
    expired = threading.Event()

    def expire() -> None:
        expired.set()
        process.kill()

    timer = threading.Timer(timeout, expire) if timeout is not None else None
    if timer is not None:
        timer.daemon = True
        timer.start()
    try:
        _, status, resources = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    finally:
        if timer is not None:
            timer.cancel()
        if process.returncode is None:  # interrupted: the process must not outlive its measurement
            process.kill()
            process.wait()
    return resources, expired.is_set()
