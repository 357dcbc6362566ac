"""Polynomials in one variable over a number field Q[u]/(m): greatest common divisors and exact quotients.

A polynomial is a list of coefficients, lowest first, each a residue modulo the irreducible m; the last one is not zero.

Guarantee: exact, and monic where a divisor is returned. Euclid's algorithm with residues reduced after every step: for
the degrees of a fibre (some thirty) over fields of degree some thirty.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpq_poly

Coefficients = Sequence[fmpq_poly]


def derivative(p: Coefficients) -> list[fmpq_poly]:
    """By the variable, not by u.

    >>> [str(c) for c in derivative([fmpq_poly([1]), fmpq_poly([0, 1]), fmpq_poly([3])])]
    ['x', '6']
    """
    return [c * k for k, c in enumerate(p)][1:]


def common_divisor(p: Coefficients, q: Coefficients, modulus: fmpq_poly) -> list[fmpq_poly]:
    """The monic greatest common divisor; p is not zero, q may be.

    >>> root2 = fmpq_poly([-2, 0, 1])
    >>> double = [fmpq_poly([2]), fmpq_poly([0, -2]), fmpq_poly([1])]  # (v - u)^2 with u^2 = 2
    >>> [str(c) for c in common_divisor(double, derivative(double), root2)]
    ['(-1)*x', '1']
    """
    first, second = _monic(p, modulus), _trimmed(q, modulus)
    while second:
        second = _monic(second, modulus)
        first, second = second, _divided(first, second, modulus)[1]
    return first


def quotient(p: Coefficients, divisor: Coefficients, modulus: fmpq_poly) -> list[fmpq_poly]:
    """p divided by a monic divisor, without what is left."""
    return _divided(p, divisor, modulus)[0]


def _divided(p: Coefficients, divisor: Coefficients, modulus: fmpq_poly) -> tuple[list[fmpq_poly], list[fmpq_poly]]:
    """Quotient and remainder by a monic divisor."""
    left, degree = list(p), len(divisor) - 1
    found: list[fmpq_poly] = []
    while len(left) > degree:
        lead = left.pop() % modulus
        found.append(lead)
        for k, c in enumerate(divisor[:-1], start=len(left) - degree):
            left[k] = (left[k] - lead * c) % modulus
    return found[::-1], _trimmed(left, modulus)


def _monic(p: Coefficients, modulus: fmpq_poly) -> list[fmpq_poly]:
    trimmed = _trimmed(p, modulus)
    divisor, inverse, _ = trimmed[-1].xgcd(modulus)
    return [c * inverse / divisor[0] % modulus for c in trimmed]


def _trimmed(p: Coefficients, modulus: fmpq_poly) -> list[fmpq_poly]:
    reduced = [c % modulus for c in p]
    while reduced and not reduced[-1]:
        reduced.pop()
    return reduced
