"""What each saving is worth: ``python -m ptmcad.studies.bench.ablation`` switches them off one by one, and all of them.

Guarantee: every map that is timed was compared with the one that all savings made (`ptmcad.studies.bench.sameness`). In
each round every variant runs once, in an order drawn from the seed; ratios are medians of the ratios within a round, of
processor time. All but times and ratios is the same in the next run.
"""

from __future__ import annotations

import random
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import chain
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import LimitReached, PtmcadError
from ptmcad.process.extras import Extra, require
from ptmcad.question.config import load
from ptmcad.question.savings import ALL, SAVINGS, Engine
from ptmcad.question.slice import Slice
from ptmcad.studies.bench.harness import Command, Record, made_with, progress, ratio, rounds, times
from ptmcad.studies.bench.process import Outcome, run
from ptmcad.studies.bench.sameness import difference
from ptmcad.studies.tables import markdown, measured_with, page
from ptmcad.text.expressions import Expression

FORMAT = "ptmcad-ablation/1"
PAPER = ("fig2", "fig3", "fig4", "fig5-caption", "fig5-text")
"""Records that are also timed as whole processes."""
Part = tuple[tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]] | None, Fraction]
_SHORT_BASE = ((Fraction(1, 20), Fraction(1, 2)), (Fraction(5, 4), Fraction(2)))
_LONG_BASE = ((Fraction(1), Fraction(2)), (Fraction(1), Fraction(2)))
CERTIFIED: dict[str, tuple[Part, ...]] = {
    "free02": ((_SHORT_BASE, Fraction(1, 20)), (None, Fraction(1, 1000))),
    "free02-unloaded": ((_SHORT_BASE, Fraction(1, 20)), (_LONG_BASE, Fraction(1, 1000))),
}
"""Records over rho and L2 on which the certified engine's savings are measured: windows, the record's own where there
is None, and the undetermined share at which to stop."""
PATIENCE = 30.0
"""Seconds after which a certified run without a saving is given up."""
SWAPPED = ("axis-order",)
"""Savings that are measured with the axes exchanged as well, as the records give the better order first."""


def ablation(records: Sequence[Path], number: int = 3, seed: int = 1) -> Record:
    """The benchmark as JSON data.

    Parameters
    ----------
    records : problem records; of those with free lengths only `CERTIFIED` are taken.
    number : runs of each variant of the exact engine, and of each whole process; certified variants run once.
    seed : of the order within a round.

    Raises
    ------
    PtmcadError
        When a record cannot be read or computed.
    """
    order = random.Random(seed)
    slices = {path: load(path) for path in records}
    if any(slice.name in CERTIFIED for slice in slices.values() if slice.has_free_lengths):
        require(Extra.certified)
    found: Record = {
        "format": FORMAT, **made_with(), "seed": seed, "rounds": number,
        "savings": [{"name": s.name, "engine": s.engine.value, "what": s.what, "why": s.why} for s in SAVINGS],
        "exact": [], "processes": [], "certified": [],
    }  # fmt: skip
    for path, slice in slices.items():
        progress(slice.name)
        if slice.has_free_lengths:
            found["certified"] += [_certified(slice, *part) for part in CERTIFIED.get(slice.name, ())]
            continue
        found["exact"].append(_exact(slice, (*_names(Engine.EXACT), ALL), number, order))
        found["exact"].append(_exact(exchanged(slice), SWAPPED, number, order))
        if slice.name in PAPER:
            found["processes"].append(_processes(path, slice.name, number, order))
    return found


def exchanged(slice: Slice) -> Slice:
    """The slice with its axes exchanged."""

    def turned(e: Expression) -> Expression:
        numerator, denominator = (tuple(sorted((j, i, c) for i, j, c in part)) for part in (e.numerator, e.denominator))
        return Expression(numerator, denominator)

    return replace(
        slice,
        name=f"{slice.name}, axes exchanged",
        axes=(slice.axes[1], slice.axes[0]),
        parameters={name: turned(e) for name, e in slice.parameters.items()},
    )


