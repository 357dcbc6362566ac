"""A global search over exact evaluations: SciPy's differential evolution, then steps along the
parameters.

Guarantee: none of what is better elsewhere. Every design that is looked at is a rational point on a
grid of the bounds, so that its value is an exact evaluation; the same seed gives the same designs.

Reference: Storn & Price, J. Global Optimization 11 (1997), Differential evolution.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from itertools import combinations, product
from typing import Any

from ptmcad.errors import LimitReached

Point = tuple[Fraction, ...]
Evaluate = Callable[[Point], Fraction | None]
GRID = 2**12
"""Steps between the bounds on which the global search looks; `_climb` halves them further."""
FINEST = 2**20
_CORNERS = 4
"""Parameters up to which all corners of the bounds are looked at."""
_CLIMBING = Fraction(1, 2)
"""Share of the evaluations for the climb."""


def best_of(evaluate: Evaluate, number: int, seed: int, evaluations: int) -> None:
    """Look for the best point of the unit cube.

    Parameters
    ----------
    evaluate : of points of the cube; None for one without a value. It keeps what it found, and may
        raise `LimitReached`.
    number : of parameters.
    evaluations : at most so many points, for the global search and for the climb.
    """
    best: list[tuple[Fraction, Point]] = []
    seen: dict[Point, Fraction | None] = {}
    left = [int(evaluations * (1 - _CLIMBING))]

    def look(point: Point) -> Fraction | None:
        if point not in seen:
            if left[0] <= 0:
                raise LimitReached("the evaluations are used up")
            left[0] -= 1
            value = seen[point] = evaluate(point)
            if value is not None and (not best or value > best[0][0]):
                best[:] = [(value, point)]
        return seen[point]

    for search in (
        partial(_evolve, look, number, seed, evaluations),
        partial(_climb, look, best),
    ):
        try:
            search()
        except LimitReached:
            if left[0] > 0:
                raise  # the caller's
        left[0] = evaluations - len(seen)


def _evolve(look: Evaluate, number: int, seed: int, evaluations: int) -> None:
    """Differential evolution from the corners, the middle and random points."""
    import numpy as np
    from scipy.optimize import differential_evolution

    def fitness(at: Any) -> float:
        value = look(tuple(Fraction(round(min(max(float(u), 0.0), 1.0) * GRID), GRID) for u in at))
        return _NOTHING if value is None else -float(value)

    source = np.random.default_rng(seed)
    corners = list(product((0.0, 1.0), repeat=number)) if number <= _CORNERS else []
    start = [*corners, (0.5,) * number]
    size = max(4 * number + 4, len(start) + 4)
    rest = source.random((size - len(start), number))
    differential_evolution(
        fitness,
        [(0.0, 1.0)] * number,
        init=np.vstack([np.array(start), rest]),
        seed=source,
        polish=False,
        tol=0.0,
        maxiter=max(1, evaluations // size),
    )


_NOTHING = 1e100


def _climb(look: Evaluate, best: Sequence[tuple[Fraction, Point]]) -> None:
    """Steps from the best point along each parameter and across two of them, as ridges run; longer after one that leads
    higher.
    """
    if not best:
        return
    value, point = best[0]
    ways = _ways(len(point))
    step = Fraction(1, 64)
    while step * FINEST >= 1:
        for number, way in enumerate(ways):
            # a step, at most to the bounds
            moved = (at + sign * step for at, sign in zip(point, way, strict=True))
            other = tuple(min(max(at, Fraction(0)), Fraction(1)) for at in moved)
            found = None if other == point else look(other)
            if found is not None and found > value:
                value, point = found, other
                ways = [way, *ways[:number], *ways[number + 1 :]]  # first the way that led higher
                step = min(2 * step, Fraction(1, 8))
                break
        else:
            step /= 2


def _ways(number: int) -> list[tuple[int, ...]]:
    """The directions of steps, each with its opposite."""
    single = [{k: sign} for k in range(number) for sign in (1, -1)]
    double = [
        {j: a, k: b}
        for j, k in combinations(range(number), 2)
        for a, b in product((1, -1), repeat=2)
    ]
    return [tuple(way.get(k, 0) for k in range(number)) for way in (*single, *double)]


def within(bounds: Sequence[tuple[Fraction, Fraction]], point: Point) -> Point:
    """A point of the unit cube as one within the bounds."""
    return tuple(low + (high - low) * u for (low, high), u in zip(bounds, point, strict=True))
