"""Curves at which a spring with a free length has no length, where solutions that have one there
are swallowed.

Guarantee: each point of the window at which a solution is swallowed by a spring's cone lies on the
projection of one of the curves (docs/soundness.md, Theorem 2).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ptmcad.certified.curve import CriticalCurve
from ptmcad.certified.plain.angle import Unknown
from ptmcad.certified.plain.bounds import TURN
from ptmcad.certified.plain.chart import SpringChart, chart
from ptmcad.certified.plain.curvesearch import CurveSearch, Pruning
from ptmcad.certified.plain.involution import square_of
from ptmcad.certified.plain.problem import FIRST, SpringCone
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.formulas.graph import Formula, Graph


def cones(search: CurveSearch, whole: SpringChart) -> Iterator[CriticalCurve]:
    """Equilibria that come to a configuration in which a spring with a free length has none."""
    closing = search.problem.closing
    for s, cone in enumerate(search.problem.cones):
        moving = whole.cones[s].active
        name = f"point where spring {cone.name} has no length{search.problem.where}"
        reason = f"an equilibrium is swallowed where spring {cone.name} has no length"
        if len(search.problem.unknowns) - closing == 1:
            # of one degree of freedom two equations d = 0 leave curves and need no direction
            equations = [
                *whole.equations[:closing],
                *_without_length(cone.difference, whole.unknowns),
            ]
            pruning = Pruning(costly=whole.equations[closing:], nonnegative=search.values(whole))
            yield search.curve(name, reason, equations, pruning)
        elif len(moving) == 1 and search.problem.is_gradient and not search.stable:
            yield _crease(search, cone, *moving)
        else:
            at = chart(search.exact, s)
            equations = [*_without_length(cone.difference, at.unknowns), *at.equations]
            minima = at.diagonal_times_length(s) if search.stable else ()
            pruning = Pruning(costly=at.balances, nonnegative=[*minima, *search.values(at)])
            yield search.curve(name, reason, equations, pruning, (*search.ranges, TURN))


def _without_length(
    parts: Sequence[TrigonometricPolynomial], unknowns: Sequence[Unknown]
) -> list[Formula]:
    """What is zero where some polynomials are; one that is zero everywhere says nothing."""
    return [f for f in (part.formula(unknowns) for part in parts) if f.value != 0]


def _crease(search: CurveSearch, cone: SpringCone, moving: int) -> CriticalCurve:
    """All configurations in which a spring that one unknown alone moves has no length, whether it
    is balanced or not.

    That is a curve by itself: other springs without length there do not matter. Where the unknown
    turns a vector that is always as long, this is as long as the rest on it, and the unknown drops
    out.
    """
    x, y = cone.difference
    gap = square_of((x.still, y.still)) - square_of((x - x.still, y - y.still))
    drops = bool(gap.terms) and gap == gap.still
    unknowns = [Graph().variable(FIRST)] * len(search.ranges)
    return search.curve(
        f"crease where spring {cone.name} has no length{search.problem.where}",
        f"spring {cone.name} has no length, whatever the other unknowns are",
        _without_length((gap,) if drops else (x, y), unknowns),
        Pruning(),
        () if drops else (search.ranges[moving],),
    )
