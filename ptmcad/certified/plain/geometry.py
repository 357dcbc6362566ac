"""What all formulas of a problem are written of, exactly and once: factors, derivatives, springs,
bodies that turn.

Guarantee: everything is over the positive common factor of its equation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from ptmcad.certified.plain.cones import ConeShape, shape
from ptmcad.certified.plain.problem import Problem, Push
from ptmcad.certified.plain.scaling import common_factor, over
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.certified.plain.turning import Turn, turns
from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, constant


@dataclass(frozen=True, slots=True)
class FactoredProblem:
    """A problem with its factors.

    Attributes
    ----------
    factors : of the equations, positive in the open window.
    equations, slopes : the smooth parts over their factors, and their derivatives by the unknowns.
    shapes : of the springs with a free length.
    turns : directions in which bodies turn together; none are used of closed loops, and where
        springs are pushes.
    pushes : of the problem, with their weights over the factors.
    """

    problem: Problem
    factors: tuple[Expression, ...]
    equations: tuple[TrigonometricPolynomial, ...]
    slopes: tuple[tuple[TrigonometricPolynomial, ...], ...]
    shapes: tuple[ConeShape, ...]
    turns: tuple[Turn, ...]
    pushes: tuple[Push, ...]


def geometry(problem: Problem, axes: tuple[Axis, Axis] | None = None) -> FactoredProblem:
    """The same for all charts of a problem.

    Parameters
    ----------
    axes : of the window in which factors are to be positive; without them, and of closed loops, all
        factors are 1, and nothing turns.
    """
    factors: tuple[Expression, ...] = (constant(1),) * len(problem.equations)
    found: tuple[Turn, ...] = ()
    if axes is not None and not problem.closing:
        factors, found = (
            common_factors(problem, axes),
            () if problem.pushes else turns(problem, axes),
        )
    equations = tuple(over(f, g) for f, g in zip(problem.equations, factors, strict=True))
    return FactoredProblem(
        problem,
        factors,
        equations,
        tuple(tuple(f.derivative(j) for j in range(len(factors))) for f in equations),
        tuple(shape(cone, factors) for cone in problem.cones),
        found,
        tuple(
            replace(
                push, weights=tuple(over(w, g) for w, g in zip(push.weights, factors, strict=True))
            )
            for push in problem.pushes
        ),
    )


def common_factors(problem: Problem, axes: tuple[Axis, Axis]) -> tuple[Expression, ...]:
    """Of each equation and the slopes of its springs' ends: a positive common factor, 1 where none
    is proved to be.
    """
    return tuple(
        common_factor(
            [
                f,
                *(d.derivative(i) for cone in problem.cones for d in cone.difference),
                *(push.weights[i] for push in problem.pushes),
            ],
            axes,
        )
        for i, f in enumerate(problem.equations)
    )
