"""All equilibria at a rational point: from the quotient algebra to poses, in an order that does not depend on rounding.

Guarantee: all real equilibria are there, each once, with its multiplicity; when none is degenerate, minima - saddles +
maxima is zero. Which of two energies is smaller, or that they are equal, is decided by the characteristic polynomial of
the energy in the quotient algebra.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from flint import ctx, fmpq

from ptmcad.algebra.fibre import Fibre, Work
from ptmcad.algebra.number_field import Element
from ptmcad.algebra.points import Points, RealPoint, points, real_values
from ptmcad.algebra.real_roots import RealRoot
from ptmcad.algebra.trigonometric import TrigonometricPolynomial
from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.answer.words import noun
from ptmcad.exact.continua import is_free
from ptmcad.exact.models.potential import deflections_of, geometry_of, system_from
from ptmcad.exact.models.potential import potential as potential_of
from ptmcad.exact.models.system import ParametricSystem, RationalPolynomial, polynomial_at, specialised
from ptmcad.exact.point_system import DegeneratePoint, PointSystem, point_system
from ptmcad.exact.statics import PointModel, State, is_positive, pose_of, state_at
from ptmcad.model import ClosedMechanism, Mechanism, Model, mechanism_in
from ptmcad.model.description import System
from ptmcad.model.evaluate import value_at
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.tree import to_text as text_of

BY_MSOLVE = "the Groebner basis was computed by msolve and proved to be one of the equations"


def exact_poses(given: Model, parameters: Mapping[str, Fraction], digits: int, most: Work | None = None) -> Poses:
    """All solutions of a mechanism without free lengths, or of another system.

    Parameters
    ----------
    parameters : all of the model's ``without_free_lengths``; free lengths are zero.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    ArithmeticError
        When two ways to the same fact disagree, which would be a fault of this program.
    LimitReached
        When the quotient algebra is more work than `most`.
    """
    system = system_from(given)
    values = {name: from_fraction(v) for name, v in parameters.items()}
    try:
        point, found = _solutions(system, values, most)
    except DegeneratePoint:
        what = "equilibria" if system.has_index or mechanism_in(given) is not None else "solutions"
        remark = f"infinitely many {what}{'' if is_free(system, values) else ', complex ones included'}"
        return Poses(given, parameters, (), Status.UNDECIDED, digits, 0, remark)
    # where equations are simpler in other angles there are more coordinates than those of the unknowns
    real = [replace(p, unknowns=p.unknowns[: system.ring.width]) for p in found.real]
    model = _at_point(given, system, point, values, parameters)
    states = [state for state in _states(model, real) if _counts(model, state)]
    results = [pose_of(model, state, digits) for state in states]
    poses = [pose for pose, _ in results]
    degenerate = any(pose.multiplicity > 1 for pose in poses)
    if not degenerate and system.has_index and system.is_on_torus:
        _check_euler_sum(poses)
    energies = _energy_ranks(poses, states, point.algebra, model, point.is_bounded)
    # of equal energies the larger value of the separating form comes first, in which ``found.real`` increases
    order = sorted(range(len(poses)), key=lambda k: (poses[k].stable is not True, energies[k], -k))
    return Poses(
        given,
        parameters,
        tuple(poses[k] for k in order),
        Status.ON_VARIETY if degenerate else Status.EXACT,
        digits,
        max((bits for _, bits in results), default=0),
        "; ".join(
            [
                *filter(None, ["" if degenerate else _remark(found), BY_MSOLVE if point.algebra.by_msolve else ""]),
                *_vanishing(given, model, states, order),
            ]
        ),
    )


def _vanishing(given: Model, model: PointModel, states: Sequence[State], order: Sequence[int]) -> Iterator[str]:
    """The conditions for stability that are zero at a solution, which counts as unstable, in words."""
    if not isinstance(given, System):
        return
    for k, condition in enumerate(given.stability, len(model.inequalities)):
        if numbers := [n for n, s in enumerate(order, 1) if states[s].conditions[k].is_zero]:
            several = len(numbers) > 1
            what = f"{noun(given, len(numbers))} {', '.join(map(str, numbers))}"
            if isinstance(given, ClosedMechanism):  # the condition is a determinant, pages long
                yield f"{what} {'are' if several else 'is'} degenerate: poses meet there, or the loop is flat"
                continue
            yield f"{text_of(condition)} is zero at {what}, which {'count' if several else 'counts'} as unstable"


def _remark(found: Points) -> str:
    """What coincides where no solution that counts is degenerate."""
    if found.distinct == found.total:
        return ""
    if found.total - found.distinct > sum(p.multiplicity - 1 for p in found.real):
        return "two solutions that are not real coincide"
    return "two solutions that an inequality excludes coincide"


def _solutions(system: ParametricSystem, values: Mapping[str, fmpq], most: Work | None) -> tuple[PointSystem, Points]:
    """All solutions, or those at which no inequality's polynomial is zero, where others are in the way.

    Raises
    ------
    DegeneratePoint
        When there are infinitely many.
    LimitReached
        When the quotient algebra is more work than `most`.
    """
    try:
        point = point_system(system, values, most=most)
        if not point.algebra.dimension:
            return point, Points((), (), 0, 0)
        found = points(point.algebra, 1 if point.is_bounded else None)
        if not system.inequalities or found.distinct == found.total:
            return point, found
    except DegeneratePoint:
        if not system.inequalities:
            raise
    point = point_system(system, values, True, most)
    if not point.algebra.dimension:
        return point, Points((), (), 0, 0)
    return point, points(point.algebra, None)


def _at_point(
    given: Model,
    system: ParametricSystem,
    point: PointSystem,
    values: Mapping[str, fmpq],
    parameters: Mapping[str, Fraction],
) -> PointModel:
    """The model at a point, with its places and springs, torsion springs too, where it is a mechanism."""
    potential = None if system.potential is None else polynomial_at(system, system.potential, values)
    angles = len(system.ring.angles)
    found = PointModel(angles, (), {}, potential, point.jacobian, point.inequalities, point.stability)
    mechanism = mechanism_in(given)
    if mechanism is None:
        return found
    geometry = geometry_of(mechanism)

    def at(p: TrigonometricPolynomial) -> RationalPolynomial:
        return specialised(geometry.ring, p, values)

    return replace(
        found,
        springs=tuple((s.name, s.start, s.end, value_at(s.stiffness, parameters)) for s in mechanism.springs),
        nodes={name: (at(x), at(y)) for name, (x, y) in geometry.nodes.items()},
        torsion=tuple((t.name, value_at(t.stiffness, parameters)) for t in mechanism.torsion),
        deflections=tuple((at(cosine), at(sine)) for cosine, sine in deflections_of(mechanism)),
        energy=at(potential_of(mechanism)) if mechanism.has_potential and given is not mechanism else None,
        second_bars=_second_bars(mechanism, parameters),
    )


def _second_bars(mechanism: Mechanism, parameters: Mapping[str, Fraction]) -> tuple[tuple[int, fmpq, fmpq], ...]:
    """Of X-joints: number of the first bar's angle, the bars' length, the base's."""
    lengths = [(value_at(j.bars, parameters), value_at(j.length, parameters)) for j in mechanism.xjoints]
    return tuple(
        (mechanism.angles.index(joint.angle), from_fraction(bars), from_fraction(length))
        for joint, (bars, length) in zip(mechanism.xjoints, lengths, strict=True)
    )


