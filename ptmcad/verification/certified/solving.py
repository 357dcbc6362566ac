"""All solutions of any model in a box, for all parameters in balls at once: exclusion, Krawczyk's
test, halving.

Guarantee: for every choice of the parameters in the balls of the `Field`, each of the solutions
that are returned exists, exactly once in its box, and there is no further one in the boxes of the
start at which no condition of the field is violated; when only minima are asked for, none that is a
minimum or degenerate without a negative eigenvalue. What cannot be proved raises `Unproved`.

`krawczyk` has the test.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from math import isfinite
from operator import gt

from flint import arb

from ptmcad.verification.certified.boxes import (
    MIN_HALF_WIDTH,
    Box,
    Floats,
    Unproved,
    Zero,
    disjoint,
    halves,
    inside,
    within,
)
from ptmcad.verification.certified.field import BallEquations, BallJet
from ptmcad.verification.certified.krawczyk import image_of, newton, proved
from ptmcad.verification.principalminors import is_no_minimum

_NEAR = 4.0
"""Balances are looked at where a spring may be shorter than so many times what it changes by in the
box.
"""
_PROMISING = 1.0
"""The width of Krawczyk's image, as a share of the box's, below which Newton's method is tried."""
_FIRST_SHARE = 2.0**-5
"""Of the start's widths: the first box that is tried around a solution is not narrower."""
_WORTH = 0.6
"""A box is replaced by Krawczyk's image when that has less than this share of it."""


class Spent(Unproved):
    """The boxes that a search may look at were not enough."""


def zeros(
    field: BallEquations,
    minima: bool,
    start: Iterable[Box],
    budget: int,
    smallest: float = MIN_HALF_WIDTH,
    near: Iterable[Zero] = (),
    whole: Floats | None = None,
) -> tuple[list[Zero], int]:
    """The solutions in the boxes, and how many boxes were looked at.

    Parameters
    ----------
    minima : whether only minima of a potential are asked for; others may then be missing.
    budget : number of boxes after which the search gives up.
    smallest : share of the first boxes' widths below which one is not halved again: in an unknown
        in which those near are closely alone, less.
    near : solutions for one choice of the parameters; those near them are proved first, before any
        box of the start is asked for, which saves a hopeless search.
    whole : half the width of the box that those of the start are parts of; of the first of these
        where it is None.

    Raises
    ------
    Unproved
        When a solution is degenerate or nearly so for some parameters, or the budget was spent.
    """
    circles = field.circles
    if whole is None:
        start = list(start)
        whole = start[0][1]
    found = [_persisting(field, zero, whole) for zero in near]
    units = _units(found, whole)
    least = [smallest * unit for unit in units]
    if not all(disjoint(one, two, circles) for one, two in combinations(found, 2)):
        raise Unproved("two solutions may meet")
    waiting, used = list(start), 0
    while waiting:
        box = waiting.pop()
        used += 1
        if used > budget:
            raise Spent(f"{budget} boxes were not enough")
        if any(inside(box, zero, circles) for zero in found):
            continue
        jet = field(_balls(box))
        if _excluded(jet, box, minima):
            continue
        image = None if jet.short else image_of(field, box, jet)
        if image is not None:
            if any(abs(step) > r for step, r in zip(image, box[1], strict=True)):
                continue
            new = _settled(field, box, found, whole) if _contracts(box, image) else None
            if new is not None and all(disjoint(new, zero, circles) for zero in found):
                found.append(new)
                if inside(box, new, circles):
                    continue
            narrower = _met(box, image)
            if narrower is not None and all(map(gt, narrower[1], least)):
                waiting.append(narrower)
                continue
        parts = halves(box, _widest(jet, box, units), least)
        if parts is None:
            where = ", ".join(f"{x:.6g}" for x in box[0])
            raise Unproved(f"a solution near ({where}) may be degenerate")
        waiting += parts
    return found, used


def _balls(box: Box) -> list[arb]:
    return list(map(arb, *box))


