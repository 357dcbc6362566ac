"""The curves of a slice at which counts change, for any problem: folds, equilibria that a spring's
cone swallows where the spring has no length, and solutions at which a condition stops to hold.

Guarantee: each point of the window at which the chosen count changes lies on the projection of one
of the curves (docs/soundness.md, Theorem 2).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ptmcad.certified.plain.curvesearch import CurveSearch, Pruning, short_lengths, variable_weights
from ptmcad.certified.plain.geometry import geometry
from ptmcad.certified.plain.harmonics import Angle, TrigonometricPolynomial, Unknown
from ptmcad.certified.plain.mirrors import (
    CONES,
    DEPENDENT,
    SADDLES,
    MirrorFrame,
    frames,
    omissions,
    square_of,
)
from ptmcad.certified.plain.problem import FIRST, TURN, Condition, Problem, SpringCone, problem_of
from ptmcad.certified.plain.springchart import SpringChart, chart, principal_minors
from ptmcad.certified.plain.straight import branches
from ptmcad.certified.plain.symmetricfolds import NEAR_SQUARED, SymmetricFold, folds
from ptmcad.certified.plain.unknownranges import ranges
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.formulas.graph import Formula, Graph, determinant
from ptmcad.model.involutions import Involution
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice

SHORT_RATIO = 4
"""Near an involution's fixed points a spring is short where its length is at most so many times
what is short elsewhere, times the distance of a configuration from its image: nearly all springs
are long on them."""


def curves(
    slice: Slice, count: Count, without: frozenset[str] = frozenset()
) -> tuple[CriticalCurve, ...]:
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


def _of_branch(
    slice: Slice, count: Count, without: frozenset[str], problem: Problem
) -> Iterator[CriticalCurve]:
    bounds = ranges(problem, slice.axes)
    exact = geometry(problem, slice.axes)
    at = chart(exact)
    left_out, _, mirrors = omissions(slice, problem, count, without)
    search = CurveSearch(
        exact,
        bounds,
        variable_weights(slice, at.equations, bounds),
        short_lengths(slice, at.lengths, bounds),
        SADDLES in left_out,
        DEPENDENT in left_out,
        problem.conditions(count),
        problem.closing > 0 and count.is_of_stable,
    )
    if mirrors:
        yield from _quotient(search, mirrors, at)
    else:
        yield from (_fold(search, at), *_short_folds(search, at))
    if CONES not in left_out:
        yield from cones(search, at)
    yield from _boundaries(search, at)
    yield from _of_predicate(search, at)


def _quotient(
    search: CurveSearch, changes: Sequence[Involution], whole: SpringChart
) -> Iterator[CriticalCurve]:
    """The folds where involutions keep the problem.

    Minima are searched all about one involution's fixed points if one unknown is odd; else what is
    far from all fixed points is searched as without an involution. So is, where all equilibria are,
    what is near them with a short spring: such a spring's direction is as good as any there, and no
    equilibrium parts with its image.
    """
    only_near = not search.stable or len(changes) > 1 or changes[0].odd > 1
    for change in changes:
        around = list(frames(search.problem, change, search.ranges))
        charted = None if search.stable else around[0]
        for frame in around:
            for fold in folds(search.exact, frame, stable=search.stable, only_near=only_near):
                yield _fold_about(search, fold, charted)
        if charted is not None:
            yield from _short_folds(search, whole, charted)
        search = replace(search, mirrors=(*search.mirrors, around[0]))
    if only_near:
        yield from (_fold(search, whole), *_short_folds(search, whole))


def _fold_about(
    search: CurveSearch, fold: SymmetricFold, charted: MirrorFrame | None
) -> CriticalCurve:
    """A fold in coordinates about an involution's fixed points, every spring long where these are
    ``charted``.
    """
    at = fold.at
    long = (
        () if charted is None else [_excess(search, at, s, charted) for s in _charted(search, at)]
    )
    nonnegative = [*fold.nonnegative, *long]
    pruning = _pruning(search, at, fold.equations, fold.vanishing, nonnegative)
    pruning = pruning._replace(cheap=[f for f in pruning.cheap if f.value is None])
    return search.curve(
        fold.name + search.problem.where, fold.reason, fold.equations, pruning, fold.ranges
    )


def _charted(search: CurveSearch, at: SpringChart) -> list[int]:
    """The cones that have a chart: those of springs that several unknowns move, and all in closed
    loops.
    """
    return [s for s, cone in enumerate(at.cones) if len(cone.active) > 1 or search.problem.closing]


def _fold(search: CurveSearch, at: SpringChart) -> CriticalCurve:
    """Solutions with a singular Jacobian, every spring long that has a chart where it is short."""
    equations = [*at.equations, at.determinant()]
    nonnegative = [_excess(search, at, s) for s in _charted(search, at)]
    pruning = _pruning(search, at, nonnegative=nonnegative)
    return search.curve(_name(search), _reason(search), equations, pruning)


def _pruning(
    search: CurveSearch,
    at: SpringChart,
    equations: Sequence[Formula] = (),
    vanishing: tuple[Sequence[Formula], Sequence[Formula]] = ((), ()),
    nonnegative: Sequence[Formula] = (),
    minima: Sequence[Formula] | None = None,
) -> Pruning:
    """What discards boxes in the search for folds.

    Parameters
    ----------
    equations : besides those of the problem.
    vanishing, nonnegative : formulas, cheap and costly ones, that are used in addition.
    minima : what is not negative at minima, where that is not `_semidefinite`.
    """
    cheap, costly = (
        [*own, *more] if search.dependent else []
        for own, more in zip(vanishing, _dependent(search, at), strict=True)
    )
    if minima is None:
        minima = _semidefinite(at) if search.stable else ()
    return Pruning(
        cheap,
        costly,
        [
            *nonnegative,
            *_far(search, at),
            *minima,
            *search.values(at),
        ],
        [*equations, *at.equations, *cheap],
    )


def _far(search: CurveSearch, at: SpringChart) -> list[Formula]:
    """What is not negative where configurations are not searched about an involution's fixed
    points.
    """
    return [_distance_squared(search, at, mirror) - NEAR_SQUARED for mirror in search.mirrors]


def _distance_squared(search: CurveSearch, at: SpringChart, mirror: MirrorFrame) -> Formula:
    """Of a configuration from its image."""
    unknowns = [
        Angle(u.graph, {u: 1}) if isinstance(u, Formula) and is_angle else u
        for u, is_angle in zip(at.unknowns, search.problem.is_angle, strict=True)
    ]
    return mirror.distance_squared(unknowns)


def _excess(
    search: CurveSearch, at: SpringChart, s: int, mirror: MirrorFrame | None = None
) -> Formula:
    """What is not negative where a spring is long, near an involution's fixed points or elsewhere."""
    if mirror is None:
        return at.lengths[s] - search.short[s]
    share = SHORT_RATIO**2 * _distance_squared(search, at, mirror) + NEAR_SQUARED**2
    return at.lengths[s].squared() - search.short[s] ** 2 * share


