"""Elimination of t1 from two polynomials in (t1, t2), and the squarefree factors and real roots of what is left.

Guarantee: exact polynomials over Q up to a constant.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from flint import fmpq, fmpz_poly

from ptmcad.algebra.polynomials import Coefficient, coefficients_in
from ptmcad.algebra.real_roots import isolate, squarefree_part
from ptmcad.algebra.resultants import resultant


@dataclass(frozen=True, slots=True)
class Elimination:
    """What eliminating t1 from two equations leaves.

    Attributes
    ----------
    bidegrees : of the two equations in (t1, t2); ``total_degrees`` likewise.
    degree : of the resultant in t2.
    circle : exponent of the factor 1 + t2^2.
    factors : (degree, multiplicity) of the other squarefree factors, by multiplicity.
    quadratics : (coefficients of 1, t2 and t2^2, multiplicity) of those of degree 2, without common divisor.
    real_roots : number of different real t2.
    """

    bidegrees: tuple[tuple[int, int], tuple[int, int]]
    total_degrees: tuple[int, int]
    degree: int
    circle: int
    factors: tuple[tuple[int, int], ...]
    quadratics: tuple[tuple[tuple[int, int, int], int], ...]
    real_roots: int


def eliminate(first: Coefficient, second: Coefficient) -> Elimination:
    """Eliminate t1 from two polynomials in (t1, t2), exactly."""
    left, right = (tuple(int(d) for d in p.degrees()) for p in (first, second))
    eliminated = resultant(coefficients_in(first, 0), coefficients_in(second, 0))
    rest, circle, factor = eliminated, 0, fmpz_poly([1, 0, 1])
    while not (division := divmod(rest, factor))[1]:
        rest, circle = division[0], circle + 1
    parts = squarefree_factors(rest)
    whole = math.prod((p for p, _ in parts), start=fmpz_poly([1]))
    return Elimination(
        bidegrees=((left[0], left[1]), (right[0], right[1])),
        total_degrees=(int(first.total_degree()), int(second.total_degree())),
        degree=eliminated.degree(),
        circle=circle,
        factors=tuple((p.degree(), e) for p, e in parts),
        quadratics=tuple((_three(p), e) for p, e in parts if p.degree() == 2),
        real_roots=real_root_number(whole),
    )


def _three(p: fmpz_poly) -> tuple[int, int, int]:
    constant, linear, leading = (int(c) for c in p // p.content())
    sign = 1 if leading > 0 else -1
    return sign * constant, sign * linear, sign * leading


def squarefree_factors(p: fmpz_poly) -> tuple[tuple[fmpz_poly, int], ...]:
    """The squarefree factors of positive degree with their multiplicities (Yun's algorithm)."""
    found = []
    common = p.gcd(p.derivative())
    w, y, multiplicity = p // common, p.derivative() // common, 1
    while w.degree() > 0:
        z = y - w.derivative()
        g = w.gcd(z) if z else w
        if g.degree() > 0:
            found.append((g, multiplicity))
        w, y, multiplicity = w // g, z // g, multiplicity + 1
    return tuple(found)


def real_root_number(p: fmpz_poly) -> int:
    """The number of different real roots: those in (-1, 1), those of the reversed polynomial there, and -1 and 1."""
    q = squarefree_part(p)
    zero = int(q.degree() > 0 and q[0] == 0)
    if zero:
        q = q.right_shift(1)
    low, high = fmpq(-1), fmpq(1)
    sides = (q, fmpz_poly(q.coeffs()[::-1]))
    return zero + sum(len(isolate(side, low, high)) for side in sides) + sum(q(end) == 0 for end in (-1, 1))
