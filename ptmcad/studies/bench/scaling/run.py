"""The measurement of all families: rounds in shuffled order, fits, and everything as data for a file.

Guarantee: in each round every size of every family runs once, in an order drawn from the seed, so that a slow minute of
the machine hits all of them alike. Two calls with the same arguments give the same but for seconds, memory, and what is
fitted to them.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from functools import partial

from ptmcad.studies.bench.harness import Record, made_with, progress, rounds
from ptmcad.studies.bench.scaling.families import FAMILIES, Family, touch, warm_up
from ptmcad.studies.bench.scaling.fit import Points, fit
from ptmcad.studies.bench.scaling.measurement import Run, in_child

FORMAT = "ptmcad-scaling/1"
ROUNDS = 3
MAX_SECONDS = 300.0
"""Wall seconds for one run."""
MIN_SECONDS = 0.002
"""A stage that never takes longer is not fitted: that is the clock's resolution and the interpreter's start of it."""
MIN_MEMORY = 1.0
"""MiB: a size below is the allocator's, not the computation's."""


def scaling(
    families: Sequence[Family] = FAMILIES, number: int = ROUNDS, seed: int = 1, limit: float = MAX_SECONDS
) -> Record:
    """Measure families of slices and fit power laws to their cost.

    Parameters
    ----------
    number : runs of each size, but of a family's heavy sizes.
    seed : of slices, of the order within a round, and of the fits' resampling.
    limit : wall seconds after which a run is given up; then this size and larger ones of its family are left out.

    Returns
    -------
    JSON data: ``format``, ``machine``, ``versions``, ``seed``, ``rounds``, and for each family its ``runs`` (seconds of
    processor time, MiB, what was found), the ``reasons`` for sizes that have none, and ``fits`` by quantity.
    """
    made = made_with()
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
            if isinstance(found, str):
                reasons[family.name][size] = found
            else:
                runs[family.name] += found
    measured = [_family(f, runs[f.name], reasons[f.name], seed) for f in families]
    return {"format": FORMAT, **made, "seed": seed, "rounds": number, "families": measured}


def _family(family: Family, runs: Sequence[Run], reasons: dict[int, str], seed: int) -> Record:
    # sorted and rounded as they are stored, so that the stored runs give the stored fits
    runs = [_rounded(run) for run in sorted(runs, key=lambda r: (r.size, _place(family.against, r), r.seconds))]
    fits = {name: fit(points, seed) for name, points in quantities(family, runs)}
    return {
        **{name: getattr(family, name) for name in ("name", "title", "against", "axis", "expected")},
        "runs": [asdict(run) for run in runs],
        "reasons": {str(size): reason for size, reason in sorted(reasons.items())},
        "fits": {
            name: {**{k: float(f"{v:.4g}") for k, v in asdict(f).items() if k != "verdict"}, "verdict": f.verdict.value}
            for name, f in fits.items()
            if f is not None
        },
    }


def _place(against: str, run: Run) -> float:
    return run.size if against == "size" else run.found[against]


def quantities(family: Family, runs: Sequence[Run]) -> Iterator[tuple[str, Points]]:
    """What is fitted: processor time in all and by stage, memory, boxes, and wall time where that is asked for."""

    def points(value: Callable[[Run], float]) -> Points:
        return [(_place(family.against, run), value(run)) for run in runs]

    yield "seconds", points(lambda run: run.seconds)
    if family.wall:
        yield "wall", points(lambda run: run.wall)
    stages = list(dict.fromkeys(stage for run in runs for stage in run.stages))
    for stage in stages if len(stages) > 1 else ():
        if any(run.stages.get(stage, 0.0) > MIN_SECONDS for run in runs):
            yield stage, points(lambda run, stage=stage: max(run.stages.get(stage, 0.0), 1e-6))  # type: ignore[misc]
    seen = [(x, y) for x, y in points(lambda run: max(run.memory.values(), default=0.0)) if y >= MIN_MEMORY]
    if len({x for x, _ in seen}) > 2:
        yield "memory", seen
    if all("boxes" in run.found for run in runs):
        yield "boxes", points(lambda run: run.found["boxes"])


def _rounded(run: Run) -> Run:
    """Seconds to 0.01 ms."""
    stages = {stage: round(seconds, 5) for stage, seconds in run.stages.items()}
    return replace(run, seconds=round(run.seconds, 5), wall=round(run.wall, 5), stages=stages)
