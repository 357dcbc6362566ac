"""The intervals of constant count along a line of a slice, as data.

Guarantee: ends are exact. Where springs have free lengths on the line they are enclosed, and what
was not decided lies in the changes.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from itertools import groupby, pairwise
from operator import eq, le

from ptmcad.answer import with_methods
from ptmcad.answer.counts import Counts, MorseIndex, euler_sum
from ptmcad.answer.regionmap import Continuum, Kind
from ptmcad.model import Model
from ptmcad.model.criterion import critical_point
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.expressions import Expressions
from ptmcad.text.numerals import Bounds, Numbers

End = AlgebraicNumber | Fraction
"""A critical value, or the window's edge."""
AnyEnd = End | Enclosure
"""The same, or an enclosure of one."""


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
    before, after : the numbers of solutions on the two sides; None where they are not known.
    kind : of an exact value, that of the variety's component through it.
    continuum : whether there are infinitely many solutions at the value; None where that is not
        known.
    names : of an enclosed value, the curves that are met.
    proved : whether each of these was proved to be met exactly; if not, there may be no critical
        value.
    """

    at: AlgebraicNumber | Enclosure
    before: Counts | None
    after: Counts | None
    kind: Kind | None = None
    continuum: Continuum | None = None
    names: tuple[str, ...] = ()
    proved: bool = True

    @property
    def event(self) -> Event | None:
        """None where the numbers on a side are not known."""
        before, after = self.before, self.after
        if before is None or after is None:
            return None
        if before == after:
            return Event.UNCHANGED
        if (first := _pair(before, after)) is not None:
            return Event.UNSTABLE_PAIR if first else Event.STABLE_PAIR
        change = abs(after.total - before.total)
        if change == 2 and before.index is None:
            return Event.PAIR
        return {0: Event.STABILITY, 1: Event.SINGLE}.get(change, Event.SEVERAL)

    @property
    def text(self) -> str:
        """The event in words, read in the direction of growing values; the curves that are met,
        where the value is enclosed.
        """
        if self.names:
            # without how it was looked for: folds with and without a short spring may be the same
            kinds = dict.fromkeys(name.partition(" with ")[0] for name in self.names)
            if self.proved:
                return " and ".join(kinds)
            return f"undecided whether there is a {' or a '.join(kinds)}"
        if self.before is None or self.after is None or self.event is None:
            return ""
        change = _words(self.event, self.before, self.after)
        if self.continuum is None:
            return change
        many = "equilibria" if self.before.index is not None else "solutions"
        further = "" if self.event is Event.UNCHANGED else f", {change}"
        return f"{self.continuum.value} {many}{further}"


def _pair(before: Counts, after: Counts) -> int | None:
    """The smaller index of the two solutions that are more or less by one; None when no two
    neighbours are.
    """
    if before.index is None or after.index is None:
        return None
    changed = {
        k: b - a for k, (a, b) in enumerate(zip(before.index, after.index, strict=True)) if a != b
    }
    first = min(changed, default=0)
    pair = changed in ({first: 1, first + 1: 1}, {first: -1, first + 1: -1})
    return first if pair else None


def _words(event: Event, before: Counts, after: Counts) -> str:
    what, first = str(event.value), _pair(before, after)
    if event is Event.STABILITY and before.index is None:
        return "solutions change their stability"
    if event in (Event.UNCHANGED, Event.STABILITY):
        return what
    # pairs keep the alternating sum of the indices; what comes from infinity need not
    if event is Event.SEVERAL and not (
        before.index and after.index and euler_sum(before.index) == euler_sum(after.index)
    ):
        what = "several solutions"
    if first is not None and before.index is not None:
        names = [critical_point(k, len(before.index) - 1) for k in (first, first + 1)]
        what = " and ".join(
            f"one {'stable equilibrium' if name == 'minimum' else name}" for name in names
        )
        what = "two saddles" if names == ["saddle", "saddle"] else what
    return f"{'gains' if after.total > before.total else 'loses'} {what}"


@dataclass(frozen=True, slots=True)
class Span:
    """An interval of the line by its ends; a Fraction is the window's edge."""

    low: AnyEnd
    high: AnyEnd

    @property
    def exact(self) -> tuple[End, End]:
        """Both ends, of an interval between exact ones."""
        low, high = self.low, self.high
        if isinstance(low, Enclosure) or isinstance(high, Enclosure):
            raise TypeError("the interval is enclosed")
        return low, high

    @property
    def width(self) -> Enclosure:
        """Its length, as narrowly as the ends are isolated."""
        return Enclosure(lower(self.high) - upper(self.low), upper(self.high) - lower(self.low))


@dataclass(frozen=True, slots=True)
class CountInterval(Span):
    """A maximal open interval of constant count.

    Attributes
    ----------
    counts : None where nothing could be decided at ``sample``.
    sample : a rational number in it that is no critical value.
    peaks : of an enclosed interval, configurations in which springs have no length and the energy
        has a peak, where they are known.
    """

    counts: Counts | None
    sample: Fraction
    peaks: int | None = None

    @property
    def total(self) -> int | None:
        return None if self.counts is None else self.counts.total

    @property
    def stable(self) -> int | None:
        return None if self.counts is None else self.counts.stable

    @property
    def index(self) -> MorseIndex | None:
        return None if self.counts is None else self.counts.index

    @property
    def working(self) -> int | None:
        """The number by which an operation range is found; None where nothing is decided."""
        return None if self.counts is None else self.counts.working


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
    enclosed : whether ends and changes are enclosures, as springs have free lengths; then there
        may be more than ``working`` stable solutions in the operation range.
    """

    name: str
    model: Model
    along: Axis
    at: Numbers
    parameters: Expressions
    intervals: tuple[CountInterval, ...]
    changes: tuple[Change, ...]
    working: int
    enclosed: bool = False

    @property
    def mechanism(self) -> str:
        """The model's name."""
        return self.model.name

    def __repr__(self) -> str:
        found = ", ".join("?" if i.working is None else str(i.working) for i in self.intervals)
        return f"<CountIntervals of {self.name} along {self.along.name}: {found} in turn>"

    @property
    def decided(self) -> bool:
        """Whether counts are known on all intervals, and between them nothing is open."""
        return all(i.counts is not None for i in self.intervals) and all(
            change.proved for change in self.changes
        )

    @property
    def stretches(self) -> list[Bounds]:
        """Intervals without a critical value, between rational numbers, from the lower edge to the
        upper one.
        """
        ends: list[AnyEnd] = [
            self.along.low,
            *(change.at for change in self.changes),
            self.along.high,
        ]
        return [(upper(a), lower(b)) for a, b in pairwise(ends) if upper(a) < lower(b)]

    @property
    def operation(self) -> tuple[OperationSpan, ...]:
        """The operation range: where there are so many stable solutions, or of enclosed intervals at
        least so many; of the paper's mechanism two.
        """
        works = le if self.enclosed else eq
        groups = groupby(
            self.intervals, lambda i: i.working is not None and works(self.working, i.working)
        )
        members = [tuple(group) for inside, group in groups if inside]
        return tuple(OperationSpan(group[0].low, group[-1].high, group) for group in members)


def lower(end: AnyEnd) -> Fraction:
    """A rational not above the end."""
    return end if isinstance(end, Fraction) else end.low


def upper(end: AnyEnd) -> Fraction:
    """A rational not below the end."""
    return end if isinstance(end, Fraction) else end.high