def _names(engine: Engine) -> tuple[str, ...]:
    return tuple(s.name for s in SAVINGS if s.engine is engine)


def _exact(slice: Slice, names: Sequence[str], number: int, order: random.Random) -> dict[str, Any]:
    """One slice by the exact engine: every variant compared, then timed."""
    from ptmcad.ask.classification import classify

    result = classify(slice)
    variants: dict[str, tuple[str, ...]] = {"": (), **{name: (name,) for name in names}}
    differences = {
        name: difference(result, classify(slice, without=without)) for name, without in variants.items() if name
    }

    def seconds(without: tuple[str, ...]) -> float:
        start = process_time()
        classify(slice, without=without)
        return process_time() - start

    timed = _timed({name: partial(seconds, without) for name, without in variants.items()}, number, order)
    for name, found in timed["switched off"].items():
        found["difference"] = differences[name]
    return {"record": slice.name, "regions": len(result.regions), "cells": len(result.cells), **timed}


def _timed(variants: Mapping[str, Callable[[], float]], number: int, order: random.Random) -> dict[str, Any]:
    """The times of variants that take turns: of the one without a name, and of the others beside it."""
    seconds: dict[str, list[float]] = {name: [] for name in variants}
    for turns in rounds(number, lambda _: list(variants), order):
        for name in turns:
            seconds[name].append(variants[name]())
    made = seconds.pop("")
    return {
        "all made": _summary(made),
        "switched off": {
            name: _summary(these) | {"ratio": round(ratio(these, made), 3)} for name, these in seconds.items()
        },
    }


def _summary(seconds: Sequence[float]) -> dict[str, Any]:
    found = times(seconds)
    return {"median": found.median, "least": found.minimum, "most": found.maximum}


def _processes(path: Path, record: str, number: int, order: random.Random) -> dict[str, Any]:
    """Whole processes that write JSON: with all savings, with everything imported, and without any saving."""
    with tempfile.TemporaryDirectory() as folder:
        command = (sys.executable, "-m", "ptmcad", "classify", str(path.resolve()), "--format", "json", "--out", folder)

        def seconds(*options: str) -> float:
            usage = run((*command, *options), timeout=120)
            if usage.outcome is not Outcome.DONE:
                raise PtmcadError(f"{record}: {usage.outcome.value}: {usage.message}")
            return usage.processor_seconds

        variants: dict[str, Callable[[], float]] = {"": seconds}
        for name in ("imports", ALL):
            variants[name] = partial(seconds, "--without", name)
        _timed(variants, 1, order)  # warms the caches
        return {"record": record, **_timed(variants, number, order)}


def _certified(
    slice: Slice, window: tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]] | None, share: Fraction
) -> dict[str, Any]:
    """A part of one slice by the certified engine, in one thread, until a share of the window is undetermined."""
    if window is not None:
        first_axis, second_axis = (replace(a, low=w[0], high=w[1]) for a, w in zip(slice.axes, window, strict=True))
        slice = replace(slice, axes=(first_axis, second_axis))
    names = _names(Engine.CERTIFIED)
    _enclosed(slice, (), Fraction(9, 10))  # loads the compiled code, or compiles it
    first, seconds, _ = _enclosed(slice, (), share)
    switched = {}
    for name in (*names, ALL):
        result, spent, reached = _enclosed(slice, names if name == ALL else (name,), share)
        switched[name] = {"seconds": round(spent, 2), "reached": reached, "ratio": round(spent / seconds, 2),
                          "difference": difference(first, result)}  # fmt: skip
    return {
        "record": slice.name,
        "window": {a.name: [str(a.low), str(a.high)] for a in slice.axes},
        "open": str(share),
        "seconds": round(seconds, 2),
        "switched off": switched,
    }


