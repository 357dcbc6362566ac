"""Equations of sliders that springs hold, solved for one length each by Cramer's rule, for bounds.

Guarantee: exact. At every solution, and at every limit of solutions with any unit vector for the direction of a spring
without length, a `Separated` has |rest| at most the sum of its springs' reaches. (Lemma 19.3 of docs/soundness.md.)

Let the smooth parts of some equations be linear in as many lengths s, A s + b, and the parts K u.w_i of the springs
with free lengths not depend on s but by their directions u. Then det A times s_k is a sum of what is known, and of the
numbers K u.v with v from Cramer's rule, of which each is at most K |v|. If det A is zero nowhere, all s are bounded.
Springs of positive stiffness have for A the matrix of the sum of k |d|^2 as a quadratic form of s, which is singular
only where some motion of the sliders leaves all springs as they are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ptmcad.certified.formula import Formula, Graph, length
from ptmcad.certified.parameters import expression_formula
from ptmcad.certified.plain.ends import Vector
from ptmcad.certified.plain.nested import nested
from ptmcad.certified.plain.problem import Problem, Push
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.text.expressions import Expression

Matrix = Sequence[Sequence[TrigonometricPolynomial]]


@dataclass(frozen=True, slots=True)
class Separated:
    """A combination of equations in which only one of the lengths is left, but for the directions of springs.

    Attributes
    ----------
    unknown : number of the length.
    slope : det A, the same for all lengths.
    smooth : the combination without all parts of springs that have a direction.
    cones : K and the vector v of each spring of which K u.v is taken off.
    pushes : of the springs on one line, with one weight each: what is taken off, too.
    """

    unknown: int
    slope: TrigonometricPolynomial
    smooth: TrigonometricPolynomial
    cones: tuple[tuple[Expression, Vector], ...]
    pushes: tuple[Push, ...]

    def nonnegative(
        self, graph: Graph, unknowns: Sequence[Formula], order: Sequence[tuple[int, bool]]
    ) -> tuple[Formula, Formula]:
        """The reach of the springs plus the rest, and less it: both are at least zero at solutions.

        Parameters
        ----------
        order : how the smooth part is nested, as `ptmcad.certified.plain.nested.nested` has it.
        """
        rest, reach = nested(graph, self.smooth, unknowns, order), graph.constant(0)
        for push in self.pushes:
            rest = rest - push.strength(graph) * push.weights[0].formula(graph, unknowns)
        for pull, (x, y) in self.cones:
            arm = length(x.formula(graph, unknowns), y.formula(graph, unknowns))
            reach = reach + expression_formula(graph, pull) * arm
        return reach + rest, reach - rest


def separated(problem: Problem, chosen: Sequence[int]) -> tuple[Separated, ...]:
    """The equations of some lengths, solved for each of them; nothing where they are not linear, or singular as such.

    Parameters
    ----------
    chosen : numbers of unknowns that are no angles.
    """
    equations = [problem.equations[k] for k in chosen]
    weights = [part for cone in problem.cones for k in chosen for part in cone.weights[k]]
    weights += [push.weights[k] for push in problem.pushes for k in chosen]
    if any(_degree(f, chosen) > 1 for f in equations) or any(_degree(f, chosen) for f in weights):
        return ()
    matrix = [[f.derivative(k) for k in chosen] for f in equations]
    slope = _determinant(matrix)
    if not slope.terms:
        return ()
    return tuple(
        _solved(problem, slope, k, dict(zip(chosen, _cofactors(matrix, j), strict=True))) for j, k in enumerate(chosen)
    )


def _solved(
    problem: Problem, slope: TrigonometricPolynomial, unknown: int, factors: Mapping[int, TrigonometricPolynomial]
) -> Separated:
    """The sum of the chosen equations times these factors."""

    def combined(parts: Sequence[TrigonometricPolynomial]) -> TrigonometricPolynomial:
        return _sum([factor * parts[k] for k, factor in factors.items()])

    arms = [
        (cone.pull, (combined([x for x, _ in cone.weights]), combined([y for _, y in cone.weights])))
        for cone in problem.cones
    ]
    return Separated(
        unknown,
        slope,
        combined(problem.equations),
        tuple((pull, (x, y)) for pull, (x, y) in arms if x.terms or y.terms),
        tuple(Push(push.pull, push.direction, (combined(push.weights),)) for push in problem.pushes),
    )


def _degree(f: TrigonometricPolynomial, chosen: Sequence[int]) -> int:
    """In the chosen unknowns together."""
    return max((sum(e[k] for k in chosen) for _, e in f.terms), default=0)


def _cofactors(matrix: Matrix, column: int) -> list[TrigonometricPolynomial]:
    """Those of a column: the rows times them are the determinant in that column, and zero in all others."""
    signed = []
    for i in range(len(matrix)):
        minor = [[*row[:column], *row[column + 1 :]] for k, row in enumerate(matrix) if k != i]
        found = _determinant(minor)
        signed.append(found if (i + column) % 2 == 0 else _NOTHING - found)
    return signed


def _determinant(matrix: Matrix) -> TrigonometricPolynomial:
    """By Laplace's expansion; for the few rows that there are."""
    if len(matrix) == 1:
        return matrix[0][0]
    first = matrix[0]
    cofactors = [_determinant([[*row[:j], *row[j + 1 :]] for row in matrix[1:]]) for j in range(len(first))]
    terms = [a * b for a, b in zip(first, cofactors, strict=True)]
    return _sum(terms[::2]) - _sum(terms[1::2])


_NOTHING = TrigonometricPolynomial({})


def _sum(terms: Sequence[TrigonometricPolynomial]) -> TrigonometricPolynomial:
    return sum(terms, start=_NOTHING)
