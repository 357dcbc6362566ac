"""What all measurements have in common: jobs take turns as whole processes, and their runs become a
data frame.

Guarantee: in each round every job that is due runs once, in an order drawn from the seed, so that a
slow minute of the machine hits all alike, and that the figures of one round belong together. A job
that failed or ran out of time has a reason and no figures, and is not tried again.
"""

from __future__ import annotations

import argparse
import os
import platform
import random
import shutil
import statistics
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.slice import Slice
from ptmcad.show.table import aligned
from ptmcad.studies.bench.error import Truth
from ptmcad.studies.bench.process import Usage, run
from ptmcad.studies.texts import installed

PACKAGES = (
    "ptmcad",
    "python-flint",
    "numpy",
    "click",
    "PyYAML",
    "matplotlib",
    "sympy",
    "numba",
    "scipy",
    "gcad",
)
GRACE_SECONDS = 1.0
"""Seconds that an engine has to save what it has when its time is over."""
FORMAT = "ptmcad-bench/1"
Row = dict[str, Any]
_SHOWN = {
    "median": "seconds",
    "minimum": "least",
    "maximum": "most",
    "processor": "processor",
    "peak": "peak MiB",
}
"""Figures of a job, and how their columns are called."""


@dataclass(slots=True)
class Job:
    """A process, and what its runs gave so far.

    Attributes
    ----------
    text : its standard input.
    answer : the file that it writes, text but for NumPy's arrays; None where the answer is on
        standard output.
    check : what is wrong with a process that is done; empty when nothing is.
    saves : whether it takes ``--timeout`` and leaves an answer when its time is over, as the
        certified engine does.
    reason : why there are no figures; empty while there may be.
    """

    subject: str
    what: str
    setting: str
    command: Sequence[str]
    text: str = ""
    answer: Path | None = None
    check: Callable[[Usage], str] = lambda usage: ""
    saves: bool = False
    usages: list[Usage] = field(default_factory=list)
    reason: str = ""

    def attempt(self, timeout: float) -> Usage:
        """Run once, within so many seconds, and take the figures, or the reason why there are none."""
        limit = ("--timeout", f"{max(timeout - GRACE_SECONDS, 0.1):.2f}") if self.saves else ()
        if self.answer is not None:
            self.answer.unlink(missing_ok=True)
        usage = run(
            (*self.command, *limit),
            text=self.text,
            timeout=max(timeout, 0.01) + GRACE_SECONDS * self.saves,
        )
        if self.answer is None:
            self.reason = usage.fault
        elif not self.answer.exists():
            self.reason = usage.fault or "failed: no answer"
        else:
            self.reason = "" if self.saves else usage.fault
            if self.answer.suffix != ".npy":
                usage = replace(usage, output=self.answer.read_text(encoding="utf-8"))
        if not self.reason and (wrong := self.check(usage)):
            self.reason = f"failed: {wrong}"
        if not self.reason:
            self.usages.append(usage)
        return usage

    @property
    def times(self) -> Row:
        """Of its runs."""
        return times([usage.seconds for usage in self.usages])

    def said(self) -> str:
        """The text of the last answer."""
        return self.usages[-1].output


class Case(NamedTuple):
    """What the methods are asked about: a slice with its own file, its map and what errors are
    measured against where there are such, a folder for answers, and whether settings have to be few
    and coarse.
    """

    slice: Slice
    record: Path
    exact: RegionMap | None
    known: dict[str, Truth] | None
    folder: Path
    quick: bool


Asked = dict[str, Any] | str
"""The command of a job and what else it has, by the names of `Job`; or why there is none."""


def classification(record: Path, name: str, folder: Path, *options: str) -> dict[str, Any]:
    """What a job has that writes the map of a record of this name into a folder."""
    command = (
        sys.executable,
        "-m",
        "ptmcad",
        "classify",
        str(record),
        *options,
        "--out",
        str(folder),
    )
    return {"command": command, "answer": folder / f"{name}.json"}