def _enclosed(slice: Slice, without: tuple[str, ...], share: Fraction) -> tuple[RegionMap, float, bool]:
    """The map, the processor seconds it took, and whether the share was reached before patience ended."""
    from ptmcad.ask.classification import classify

    start, begun = process_time(), perf_counter()
    try:
        result = classify(slice, tolerance=share, jobs=1, without=without, timeout=PATIENCE)
    except LimitReached as stopped:
        if not isinstance(stopped.partial, RegionMap) or perf_counter() - begun < PATIENCE / 2:
            raise
        return stopped.partial, process_time() - start, False
    return result, process_time() - start, True


_INTRODUCTION = """
Processor time of the computation with a saving switched off (`--without NAME`), over that with all savings
made: 1.00 means that the saving is worth nothing on that slice. `all` is the plain pipeline.
[plan.md](../plan.md) says what the savings are. Every map was compared with the one that all savings made:
regions, counts, neighbours, areas. Made by `python -m ptmcad.studies.bench.ablation --out docs/benchmarks`.
"""


def to_markdown(found: Record) -> str:
    """The benchmark as a page."""
    names = (*_names(Engine.EXACT), ALL)
    cells = []
    for row in found["exact"]:
        made = row["all made"]
        spread = f"{1000 * made['median']:.0f} ({1000 * made['least']:.0f}-{1000 * made['most']:.0f})"
        cells.append((row["record"], spread, *_ratios(row, names), "no" if differs(row) else "yes"))
    header = ("slice", "ms, all made", "ms, --without imports", "over", "ms, --without all", "over")
    return page(
        "# What each saving is worth",
        _INTRODUCTION,
        f"Rounds: {found['rounds']}, seed {found['seed']}; ratios are medians of those within a round.",
        markdown(("slice", "ms, all made (least-most)", *names, "same answer"), cells),
        "## Whole processes",
        "`ptmcad classify RECORD --format json`, processor time of everything, start-up included.",
        markdown(header, map(_process_cells, found["processes"])),
        *_certified_blocks(found["certified"]),
        *measured_with(found),
    )


def differs(row: Record) -> bool:
    """Whether an answer without some saving is another."""
    return any(variant["difference"] for variant in row["switched off"].values())


def _ratios(row: Record, names: Sequence[str]) -> list[str]:
    """Times over that with all savings, above a bound where patience ended; empty for what was not measured."""
    found = [row["switched off"].get(name) for name in names]
    return [f"{'' if v.get('reached', True) else '> '}{v['ratio']:.2f}" if v else "" for v in found]


def _process_cells(row: Record) -> tuple[str, ...]:
    off = row["switched off"]
    switched = [(f"{1000 * off[name]['median']:.0f}", f"{off[name]['ratio']:.2f}") for name in ("imports", ALL)]
    return row["record"], f"{1000 * row['all made']['median']:.0f}", *chain(*switched)


def _certified_blocks(rows: Sequence[Record]) -> list[str | list[str]]:
    if not rows:
        return []
    names = (*_names(Engine.CERTIFIED), ALL)
    cells = []
    for row in rows:
        window = ", ".join(f"{low} < {name} < {high}" for name, (low, high) in row["window"].items())
        same = "no" if differs(row) else "yes"
        cells.append((row["record"], window, row["open"], f"{row['seconds']:.1f}", *_ratios(row, names), same))
    return [
        "## The certified engine",
        "Processor time until at most a given share of the window is undetermined, in one thread, over that with all\n"
        f"savings made; one run each. Above a bound where {PATIENCE:.0f} seconds (of wall time) were not enough.",
        markdown(("slice", "window", "share", "s, all made", *names, "no contradiction"), cells),
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print the page, write ablation.json and ablation.md; 1 when an answer differed, 2 for bad input."""
    command = Command("bench.ablation", "What each saving is worth.", "ablation", rounds=3)
    command.add_argument("records", nargs="*", type=Path, help="problem records; default: configs/*.yaml")
    chosen = command.chosen(arguments)
    records = command.records(chosen.records, lambda slice: True)
    return command.status(
        chosen.out,
        lambda: ablation(records, chosen.rounds, chosen.seed),
        to_markdown,
        wrong=lambda found: any(map(differs, (*found["exact"], *found["certified"]))),
    )


if __name__ == "__main__":
    sys.exit(main())
