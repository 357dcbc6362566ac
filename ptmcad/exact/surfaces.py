"""The discriminant variety of a family in three dimensions: surfaces off which every count is
locally constant.

Guarantee: on every connected component of the box without these surfaces, and without a set that
does not cut it, all counts are constant. They may be more than that needs.

Why: what `variety` says of curves holds over Q(x, y, z) word for word, in three parameters.
Surfaces at infinity are taken by what they divide, the denominators of the multiplication matrices,
unless solutions are proved to stay regular near almost all of their points: the exceptional points
form curves, which do not cut a part of space in two.
"""

from __future__ import annotations

from collections.abc import Sequence

from ptmcad.algebra.polynomials import Coefficient, irreducible_factors
from ptmcad.algebra.quotient import multiples, multiplication_denominator, quotient_algebra
from ptmcad.algebra.real_roots import Interval
from ptmcad.algebra.space import nowhere_zero
from ptmcad.exact.familyvariety import FamilyVariety
from ptmcad.exact.models.system import SystemOnAxes
from ptmcad.exact.variety import harmless, settles, sign_changes


def surfaces_of(
    on: SystemOnAxes, known: FamilyVariety, box: Sequence[Interval]
) -> tuple[Coefficient, ...]:
    """The irreducible surfaces that may have a point in an open box.

    Parameters
    ----------
    on : the system on the axes x, y and z.
    known : the variety over Q(x, y, z).
    box : the ranges of x, y and z.
    """
    equations = on.equations
    algebra = quotient_algebra(known.basis)
    assert algebra is not None  # it was, when the variety was computed
    given = [
        known.jacobian_norm[0],
        *equations.boundary,
        *on.limits,
        *sign_changes(equations, algebra),
    ]
    found = irreducible_factors(*given)
    everywhere = irreducible_factors(multiplication_denominator(algebra))
    suspects = [f for f in everywhere if f not in found and not nowhere_zero(f, box)]
    if suspects and settles(equations):
        rows = multiples(algebra, equations.jacobian)
        proved = harmless(equations, rows, known.jacobian_norm, suspects)
        suspects = [f for f in suspects if f not in proved]
    return (*(f for f in found if not nowhere_zero(f, box)), *suspects)
