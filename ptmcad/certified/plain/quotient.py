"""Folds of minima of a problem that an involution leaves as it is, in coordinates that are regular at its fixed points.

Guarantee: each point of the window at which minima meet other equilibria lies on the projection of one of the curves
(Lemmas Q1 to Q3 of docs/soundness.md).

In coordinates e that the involution keeps and o that it takes to -o, about a component o = 0 of its fixed points, the
energy U is even in o. On the component the Hessian has two blocks: equilibria meet within it where that of e is
singular, and they part with others, each the other's image, where that of o is. There the Jacobian of U_e, U_o and
det H loses rank. Off the component some |o_i| is largest: with that one r > 0 and o = r w, U is a smooth function
u(e, v, w) of v = r^2, and its derivatives by w are v times smooth functions g. The equilibria are the zeros of u_e, u_v
and g, and they meet where a matrix is singular that is smooth at v = 0, too.

References
----------
Golubitsky, Stewart & Schaeffer, Singularities and Groups in Bifurcation Theory II (1988), chapter XIII.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ptmcad.certified.curve import Curve
from ptmcad.certified.plain.chart import chart, determinant, principal_minors
from ptmcad.certified.plain.frame import Frame
from ptmcad.certified.plain.opening import Coordinates, Opening, coordinates, opening, stiffness
from ptmcad.certified.plain.problem import FIRST
from ptmcad.certified.plain.search import Search, dependent, semidefinite, values
from ptmcad.certified.plain.springs import Matrix
from ptmcad.certified.system import system


def symmetric_folds(search: Search, frames: Sequence[Frame]) -> Iterator[Curve]:
    """All folds of minima, on the fixed points and off them."""
    for frame in frames:
        yield from _fixed(search, frame)
        for lead in range(len(frame.reaches)):
            yield _moved(search, frame, lead)


def _fixed(search: Search, frame: Frame) -> Iterator[Curve]:
    """Folds on a component of the fixed points."""
    place = coordinates(frame, 0)
    at = chart(search.exact, unknowns=frame.unknowns(place.evens, (), place.graph))
    there = at.matrix_at_equilibrium()
    across = [stiffness(place, [spring.vector for spring in at.springs])] if len(frame.odds) == 1 else []
    for parting in (False, True) if frame.ranges else (True,):
        block, other = (frame.odds, frame.evens) if parting else (frame.evens, frame.odds)
        singular, known = (frame.block(h, block, at.scales, over=True) for h in (at.hessian, there))
        definite = frame.block(there, other, at.scales, over=True)
        zero = across[0] if parting and across else determinant(singular)
        yield Curve(
            f"{'pitchfork' if parting else 'fold'} of a stable equilibrium that is its own image{search.where}",
            "a minimum parts with two others, or meets two saddles, that are each other's images"
            if parting
            else "a minimum meets a saddle, and both are their own images",
            system(
                [*(at.equations[e[0][0]] for e in frame.evens), zero],
                (0, 1, *range(FIRST, FIRST + len(frame.ranges))),
                dependent(search, at, costly=[determinant(known), at.levelled()]),
                [
                    *([] if parting else across),
                    *principal_minors(known),
                    *(principal_minors(definite, whole=True)),
                    *semidefinite(at),
                    *values(search.conditions, at),
                ],
                solved=search.solved([*at.equations, zero]),
            ),
            frame.ranges,
            np.array([*search.weights[:2], *(1.0 for _ in frame.ranges)]),
        )


def _moved(search: Search, frame: Frame, lead: int) -> Curve:
    """Folds off the fixed points, each for its image, too: where the odd coordinate of number ``lead`` is largest."""
    place = coordinates(frame, lead)
    at = chart(search.exact, unknowns=place.unknowns())
    near = opening(place, [spring.vector for spring in at.springs])
    matrix = _matrix(place, near, frame.block(at.hessian, frame.evens, at.scales, over=False))
    equations = [sum((s * at.equations[k] for k, s in e[1:]), start=at.equations[e[0][0]]) for e in frame.evens]
    cheap, costly = dependent(search, at, at.equations)
    return Curve(
        f"fold of a stable equilibrium that is not its own image{search.where}",
        "a minimum meets a saddle: det H = 0 with no negative principal minor; so do their images",
        system(
            [*equations, near.slope, *near.ratios, determinant(matrix)],
            (0, 1, *search.problem.variables),
            (cheap, costly),
            [*semidefinite(at), *principal_minors(matrix), *values(search.conditions, at)],
            solved=search.solved([*at.equations, *equations, near.slope, *near.ratios, *cheap]),
        ),
        place.ranges,
        np.array([*search.weights[:2], *(1.0 for _ in at.equations)]),
    )


def _matrix(place: Coordinates, near: Opening, even: Matrix) -> Matrix:
    """By the even coordinates, by c, and by w over r each time: symmetric, and singular where equilibria meet."""
    rows = [[*row, mixed, *(place.r * f[k] for f in near.by_even)] for k, (row, mixed) in enumerate(zip(even, near.mixed, strict=True))]
    rows.append([*near.mixed, near.bend, *(place.r * f for f in near.by_coordinate)])
    for by_even, by_coordinate, by_ratio in zip(near.by_even, near.by_coordinate, near.by_ratio, strict=True):
        rows.append([*(place.r * f for f in (*by_even, by_coordinate)), *by_ratio])
    return tuple(map(tuple, rows))
