"""The elimination system of a slice: equilibria with a singular Hessian, as polynomials with integer coefficients.

Guarantee: the ideal that they generate, cut with Q[x, y], vanishes on every CRITICAL component of the slice.
"""

from __future__ import annotations

from collections.abc import Mapping

from ptmcad.algebra.polynomials import Ratio, UnknownPolynomial
from ptmcad.answer.slicevariety import EliminationSystem, Term
from ptmcad.exact.models.system import ParametricSystem, on_slice
from ptmcad.exact.models.text import system_text


def elimination_system(
    system: ParametricSystem, parameters: Mapping[str, Ratio], axes: tuple[str, str]
) -> EliminationSystem:
    """The equations of a slice, the circles, and the Hessian's determinant.

    Parameters
    ----------
    parameters : every parameter of the system's ring as numerator and denominator in Z[x, y].
    axes : the names of x and y.
    """
    on = on_slice(system, parameters)
    polynomials = tuple(_terms(p) for p in (*on.equations, on.jacobian))
    return EliminationSystem(system_text(system).unknowns, axes, polynomials)


def _terms(p: UnknownPolynomial) -> tuple[Term, ...]:
    terms = [((*unknowns, int(i), int(j)), int(c)) for unknowns, q in p.items() for (i, j), c in q.terms()]
    return tuple(sorted(terms, reverse=True))