_KEYS = (
    "method",
    "setting",
    "seconds",
    "computing",
    "peak",
    "reason",
    "note",
    "figures",
    "area_width",
)


def measurement(method: str, setting: str, **more: Any) -> Row:
    """What is known of one method at one setting; ``docs/bench.schema.json`` says what each key
    means.
    """
    return {
        **dict.fromkeys(_KEYS),
        "method": method,
        "setting": setting,
        "reason": "",
        "note": "",
        **more,
    }


def take_turns(
    jobs: Sequence[Job], rounds: int, order: random.Random, attempt: Callable[[Job], object]
) -> None:
    """So many rounds, in each of which every job without a reason is attempted once."""
    for _ in range(rounds):
        due = [job for job in jobs if not job.reason]
        for job in order.sample(due, len(due)):
            attempt(job)


def turns(jobs: Sequence[Job], options: argparse.Namespace) -> None:
    """All rounds of jobs, which have ``--timeout`` seconds each."""

    def attempt(job: Job) -> None:
        print(f"{job.subject}, {job.what}, {job.setting}", file=sys.stderr, flush=True)
        job.attempt(options.timeout)

    take_turns(jobs, options.rounds, random.Random(options.seed), attempt)


def times(seconds: Sequence[float]) -> Row:
    """How many runs, and their median and spread, rounded to 0.1 ms."""
    spread = statistics.median(seconds), min(seconds), max(seconds)
    names = ("median", "minimum", "maximum")
    return {"runs": len(seconds), **{n: round(x, 4) for n, x in zip(names, spread, strict=True)}}


def summary(jobs: Sequence[Job], over: str = "", figure: str = "processor_seconds") -> pd.DataFrame:
    """A row for each job: medians over its runs, or the reason why there are none.

    Parameters
    ----------
    over : what the first job is: the column "over ..." has medians of the ratios to it within a
        round. None when empty.
    figure : of a `Usage`, of which ratios are taken.
    """
    rows = []
    for job in jobs:
        row: Row = {"subject": job.subject, "what": job.what, "setting": job.setting}
        if job.usages and not job.reason:
            row |= job.times
            row["processor"] = round(
                statistics.median(usage.processor_seconds for usage in job.usages), 4
            )
            row["peak"] = round(max(usage.peak_mebibytes for usage in job.usages), 4)
            pairs = zip(job.usages, () if jobs[0].reason else jobs[0].usages, strict=False)
            ratios = [getattr(usage, figure) / getattr(first, figure) for usage, first in pairs]
            row["over"] = round(statistics.median(ratios), 3) if ratios else None
        rows.append(row | {"reason": job.reason or (None if job.usages else "not run")})
    columns = ["subject", "what", "setting", "runs", *_SHOWN, *(["over"] if over else []), "reason"]
    shown = pd.DataFrame(rows, columns=columns).astype({"runs": "Int64"})
    return shown.rename(columns={**_SHOWN, "over": f"over {over}"})


def made_with() -> dict[str, dict[str, str]]:
    """What figures depend on: the machine, without anything that identifies it, and versions."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    machine = {
        "processor": (models or [platform.processor() or platform.machine()])[0],
        "cores": str(os.cpu_count()),
        "system": f"{platform.system()} {platform.machine()}",
        "load before": " ".join(f"{load:.2f}" for load in os.getloadavg()),
    }
    said = "not installed"
    if where := shutil.which("qepcad"):
        said = (run((where, "-v"), timeout=10).output.strip() or "unknown").splitlines()[0]
    versions = {"python": platform.python_version(), **installed(PACKAGES), "qepcad": said}
    return {"machine": machine, "versions": versions}


def table(rows: pd.DataFrame) -> str:
    """Rows in columns, without columns in which there is nothing."""
    shown = rows.dropna(axis=1, how="all").map(
        lambda x: "-" if pd.isna(x) else f"{x:.4g}" if isinstance(x, float) else str(x)
    )
    return "\n".join(aligned([list(map(str, shown)), *shown.to_numpy().tolist()]))