def _semidefinite(at: SpringChart) -> list[Formula]:
    """What is not negative at minima, nor at limits of them, but for the determinant."""
    return [
        *principal_minors(at.matrix_at_equilibrium()),
        *(f for s in range(len(at.cones)) for f in at.diagonal_times_length(s)),
        *(turned.stiffness for turned in at.turned),
    ]


def _dependent(search: CurveSearch, at: SpringChart) -> tuple[Sequence[Formula], Sequence[Formula]]:
    """What vanishes at folds besides the equations, cheap formulas first; nothing without that
    saving.
    """
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


def _boundaries(search: CurveSearch, at: SpringChart) -> Iterator[CriticalCurve]:
    """Solutions at which a condition is zero and no other one is violated; there one stops or
    begins to count.
    """
    semidefinite = [*principal_minors(at.hessian), determinant(at.hessian)] if search.stable else []
    semidefinite += [at.determinant()] if search.rising else []
    yield from _zeros(search, at, search.conditions, Pruning(nonnegative=semidefinite))


def _of_predicate(search: CurveSearch, at: SpringChart) -> Iterator[CriticalCurve]:
    """Stable equilibria at which one of a predicate's margins is zero, and no other one is
    negative.
    """
    if not search.problem.further:
        return
    minima = (
        [*_semidefinite(at), at.determinant(at_equilibrium=True)]
        if search.problem.is_gradient
        else []
    )
    minima += [at.determinant()] if search.rising else []
    cheap = [*(turned.moment for turned in at.turned), *at.dependent]
    nonnegative = [*minima, *search.values(at)]
    pruning = Pruning(cheap, at.balances, nonnegative, [*at.equations, *cheap])
    yield from _zeros(search, at, search.problem.further, pruning)


