"""The benchmark of ``ptmcad classify`` on problem records: what is run, in which order, and what comes out.

Guarantee: in each round every job runs once, in an order drawn from the seed, so the i-th figures of two jobs belong
together and ratios can be taken pair by pair. A job that failed or ran out of time has no summary but a reason.
"""

from __future__ import annotations

import os
import platform
import random
import statistics
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from ptmcad.question import config
from ptmcad.studies.bench import qepcad
from ptmcad.studies.bench.process import Outcome, Usage, run
from ptmcad.studies.bench.rounds import Times, ratio, rounds, times
from ptmcad.studies.tables import installed

FLOOR = (sys.executable, "-c", "import flint, numpy, click, yaml")
PACKAGES = ("ptmcad", "python-flint", "numpy", "click", "PyYAML", "matplotlib", "sympy", "numba", "scipy", "gcad")


@dataclass(frozen=True, slots=True)
class Summary(Times):
    """The runs of one job: their wall and median processor seconds, and the largest peak of all, in MiB."""

    processor: float
    peak: float


@dataclass(frozen=True, slots=True)
class Row:
    """One slice.

    Attributes
    ----------
    text : run with JSON output only, or the reason why there is no figure.
    over_floor : its time over the machine's floor, median over the rounds; 0 without figures.
    pictures : run with PNG and SVG too, or the reason.
    """

    name: str
    text: Summary | str
    over_floor: float
    pictures: Summary | str


@dataclass(frozen=True, slots=True)
class Report:
    """A whole benchmark, with what is needed to judge it. `date` is the caller's, or empty."""

    machine: dict[str, str]
    versions: dict[str, str]
    date: str
    seed: int
    rounds: int
    floor: Summary | str
    rows: tuple[Row, ...]


class Plan(NamedTuple):
    """How often each job runs, with JSON only and with pictures too; seconds for a run; the seed of their order."""

    rounds: int = 5
    picture_rounds: int = 2
    timeout: float = 120.0
    seed: int = 1


def measure(
    records: Sequence[Path], plan: Plan, *, date: str = "", progress: Callable[[str], None] = lambda _: None
) -> Report:
    """Run the benchmark.

    Parameters
    ----------
    records : problem records.
    date : recorded as it is.
    progress : called before each round.

    Raises
    ------
    ConfigError
        If a record cannot be read.
    """
    for path in records:
        config.load(path)
    with tempfile.TemporaryDirectory() as folder:
        floor = _Job(FLOOR, plan.rounds, [])
        texts = [_Job(_classify(path, "json", folder), plan.rounds, []) for path in records]
        pictures = [_Job(_classify(path, "json,png,svg", folder), plan.picture_rounds, []) for path in records]
        for path, job in zip(records, texts, strict=True):
            progress(f"warming up: {path.stem}")
            run(job.command, timeout=plan.timeout)
        run(FLOOR, timeout=plan.timeout)
        jobs = [floor, *texts, *pictures]

        def due(index: int) -> list[_Job]:
            """A job that did not get through is not tried again."""
            return [job for job in jobs if index < job.rounds and _got_through(job.runs)]

        for index, turns in enumerate(rounds(max(job.rounds for job in jobs), due, random.Random(plan.seed))):
            progress(f"round {index + 1}: {len(turns)} runs")
            for job in turns:
                job.runs.append(run(job.command, timeout=plan.timeout))
    rows = tuple(
        Row(path.stem, summary(text.runs), _over(text.runs, floor.runs), summary(drawn.runs))
        for path, text, drawn in zip(records, texts, pictures, strict=True)
    )
    return Report(machine(), versions(), date, plan.seed, plan.rounds, summary(floor.runs), rows)


def summary(runs: Sequence[Usage]) -> Summary | str:
    """The summary of the runs of one job, or why there is none."""
    if not runs:
        return "not run"
    for usage in runs:
        if usage.outcome is not Outcome.DONE:
            after = f" after {usage.seconds:.0f} s" if usage.outcome is Outcome.TIMED_OUT else ""
            return f"{usage.outcome.value}{after}{': ' + usage.message if usage.message else ''}"
    wall = times([usage.seconds for usage in runs])
    processor = statistics.median(usage.processor_seconds for usage in runs)
    return Summary(wall.runs, wall.median, wall.minimum, wall.maximum, processor, max(u.peak_mebibytes for u in runs))


def machine() -> dict[str, str]:
    """What the figures depend on, without anything that identifies the machine."""
    processor = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        models = [line.partition(":")[2].strip() for line in cpuinfo.read_text().splitlines() if "model name" in line]
        processor = models[0] if models else processor
    return {
        "processor": processor,
        "cores": str(os.cpu_count()),
        "system": f"{platform.system()} {platform.machine()}",
        "load before": " ".join(f"{load:.2f}" for load in os.getloadavg()),
    }


def versions() -> dict[str, str]:
    """Versions of Python, of the packages and of QEPCAD."""
    found = {"python": platform.python_version(), **installed(PACKAGES)}
    where = qepcad.program()
    if where is None:
        found["qepcad"] = "not installed"
    else:
        lines = run((where, "-v"), timeout=10).output.strip().splitlines()
        found["qepcad"] = lines[0] if lines else "unknown"
    return found


class _Job(NamedTuple):
    """A command that is run in the first rounds, and its runs so far."""

    command: tuple[str, ...]
    rounds: int
    runs: list[Usage]


def _classify(path: Path, formats: str, folder: str) -> tuple[str, ...]:
    script = Path(sys.executable).with_name("ptmcad")
    return (str(script), "classify", str(path), "--format", formats, "--out", folder)


def _got_through(runs: Sequence[Usage]) -> bool:
    return all(usage.outcome is Outcome.DONE for usage in runs)


def _over(runs: Sequence[Usage], floor: Sequence[Usage]) -> float:
    """How many times the floor's a job's time is; 0 where either did not get through."""
    if not runs or not floor or not _got_through([*runs, *floor]):
        return 0.0
    return ratio([u.seconds for u in runs], [u.seconds for u in floor])
