"""The intervals of constant count along a line of a slice, as data.

Guarantee: ends are exact, or enclosures where the certified engine found them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from itertools import groupby, pairwise

from ptmcad.answer import with_methods
from ptmcad.answer.counts import Counts, MorseIndex, euler_sum
from ptmcad.answer.regionmap import Continuum, Kind
from ptmcad.model import Model
from ptmcad.model.criterion import critical_point
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.expressions import Expressions
from ptmcad.text.numerals import Numbers

End = AlgebraicNumber | Fraction
"""A critical value, or the window's edge."""


class Event(Enum):
    """What happens to the numbers of solutions at a critical value: which of them meet, only a path
    shows.
    """

    STABLE_PAIR = "a stable critical point and one of index 1"
    UNSTABLE_PAIR = "two unstable critical points"
    PAIR = "two solutions"
    SINGLE = "one solution"
    STABILITY = "indices change without a pair"
    SEVERAL = "several pairs"
    UNCHANGED = "the counts do not change"


@dataclass(frozen=True, slots=True)
class Change:
    """A critical value.

    Attributes
    ----------
    kind : the kind of the variety's component through it.
    before, after : the numbers of solutions on the two sides.
    continuum : whether there are infinitely many solutions at the value; None where that is not
        known.
    """

    at: AlgebraicNumber
    kind: Kind
    before: Counts
    after: Counts
    continuum: Continuum | None = None

    @property
    def event(self) -> Event:
        if self.before == self.after:
            return Event.UNCHANGED
        if (first := self._pair()) is not None:
            return Event.UNSTABLE_PAIR if first else Event.STABLE_PAIR
        change = abs(self.after.total - self.before.total)
        if change == 2 and self.before.index is None:
            return Event.PAIR
        return {0: Event.STABILITY, 1: Event.SINGLE}.get(change, Event.SEVERAL)

    def _pair(self) -> int | None:
        """The smaller index of the two solutions that are more or less by one; None when no two
        neighbours are.
        """
        if self.before.index is None or self.after.index is None:
            return None
        changed = {
            k: b - a
            for k, (a, b) in enumerate(zip(self.before.index, self.after.index, strict=True))
            if a != b
        }
        first = min(changed, default=0)
        pair = changed in ({first: 1, first + 1: 1}, {first: -1, first + 1: -1})
        return first if pair else None

    def _balanced(self) -> bool:
        """Whether the alternating sum of the indices stays, as pairs keep it; what comes from
        infinity need not.
        """
        if self.before.index is None or self.after.index is None:
            return False
        return euler_sum(self.before.index) == euler_sum(self.after.index)

    @property
    def text(self) -> str:
        """The event in words, read in the direction of growing values."""
        if self.continuum is None:
            return self._change()
        many = "equilibria" if self.before.index is not None else "solutions"
        change = "" if self.event is Event.UNCHANGED else f", {self._change()}"
        return f"{self.continuum.value} {many}{change}"

    def _change(self) -> str:
        event, first = self.event, self._pair()
        if event is Event.UNCHANGED:
            return str(event.value)
        if event is Event.STABILITY:
            return (
                str(event.value)
                if self.before.index is not None
                else "solutions change their stability"
            )
        what = (
            "several solutions" if event is Event.SEVERAL and not self._balanced() else event.value
        )
        if first is not None and self.before.index is not None:
            names = [critical_point(k, len(self.before.index) - 1) for k in (first, first + 1)]
            what = " and ".join(
                f"one {'stable equilibrium' if name == 'minimum' else name}" for name in names
            )
            what = "two saddles" if names == ["saddle", "saddle"] else what
        return f"{'gains' if self.after.total > self.before.total else 'loses'} {what}"


@dataclass(frozen=True, slots=True)
class Span:
    """An interval of the line by its ends; a Fraction is the window's edge."""

    low: End
    high: End

    @property
    def width(self) -> Enclosure:
        """Its length, as narrowly as the ends are isolated."""
        return Enclosure(lower(self.high) - upper(self.low), upper(self.high) - lower(self.low))


