"""The curves of a slice at which counts change, for any problem: folds, equilibria that a spring's cone swallows,
solutions at which a condition stops to hold, and such as leave to infinity.

Guarantee: each point of the window at which the chosen count changes lies on the projection of one of the curves
(docs/soundness.md, "Plain formulas").
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ptmcad.certified.curve import Curve
from ptmcad.certified.formula import Formula
from ptmcad.certified.parameters import expression_formula
from ptmcad.certified.plain.bounds import TURN, Range
from ptmcad.certified.plain.chart import Chart, chart, determinant, extended_determinant, principal_minors
from ptmcad.certified.plain.infinity import Patch, at_infinity, patches
from ptmcad.certified.plain.problem import FIRST, Condition, Problem, problem_of
from ptmcad.certified.scales import typical_lengths, variable_weights
from ptmcad.certified.system import system
from ptmcad.question.slice import Count, Slice

SHORT_SHARE = Fraction(1, 8)
"""A spring shorter than this part of its typical length is searched in its chart."""
TURNING_WEIGHT = 0.25
"""Of phi, which follows from the unknowns, in the choice which variable to bisect."""


@dataclass(frozen=True, slots=True)
class _Search:
    """What all curves of a slice have in common."""

    problem: Problem
    ranges: tuple[Range, ...]
    weights: tuple[float, ...]
    short: tuple[Fraction, ...]
    stable: bool
    conditions: tuple[Condition, ...]
    where: str


def curves(slice: Slice, count: Count, without: frozenset[str] = frozenset()) -> tuple[Curve, ...]:
    """The curves at which ``count`` may change.

    Parameters
    ----------
    without : names of savings to switch off, of `ptmcad.question.savings`.

    Raises
    ------
    ConfigError, GeometryError
        As `problem_of` and `patches` do.
    """
    found = patches(problem_of(slice), slice.axes)
    return tuple(curve for patch in found for curve in _of_patch(slice, count, without, patch))


def _of_patch(slice: Slice, count: Count, without: frozenset[str], patch: Patch) -> Iterator[Curve]:
    problem = patch.problem
    at = chart(problem)
    search = _Search(
        problem,
        patch.ranges,
        variable_weights(slice, at.equations, patch.ranges),
        tuple(_rounded(SHORT_SHARE * x) for x in typical_lengths(slice, at.lengths, patch.ranges)),
        problem.is_gradient and count is Count.STABLE and "folds-of-saddles" not in without,
        problem.conditions(count),
        "".join(f", {problem.unknowns[k]} large" for k in patch.inverse),
    )
    yield from _smooth(search, at)
    yield from _boundaries(search, at)
    yield from _infinite(search, patch)


def _infinite(search: _Search, patch: Patch) -> Iterator[Curve]:
    """Where a solution leaves to infinity."""
    for k in patch.inverse:
        equations, conditions = at_infinity(patch, k, search.conditions)
        if any(f.value is not None and f.value != 0 for f in equations):
            continue  # nowhere
        ranges = (*search.ranges[:k], (0.0, 0.0), *search.ranges[k + 1 :])
        name = search.problem.unknowns[k]
        yield Curve(
            f"{name} infinite{search.where}",
            f"a solution leaves to infinity with {name}",
            system(
                equations,
                (0, 1, *(variable for variable in search.problem.variables if variable != FIRST + k)),
                nonnegative=conditions,
            ),
            ranges,
            np.array(search.weights),
        )


def _smooth(search: _Search, at: Chart) -> tuple[Curve, ...]:
    """The folds, and the cones."""
    if len(search.problem.unknowns) == 1:
        return (_fold(search, at), *_points_without_length(search, at))
    if search.problem.closing:
        return (_fold(search, at), *_short_folds(search), *_points_without_length(search, at))
    return (_fold(search, at), *_short_folds(search), *_cones(search))


def _rounded(value: Fraction) -> Fraction:
    """A power of two near a positive number; any would do."""
    result = Fraction(1)
    while result > value:
        result /= 2
    while 2 * result < value:
        result *= 2
    return result


def _fold(search: _Search, at: Chart) -> Curve:
    """Solutions with a singular Jacobian, every spring with a free length long where the short ones have a chart."""
    charted = len(search.problem.unknowns) > 1
    long = [extent - short for extent, short in zip(at.lengths, search.short, strict=True) if charted]
    semidefinite: list[Formula] = principal_minors(at.hessian) if search.stable else []
    return Curve(
        _name(search),
        _reason(search),
        system(
            [*at.equations, determinant(at.hessian)],
            (0, 1, *search.problem.variables),
            ((), at.balances),
            [*long, *semidefinite, *_values(search.conditions, at)],
        ),
        search.ranges,
        np.array(search.weights),
    )


def _values(conditions: Sequence[Condition], at: Chart) -> list[Formula]:
    """What is not negative at solutions that count, nor at limits of them."""
    graph = at.equations[0].graph
    unknowns = [graph.variable(FIRST + k) for k in range(len(at.equations))]
    return [condition.value.formula(graph, unknowns) for condition in conditions]


def _boundaries(search: _Search, at: Chart) -> Iterator[Curve]:
    """Solutions at which a condition is zero and no other one is violated; there one stops or begins to count."""
    semidefinite = [*principal_minors(at.hessian), determinant(at.hessian)] if search.stable else []
    for k, condition in enumerate(search.conditions):
        others = _values([*search.conditions[:k], *search.conditions[k + 1 :]], at)
        yield Curve(
            f"boundary {condition.text} = 0{search.where}",
            f"solutions count where {condition.text} > 0, and at one of them it is zero",
            system(
                [*at.equations, *_values([condition], at)],
                (0, 1, *search.problem.variables),
                nonnegative=[*others, *semidefinite],
            ),
            search.ranges,
            np.array(search.weights),
        )


def _short_folds(search: _Search) -> Iterator[Curve]:
    """The same where one spring is short, in its chart; the other ones may have any length."""
    for s, cone in enumerate(search.problem.cones):
        at = chart(search.problem, s)
        aligned, along, *turned = at.turning
        semidefinite = []
        if search.stable:  # |d| times the diagonal of the Hessian, whose last part is K (u x dd)^2 / |d|
            pull = expression_formula(along.graph, cone.pull)
            semidefinite = [along * at.hessian[i][i] - pull * slope.squared() for i, slope in enumerate(turned)]
        yield Curve(
            f"{_name(search)}, spring {cone.name} short",
            f"{_reason(search)}; spring {cone.name} is at most {search.short[s]} long",
            system(
                [aligned, *at.equations, extended_determinant(at, search.problem)],
                (0, 1, *search.problem.variables, FIRST + len(search.problem.unknowns)),
                ((), at.balances),
                [along, search.short[s] - at.lengths[s], *semidefinite],
            ),
            (*search.ranges, TURN),
            np.array([*search.weights, TURNING_WEIGHT]),
        )


def _points_without_length(search: _Search, at: Chart) -> Iterator[Curve]:
    """The same as `_cones` where configurations are a curve: two equations d = 0 leave curves and need no direction."""
    graph = at.equations[0].graph
    unknowns = [graph.variable(k) for k in search.problem.variables]
    closed, others = at.equations[: search.problem.closing], at.equations[search.problem.closing :]
    for cone in search.problem.cones:
        vanishing = [f for f in (d.formula(graph, unknowns) for d in cone.difference) if f.value != 0]
        yield Curve(
            f"cone {cone.name}",
            f"an equilibrium is swallowed where spring {cone.name} has no length",
            system([*closed, *vanishing], (0, 1, *search.problem.variables), ((), others)),
            search.ranges,
            np.array(search.weights),
        )


def _cones(search: _Search) -> Iterator[Curve]:
    """Equilibria that come to a configuration in which a spring with a free length has none."""
    for s, cone in enumerate(search.problem.cones):
        at = chart(search.problem, s)
        graph = at.equations[0].graph
        unknowns = [graph.variable(k) for k in search.problem.variables]
        # a coordinate that is zero everywhere says nothing
        vanishing = [f for f in (d.formula(graph, unknowns) for d in cone.difference) if f.value != 0]
        yield Curve(
            f"cone {cone.name}",
            f"an equilibrium is swallowed where spring {cone.name} has no length",
            system(
                [*vanishing, *at.equations],
                (0, 1, *search.problem.variables, FIRST + len(search.problem.unknowns)),
                ((), at.balances),
            ),
            (*search.ranges, TURN),
            np.array([*search.weights, TURNING_WEIGHT]),
        )


def _name(search: _Search) -> str:
    return ("fold of a stable equilibrium" if search.stable else "fold") + search.where


def _reason(search: _Search) -> str:
    if search.stable:
        return "a minimum meets a saddle: det H = 0 with no negative principal minor"
    if search.problem.closing:
        return "equilibria meet, or a loop folds flat: the Jacobian is singular"
    return "equilibria meet: det H = 0" if search.problem.is_gradient else "solutions meet: the Jacobian is singular"
