"""All equilibria at a rational point: from the quotient algebra to poses, in the order of their
energies.

Guarantee: all real equilibria are there, each once, with its multiplicity; when none is degenerate,
minima - saddles + maxima is zero. Energies that agree in all digits asked for count as equal, in the
order of the poses alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from flint import fmpq

from ptmcad.algebra.fibre_algebra import WorkLimit
from ptmcad.algebra.number_field import Modulus, RealPoint, points
from ptmcad.algebra.polynomials import Values
from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.answer.words import noun
from ptmcad.exact.continua import is_free
from ptmcad.exact.models.modelsystem import system_from
from ptmcad.exact.models.system import ParametricSystem
from ptmcad.exact.point_system import DegeneratePoint, PointSystem, point_systems
from ptmcad.exact.statics import ExactSolution, pose_of, solution_at
from ptmcad.model import Model
from ptmcad.model.compile import CompiledSystem, compiled
from ptmcad.text.flint_numbers import from_fraction

BY_MSOLVE = "the Groebner basis was computed by msolve and proved to be one of the equations"


def exact_poses(
    given: Model, parameters: Mapping[str, Fraction], digits: int, most: WorkLimit | None = None
) -> Poses:
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
    system, known = system_from(given), compiled(given)
    values = {name: from_fraction(v) for name, v in parameters.items()}
    try:
        point, found, coinciding = _solutions(system, values, most)
    except DegeneratePoint:
        what = noun(given) if known.points else known.criterion.solutions
        remark = (
            f"infinitely many {what}{'' if is_free(system, values) else ', complex ones included'}"
        )
        return Poses(given, parameters, (), Status.UNDECIDED, digits, 0, remark)
    # where solutions are left out there is one coordinate more than those of the unknowns
    real = [replace(p, unknowns=p.unknowns[: system.ring.width]) for p in found]
    relaxed = dict.fromkeys(given.free_lengths, fmpq(0)) | values
    solutions = [
        s for s in _exact_solutions(known, point, relaxed, real) if s.all_positive(s.inequalities)
    ]
    results = [pose_of(solution, digits) for solution in solutions]
    poses = [pose for pose, _ in results]
    degenerate = any(pose.multiplicity > 1 for pose in poses)
    if not degenerate and system.is_on_torus:
        _check_euler_sum(poses)
    energies = _energy_ranks(poses)
    # of equal energies the larger value of the separating form comes first, in which ``found``
    # increases
    order = sorted(range(len(poses)), key=lambda k: (poses[k].stable is not True, energies[k], -k))
    remarks = [
        "" if degenerate else _remark(found, coinciding),
        BY_MSOLVE if point.algebra.by_msolve else "",
        *_vanishing(given, known, [solutions[k] for k in order]),
    ]
    return Poses(
        given,
        parameters,
        tuple(poses[k] for k in order),
        Status.ON_VARIETY if degenerate else Status.EXACT,
        digits,
        max((bits for _, bits in results), default=0),
        "; ".join(filter(None, remarks)),
    )


def _vanishing(
    given: Model, known: CompiledSystem, solutions: Sequence[ExactSolution]
) -> Iterator[str]:
    """The conditions for stability that are zero at a solution, which counts as unstable, in words."""
    conditions = given.stability or (None,) * len(known.stability)
    for k in range(len(known.stability)):
        if numbers := [n for n, s in enumerate(solutions, 1) if s.stability[k].is_zero]:
            what = f"{noun(given, len(numbers))} {', '.join(map(str, numbers))}"
            yield known.criterion.at_zero(what, len(numbers), conditions[k])


def _remark(real: Sequence[RealPoint], coinciding: int) -> str:
    """What coincides where no solution that counts is degenerate.

    Parameters
    ----------
    coinciding : how many fewer different solutions there are than with multiplicity.
    """
    if not coinciding:
        return ""
    if coinciding > sum(p.multiplicity - 1 for p in real):
        return "two solutions that are not real coincide"
    return "two solutions that an inequality excludes coincide"


def _solutions(
    system: ParametricSystem, values: Values, most: WorkLimit | None
) -> tuple[PointSystem, list[RealPoint], int]:
    """All real solutions, or those at which no inequality's polynomial is zero, where others are in
    the way; and how many fewer different complex ones there are than with multiplicity.

    Raises
    ------
    DegeneratePoint
        When there are infinitely many.
    LimitReached
        When the quotient algebra is more work than `most`.
    """
    for point in point_systems(system, values, most):
        found, different = list[RealPoint](), 0
        if point.algebra.dimension:
            found, different = points(point.algebra, 1 if point.is_bounded else None)
        coinciding = point.algebra.dimension - different
        if not coinciding:
            break
    return point, found, coinciding


def _exact_solutions(
    known: CompiledSystem, system: PointSystem, parameters: Values, real: Sequence[RealPoint]
) -> Iterator[ExactSolution]:
    """The solutions at real points; those at roots of one polynomial share the work."""
    first: dict[Modulus, ExactSolution] = {}
    for point in real:
        modulus = point.field.modulus
        if modulus not in first:
            first[modulus] = solution_at(known, system, parameters, point)
        yield replace(first[modulus], point=point)


def _check_euler_sum(poses: Sequence[Pose]) -> None:
    total = sum((-1) ** pose.index for pose in poses if pose.index is not None)
    if total != 0:
        raise ArithmeticError(f"{len(poses)} equilibria with Euler sum {total}")


def _energy_ranks(poses: Sequence[Pose]) -> list[int]:
    """A number for each pose, ordered as their energies are; equal where their digits do not separate
    them, as all are without energies.
    """
    energies = [pose.energy for pose in poses if pose.energy is not None]
    ranks = [0] * len(poses)
    if len(energies) == len(poses):
        order = sorted(range(len(poses)), key=lambda k: energies[k].center)
        for a, b in pairwise(order):
            ranks[b] = ranks[a] + int(energies[a].high < energies[b].low)
    return ranks