def _excluded(jet: BallJet, box: Box, minima: bool) -> bool:
    """Whether no solution that is asked for lies in the box."""
    if any(v > 0 or v < 0 for v in jet.values) or any(c < 0 for c in jet.conditions):
        return True
    short = jet.short
    if minima and not short and is_no_minimum(jet.jacobian):
        return True
    for k in jet.pulling if max(box[1]) < 1 else ():
        change = sum(slope.upper() * r for slope, r in zip(jet.slopes(k), box[1], strict=True))
        if not jet.length(k) > _NEAR * change and any(not b.contains(0) for b in jet.balances(k)):
            return True
    return minima and len(short) == 1 and jet.bends_down(short[0])


def _contracts(box: Box, image: Sequence[arb]) -> bool:
    """Whether Krawczyk's image of a box is not much wider, so that it is worth looking for a
    solution in it.
    """
    return all(step.rad() < _PROMISING * r for step, r in zip(image, box[1], strict=True))


def _met(box: Box, image: Sequence[arb]) -> Box | None:
    """What a box has in common with its image, if that is worth it; a little more than that."""
    middle, radii, share = [], [], 1.0
    for m, r, step in zip(*box, image, strict=True):
        slack = 2.0**-50 * (abs(m) + r)
        low = max(m - r, m + float(step.lower()) - slack)
        high = min(m + r, m + float(step.upper()) + slack)
        if not (isfinite(low) and isfinite(high)):
            return None
        center = (low + high) / 2
        radius = max(high - center, center - low) + slack
        middle.append(center)
        radii.append(radius)
        share *= radius / r
    return (tuple(middle), tuple(radii)) if share < _WORTH else None


def _settled(field: BallEquations, box: Box, found: Sequence[Zero], whole: Floats) -> Zero | None:
    """A solution that Newton's method reaches from the box's middle, proved to be one; None when
    none is.
    """
    center = newton(field, box)
    if center is None or any(within(center, z.center, z.alone, field.circles) for z in found):
        return None
    return proved(field, center, _shapes(box[1], whole))


def _persisting(field: BallEquations, zero: Zero, whole: Floats) -> Zero:
    """The solution for all parameters that one for some parameters belongs to."""
    persisting = proved(field, zero.center, _shapes(zero.alone, whole))
    if persisting is None:
        where = ", ".join(f"{x:.6g}" for x in zero.center)
        raise Unproved(f"the solution near ({where}) may not persist")
    return persisting


def _shapes(radii: Floats, whole: Floats) -> tuple[Floats, Floats]:
    """Half widths of boxes that are tried around a solution: of the start's shape, which a box in
    it need not have.
    """
    share = max(_FIRST_SHARE, *(r / w for r, w in zip(radii, whole, strict=True)))
    return tuple(share * w for w in whole), radii


def _units(found: Sequence[Zero], whole: Floats) -> list[float]:
    """Widths to compare those of boxes with: shares of the whole, as different as where known
    solutions are alone.
    """
    shares = [[r / w for r, w in zip(zero.alone, whole, strict=True)] for zero in found]
    return [
        w * min((some[k] / max(some) for some in shares), default=1.0) for k, w in enumerate(whole)
    ]


def _widest(jet: BallJet, box: Box, units: Sequence[float]) -> list[int]:
    """The unknowns in the order in which halving is worth most: those first that the equations vary
    with most.
    """

    slopes = {n: jet.slopes(n) for n in jet.short}

    def weight(k: int) -> float:
        if jet.short:
            change = sum(float((jet.pull(n) * some[k]).upper()) for n, some in slopes.items())
        else:
            change = sum(float(row[k].abs_upper()) for row in jet.jacobian)
        return change * box[1][k] if isfinite(change) else box[1][k] / units[k]

    weights = [weight(k) for k in range(len(units))]
    shares = [r / unit for r, unit in zip(box[1], units, strict=True)]
    largest = max(shares)
    # no unknown is left behind by far
    return sorted(
        range(len(units)), key=lambda k: (shares[k] * 64 > largest, weights[k]), reverse=True
    )
