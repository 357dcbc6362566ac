"""The curves of a slice at which counts change, for any problem: folds, equilibria that a spring's cone swallows,
and solutions at which a condition stops to hold.

Guarantee: each point of the window at which the chosen count changes lies on the projection of one of the curves
(docs/soundness.md, "Plain formulas").
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from ptmcad.certified.curve import CriticalCurve
from ptmcad.certified.plain.angle import Angle
from ptmcad.certified.plain.bounds import TURN, Range, ranges
from ptmcad.certified.plain.chart import SpringChart, chart, principal_minors
from ptmcad.certified.plain.frame import MirrorFrame, frames
from ptmcad.certified.plain.geometry import FactoredProblem, geometry
from ptmcad.certified.plain.involution import mirrors, square_of
from ptmcad.certified.plain.problem import FIRST, Condition, Problem, SpringCone, problem_of
from ptmcad.certified.plain.quotient import NEAR, SymmetricFold, folds
from ptmcad.certified.plain.straight import branches
from ptmcad.certified.scales import TURNING_WEIGHT, short_lengths, variable_weights
from ptmcad.certified.solved import Quotient, quotients
from ptmcad.certified.system import system
from ptmcad.formulas.determinants import determinant
from ptmcad.formulas.graph import Formula, Graph
from ptmcad.model.involutions import Involution
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice

SHORT_RATIO = 4
"""Near an involution's fixed points a spring is short where its length is at most so many times what is short
elsewhere, times the distance of a configuration from its image: nearly all springs are long on them."""


@dataclass(frozen=True, slots=True)
class _CurveSearch:
    """What all curves of a slice have in common.

    Attributes
    ----------
    exact : the problem with common factors that are positive in the window.
    short : below this length a spring is searched in its chart.
    stable : whether only folds of minima are asked for.
    swallowed : whether solutions that springs without length swallow have curves of their own.
    dependent : whether formulas that vanish at all solutions are used besides the equations.
    mirrors : a frame of each involution, configurations near whose fixed points are searched about these.
    rising : whether only solutions are asked for at which the Jacobian's determinant is not negative.
    """

    problem: Problem
    exact: FactoredProblem
    ranges: tuple[Range, ...]
    weights: tuple[float, ...]
    short: tuple[Fraction, ...]
    stable: bool
    swallowed: bool
    dependent: bool
    conditions: tuple[Condition, ...]
    rising: bool
    where: str
    mirrors: tuple[MirrorFrame, ...] = ()


def curves(slice: Slice, count: Count, without: frozenset[str] = frozenset()) -> tuple[CriticalCurve, ...]:
    """The curves at which ``count`` may change.

    Parameters
    ----------
    without : names of savings to switch off, of `ptmcad.question.savings`.

    Raises
    ------
    ConfigError
        As `problem_of` and `ranges` do.
    """
    found = branches(problem_of(slice), slice.axes)
    return tuple(curve for branch in found for curve in _of_branch(slice, count, without, branch))


def _of_branch(slice: Slice, count: Count, without: frozenset[str], problem: Problem) -> Iterator[CriticalCurve]:
    bounds = ranges(problem, slice.axes)
    exact = geometry(problem, slice.axes)
    at = chart(exact)
    stable = problem.is_gradient and count.is_of_stable and "folds-of-saddles" not in without
    search = _CurveSearch(
        problem,
        exact,
        bounds,
        variable_weights(slice, at.equations, bounds),
        short_lengths(slice, at.lengths, bounds),
        stable,
        not stable or "cones-and-creases" in without,
        "dependent-equations" not in without and not problem.closing,
        problem.conditions(count),
        problem.closing > 0 and count.is_of_stable,
        problem.where,
    )
    found = [] if "mirror-images" in without else mirrors(slice, problem)
    yield from _quotient(search, found, at) if found else _smooth(search, at)
    yield from _boundaries(search, at)
    yield from _of_predicate(search, at)


def _smooth(search: _CurveSearch, at: SpringChart) -> tuple[CriticalCurve, ...]:
    """The folds, and the cones."""
    if not search.swallowed:
        # the folds' systems have the points at which a minimum is swallowed
        return (_fold(search, at), *_short_folds(search, at))
    return (_fold(search, at), *_short_folds(search, at), *_cones(search, at))


def _quotient(search: _CurveSearch, changes: Sequence[Involution], whole: SpringChart) -> Iterator[CriticalCurve]:
    """The folds where involutions keep the problem, and limits without a spring's length.

    Minima are searched all about one involution's fixed points if one unknown is odd; else what is far from all fixed
    points is searched as without an involution. So is, where all equilibria are, what is near them with a short spring:
    such a spring's direction is as good as any there, and no equilibrium parts with its image.
    """
    near = not search.stable or len(changes) > 1 or changes[0].odd > 1
    for change in changes:
        around = list(frames(search.problem, change, search.ranges))
        charted = None if search.stable else around[0]
        for frame in around:
            for fold in folds(search.exact, frame, stable=search.stable, near=near):
                yield _fold_about(search, fold, charted)
        if charted is not None:
            yield from _short_folds(search, whole, charted)
        search = replace(search, mirrors=(*search.mirrors, around[0]))
    if near:
        yield from (_fold(search, whole), *_short_folds(search, whole))
    yield from _cones(search, whole)


def _fold_about(search: _CurveSearch, fold: SymmetricFold, charted: MirrorFrame | None) -> CriticalCurve:
    """A fold in coordinates about an involution's fixed points, every spring long where these are ``charted``."""
    long = () if charted is None else [_excess(search, fold.at, s, charted) for s in _charted(search, fold.at)]
    cheap, costly = (
        [*own, *more] if search.dependent else []
        for own, more in zip(fold.vanishing, _dependent(search, fold.at), strict=True)
    )
    return CriticalCurve(
        fold.name + search.where,
        fold.reason,
        system(
            fold.equations,
            (0, 1, *(FIRST + k for k in range(len(fold.ranges)))),
            ([f for f in cheap if f.value is None], costly),
            [
                *fold.nonnegative,
                *long,
                *_far(search, fold.at),
                *(_semidefinite(fold.at) if search.stable else ()),
                *_values(search.conditions, fold.at),
            ],
            solved=_solved(search, [*fold.equations, *fold.at.equations, *cheap]),
        ),
        fold.ranges,
        np.array([*search.weights[:2], *(1.0 for _ in fold.ranges)]),
    )


