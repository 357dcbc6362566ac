"""What all measurements have in common: jobs take turns as whole processes, and their runs become a data frame.

Guarantee: in each round every job that is due runs once, in an order drawn from the seed, so that a slow minute of the
machine hits all alike, and that the figures of one round belong together. A job that failed or ran out of time has a
reason and no figures, and is not tried again.
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
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.table import aligned
from ptmcad.studies.bench.error import Truth
from ptmcad.studies.bench.process import Outcome, Usage, run
from ptmcad.studies.tables import installed

PACKAGES = ("ptmcad", "python-flint", "numpy", "click", "PyYAML", "matplotlib", "sympy", "numba", "scipy", "gcad")
GRACE_SECONDS = 1.0
"""Seconds that an engine has to save what it has when its time is over."""
Row = dict[str, Any]


@dataclass(slots=True)
class Job:
    """A process, and what its runs gave so far.

    Attributes
    ----------
    text : its standard input.
    answer : the file that it writes, text but for NumPy's arrays; None where the answer is on standard output.
    check : what is wrong with a process that is done; empty when nothing is.
    saves : whether it takes ``--timeout`` and leaves an answer when its time is over, as the certified engine does.
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
        if self.answer is not None:
            self.answer.unlink(missing_ok=True)
        if self.saves:
            limit = f"{max(timeout - GRACE_SECONDS, 0.1):.2f}"
            usage = run((*self.command, "--timeout", limit), text=self.text, timeout=timeout + GRACE_SECONDS)
            if self.answer is not None and self.answer.exists():
                usage = replace(usage, outcome=Outcome.DONE)
            elif "time limit" in usage.message:
                usage = replace(usage, outcome=Outcome.TIMED_OUT)
        else:
            usage = run(self.command, text=self.text, timeout=max(timeout, 0.01))
        if usage.outcome is Outcome.TIMED_OUT:
            self.reason = f"not in {timeout:g} s"
        elif usage.outcome is Outcome.FAILED:
            self.reason = f"failed: {(usage.message or 'no message').splitlines()[-1]}"
        elif self.answer is not None and not self.answer.exists():
            self.reason = "failed: no answer"
        else:
            if self.answer is not None and self.answer.suffix != ".npy":
                usage = replace(usage, output=self.answer.read_text(encoding="utf-8"))
            if wrong := self.check(usage):
                self.reason = f"failed: {wrong}"
            else:
                self.usages.append(usage)
        return usage

    def said(self) -> str:
        """The text of the last answer."""
        return self.usages[-1].output


class Case(NamedTuple):
    """What the methods are asked about: a slice with its own file, its map and what errors are measured against where
    there are such, a folder for answers, and whether settings have to be few and coarse.
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
    command = (sys.executable, "-m", "ptmcad", "classify", str(record), *options, "--out", str(folder))
    return {"command": command, "answer": folder / f"{name}.json"}


def take_turns(jobs: Sequence[Job], rounds: int, order: random.Random, attempt: Callable[[Job], object]) -> None:
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
    spread = {"median": statistics.median(seconds), "minimum": min(seconds), "maximum": max(seconds)}
    return {"runs": len(seconds)} | {name: round(x, 4) for name, x in spread.items()}


def summary(jobs: Sequence[Job], over: str = "", figure: str = "processor_seconds") -> pd.DataFrame:
    """A row for each job: medians over its runs, or the reason why there are none.

    Parameters
    ----------
    over : what the first job is: the column "over ..." has medians of the ratios to it within a round. None when empty.
    figure : of a `Usage`, of which ratios are taken.
    """
    measured = [
        {"job": number, "round": turn, **asdict(usage)}
        for number, job in enumerate(jobs)
        for turn, usage in enumerate(job.usages if not job.reason else ())
    ]
    runs = pd.DataFrame(measured, columns=["job", "round", *(part.name for part in fields(Usage))])
    rows = pd.DataFrame([(job.subject, job.what, job.setting) for job in jobs], columns=["subject", "what", "setting"])
    figures = runs.groupby("job").agg(
        runs=("seconds", "size"),
        seconds=("seconds", "median"),
        least=("seconds", "min"),
        most=("seconds", "max"),
        processor=("processor_seconds", "median"),
        peak=("peak_mebibytes", "max"),
    )
    rows = rows.join(figures.round(4)).astype({"runs": "Int64"}).rename(columns={"peak": "peak MiB"})
    if over:
        by_round = runs.pivot(index="round", columns="job", values=figure).reindex(columns=range(len(jobs)))
        rows[f"over {over}"] = by_round.div(by_round[0], axis=0).median().round(3)
    rows["reason"] = [job.reason or (None if job.usages else "not run") for job in jobs]
    return rows


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
    where = shutil.which("qepcad")
    said = run((where, "-v"), timeout=10).output.strip().splitlines() or ["unknown"] if where else ["not installed"]
    versions = {"python": platform.python_version(), **installed(PACKAGES), "qepcad": said[0]}
    return {"machine": machine, "versions": versions}


def table(rows: pd.DataFrame) -> str:
    """Rows in columns, without columns in which there is nothing."""
    shown = rows.dropna(axis=1, how="all").map(
        lambda x: "-" if pd.isna(x) else f"{x:.4g}" if isinstance(x, float) else str(x)
    )
    return "\n".join(aligned([list(map(str, shown)), *shown.to_numpy().tolist()]))
