"""Checks of where ranges are longest, and whether that is attained, on lines of the slice by themselves.

Guarantee: what passes holds at the rational values that were looked at: those that the claims name, the window's edges,
random ones in an interval, and all at which the whole line is exceptional: counts can change there on every line across
it, so that it is a common critical value of some random ones. On a line with degenerate solutions points with another
count are sought that leave no room for the range.

Not guaranteed: anything at irrational values, and of places that are enclosed.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import fmpz_poly

from ptmcad.answer.intervals import End, lower
from ptmcad.answer.widths import Maximum, Place
from ptmcad.question.slice import Axis
from ptmcad.text.numerals import shortest_text
from ptmcad.verification.algebra import NotFinite
from ptmcad.verification.fibre import fibre
from ptmcad.verification.line import Line, NotKnown
from ptmcad.verification.report import Unchecked, Violation

ACROSS = 3
"""Lines across, of which common critical values are taken."""
INSIDE = 5
_POINTS = 40
_NEAR = Fraction(1, 2**100)
"""How far from a value a limit is looked at, as a share of the window, and what of it must be left."""
_LEFT = Fraction(99, 100)


@dataclass(frozen=True)
class Lines:
    """The lines of a slice in both directions.

    Attributes
    ----------
    at : the line at a value of the axis ``over``.
    across : the line along that axis at a value of the axis of ranges.
    working : the wanted count.
    """

    at: Callable[[Fraction], Line]
    across: Callable[[Fraction], Line]
    along: Axis
    over: Axis
    working: int

    def has(self, value: Fraction, width: Fraction) -> bool | None:
        """Whether the longest range on a line is at least so long; None where that was not found out."""
        line = self.at(value)
        try:
            return max((span.width.high for span in line.ranges(self.working)), default=Fraction(0)) >= width
        except NotKnown:
            others = [line.low, line.high]
        for _ in range(_POINTS):
            low, high = max(pairwise(others), key=lambda pair: pair[1] - pair[0])
            if high - low < width:
                return False
            point = low + (high - low) * Fraction(7, 15)
            if self._counted(line, point) is not False:
                return None
            others = sorted([*others, point])
        return None

    def _counted(self, line: Line, point: Fraction) -> bool | None:
        """Whether there is the wanted count, of different solutions, at a point where some may be degenerate."""
        try:
            found = fibre(line.model, line.values_at(point))
        except NotFinite:  # of one unknown infinitely many count, or none
            return False if len(line.model.unknowns) == 1 and self.working else None
        except NotKnown:  # a parameter has a pole
            return False
        if found.dimension == 0:
            return self.working == 0
        counts, number = found.counts(), found.number_of_real_solutions()
        if counts is not None:
            return (counts.total if counts.stable is None else counts.stable) == self.working
        tells = found.point.has_index or bool(found.point.stability)
        return number == self.working if number < self.working or not tells else None

    def exceptional(self) -> list[Fraction]:
        """The rational values inside of the window at which the whole line is exceptional.

        Raises
        ------
        NotKnown
        """
        source = random.Random(f"{self.along} {self.over}")
        common = fmpz_poly([0])
        for _ in range(ACROSS):
            common = common.gcd(self.across(_between(source, self.along.low, self.along.high)).critical)
        linear = [factor for factor, _ in common.factor()[1] if factor.degree() == 1]
        values = [Fraction(-int(factor[0]), int(factor[1])) for factor in linear]
        return [value for value in values if self.over.low < value < self.over.high]


def _between(source: random.Random, low: Fraction, high: Fraction) -> Fraction:
    return low + (high - low) * Fraction(source.randrange(1, 2**20), 2**20)


def check_maxima(lines: Lines, maxima: Sequence[Maximum]) -> str:
    """The claims of the longest ranges over one axis.

    Raises
    ------
    Violation
    """
    over, unknown = lines.over, 0
    most = max((m.width.high for m in maxima), default=Fraction(0))
    special = [over.low, *lines.exceptional(), over.high]
    for value in special:
        if lines.has(value, most + (lines.along.high - lines.along.low) * _NEAR):
            raise Violation(f"at {over.name} = {shortest_text(value)} there is a longer range than the longest one")
    source = random.Random(str(maxima))
    for m in maxima:
        claims: dict[End, bool] = {}
        if m.place is Place.PLATEAU:
            inside = [_between(source, m.at.low, m.at.high) for _ in range(INSIDE)]
            whole: list[End] = [
                m.at.low,
                *inside,
                *(value for value in special if m.at.low <= value <= m.at.high),
                m.at.high,
            ]
            claims = dict.fromkeys(whole, True)
            claims |= dict.fromkeys(m.exceptions, False)
            claims = {at: attained for at, attained in claims.items() if at not in m.doubtful}
        elif m.at.exact is not None and m.attained is not None:
            claims = {m.at.exact: m.attained}
        unknown += not claims
        for at, attained in claims.items():
            found = lines.has(at, m.width.low) if isinstance(at, Fraction) else None
            unknown += found is None
            if found is (not attained):
                words = "no range so long" if attained else "a range so long"
                raise Violation(f"at {over.name} = {shortest_text(lower(at))} there is {words} as the longest one")
        if m.attained is False and m.at.exact is not None:
            reach = (over.high - over.low) * _NEAR
            sides = [v for v in (m.at.exact - reach, m.at.exact + reach) if over.low < v < over.high]
            if all(lines.has(value, m.width.low * _LEFT) is False for value in sides):
                raise Violation(f"beside {over.name} = {shortest_text(m.at.exact)} ranges do not come near the longest")
    told = f"{len(maxima)} places, {len(special)} lines"
    return Unchecked(f"{told}; {unknown} claims were not decided") if unknown else told
