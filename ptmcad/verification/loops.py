"""What equilibria of a mechanism with closed loops satisfy.

Guarantee: nothing is taken from `ptmcad.model.closedloops`, which has the same as formulas of one graph.
With g the squared distances that closing bars keep, less the squares of these, and U the energy, an
equilibrium is a zero of g and of E, the determinant of the gradients of g and U; it is stable where
the determinant of the gradients of g and E is positive. Where several degrees of freedom are left,
each bar's tension is one more unknown.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

from flint import fmpq, fmpq_mpoly

from ptmcad.verification.coordinates import CoordinateRing
from ptmcad.verification.inertia import determinant, total

Conditions = tuple[tuple[fmpq_mpoly, ...], tuple[fmpq_mpoly, ...]]
"""Equations, each zero at an equilibrium, and what is positive at a stable one."""


class Loops(NamedTuple):
    """Closed loops: the unknowns, and what bars that close them keep zero."""

    ring: CoordinateRing
    unknowns: tuple[str, ...]
    kept: tuple[fmpq_mpoly, ...]

    @property
    def leave_one_way(self) -> bool:
        """Whether one degree of freedom is left."""
        return 0 < len(self.kept) == len(self.unknowns) - 1

    def along(self, slopes: Sequence[fmpq_mpoly]) -> fmpq_mpoly:
        """The derivative along loops with one degree of freedom of what has these slopes."""
        found: fmpq_mpoly = determinant(
            [*(self.ring.gradient(g, self.unknowns) for g in self.kept), slopes]
        )
        return found

    def conditions(self, slopes: Sequence[fmpq_mpoly]) -> Conditions:
        """What holds at an equilibrium.

        Parameters
        ----------
        slopes : of the energy, less the moments.
        """
        if not self.leave_one_way:
            return self._with_tensions(slopes)
        force = self.along(slopes)
        return (*self.kept, force), (self.along(self.ring.gradient(force, self.unknowns)),)

    def _with_tensions(self, slopes: Sequence[fmpq_mpoly]) -> Conditions:
        """Where several degrees of freedom are left: the last unknowns are the bars' tensions.

        The equations are the derivatives of the energy plus half of each tension times what its bar
        keeps. With s added to the unknowns' own second derivatives the determinant of the bordered
        matrix is a polynomial in s; its coefficients, with one sign, are all positive at a minimum.
        """
        ring, count, bars = self.ring, len(self.unknowns), len(self.kept)
        tensions = (ring.elements[name] * fmpq(1, 2) for name in self.unknowns[-bars:])
        work = total(tension * g for tension, g in zip(tensions, self.kept, strict=True))
        equations = tuple(map(fmpq_mpoly.__add__, slopes, ring.gradient(work, self.unknowns)))
        rows = [ring.gradient(equation, self.unknowns) for equation in equations]
        sign = -1 if bars % 2 else 1

        def minors(size: int) -> fmpq_mpoly:
            """The sum of the principal minors without so many of the unknowns that are no tensions."""
            chosen = (
                [k for k in range(count) if k not in out]
                for out in combinations(range(count - bars), size)
            )
            found: fmpq_mpoly = total(
                determinant([[rows[i][j] for j in of] for i in of]) for of in chosen
            )
            return found * sign

        return equations, tuple(minors(size) for size in reversed(range(count - 2 * bars)))
