"""A rational function of one variable from its values modulo a prime: its degrees, and what its
numerator looks like.

Not guaranteed: that it is the function; that is so where the values left over are no accident.

Reference: von zur Gathen & Gerhard, Modern Computer Algebra, section 5.7 (Cauchy interpolation).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import gcd
from typing import NamedTuple

from flint import nmod_poly

from ptmcad.algebra.polynomials import Coefficient

LinePolynomial = nmod_poly
"""A polynomial in a line's parameter, modulo a prime."""
Points = Sequence[tuple[int, int]]
"""Values of the parameter, each with one of a fraction there."""
_WEIGHT = 0x2545F4914F6CDD1D
"""Of a number that of the one before, times this."""
_SPARE = 4
"""Values that a fraction has to fit although they were not asked for."""


class Numerator(NamedTuple):
    """A polynomial without multiplicities.

    Attributes
    ----------
    degree : without the root 0.
    has_zero : whether 0 is a root.
    step : without that root all exponents are multiples of this number.
    """

    degree: int
    has_zero: bool
    step: int


def numerator(points: Points, prime: int, known: Sequence[LinePolynomial] = ()) -> Numerator | None:
    """Of the fraction of least degree through points (x, y); None where nearly all of them are
    needed for it.

    Parameters
    ----------
    known : polynomials whose roots are left out.
    """
    found = _fraction(points, prime)
    if found is None:
        return None
    squarefree = found[0] // found[0].gcd(found[0].derivative())
    for other in known:
        squarefree //= squarefree.gcd(other)
    parts = squarefree.coeffs()
    zero = len(parts) > 1 and not int(parts[0])
    exponents = [k for k, c in enumerate(parts[1:] if zero else parts) if int(c)]
    return Numerator(exponents[-1], zero, gcd(*exponents) or 1)


def restricted(
    p: Coefficient, line: tuple[tuple[int, int], tuple[int, int]], prime: int
) -> LinePolynomial:
    """p on a line, of which two points are given: those of the parameters 0 and 1."""
    x, y = (nmod_poly([at, after - at], prime) for at, after in zip(*line, strict=True))
    return sum(
        (x ** int(i) * y ** int(j) * (int(c) % prime) for (i, j), c in p.terms()),
        nmod_poly([0], prime),
    )


def weighted(numbers: Sequence[int], prime: int) -> int:
    """A sum with weights that are no accident."""
    return int(nmod_poly(numbers, prime)(_WEIGHT % prime))


def degree(points: Points, prime: int) -> int | None:
    """The larger one of the fraction's degrees, above and below; None as for `numerator`."""
    found = _fraction(points, prime)
    return None if found is None else max(int(part.degree()) for part in found)


def _fraction(points: Points, prime: int) -> tuple[nmod_poly, nmod_poly] | None:
    product, through = nmod_poly([1], prime), nmod_poly([0], prime)
    for x, y in points:
        step = (y - int(through(x))) * pow(int(product(x)), -1, prime) % prime
        through += product * step
        product *= nmod_poly([-x, 1], prime)
    before, rest = product, through
    last, factor = nmod_poly([0], prime), nmod_poly([1], prime)
    best: tuple[int, nmod_poly, nmod_poly] | None = None
    while rest.degree() >= 0:
        size = int(rest.degree()) + int(factor.degree())
        if best is None or size < best[0]:
            best = size, rest, factor
        quotient = before // rest
        before, rest = rest, before - quotient * rest
        last, factor = factor, last - quotient * factor
    if best is None or best[0] + _SPARE >= len(points):
        return None
    return best[1:]
