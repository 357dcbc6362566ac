"""The intervals of constant count along a line of a slice, with exact ends.

Guarantee: exact. The window's part of the line, less the critical values, is cut into open intervals; in each the
equilibria are nondegenerate, their number and indices are constant, and they were counted at a rational sample. Ends
are real algebraic numbers. Neighbours with equal counts are joined, and the critical value between them is kept among
the changes.

The line's own discriminant variety is computed, in one parameter: its components are the irreducible factors of the
norm of det H over Q(x). So nothing depends on how a basis over the plane specialises, and that the ends are those of
the map's walls is a test of both.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import Any

from flint import fmpq

from ptmcad.algebra.numbers import in_order, refined, roots_in
from ptmcad.algebra.polynomials import Ratio, from_expression, from_fraction
from ptmcad.algebra.real_roots import simplest_between
from ptmcad.enclosure import AlgebraicNumber, Enclosure
from ptmcad.errors import ConfigError, DegenerateSliceError, ExpressionError, InfiniteSolutionsError
from ptmcad.exactmap import count_at, domain_limits
from ptmcad.expressions import Expression, axis, constant, rational
from ptmcad.models import ParametricSystem, system_of
from ptmcad.numerals import shortest_text
from ptmcad.regionmap import Kind, MorseIndex
from ptmcad.slice import Axis, Slice, without_free_lengths
from ptmcad.variety import discriminant_variety

End = AlgebraicNumber | Fraction
"""A critical value, or the window's edge."""
FINE = Fraction(1, 2**100)
"""Width of the ends' isolating intervals, against the window's."""


class Event(Enum):
    """What happens to the numbers of equilibria at a critical value: which of them meet, only a path tells."""

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
class Line:
    """The part of a slice that lies on a line: parameters as expressions in ``along``, the first axis."""

    along: Axis
    at: Mapping[str, Fraction]
    parameters: Mapping[str, Expression]

    def place(self, value: fmpq | Fraction) -> str:
        """A point of the line in words."""
        fixed = (f"{name} = {shortest_text(v)}" for name, v in self.at.items())
        return ", ".join([f"{self.along.name} = {value}", *fixed])


def varying_axis(slice: Slice, along: str, at: Mapping[str, Any]) -> tuple[int, str, Fraction]:
    """The number of the axis that varies on a line, and the other axis with its value.

    Raises
    ------
    ConfigError
        When ``along`` is no axis, or ``at`` does not name exactly the other one with an exact number.
    """
    names = slice.axis_names
    if along not in names:
        raise ConfigError(f"{along} is not an axis of the slice: choose {names[0]} or {names[1]}", key="along")
    varying = names.index(along)
    other = names[1 - varying]
    if set(at) != {other}:
        given = ", ".join(map(str, at)) or "nothing"
        raise ConfigError(
            f"a line along {along} needs a value of {other} and of nothing else, not of {given}", key="at"
        )
    try:
        return varying, other, rational(at[other])
    except ExpressionError as error:
        raise ConfigError(str(error), key=f"at {other}") from error


def line_of(slice: Slice, along: str, at: Mapping[str, Any]) -> Line:
    """The line of a slice on which one axis varies and the other is fixed.

    Raises
    ------
    ConfigError
        When ``along`` is no axis, ``at`` does not name exactly the other one, its value is not an exact number, a
        parameter is not defined on the line, or springs have a free length on it.
    """
    varying, other, value = varying_axis(slice, along, at)
    try:
        parameters = {n: restricted(e, varying, value) for n, e in slice.parameters.items()}
    except ExpressionError as error:
        raise ConfigError(str(error), key=f"at {other}") from error
    parameters = without_free_lengths(
        parameters, "exact ends and paths of poses are", "ptmcad range with --at alone encloses the ends"
    )
    return Line(slice.axes[varying], {other: value}, parameters)


def restricted(expression: Expression, varying: int, value: Fraction) -> Expression:
    """A rational function of the slice on the line where the other axis has a value, in the first axis."""

    def on_line(terms: tuple[tuple[int, int, Fraction], ...]) -> Expression:
        total = constant(0)
        for term in terms:
            powers, c = term[:2], term[2]
            total = total + axis(0) ** powers[varying] * (c * value ** powers[1 - varying])
        return total

    return on_line(expression.numerator) / on_line(expression.denominator)


