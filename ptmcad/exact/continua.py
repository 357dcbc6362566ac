"""Curves of a slice on which there are infinitely many solutions.

Guarantee: what is PROVED is. Where an equation vanishes identically on a curve, one of one unknown holds everywhere;
and a potential on a torus does not depend on an unknown there: it has a critical point in the others, as every
function on a torus has, with any value of that one. POSSIBLE is said of a line where complex solutions are infinitely
many at some points of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from flint import fmpq

from ptmcad.algebra.polynomials import Coefficient, Ratio, evaluate, multiplicity
from ptmcad.answer.regionmap import Continuum
from ptmcad.exact.models.system import ParametricSystem, SliceSystem
from ptmcad.exact.point_system import DegeneratePoint, point_system


def continuum(
    curve: Coefficient,
    system: ParametricSystem,
    parameters: Mapping[str, Ratio],
    equations: SliceSystem,
    jacobian_norm: Coefficient,
) -> Continuum | None:
    """Whether there are infinitely many solutions on an irreducible curve; None where that is not known.

    Parameters
    ----------
    equations : the system's, on the slice.
    jacobian_norm : of the Jacobian's determinant, over the solutions at a generic point.
    """
    if any(divmod(common, curve)[1].is_zero() for common in equations.vanishing):
        return Continuum.PROVED if has_others(system) else Continuum.POSSIBLE
    # the limits of solutions in a continuum are singular, so that the norm vanishes more than once
    if curve.total_degree() > 1 or multiplicity(jacobian_norm, curve) < 2:
        return None
    return Continuum.POSSIBLE if all(_is_infinite(system, parameters, at) for at in _points(curve)) else None


def _is_infinite(system: ParametricSystem, parameters: Mapping[str, Ratio], at: tuple[fmpq, fmpq]) -> bool:
    """Whether there are infinitely many solutions at a point, complex ones included."""
    values = {}
    for name, (numerator, denominator) in parameters.items():
        below = evaluate(denominator, *at)
        if not below:
            return False
        values[name] = evaluate(numerator, *at) / below
    try:
        point_system(system, values)
    except DegeneratePoint:
        return True
    return False


def _points(line: Coefficient) -> Iterator[tuple[fmpq, fmpq]]:
    """Points of a line at which no coincidence is to be expected."""
    zero = fmpq(0)
    constant, first, second = evaluate(line, zero, zero), evaluate(line, fmpq(1), zero), evaluate(line, zero, fmpq(1))
    for v in (fmpq(1009, 1117), fmpq(857, 331)):
        if first != constant:
            yield -(constant + (second - constant) * v) / (first - constant), v
        else:
            yield v, -constant / (second - constant)


def has_others(system: ParametricSystem) -> bool:
    """Whether all but one of the equations are known to have a common real solution, whichever is left out."""
    return system.is_on_torus and (system.dimension == 1 or _is_gradient(system))


def _is_gradient(system: ParametricSystem) -> bool:
    """Whether the equations are the slopes of a function on the torus; with constant moments there is none."""
    ring, potential = system.ring, system.potential
    return potential is not None and all(
        not (ring.reduce(ring.derivative(potential, unknown)) - equation)
        for unknown, equation in zip(ring.unknowns, system.equations, strict=True)
    )
