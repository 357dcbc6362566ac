"""The sign of a rational function in the open window, by exact Bernstein coefficients and halving.

Guarantee: a witness is exact: the function has the reported sign at the reported point, or its denominator changes
sign between the two reported points. Every number is rational.

Not guaranteed: that a witness is found where there is one. None is returned when the sign is proved and also when
halving has not decided after `MAX_BOXES` boxes (a zero that only touches the window, or a tiny excursion).

References: Farouki, "The Bernstein polynomial basis: a centennial retrospective", CAGD 29 (2012), section 4: the
coefficients on a box bound the polynomial there, and those at the corners are its values.
"""

from __future__ import annotations

from fractions import Fraction
from math import comb

from ptmcad.expressions import Expression, Term
from ptmcad.numerals import approximate_text
from ptmcad.slice import Axis

MAX_BOXES = 64
MAX_DEGREE = 12

_Point = tuple[Fraction, Fraction]
_Interval = tuple[Fraction, Fraction]
_Box = tuple[_Interval, _Interval]


def find_pole(expression: Expression, axes: tuple[Axis, Axis]) -> str | None:
    """Where the denominator vanishes or changes sign inside the window, in words; None when nothing was found."""
    low, high = _extremes(expression.denominator, axes)
    for point, value in (low, high):
        if point is not None and value == 0:
            return f"at {_named(point, axes)}"
    if low[0] is not None and high[0] is not None and low[1] < 0 < high[1]:
        return f"between {_named(low[0], axes)} and {_named(high[0], axes)}"
    return None


def find_nonpositive(expression: Expression, axes: tuple[Axis, Axis]) -> str | None:
    """A point inside the window where the function is not positive, in words; None when nothing was found.

    The denominator must not change sign in the window (see `find_pole`).
    """
    lowest = _lowest(expression, axes)
    return None if lowest is None or lowest[1] > 0 else _witness(expression, lowest[0], axes)


def find_negative(expression: Expression, axes: tuple[Axis, Axis]) -> str | None:
    """A point inside the window where the function is negative, in words; None when nothing was found.

    The denominator must not change sign in the window (see `find_pole`).
    """
    lowest = _lowest(expression, axes)
    return None if lowest is None or lowest[1] >= 0 else _witness(expression, lowest[0], axes)


def _lowest(expression: Expression, axes: tuple[Axis, Axis]) -> tuple[_Point, Fraction] | None:
    """The point seen where the numerator, with the denominator's sign, is least, and its value there."""
    middle = tuple((axis.low + axis.high) / 2 for axis in axes)
    sign = 1 if _value(expression.denominator, *middle) > 0 else -1
    numerator = tuple((i, j, sign * c) for i, j, c in expression.numerator)
    (point, value), _ = _extremes(numerator, axes)
    return None if point is None else (point, value)


def _witness(expression: Expression, point: _Point, axes: tuple[Axis, Axis]) -> str:
    # a value of a high power at a point of many digits may be longer than Python writes out
    value, longest = expression.evaluate(*point), 10**40
    short = abs(value.numerator) < longest and value.denominator < longest
    return f"{value if short else 'about ' + approximate_text(value)} at {_named(point, axes)}"


_Seen = tuple[_Point | None, Fraction]


def _extremes(terms: tuple[Term, ...], axes: tuple[Axis, Axis]) -> tuple[_Seen, _Seen]:
    """The least and the greatest value seen at the middles of boxes, halving boxes whose sign is not proved."""
    boxes: list[_Box] = [((axes[0].low, axes[0].high), (axes[1].low, axes[1].high))]
    lowest: _Seen = (None, Fraction(0))
    highest: _Seen = (None, Fraction(0))
    too_large = max((max(i, j) for i, j, _ in terms), default=0) > MAX_DEGREE
    for box in boxes:  # grows while it is read, breadth first
        point = ((box[0][0] + box[0][1]) / 2, (box[1][0] + box[1][1]) / 2)
        value = _value(terms, *point)
        if lowest[0] is None or value < lowest[1]:
            lowest = (point, value)
        if highest[0] is None or value > highest[1]:
            highest = (point, value)
        if not too_large and len(boxes) < MAX_BOXES and not _sign_is_proved(terms, box):
            (x0, x1), (y0, y1) = box
            boxes += [(x, y) for x in ((x0, point[0]), (point[0], x1)) for y in ((y0, point[1]), (point[1], y1))]
    return lowest, highest


def _sign_is_proved(terms: tuple[Term, ...], box: _Box) -> bool:
    """Whether the Bernstein coefficients on the box have one sign, so that the polynomial has it in the open box."""
    coefficients = bernstein(terms, box)
    return any(coefficients) and (min(coefficients) >= 0 or max(coefficients) <= 0)


def bernstein(terms: tuple[Term, ...], box: _Box) -> list[Fraction]:
    """The Bernstein coefficients of a polynomial on a box, row by row.

    >>> one = Fraction(1)
    >>> [str(c) for c in bernstein(((0, 0, -one), (1, 0, one)), ((Fraction(0), Fraction(4)), (Fraction(0), one)))]
    ['-1', '3']
    """
    m = max((i for i, _, _ in terms), default=0)
    n = max((j for _, j, _ in terms), default=0)
    left = [_power_in_bernstein(i, m, box[0]) for i in range(m + 1)]
    right = [_power_in_bernstein(j, n, box[1]) for j in range(n + 1)]
    return [
        sum((c * left[i][p] * right[j][q] for i, j, c in terms), Fraction(0))
        for p in range(m + 1)
        for q in range(n + 1)
    ]


def _power_in_bernstein(power: int, degree: int, interval: _Interval) -> list[Fraction]:
    """x^power on the interval in the Bernstein basis of the degree: its blossom with p upper ends."""
    low, high = interval
    return [
        sum(
            (
                Fraction(comb(p, r) * comb(degree - p, power - r), comb(degree, power)) * high**r * low ** (power - r)
                for r in range(max(0, power - degree + p), min(p, power) + 1)
            ),
            Fraction(0),
        )
        for p in range(degree + 1)
    ]


def _value(terms: tuple[Term, ...], x: Fraction, y: Fraction) -> Fraction:
    return sum((c * x**i * y**j for i, j, c in terms), Fraction(0))


def _named(point: _Point, axes: tuple[Axis, Axis]) -> str:
    return ", ".join(f"{axis.name} = {value}" for axis, value in zip(axes, point, strict=True))
