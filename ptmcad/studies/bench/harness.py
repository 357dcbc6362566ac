"""What all measurements have in common: jobs take turns as whole processes, and each becomes a row of a table.

Guarantee: in each round every job that is due runs once, in an order drawn from the seed, so that
a slow minute of the machine hits all alike, and that the i-th figures of two jobs belong together.
A job that failed or ran out of time has a reason and no figures, and is not tried again.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import random
import statistics
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ptmcad.errors import PtmcadError
from ptmcad.process.output import text_writer, write_files
from ptmcad.studies.bench import qepcad
from ptmcad.studies.bench.process import Outcome, Usage, run
from ptmcad.studies.tables import columns, installed

PACKAGES = ("ptmcad", "python-flint", "numpy", "click", "PyYAML", "matplotlib", "sympy", "numba", "scipy", "gcad")
PTMCAD = (sys.executable, "-m", "ptmcad")
Row = dict[str, Any]


def times(seconds: Sequence[float]) -> Row:
    """How many runs, and their median and spread, rounded to 0.1 ms."""
    spread = {"median": statistics.median(seconds), "minimum": min(seconds), "maximum": max(seconds)}
    return {"runs": len(seconds)} | {name: round(x, 4) for name, x in spread.items()}


@dataclass(slots=True)
class Job:
    """Processes whose times are added, and what their runs gave so far.

    Attributes
    ----------
    commands : each with its standard input.
    answer : the file that the last one writes; None where the answer is on standard output.
    check : what is wrong with a process that is done; empty when nothing is.
    reason : why there are no figures; empty while there may be.
    """

    subject: str
    what: str
    setting: str
    commands: Sequence[tuple[Sequence[str], str]]
    answer: Path | None = None
    check: Callable[[Usage], str] = lambda usage: ""
    usages: list[Usage] = field(default_factory=list)
    reason: str = ""

    def attempt(self, timeout: float) -> Usage:
        """Run once, within so many seconds for all processes, and record it."""
        if self.answer is not None:
            self.answer.unlink(missing_ok=True)
        parts: list[Usage] = []
        for command, text in self.commands:
            left = timeout - sum(u.seconds for u in parts)
            usage = run(command, text=text, timeout=max(left, 0.01))
            wrong = self.check(usage) if usage.outcome is Outcome.DONE else ""
            parts.append(replace(usage, outcome=Outcome.FAILED, message=wrong) if wrong else usage)
            if parts[-1].outcome is not Outcome.DONE:
                break
        last = parts[-1]
        whole = Usage(
            last.outcome,
            sum(u.seconds for u in parts),
            sum(u.processor_seconds for u in parts),
            max(u.peak_mebibytes for u in parts),
            last.output,
            last.message,
        )
        self.record(whole, timeout)
        return whole

    def record(self, usage: Usage, timeout: float) -> None:
        """Take a run's figures, or the reason why there are none."""
        if usage.outcome is Outcome.TIMED_OUT:
            self.reason = f"not in {timeout:g} s"
        elif usage.outcome is Outcome.FAILED:
            said = usage.message.strip().splitlines()
            self.reason = f"failed: {said[-1] if said else 'no message'}"
        elif self.answer is not None and not self.answer.exists():
            self.reason = "failed: no answer"
        else:
            self.usages.append(usage)

    def row(self) -> Row:
        """The figures, or the reason, as a row of a table."""
        found: Row = {"subject": self.subject, "what": self.what, "setting": self.setting}
        if self.reason or not self.usages:
            return found | {"reason": self.reason or "not run"}
        seconds = times([u.seconds for u in self.usages])
        return found | {
            "runs": seconds["runs"],
            "seconds": seconds["median"],
            "least": seconds["minimum"],
            "most": seconds["maximum"],
            "processor": round(statistics.median(u.processor_seconds for u in self.usages), 4),
            "peak MiB": round(max(u.peak_mebibytes for u in self.usages), 1),
        }


def take_turns(jobs: Sequence[Job], number: int, order: random.Random, attempt: Callable[[Job], object]) -> None:
    """So many rounds, in each of which every job without a reason is attempted once."""
    for _ in range(number):
        due = [job for job in jobs if not job.reason]
        for job in order.sample(due, len(due)):
            attempt(job)


def ratio(job: Job, other: Job, figure: str = "processor_seconds") -> float | None:
    """The median of the ratios of the same rounds; None where either was not measured."""
    pairs = zip(job.usages, other.usages, strict=False)
    ratios: list[float] = [getattr(a, figure) / getattr(b, figure) for a, b in pairs]
    return round(statistics.median(ratios), 3) if ratios and not (job.reason or other.reason) else None


def made_with() -> dict[str, dict[str, str]]:
    """What figures depend on: the machine, without anything that identifies it, and versions."""
    processor = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    machine = {
        "processor": models[0] if models else processor,
        "cores": str(os.cpu_count()),
        "system": f"{platform.system()} {platform.machine()}",
        "load before": " ".join(f"{load:.2f}" for load in os.getloadavg()),
    }
    where = qepcad.program()
    said = [] if where is None else run((where, "-v"), timeout=10).output.strip().splitlines() or ["unknown"]
    versions = {"python": platform.python_version(), **installed(PACKAGES)}
    return {"machine": machine, "versions": versions | {"qepcad": said[0] if said else "not installed"}}


def progress(message: str) -> None:
    """What is being done, on standard error."""
    print(message, file=sys.stderr, flush=True)


def table(rows: Iterable[Mapping[str, Any]]) -> str:
    """Rows in columns, by their keys in the order in which they come first; a reason stands at the end."""
    rows = list(rows)
    keys = list(dict.fromkeys(key for row in rows for key in row if key != "reason"))
    header = [*keys, "reason" if any("reason" in row for row in rows) else ""]
    return "\n".join(columns([header, *([_text(row.get(key)) for key in header] for row in rows)]))


def _text(value: Any) -> str:
    if value is None or value == "":
        return "-" if value is None else ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def study(
    name: str,
    options: argparse.Namespace,
    measure: Callable[[argparse.Namespace], list[Row]],
    more: Callable[[list[Row], Path], object] = lambda rows, folder: None,
) -> int:
    """Measure, print the table, and write NAME.json; 1 where a row differs, 2, with a message, for bad input.

    Parameters
    ----------
    more : writes what goes with the file.
    """
    try:
        if options.out is not None:
            options.out.mkdir(parents=True, exist_ok=True)
        found = {"format": f"ptmcad-{name}/2", **made_with(), "seed": options.seed, "rounds": options.rounds}
        rows = measure(options)
        if options.out is not None:
            text = json.dumps(found | {"rows": rows}, indent=1, ensure_ascii=False) + "\n"
            write_files(options.out, {f"{name}.json": text_writer(text)})
            more(rows, options.out)
    except (PtmcadError, OSError) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 2
    print(table(rows))
    return int(any(row.get("differs") for row in rows))
