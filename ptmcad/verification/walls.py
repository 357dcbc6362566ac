"""Walls of stacks: enclosures of their integrals from one critical value to the next.

In the middle power series are taken, as far as they reach (`ptmcad.verification.branches`), beside critical values
series about these, and to the far end of a long stack one about infinity (`ptmcad.verification.turning`). Where a
reflection (u, v) to (u, T(u) - v) maps a curve to itself, what is known of one branch is known of its image.

Guarantee: what is returned contains the integral of the branch. That the curve is its own image is proved by
comparing polynomials, which branch is the image by counting roots over one abscissa of the stack.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, lru_cache

from flint import arb, ctx, fmpq, fmpq_poly

from ptmcad.answer.regionmap import CriticalValue
from ptmcad.verification.branches import Branch, Effort, Part, integrals_over, known_by_edges
from ptmcad.verification.claims import PlaneCurve, ball
from ptmcad.verification.sturm import ends_of, roots_between
from ptmcad.verification.turning import Abscissa, Beside, integral_beside

Known = dict[tuple[int, int, fmpq, fmpq], list[Part]]
"""Parts of panels, by the curve, the number of its root, and the panel's ends."""
LONG = 2**6
"""Times as far away as anything singular that is known: where a series about infinity is tried."""
_LEAP = fmpq(2) ** 16
"""By so much nearer to the far end is it tried next."""
_ROOM_BITS = 64
"""By so many bits is a critical value known better than it is asked for."""


@dataclass(frozen=True)
class Wall:
    """A branch over a stack.

    Attributes
    ----------
    span : of the stack, without the strips around critical values.
    places : the critical values at its ends, None for the window's edges.
    margin : width of what is left out beside a critical value.
    share : error that a panel may have.
    image : the number of the root that is its mirror image, and T; None when there is none in the window.
    scale : how far from zero something singular is known to be, at the most; 1 where nothing is known.
    """

    branch: Branch
    span: tuple[fmpq, fmpq]
    places: tuple[Abscissa | None, Abscissa | None]
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
            found += [q for p in inside for q in self._to_the_end(p, effort)]
        else:
            found = integrals_over(self.branch, left, right, effort)
        known[curve, number, left, right] = found
        return found

    def _from_infinity(self, effort: Effort) -> tuple[list[Part], tuple[fmpq, fmpq]]:
        """The parts of the span that series about infinity reach from its far ends, and the rest of it."""
        done, rest = [], list(self.span)
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

    def _to_the_end(self, part: Part, effort: Effort) -> list[Part]:
        """A part of the span, by a series about the critical value at its end if one reaches from there."""
        if part.tried or part.right - part.left < 4 * self.margin:
            return [part]
        for side, place in enumerate(self.places):
            end, other = (part.left, part.right) if side == 0 else (part.right, part.left)
            if place is None or end != self.span[side]:
                continue
            near = end + (self.margin if side == 0 else -self.margin)
            found = integral_beside(self.branch, Beside(place, near, other), self.margin, effort)
            if found is None:
                continue
            integral, reached = found
            first, last = (near, reached) if side == 0 else (reached, near)
            done = [Part(first, last, integral - effort.heights[0] * (last - first), True)]
            beyond = (end, near) if side == 0 else (near, end)
            done.append(known_by_edges(*beyond, effort, True))
            if reached != other:
                rest = (reached, other) if side == 0 else (other, reached)
                done.append(known_by_edges(*rest, effort, False))
            return done
        return [part]


def _reflected(part: Part, total: fmpq_poly, effort: Effort) -> Part:
    """The part of the image, which is T less the branch."""
    left, right, integral, tried = part
    if not tried:
        return part
    whole = total.integral()
    return Part(
        left, right, fmpq(whole(right)) - fmpq(whole(left)) - 2 * effort.heights[0] * (right - left) - integral, tried
    )


def abscissa_of(value: CriticalValue) -> Abscissa:
    """A function for a ball around a critical value, which remembers it for each power of two."""

    @cache
    def known(bits: int) -> arb:
        with ctx.workprec(max(ctx.prec, bits + _ROOM_BITS)):
            return ball(value, fmpq(2) ** -bits)

    def abscissa(width: fmpq) -> arb:
        return known(int((1 / width).ceil()).bit_length())

    return abscissa


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
