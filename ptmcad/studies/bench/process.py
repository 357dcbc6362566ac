"""A process that is run once and measured.

Guarantee: the figures are the kernel's for that process and the descendants it waited for
(`os.wait4`). It is started by a small process, this file run by itself, because a child's peak is
at least the size of the process that starts it: so whoever measures may be as large as it likes.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

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
    seconds : wall time from before the start to after the exit.
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
    text : its standard input.
    timeout : seconds after which it is killed.

    Examples
    --------
    >>> import sys
    >>> usage = run([sys.executable, "-c", "print(input()[::-1])"], text="stressed")
    >>> usage.outcome, usage.output, usage.peak_mebibytes > 1
    (<Outcome.DONE: 'done'>, 'desserts\\n', True)
    """
    with tempfile.TemporaryDirectory() as folder:
        names = ("figures", "input", "output", "errors")
        figures, *paths = (os.path.join(folder, name) for name in names)
        with open(paths[0], "w", encoding="utf-8") as given:
            given.write(text)
        with open(paths[0]) as given, open(paths[1], "w") as output, open(paths[2], "w") as errors:
            limit = "" if timeout is None else str(timeout)
            subprocess.run(
                [sys.executable, "-I", "-S", __file__, figures, limit, *command],
                stdin=given,
                stdout=output,
                stderr=errors,
                check=False,
            )
        told, wrong = (Path(path).read_text(encoding="utf-8", errors="replace") for path in paths[1:])
        if not os.path.exists(figures):
            return Usage(Outcome.FAILED, 0.0, 0.0, 0.0, told, wrong[-_MESSAGE_LENGTH:].strip())
        with open(figures) as stream:
            status, expired, seconds, processor, peak = json.load(stream)
    outcome = Outcome.DONE if status == 0 else Outcome.TIMED_OUT if expired else Outcome.FAILED
    message = "" if outcome is Outcome.DONE else wrong[-_MESSAGE_LENGTH:].strip()
    return Usage(outcome, seconds, processor, peak, told, message)


def _measure(figures: str, limit: str, *command: str) -> None:
    """Run the command, and write what it took into a file, in the order that `run` reads."""
    expired = threading.Event()
    start = time.perf_counter()
    process = subprocess.Popen(command)

    def expire() -> None:
        expired.set()
        process.kill()

    timer = threading.Timer(float(limit or threading.TIMEOUT_MAX), expire)
    timer.daemon = True
    timer.start()
    try:
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    finally:
        timer.cancel()
        if process.returncode is None:  # interrupted: it must not outlive its measurement
            process.kill()
            process.wait()
    seconds = time.perf_counter() - start
    processor, peak = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024
    with open(figures, "w") as stream:
        json.dump((process.returncode, expired.is_set(), seconds, processor, peak), stream)


if __name__ == "__main__":
    _measure(*sys.argv[1:])
