"""Shipped records as whole processes: time, memory and forecasts; and what each saving is worth.

Guarantee: of an ablation every map that is timed was compared with the one that all savings made
(`difference`); ratios are medians of the ratios within a round, of processor time.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from ptmcad.answer.regionmap import Merge, RegionMap
from ptmcad.ask.checking import check
from ptmcad.errors import PtmcadError
from ptmcad.question.config import load
from ptmcad.question.savings import ALL, SAVINGS, Engine
from ptmcad.studies.bench.harness import PTMCAD, Job, Row, progress, ratio, take_turns
from ptmcad.studies.bench.methods import exchanged

FLOOR = (sys.executable, "-c", "import flint, numpy, click, yaml")
_SHORT, _LONG = ("rho=1/20:1/2", "L2=5/4:2"), ("rho=1:2", "L2=1:2")
CERTIFIED: dict[str, tuple[tuple[Sequence[str], str], ...]] = {
    "free02": ((_SHORT, "1/20"), ((), "1/1000")),
    "free02-unloaded": ((_SHORT, "1/20"), (_LONG, "1/1000")),
}
"""Records on which the certified engine's savings are measured: windows, and the share at which to stop."""
PATIENCE = 30
"""Seconds after which a certified run without a saving stops."""


def turns(jobs: Sequence[Job], options: argparse.Namespace) -> None:
    """All rounds of jobs, which have ``--timeout`` seconds each."""

    def attempt(job: Job) -> None:
        progress(f"{job.subject}, {job.what}, {job.setting}")
        job.attempt(options.timeout)

    take_turns(jobs, options.rounds, random.Random(options.seed), attempt)


def found_records(given: Sequence[Path], pattern: str = "*.yaml") -> Sequence[Path]:
    """The records that are given, else those in configs/.

    Raises
    ------
    PtmcadError
        When there are none, or one cannot be read.
    """
    found = given or sorted(Path("configs").glob(pattern))
    if not found:
        raise PtmcadError("no configs/*.yaml here: name the problem records, or change to the project's folder")
    for path in found:
        load(path)
    return found


def timed(options: argparse.Namespace) -> list[Row]:
    """Whole ``ptmcad classify`` processes, with JSON only and with pictures too, against the machine's floor.

    Each row of a record without free lengths holds what ``ptmcad check`` foretells.
    """
    floor = Job("floor", "", "", ((FLOOR, ""),))
    jobs = [floor]
    slices = {path: load(path) for path in found_records(options.records)}
    with tempfile.TemporaryDirectory() as folder:
        for path, slice in slices.items():
            if slice.has_free_lengths and not options.records:
                continue  # such a map takes as long as it is given
            for formats in ("json", "json,png,svg"):
                command = (*PTMCAD, "classify", str(path), "--format", formats, "--out", folder)
                jobs.append(Job(str(path.with_suffix("")), "classify", formats, ((command, ""),)))
        turns(jobs, options)
    rows = []
    foretold = {str(path.with_suffix("")): check(slice).forecast for path, slice in slices.items()}
    for job in jobs:
        row = job.row() | {"over floor": ratio(job, floor, "seconds")}
        cost = foretold.get(job.subject)
        if cost is not None and job.setting == "json":
            row |= {"foretold s": round(cost.seconds, 2), "foretold MB": round(cost.megabytes)}
        rows.append(row)
    return rows


def ablation(options: argparse.Namespace) -> list[Row]:
    """Records with each saving switched off, and with all of them; their own engine's savings, and "imports"."""
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path in found_records(options.records):
            slice = load(path)
            exact = tuple(s.name for s in SAVINGS if s.engine is not Engine.CERTIFIED)
            parts: list[tuple[Path, Sequence[str], Sequence[str], str]] = [
                (path, (*exact, ALL), (), slice.name),
                (exchanged(path, folder), ("axis-order",), (), f"{slice.name}, axes exchanged"),
            ]
            if slice.has_free_lengths:
                names = tuple(s.name for s in SAVINGS if s.engine is Engine.CERTIFIED)
                parts = []
                for window, share in CERTIFIED.get(slice.name, ()):
                    ranges = [part for axis in window for part in ("--range", axis)]
                    more: Sequence[str] = [*ranges, "--tolerance", share, "--jobs", "1", "--timeout", str(PATIENCE)]
                    parts.append((path, (*names, ALL), more, " ".join([slice.name, *window, share])))
            for record, savings, more, subject in parts:
                rows += _without(record, subject, savings, more, folder, options)
    return rows