def intervals(slice: Slice, along: str, at: Mapping[str, Any]) -> CountIntervals:
    """The intervals of constant count on a line of a slice.

    Parameters
    ----------
    along : the axis that varies, over its window.
    at : the other axis with its value: text, int or Fraction.

    Raises
    ------
    ConfigError
        See `line_of`.
    DegenerateSliceError
        When the line lies inside the discriminant variety: every point of it has a singular equilibrium.
    InfiniteSolutionsError
        When every point of it has infinitely many equilibria.
    GeometryError
        When a length or a stiffness is not positive on it.
    """
    line = line_of(slice, along, at)
    found = critical_values(line)
    numbers = tuple(number for number, _ in found)
    kinds = dict(found)
    samples = samples_between(line.along, numbers)
    counts = [index_at(line, sample) for sample in samples]
    changes = tuple(Change(n, kinds[n], counts[k], counts[k + 1]) for k, n in enumerate(numbers))
    return CountIntervals(
        slice.name,
        slice.mechanism,
        line.along,
        line.at,
        line.parameters,
        tuple(_joined(line.along, numbers, samples, counts)),
        changes,
    )


def system_on(line: Line, mechanism: str = "ptm") -> tuple[ParametricSystem, dict[str, Ratio]]:
    """The mechanism's system and its parameters on the line, for the engine."""
    system = system_of(mechanism)
    return system, {name: from_expression(line.parameters[name]) for name in system.ring.parameters}


def critical_values(line: Line) -> tuple[tuple[AlgebraicNumber, Kind], ...]:
    """The line's discriminant variety in the window, in increasing order.

    The isolating intervals are disjoint.

    Raises
    ------
    DegenerateSliceError, InfiniteSolutionsError
        See `intervals`.
    """
    system, parameters = system_on(line)
    low, high = line.along.low, line.along.high
    window = (from_fraction(low), from_fraction(high))
    where = ", ".join(f"{name} = {shortest_text(value)}" for name, value in line.at.items())
    try:
        # the second axis does not occur, so any range serves for it
        variety = discriminant_variety(
            system, parameters, (window, (fmpq(0), fmpq(1))), domain_limits(system, parameters), frozenset({"infinity"})
        )
    except DegenerateSliceError as error:
        raise DegenerateSliceError(
            f"the line {where} lies inside the discriminant variety: at every {line.along.name} some equilibrium has a "
            "singular Hessian; fix another value"
        ) from error
    except InfiniteSolutionsError as error:
        raise InfiniteSolutionsError(
            f"on the line {where} the equations have infinitely many solutions at every {line.along.name} (complex "
            "ones included); fix another value"
        ) from error
    numbers, kinds = [], {}
    for component in variety.components:
        if not component.left_out:
            for number in roots_in(component.polynomial, low, high):
                numbers.append(number)
                kinds[number.polynomial] = component.kind
    ordered = in_order(numbers, low, high, (high - low) * FINE)
    return tuple((number, kinds[number.polynomial]) for number in ordered)


def samples_between(along: Axis, numbers: tuple[AlgebraicNumber, ...]) -> tuple[Fraction, ...]:
    """Simple rationals below, between and above the given numbers, in the window."""
    lows = [along.low, *(n.high for n in numbers)]
    highs = [*(n.low for n in numbers), along.high]
    samples = (simplest_between(from_fraction(a), from_fraction(b)) for a, b in zip(lows, highs, strict=True))
    return tuple(Fraction(int(s.p), int(s.q)) for s in samples)


def index_at(line: Line, value: Fraction) -> MorseIndex:
    """Numbers of minima, saddles and maxima at a rational value that is not critical."""
    system, parameters = system_on(line)
    return count_at(line.place(value), system, parameters, (from_fraction(value), fmpq(0))).counts.index


def _joined(
    along: Axis, numbers: tuple[AlgebraicNumber, ...], samples: tuple[Fraction, ...], counts: list[MorseIndex]
) -> Iterator[CountInterval]:
    """The intervals, those with equal counts joined."""
    ends: list[End] = [along.low, *numbers, along.high]
    start = 0
    for k, index in enumerate(counts):
        if k + 1 == len(counts) or counts[k + 1] != index:
            yield CountInterval(ends[start], ends[k + 1], index, samples[start])
            start = k + 1


def finer(interval: CountInterval, width: Fraction) -> CountInterval:
    """The same interval with its ends isolated within ``width`` > 0."""
    low, high = (e if isinstance(e, Fraction) else refined(e, width) for e in (interval.low, interval.high))
    return CountInterval(low, high, interval.index, interval.sample)
