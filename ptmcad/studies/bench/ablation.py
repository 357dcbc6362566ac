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
from ptmcad.process.extras import require_numba
from ptmcad.question.config import load
from ptmcad.question.savings import ALL, SAVINGS, Engine
from ptmcad.question.slice import Slice
from ptmcad.studies.bench.command import NO_RECORDS, Command, progress, save
from ptmcad.studies.bench.process import Outcome, run
from ptmcad.studies.bench.rounds import ratio, rounds, times
from ptmcad.studies.bench.sameness import difference
from ptmcad.studies.bench.suite import machine, versions
from ptmcad.studies.tables import markdown, measured_with
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

Progress = Callable[[str], None]


def ablation(
    records: Sequence[Path], number: int = 3, seed: int = 1, report: Progress = lambda _: None
) -> dict[str, Any]:
    """The benchmark as JSON data.

    Parameters
    ----------
    records : problem records; of those with free lengths only `CERTIFIED` are taken.
    number : runs of each variant of the exact engine, and of each whole process; certified variants run once.
    seed : of the order within a round.
    report : called with the name of each record.

    Raises
    ------
    PtmcadError
        When a record cannot be read or computed.
    """
    order = random.Random(seed)
    slices = {path: load(path) for path in records}
    if any(slice.name in CERTIFIED for slice in slices.values() if slice.has_free_lengths):
        require_numba()
    rows, free = [], []
    for slice in slices.values():
        report(slice.name)
        if slice.has_free_lengths:
            if slice.name in CERTIFIED:
                free += [_certified(slice, *part) for part in CERTIFIED[slice.name]]
            continue
        rows.append(_exact(slice, (*_names(Engine.EXACT), ALL), number, order))
        rows.append(_exact(exchanged(slice), SWAPPED, number, order))
    paper = [path for path, slice in slices.items() if slice.name in PAPER]
    processes = [_processes(path, slices[path].name, number, order) for path in paper]
    return {
        "format": FORMAT,
        "machine": machine(),
        "versions": versions(),
        "seed": seed,
        "rounds": number,
        "savings": [{"name": s.name, "engine": s.engine.value, "what": s.what, "why": s.why} for s in SAVINGS],
        "exact": rows,
        "processes": processes,
        "certified": free,
    }


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
        result, spent, reached = _enclosed(slice, tuple(names) if name == ALL else (name,), share)
        switched[name] = {
            "seconds": round(spent, 2),
            "reached": reached,
            "ratio": round(spent / seconds, 2),
            "difference": difference(first, result),
        }
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


def to_markdown(found: dict[str, Any]) -> str:
    """The benchmark as a page."""
    names = (*_names(Engine.EXACT), ALL)
    lines = [
        "# What each saving is worth",
        "",
        "Processor time of the computation with a saving switched off (`--without NAME`), over that with all savings",
        "made: 1.00 means that the saving is worth nothing on that slice. `all` is the plain pipeline.",
        "[plan.md](../plan.md) says what the savings are. Every map was compared with the one that all savings made:",
        "regions, counts, neighbours, areas. Made by `python -m ptmcad.studies.bench.ablation --out docs/benchmarks`.",
        "",
        f"Rounds: {found['rounds']}, seed {found['seed']}; ratios are medians of those within a round.",
        "",
    ]
    cells: list[tuple[str, ...]] = []
    for row in found["exact"]:
        off, made = row["switched off"], row["all made"]
        ratios = (f"{off[n]['ratio']:.2f}" if n in off else "" for n in names)
        same = "no" if any(v["difference"] for v in off.values()) else "yes"
        spread = f"{1000 * made['median']:.0f} ({1000 * made['least']:.0f}-{1000 * made['most']:.0f})"
        cells.append((row["record"], spread, *ratios, same))
    lines += [
        *markdown(("slice", "ms, all made (least-most)", *names, "same answer"), cells),
        "",
        "## Whole processes",
        "",
        "`ptmcad classify RECORD --format json`, processor time of everything, start-up included.",
        "",
    ]
    header = ("slice", "ms, all made", "ms, --without imports", "over", "ms, --without all", "over")
    lines += markdown(header, map(_process_cells, found["processes"]))
    lines += [*_certified_lines(found["certified"]), "", *measured_with(found)]
    return "\n".join(lines) + "\n"


def _process_cells(row: dict[str, Any]) -> tuple[str, ...]:
    off = row["switched off"]
    switched = [(f"{1000 * off[name]['median']:.0f}", f"{off[name]['ratio']:.2f}") for name in ("imports", ALL)]
    return row["record"], f"{1000 * row['all made']['median']:.0f}", *chain(*switched)


def _certified_lines(rows: Sequence[dict[str, Any]]) -> list[str]:
    if not rows:
        return []
    names = (*_names(Engine.CERTIFIED), ALL)
    lines = [
        "",
        "## The certified engine",
        "",
        "Processor time until at most a given share of the window is undetermined, in one thread, over that with all",
        f"savings made; one run each. Above a bound where {PATIENCE:.0f} seconds (of wall time) were not enough.",
        "",
    ]
    cells = []
    for row in rows:
        off = row["switched off"]
        ratios = (("" if off[n]["reached"] else "> ") + f"{off[n]['ratio']:.2f}" for n in names)
        same = "no" if any(v["difference"] for v in off.values()) else "yes"
        window = ", ".join(f"{low} < {name} < {high}" for name, (low, high) in row["window"].items())
        cells.append((row["record"], window, row["open"], f"{row['seconds']:.1f}", *ratios, same))
    return [*lines, *markdown(("slice", "window", "share", "s, all made", *names, "no contradiction"), cells)]


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print the page, write ablation.json and ablation.md; 1 when an answer differed, 2 for bad input."""
    command = Command("bench.ablation", "What each saving is worth.", files="ablation.json and ablation.md", rounds=3)
    command.add_argument("records", nargs="*", type=Path, help="problem records; default: configs/*.yaml")
    chosen = command.chosen(arguments)
    records = chosen.records or sorted(Path("configs").glob("*.yaml"))
    if not records:
        command.error(NO_RECORDS)

    def work() -> int:
        found = ablation(records, chosen.rounds, chosen.seed, progress)
        save(chosen.out, "ablation", found, to_markdown(found))
        print(to_markdown(found), end="")
        rows = (*found["exact"], *found["certified"])
        return int(any(v["difference"] for row in rows for v in row["switched off"].values()))

    return command.status(work)


if __name__ == "__main__":
    sys.exit(main())