def _without(
    record: Path, subject: str, savings: Sequence[str], more: Sequence[str], folder: Path, options: argparse.Namespace
) -> Iterator[Row]:
    """The rows of one record: all savings made, and each switched off."""
    name = load(record).name
    made: list[Job] = []
    for saving in ("", *savings):
        target = folder / f"{len(made)}-{saving}"
        off = ("--without", saving) if saving else ()
        command = (*PTMCAD, "classify", str(record), *more, *off, "--format", "json", "--out", str(target))
        made.append(Job(subject, "classify", saving or "all made", ((command, ""),), target / f"{name}.json"))
    made[0].attempt(options.timeout)  # fills caches, and compiles
    made[0].usages.clear()
    turns(made, options)
    results = []
    for job in made:
        assert job.answer is not None
        results.append(RegionMap.from_json(job.answer.read_text(encoding="utf-8")) if job.answer.exists() else None)
    for job, result in zip(made, results, strict=True):
        row = job.row() | {"over all made": ratio(job, made[0])}
        if results[0] is not None and result is not None:
            row["differs"] = difference(results[0], result)
        yield row


def difference(one: RegionMap, other: RegionMap) -> str:
    """What two maps of one slice disagree on, whatever their decompositions; empty when they say the same.

    Guarantee
    ---------
    Empty only if the regions of both exact maps correspond one to one, with equal counts, the same
    pairs of neighbours and areas whose bounds overlap. Of certified maps it says only that no
    sample's counts contradict each other.
    """
    return next(_certified(one, other) if one.cover is not None else _exact(one, other), "")


def _exact(one: RegionMap, other: RegionMap) -> Iterator[str]:
    if len(one.regions) != len(other.regions):
        yield f"{len(one.regions)} regions and {len(other.regions)}"
        return
    pairs: set[tuple[int, int]] = set()
    for first, second, step in ((one, other, 1), (other, one, -1)):
        for cell in first.cells:
            at = second.locate(**dict(cell.sample))
            if at.region is None:  # on a curve that only one of the maps uses
                continue
            if (at.total, at.stable, at.index) != (cell.total, cell.stable, cell.index):
                yield f"other counts at {dict(cell.sample)}"
            first_region, second_region = (cell.region, at.region)[::step]
            pairs.add((first_region, second_region))
    partner = dict(pairs)
    if not len(pairs) == len(partner) == len(set(partner.values())) == len(one.regions):
        yield "the regions do not correspond"
        return
    for n, m in partner.items():
        a, b = one.regions[n], other.regions[m]
        if (a.stable, a.total, a.index) != (b.stable, b.total, b.index):
            yield f"other counts of region {n}"
        if a.area[0] > b.area[1] or b.area[0] > a.area[1]:
            yield f"another area of region {n}"
    if {frozenset(map(partner.__getitem__, pair)) for pair in neighbours(one)} != neighbours(other):
        yield "other neighbours"


def neighbours(result: RegionMap) -> set[frozenset[int]]:
    """Pairs of regions that share an arc."""
    region = [cell.region for cell in result.cells]
    return {frozenset((region[a.first], region[a.second])) for a in result.adjacencies if a.merge is Merge.SEPARATED}


def _certified(one: RegionMap, other: RegionMap) -> Iterator[str]:
    count = one.slice.count.value
    for first, second in ((one, other), (other, one)):
        for cell in first.cells:
            mine, yours = getattr(cell, count), getattr(second.locate(**dict(cell.sample)), count)
            if None not in (mine, yours) and mine != yours:
                yield f"another {count} at {dict(cell.sample)}"
