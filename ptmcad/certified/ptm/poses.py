"""The equilibria at a point of a mechanism whose springs have free lengths, with everything asked of a pose.

Guarantee: each equilibrium is proved, and all are there unless the answer is UNDECIDED. Every number settles the digits
asked for or, where it may be zero, is enclosed. A pose is called flat, and its numbers are exact, only when the flat
configuration itself is an equilibrium, exactly, and lies in the box in which the pose is the only one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from flint import arb, ctx

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import Solution
from ptmcad.certified.arb_evaluation import ball
from ptmcad.certified.arb_isolation import Box, refined
from ptmcad.certified.plain.poses import NOT_TOLD, Written, answered, assembled, measured, point_slice, tape_of
from ptmcad.certified.ptm.points import point_counter
from ptmcad.certified.system import System
from ptmcad.mechanism import ptm
from ptmcad.question.domain import prove_slice
from ptmcad.question.slice import Count

MECHANISM = ptm()
MAX_DOUBLINGS = 5
"""Of the bits, for a number that is not distinguished from zero."""
_PEAKED = MECHANISM.springs[2]
_PEAKS = {
    1: f"the energy has a peak where spring {_PEAKED.start}{_PEAKED.end} has no length too",
    2: f"the energy has two peaks where spring {_PEAKED.start}{_PEAKED.end} has no length too",
}


def certified_poses(parameters: Mapping[str, Fraction], digits: int) -> Poses:
    """All equilibria of the mechanism.

    Parameters
    ----------
    parameters : all variables of the description.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    GeometryError
        When a length or a stiffness is not positive, or the base or a free length is negative.
    """
    slice = point_slice(MECHANISM, parameters)
    prove_slice(slice)
    counter = point_counter(slice)
    counts = counter.at(Fraction(0), Fraction(0), Count.INDEX)
    solutions, unclear = (counts.solutions, 0) if counts.decided else counter.proved(Fraction(0), Fraction(0))
    written, equations = tape_of(MECHANISM, parameters), counter.equilibria_at(Fraction(0), Fraction(0)).equations
    poses = [_pose(parameters, written, equations, s, digits) for s in solutions]
    found = answered(MECHANISM, parameters, digits, poses, unclear, NOT_TOLD, _PEAKS.get(counts.cones or 0, ""))
    return replace(found, equilibria=tuple(_ordered(found.equilibria)))


def _ordered(poses: Sequence[Pose]) -> list[Pose]:
    """Stable ones first, then by energy; where energies are not separated, larger angles come first."""
    by_energy = sorted(poses, key=lambda pose: pose.known_energy.center)
    groups: list[list[Pose]] = []
    for pose in by_energy:
        if groups and pose.known_energy.low <= max(p.known_energy.high for p in groups[-1]):
            groups[-1].append(pose)
        else:
            groups.append([pose])
    ordered = [
        pose
        for group in groups
        for pose in sorted(group, key=lambda p: (p.angles[0].center, p.angles[1].center), reverse=True)
    ]
    return sorted(ordered, key=lambda pose: not pose.stable)


def _pose(
    parameters: Mapping[str, Fraction], written: Written, equations: System, solution: Solution, digits: int
) -> tuple[Pose, int]:
    """The pose with all numbers settled or, where they may be zero, enclosed; and the bits that this took."""

    def boxes(bits: int) -> tuple[Box, Box]:
        with ctx.workprec(bits):
            r = solution.radius
            whole = (arb(0), arb(0), *(ball(c - r, c + r) for c in solution.center))
        return whole, refined(equations, whole, bits)

    numbers, bits = measured(MECHANISM, parameters, written, boxes, digits, MAX_DOUBLINGS)
    flat = all(numbers[f"sin {angle}"].exact == 0 for angle in MECHANISM.angles)
    return assembled(MECHANISM, parameters, numbers, solution.signs.count("-"), flat), bits
