"""Solutions along one parameter: the values at which counts can change, read off one fibre, and
counts between.

The norms of the Jacobian's determinant and of all conditions, and a sum of traces, whose poles are
where solutions leave every bounded set, are rational functions of the parameter. The digits of its
value over a large integer are the coefficients of each (`ptmcad.verification.fibre`), where it has
the right values over further integers, too.

Guarantee: counts at a point are exact. That no change is missing holds but for the probability that
a wrong rational function has the right values at `FRESH` random points.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import groupby, pairwise
from math import lcm, prod

from flint import fmpq, fmpz, fmpz_poly

from ptmcad.answer.counts import Counts
from ptmcad.answer.intervals import End, Span, lower, upper
from ptmcad.errors import PoleError
from ptmcad.model import Model
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.expressions import Expression
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.verification.algebra import NotFinite
from ptmcad.verification.counts import not_positive
from ptmcad.verification.fibre import fibre
from ptmcad.verification.sturm import isolating_intervals, squarefree

FRESH = 3
BITS = (256, 1024, 4096)
"""Of the integer that rational functions are read off at."""
_SPARE = prod(p for p in range(2, 100) if all(p % q for q in range(2, p))) ** 2
"""Numerator and denominator of a value may have had such factors in common."""
_NARROW = 2**200
"""Ends are known to such shares of the range at least."""


class NotKnown(ArithmeticError):
    """Where counts can change on the line was not found out."""


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
    """

    model: Model
    parameters: Mapping[str, Expression]
    low: Fraction
    high: Fraction

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
        source = random.Random(repr(self.parameters))
        fresh = [(at, self._functions(at)) for at in (source.getrandbits(24) for _ in range(FRESH))]
        for bits in BITS:
            base = source.getrandbits(bits) | 1 << bits
            pairs = [(_read(v.p, base), _read(v.q, base)) for v in self._functions(base)]
            if all(
                p(at) == v * q(at)
                for at, row in fresh
                for (p, q), v in zip(pairs, row, strict=True)
            ):
                terms = [
                    part
                    for e in self.parameters.values()
                    for part in (e.numerator, e.denominator)
                    if part
                ]
                product = fmpz_poly([1])
                for part in filter(None, (*(p for pair in pairs for p in pair), *map(_row, terms))):
                    product = squarefree(product * squarefree(part))
                return product // int(product.content())
        raise NotKnown("the critical values have too long polynomials")

    def _functions(self, at: int) -> list[fmpq]:
        """The values of the rational functions over an integer.

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
        if self.model.reals:
            form = random.Random("form")
            traces = found.form_traces(
                [form.getrandbits(10) for _ in range(found.point.coordinates)]
            )
            norms.append(sum((t * form.getrandbits(10) for t in traces), fmpq(0)))
        return norms

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
            sample = simple_between(upper(a) + third, lower(b) - third)
            counts = self.counts_at(sample)
            if counts is None:
                raise NotKnown(
                    "a solution is degenerate between critical values, or a parameter has no meaning"
                )
            found.append(LineGap(a, b, counts, sample))
        return found

    def ranges(self, working: int) -> list[Span]:
        """Where there are so many stable solutions: neighbours that differ in others only are one
        range.
        """
        groups = (
            (inside, list(group))
            for inside, group in groupby(self.gaps(), lambda g: g.working == working)
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
    row = {i: int(c * scale) for i, _, c in terms}
    return fmpz_poly([row.get(i, 0) for i in range(1 + max(row))])


def simple_between(low: Fraction, high: Fraction) -> Fraction:
    """A number of few digits between two others, or one of them: a fibre's numbers get long with
    its digits.
    """
    middle, most = (low + high) / 2, 1
    while not low <= (found := middle.limit_denominator(most)) <= high:
        most *= 2
    return found
