"""All equilibria of the mechanism at one rational point, by the engine that the point needs.

Guarantee: a count is exact or proved. In more than three angles a Groebner basis over Q may not end:
it is tried as long as it stays small; beyond, the certified engine searches the torus at the point,
which decides everything but a degenerate solution in about a second for four angles and half a
minute for five. Neither goes on without end.

Algebra is loaded where it is used: who asks for a point with free lengths does without.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from importlib.util import find_spec
from time import monotonic
from typing import TYPE_CHECKING

from ptmcad.answer.counts import Counts
from ptmcad.answer.poses import DIGITS, MAX_DIGITS, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.errors import A_MODEL, ConfigError, LimitReached, expect, shown
from ptmcad.model import Model, ptm
from ptmcad.model.compile import compiled
from ptmcad.process.memory import loading
from ptmcad.question.config import point_from, point_from_mapping, units_of
from ptmcad.question.counts import Count
from ptmcad.question.shipped import RecordSource
from ptmcad.question.slice import Slice, have_free_lengths
from ptmcad.text.expressions import constant
from ptmcad.text.numerals import Numbers

if TYPE_CHECKING:
    from ptmcad.algebra.fibre_algebra import WorkLimit


def solve(
    question: RecordSource | Slice | None = None,
    /,
    digits: int = DIGITS,
    model: Model | None = None,
    **parameters: object,
) -> Poses:
    """All equilibria of the paper's mechanism, or solutions of another model, at a rational point.

    >>> poses = solve(rho="1", L2="3/2")
    >>> [pose.angles[0].text(6) for pose in poses.equilibria if pose.stable]
    ['0.812756', '-0.812756']
    >>> record = {"axes": {"rho": [0, 2], "L2": [0, 2]}, "parameters": {"F3": "-10", "F4": "-10"}}
    >>> len(solve(record, rho="7/10", L2="3/2").equilibria)
    6

    Parameters
    ----------
    question : a slice, the file of a record, or a mapping like one: the point is given by values of
        its axes.
    digits : significant digits that every number settles, 1 to `MAX_DIGITS`; more digits cost more
        time.
    model : the mechanism or system where no question is given; the paper's mechanism when None.
    parameters : by the names of a problem record (of the paper's mechanism L1, L2, rho, k or k1,
        k2, k3, F3, F4, F3x, F4x, l0 or l0_1, l0_2, l0_3), with its defaults: lengths 1, stiffness
        100, no load, free lengths 0. Text, int, Fraction, Decimal, float (its shortest decimal) or
        one of numpy's numbers.

    Raises
    ------
    ConfigError
        For a name or a value that is wrong, with the name.
    """
    if isinstance(digits, bool) or not isinstance(digits, int) or not 1 <= digits <= MAX_DIGITS:
        raise ConfigError(
            f"{shown(repr(digits), 60)} is not a number of digits from 1 to {MAX_DIGITS}",
            key="digits",
        )
    if isinstance(question, int):
        raise ConfigError(
            f"give the number of digits by name: digits={shown(repr(question), 60)}", key="digits"
        )
    if question is not None:
        if model is not None:
            raise ConfigError(
                "a slice or record has a model of its own: leave one out", key="model"
            )
        return replace(
            poses_at(*point_from(question, parameters), digits), units=units_of(question)
        )
    if model is None:
        model = ptm()
    expect(model, Model, "model", A_MODEL)
    return poses_at(model, point_from_mapping(parameters, model), digits)


def poses_at(model: Model, parameters: Numbers, digits: int) -> Poses:
    """All solutions of a model; only the engine that is used is loaded.

    Of a mechanism with more than three angles whose basis grows too large it is the certified one,
    where that leaves the point undecided, the exact one with a basis by msolve,
    if it is installed.

    Parameters
    ----------
    parameters : all of the model's, with the free lengths if some is not zero.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    ConfigError
        For springs with a free length in a mechanism that the certified engine does not take.
    """
    if needs_intervals(model, parameters):
        return _poses_by_search(model, parameters, digits)
    from ptmcad.exact.exactposes import exact_poses

    given = {n: v for n, v in parameters.items() if n not in model.free_lengths}
    most = None if model.whole is None else work_for(model)
    try:
        return exact_poses(model, given, digits, most)
    except LimitReached:
        if most is None:
            raise
    found = _poses_by_search(model, parameters, digits)
    more = work_by_msolve() if found.status is Status.UNDECIDED else None
    try:
        return found if more is None else exact_poses(model, given, digits, more)
    except LimitReached:
        return found


def needs_intervals(model: Model, parameters: Numbers) -> bool:
    """Whether some spring has a free length at a point."""
    return have_free_lengths(model, {name: constant(value) for name, value in parameters.items()})


FEW = 3
"""Unknowns of which a basis is computed whatever it takes: there are seldom more than 64 solutions.
"""
_MAX_WORK = 64, 120, 500, 5_000
"""Solutions, and polynomials, terms and bits of a basis, which take about two seconds."""

_MAX_BY_MSOLVE = 150
"""Solutions, whose algebra takes some tens of seconds: 70 take ten, of which the basis's proof is
the half.
"""


def work_for(model: Model) -> WorkLimit | None:
    """How much work the exact solutions at a point may be before the certified engine is asked;
    None for any.

    It takes critical points of a function of angles alone; with free lengths nothing else is asked
    anyway.
    """
    from ptmcad.algebra.fibre_algebra import WorkLimit

    if model.criterion.order <= FEW or model.reals or compiled(model).inequalities:
        return None
    return WorkLimit(*_MAX_WORK) if find_spec("numba") is not None else None


def work_by_msolve() -> WorkLimit | None:
    """How much work the exact solutions may be where the search has not separated all; None
    without msolve.
    """
    from ptmcad.algebra.bases import SMALL
    from ptmcad.algebra.msolve import program

    return SMALL._replace(by_msolve=_MAX_BY_MSOLVE) if program() is not None else None


def counts_by_search(model: Model, point: Mapping[str, Fraction], timeout: float | None) -> Counts:
    """Numbers of critical points at a point, by the certified engine.

    Parameters
    ----------
    timeout : seconds after which the search is given up; None for as many as it takes, which are
        bounded.

    Raises
    ------
    LimitReached
        When they were not all separated.
    """
    with loading("the certified engine"):
        from ptmcad.certified.plain.certifiedposes import point_slice
        from ptmcad.certified.plain.pointcounts import plain_counter
        from ptmcad.certified.plain.problem import MAX_UNKNOWNS_AT_POINTS
    tried = "the Groebner basis of the equations grows beyond what is computed at a point"
    if len(model.unknowns) > MAX_UNKNOWNS_AT_POINTS:
        raise LimitReached(
            f"{tried}, and the certified engine takes up to {MAX_UNKNOWNS_AT_POINTS} unknowns there"
        )
    counter = plain_counter(
        point_slice(model, point), MAX_UNKNOWNS_AT_POINTS, _clock(tried, timeout)
    )
    found = counter.at(Fraction(0), Fraction(0), Count.INDEX)
    if not found.decided or found.total is None:
        raise LimitReached(
            f"{tried}, and the certified engine did not tell all solutions apart: there are infinitely many, one is "
            "degenerate or nearly so, or they are too many for its search; change a value a little"
        )
    return Counts(found.total, found.stable, found.index)


def _clock(tried: str, timeout: float | None) -> Callable[[], None]:
    """What ends a search that takes longer."""
    end = None if timeout is None else monotonic() + timeout

    def pause() -> None:
        if end is not None and monotonic() > end:
            raise LimitReached(
                f"{tried}, and the certified engine was stopped after {timeout:g} s: give more as timeout"
            )

    return pause


def _poses_by_search(model: Model, point: Numbers, digits: int) -> Poses:
    """All equilibria at a point, by the certified engine; UNDECIDED where they were not all
    separated.
    """
    with loading("the certified engine"):
        from ptmcad.certified.plain.certifiedposes import plain_poses
    return plain_poses(model, point, digits)
