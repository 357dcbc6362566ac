"""The ranges of a count on any line of a slice: one in the discriminant variety, or at an algebraic
value, too.

Guarantee: exact. In the ranges that are certain the count is the wanted one at all but finitely
many points; elsewhere, off those that are possible, it is another one. The two differ where a
degenerate solution may be stable, or where there are infinitely many complex solutions of a system
of several unknowns.

The value of the other axis is one more unknown, a root of its polynomial (`with_root`). Over Q(x),
x being the axis along the line, the solutions may be multiple. Hermite's form still tells the
different ones: while the lowest coefficient of its characteristic polynomial that is not zero
identically has no zero, its rank, the number of different solutions, is constant, so that none of
them meet; and while that of the multiplication by a condition has none, no condition changes its
sign at a solution at which it is not zero all along.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.number_field import points, value_at
from ptmcad.algebra.plane_determinants import determinant
from ptmcad.algebra.polynomials import (
    ONE,
    PLANE,
    Ratio,
    UnivariatePolynomial,
    UnknownPolynomial,
    add_ratios,
    coefficients_in,
    from_expression,
)
from ptmcad.algebra.quotient_algebra import (
    QuotientAlgebra,
    matrix_of,
    multiples,
    multiplication_denominator,
    trace_form,
)
from ptmcad.algebra.real_roots import algebraic_number, gaps, in_order, isolate
from ptmcad.algebra.trigonometric_ring import RationalPolynomial
from ptmcad.answer.intervals import End, Span
from ptmcad.errors import ConfigError, DegenerateSliceError, HypothesisError, InfiniteSolutionsError
from ptmcad.exact.cad.stacks import BaseEnd
from ptmcad.exact.discriminant_variety import algebra_of
from ptmcad.exact.models import ParametricSystem, system_from
from ptmcad.exact.models.system import ALONG, SliceSystem, lifted, on_slice, saturated, with_root
from ptmcad.exact.point_system import DegeneratePoint, point_system
from ptmcad.exact.ranges.exactline import END_WIDTH, intervals, runs
from ptmcad.exact.ranges.rangestrips import RangeStrips
from ptmcad.exact.statics import sign_of
from ptmcad.question.line import line_of
from ptmcad.question.slice import Axis, Slice
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.flint_numbers import from_fraction, interval_of, simplest_between

MAX_DIMENSION = 40
"""Complex solutions, with multiplicity and at all conjugate values, up to which they are
separated.
"""
_SAMPLES = 12
"""Tried in a gap until one has as many solutions, with multiplicity, as points of the line have in
general.
"""


LineRanges = tuple[tuple[Span, ...], tuple[Span, ...]]
"""The ranges of a count on a line: those that are certain, and all that are possible."""
NO_RANGES: LineRanges = ((), ())


def ranges_on(slice: Slice, along: str, value: End, working: int) -> LineRanges:
    """The ranges of a count on the line at a value of the other axis.

    Where the slice has no meaning on the line, as a length is zero there, there are none.

    Parameters
    ----------
    working : the number of stable solutions, or of all where nothing says what is stable.
    """
    number = slice.axis_names.index(along)
    if isinstance(value, Fraction):
        try:
            found = intervals(
                slice, along, {slice.axis_names[1 - number]: value}, working
            ).operation
            return found, found
        except (DegenerateSliceError, InfiniteSolutionsError):
            on_line = line_of(slice, along, {slice.axis_names[1 - number]: value}).parameters
            if not all(on_line[name].numerator for name in system_from(slice.model).positive):
                return NO_RANGES
        except (ConfigError, HypothesisError):
            return NO_RANGES
    minimal = AlgebraicNumber.of(value)
    axis = slice.axes[number]
    parameters = {name: from_expression(e) for name, e in slice.parameters.items()}
    known = system_from(slice.model)
    system = with_root(known, parameters, number, UnivariatePolynomial(list(minimal.polynomial)))
    whole = (Span(axis.low, axis.high),)
    given = on_slice(system, {ALONG: (PLANE.gen(0), ONE)})
    finite = _finite(given)
    if (
        finite is None
    ):  # of one unknown infinitely many are all, on a part that conditions leave: a count of 0 or none
        return (), whole if known.dimension > 1 or not working else ()
    equations, algebra = finite
    if not algebra.dimension:
        return (whole, whole) if not working else NO_RANGES
    if algebra.dimension > MAX_DIMENSION:
        return (), whole
    numbers = _critical(equations, algebra, axis)
    count_at = _counting(system, algebra.dimension, equations is not given, minimal)
    ends: list[End] = [axis.low, *numbers, axis.high]
    here = [
        _has(working, count_at, *map(from_fraction, gap))
        for gap in gaps(numbers, (axis.low, axis.high))
    ]
    return _spans(ends, [h is True for h in here]), _spans(ends, [h is not False for h in here])


class SpecialLine(NamedTuple):
    """A value of the other axis, an end of strips, and what is counted on the line there."""

    end: BaseEnd
    ranges: LineRanges

    @property
    def value(self) -> End:
        return number_at(self.end)

    @property
    def most(self) -> Fraction:
        """An upper bound of the widths on it."""
        return max((span.width.high for span in self.ranges[1]), default=Fraction(0))


def lines_of(slice: Slice, along: str, found: RangeStrips) -> list[SpecialLine]:
    """The lines at the special values of the other axis."""
    return [
        SpecialLine(end, ranges_on(slice, along, number_at(end), found.working))
        for end in found.special
    ]


def number_at(end: BaseEnd) -> End:
    """Where an end of strips is."""
    number = algebraic_number(end.root)
    return number if number.exact is None else number.exact


def _finite(equations: SliceSystem) -> tuple[SliceSystem, QuotientAlgebra] | None:
    """The equations of finitely many solutions, if need be without those that an inequality
    excludes.
    """
    for _ in range(2):
        try:
            return equations, algebra_of(equations)
        except InfiniteSolutionsError:
            for condition in equations.inequalities:
                equations = saturated(equations, condition)
    return None


def _critical(
    equations: SliceSystem, algebra: QuotientAlgebra, axis: Axis
) -> tuple[AlgebraicNumber, ...]:
    """Where the solutions' number or the signs of conditions can change, in increasing order."""
    conditions = (*equations.inequalities, *equations.stability)
    found: list[UnivariatePolynomial] = [
        coefficients_in(p, 1)[0]
        for p in (
            *equations.boundary,
            multiplication_denominator(algebra),
            *_lowest(trace_form(algebra)),
            *(
                p
                for condition in conditions
                for p in _lowest(_matrix(algebra, lifted(condition, equations.unknowns)))
            ),
        )
    ]
    factors = {
        tuple(map(int, factor.coeffs())): factor for p in found for factor, _ in p.factor()[1]
    }
    low, high = interval_of(axis)
    roots = [
        algebraic_number(root) for factor in factors.values() for root in isolate(factor, low, high)
    ]
    return in_order(roots, axis.low, axis.high, axis.width * END_WIDTH)