def _solved(search: _CurveSearch, vanishing: Sequence[Formula]) -> tuple[Quotient, ...]:
    """Formulas that vanish at solutions, solved for axes; for none that springs' directions depend on.

    With one unknown that costs more boxes than it saves.
    """
    ends = [c for cone in search.problem.cones for d in cone.difference for pair in d.terms.values() for c in pair]
    if not (search.dependent and ends) or len(search.problem.unknowns) == 1:
        return ()
    return quotients(vanishing, [k for k in (0, 1) if not any(c.uses(k) for c in ends)])


def _charted(search: _CurveSearch, at: SpringChart) -> list[int]:
    """The cones that have a chart: those of springs that several unknowns move, and all in closed loops."""
    return [s for s, cone in enumerate(at.cones) if len(cone.active) > 1 or search.problem.closing]


def _fold(search: _CurveSearch, at: SpringChart) -> CriticalCurve:
    """Solutions with a singular Jacobian, every spring long that has a chart where it is short."""
    return _curve(
        search,
        _name(search),
        _reason(search),
        [*at.equations, at.determinant()],
        _dependent(search, at),
        [
            *(_excess(search, at, s) for s in _charted(search, at)),
            *_far(search, at),
            *(_semidefinite(at) if search.stable else []),
            *_values(search.conditions, at),
        ],
        _solved(search, [*at.equations, *_dependent(search, at)[0]]),
    )


def _curve(
    search: _CurveSearch,
    name: str,
    reason: str,
    equations: Sequence[Formula],
    vanishing: tuple[Sequence[Formula], Sequence[Formula]] = ((), ()),
    nonnegative: Sequence[Formula] = (),
    solved: Sequence[Quotient] = (),
    *,
    turning: bool = False,
) -> CriticalCurve:
    """A curve in the axes and the problem's unknowns; ``turning`` where a short spring's direction is one more."""
    unknowns = len(search.problem.unknowns) + turning
    return CriticalCurve(
        name,
        reason,
        system(equations, range(FIRST + unknowns), vanishing, nonnegative, solved=solved),
        (*search.ranges, TURN)[:unknowns],
        np.array([*search.weights, TURNING_WEIGHT][: FIRST + unknowns]),
    )


def _far(search: _CurveSearch, at: SpringChart) -> list[Formula]:
    """What is not negative where configurations are not searched about an involution's fixed points."""
    return [_distance(search, at, mirror) - NEAR for mirror in search.mirrors]


