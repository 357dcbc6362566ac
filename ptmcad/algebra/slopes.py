"""Where the branches of a plane curve have a given direction: the proof that one is monotone, or steeper than a line.

Guarantee: exact. No point of the curve off the real roots of `tangent_resultant` has the direction; at one of
them `may_be_tangent` answers False only with proof, by balls that do not contain zero.
"""

from __future__ import annotations

from flint import arb, ctx, fmpq, fmpz_mpoly, fmpz_poly

from ptmcad.algebra.polynomials import Coefficient, coefficients_in
from ptmcad.algebra.real_roots import RealRoot, refine, squarefree_part
from ptmcad.algebra.resultants import resultant

Direction = tuple[int, int]
"""(dx, dy), not both zero: (1, 0) is horizontal, where the curve folds over the y-axis."""
BITS = 400
"""Working precision of the balls."""
MAX_ROOT_WIDTH = fmpq(1, 2**200)
"""Length to which isolating intervals are shortened before balls are formed from them."""
MIN_PIECE = fmpq(1, 2**40)
"""Pieces of a segment that are shorter are not cut again."""


def tangency(p: Coefficient, direction: Direction) -> fmpz_mpoly:
    """The polynomial dx p_x + dy p_y: on p = 0 it vanishes where that is tangent, and at singular points."""
    return p.derivative(0) * direction[0] + p.derivative(1) * direction[1]


def tangent_resultant(p: Coefficient, direction: Direction) -> fmpz_poly:
    """The squarefree polynomial in y that vanishes where p = 0 has such a (complex) point or a singular one.

    Raises
    ------
    ArithmeticError
        When there are infinitely many: the curve contains a line of that direction, or a multiple component.
    """
    eliminated = resultant(coefficients_in(p, 0), coefficients_in(tangency(p, direction), 0))
    if not eliminated:
        raise ArithmeticError("the curve contains a line of the direction, or a multiple component")
    return squarefree_part(eliminated)


def may_be_tangent(p: Coefficient, direction: Direction, y: RealRoot, low: fmpq, high: fmpq) -> bool:
    """Whether p = 0 may have a point with a tangent in the direction at the height y and an abscissa in [low, high].

    False only with proof: the segment is covered by balls on each of which p, or its tangency polynomial, has no zero.
    """
    with ctx.workprec(BITS):
        short = refine(y, MAX_ROOT_WIDTH)
        height = arb(short.low).union(arb(short.high))
        both = [[_value(c, height) for c in coefficients_in(q, 0)] for q in (p, tangency(p, direction))]
        pieces = [(low, high)]
        while pieces:
            a, b = pieces.pop()
            x = arb(a).union(arb(b))
            if all(_horner(coefficients, x).contains(0) for coefficients in both):
                if b - a < MIN_PIECE:
                    return True
                pieces += [(a, (a + b) / 2), ((a + b) / 2, b)]
    return False


def _value(p: fmpz_poly, at: arb) -> arb:
    return _horner([arb(c) for c in p.coeffs()], at)


def _horner(coefficients: list[arb], x: arb) -> arb:
    total = arb(0)
    for c in reversed(coefficients):
        total = total * x + c
    return total
