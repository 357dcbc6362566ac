"""Checks of where ranges are longest, and whether that is attained, on lines of the slice by
themselves.

Guarantee: what passes holds at the rational values that were looked at: those that the claims name,
the window's edges, random ones in an interval, and all at which the whole line is exceptional:
counts can change there on every line across it, so that it is a common critical value of some
random ones. On a line with degenerate solutions points with another count are sought that leave no
room for the range.

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
from ptmcad.verification.line import NotKnown, ParameterLine
from ptmcad.verification.report import Unchecked, Violation

ACROSS = 3
"""Lines across, of which common critical values are taken."""
INSIDE = 5
"""Random values in an interval."""
_POINTS = 40
_NEAR = Fraction(1, 2**100)
"""How far from a value a limit is looked at, as a share of the window; and what of it is there at
least.
"""
_LEFT = Fraction(99, 100)


@dataclass(frozen=True)
class SliceLines:
    """The lines of a slice in both directions.

    Attributes
    ----------
    at : the line at a value of the axis ``over``.
    across : the line along that axis at a value of the axis of ranges.
    working : the wanted count.
    """

    at: Callable[[Fraction], ParameterLine]
    across: Callable[[Fraction], ParameterLine]
    along: Axis
    over: Axis
    working: int

    def has(self, value: End, width: Fraction) -> bool | None:
        """Whether the longest range on a line is at least so long; None where that was not found
        out.
        """
        if not isinstance(value, Fraction):
            return None
        line = self.at(value)
        try:
            return (
                max((span.width.high for span in line.ranges(self.working)), default=Fraction(0))
                >= width
            )
        except NotKnown:
            others = [line.low, line.high]
        for _ in range(_POINTS):
            low, high = max(pairwise(others), key=lambda pair: pair[1] - pair[0])
            if high - low < width:
                return False
            others = sorted([*others, low + (high - low) * Fraction(7, 15)])
            if self._may_count(line, low + (high - low) * Fraction(7, 15)):
                break
        return None

    def _may_count(self, line: ParameterLine, point: Fraction) -> bool:
        """Whether there may be the wanted count at a point, at which solutions may be degenerate."""
        try:
            found = fibre(line.model, line.values_at(point))
        except NotFinite:  # of one unknown infinitely many count, or none
            return len(line.model.unknowns) > 1 or not self.working
        except NotKnown:  # a parameter has a pole
            return False
        return bool(found.dimension) and found.number_of_real_solutions() >= self.working

    def exceptional(self) -> list[Fraction]:
        """The rational values inside of the window at which the whole line is exceptional.

        Raises
        ------
        NotKnown
        """
        common = fmpz_poly([0])
        for value in _between(self.along.low, self.along.high, ACROSS):
            common = common.gcd(self.across(value).critical)
        linear = [factor for factor, _ in common.factor()[1] if factor.degree() == 1]
        values = [Fraction(-int(factor[0]), int(factor[1])) for factor in linear]
        return [value for value in values if self.over.low < value < self.over.high]


def _between(low: Fraction, high: Fraction, number: int) -> list[Fraction]:
    source = random.Random(f"{low} {high}")
    return [low + (high - low) * Fraction(source.randrange(1, 64), 64) for _ in range(number)]


def check_maxima(lines: SliceLines, maxima: Sequence[Maximum]) -> str:
    """The claims of the longest ranges over one axis.

    Raises
    ------
    Violation, NotKnown
    """
    over, unknown = lines.over, 0
    reach = (over.high - over.low) * _NEAR
    special = [over.low, *lines.exceptional(), over.high]
    claims: list[tuple[End, Fraction, bool]] = []
    most = max((m.width.high for m in maxima), default=Fraction(0))
    claims += [(value, most + reach, False) for value in special]
    for m in maxima:
        known = len(claims)
        if m.place is Place.PLATEAU:
            inside = [
                *_between(m.at.low, m.at.high, INSIDE),
                *(v for v in special if m.at.low <= v <= m.at.high),
            ]
            claims += [
                (v, m.width.low, True) for v in inside if v not in (*m.exceptions, *m.doubtful)
            ]
            claims += [(v, m.width.low, False) for v in m.exceptions]
        elif m.at.exact is not None and m.attained is not None:
            claims.append((m.at.exact, m.width.low, m.attained))
            sides = [
                v for v in (m.at.exact - reach, m.at.exact + reach) if over.low < v < over.high
            ]
            if not m.attained and all(lines.has(v, m.width.low * _LEFT) is False for v in sides):
                raise Violation(
                    f"beside {over.name} = {shortest_text(m.at.exact)} no range comes near the longest one"
                )
        unknown += len(claims) == known
    for value, width, expected in claims:
        found = lines.has(value, width)
        unknown += found is None
        if found is (not expected):
            words = "no range so long as is said" if expected else "a longer range than is said"
            raise Violation(f"at {over.name} = {shortest_text(lower(value))} there is {words}")
    told = f"{len(claims)} claims of {len(maxima)} places"
    return Unchecked(f"{told}; {unknown} were not decided") if unknown else told