def _counts(model: PointModel, state: State) -> bool:
    """Whether a solution satisfies the inequalities."""
    return all(map(is_positive, state.conditions[: len(model.inequalities)]))


def _states(model: PointModel, found: Sequence[RealPoint]) -> list[State]:
    """The equilibria at real points; those at roots of one polynomial share the work."""
    first: dict[int, State] = {}
    states = []
    for point in found:
        known = first.get(id(point.field.modulus))
        states.append(state_at(model, point) if known is None else known.conjugate(point))
        first.setdefault(id(point.field.modulus), states[-1])
    return states


def _check_euler_sum(poses: Sequence[Pose]) -> None:
    total = sum(-1 if (pose.index or 0) % 2 else 1 for pose in poses)
    if total != 0:
        raise ArithmeticError(f"{len(poses)} equilibria with Euler sum {total}")


def _energy_ranks(
    poses: Sequence[Pose], states: Sequence[State], algebra: Fibre, model: PointModel, is_compact: bool
) -> list[int]:
    """A number for each pose, ordered as their energies are and equal where these are, as all are without energies."""
    potential = model.energy if model.potential is None else model.potential
    if potential is None:
        return [0] * len(poses)
    energies = [pose.energy for pose in poses if pose.energy is not None]
    by_energy = sorted(range(len(poses)), key=lambda k: energies[k].center)
    if all(energies[a].high < energies[b].low for a, b in pairwise(by_energy)):
        return [by_energy.index(k) for k in range(len(poses))]
    if model.second_bars:  # the energy is no polynomial in the algebra's coordinates
        return _ranks_by_enclosures([pose.known_energy for pose in poses])
    # cosines and sines are at most 1
    bound = 1 + sum((abs(c) for c in potential.values()), fmpq(0)) if is_compact else None
    further = len(algebra.multiplication) - len(next(iter(potential), ()))
    potential = {(*m, *(0,) * further): c for m, c in potential.items()}
    values = real_values(algebra, potential, bound)
    return [_rank(state.energy, values) for state in states if state.energy is not None]


def _ranks_by_enclosures(energies: Sequence[Enclosure]) -> list[int]:
    """The same, where energies that all their digits do not tell apart count as equal."""
    order = sorted(range(len(energies)), key=lambda k: energies[k].center)
    ranks = [0] * len(energies)
    for a, b in pairwise(order):
        ranks[b] = ranks[a] + int(energies[a].high < energies[b].low)
    return ranks


def _rank(energy: Element, values: Sequence[RealRoot]) -> int:
    """Which of the isolated real numbers the energy is."""
    bits = 64
    while True:
        with ctx.workprec(bits):
            ball = energy.ball(energy.field.evaluation())
            met = [k for k, root in enumerate(values) if not (ball < root.low or ball > root.high)]
        if len(met) == 1:
            return met[0]
        if not met:
            raise ArithmeticError("an energy is no root of the energy's characteristic polynomial")
        bits *= 2
