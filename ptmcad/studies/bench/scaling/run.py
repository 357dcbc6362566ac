"""The measurement of all families: rounds in shuffled order, fits, and everything as data for a file.

Guarantee: in each round every size of every family runs once, in an order drawn from the seed, so that a slow minute of
the machine hits all of them alike. Two calls with the same arguments give the same but for seconds, memory, and what is
fitted to them.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any

from ptmcad.studies.bench.rounds import rounds
from ptmcad.studies.bench.scaling.families import FAMILIES, Family, touch, warm_up
from ptmcad.studies.bench.scaling.fit import Points, fit
from ptmcad.studies.bench.scaling.measurement import Run, Unmeasured, in_child
from ptmcad.studies.bench.suite import machine, versions

FORMAT = "ptmcad-scaling/1"
ROUNDS = 3
MAX_SECONDS = 300.0
"""Wall seconds for one run."""
MIN_SECONDS = 0.002
"""A stage that never takes longer is not fitted: that is the clock's resolution and the interpreter's start of it."""
MIN_MEMORY = 1.0
"""MiB: a size below is the allocator's, not the computation's."""


def scaling(
    families: Sequence[Family] = FAMILIES,
    number: int = ROUNDS,
    seed: int = 1,
    *,
    limit: float = MAX_SECONDS,
    progress: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Measure families of slices and fit power laws to their cost.

    Parameters
    ----------
    number : runs of each size, but of a family's heavy sizes.
    seed : of slices, of the order within a round, and of the fits' resampling.
    limit : wall seconds after which a run is given up; then this size and larger ones of its family are left out.
    progress : called with what runs.

    Returns
    -------
    JSON data: ``format``, ``machine``, ``versions``, ``seed``, ``rounds``, and for each family its ``runs`` (seconds of
    processor time, MiB, what was found), the ``reasons`` for sizes that have none, and ``fits`` by quantity.
    """
    before = machine()
    progress("loading")
    warm_up(any(f.certified for f in families))
    runs: dict[str, list[Run]] = {family.name: [] for family in families}
    reasons: dict[str, dict[int, str]] = {family.name: {} for family in families}

    def due(index: int) -> list[tuple[Family, int]]:
        return [(f, size) for f in families for size in f.sizes if index == 0 or size not in f.heavy]

    for index, turns in enumerate(rounds(number, due, random.Random(seed))):
        for family, size in turns:
            if any(size >= given_up for given_up in reasons[family.name]):
                continue
            progress(f"round {index + 1} of {number}: {family.name} {size}")
            found = in_child(partial(family.measure, size, seed), limit, partial(touch, family.certified))
            if isinstance(found, Unmeasured):
                reasons[family.name][size] = found.reason
            else:
                runs[family.name] += found
    return {
        "format": FORMAT,
        "machine": before,
        "versions": versions(),
        "seed": seed,
        "rounds": number,
        "families": [_family(f, runs[f.name], reasons[f.name], seed) for f in families],
    }


def _family(family: Family, runs: Sequence[Run], reasons: dict[int, str], seed: int) -> dict[str, Any]:
    # sorted and rounded as they are stored, so that the stored runs give the stored fits
    runs = [Run(**_rounded(asdict(run))) for run in sorted(runs, key=lambda r: _order(family.against, r))]
    fits = {name: fit(points, seed) for name, points in quantities(family, runs)}
    return {
        "name": family.name,
        "title": family.title,
        "against": family.against,
        "axis": family.axis,
        "expected": family.expected,
        "runs": [asdict(run) for run in runs],
        "reasons": {str(size): reason for size, reason in sorted(reasons.items())},
        "fits": {
            name: {**{k: float(f"{v:.4g}") for k, v in asdict(f).items() if k != "verdict"}, "verdict": f.verdict.value}
            for name, f in fits.items()
            if f is not None
        },
    }


def _order(against: str, run: Run) -> tuple[float, ...]:
    return (run.size, _place(against, run), run.seconds)


def _place(against: str, run: Run) -> float:
    return run.size if against == "size" else run.found[against]


def quantities(family: Family, runs: Sequence[Run]) -> Iterator[tuple[str, Points]]:
    """What is fitted: processor time in all and by stage, memory, boxes, and wall time where that is asked for."""
    places = [_place(family.against, run) for run in runs]
    yield "seconds", [(x, run.seconds) for x, run in zip(places, runs, strict=True)]
    if family.wall:
        yield "wall", [(x, run.wall) for x, run in zip(places, runs, strict=True)]
    stages = list(dict.fromkeys(stage for run in runs for stage in run.stages))
    if len(stages) > 1:
        for stage in stages:
            points = [(x, run.stages.get(stage, 0.0)) for x, run in zip(places, runs, strict=True)]
            if any(seconds > MIN_SECONDS for _, seconds in points):
                yield stage, [(x, max(seconds, 1e-6)) for x, seconds in points]
    grown = [(x, max(run.memory.values())) for x, run in zip(places, runs, strict=True) if run.memory]
    seen = [(x, mebibytes) for x, mebibytes in grown if mebibytes >= MIN_MEMORY]
    if len({x for x, _ in seen}) > 2:
        yield "memory", seen
    if all("boxes" in run.found for run in runs):
        yield "boxes", [(x, run.found["boxes"]) for x, run in zip(places, runs, strict=True)]


def _rounded(run: dict[str, Any]) -> dict[str, Any]:
    """Seconds to 0.01 ms."""
    stages = {stage: round(seconds, 5) for stage, seconds in run["stages"].items()}
    return {**run, "seconds": round(run["seconds"], 5), "wall": round(run["wall"], 5), "stages": stages}
