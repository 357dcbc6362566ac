"""All equilibria at a rational point: from the quotient algebra to poses, in an order that does not depend on rounding.

Guarantee: all real equilibria are there, each once, with its multiplicity; when none is degenerate, minima - saddles +
maxima is zero. Which of two energies is smaller, or that they are equal, is decided by the characteristic polynomial of
the energy in the quotient algebra.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise

from flint import ctx, fmpq

from ptmcad.algebra.fibre import Fibre
from ptmcad.algebra.points import RealPoint, points, real_values
from ptmcad.algebra.polynomials import from_fraction
from ptmcad.algebra.real_roots import RealRoot
from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.exact.counting import DegeneratePoint, point_system
from ptmcad.exact.models.potential import geometry_of, system_from
from ptmcad.exact.models.system import polynomial_at
from ptmcad.exact.statics import Model, State, pose_of, state_at
from ptmcad.mechanism import ptm
from ptmcad.mechanism.evaluate import value_at

INFINITELY_MANY = "infinitely many equilibria"
COMPLEX_DOUBLE = "two solutions that are not real coincide"


def exact_poses(parameters: Mapping[str, Fraction], digits: int) -> Poses:
    """All equilibria of the paper's mechanism.

    Parameters
    ----------
    parameters : all of the mechanism's ``without_free_lengths``; the free lengths are zero.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    ArithmeticError
        When two ways to the same fact disagree, which would be a fault of this program.
    """
    mechanism = ptm()
    system = system_from(mechanism)
    values = {name: from_fraction(v) for name, v in parameters.items()}
    try:
        point = point_system(system, values)
    except DegeneratePoint:
        return Poses(mechanism.name, parameters, (), Status.UNDECIDED, digits, 0, INFINITELY_MANY)
    found = points(point.algebra)
    coordinates = {
        name: (polynomial_at(system, x, values), polynomial_at(system, y, values))
        for name, (x, y) in geometry_of(mechanism).nodes.items()
    }
    assert system.potential is not None
    hessian = (point.jacobian[0][0], point.jacobian[0][1], point.jacobian[1][1])
    springs = tuple((s.name, s.start, s.end, value_at(s.stiffness, parameters)) for s in mechanism.springs)
    model = Model(springs, coordinates, polynomial_at(system, system.potential, values), hessian)
    states = _states(model, found.real)
    results = [pose_of(model, state, digits) for state in states]
    poses = [pose for pose, _ in results]
    degenerate = any(pose.multiplicity > 1 for pose in poses)
    if not degenerate:
        _check_euler_sum(poses)
    energies = _energy_ranks(poses, states, point.algebra, model)
    # of equal energies the larger value of the separating form comes first, in which ``found.real`` increases
    order = sorted(range(len(poses)), key=lambda k: (poses[k].stable is not True, energies[k], -k))
    return Poses(
        mechanism.name,
        parameters,
        tuple(poses[k] for k in order),
        Status.ON_VARIETY if degenerate else Status.EXACT,
        digits,
        max(bits for _, bits in results),
        COMPLEX_DOUBLE if not degenerate and found.distinct < found.total else "",
    )


def _states(model: Model, found: Sequence[RealPoint]) -> list[State]:
    """The equilibria at real points; those at roots of one polynomial share the work."""
    first: dict[int, State] = {}
    states = []
    for point in found:
        known = first.get(id(point.field.modulus))
        states.append(state_at(model, point) if known is None else known.conjugate(point))
        first.setdefault(id(point.field.modulus), states[-1])
    return states


def _check_euler_sum(poses: Sequence[Pose]) -> None:
    total = sum(1 if pose.index in (0, 2) else -1 for pose in poses)
    if total != 0 or len(poses) not in (4, 6):
        raise ArithmeticError(f"{len(poses)} equilibria with Euler sum {total}")


def _energy_ranks(poses: Sequence[Pose], states: Sequence[State], algebra: Fibre, model: Model) -> list[int]:
    """A number for each pose, ordered as their energies are and equal where these are."""
    by_energy = sorted(range(len(poses)), key=lambda k: poses[k].energy.center)
    if all(poses[a].energy.high < poses[b].energy.low for a, b in pairwise(by_energy)):
        return [by_energy.index(k) for k in range(len(poses))]
    bound = 1 + sum((abs(c) for c in model.potential.values()), fmpq(0))  # cosines and sines are at most 1
    values = real_values(algebra, model.potential, bound)
    return [_rank(state, values) for state in states]


def _rank(state: State, values: Sequence[RealRoot]) -> int:
    """Which of the isolated real numbers the energy is."""
    bits = 64
    while True:
        with ctx.workprec(bits):
            ball = state.energy.ball(state.energy.field.evaluation())
            met = [k for k, root in enumerate(values) if not (ball < root.low or ball > root.high)]
        if len(met) == 1:
            return met[0]
        if not met:
            raise ArithmeticError("an energy is no root of the energy's characteristic polynomial")
        bits *= 2