def _distance(search: _CurveSearch, at: SpringChart, mirror: MirrorFrame) -> Formula:
    """Of a configuration from its image, squared."""
    angles = [name not in search.problem.reals for name in search.problem.unknowns]
    unknowns = [
        Angle(u.graph, {u: 1}) if isinstance(u, Formula) and is_angle else u
        for u, is_angle in zip(at.unknowns, angles, strict=True)
    ]
    return mirror.distance(unknowns)


def _excess(search: _CurveSearch, at: SpringChart, s: int, near: MirrorFrame | None = None) -> Formula:
    """What is not negative where a spring is long, near an involution's fixed points or elsewhere."""
    if near is None:
        return at.lengths[s] - search.short[s]
    share = SHORT_RATIO**2 * _distance(search, at, near) + NEAR**2
    return at.lengths[s].squared() - search.short[s] ** 2 * share


def _semidefinite(at: SpringChart) -> list[Formula]:
    """What is not negative at minima, nor at limits of them, but for the determinant."""
    return [
        *principal_minors(at.matrix_at_equilibrium()),
        *(f for s in range(len(at.cones)) for f in at.diagonal_times_length(s)),
        *(turned.stiffness for turned in at.turned),
    ]


def _dependent(search: _CurveSearch, at: SpringChart) -> tuple[Sequence[Formula], Sequence[Formula]]:
    """What vanishes at folds besides the equations, cheap formulas first."""
    if not search.dependent:
        return (), ()
    moments = [turned.moment for turned in at.turned]
    along = () if at.short is None else at.along
    return (*moments, *at.dependent, *along), (
        *at.balances,
        *([at.determinant(at_equilibrium=True)] if at.cones else []),
        *at.determinants_by_turning(),
        *([at.levelled()] if at.cones and not search.stable else []),
    )


def _values(conditions: Sequence[Condition], at: SpringChart) -> list[Formula]:
    """What is not negative at solutions that count, nor at limits of them."""
    return [condition.value.formula(at.equations[0].graph, at.unknowns) for condition in conditions]


def _boundaries(search: _CurveSearch, at: SpringChart) -> Iterator[CriticalCurve]:
    """Solutions at which a condition is zero and no other one is violated; there one stops or begins to count."""
    semidefinite = [*principal_minors(at.hessian), determinant(at.hessian)] if search.stable else []
    semidefinite += [at.determinant()] if search.rising else []
    for k, condition in enumerate(search.conditions):
        others = _values([*search.conditions[:k], *search.conditions[k + 1 :]], at)
        yield _boundary(search, at, condition, [*others, *semidefinite])


def _of_predicate(search: _CurveSearch, at: SpringChart) -> Iterator[CriticalCurve]:
    """Stable equilibria at which one of a predicate's margins is zero, and no other one is negative."""
    minima = [*_semidefinite(at), at.determinant(at_equilibrium=True)] if search.problem.is_gradient else []
    minima += [at.determinant()] if search.rising else []
    moments = [turned.moment for turned in at.turned]
    values = _values(search.problem.further, at)
    for k, condition in enumerate(search.problem.further):
        nonnegative = [*values[:k], *values[k + 1 :], *minima, *_values(search.conditions, at)]
        solved = _solved(search, [*at.equations, *moments, *at.dependent])
        yield _boundary(search, at, condition, nonnegative, ([*moments, *at.dependent], at.balances), solved)


def _boundary(
    search: _CurveSearch,
    at: SpringChart,
    condition: Condition,
    nonnegative: Sequence[Formula],
    vanishing: tuple[Sequence[Formula], Sequence[Formula]] = ((), ()),
    solved: Sequence[Quotient] = (),
) -> CriticalCurve:
    """The solutions at which a condition is zero."""
    vanish = condition.squares or (condition.value,)
    zero, *others = (f.formula(at.equations[0].graph, at.unknowns) for f in vanish)
    cheap, rest = vanishing
    return _curve(
        search,
        (condition.curve or f"point where {condition.text} is 0") + search.where,
        condition.reason or f"solutions count where {condition.text} > 0, and at one of them it is zero",
        [*at.equations, zero],
        ([*others, *cheap], rest),
        nonnegative,
        solved,
    )


