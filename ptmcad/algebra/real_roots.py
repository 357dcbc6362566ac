"""Real roots of integer polynomials: isolated, refined, compared, with rational points between; and
real algebraic numbers, as engine-neutral data of them.

Guarantee: exact. Isolation (`descartes`) finds every root in the open interval; isolating intervals
have rational ends, are disjoint and contain one root each, an interval of length zero being the
root itself. Numbers are equal exactly when `compare` says so, however near they are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpz, fmpz_poly

from ptmcad.algebra.descartes import descartes_bound, isolating_intervals, on_unit_interval
from ptmcad.algebra.polynomials import coefficients_in, from_plane
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.flint_numbers import from_fraction, interval_of, to_fraction
from ptmcad.text.plane import PlanePolynomial

_LONG_BITS = 1000
"""Bits of coefficients from which on values are not computed exactly where a ball will do."""


Interval = tuple[fmpq, fmpq]
Window = tuple[Interval, Interval]
"""The ranges of two axes."""


class RealRoot(NamedTuple):
    """The only root of the squarefree ``polynomial`` in the open interval (low, high), or low
    itself if low == high.
    """

    polynomial: fmpz_poly
    low: fmpq
    high: fmpq

    @classmethod
    def of(cls, value: fmpq) -> RealRoot:
        """A rational number."""
        return cls(fmpz_poly([-int(value.p), int(value.q)]), value, value)

    @property
    def is_rational(self) -> bool:
        """Whether the root is known to be the rational ``low``."""
        return bool(self.low == self.high)

    @property
    def middle(self) -> fmpq:
        return (self.low + self.high) / 2

    @property
    def ball(self) -> arb:
        """Around the isolating interval."""
        return arb(self.low).union(arb(self.high))


def sign(value: fmpq | fmpz) -> int:
    """-1, 0 or 1."""
    return (value > 0) - (value < 0)


def sign_at(p: fmpz_poly, at: fmpq) -> int:
    """The sign of p at a rational point."""
    return sign(fmpq(p(at)))


def order(at: fmpq, root: RealRoot) -> int:
    """The sign of a rational number minus a root."""
    if root.is_rational:
        return sign(at - root.low)
    if not root.low < at < root.high:
        return -1 if at <= root.low else 1
    here = sign_at(root.polynomial, at)
    return 0 if here == 0 else 1 if here == sign_at(root.polynomial, root.high) else -1


def squarefree_part(p: fmpz_poly) -> fmpz_poly:
    """p divided by gcd(p, p')."""
    if p.degree() < 1:
        return p
    common = p.gcd(p.derivative())
    return p if common.degree() == 0 else p // common


def isolate(p: fmpz_poly, low: fmpq, high: fmpq) -> tuple[RealRoot, ...]:
    """The roots of a squarefree polynomial in the open interval (low, high), in increasing order.

    Raises
    ------
    ValueError
        When the polynomial has a multiple root in the interval.
    """
    return tuple(_normalised(p, *ends) for ends in isolating_intervals(p, low, high))


def _normalised(p: fmpz_poly, low: fmpq, high: fmpq) -> RealRoot:
    """The isolating interval with ends that are no roots, so that signs at its ends differ."""
    if low == high:
        return RealRoot(p, low, high)
    derivative = p.derivative()
    while True:
        s, t = sign_at(p, low), sign_at(p, high)
        s = s or sign_at(derivative, low)
        t = t or -sign_at(derivative, high)
        if s == 0 or t == 0:
            raise ValueError(f"a polynomial of degree {p.degree()} is not squarefree")
        if sign_at(p, low) and sign_at(p, high):
            return RealRoot(p, low, high)
        middle = (low + high) / 2
        u = sign_at(p, middle)
        if u == 0:
            return RealRoot(p, middle, middle)
        if u == s:
            low = middle
        else:
            high = middle


def halve(root: RealRoot) -> RealRoot:
    """The same root in an interval half as long."""
    if root.is_rational:
        return root
    middle = root.middle
    at_middle = sign_at(root.polynomial, middle)
    if at_middle == 0:
        return RealRoot(root.polynomial, middle, middle)
    if at_middle == sign_at(root.polynomial, root.low):
        return RealRoot(root.polynomial, middle, root.high)
    return RealRoot(root.polynomial, root.low, middle)


def refine(root: RealRoot, width: fmpq) -> RealRoot:
    """The same root in an interval shorter than ``width``, by quadratic interval refinement.

    Reference: Abbott, Quadratic interval refinement for real roots, ACM Commun. Comput. Algebra 48
    (2014).
    """
    p, low, high = root.polynomial, root.low, root.high
    if low == high or high - low < width:
        return root
    value_at = _values(p, low, high, width)
    pieces = 4
    at_low, at_high = value_at(low, pieces), value_at(high, pieces)
    while high - low >= width:
        step = (high - low) / pieces
        slope = at_low / (at_low - at_high)
        k = (slope * pieces + fmpq(1, 2)).floor()
        left = low + step * k
        value = at_low if k == 0 else at_high if k == pieces else value_at(left, pieces)
        if value == 0:
            return RealRoot(p, left, left)
        right = left + step if sign(value) == sign(at_low) else left - step
        if low <= right <= high:
            other = (
                at_low if right == low else at_high if right == high else value_at(right, pieces)
            )
            if other == 0:
                return RealRoot(p, right, right)
            if sign(other) != sign(value):
                if right > left:
                    low, at_low, high, at_high = left, value, right, other
                else:
                    low, at_low, high, at_high = right, other, left, value
                pieces *= pieces
                continue
        pieces = 4
        middle = (low + high) / 2
        value = value_at(middle, pieces)
        if value == 0:
            return RealRoot(p, middle, middle)
        if sign(value) == sign(at_low):
            low, at_low = middle, value
        else:
            high, at_high = middle, value
    return RealRoot(p, low, high)


def _values(p: fmpz_poly, low: fmpq, high: fmpq, width: fmpq) -> Callable[[fmpq, int], fmpq]:
    """p at points of [low, high], for so many pieces: exact, or with the right sign and short if p
    is long.

    A short value comes from a ball that does not contain zero and is known more precisely than one
    piece of the secant.
    """

    def exact(at: fmpq, pieces: int) -> fmpq:
        return fmpq(p(at))

    bits = p.height_bits()
    if bits < _LONG_BITS:
        return exact
    depth = int((max(abs(low), abs(high)) / width).ceil()).bit_length()
    precision = 3 * depth + 64
    if bits < 2 * precision:
        return exact
    with ctx.workprec(precision):
        rounded = arb_poly(p)

    def value_at(at: fmpq, pieces: int) -> fmpq:
        with ctx.workprec(precision):
            ball = rounded(arb(at))
        if ball.rel_accuracy_bits() < pieces.bit_length() + 8:
            return fmpq(p(at))
        return ball.mid().fmpq()

    return value_at


def has_root_between(p: fmpz_poly, low: fmpq, high: fmpq) -> bool:
    """Whether p has a root in the closed interval [low, high]; p need not be squarefree."""
    if sign_at(p, low) == 0 or sign_at(p, high) == 0:
        return True
    if p.degree() < 1:
        return False
    bound = descartes_bound(on_unit_interval(p, low, high), p.degree())
    if bound % 2 == 1:
        return True
    return bound > 0 and bool(isolate(squarefree_part(p), low, high))


def avoids(p: fmpz_poly | arb_poly, low: fmpq, high: fmpq) -> bool:
    """Whether p is proved to have no zero in [low, high]: its value in the middle outweighs the
    rest of its Taylor sum.

    False may mean undecided.
    """
    radius = arb((high - low) / 2)
    local = arb_poly(p)(arb_poly([arb((low + high) / 2), radius]))
    value = local[0]
    # in Horner's scheme a ball around zero adds up the coefficients' moduli
    return bool(abs((local - value)(arb(0, 1))).upper() < abs(value))


def is_root_of(divisor: fmpz_poly, root: RealRoot) -> bool:
    """Whether a divisor of the root's polynomial has the root too: it is simple, and no end of its
    interval is another one.
    """
    at_low = sign_at(divisor, root.low)
    return at_low == 0 if root.is_rational else at_low != sign_at(divisor, root.high)


def vanishes_at(p: fmpz_poly, root: RealRoot) -> bool:
    """Whether any polynomial has the root."""
    return not p or is_root_of(p.gcd(root.polynomial), root)


def disjoint(roots: Sequence[RealRoot]) -> tuple[RealRoot, ...]:
    """Different real numbers in increasing order, with closed isolating intervals that are pairwise
    disjoint.
    """
    return tuple(root for _, root in numbered_disjoint(roots))


def numbered_disjoint(roots: Sequence[RealRoot]) -> list[tuple[int, RealRoot]]:
    """The same, each with its number among those given."""

    def place(numbered: tuple[int, RealRoot]) -> Interval:
        return numbered[1].low, numbered[1].high

    ordered = sorted(enumerate(roots), key=place)
    changed = True
    while changed:
        changed = False
        for i in range(len(ordered) - 1):
            (n, a), (m, b) = ordered[i], ordered[i + 1]
            while a.high >= b.low:
                a, b = (halve(a), b) if a.high - a.low >= b.high - b.low else (a, halve(b))
                changed = True
                if a.low > b.high or (a.is_rational and b.is_rational):
                    break
            ordered[i], ordered[i + 1] = (n, a), (m, b)
        if changed:
            ordered.sort(key=place)
    return ordered


def inside(roots: Sequence[RealRoot], interval: Interval) -> tuple[RealRoot, ...]:
    """The same roots, in order, all inside an open interval, with closed isolating intervals inside
    it too.
    """
    inner = list(roots)
    while inner and inner[0].low <= interval[0]:
        inner[0] = halve(inner[0])
    while inner and inner[-1].high >= interval[1]:
        inner[-1] = halve(inner[-1])
    return tuple(inner)


def gaps(isolated: Sequence[Any], interval: tuple[Any, Any]) -> list[tuple[Any, Any]]:
    """The parts of an interval between the intervals of numbers in it, which are disjoint and in
    increasing order.
    """
    ends = [
        interval[0],
        *(end for number in isolated for end in (number.low, number.high)),
        interval[1],
    ]
    return list(zip(ends[::2], ends[1::2], strict=True))


def algebraic_number(root: RealRoot) -> AlgebraicNumber:
    """The number that is a root of an irreducible primitive polynomial."""
    p = root.polynomial if root.polynomial.leading_coefficient() > 0 else -root.polynomial
    coefficients = tuple(int(c) for c in p.coeffs())
    if len(coefficients) == 2:
        value = Fraction(-coefficients[0], coefficients[1])
        return AlgebraicNumber(coefficients, value, value)
    return AlgebraicNumber(coefficients, to_fraction(root.low), to_fraction(root.high))


def root_of(number: AlgebraicNumber) -> RealRoot:
    """The engine's form of a number."""
    return RealRoot(fmpz_poly(list(number.polynomial)), *interval_of(number))


def refined(number: AlgebraicNumber, width: Fraction) -> AlgebraicNumber:
    """The same number in an interval shorter than ``width`` > 0."""
    return algebraic_number(refine(root_of(number), from_fraction(width)))


def compare(a: AlgebraicNumber, b: AlgebraicNumber | Fraction) -> int:
    """The sign of a - b."""
    if isinstance(b, AlgebraicNumber):
        # isolating intervals of one polynomial that overlap hold the same root if their union holds
        # only one
        overlap = a.polynomial == b.polynomial and a.low <= b.high and b.low <= a.high
        if overlap and _one_root(a, min(a.low, b.low), max(a.high, b.high)):
            return 0
        while a.low <= b.high and b.low <= a.high:
            a, b = (
                refined(a, (a.high - a.low) / 2 or Fraction(1)),
                refined(b, (b.high - b.low) / 2 or Fraction(1)),
            )
        return 1 if a.low > b.high else -1
    return -order(from_fraction(b), root_of(a))


def _one_root(number: AlgebraicNumber, low: Fraction, high: Fraction) -> bool:
    if low == high:
        return True
    p = fmpz_poly(list(number.polynomial))
    return len(isolate(p, from_fraction(low), from_fraction(high))) == 1


def roots_in(
    polynomial: PlanePolynomial, low: Fraction, high: Fraction
) -> tuple[AlgebraicNumber, ...]:
    """The roots, in the open interval, of an irreducible polynomial in the first axis alone."""
    p = coefficients_in(from_plane(polynomial), 1)[0]
    return tuple(algebraic_number(r) for r in isolate(p, from_fraction(low), from_fraction(high)))


def in_order(
    numbers: Sequence[AlgebraicNumber], low: Fraction, high: Fraction, width: Fraction
) -> tuple[AlgebraicNumber, ...]:
    """Different numbers of the open interval (low, high) in increasing order.

    Their isolating intervals are disjoint, inside (low, high) and shorter than ``width``.
    """
    short = [refine(root_of(number), from_fraction(width)) for number in numbers]
    found = inside(disjoint(short), (from_fraction(low), from_fraction(high)))
    return tuple(algebraic_number(r) for r in found)


def fibre_roots(p: fmpz_poly, low: fmpq, high: fmpq) -> tuple[AlgebraicNumber, ...]:
    """The different roots, in the open interval and in no order, of a polynomial that is not zero."""
    return tuple(
        algebraic_number(r) for factor, _ in p.factor()[1] for r in isolate(factor, low, high)
    )
