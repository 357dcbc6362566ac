"""What all curves of a slice have in common: what is known of a search, and what vanishes or is positive at solutions.

Guarantee: `dependent` vanishes at all solutions with a singular Jacobian, `semidefinite` and `values` are nowhere
negative at minima that count, nor at limits of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.certified.formula import Formula
from ptmcad.certified.plain.bounds import Range
from ptmcad.certified.plain.chart import Chart, principal_minors
from ptmcad.certified.plain.geometry import Geometry
from ptmcad.certified.plain.problem import Condition, Problem
from ptmcad.certified.solved import Quotient, quotients


@dataclass(frozen=True, slots=True)
class Search:
    """What all curves of a slice have in common.

    Attributes
    ----------
    exact : the problem with common factors that are positive in the window.
    short : below this length a spring is searched in its chart.
    stable : whether only folds of minima are asked for.
    swallowed : whether solutions that springs without length swallow have curves of their own.
    dependent : whether formulas that vanish at all solutions are used besides the equations.
    """

    problem: Problem
    exact: Geometry
    ranges: tuple[Range, ...]
    weights: tuple[float, ...]
    short: tuple[Fraction, ...]
    stable: bool
    swallowed: bool
    dependent: bool
    conditions: tuple[Condition, ...]
    where: str

    def solved(self, vanishing: Sequence[Formula]) -> tuple[Quotient, ...]:
        """Formulas that vanish at solutions, solved for axes on which no spring's direction depends."""
        ends = [c for cone in self.problem.cones for d in cone.difference for pair in d.terms.values() for c in pair]
        return quotients(vanishing, [k for k in (0, 1) if not any(c.uses(k) for c in ends)])


def semidefinite(at: Chart) -> list[Formula]:
    """What is not negative at minima, nor at limits of them, but for the determinant."""
    return [
        *principal_minors(at.matrix_at_equilibrium()),
        *(f for s in range(len(at.springs)) for f in at.diagonal_times_length(s)),
        *(turned.stiffness for turned in at.turned),
    ]


def dependent(
    search: Search, at: Chart, cheap: Sequence[Formula] = (), costly: Sequence[Formula] = ()
) -> tuple[Sequence[Formula], Sequence[Formula]]:
    """What vanishes at folds besides the equations, cheap formulas first, and others that are given."""
    if not search.dependent:
        return (), ()
    moments = [turned.moment for turned in at.turned]
    along = () if at.short is None else at.along
    return [f for f in (*cheap, *moments, *at.dependent, *along) if f.value != 0], [
        *costly,
        *at.balances,
        *([at.determinant(at_equilibrium=True)] if at.springs else []),
        *at.determinants_by_turning(),
        *([at.levelled()] if at.springs and not search.stable else []),
    ]


def values(conditions: Sequence[Condition], at: Chart) -> list[Formula]:
    """What is not negative at solutions that count, nor at limits of them."""
    return [condition.value.formula(at.equations[0].graph, at.unknowns) for condition in conditions]
