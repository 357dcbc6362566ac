"""What equilibria of a mechanism with closed loops satisfy.

Guarantee: nothing is taken from `ptmcad.model.loops`, which writes the same formulas as trees. With g the squared
distances that closing bars keep, less the squares of these, and U the energy, an equilibrium is a zero of g and of E,
the determinant of the gradients of g and U; it is stable where the determinant of the gradients of g and E is positive.
Where several degrees of freedom are left, each bar's tension is one more unknown.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from flint import fmpq, fmpq_mpoly

from ptmcad.verification.coordinates import CoordinateRing
from ptmcad.verification.inertia import determinant, total

Conditions = tuple[tuple[fmpq_mpoly, ...], tuple[fmpq_mpoly, ...]]
"""Equations, each zero at an equilibrium, and what is positive at a stable one."""


def along(
    ring: CoordinateRing, unknowns: Sequence[str], kept: Sequence[fmpq_mpoly], row: Sequence[fmpq_mpoly]
) -> fmpq_mpoly:
    """The derivative along loops with one degree of freedom of what has the slopes of a row."""
    found: fmpq_mpoly = determinant([*(ring.gradient(g, unknowns) for g in kept), row])
    return found


def one_way(
    ring: CoordinateRing, unknowns: Sequence[str], kept: Sequence[fmpq_mpoly], slopes: Sequence[fmpq_mpoly]
) -> Conditions:
    """Where one degree of freedom is left.

    Parameters
    ----------
    slopes : of the energy, less the moments.
    """
    force = along(ring, unknowns, kept, slopes)
    return (*kept, force), (along(ring, unknowns, kept, ring.gradient(force, unknowns)),)


def several_ways(
    ring: CoordinateRing, unknowns: Sequence[str], kept: Sequence[fmpq_mpoly], slopes: Sequence[fmpq_mpoly]
) -> Conditions:
    """Where more are: the last unknowns are the bars' tensions.

    The equations are the derivatives of the energy plus half of each tension times what its bar keeps. With s added to
    the unknowns' own second derivatives the determinant of the bordered matrix is a polynomial in s; its coefficients,
    with one sign, are all positive at a minimum.
    """
    count, bars = len(unknowns), len(kept)
    work = sum(
        (ring.elements[tension] * g * fmpq(1, 2) for tension, g in zip(unknowns[-bars:], kept, strict=True)),
        ring.context.constant(0),
    )
    equations = tuple(map(fmpq_mpoly.__add__, slopes, ring.gradient(work, unknowns)))
    rows = [ring.gradient(equation, unknowns) for equation in equations]
    sign = -1 if bars % 2 else 1

    def minors(size: int) -> fmpq_mpoly:
        """The sum of the principal minors without so many of the unknowns that are no tensions."""
        chosen = ([k for k in range(count) if k not in out] for out in combinations(range(count - bars), size))
        found: fmpq_mpoly = total(determinant([[rows[i][j] for j in of] for i in of]) for of in chosen)
        return found * sign

    return equations, tuple(minors(size) for size in reversed(range(count - 2 * bars)))