def _zeros(
    search: CurveSearch, at: SpringChart, conditions: Sequence[Condition], pruning: Pruning
) -> Iterator[CriticalCurve]:
    """The solutions at which one of some conditions is zero, and no other one is negative."""
    values = [condition.value.formula(at.unknowns) for condition in conditions]
    for k, condition in enumerate(conditions):
        zero, *others = (f.formula(at.unknowns) for f in condition.squares or (condition.value,))
        yield search.curve(
            (condition.curve or f"point where {condition.text} is 0") + search.problem.where,
            condition.reason
            or f"solutions count where {condition.text} > 0, and at one of them it is zero",
            [*at.equations, zero],
            pruning._replace(
                cheap=[*others, *pruning.cheap],
                nonnegative=[*values[:k], *values[k + 1 :], *pruning.nonnegative],
            ),
        )


def _short_folds(
    search: CurveSearch, at: SpringChart, mirror: MirrorFrame | None = None
) -> Iterator[CriticalCurve]:
    """The same where one spring is short, in its chart; the other ones may have any length.

    Parameters
    ----------
    mirror : of the involution near whose fixed points they are.
    """
    for s in _charted(search, at):
        cone, at = search.problem.cones[s], chart(search.exact, s)
        minima = (
            [*at.diagonal_times_length(s), *(turned.stiffness for turned in at.turned)]
            if search.stable
            else []
        )
        nonnegative = [
            at.cones[s].extent,
            -_excess(search, at, s, mirror),
            *([] if mirror is None else [NEAR_SQUARED - _distance_squared(search, at, mirror)]),
        ]
        yield search.curve(
            f"{_name(search)} with spring {cone.name} short",
            f"{_reason(search)}; spring {cone.name} is at most {search.short[s]} long",
            [at.aligned, *at.equations, at.determinant()],
            _pruning(search, at, nonnegative=nonnegative, minima=minima),
            (*search.ranges, TURN),
        )


def _name(search: CurveSearch) -> str:
    return ("fold of a stable equilibrium" if search.stable else "fold") + search.problem.where


def _reason(search: CurveSearch) -> str:
    if search.problem.closing:
        return "equilibria meet, or a loop folds flat: the Jacobian is singular"
    if search.stable:
        return "a minimum meets a saddle: det H = 0 with no negative principal minor"
    return (
        "equilibria meet: det H = 0"
        if search.problem.is_gradient
        else "solutions meet: the Jacobian is singular"
    )


def cones(search: CurveSearch, whole: SpringChart) -> Iterator[CriticalCurve]:
    """Equilibria that come to a configuration in which a spring with a free length has none."""
    closing = search.problem.closing
    for s, cone in enumerate(search.problem.cones):
        moving = whole.cones[s].active
        name = f"point where spring {cone.name} has no length{search.problem.where}"
        reason = f"an equilibrium is swallowed where spring {cone.name} has no length"
        if len(search.problem.unknowns) - closing == 1:
            # of one degree of freedom two equations d = 0 leave curves and need no direction
            equations = [
                *whole.equations[:closing],
                *_without_length(cone.difference, whole.unknowns),
            ]
            pruning = Pruning(costly=whole.equations[closing:], nonnegative=search.values(whole))
            yield search.curve(name, reason, equations, pruning)
        elif len(moving) == 1 and search.problem.is_gradient and not search.stable:
            yield _crease(search, cone, *moving)
        else:
            at = chart(search.exact, s)
            equations = [*_without_length(cone.difference, at.unknowns), *at.equations]
            minima = at.diagonal_times_length(s) if search.stable else ()
            pruning = Pruning(costly=at.balances, nonnegative=[*minima, *search.values(at)])
            yield search.curve(name, reason, equations, pruning, (*search.ranges, TURN))


def _without_length(
    parts: Sequence[TrigonometricPolynomial], unknowns: Sequence[Unknown]
) -> list[Formula]:
    """What is zero where some polynomials are; one that is zero everywhere says nothing."""
    return [f for f in (part.formula(unknowns) for part in parts) if f.value != 0]


def _crease(search: CurveSearch, cone: SpringCone, moving: int) -> CriticalCurve:
    """All configurations in which a spring that one unknown alone moves has no length, whether it
    is balanced or not.

    That is a curve by itself: other springs without length there do not matter. Where the unknown
    turns a vector that is always as long, this is as long as the rest on it, and the unknown drops
    out.
    """
    x, y = cone.difference
    gap = square_of((x.still, y.still)) - square_of((x - x.still, y - y.still))
    drops = bool(gap.terms) and gap == gap.still
    unknowns = [Graph().variable(FIRST)] * len(search.ranges)
    return search.curve(
        f"crease where spring {cone.name} has no length{search.problem.where}",
        f"spring {cone.name} has no length, whatever the other unknowns are",
        _without_length((gap,) if drops else (x, y), unknowns),
        Pruning(),
        () if drops else (search.ranges[moving],),
    )
