"""Where the branches of a plane curve have a given slope: what proves that a branch is monotone, or steeper than a line.

Guarantee: exact. Between two consecutive abscissae of `slope_abscissae` no branch has the slope; at one of them
`may_have_slope` answers False only with proof, by a ball that does not contain zero.
"""

from __future__ import annotations

from flint import arb, ctx, fmpq, fmpz_mpoly

from ptmcad.algebra.polynomials import Coefficient, coefficients_in
from ptmcad.algebra.real_roots import RealRoot, isolate, refine, squarefree_part
from ptmcad.algebra.resultants import resultant

BITS = 400
"""Working precision of the balls."""
NARROW = fmpq(1, 2**200)
"""Length to which isolating intervals are shortened before balls are formed from them."""


def tangency(p: Coefficient, slope: fmpq) -> fmpz_mpoly:
    """The polynomial p_y + slope p_x: on the curve p = 0 it vanishes where dx/dy = slope, and at singular points."""
    return p.derivative(1) * int(slope.q) + p.derivative(0) * int(slope.p)


def slope_abscissae(p: Coefficient, slope: fmpq, low: fmpq, high: fmpq) -> tuple[RealRoot, ...]:
    """The y in (low, high) over which p = 0 may have a (complex) point with dx/dy = slope or a singular one.

    Raises
    ------
    ArithmeticError
        When there are infinitely many: the curve contains a line of that slope, or a multiple component.
    """
    eliminated = resultant(coefficients_in(p, 0), coefficients_in(tangency(p, slope), 0))
    if not eliminated:
        raise ArithmeticError("the curve contains a line of the slope, or a multiple component")
    return isolate(squarefree_part(eliminated), low, high)


def may_have_slope(p: Coefficient, slope: fmpq, y: RealRoot, low: fmpq, high: fmpq) -> bool:
    """Whether p = 0 may have a point with dx/dy = slope at the ordinate y and an abscissa in [low, high].

    False only with proof: the segment is covered by balls on each of which p, or its tangency polynomial, has no zero.
    """
    with ctx.workprec(BITS):
        short = refine(y, NARROW)
        over = arb(short.low).union(arb(short.high))
        pieces = [(low, high)]
        tangent = tangency(p, slope)
        rows, others = coefficients_in(p, 0), coefficients_in(tangent, 0)
        first, second = ([c(over) for c in cs] for cs in (rows, others))
        while pieces:
            a, b = pieces.pop()
            x = arb(a).union(arb(b))
            if all(_horner(c, x).contains(0) for c in (first, second)):
                if b - a < fmpq(1, 2**40):
                    return True
                pieces += [(a, (a + b) / 2), ((a + b) / 2, b)]
    return False


def _horner(coefficients: list[arb], x: arb) -> arb:
    total = arb(0)
    for c in reversed(coefficients):
        total = total * x + c
    return total
