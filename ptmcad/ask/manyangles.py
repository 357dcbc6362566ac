"""Critical points in more than three angles at one point, where a Groebner basis over Q may not
end.

Guarantee: a count is exact or proved. The basis is tried as long as it stays small; beyond, the
certified engine searches the torus at the point, which decides everything but a degenerate solution
in about a second for four angles and half a minute for five. Neither goes on without end.

Algebra is loaded where it is used: who asks for a point with free lengths does without.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from importlib.util import find_spec
from time import monotonic
from typing import TYPE_CHECKING

from ptmcad.answer.counts import Counts
from ptmcad.answer.poses import Poses
from ptmcad.errors import LimitReached
from ptmcad.model import Model
from ptmcad.model.compile import compiled
from ptmcad.process.memory import loading
from ptmcad.question.counts import Count

if TYPE_CHECKING:
    from ptmcad.algebra.fibre_algebra import WorkLimit

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


def poses_by_search(mechanism: Model, point: Mapping[str, Fraction], digits: int) -> Poses:
    """All equilibria at a point, by the certified engine; UNDECIDED where they were not all
    separated.
    """
    with loading("the certified engine"):
        from ptmcad.certified.plain.certifiedposes import plain_poses
    return plain_poses(mechanism, point, digits)