def _matrix(algebra: QuotientAlgebra, p: UnknownPolynomial) -> list[list[Ratio]]:
    """Of multiplication by a polynomial; of none of its terms zero."""
    if not p:
        return [[(algebra.zero, algebra.one)] * algebra.dimension] * algebra.dimension
    return matrix_of(multiples(algebra, p))


def _lowest(matrix: list[list[Ratio]]) -> Ratio:
    """The lowest coefficient of the characteristic polynomial that is not zero, over Q(x); up to
    its sign.
    """
    found = determinant(matrix)
    if not found[0].is_zero():
        return found
    unknown: Ratio = (PLANE.gen(1), ONE)
    shifted = [
        [add_ratios(c, unknown) if i == j else c for j, c in enumerate(row)]
        for i, row in enumerate(matrix)
    ]
    numerator, denominator = determinant(shifted)
    lowest = min(int(powers[1]) for powers, _ in numerator.terms())
    terms: dict[tuple[int, ...], int] = {
        (int(i), 0): int(c) for (i, j), c in numerator.terms() if j == lowest
    }
    return PLANE.from_dict(terms), denominator


_Count = Callable[[fmpq], tuple[int, int] | None]
"""The least and the largest count that there may be at a point of the line; None at an exception."""


def _has(working: int, count_at: _Count, low: fmpq, high: fmpq) -> bool | None:
    """Whether there is the wanted count between two neighbouring critical values; None where that
    is open.
    """
    sample = low
    for _ in range(_SAMPLES):
        sample = simplest_between(sample, high)
        found = count_at(sample)
        if found is not None:
            least, most = found
            return (True if least == most else None) if least <= working <= most else False
    return None


def _counting(
    system: ParametricSystem, dimension: int, is_saturated: bool, value: AlgebraicNumber
) -> _Count:
    """What counts at points of the line.

    Parameters
    ----------
    dimension : the number of solutions in general, with multiplicity.
    is_saturated : whether those at which an inequality's polynomial vanishes are left out.
    value : of the other axis; solutions at its conjugates do not count.
    """
    within: list[RationalPolynomial] = []
    if value.exact is None:
        unit, one = (*(0,) * (system.ring.width - 1), 1), (0,) * system.ring.width
        low, high = interval_of(value)
        within = [{unit: fmpq(1), one: -low}, {unit: fmpq(-1), one: high}]

    def count_at(sample: fmpq) -> tuple[int, int] | None:
        try:
            point = point_system(system, {ALONG: sample}, is_saturated)
        except DegeneratePoint:
            return None
        if point.algebra.dimension != dimension:
            return None
        stable = open_ones = 0
        for solution in points(point.algebra, None)[0]:
            if all(sign_of(value_at(solution, p)) > 0 for p in (*point.inequalities, *within)):
                signs = [sign_of(value_at(solution, p)) for p in point.stability]
                stable += all(s > 0 for s in signs)
                # a flat minimum, or a flat loop; of a system the conditions are what is called
                # stable
                open_ones += system.criterion.stable_at_zero and min(signs) == 0
        return stable, stable + open_ones

    return count_at


def _spans(ends: Sequence[End], here: Sequence[bool]) -> tuple[Span, ...]:
    """The longest runs of gaps in which something holds."""
    return tuple(Span(ends[first], ends[last]) for first, last in runs(here))
