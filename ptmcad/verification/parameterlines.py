"""Solutions along one parameter: the values at which counts can change, the counts between, and where
ranges over a second parameter are longest.

The norms of the Jacobian's determinant and of all conditions, and a sum of traces, whose poles are
where solutions leave every bounded set, are rational functions of the parameter. The digits of its
value over a large integer are the coefficients of each (`ptmcad.verification.fibrealgebra`), where
it has the right values over further integers, too. Of angles alone a sum of the coefficients of
characteristic polynomials stands for the traces: a norm is finite and not zero where a solution is
degenerate while another one leaves every bounded set, but then a coefficient has a pole.

Guarantee: counts at a point are exact. That no change is missing holds but for the probability that
a wrong rational function has the right values at `FRESH` random points. Longest ranges, and whether
they are attained, are checked at rational values: those that the claims name, the window's edges,
random ones in an interval and in the window, and all at which the whole line is exceptional: counts
can change there on every line across it, so that it is a common critical value of some random ones.
On a line with degenerate solutions points with another count are sought that leave no room for the
range.

Not guaranteed: longest ranges at irrational values, and of places that are enclosed.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import groupby, pairwise
from math import lcm, prod

from flint import fmpq, fmpz, fmpz_poly

from ptmcad.answer.counts import Counts
from ptmcad.answer.intervals import End, Span, lower, upper
from ptmcad.answer.widths import Maximum, Place
from ptmcad.errors import PoleError
from ptmcad.model import Model
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.expressions import Expression
from ptmcad.text.flint_numbers import from_fraction, simplest_fraction, to_fraction
from ptmcad.text.numerals import shortest_text
from ptmcad.verification.derivation import not_positive
from ptmcad.verification.fibrealgebra import NotFinite, fibre
from ptmcad.verification.planecurves import coefficients
from ptmcad.verification.report import NotKnown, Unchecked, Violation
from ptmcad.verification.rootcounts import isolating_intervals, squarefree

FRESH = 3
BITS = (256, 1024, 4096)
"""Of the integer that rational functions are read off at."""
_SPARE = prod(p for p in range(2, 100) if all(p % q for q in range(2, p))) ** 2
"""Numerator and denominator of a value may have had such factors in common."""
_NARROW = 2**200
"""Ends are known to such shares of the range at least."""


@dataclass(frozen=True, slots=True)
class LineGap(Span):
    """An interval without a critical value, and the counts in it."""

    counts: Counts
    sample: Fraction

    @property
    def working(self) -> int:
        """The number by which an operation range is found."""
        return self.counts.working


@dataclass(frozen=True)
class ParameterLine:
    """A model whose parameters are rational functions of one variable, the first axis, and a range
    of that.

    Attributes
    ----------
    seed : of the points at which rational functions are read off and compared.
    """

    model: Model
    parameters: Mapping[str, Expression]
    low: Fraction
    high: Fraction
    seed: str

    def counts_at(self, value: Fraction) -> Counts | None:
        """The counts at a point; None where a solution is degenerate, and where parameters have no
        meaning.

        Raises
        ------
        NotKnown
            When there are infinitely many solutions, or a parameter has a pole.
        """
        values = self.values_at(value)
        try:
            return (
                None
                if not_positive(self.model, values) is not None
                else fibre(self.model, values).counts()
            )
        except NotFinite:
            raise NotKnown("there are infinitely many solutions") from None

    def values_at(self, value: Fraction) -> dict[str, Fraction]:
        """The parameters at a point.

        Raises
        ------
        NotKnown
            When one has a pole there.
        """
        try:
            return {n: e.evaluate(value, Fraction(0)) for n, e in self.parameters.items()}
        except PoleError as error:
            raise NotKnown(str(error)) from None

    @cached_property
    def critical(self) -> fmpz_poly:
        """A squarefree polynomial that vanishes at every value at which counts can change.

        Raises
        ------
        NotKnown
        """
        source = random.Random(f"line {self.seed}")
        fresh = [(at, self._functions(at)) for at in (source.getrandbits(24) for _ in range(FRESH))]
        for bits in BITS:
            base = source.getrandbits(bits) | 1 << bits
            pairs = [(_read(v.p, base), _read(v.q, base)) for v in self._functions(base)]
            if all(
                p(at) == v * q(at)
                for at, row in fresh
                for (p, q), v in zip(pairs, row, strict=True)
            ):
                terms = [e.denominator for e in self.parameters.values()]
                terms += [e.numerator for e in self._signed]
                zeros = [p for p, _ in pairs[:-1]]
                poles = [q for _, q in pairs]
                product = fmpz_poly([1])
                for part in filter(None, (*zeros, *poles, *map(_row, filter(None, terms)))):
                    product = squarefree(product * squarefree(part))
                return product // int(product.content())
        raise NotKnown("the critical values have too long polynomials")

    @property
    def _signed(self) -> list[Expression]:
        """The parameters whose signs have a meaning."""
        signed = (*self.model.positive, *self.model.nonnegative)
        return [self.parameters[name] for name in signed if name in self.parameters]

    def _functions(self, at: int) -> list[fmpq]:
        """The values of the rational functions over an integer: norms, and one of which only the
        poles say something.

        Raises
        ------
        NotKnown
        """
        try:
            found = fibre(self.model, self.values_at(Fraction(at)))
        except NotFinite:
            raise NotKnown("there are infinitely many solutions at random points") from None
        norms = [found.norm(), *(found.norm_where_nonzero(p) for p in found.conditions)]
        if norms[0] == 0:
            raise NotKnown("there is a degenerate solution at random points")
        form = random.Random(f"form {self.seed}")
        values = (
            found.form_traces([form.getrandbits(10) for _ in range(found.point.coordinates)])
            if self.model.reals
            else found.coefficients()
        )
        return [*norms, sum((v * form.getrandbits(10) for v in values), fmpq(0))]

    def gaps(self) -> list[LineGap]:
        """The intervals between critical values, in increasing order.

        Raises
        ------
        NotKnown
        """
        coefficients = tuple(int(c) for c in self.critical.coeffs())
        roots = isolating_intervals(
            self.critical, from_fraction(self.low), from_fraction(self.high)
        )
        width = (self.high - self.low) / _NARROW
        inner = (
            AlgebraicNumber(coefficients, to_fraction(a), to_fraction(b)).refined(width)
            for a, b in roots
        )
        ends: list[End] = [self.low, *inner, self.high]
        found = []
        for a, b in pairwise(ends):
            third = (lower(b) - upper(a)) / 3
            sample = simplest_fraction(upper(a) + third, lower(b) - third)
            counts = self.counts_at(sample)
            if counts is None:
                raise NotKnown(
                    "a solution is degenerate between critical values, or a parameter has no meaning"
                )
            found.append(LineGap(a, b, counts, sample))
        return found

    def ranges(self, working: int) -> list[Span]:
        """Where there are so many stable solutions."""
        return ranges_in(self.gaps(), working)


def ranges_in(gaps: Sequence[LineGap], working: int) -> list[Span]:
    """Where there are so many stable solutions: neighbours that differ in others only are one
    range.
    """
    groups = (
        (inside, list(group)) for inside, group in groupby(gaps, lambda g: g.working == working)
    )
    return [Span(group[0].low, group[-1].high) for inside, group in groups if inside]


def _read(value: fmpz, base: int) -> fmpz_poly:
    """The integer polynomial with small coefficients that has a value, times `_SPARE`, at a large
    number.
    """
    rest, row = int(value) * _SPARE, []
    while rest:
        digit = (rest + base // 2) % base - base // 2
        row.append(digit)
        rest = (rest - digit) // base
    return fmpz_poly(row)


def _row(terms: Sequence[tuple[int, int, Fraction]]) -> fmpz_poly:
    """A multiple of a polynomial in the first axis."""
    scale = lcm(*(c.denominator for _, _, c in terms))
    return coefficients(tuple((i, 0, int(c * scale)) for i, _, c in terms))[0]


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
    seed : of the random values.
    """

    at: Callable[[Fraction], ParameterLine]
    across: Callable[[Fraction], ParameterLine]
    along: Axis
    over: Axis
    working: int
    seed: str

    def between(self, low: Fraction, high: Fraction, number: int) -> list[Fraction]:
        """Random values in an interval."""
        source = random.Random(f"{low} {high} {self.seed}")
        return [low + (high - low) * Fraction(source.randrange(1, 64), 64) for _ in range(number)]

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
        for value in self.between(self.along.low, self.along.high, ACROSS):
            common = common.gcd(self.across(value).critical)
        linear = [factor for factor, _ in common.factor()[1] if factor.degree() == 1]
        values = [Fraction(-int(factor[0]), int(factor[1])) for factor in linear]
        return [value for value in values if self.over.low < value < self.over.high]


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
    others = lines.between(over.low, over.high, INSIDE)
    claims += [(value, most + reach, False) for value in (*special, *others)]
    for m in maxima:
        known = len(claims)
        if m.place is Place.PLATEAU:
            inside = [
                *lines.between(m.at.low, m.at.high, INSIDE),
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
    checked = f"{len(claims)} claims of {len(maxima)} places; seed {lines.seed}"
    return Unchecked(f"{checked}; {unknown} were not decided") if unknown else checked
