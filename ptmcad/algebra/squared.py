"""Elimination for springs with a free length, after two squarings have cleared the roots from the equations.

Guarantee: exact polynomials over Q up to a constant; their zeros contain all equilibria, and many that are none.

With a spring length l_i = sqrt(P_i), each equation dU/dth = 0 has the form a + b/l + c/l', and the product over the
signs of the two roots is a polynomial. Here cosines and sines are written in t = tan(th/2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq, fmpz_poly

from ptmcad.algebra.polynomials import PLANE, Coefficient, coefficients_in
from ptmcad.algebra.real_roots import isolate, squarefree_part
from ptmcad.algebra.resultants import resultant


@dataclass(frozen=True, slots=True)
class Elimination:
    """What eliminating t1 from the two squared equations leaves.

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


def squared_equations(
    rho: Fraction, rods: tuple[Fraction, Fraction], free: Fraction, loads: tuple[Fraction, Fraction]
) -> tuple[Coefficient, Coefficient]:
    """The two equilibrium equations in (t1, t2), squared twice; lengths in one unit, loads divided by k."""
    numbers = (rho, *rods, free, *loads)
    scale = math.lcm(*(n.denominator for n in numbers))
    # scaling all lengths, and loads over k, which are lengths too, leaves the angles as they are
    r, length1, length2, l0, f3, f4 = (int(n * scale) for n in numbers)
    t1, t2 = PLANE.gens()
    first = _squared(r, length1, length2, l0, f3, t1, t2)
    second = _squared(r, length2, length1, l0, f4, t2, t1)
    return first, second


def _squared(r: int, own: int, other: int, l0: int, f: int, t: Coefficient, u: Coefficient) -> Coefficient:
    """The equation of the rod of length ``own`` with half angle t; u belongs to the other rod."""
    d, e = 1 + t**2, 1 + u**2
    sine = 2 * t * e  # all of these are to be divided by d e
    cosine = (1 - t**2) * e
    sum_sine = 2 * t * (1 - u**2) + 2 * u * (1 - t**2)
    diagonal = (r * r + own * own) * d - 2 * r * own * (1 - t**2)  # d l^2 for the spring from this rod's end
    sum_cosine = (1 - t**2) * (1 - u**2) - 4 * t * u
    top = (  # d e l3^2
        (r * r + own * own + other * other) * d * e + 2 * own * other * sum_cosine
        - 2 * r * own * (1 - t**2) * e - 2 * r * other * (1 - u**2) * d
    )  # fmt: skip
    a = 2 * r * sine - other * sum_sine - f * cosine
    b, c = r * sine, r * sine - other * sum_sine
    # a = l0 (b sqrt(d / diagonal) + c sqrt(d e / top))
    inner = a**2 * diagonal * top - l0**2 * b**2 * d * top - l0**2 * c**2 * d * e * diagonal
    return inner**2 - 4 * l0**4 * b**2 * c**2 * d**2 * e * diagonal * top


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
