"""The equilibria at a point of a mechanism with closed loops and springs of free lengths, with everything of a pose.

Guarantee: each equilibrium is proved, and all are there unless the answer is UNDECIDED. Every number settles the digits
asked for or, where it may be zero, is enclosed. There is no index: with one degree of freedom left a pose is stable
where the energy's second derivative along the loops is positive.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.certified.plain.points import plain_counter
from ptmcad.certified.plain.poses import answered, is_tense, point_slice, pose_at, solutions_at, tape_of
from ptmcad.certified.plain.problem import MAX_UNKNOWNS_AT_POINTS
from ptmcad.mechanism import ClosedMechanism
from ptmcad.mechanism.fourbars import flat_everywhere
from ptmcad.question.domain import prove_slice
from ptmcad.question.slice import Count

NOT_TOLD = (
    "not all equilibria could be distinguished: there are infinitely many, one is nearly degenerate, a loop is nearly "
    "flat, or a spring has nearly no length there"
)


def loop_poses(model: ClosedMechanism, parameters: Mapping[str, Fraction], digits: int) -> Poses:
    """All equilibria of a mechanism whose closed loops leave one degree of freedom.

    Parameters
    ----------
    parameters : all variables of the description.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    ConfigError, GeometryError
        As `ptmcad.certified.plain.points.plain_counter` does, or where a parameter is not what its kind asks for.
    """
    slice = point_slice(model, parameters)
    prove_slice(slice)
    if flat := flat_everywhere(model.mechanism, slice.parameters):
        loop, fold = flat
        return Poses(model, parameters, (), Status.UNDECIDED, digits, 0, loop.in_short(fold))
    found, unclear = solutions_at(plain_counter(slice, MAX_UNKNOWNS_AT_POINTS), Count.TOTAL)
    written = tape_of(model.mechanism, parameters)
    poses = []
    for at, solution in found:
        pose, bits = pose_at(model.mechanism, parameters, written, at, solution, digits)
        stable = solution.signs == "+" if solution.signs else None
        poses.append((replace(pose, stable=stable, admissible=is_tense(stable, pose.springs)), bits))
    has_energy = model.mechanism.has_potential

    def order(found: tuple[Pose, int]) -> tuple[bool, Fraction]:
        pose, _ = found
        return not pose.stable, pose.known_energy.center if has_energy else pose.angles[0].center

    return answered(model, parameters, digits, sorted(poses, key=order), unclear, NOT_TOLD)
