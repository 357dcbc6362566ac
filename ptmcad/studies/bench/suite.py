"""Time and memory of whole ``ptmcad classify`` processes on problem records, against the machine's floor.

Guarantee: in each round every job runs once, so the i-th figures of two jobs belong together and ratios can be taken
pair by pair. A job that failed or ran out of time has no summary but a reason, and is not tried again.
"""

from __future__ import annotations

import random
import statistics
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

from ptmcad.question.config import load
from ptmcad.studies.bench.harness import Command, Record, made_with, progress, ratio, rounds, times
from ptmcad.studies.bench.process import Outcome, Usage, run
from ptmcad.studies.tables import markdown, measured_with, page

FLOOR = (sys.executable, "-c", "import flint, numpy, click, yaml")
TEXT, PICTURES = "json", "json,png,svg"


class Plan(NamedTuple):
    """How often each job runs, with JSON only and with pictures too; seconds for a run; the seed of their order."""

    rounds: int = 5
    picture_rounds: int = 2
    timeout: float = 120.0
    seed: int = 1


def measure(records: Sequence[Path], plan: Plan, date: str = "") -> Record:
    """The benchmark of some problem records.

    Parameters
    ----------
    date : recorded as it is.

    Raises
    ------
    ConfigError
        If a record cannot be read.
    """
    for path in records:
        load(path)
    found: Record = {**made_with(), "date": date, "seed": plan.seed, "rounds": plan.rounds}
    script = str(Path(sys.executable).with_name("ptmcad"))
    with tempfile.TemporaryDirectory() as folder:
        commands: dict[tuple[str, str], tuple[str, ...]] = {("floor", ""): FLOOR}
        for formats in (TEXT, PICTURES):
            for path in records:
                commands[path.stem, formats] = (script, "classify", str(path), "--format", formats, "--out", folder)
        runs: dict[tuple[str, str], list[Usage]] = {job: [] for job in commands}
        for (name, formats), command in commands.items():
            if formats != PICTURES:
                progress(f"warming up: {name}")
                run(command, timeout=plan.timeout)

        def due(index: int) -> list[tuple[str, str]]:
            number = {PICTURES: plan.picture_rounds}
            return [job for job in runs if index < number.get(job[1], plan.rounds) and _got_through(runs[job])]

        most = max(plan.rounds, plan.picture_rounds)
        for index, turns in enumerate(rounds(most, due, random.Random(plan.seed))):
            progress(f"round {index + 1}: {len(turns)} runs")
            for job in turns:
                runs[job].append(run(commands[job], timeout=plan.timeout))
    floor = runs["floor", ""]
    found["floor"] = summary(floor)
    found["rows"] = [
        {"name": path.stem, "text": summary(runs[path.stem, TEXT]), "over_floor": _over(runs[path.stem, TEXT], floor),
         "pictures": summary(runs[path.stem, PICTURES])}
        for path in records
    ]  # fmt: skip
    return found


def summary(runs: Sequence[Usage]) -> dict[str, float] | str:
    """The runs of one job: their times, the median processor seconds and the largest peak in MiB; or why not."""
    if not runs:
        return "not run"
    for usage in runs:
        if usage.outcome is not Outcome.DONE:
            after = f" after {usage.seconds:.0f} s" if usage.outcome is Outcome.TIMED_OUT else ""
            return f"{usage.outcome.value}{after}{': ' + usage.message if usage.message else ''}"
    processor = statistics.median(usage.processor_seconds for usage in runs)
    peak = max(usage.peak_mebibytes for usage in runs)
    wall = asdict(times([usage.seconds for usage in runs]))
    return {**wall, "processor": round(processor, 4), "peak": round(peak, 4)}


def _got_through(runs: Sequence[Usage]) -> bool:
    return all(usage.outcome is Outcome.DONE for usage in runs)


def _over(runs: Sequence[Usage], floor: Sequence[Usage]) -> float:
    """How many times the floor's a job's time is, median over the rounds; 0 where either did not get through."""
    if not runs or not floor or not _got_through([*runs, *floor]):
        return 0.0
    return round(ratio([u.seconds for u in runs], [u.seconds for u in floor]), 4)


_INTRODUCTION = """
Wall seconds of whole processes, start-up included; every round runs each job once, in shuffled order. Ratios
are medians of the ratios within a round. The floor is the time in which the machine's Python imports flint,
numpy, click and yaml and does nothing else. Written by `make bench`. Other programs, and the error of each,
are on [their own page](error-time.md).
"""
_HEADER = ("slice", "JSON: median (min-max) s", "over floor", "with PNG and SVG, s", "peak MiB, JSON / pictures")


def to_markdown(found: Record) -> str:
    """The record as a page: the table, and what it was measured with."""
    date = f", {found['date']}" if found["date"] else ""
    return page(
        "# Benchmark",
        _INTRODUCTION,
        f"Floor: {_times(found['floor'])} s. Rounds: {found['rounds']}, seed {found['seed']}{date}.",
        markdown(_HEADER, map(_cells, found["rows"])),
        *measured_with(found),
    )


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    text, pictures = row["text"], row["pictures"]
    peaks = " / ".join("-" if isinstance(part, str) else f"{part['peak']:.0f}" for part in (text, pictures))
    over = f"{row['over_floor']:.2f}" if row["over_floor"] else "-"
    drawn = pictures if isinstance(pictures, str) else f"{pictures['median']:.2f}"
    return (row["name"], _times(text), over, drawn, peaks)


def _times(found: dict[str, float] | str) -> str:
    if isinstance(found, str):
        return found
    return f"{found['median']:.3f} ({found['minimum']:.3f}-{found['maximum']:.3f})"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark; the exit status is 0, or 2 for bad input."""
    command = Command(
        "bench",
        "Time and memory of whole `ptmcad classify` processes, against the machine's floor.",
        "bench",
        rounds=5,
        epilog="example: python -m ptmcad.studies.bench configs/fig4.yaml --rounds 3 --out /tmp",
    )  # fmt: skip
    command.add_argument("records", nargs="*", type=Path, help="problem records; default: configs/, no free lengths")
    command.add_argument("--picture-rounds", type=int, default=2, help="runs with PNG and SVG too (default 2)")
    command.add_argument("--timeout", type=float, default=120.0, help="seconds for each run (default 120)")
    command.add_argument("--date", default="", help="recorded in the report as it is")
    chosen = command.chosen(arguments)
    # a map with free lengths takes as long as it is given
    records = command.records(chosen.records, lambda slice: not slice.has_free_lengths)
    if chosen.picture_rounds < 0:
        command.error("--picture-rounds must be at least 0")
    plan = Plan(chosen.rounds, chosen.picture_rounds, chosen.timeout, chosen.seed)
    return command.status(chosen.out, lambda: measure(records, plan, chosen.date), to_markdown)
