"""The sign of a rational function in the open window: proved, refuted by a point, or undecided with
the place.

Guarantee: `PROVED` is a theorem, and a `Witness` is exact: the function has the stated value at the
stated point. Any other verdict names the boxes that are undecided, and is never taken for a proof.

Bernstein coefficients on boxes bound the polynomial there, and those at its corners are its values;
the box with the lowest bound is halved next, so that the work gathers where a dip may be. Where
`MAX_SPLITS` and `MAX_WORK` leave a polynomial open, it stays undecided: thin dips, and what
touches zero where no box has a corner.

References: Farouki, "The Bernstein polynomial basis: a centennial retrospective", CAGD 29 (2012),
section 4.
"""

from collections.abc import Iterator
from enum import Enum
from fractions import Fraction
from functools import lru_cache
from heapq import heappop, heappush
from itertools import count, pairwise, product
from math import comb, lcm
from typing import NamedTuple

from ptmcad.question.slice import PROVED, Axes, Box, Corner, Interval, Verdict, Witness
from ptmcad.text.expressions import Expression, Terms, polynomial_value
from ptmcad.text.numerals import approximate_text

MAX_SPLITS = 400
MAX_WORK = 2_000_000
"""Additions of Bernstein coefficients; less than a second."""
MAX_SHOWN = 10**40
"""Numerators and denominators from here on are shown rounded."""


Row = tuple[int, ...]
Rows = tuple[Row, ...]


class Need(Enum):
    """What is asked of a function in the whole open window."""

    POSITIVE = "positive"
    NOT_NEGATIVE = "not negative"
    NO_POLE = "without a pole"
    """its denominator, as it is written, is not zero"""


@lru_cache(maxsize=256)
def decide(expression: Expression, axes: Axes, need: Need) -> Verdict:
    """Whether a rational function is in the whole open window what it needs to be.

    Guarantee
    ---------
    For `Need.POSITIVE` and `Need.NOT_NEGATIVE` the verdict holds where the denominator, as it is
    written, is not zero; ask for `Need.NO_POLE` too.
    """
    window, asks_pole = window_of(axes), need is Need.NO_POLE
    middle = middle_of(window)
    denominator = polynomial_value(expression.denominator, *middle)
    if denominator == 0:
        return Witness(middle, denominator) if asks_pole else (window,)
    side = 1 if denominator > 0 else -1
    terms = expression.denominator if asks_pole else expression.numerator
    signed = tuple((i, j, side * c) for i, j, c in terms)
    verdict = _decided(signed, window, need is not Need.NOT_NEGATIVE)
    if not isinstance(verdict, Witness):
        return verdict
    point, value = verdict.point, side * verdict.value
    if asks_pole:
        return Witness(point, value, middle if verdict.value < 0 else None)
    if value == 0:
        return verdict
    denominator = polynomial_value(expression.denominator, *point)
    if denominator == 0:
        x, y = point
        return (((x, x), (y, y)),)
    return Witness(point, value / denominator)


def place(verdict: Verdict, axes: Axes) -> str:
    """Where it is, in words: ``at rho = 1, m = 2``, or ``near``."""
    if isinstance(verdict, Witness):
        return f"at {named(verdict.point, axes)}"
    return f"near {named(middle_of(verdict[0]), axes)}"


def named(point: Corner, axes: Axes) -> str:
    """A point in words, numbers of many digits rounded."""
    return ", ".join(
        f"{axis.name} = {number(value)}" for axis, value in zip(axes, point, strict=True)
    )


def number(value: Fraction) -> str:
    """A number for a message."""
    if abs(value.numerator) < MAX_SHOWN and value.denominator < MAX_SHOWN:
        return str(value)
    # a value of a high power at a point of many digits may be longer than Python writes out
    return f"about {approximate_text(value)}"


class _Part(NamedTuple):
    """A box with the Bernstein coefficients of the polynomial on it, times 2^shift and a constant:
    row i is for x^i.
    """

    box: Box
    rows: Rows
    shift: int

    def lowest(self) -> Fraction:
        """A bound for the polynomial on the box, in a unit that all parts share."""
        return Fraction(min(map(min, self.rows)), 1 << self.shift)


