"""Where the branches of a plane curve have a given direction: the proof that one is monotone, or
steeper than a line.

Guarantee: exact. No point of the curve off the real roots of `tangent_resultant` has the direction.
"""

from __future__ import annotations

from flint import fmpz_mpoly, fmpz_poly

from ptmcad.algebra.polynomials import Coefficient, coefficients_in
from ptmcad.algebra.real_roots import squarefree_part
from ptmcad.algebra.resultants import resultant

Direction = tuple[int, int]
"""(dx, dy), not both zero: (1, 0) is horizontal, where the curve folds over the y-axis."""


def tangency(p: Coefficient, direction: Direction) -> fmpz_mpoly:
    """The polynomial dx p_x + dy p_y: on p = 0 it vanishes where that is tangent, and at singular
    points.
    """
    return p.derivative(0) * direction[0] + p.derivative(1) * direction[1]


def tangent_resultant(p: Coefficient, direction: Direction) -> fmpz_poly:
    """The squarefree polynomial in y that vanishes where p = 0 has such a (complex) point or a
    singular one.

    Raises
    ------
    ArithmeticError When there are infinitely many: the curve contains a line of that direction, or
        a multiple component.
    """
    eliminated = resultant(coefficients_in(p, 0), coefficients_in(tangency(p, direction), 0))
    if not eliminated:
        raise ArithmeticError("the curve contains a line of the direction, or a multiple component")
    return squarefree_part(eliminated)
