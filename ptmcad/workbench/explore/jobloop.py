"""The process that computes for the explorer: jobs come in as lines of JSON, answers go out as
such.

Guarantee: it ends when the server does, whatever it is doing (`end_with`). Standard output holds
answers alone, whatever libraries print.

The first line is the panel, which the server that started this process has pickled; then every line
is a job ``{"number": n, ...}`` or ``{"cancel": n}``. An answer is two lines: ``{"number": n,
"ended": "done" | "refused" | "superseded"}``, and what the page is told.
"""

from __future__ import annotations

import base64
import json
import os
import pickle
import select
import signal
import sys
from pathlib import Path
from typing import IO, Any

from ptmcad.errors import PtmcadError
from ptmcad.process.handover import end_with
from ptmcad.workbench.explore.jobs import Tasks


class Superseded(Exception):
    """The job at hand is no longer wanted."""


class InputLines:
    """Standard input as lines, of which one can ask whether there are more without waiting."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor, self.buffer = descriptor, b""

    def next(self) -> bytes | None:
        """The next line, waited for; None at the end."""
        while b"\n" not in self.buffer:
            data = os.read(self.descriptor, 1 << 16)
            if not data:
                return None
            self.buffer += data
        line, _, self.buffer = self.buffer.partition(b"\n")
        return line

    def waiting(self) -> bool:
        """Whether there is something to read, or the end."""
        return b"\n" in self.buffer or bool(select.select([self.descriptor], [], [], 0)[0])


class JobLoop:
    """A loop over jobs."""

    def __init__(self, lines: InputLines, answers: IO[bytes]) -> None:
        self.lines, self.answers = lines, answers
        self.number = -1

    def check(self) -> None:
        """Leave the job at hand if it has been cancelled; nothing else comes while it lasts."""
        while self.lines.waiting():
            line = self.lines.next()
            if line is None:
                raise SystemExit(0)
            if json.loads(line).get("cancel") == self.number:
                raise Superseded

    def run(self, tasks: Tasks) -> None:
        """Answer until the server is gone."""
        while (line := self.lines.next()) is not None:
            job = json.loads(line)
            if "cancel" in job:
                continue  # it came too late: the job is done
            self.number = job["number"]
            ended, told = self._ended(tasks, job)
            for part in ({"number": self.number, "ended": ended}, told):
                self.answers.write(
                    json.dumps(part, separators=(",", ":"), allow_nan=False).encode() + b"\n"
                )
            self.answers.flush()

    def _ended(self, tasks: Tasks, job: dict[str, Any]) -> tuple[str, dict[str, Any]]:
        try:
            return "done", tasks.answer(job)
        except Superseded:
            return "superseded", {}
        except PtmcadError as error:
            return "refused", {"error": str(error)}


def main() -> None:
    """Run as ``python -m ptmcad.workbench.explore.jobloop LIFELINE PARENT FOLDER``."""
    lifeline, parent, folder = int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    end_with(lifeline, parent)
    signal.signal(
        signal.SIGINT, signal.SIG_IGN
    )  # Ctrl-C goes to the server, which ends this process
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print
    os.environ["MPLBACKEND"], os.environ["MATPLOTLIBRC"] = "agg", os.devnull
    lines = InputLines(0)
    first = lines.next()
    if first is None:
        return
    worker = JobLoop(lines, answers)
    worker.run(Tasks(pickle.loads(base64.b64decode(first)), worker.check, folder))


if __name__ == "__main__":
    main()
