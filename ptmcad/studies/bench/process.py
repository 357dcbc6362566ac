"""A process that is run once and measured.

Guarantee: the figures are the kernel's for that process and the descendants it waited for. It is
started by a small process, this file run by itself, because a child's peak is at least the size of
the process that starts it: so whoever measures may be as large as it likes.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory


@dataclass(frozen=True, slots=True)
class Usage:
    """What one run of a process cost.

    Attributes
    ----------
    seconds : wall time from before the start to after the exit.
    processor_seconds : user and system time.
    peak_mebibytes : largest resident set.
    output : what it wrote to standard output.
    fault : that its time was over, or that it failed, with its last words on standard error; empty
        when it is done.
    """

    seconds: float
    processor_seconds: float
    peak_mebibytes: float
    output: str = ""
    fault: str = ""


def run(command: Sequence[str], *, text: str = "", timeout: float = threading.TIMEOUT_MAX) -> Usage:
    """Run a command and measure it.

    Parameters
    ----------
    text : its standard input.
    timeout : seconds after which it is killed.

    Examples
    --------
    >>> import sys
    >>> usage = run([sys.executable, "-c", "print(input()[::-1])"], text="stressed")
    >>> usage.fault, usage.output, usage.peak_mebibytes > 1
    ('', 'desserts\\n', True)
    """
    with TemporaryDirectory() as name:
        figures, given, *said = (
            Path(name, part) for part in ("figures", "input", "output", "errors")
        )
        given.write_text(text, encoding="utf-8")
        starter = [sys.executable, "-I", "-S", __file__, str(figures), str(timeout), *command]
        # files, not pipes: a descendant that outlives the process would keep a pipe open
        with given.open() as stdin, said[0].open("w") as stdout, said[1].open("w") as stderr:
            subprocess.run(starter, stdin=stdin, stdout=stdout, stderr=stderr, check=False)
        output, wrong = (path.read_text(encoding="utf-8", errors="replace") for path in said)
        measured = (
            json.loads(figures.read_text()) if figures.exists() else ("failed", 0.0, 0.0, 0.0)
        )
    last = (wrong.strip() or "no message").splitlines()[-1][-300:]
    fault = {"done": "", "late": f"not in {timeout:g} s", "failed": f"failed: {last}"}[measured[0]]
    return Usage(measured[1], measured[2], measured[3], output, fault)


def _measure(figures: str, timeout: str, *command: str) -> None:
    """Run the command, and write how it ended and what it took into a file."""
    start = time.perf_counter()
    with subprocess.Popen(command) as process:
        timer = threading.Timer(float(timeout), process.kill)
        timer.daemon = True
        timer.start()
        try:
            process.wait()
        finally:
            timer.cancel()
            process.kill()  # where this was interrupted: it must not outlive its measurement
    seconds = time.perf_counter() - start
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    late = process.returncode != 0 and seconds >= float(timeout)
    ended = "late" if late else "failed" if process.returncode else "done"
    measured = (ended, seconds, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)
    Path(figures).write_text(json.dumps(measured))


if __name__ == "__main__":
    _measure(*sys.argv[1:])
