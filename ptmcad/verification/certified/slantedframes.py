"""A slanted piece of a cover: the parts that its tubes leave of its frame.

Guarantee: bounds of areas hold, and parts of sides that are said to be open are so. Tubes are
polynomials in powers here, which are put together from the controls' differences; that they are in
order and pass the sides of their frames once is proved by counting roots, where the engine looks
at the controls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import comb

from flint import arb, arb_poly, fmpq, fmpq_poly

from ptmcad.cover.rectangles import Patch
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.verification.report import Violation
from ptmcad.verification.rootcounts import roots_between

ONE = fmpq(1)
_FINER = 2**20
"""Parts of a lattice step to which the place is found where a tube passes a side of its frame."""
Part = tuple[Fraction | int, Fraction | int, bool, int]
"""Of a side: its ends, whether it is open, and the number of what has it."""


class SlantedFrame:
    """A patch with its polynomials in s, which goes from 0 to 1 along the frame.

    Raises
    ------
    Violation
        When the tubes do not part the frame as they should.
    """

    def __init__(self, patch: Patch, number: int) -> None:
        self.patch, self.name = patch, f"slanted piece {number}"
        a = patch.along
        self.low, self.high = patch.frame[2 * a], patch.frame[2 * a + 1]
        self.bottom, self.top = patch.frame[2 - 2 * a], patch.frame[3 - 2 * a]
        self.centers = [_in_powers(tube.controls) for tube in patch.tubes]
        self.halves = [tube.half for tube in patch.tubes]
        if not patch.tubes or min(self.halves) <= 0:
            raise Violation(f"{self.name} has no tube, or one without width")
        for below, above in pairwise(range(len(self.centers))):
            gap = (
                self.centers[above]
                - self.centers[below]
                - (self.halves[above] + self.halves[below])
            )
            if not _positive(gap):
                raise Violation(f"tubes of {self.name} are not ascending and disjoint")
        self.turns = [
            self._direction(center, half)
            for center, half in zip(self.centers, self.halves, strict=True)
        ]

    def _direction(self, center: fmpq_poly, half: int) -> int:
        """1 or -1 where the tube ascends or descends, 0 where it stays within the frame.

        Raises
        ------
        Violation
            Where it does neither.
        """
        if _positive(center - half - self.bottom) and _positive(self.top - center - half):
            return 0
        slope = center.derivative()
        if (
            slope.degree() < 0
            or roots_between(slope.numer(), fmpq(0), ONE)
            or slope(fmpq(1, 2)) == 0
        ):
            raise Violation(f"a tube of {self.name} passes a side of its frame, and turns back")
        return 1 if slope(fmpq(1, 2)) > 0 else -1

    def place(self, u: Fraction, v: Fraction) -> int | None:
        """How many tubes are below a point of the frame; None in a tube. u is along the tubes."""
        s = from_fraction((u - self.low) / (self.high - self.low))
        for k, (center, half) in enumerate(zip(self.centers, self.halves, strict=True)):
            away = from_fraction(v) - center(s)
            if away <= half:
                return k if away < -half else None
        return len(self.centers)

    def side(self, axis: int, end: int) -> Sequence[Part]:
        """The parts of a side across an axis, the lower (0) or the upper (1) one; numbers of parts
        or of tubes.
        """
        key = (axis, end)
        if key not in self._sides:
            self._sides[key] = list(self._end(end) if axis == self.patch.along else self._long(end))
        return self._sides[key]

    @cached_property
    def _sides(self) -> dict[tuple[int, int], Sequence[Part]]:
        return {}

    def _end(self, end: int) -> Iterator[Part]:
        at: Fraction | int = self.bottom
        number = 0
        for k, (center, half) in enumerate(zip(self.centers, self.halves, strict=True)):
            value = center(fmpq(end))
            first, last = (
                to_fraction(value - half).__floor__(),
                to_fraction(value + half).__ceil__(),
            )
            if last < self.bottom:
                number = k + 1
                continue
            if first > self.top:
                break
            if first > at:
                yield at, first, True, k
            yield max(first, self.bottom), min(last, self.top), False, k
            at, number = max(last, at), k + 1
        if at < self.top:
            yield at, self.top, True, number

    def _long(self, end: int) -> Iterator[Part]:
        height = (self.bottom, self.top)[end]
        blocks = []
        for k in range(len(self.centers)):
            passed = self._passing(k, height)
            if passed is not None:
                blocks.append((*passed, k))
        at = Fraction(self.low)
        for first, last, k in [*sorted(blocks), (Fraction(self.high), Fraction(self.high), -1)]:
            if first > at:
                number = self.place((at + first) / 2, Fraction(height))
                if number is not None:
                    yield at, first, True, number
            if k >= 0:
                yield first, last, False, k
            at = max(at, last)

    def _passing(self, k: int, height: int) -> tuple[Fraction, Fraction] | None:
        """An interval on lattice points that holds all places at which a tube is at a height."""
        turn = self.turns[k]
        if turn == 0:
            return None
        ends = sorted(self._reached(k, height - sign * turn * self.halves[k]) for sign in (1, -1))
        if ends[1] < self.low or ends[0] > self.high:
            return None
        first, last = (
            Fraction(ends[0].__floor__()),
            Fraction((ends[1] + Fraction(1, _FINER)).__ceil__()),
        )
        return max(first, Fraction(self.low)), min(last, Fraction(self.high))

    def _reached(self, k: int, level: int) -> Fraction:
        """Where a center that ascends or descends reaches a level, at most 1/_FINER more; beyond
        the frame if not.
        """
        center, turn = self.centers[k], self.turns[k]
        width = self.high - self.low
        if turn * (center(fmpq(0)) - level) > 0:
            return Fraction(self.low - 1)
        if turn * (center(ONE) - level) < 0:
            return Fraction(self.high + 1)
        a, b = 0, width * _FINER
        while b - a > 1:
            middle = (a + b) // 2
            if turn * (center(fmpq(middle, width * _FINER)) - level) < 0:
                a = middle
            else:
                b = middle
        return self.low + Fraction(a, _FINER)

    @cached_property
    def parts(self) -> list[Fraction]:
        """Upper bounds of the areas of the parts between the tubes, from below."""
        width = self.high - self.low
        edges: list[tuple[Fraction, Fraction]] = [(Fraction(self.bottom * width),) * 2]
        for k in range(len(self.centers)):
            edges += [self._cut(k, -self.halves[k]), self._cut(k, self.halves[k])]
        edges.append((Fraction(self.top * width),) * 2)
        return [max(Fraction(0), edges[k + 1][1] - edges[k][0]) for k in range(0, len(edges), 2)]

    def _cut(self, k: int, shift: int) -> tuple[Fraction, Fraction]:
        """Bounds of the integral of a shifted center, cut off at the frame's heights."""
        center, turn, width = self.centers[k] + shift, self.turns[k], self.high - self.low
        primitive = center.integral()
        if turn == 0:
            value = to_fraction(primitive(ONE) * width)
            return value, value
        marks = [Fraction(0)]
        for level in (self.bottom, self.top)[::turn]:
            at = self._reached(k, level - shift)
            marks.append(min(max((at - self.low) / width, Fraction(0)), Fraction(1)))
        marks.append(Fraction(1))
        before, after = (self.bottom, self.top)[::turn]
        middle = to_fraction(
            primitive(from_fraction(marks[2])) - primitive(from_fraction(marks[1]))
        )
        total = width * (before * marks[1] + middle + after * (1 - marks[2]))
        # outside of the frame, or from one end of it to the other, nothing was rounded
        rounded = not {marks[1], marks[2]} <= {Fraction(0), Fraction(1)}
        slack = Fraction(2 * (self.top - self.bottom) + 2, _FINER) if rounded else Fraction(0)
        return total - slack, total + slack

    def avoids(self, low: tuple[Fraction, Fraction], high: tuple[Fraction, Fraction]) -> bool:
        """Whether a rectangle surely meets no tube inside the frame."""
        a, width = self.patch.along, self.high - self.low
        start = (max(low[a], Fraction(self.low)) - self.low) / width
        end = (min(high[a], Fraction(self.high)) - self.low) / width
        s = arb(from_fraction((start + end) / 2), arb(from_fraction((end - start) / 2)).upper())
        for center, half in zip(self.centers, self.halves, strict=True):
            value = arb_poly(center)(s)
            if not (
                value - half > arb(from_fraction(high[1 - a]))
                or value + half < arb(from_fraction(low[1 - a]))
            ):
                return False
        return True


def _in_powers(controls: Sequence[int]) -> fmpq_poly:
    """The polynomial with these coefficients in Bernstein's basis: its j-th power has binomial(n,
    j) times the j-th forward difference."""
    n, coefficients, differences = len(controls) - 1, [], list(controls)
    for j in range(n + 1):
        coefficients.append(comb(n, j) * differences[0])
        differences = [b - a for a, b in pairwise(differences)]
    return fmpq_poly(coefficients)


def _positive(p: fmpq_poly) -> bool:
    """Whether a polynomial is positive on [0, 1]."""
    if p(fmpq(0)) <= 0 or p(ONE) <= 0:
        return False
    return p.degree() < 1 or roots_between(p.numer(), fmpq(0), ONE) == 0
