"""Folds of a problem that an involution leaves as it is, in coordinates that are regular at its
fixed points.

Guarantee: each point of the window at which equilibria, or minima, about the fixed points meet
others lies on the projection of one of the curves (Lemmas Q1 to Q3 of docs/soundness.md).

In coordinates e that the involution keeps and o that it takes to -o, about a component o = 0 of its
fixed points, the energy U is even in o. On the component the Hessian has two blocks: equilibria
meet within it where that of e is singular, and they part with others, each the other's image, where
that of o is. There the Jacobian of U_e, U_o and det H loses rank. Off the component some |o_i| is
largest: with that one r > 0 and o = r w, U is a smooth function u(e, v, w) of v = r^2, and its
derivatives by w are v times smooth functions g. The equilibria are the zeros of u_e, u_v and g, and
they meet where a matrix is singular that is smooth at v = 0, too.

References
----------
Golubitsky, Stewart & Schaeffer, Singularities and Groups in Bifurcation Theory II (1988), chapter
XIII.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from ptmcad.certified.plain.geometry import FactoredProblem, Matrix
from ptmcad.certified.plain.mirrors import MirrorFrame
from ptmcad.certified.plain.opening import (
    Coordinates,
    UnfoldedEnergy,
    coordinates,
    opening,
    stiffness,
)
from ptmcad.certified.plain.problem import Range
from ptmcad.certified.plain.springchart import SpringChart, chart, principal_minors
from ptmcad.formulas.graph import Formula, determinant

NEAR_SQUARED = Fraction(1, 1024)
"""The square of the distance from their images below which configurations are searched about the
fixed points."""
MAX_ODD = 0.0314
"""A little more than the odd coordinates there, whose sines are at most 1/32, or shares of the
reach; and than twice the tangents of half of these. To be changed with `NEAR_SQUARED`.
"""


@dataclass(frozen=True, slots=True)
class SymmetricFold:
    """Where minima meet others, in coordinates of their own.

    Attributes
    ----------
    at : the problem's formulas in these coordinates.
    equations : as many as there are coordinates, and one more.
    vanishing : cheap and costly formulas that vanish there, besides the problem's.
    nonnegative : what is not negative there.
    ranges : of the coordinates.
    """

    name: str
    reason: str
    at: SpringChart
    equations: tuple[Formula, ...]
    vanishing: tuple[Sequence[Formula], Sequence[Formula]]
    nonnegative: tuple[Formula, ...]
    ranges: tuple[Range, ...]


def folds(
    exact: FactoredProblem, frame: MirrorFrame, *, stable: bool, only_near: bool
) -> Iterator[SymmetricFold]:
    """Folds about a component of the fixed points, on it and off it.

    Parameters
    ----------
    stable : whether only those of minima are asked for.
    only_near : whether only those are asked for that are as near as `NEAR_SQUARED` says.
    """
    for fold in (
        *_fixed(exact, frame),
        *(_moved(exact, frame, lead, only_near) for lead in range(len(frame.reaches))),
    ):
        kind, _, _ = fold.name.partition(" ")
        yield (
            fold
            if stable
            else replace(fold, name=kind, reason="equilibria meet: det H = 0", nonnegative=())
        )


def _fixed(exact: FactoredProblem, frame: MirrorFrame) -> Iterator[SymmetricFold]:
    """Folds on the component itself."""
    place = coordinates(frame, 0)
    at = chart(exact, unknowns=frame.unknowns(place.evens, (), place.graph))
    there = at.matrix_at_equilibrium()
    across = [stiffness(place, [cone.vector for cone in at.cones])] if len(frame.odds) == 1 else []
    balance = [at.equations[e[0][0]] for e in frame.evens]
    for parting in (False, True) if balance else (True,):
        block, other = (frame.odds, frame.evens) if parting else (frame.evens, frame.odds)
        singular, known = (
            determinant(frame.block(h, block, at.scales, over=True)) for h in (at.hessian, there)
        )
        zero = across[0] if parting and across else singular
        yield SymmetricFold(
            f"{'pitchfork' if parting else 'fold'} of a stable equilibrium that is its own image",
            "a minimum parts with two others, or meets two saddles, that are each other's images"
            if parting
            else "a minimum meets a saddle, and both are their own images",
            at,
            (*balance, zero),
            ((), (known, at.levelled())),
            (
                *(() if parting else across),
                *principal_minors(frame.block(there, block, at.scales, over=True)),
                *principal_minors(frame.block(there, other, at.scales, over=True), whole=True),
            ),
            frame.ranges,
        )


def _moved(exact: FactoredProblem, frame: MirrorFrame, lead: int, only_near: bool) -> SymmetricFold:
    """Folds off it, each for its image, too: where the odd coordinate of number ``lead`` is the
    largest.
    """
    place = coordinates(frame, lead)
    at = chart(exact, unknowns=place.unknowns())
    most = MAX_ODD if place.is_turning or frame.reaches[lead] else MAX_ODD / 2
    opened = opening(place, [cone.vector for cone in at.cones])
    matrix = _matrix(place, opened, frame.block(at.hessian, frame.evens, at.scales, over=False))
    balance = [
        sum((s * at.equations[k] for k, s in e[1:]), start=at.equations[e[0][0]])
        for e in frame.evens
    ]
    return SymmetricFold(
        "fold of a stable equilibrium that is not its own image",
        "a minimum meets a saddle: det H = 0 with no negative principal minor; so do their images",
        at,
        (*balance, opened.slope, *opened.ratios, determinant(matrix)),
        (at.equations, ()),
        tuple(principal_minors(matrix)),
        tuple(
            (0.0, most) if only_near and k == len(frame.ranges) else r
            for k, r in enumerate(place.ranges)
        ),
    )


def _matrix(place: Coordinates, opened: UnfoldedEnergy, even: Matrix) -> Matrix:
    """By the even coordinates, by c, and by w over r each time: symmetric, and singular where
    equilibria meet.
    """
    rows = [
        [*row, mixed, *(place.r * f[k] for f in opened.by_even)]
        for k, (row, mixed) in enumerate(zip(even, opened.mixed, strict=True))
    ]
    rows.append([*opened.mixed, opened.bend, *(place.r * f for f in opened.by_coordinate)])
    for by_even, by_coordinate, by_ratio in zip(
        opened.by_even, opened.by_coordinate, opened.by_ratio, strict=True
    ):
        rows.append([*(place.r * f for f in (*by_even, by_coordinate)), *by_ratio])
    return tuple(map(tuple, rows))
