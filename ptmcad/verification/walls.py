"""Walls of stacks: enclosures of their integrals from one critical value to the next.

In the middle power series are taken, as far as they reach (`ptmcad.verification.branches`), beside critical values
series about these, and to the far end of a long stack one about infinity (`ptmcad.verification.turning`). Where a
reflection (u, v) to (u, T(u) - v) maps a curve to itself, what is known of one branch is known of its image.

Guarantee: what is returned contains the integral of the branch. That the curve is its own image is proved by
comparing polynomials, which branch is the image by counting roots over one abscissa of the stack.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from flint import arb, fmpq, fmpq_poly

from ptmcad.verification.branches import Branch, Effort, Part, integrals_over, known_by_edges
from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.places import Place
from ptmcad.verification.sturm import ends_of, roots_between
from ptmcad.verification.turning import Beside, integral_beside

Known = dict[tuple[int, int, fmpq, fmpq], list[Part]]
"""Parts of panels, by the curve, the number of its root, and the panel's ends."""
LONG = 2**6
"""Times as far away as anything singular that is known: where a series about infinity is tried."""
_LEAP = fmpq(2) ** 16
"""By so much nearer to the far end is it tried next."""


@dataclass(frozen=True)
class Wall:
    """A branch over a stack.

    Attributes
    ----------
    span : of the stack, without the strips around critical values.
    places : about what series may be taken at either end of it, the first that serves.
    margin : a part that is not some times as wide is not tried.
    share : error that a panel may have.
    image : the number of the root that is its mirror image, and T; None when there is none in the window.
    scale : how far from zero something singular is known to be, at the most; 1 where nothing is known.
    """

    branch: Branch
    span: tuple[fmpq, fmpq]
    places: tuple[Sequence[Place], Sequence[Place]]
    margin: fmpq
    share: arb
    image: tuple[int, fmpq_poly] | None
    scale: fmpq

    def parts(self, left: fmpq, right: fmpq, effort: Effort, known: Known) -> list[Part]:
        """The integral over a panel from the window's lower edge, in parts: the best enclosures at hand.

        Raises
        ------
        PrecisionTooLow
        """
        number, curve = self.branch.root, self.branch.curve.number
        if self.image is not None and (curve, self.image[0], left, right) in known:
            return [_reflected(p, self.image[1], effort) for p in known[curve, self.image[0], left, right]]
        effort = replace(effort, share=self.share)
        if (left, right) == self.span:
            found, rest = self._from_infinity(effort)
            inside = integrals_over(self.branch, *rest, effort) if rest[0] < rest[1] else []
            found += [q for p in inside for q in self._to_the_ends(p, effort)]
        else:
            found = integrals_over(self.branch, left, right, effort)
        known[curve, number, left, right] = found
        return found

    def _from_infinity(self, effort: Effort) -> tuple[list[Part], tuple[fmpq, fmpq]]:
        """The parts of the span that series about infinity reach from its far ends, and the rest of it."""
        rest = list(self.span)
        done: list[Part] = []
        for side, sign in enumerate((-1, 1)):
            near, distance = self.span[side], self.scale
            while near * sign > distance * LONG and (rest[1 - side] - distance * sign) * sign <= 0:
                far = distance * sign
                found = integral_beside(self.branch, Beside(None, near, far), far * far / abs(near), effort)
                if found is not None:
                    integral, reached = found
                    first, last = sorted((near, reached))
                    done.append(Part(first, last, integral - effort.heights[0] * (last - first), True))
                    rest[side] = reached
                    break
                distance *= _LEAP
        return done, (rest[0], rest[1])

    def _to_the_ends(self, part: Part, effort: Effort) -> list[Part]:
        """A part of the span of which nothing is known, by series about places at its ends as far as they reach."""
        heights, rest = effort.heights, [part.left, part.right]
        done: list[Part] = []
        known = part.integral.rad() * 4 < (heights[1] - heights[0]) * (part.right - part.left)
        if known or part.right - part.left < 4 * self.margin:
            return [part]
        for side, places in enumerate(self.places):
            end, other = rest[side], rest[1 - side]
            for place in places if end == self.span[side] and end != other else ():
                near = end + (-place.gap if side else place.gap)
                found = integral_beside(self.branch, Beside(place.abscissa, near, other), place.away, effort)
                if found is None:
                    continue
                integral, reached = found
                first, last = sorted((near, reached))
                done.append(Part(first, last, integral - heights[0] * (last - first), True))
                if place.gap > 0:
                    done.append(known_by_edges(min(end, near), max(end, near), effort, True))
                rest[side] = reached
                break
        if not done:
            return [part]
        return done if rest[0] == rest[1] else [*done, known_by_edges(rest[0], rest[1], effort, False)]


def _reflected(part: Part, total: fmpq_poly, effort: Effort) -> Part:
    """The part of the image, which is T less the branch."""
    left, right, integral, tried = part
    if not tried:
        return part
    whole = total.integral()
    return Part(
        left, right, fmpq(whole(right)) - fmpq(whole(left)) - 2 * effort.heights[0] * (right - left) - integral, tried
    )


@lru_cache(maxsize=64)
def reflection(curve: PlaneCurve) -> fmpq_poly | None:
    """The polynomial T for which (u, v) to (u, T(u) - v) maps the curve to itself; None when there is none.

    T is twice the mean of all roots over u, so there is one at most.
    """
    rows = [fmpq_poly(row) for row in curve.in_v]
    degree = len(rows) - 1
    quotient, remainder = divmod(-2 * rows[degree - 1], degree * rows[degree])
    if remainder.degree() >= 0:
        return None
    # p(u, T - v), by Horner's division by v + T, then a change of the sign of v
    image = list(rows)
    for start in range(degree):
        for j in range(degree - 1, start - 1, -1):
            image[j] = image[j] + image[j + 1] * quotient
    sign = (-1) ** degree
    if any((-1) ** j * image[j] != sign * rows[j] for j in range(degree + 1)):
        return None
    return quotient


def image_of(branch: Branch, u: fmpq, heights: tuple[fmpq, fmpq]) -> tuple[int, fmpq_poly] | None:
    """Which root over u between two heights is a branch's mirror image, and T; None when it is not one of these."""
    twice = reflection(branch.curve)
    height = None if twice is None else branch.height(u, *heights)
    if twice is None or height is None:
        return None
    low, high = ends_of(twice(u) - height)
    if not heights[0] < low <= high < heights[1]:
        return None
    p = branch.curve.over(u)
    if p(low) == 0 or p(high) == 0:
        return None
    below = roots_between(p, heights[0], low)
    return (below, twice) if roots_between(p, heights[0], high) == below + 1 else None
