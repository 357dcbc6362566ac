"""The benchmark of ``ptmcad classify`` on problem records: what is run, in which order, and what comes out.

Guarantee: in each round every job runs once, in an order drawn from the seed, so the i-th figures of two jobs belong
together and ratios can be taken pair by pair. A job that failed or ran out of time has no summary but a reason.
"""

from __future__ import annotations

import importlib.metadata
import os
import platform
import random
import statistics
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ptmcad.question import config
from ptmcad.studies.bench import qepcad
from ptmcad.studies.bench.process import Outcome, Usage, run

FLOOR = (sys.executable, "-c", "import flint, numpy, click, yaml")
PACKAGES = ("ptmcad", "python-flint", "numpy", "click", "PyYAML", "matplotlib", "sympy", "numba", "scipy", "gcad")


@dataclass(frozen=True, slots=True)
class Summary:
    """Median and extremes of the runs of one job; the peak is the largest of all runs, in MiB."""

    runs: int
    median: float
    minimum: float
    maximum: float
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


def measure(
    records: Sequence[Path],
    *,
    rounds: int = 5,
    picture_rounds: int = 2,
    timeout: float = 120.0,
    seed: int = 1,
    date: str = "",
    progress: Callable[[str], None] = lambda _: None,
) -> Report:
    """Run the benchmark.

    Parameters
    ----------
    records : problem records.
    rounds : runs of each job.
    picture_rounds : runs with pictures too.
    timeout : seconds after which a run is killed and the job given up.
    seed : of the order within a round.
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
        jobs = [_Job("floor", "", FLOOR, rounds, timeout)]
        for path in records:
            jobs.append(_Job("json", path.stem, _classify(path, "json", folder), rounds, timeout))
            jobs.append(_Job("pictures", path.stem, _classify(path, "json,png,svg", folder), picture_rounds, timeout))
            progress(f"warming up: {path.stem}")
            run(jobs[-2].command, timeout=timeout)
        run(FLOOR, timeout=timeout)
        figures = _rounds(jobs, rounds, seed, progress)
    floor = figures[jobs[0]]
    rows = []
    for path in records:
        ours, pictures = (job for job in jobs if job.slice == path.stem)
        rows.append(
            Row(
                name=path.stem,
                text=summary(figures[ours]),
                over_floor=_ratio(figures[ours], floor),
                pictures=summary(figures[pictures]),
            )
        )
    return Report(machine(), versions(), date, seed, rounds, summary(floor), tuple(rows))


def summary(runs: Sequence[Usage]) -> Summary | str:
    """The summary of the runs of one job, or why there is none."""
    if not runs:
        return "not run"
    for usage in runs:
        if usage.outcome is not Outcome.DONE:
            after = f" after {usage.seconds:.0f} s" if usage.outcome is Outcome.TIMED_OUT else ""
            return f"{usage.outcome.value}{after}{': ' + usage.message if usage.message else ''}"
    seconds = [usage.seconds for usage in runs]
    return Summary(
        runs=len(runs),
        median=statistics.median(seconds),
        minimum=min(seconds),
        maximum=max(seconds),
        processor=statistics.median(usage.processor_seconds for usage in runs),
        peak=max(usage.peak_mebibytes for usage in runs),
    )


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
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            found[package] = "not installed"
    where = qepcad.program()
    if where is None:
        found["qepcad"] = "not installed"
    else:
        lines = run((where, "-v"), timeout=10).output.strip().splitlines()
        found["qepcad"] = lines[0] if lines else "unknown"
    return found


@dataclass(frozen=True, slots=True)
class _Job:
    """A command that is run in the first `rounds` rounds."""

    kind: str
    slice: str
    command: tuple[str, ...]
    rounds: int
    timeout: float

    def run(self) -> Usage:
        return run(self.command, timeout=self.timeout)


def _classify(path: Path, formats: str, folder: str) -> tuple[str, ...]:
    script = Path(sys.executable).with_name("ptmcad")
    return (str(script), "classify", str(path), "--format", formats, "--out", folder)


def _rounds(jobs: Sequence[_Job], rounds: int, seed: int, progress: Callable[[str], None]) -> dict[_Job, list[Usage]]:
    """Run every job once a round; a job that did not get through is not tried again."""
    figures: dict[_Job, list[Usage]] = {job: [] for job in jobs}
    order = random.Random(seed)
    for index in range(max(rounds, *(job.rounds for job in jobs))):
        due = [job for job in jobs if index < job.rounds and _got_through(figures[job])]
        progress(f"round {index + 1}: {len(due)} runs")
        order.shuffle(due)
        for job in due:
            figures[job].append(job.run())
    return figures


def _got_through(runs: Sequence[Usage]) -> bool:
    return all(usage.outcome is Outcome.DONE for usage in runs)


def _ratio(numerator: Sequence[Usage], denominator: Sequence[Usage]) -> float:
    """Median of the ratios of the runs of the same round; 0 where there is none or either did not get through."""
    if not numerator or not denominator or not _got_through([*numerator, *denominator]):
        return 0.0
    return statistics.median(a.seconds / b.seconds for a, b in zip(numerator, denominator, strict=False))
