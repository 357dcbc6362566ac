"""Curves of a slice on which there are infinitely many solutions.

Guarantee: what is PROVED is. Where an equation of one unknown vanishes identically on a curve,
every value solves it. Where a potential on a torus does not change when some angles turn together,
it has infinitely many minima: one, as every function on a torus has, and all to which that is
turned. POSSIBLE is said of a curve on which an equation vanishes, and of a line with points at which
complex solutions are infinitely many.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

from flint import fmpq

from ptmcad.algebra.polynomials import Coefficient, Values, common_factor, evaluate, multiplicity
from ptmcad.algebra.trigonometric_ring import TrigonometricPolynomial
from ptmcad.answer.regionmap import Continuum
from ptmcad.exact.models.system import (
    ParametricSystem,
    SliceSystem,
    SystemOnAxes,
    element_on_slice,
    polynomial_at,
)
from ptmcad.exact.point_system import DegeneratePoint, point_system


def continuum(
    curve: Coefficient,
    on: SystemOnAxes,
    equations: SliceSystem,
    jacobian_norm: Coefficient,
) -> Continuum | None:
    """Whether there are infinitely many solutions on an irreducible curve; None where that is not
    known.

    Parameters
    ----------
    on, equations : the system on the slice.
    jacobian_norm : of the Jacobian's determinant, over the solutions at a generic point.
    """
    if not any(divmod(common, curve)[1].is_zero() for common in equations.vanishing):
        # the limits of solutions in a continuum are singular, so that the norm vanishes more than
        # once
        if curve.total_degree() > 1 or multiplicity(jacobian_norm, curve) < 2:
            return None
        if not all(_is_infinite(on, at) for at in _points(curve)):
            return None
    system = on.system
    slopes = (
        common_factor(element_on_slice(system, p, on.parameters).values())
        for p in _sums(system.equations)
    )
    is_free = has_minima(system) and any(divmod(slope, curve)[1].is_zero() for slope in slopes)
    return Continuum.PROVED if is_free else Continuum.POSSIBLE


def is_free(system: ParametricSystem, values: Values) -> bool:
    """Whether at a point the potential stays where some angles turn together: solutions are
    infinitely many.
    """
    return has_minima(system) and any(
        not polynomial_at(system, p, values) for p in _sums(system.equations)
    )


def _sums(equations: Sequence[TrigonometricPolynomial]) -> Iterator[TrigonometricPolynomial]:
    """The slopes where some angles turn together, to one side or the other."""
    for weights in product((-1, 0, 1), repeat=len(equations)):
        if any(weights):
            yield sum(
                (w * e for w, e in zip(weights, equations, strict=True)), start=0 * equations[0]
            )


def _is_infinite(on: SystemOnAxes, at: tuple[fmpq, fmpq]) -> bool:
    """Whether there are infinitely many solutions at a point, complex ones included."""
    try:
        values = on.values(at)
    except ZeroDivisionError:  # a parameter has none there
        return False
    try:
        point_system(on.system, values)
    except DegeneratePoint:
        return True
    return False


def _points(line: Coefficient) -> Iterator[tuple[fmpq, fmpq]]:
    """Points of a line at which no coincidence is to be expected."""
    zero = fmpq(0)
    constant, first, second = (
        evaluate(line, zero, zero),
        evaluate(line, fmpq(1), zero),
        evaluate(line, zero, fmpq(1)),
    )
    for v in (fmpq(1009, 1117), fmpq(857, 331)):
        if first != constant:
            yield -(constant + (second - constant) * v) / (first - constant), v
        else:
            yield v, -constant / (second - constant)


def has_minima(system: ParametricSystem) -> bool:
    """Whether the equations are the slopes of a function on a torus, or there is one alone."""
    return system.is_on_torus and (system.dimension == 1 or _is_gradient(system))


def _is_gradient(system: ParametricSystem) -> bool:
    """Whether the equations are the slopes of a function on the torus; with constant moments there
    is none.
    """
    ring, potential = system.ring, system.potential
    return potential is not None and all(
        not (ring.reduce(ring.derivative(potential, unknown)) - equation)
        for unknown, equation in zip(ring.unknowns, system.equations, strict=True)
    )
