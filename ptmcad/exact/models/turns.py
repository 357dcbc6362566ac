"""Other angles in which a system's equations are shorter: sums of the unknown ones, such as the
directions of bars.

Guarantee: the new angles are the old ones times an integer matrix of determinant 1 or -1, so that
each solution is one in the other angles, and the equations generate the same ideal of functions on
the torus.

Bars whose angles are measured against the bar before have cosines of sums in their coordinates; the
basis of such equations takes minutes for three bars, that of the same equations in the bars'
directions a third of a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from typing import NamedTuple

from ptmcad.algebra.fibre import FibreAlgebra, combined_angles
from ptmcad.algebra.trigonometric import TrigonometricPolynomial, TrigonometricRing, angle_sum
from ptmcad.exact.models.system import ParametricSystem, from_equations

MIN_ANGLES = 3
"""With two angles the gain is nothing."""
MAX_DEGREE, MAX_TERMS = 20, 2_000
"""Of an equation, and of all of them: with more the search alone would take many seconds. Six bars
have 8 and 1170.
"""
Matrix = Sequence[Sequence[int]]


class Turns(NamedTuple):
    """The equations in new angles.

    Attributes
    ----------
    system : in the same ring, whose angles stand for the new ones.
    matrix : row i has the multiples of the new angles that add up to the unknown angle i.
    """

    system: ParametricSystem
    matrix: Matrix


def with_turns(system: ParametricSystem) -> ParametricSystem:
    """The system with the angles in which its equations have the least degrees and the fewest
    terms, where others do.

    By steps, each of which measures one angle against another while that helps.
    """
    count = len(system.ring.angles)
    if count < MIN_ANGLES or not _is_searched(system.equations):
        return system
    identity = tuple(tuple(int(i == j) for j in range(count)) for i in range(count))
    best, equations = identity, system.equations
    cost = _cost(equations)
    improved = True
    while improved:
        improved = False
        for i, j in permutations(range(count), 2):
            for sign in (1, -1):
                step = [
                    [int(k == m) + sign * int((k, m) == (i, j)) for m in range(count)]
                    for k in range(count)
                ]
                images = _images(system.ring, step)
                reduced = [system.ring.reduce(e.compose(*images)) for e in equations]
                found = system.criterion.turned(reduced, i, j, sign)
                if (other := _cost(found)) < cost:
                    # the angle i is the new angle i and sign times the angle j
                    best = tuple((*r[:j], r[j] + sign * r[i], *r[j + 1 :]) for r in best)
                    equations, cost, improved = found, other, True
    if best == identity:
        return system
    return system._replace(turns=Turns(_moved(system, equations, best), best))


def in_old_angles(system: ParametricSystem, algebra: FibreAlgebra, turns: Turns) -> FibreAlgebra:
    """The fibre of the equations in new angles, with the coordinates of the unknown ones before the
    new ones'.
    """
    return combined_angles(algebra, turns.matrix, len(system.ring.reals))


def _moved(
    system: ParametricSystem, equations: tuple[TrigonometricPolynomial, ...], matrix: Matrix
) -> ParametricSystem:
    """The system in new angles, with the equations that are known there."""
    ring = system.ring
    images = _images(ring, matrix)

    def moved(p: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return ring.reduce(p.compose(*images))

    return from_equations(
        ring,
        equations,
        potential=None if system.potential is None else moved(system.potential),
        inequalities=tuple(map(moved, system.inequalities)),
        stability=tuple(map(moved, system.stability)),
        criterion=system.criterion,
        positive=system.positive,
        nonnegative=system.nonnegative,
    )


def _is_searched(equations: tuple[TrigonometricPolynomial, ...]) -> bool:
    """Whether it is worth while to look for other angles."""
    degree = max((int(e.total_degree()) for e in equations), default=0)
    return degree <= MAX_DEGREE and sum(map(len, equations)) <= MAX_TERMS


def _cost(equations: tuple[TrigonometricPolynomial, ...]) -> tuple[int, int]:
    return sum(int(e.total_degree()) for e in equations), sum(len(e) for e in equations)


def _images(ring: TrigonometricRing, matrix: Matrix) -> list[TrigonometricPolynomial]:
    """What stands for each variable of the ring, where the angles are these sums of new ones."""
    turns = [(ring.cos(angle), ring.sin(angle)) for angle in ring.angles]
    sums = [c for row in matrix for c in angle_sum(turns, row, ring.context.constant(1))]
    first = len(ring.parameters)
    gens = ring.context.gens()
    return [*gens[:first], *sums, *gens[first + len(sums) :]]