@dataclass(frozen=True, slots=True)
class CountInterval(Span):
    """A maximal open interval of constant count.

    Attributes
    ----------
    sample : a rational number in it that is no critical value.
    """

    counts: Counts
    sample: Fraction

    @property
    def total(self) -> int:
        return self.counts.total

    @property
    def stable(self) -> int | None:
        return self.counts.stable

    @property
    def index(self) -> MorseIndex | None:
        return self.counts.index


@dataclass(frozen=True, slots=True)
class OperationSpan(Span):
    """A part of the operation range: neighbours that differ in unstable solutions only."""

    parts: tuple[CountInterval, ...]


@with_methods
@dataclass(frozen=True, slots=True)
class CountIntervals:
    """The answer for a line.

    Attributes
    ----------
    name : of the slice.
    along : the axis with its window.
    at : what was fixed on the line.
    parameters : every parameter of the model as an expression in ``along`` (its first axis; no
        second one occurs).
    intervals : from the window's lower edge to its upper one.
    changes : all critical values in the window in increasing order, those where no count changes
        among them.
    working : the number of stable solutions in the operation range, or of all where nothing says
        what is stable.
    """

    name: str
    model: Model
    along: Axis
    at: Numbers
    parameters: Expressions
    intervals: tuple[CountInterval, ...]
    changes: tuple[Change, ...]
    working: int

    @property
    def mechanism(self) -> str:
        """The model's name."""
        return self.model.name

    def __repr__(self) -> str:
        found = ", ".join(str(i.counts.working) for i in self.intervals)
        return f"<CountIntervals of {self.name} along {self.along.name}: {found} in turn>"

    @property
    def stretches(self) -> list[tuple[Fraction, Fraction]]:
        """Intervals without a critical value, between rational numbers, from the lower edge to the
        upper one.
        """
        ends: list[End] = [self.along.low, *(change.at for change in self.changes), self.along.high]
        return [(upper(a), lower(b)) for a, b in pairwise(ends)]

    @property
    def operation(self) -> tuple[OperationSpan, ...]:
        """The operation range: where there are so many stable solutions; of the paper's mechanism
        two.
        """
        groups = groupby(self.intervals, lambda i: i.counts.working == self.working)
        members = [list(group) for inside, group in groups if inside]
        return tuple(OperationSpan(group[0].low, group[-1].high, tuple(group)) for group in members)


def lower(end: End) -> Fraction:
    """A rational not above the end."""
    return end if isinstance(end, Fraction) else end.low


def upper(end: End) -> Fraction:
    """A rational not below the end."""
    return end if isinstance(end, Fraction) else end.high


@dataclass(frozen=True, slots=True)
class CertifiedInterval:
    """An open interval, its ends' enclosures (exact at the window's edge), and the counts on it.

    ``total`` is None when nothing could be decided at ``sample``; ``index`` is, too, where there is
    no potential, and ``cones``, but for the paper's mechanism. ``stable`` is None where nothing
    says what is stable.
    """

    low: Enclosure
    high: Enclosure
    index: MorseIndex | None
    cones: int | None
    sample: Fraction
    total: int | None
    stable: int | None = None

    @property
    def working(self) -> int | None:
        """The number by which an operation range is found, as that of `Counts`; None where nothing
        is decided.
        """
        return self.total if self.stable is None else self.stable


@dataclass(frozen=True, slots=True)
class CertifiedChange:
    """What lies between two intervals: the curves met there; ``proved`` when each was proved to be
    met exactly.
    """

    at: Enclosure
    names: tuple[str, ...]
    proved: bool


@dataclass(frozen=True, slots=True)
class CertifiedIntervals:
    """The answer for a line, from the window's lower edge to its upper one."""

    along: Axis
    at: Numbers
    intervals: tuple[CertifiedInterval, ...]
    changes: tuple[CertifiedChange, ...]

    @property
    def stretches(self) -> list[tuple[Fraction, Fraction]]:
        """Intervals without a critical value, between rational numbers, from the lower edge to the
        upper one.
        """
        return [(interval.low.high, interval.high.low) for interval in self.intervals]
