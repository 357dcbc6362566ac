"""Shipped records as whole processes: time, memory and forecasts; and what each saving is worth.

Guarantee: of an ablation every map that is timed was compared with the one that all savings made (`difference`); ratios
are medians of the ratios within a round, of processor time.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from ptmcad.answer.regionmap import Merge, RegionMap
from ptmcad.ask.checking import check
from ptmcad.errors import PtmcadError
from ptmcad.question.config import load
from ptmcad.question.savings import ALL, SAVINGS, Engine
from ptmcad.studies.bench.harness import PTMCAD, Job, summary, turns

FLOOR = (sys.executable, "-c", "import flint, numpy, click, yaml")
TOLERANCE, PATIENCE = "1/20", 30
"""The share at which a certified run of an ablation stops, and the seconds."""


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


def timed(options: argparse.Namespace) -> pd.DataFrame:
    """Whole ``ptmcad classify`` processes, with JSON only and with pictures too, against the machine's floor.

    Each row of a record without free lengths holds what ``ptmcad check`` foretells.
    """
    jobs = [Job("floor", "", "", FLOOR)]
    slices = {str(path.with_suffix("")): (path, load(path)) for path in found_records(options.records)}
    with tempfile.TemporaryDirectory() as folder:
        for subject, (path, slice) in slices.items():
            if slice.has_free_lengths and not options.records:
                continue  # such a map takes as long as it is given
            for formats in ("json", "json,png,svg"):
                command = (*PTMCAD, "classify", str(path), "--format", formats, "--out", folder)
                jobs.append(Job(subject, "classify", formats, command))
        turns(jobs, options)
    rows = summary(jobs, "floor", "seconds")
    foretold = {subject: check(slice).forecast for subject, (_, slice) in slices.items()}
    costs = [foretold.get(job.subject) if job.setting == "json" else None for job in jobs]
    rows["foretold s"] = [cost and round(cost.seconds, 2) for cost in costs]
    rows["foretold MB"] = [cost and round(cost.megabytes) for cost in costs]
    return rows


def ablation(options: argparse.Namespace) -> pd.DataFrame:
    """Records with each saving switched off, and with all of them; their own engine's savings, and "imports"."""
    tables = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path in found_records(options.records):
            slice = load(path)
            if slice.has_free_lengths:
                savings = [s.name for s in SAVINGS if s.engine is Engine.CERTIFIED]
                more = ["--tolerance", TOLERANCE, "--jobs", "1", "--timeout", str(PATIENCE)]
                tables.append(_without(path, slice.name, [*savings, ALL], more, folder, options))
            else:
                savings = [s.name for s in SAVINGS if s.engine is not Engine.CERTIFIED]
                tables.append(_without(path, slice.name, [*savings, ALL], [], folder, options))
                turned = exchanged(path, folder)
                tables.append(_without(turned, f"{slice.name}, axes exchanged", ["axis-order"], [], folder, options))
    return pd.concat(tables)


def _without(
    record: Path, subject: str, savings: Sequence[str], more: Sequence[str], folder: Path, options: argparse.Namespace
) -> pd.DataFrame:
    """The rows of one record: all savings made, and each switched off."""
    name = load(record).name
    made: list[Job] = []
    for saving in ("", *savings):
        target = folder / f"{len(made)}-{saving}"
        off = ("--without", saving) if saving else ()
        command = (*PTMCAD, "classify", str(record), *more, *off, "--format", "json", "--out", str(target))
        made.append(Job(subject, "classify", saving or "all made", command, answer=target / f"{name}.json"))
    made[0].attempt(options.timeout)  # fills caches, and compiles
    made[0].usages.clear()
    turns(made, options)
    results = [RegionMap.from_json(job.said()) if job.usages else None for job in made]
    rows = summary(made, "all made")
    rows["differs"] = [
        None if results[0] is None or result is None else difference(results[0], result) for result in results
    ]
    return rows


def exchanged(record: Path, folder: Path) -> Path:
    """The record with its axes exchanged."""
    data: dict[str, Any] = yaml.safe_load(record.read_text(encoding="utf-8"))
    data["axes"] = dict(reversed(data["axes"].items()))
    model = data.get("mechanism")
    if isinstance(model, str) and (beside := record.resolve().parent / model).is_file():
        data["mechanism"] = str(beside)
    target = folder / f"exchanged-{record.name}"
    target.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
    return target


def difference(one: RegionMap, other: RegionMap) -> str:
    """What two maps of one slice disagree on, whatever their decompositions; empty when they say the same.

    Guarantee
    ---------
    Empty only if no sample's counts contradict each other, and if the regions of exact maps correspond one to one, with
    the same pairs of neighbours and areas whose bounds overlap.
    """
    pairs: set[tuple[int, int]] = set()
    for first, second in ((one, other), (other, one)):
        for cell in first.cells:
            at = second.locate(**dict(cell.sample))
            counts = ((cell.total, at.total), (cell.stable, at.stable), (cell.index, at.index))
            if at.region is None:  # on a curve that only one of the maps uses, or undecided
                continue
            if any(mine != yours and None not in (mine, yours) for mine, yours in counts):
                return f"other counts at {dict(cell.sample)}"
            pairs.add((cell.region, at.region) if first is one else (at.region, cell.region))
    if one.cover is not None:
        return ""
    partner = dict(pairs)
    if not len(pairs) == len(partner) == len(set(partner.values())) == len(one.regions) == len(other.regions):
        return f"{len(one.regions)} regions and {len(other.regions)}, which do not correspond"
    for n, m in partner.items():
        (low, high), (least, most) = one.regions[n].area, other.regions[m].area
        if low > most or least > high:
            return f"another area of region {n}"
    pairs_of_one = {frozenset(map(partner.__getitem__, pair)) for pair in neighbours(one)}
    return "" if pairs_of_one == neighbours(other) else "other neighbours"


def neighbours(result: RegionMap) -> set[frozenset[int]]:
    """Pairs of regions that share an arc."""
    region = [cell.region for cell in result.cells]
    return {frozenset((region[a.first], region[a.second])) for a in result.adjacencies if a.merge is Merge.SEPARATED}
