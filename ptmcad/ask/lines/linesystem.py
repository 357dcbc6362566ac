"""A model on a line of parameters: its formulas along the axis, in balls, and its solutions at
single values.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, ctx

from ptmcad.algebra.polynomials import Monomial
from ptmcad.answer.poses import Pose
from ptmcad.ask.lines.diagram import SolutionsOnLine
from ptmcad.exact.models import system_from
from ptmcad.exact.models.system import Part, Terms
from ptmcad.formulas.ballarithmetic import evaluated, signs_of
from ptmcad.formulas.continuation import BITS, BranchEquations, Reached, Vector, branch_equations
from ptmcad.formulas.graph import Formula, expression_formula
from ptmcad.model.compile import CompiledSystem
from ptmcad.question.line import Line, compiled_on
from ptmcad.question.slice import relaxed_springs
from ptmcad.text.balls import ball_of, ball_over
from ptmcad.text.flint_numbers import to_fraction

DIGITS = 12


@dataclass(frozen=True, slots=True)
class LineSystem:
    """A line with its model's formulas on it, those of its branches, and its solutions.

    Attributes
    ----------
    potential : the energy with the springs' free lengths; None where there is none.
    lengths : of the springs that have a free length; the equations are smooth where these are
        positive.
    """

    line: Line
    formulas: CompiledSystem
    branches: BranchEquations
    potential: Formula | None
    lengths: tuple[Formula, ...]
    solutions: SolutionsOnLine

    @property
    def angles(self) -> int:
        """How many of the unknowns are on the circle: the first ones."""
        return self.branches.angles

    @property
    def is_on_torus(self) -> bool:
        """Whether all unknowns are angles and all solutions count."""
        return not self.line.model.reals and not self.formulas.inequalities

    def values(
        self, formulas: Sequence[Formula], low: Fraction, high: Fraction, point: Vector
    ) -> list[arb]:
        """Formulas on the line for all parameters from low to high, at balls of the unknowns."""
        with ctx.workprec(BITS):
            return evaluated(formulas, (ball_over(low, high), *point))

    def sides(self, low: Fraction, high: Fraction, point: Vector) -> tuple[int, ...]:
        """Of each rising point of a mechanism 1 where it is proved above the x axis, -1 where
        below, else 0.
        """
        return signs_of(self.values(self.formulas.heights, low, high, point))

    def values_at(self, formulas: Sequence[Formula], reached: Reached) -> list[arb]:
        """Formulas on the line at a place of a branch."""
        return self.values(formulas, reached.value, reached.value, reached.point)


def line_system(line: Line) -> LineSystem:
    """The system of a line's model."""
    formulas = compiled_on(line.model, line.parameters)
    relaxed = relaxed_springs(line.model, line.parameters)
    return LineSystem(
        line,
        formulas,
        branch_equations(formulas.balance(relaxed), len(formulas.angles))
        if relaxed
        else _polynomial(line, formulas),
        formulas.energy(relaxed) if relaxed else formulas.smooth,
        tuple(formulas.springs[k].length for k in relaxed),
        SolutionsOnLine(line, DIGITS),
    )


def _polynomial(line: Line, formulas: CompiledSystem) -> BranchEquations:
    """The equations as polynomials of cosines and sines: in balls they are narrower so."""
    system, graph, angles = system_from(line.model), formulas.graph, len(formulas.angles)
    parameters = [
        expression_formula(graph, line.parameters[name]) for name in system.ring.parameters
    ]
    turns = (f for k in formulas.angles for f in (graph.variable(k).cos(), graph.variable(k).sin()))
    at = (*turns, *map(graph.variable, formulas.reals))

    def formula(terms: Terms) -> Formula:
        total = graph.constant(0)
        for monomial, part in terms:
            coefficient = graph.constant(0)
            for powers, c in part:
                factors = ((parameters[k], e) for k, e in powers)
                coefficient = coefficient + _product(graph.constant(to_fraction(c)), factors)
            total = total + _product(coefficient, zip(at, monomial, strict=True))
        return total

    def gradient(terms: Terms) -> list[Formula]:
        # that by an angle is made of those by its cosine and its sine: in balls it is narrower than
        # a sum of all terms'
        by = [formula(tuple(_lowered(terms, k))) for k in range(len(at))]
        turned = (at[k] * by[k + 1] - at[k + 1] * by[k] for k in range(0, 2 * angles, 2))
        return [*turned, *by[2 * angles :]]

    entries = [entry for row in system.jacobian_terms for entry in row]
    return branch_equations(
        list(map(formula, system.equation_terms)),
        angles,
        list(map(formula, entries)),
        list(map(gradient, entries)),
    )


def _lowered(terms: Terms, k: int) -> Iterator[tuple[Monomial, Part]]:
    """The derivative by a coordinate."""
    for monomial, part in terms:
        if monomial[k]:
            lower = (*monomial[:k], monomial[k] - 1, *monomial[k + 1 :])
            yield lower, tuple((powers, c * monomial[k]) for powers, c in part)


def _product(first: Formula, powers: Iterable[tuple[Formula, int]]) -> Formula:
    for factor, exponent in powers:
        for _ in range(exponent):
            first = first * factor
    return first


def coordinates_of(point: Vector, angles: int) -> list[arb]:
    """Cosine and sine of each angle, then the unknowns on the line."""
    return [*(f(a) for a in point[:angles] for f in (arb.cos, arb.sin)), *point[angles:]]


def guess_of(pose: Pose) -> Vector:
    """The middles of a pose's unknowns."""
    with ctx.workprec(BITS):
        return tuple(ball_of(a.center) for a in (*pose.angles, *pose.reals))