def _decided(terms: Terms, window: Box, strict: bool) -> Verdict:
    """Whether a polynomial is positive, or not negative, in the open window."""
    if not terms:
        return Witness(middle_of(window), Fraction(0)) if strict else PROVED
    exact = bernstein(terms, window)
    denominator = lcm(*(c.denominator for row in exact for c in row))
    rows = tuple(tuple(int(c * denominator) for c in row) for row in exact)
    cost = max(1, len(rows) * len(rows[0]) * max(len(rows), len(rows[0])) // 2)
    order = count()
    waiting: list[tuple[Fraction, int, _Part]] = []
    fresh: tuple[_Part, ...] = (_Part(window, rows, 0),)
    for splits in range(min(MAX_SPLITS, MAX_WORK // cost), -1, -1):
        for part in fresh:
            for point, value in _inner_corners(part, window):
                if value < 0 or (strict and value == 0):
                    return Witness(point, value / denominator)
            if not _is_proved(part, window, strict):
                heappush(waiting, (part.lowest(), next(order), part))
        if not (splits and waiting):
            break
        fresh = _halves(heappop(waiting)[2])
    return tuple(part.box for _, _, part in sorted(waiting, key=lambda w: w[:2]))


def _is_proved(part: _Part, window: Box, strict: bool) -> bool:
    """Whether the polynomial is not negative on the box; and positive but on the window's edge, if
    that is asked for.

    Coefficients that are not negative and not all zero are a positive polynomial inside of the box;
    those along a side are its coefficients there, and that in a corner is its value. Sides on the
    window's edge do not count.
    """
    rows = part.rows
    if min(map(min, rows)) < 0:
        return False
    if not strict:
        return True
    # for each axis: all coefficients, and those of the ends that are inside of the window
    faces = [
        [slice(None), *(slice(i, i + 1 or None) for i, _ in _inner_ends(part, window, k))]
        for k in (0, 1)
    ]
    return all(any(any(row[up]) for row in rows[across]) for across in faces[0] for up in faces[1])


def _inner_ends(part: _Part, window: Box, k: int) -> list[tuple[int, Fraction]]:
    """The ends of the box along an axis that are inside of the window, each after the number of its
    coefficients.
    """
    low, high = part.box[k]
    return [(i, end) for i, end in ((0, low), (-1, high)) if window[k][0] < end < window[k][1]]


def _inner_corners(part: _Part, window: Box) -> Iterator[tuple[Corner, Fraction]]:
    """Corners of the box inside of the window, with the polynomial's values; an axis that does not
    occur is halved.
    """
    across, up = (
        _inner_ends(part, window, k) if size > 1 else [(0, middle_of(part.box)[k])]
        for k, size in enumerate((len(part.rows), len(part.rows[0])))
    )
    for (i, x), (j, y) in product(across, up):
        yield (x, y), Fraction(part.rows[i][j], 1 << part.shift)


def _halves(part: _Part) -> tuple[_Part, _Part]:
    """The two halves of a box, cut across the direction in which the coefficients differ more."""
    rows, (x, y) = part.rows, part.box
    columns = tuple(zip(*rows, strict=True))
    across = _variation(rows) > _variation(columns)  # along y
    first, second = zip(*map(_halved, rows if across else columns), strict=True)
    if not across:
        first, second = (tuple(zip(*half, strict=True)) for half in (first, second))
    shift = part.shift + len((rows if across else columns)[0]) - 1
    low, high = y if across else x
    middle = (low + high) / 2
    boxes = [(x, half) if across else (half, y) for half in ((low, middle), (middle, high))]
    return _Part(boxes[0], first, shift), _Part(boxes[1], second, shift)


def _halved(row: Row) -> tuple[Row, Row]:
    """De Casteljau's subdivision at the middle, times 2^degree."""
    degree = len(row) - 1
    left, right, sums = [row[0] << degree], [row[-1] << degree], list(row)
    for step in range(1, degree + 1):
        sums = [a + b for a, b in pairwise(sums)]
        left.append(sums[0] << (degree - step))
        right.append(sums[-1] << (degree - step))
    return tuple(left), tuple(reversed(right))


def _variation(rows: Rows) -> int:
    """The largest difference of two coefficients in a row."""
    return max(max(row) - min(row) for row in rows)


def bernstein(terms: Terms, box: Box) -> list[list[Fraction]]:
    """The Bernstein coefficients of a polynomial on a box; row p belongs to the p-th basis function
    of the first axis.

    >>> one = Fraction(1)
    >>> form = bernstein(((0, 0, -one), (1, 0, one)), ((Fraction(0), Fraction(4)), (Fraction(0), one)))
    >>> [[str(c) for c in row] for row in form]
    [['-1'], ['3']]
    """
    m = max((i for i, _, _ in terms), default=0)
    n = max((j for _, j, _ in terms), default=0)
    left = [_power_in_bernstein(i, m, box[0]) for i in range(m + 1)]
    right = [_power_in_bernstein(j, n, box[1]) for j in range(n + 1)]
    by_power = [
        [Fraction(0)] * (n + 1) for _ in range(m + 1)
    ]  # of x^i, in the Bernstein basis of the second axis
    for i, j, c in terms:
        by_power[i] = [total + c * r for total, r in zip(by_power[i], right[j], strict=True)]
    return [
        [
            sum((left[i][p] * by_power[i][q] for i in range(m + 1)), Fraction(0))
            for q in range(n + 1)
        ]
        for p in range(m + 1)
    ]


def _power_in_bernstein(power: int, degree: int, interval: Interval) -> list[Fraction]:
    """x^power on the interval in the Bernstein basis of the degree: its blossom with p upper ends."""
    low, high = interval
    return [
        sum(
            (
                Fraction(comb(p, r) * comb(degree - p, power - r), comb(degree, power))
                * high**r
                * low ** (power - r)
                for r in range(max(0, power - degree + p), min(p, power) + 1)
            ),
            Fraction(0),
        )
        for p in range(degree + 1)
    ]


def window_of(axes: Axes) -> Box:
    return (axes[0].low, axes[0].high), (axes[1].low, axes[1].high)


def middle_of(box: Box) -> Corner:
    (x0, x1), (y0, y1) = box
    return (x0 + x1) / 2, (y0 + y1) / 2
