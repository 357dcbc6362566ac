"""Other angles in which a system's equations are shorter: sums of the unknown ones, such as the directions of bars.

Guarantee: the new angles are the old ones times an integer matrix of determinant 1 or -1, so that each solution is one
in the other angles, and the equations generate the same ideal of functions on the torus.

Bars whose angles are measured against the bar before have cosines of sums in their coordinates; the basis of such
equations takes minutes for three bars, that of the same equations in the bars' directions a third of a second.
"""

from __future__ import annotations

from itertools import permutations
from typing import NamedTuple

from ptmcad.algebra.fibre import FibreAlgebra, combined_angles
from ptmcad.algebra.trigonometric import TrigonometricPolynomial, TrigonometricRing
from ptmcad.exact.models.system import ParametricSystem, from_equations

MIN_ANGLES = 3
"""With two angles the gain is nothing."""
MAX_DEGREE, MAX_TERMS = 20, 2_000
"""Of an equation, and of all of them: with more the search alone would take many seconds. Six bars have 8 and 1170."""
Matrix = tuple[tuple[int, ...], ...]


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
    """The system with the angles in which its equations have the least degrees and the fewest terms, where others do.

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
                found = tuple(_substituted(system.ring, e, i, j, sign) for e in equations)
                if system.has_index:  # derivatives by the new angles
                    found = tuple(e + sign * found[i] if k == j else e for k, e in enumerate(found))
                if (other := _cost(found)) < cost:
                    # the angle i is the new angle i and sign times the angle j
                    best = tuple((*r[:j], r[j] + sign * r[i], *r[j + 1 :]) for r in best)
                    equations, cost, improved = found, other, True
    if best == identity:
        return system
    return system._replace(turns=Turns(_moved(system, equations, best), best))


def in_old_angles(system: ParametricSystem, algebra: FibreAlgebra, turns: Turns) -> FibreAlgebra:
    """The fibre of the equations in new angles, with the coordinates of the unknown ones before the new ones'."""
    return combined_angles(algebra, turns.matrix, len(system.ring.reals))


def _moved(
    system: ParametricSystem, equations: tuple[TrigonometricPolynomial, ...], matrix: Matrix
) -> ParametricSystem:
    """The system in new angles, with the equations that are known there."""
    ring = system.ring
    images = list(ring.context.gens())
    for k, row in enumerate(matrix):
        cosine, sine = ring.context.constant(1), ring.context.constant(0)
        for angle, multiple in zip(ring.angles, row, strict=True):
            c, s = ring.cos(angle), ring.sin(angle) * (-1 if multiple < 0 else 1)
            for _ in range(abs(multiple)):
                cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        at = len(ring.parameters) + 2 * k
        images[at], images[at + 1] = cosine, sine

    def moved(p: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return ring.reduce(p.compose(*images))

    return from_equations(
        ring,
        equations,
        potential=None if system.potential is None else moved(system.potential),
        inequalities=tuple(map(moved, system.inequalities)),
        stability=tuple(map(moved, system.stability)),
        definite=system.definite,
        positive=system.positive,
        nonnegative=system.nonnegative,
    )


def _is_searched(equations: tuple[TrigonometricPolynomial, ...]) -> bool:
    """Whether it is worth while to look for other angles."""
    degree = max((int(e.total_degree()) for e in equations), default=0)
    return degree <= MAX_DEGREE and sum(map(len, equations)) <= MAX_TERMS


def _cost(equations: tuple[TrigonometricPolynomial, ...]) -> tuple[int, int]:
    return sum(int(e.total_degree()) for e in equations), sum(len(e) for e in equations)


def _substituted(
    ring: TrigonometricRing, p: TrigonometricPolynomial, i: int, j: int, sign: int
) -> TrigonometricPolynomial:
    """p with the angle i replaced by the sum of angle i and sign times angle j."""
    first, second = ring.angles[i], ring.angles[j]
    c, s, d, t = ring.cos(first), ring.sin(first), ring.cos(second), ring.sin(second) * sign
    images = list(ring.context.gens())
    at = len(ring.parameters) + 2 * i
    images[at], images[at + 1] = c * d - s * t, s * d + c * t
    return ring.reduce(p.compose(*images))