def _short_folds(search: _CurveSearch, at: SpringChart, near: MirrorFrame | None = None) -> Iterator[CriticalCurve]:
    """The same where one spring is short, in its chart; the other ones may have any length.

    Parameters
    ----------
    near : of the involution near whose fixed points they are.
    """
    for s in _charted(search, at):
        cone, at = search.problem.cones[s], chart(search.exact, s)
        semidefinite: list[Formula] = []
        if search.stable:
            semidefinite = [*at.diagonal_times_length(s), *(turned.stiffness for turned in at.turned)]
        yield _curve(
            search,
            f"{_name(search)} with spring {cone.name} short",
            f"{_reason(search)}; spring {cone.name} is at most {search.short[s]} long",
            [at.aligned, *at.equations, at.determinant()],
            _dependent(search, at),
            [
                at.cones[s].extent,
                -_excess(search, at, s, near),
                *([] if near is None else [NEAR - _distance(search, at, near)]),
                *_far(search, at),
                *semidefinite,
                *_values(search.conditions, at),
            ],
            _solved(search, [*at.equations, *_dependent(search, at)[0]]),
            turning=True,
        )


def _points_without_length(search: _CurveSearch, at: SpringChart) -> Iterator[CriticalCurve]:
    """The same as `_cones` for one degree of freedom, where two equations d = 0 leave curves and need no direction."""
    graph, closing = at.equations[0].graph, search.problem.closing
    unknowns = [graph.variable(k) for k in search.problem.variables]
    for cone in search.problem.cones:
        vanishing = [d.formula(graph, unknowns) for d in cone.difference]
        yield _curve(
            search,
            f"point where spring {cone.name} has no length{search.where}",
            f"an equilibrium is swallowed where spring {cone.name} has no length",
            [*at.equations[:closing], *(f for f in vanishing if f.value != 0)],
            ((), at.equations[closing:]),
            _values(search.conditions, at),
        )


def _cones(search: _CurveSearch, whole: SpringChart) -> Iterator[CriticalCurve]:
    """Equilibria that come to a configuration in which a spring with a free length has none."""
    if len(search.problem.unknowns) - search.problem.closing == 1:
        yield from _points_without_length(search, whole)
        return
    for s, cone in enumerate(search.problem.cones):
        moving = whole.cones[s].active
        if len(moving) == 1 and search.problem.is_gradient and not search.stable:
            yield _crease(search, cone, *moving)
            continue
        at = chart(search.exact, s)
        graph = at.equations[0].graph
        unknowns = [graph.variable(k) for k in search.problem.variables]
        # a coordinate that is zero everywhere says nothing
        vanishing = [f for f in (d.formula(graph, unknowns) for d in cone.difference) if f.value != 0]
        yield _curve(
            search,
            f"point where spring {cone.name} has no length{search.where}",
            f"an equilibrium is swallowed where spring {cone.name} has no length",
            [*vanishing, *at.equations],
            ((), at.balances),
            [*(at.diagonal_times_length(s) if search.stable else ()), *_values(search.conditions, at)],
            turning=True,
        )


def _crease(search: _CurveSearch, cone: SpringCone, moving: int) -> CriticalCurve:
    """All configurations in which a spring that one unknown alone moves has no length, whether it is balanced or not.

    That is a curve by itself: other springs without length there do not matter. Where the unknown turns a vector that
    is always as long, this is as long as the rest on it, and the unknown drops out.
    """
    x, y = cone.difference
    gap = square_of((x.still, y.still)) - square_of((x - x.still, y - y.still))
    drops = bool(gap.terms) and gap == gap.still
    unknown = Graph().variable(FIRST)
    vanishing = [f.formula(unknown.graph, [unknown] * len(search.ranges)) for f in ((gap,) if drops else (x, y))]
    ranges = () if drops else (search.ranges[moving],)
    return CriticalCurve(
        f"crease where spring {cone.name} has no length{search.where}",
        f"spring {cone.name} has no length, whatever the other unknowns are",
        system([f for f in vanishing if f.value != 0], range(FIRST + len(ranges))),
        ranges,
        np.array(search.weights[: FIRST + len(ranges)]),
    )


def _name(search: _CurveSearch) -> str:
    return ("fold of a stable equilibrium" if search.stable else "fold") + search.where


def _reason(search: _CurveSearch) -> str:
    if search.problem.closing:
        return "equilibria meet, or a loop folds flat: the Jacobian is singular"
    if search.stable:
        return "a minimum meets a saddle: det H = 0 with no negative principal minor"
    return "equilibria meet: det H = 0" if search.problem.is_gradient else "solutions meet: the Jacobian is singular"
