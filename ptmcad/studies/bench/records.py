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

import pandas as pd

from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.checking import check
from ptmcad.ask.comparison import compare
from ptmcad.errors import PtmcadError
from ptmcad.question.config import load
from ptmcad.question.savings import ALL, SAVINGS, Engine
from ptmcad.question.slice import Slice
from ptmcad.studies.bench.harness import PTMCAD, Job, summary, turns

FLOOR = (sys.executable, "-c", "import flint, numpy, click, yaml")
LIMITS = ("--tolerance", "1/20", "--jobs", "1", "--timeout", "30")
"""Of certified runs of an ablation."""


def slices_of(given: Sequence[Path]) -> dict[Path, Slice]:
    """The records that are given, else those in configs/.

    Raises
    ------
    PtmcadError
        When there are none, or one cannot be read.
    """
    found = given or sorted(Path("configs").glob("*.yaml"))
    if not found:
        raise PtmcadError("no configs/*.yaml here: name the problem records, or change to the project's folder")
    return {path: load(path) for path in found}


def timed(options: argparse.Namespace) -> pd.DataFrame:
    """Whole ``ptmcad classify`` processes, with JSON only and with pictures too, against the machine's floor.

    Each row of a record without free lengths holds what ``ptmcad check`` foretells.
    """
    jobs, foretold = [Job("floor", "", "", FLOOR)], {}
    with tempfile.TemporaryDirectory() as folder:
        for path, slice in slices_of(options.records).items():
            if slice.has_free_lengths and not options.records:
                continue  # such a map takes as long as it is given
            foretold[len(jobs)] = check(slice).forecast
            for formats in ("json", "json,png,svg"):
                command = (*PTMCAD, "classify", str(path), "--format", formats, "--out", folder)
                jobs.append(Job(str(path.with_suffix("")), "classify", formats, command))
        turns(jobs, options)
    rows = summary(jobs, "floor", "seconds")
    costs = {number: cost for number, cost in foretold.items() if cost is not None}
    rows["foretold s"] = pd.Series({number: round(cost.seconds, 2) for number, cost in costs.items()}, dtype=float)
    rows["foretold MB"] = pd.Series({number: round(cost.megabytes) for number, cost in costs.items()}, dtype="Int64")
    return rows


def ablation(options: argparse.Namespace) -> pd.DataFrame:
    """Records with each saving switched off, and with all of them; their own engine's savings, and "imports"."""
    tables = []
    with tempfile.TemporaryDirectory() as name:
        for path, slice in slices_of(options.records).items():
            savings = [s.name for s in SAVINGS if (s.engine is Engine.CERTIFIED) == slice.has_free_lengths]
            more = LIMITS if slice.has_free_lengths else ()
            tables.append(_without(path, slice.name, [*savings, ALL], more, Path(name), options))
            if not slice.has_free_lengths:
                turned = ("--slice", ",".join(slice.axis_names[::-1]))
                subject = f"{slice.name}, axes exchanged"
                tables.append(_without(path, subject, ["axis-order"], turned, Path(name), options))
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


def difference(one: RegionMap, other: RegionMap) -> str:
    """Where two maps of one slice have other counts, whatever their decompositions; empty when nowhere.

    Raises
    ------
    ConfigError
        When one of them is not complete.
    """
    changes = compare(one, other).changes
    return (
        f"other counts on {len(changes)} parts, the largest of area {float(changes[0].area[1]):.3g}" if changes else ""
    )
