"""The intervals of constant count along a line of a slice, as data.

Guarantee: ends are exact, or enclosures where the certified engine found them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from ptmcad.answer.regionmap import Kind, MorseIndex
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.expressions import Expression

End = AlgebraicNumber | Fraction
"""A critical value, or the window's edge."""


class Event(Enum):
    """What happens to the numbers of equilibria at a critical value: which of them meet, only a path shows."""

    STABLE_PAIR = "one stable equilibrium and one saddle"
    UNSTABLE_PAIR = "one saddle and one maximum"
    STABILITY = "indices change without a pair"
    SEVERAL = "several pairs"
    UNCHANGED = "the counts do not change"


@dataclass(frozen=True, slots=True)
class Change:
    """A critical value.

    Attributes
    ----------
    kind : the kind of the variety's component through it.
    before, after : numbers of minima, saddles and maxima on the two sides.
    """

    at: AlgebraicNumber
    kind: Kind
    before: MorseIndex
    after: MorseIndex

    @property
    def event(self) -> Event:
        minima, saddles, maxima = (b - a for a, b in zip(self.before, self.after, strict=True))
        if (minima, saddles, maxima) == (0, 0, 0):
            return Event.UNCHANGED
        if abs(saddles) == 1:
            return Event.STABLE_PAIR if minima == saddles else Event.UNSTABLE_PAIR
        return Event.STABILITY if saddles == 0 else Event.SEVERAL

    @property
    def text(self) -> str:
        """The event in words, read in the direction of growing values."""
        event = self.event
        if event in (Event.UNCHANGED, Event.STABILITY):
            return str(event.value)
        grows = sum(self.after) > sum(self.before)
        return f"{event.value} {'more' if grows else 'less'}"


@dataclass(frozen=True, slots=True)
class CountInterval:
    """A maximal open interval of constant count.

    Attributes
    ----------
    low, high : its ends; a Fraction is the window's edge.
    index : numbers of minima, saddles and maxima.
    sample : a rational number in it that is no critical value.
    """

    low: End
    high: End
    index: MorseIndex
    sample: Fraction

    @property
    def total(self) -> int:
        return sum(self.index)

    @property
    def stable(self) -> int:
        return self.index[0]

    @property
    def width(self) -> Enclosure:
        """Its length, as narrowly as the ends are isolated."""
        return Enclosure(lower(self.high) - upper(self.low), upper(self.high) - lower(self.low))


@dataclass(frozen=True, slots=True)
class CountIntervals:
    """The answer for a line.

    Attributes
    ----------
    name : of the slice.
    along : the axis with its window.
    at : what was fixed on the line.
    parameters : every parameter of the mechanism as an expression in ``along`` (its first axis; no second one occurs).
    intervals : from the window's lower edge to its upper one.
    changes : all critical values in the window in increasing order, those where no count changes among them.
    """

    name: str
    mechanism: str
    along: Axis
    at: Mapping[str, Fraction]
    parameters: Mapping[str, Expression]
    intervals: tuple[CountInterval, ...]
    changes: tuple[Change, ...]

    @property
    def operation(self) -> tuple[CountInterval, ...]:
        """The paper's operation range: the intervals with two stable equilibria."""
        return tuple(i for i in self.intervals if i.stable == 2)


def lower(end: End) -> Fraction:
    """A rational not above the end."""
    return end if isinstance(end, Fraction) else end.low


def upper(end: End) -> Fraction:
    """A rational not below the end."""
    return end if isinstance(end, Fraction) else end.high


@dataclass(frozen=True, slots=True)
class CertifiedInterval:
    """An open interval, its ends' enclosures (exact at the window's edge), and the counts on it.

    ``index`` and ``cones`` are None when nothing could be decided at ``sample``.
    """

    low: Enclosure
    high: Enclosure
    index: MorseIndex | None
    cones: int | None
    sample: Fraction


@dataclass(frozen=True, slots=True)
class CertifiedChange:
    """What lies between two intervals: the curves met there; ``proved`` when each was proved to be met exactly."""

    at: Enclosure
    names: tuple[str, ...]
    proved: bool


@dataclass(frozen=True, slots=True)
class CertifiedIntervals:
    """The answer for a line, from the window's lower edge to its upper one."""

    along: Axis
    at: Mapping[str, Fraction]
    intervals: tuple[CertifiedInterval, ...]
    changes: tuple[CertifiedChange, ...]


@dataclass(frozen=True, slots=True)
class CriticalFreeLength:
    """A degenerate solution: its free length, and the signs of l1, l2 and l3; (1, 1, 1) is a pose."""

    free: Enclosure
    signs: tuple[int, int, int]

    @property
    def fold(self) -> bool:
        """Whether equilibria of the mechanism meet here: positive lengths and a positive free length."""
        return self.signs == (1, 1, 1) and self.free.low > 0
