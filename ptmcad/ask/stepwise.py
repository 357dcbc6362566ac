"""The exact engine's steps one by one, for any mechanism or system: the variety, an open CAD,
counts at a point.

Guarantee: exact, as the map is that these are the steps of; none of them draws or stores anything.
Where the basis at a point grows too large in more than three angles, the count is one that the
certified engine proves; where it does not tell, one from a basis by msolve, proved, if that is
installed.
"""

from __future__ import annotations

from time import monotonic

from ptmcad.algebra.bases import MISSING
from ptmcad.answer.counts import Counts
from ptmcad.answer.slicevariety import SliceVariety
from ptmcad.ask.solving import counts_by_search, work_by_msolve, work_for
from ptmcad.errors import A_MODEL, ConfigError, LimitReached, expect, shown
from ptmcad.exact.counting import equilibria
from ptmcad.exact.eliminationsystem import slice_variety
from ptmcad.exact.models import system_from
from ptmcad.exact.stages import decomposition_of, problem_of
from ptmcad.model import Model
from ptmcad.question.config import point_from_mapping, slice_from
from ptmcad.question.domain import proved
from ptmcad.question.shipped import RecordSource
from ptmcad.question.slice import Point, Slice, without_free_lengths
from ptmcad.text.expressions import constant
from ptmcad.text.flint_numbers import from_fraction

TIMEOUT = 60.0
"""Seconds for a search where algebra does not count."""
Question = Slice | RecordSource


def discriminant_variety(question: Question) -> SliceVariety:
    """The curves in Z[x, y] off which numbers of solutions are locally constant.

    >>> found = discriminant_variety({
    ...     "system": {"unknowns": {"x": "real"}, "equations": ["x^3 - a*x + b"]},
    ...     "axes": {"a": [-2, 2], "b": [-2, 2]},
    ... })
    >>> [component.polynomial.text(("a", "b")) for component in found.components]
    ['4*a^3 - 27*b^2']

    Parameters
    ----------
    question : a slice, the file of a record, or a mapping like a record.

    Raises
    ------
    ConfigError
        When the question is wrong, or springs have a free length.
    HypothesisError
        When the slice is degenerate, or has infinitely many solutions.

    References
    ----------
    Lazard & Rouillier, Solving parametric polynomial systems, J. Symb. Comp. 42 (2007).
    """
    return slice_variety(slice_from(question))


def open_cad(question: Question) -> tuple[Point, ...]:
    """A rational point of each cell of an open cylindrical algebraic decomposition of the window.

    The points lie off the variety, and at least one lies in each connected part of the window
    without the variety.

    Parameters
    ----------
    question : a slice, the file of a record, or a mapping like a record.

    Raises
    ------
    ConfigError, HypothesisError
        As `discriminant_variety` does.

    References
    ----------
    Strzebonski, Solving systems of strict polynomial inequalities, J. Symb. Comp. 29 (2000).
    """
    slice = slice_from(question)
    without_free_lengths(slice.model, slice.parameters, "an open CAD is")
    return decomposition_of(problem_of(proved(slice))).samples(slice.axis_names)


def counts_at(model: Model, *, timeout: float | None = TIMEOUT, **values: object) -> Counts:
    """Numbers of solutions of a mechanism or system at a rational point: in all, stable, and by
    index.

    >>> from ptmcad.question.config import make_system
    >>> counts_at(make_system(unknowns={"x": "real"}, equations=["x^3 - a*x + b"]), a=1, b="1/10").total
    3

    Parameters
    ----------
    timeout : seconds after which a search for critical points in more than three angles, whose
        basis grew too large for algebra, is given up; None for no limit.
    values : of the parameters, as text, int or Fraction; a mechanism's have defaults.

    Raises
    ------
    ConfigError
        For a name or a value that is wrong, with the name; also for springs that have a free
        length.
    HypothesisError
        When some solution is singular, or there are infinitely many.
    LimitReached
        When that search was given up, or did not tell all solutions apart.
    """
    if timeout is not None and (
        isinstance(timeout, bool) or not isinstance(timeout, int | float) or not timeout > 0
    ):
        raise ConfigError(
            f"{shown(repr(timeout), 60)} is not a positive number of seconds", key="timeout"
        )
    if isinstance(model, Slice):
        raise ConfigError(
            "a count is of a mechanism or a system: give the slice's model, and all values",
            key="model",
        )
    expect(model, Model, "model", A_MODEL)
    point = point_from_mapping(values, model)
    without_free_lengths(
        model, {n: constant(v) for n, v in point.items()}, "an exact count is", "use ptmcad.solve"
    )
    system = system_from(model)
    exact = {name: from_fraction(point[name]) for name in system.ring.parameters}
    try:
        return equilibria(system, exact, work_for(model)).counts
    except LimitReached:
        begun = monotonic()
    try:
        return counts_by_search(model, point, timeout)
    except LimitReached as error:
        if timeout is not None and monotonic() > begun + timeout:
            raise
        more = work_by_msolve()
        if more is None:
            raise LimitReached(f"{error}; {MISSING}") from error
        return equilibria(system, exact, more).counts
