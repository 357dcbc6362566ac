"""Real algebraic numbers: from the roots of polynomials to engine-neutral data, and back to be
refined and compared.

Guarantee: exact. Numbers are equal exactly when `compare` says so, however near they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import fmpq

from ptmcad.algebra.polynomials import UnivariatePolynomial, coefficients_in, from_plane
from ptmcad.algebra.real_roots import RealRoot, disjoint, inside, isolate, order, refine
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.flint_numbers import from_fraction, interval_of, to_fraction
from ptmcad.text.plane import PlanePolynomial


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
    return RealRoot(UnivariatePolynomial(list(number.polynomial)), *interval_of(number))


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
    p = UnivariatePolynomial(list(number.polynomial))
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


def fibre_roots(p: UnivariatePolynomial, low: fmpq, high: fmpq) -> tuple[AlgebraicNumber, ...]:
    """The different roots, in the open interval and in no order, of a polynomial that is not zero."""
    return tuple(
        algebraic_number(r) for factor, _ in p.factor()[1] for r in isolate(factor, low, high)
    )
