"""The equations of equilibrium of springs with a free length, after two squarings have cleared their roots.

Guarantee: exact polynomials over Q up to a constant; their zeros contain all equilibria, and many that are none.

With a spring length l_i = sqrt(P_i), each equation dU/dth = 0 has the form a + b/l + c/l', and the product over the
signs of the two roots is a polynomial. Here cosines and sines are written in t = tan(th/2).
"""

from __future__ import annotations

import math
from fractions import Fraction

from ptmcad.algebra.polynomials import PLANE, Coefficient


def squared_equations(
    base: Fraction, rods: tuple[Fraction, Fraction], free: Fraction, loads: tuple[Fraction, Fraction]
) -> tuple[Coefficient, Coefficient]:
    """The two equilibrium equations in (t1, t2), squared twice; lengths in one unit, loads divided by k."""
    numbers = (base, *rods, free, *loads)
    scale = math.lcm(*(n.denominator for n in numbers))
    # scaling all lengths, and loads over k, which are lengths too, leaves the angles as they are
    r, length1, length2, l0, f3, f4 = (int(n * scale) for n in numbers)
    t1, t2 = PLANE.gens()
    first = _squared((r, length1, length2, l0, f3), t1, t2)
    second = _squared((r, length2, length1, l0, f4), t2, t1)
    return first, second


def _squared(numbers: tuple[int, int, int, int, int], t: Coefficient, u: Coefficient) -> Coefficient:
    """The equation of the rod of length ``own`` with half angle t; u belongs to the other rod."""
    r, own, other, l0, f = numbers
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
