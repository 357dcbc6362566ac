"""All equilibria of the mechanism at one rational point, by the engine that the point needs."""

from __future__ import annotations

from dataclasses import replace

from ptmcad.answer.poses import DIGITS, MAX_DIGITS, Poses
from ptmcad.answer.regionmap import Status
from ptmcad.ask.manyangles import poses_by_search, work_by_msolve, work_for
from ptmcad.errors import A_MODEL, ConfigError, LimitReached, expect, shown
from ptmcad.model import Model, ptm
from ptmcad.process.memory import loading
from ptmcad.question.config import point_from, point_from_mapping, units_of
from ptmcad.question.shipped import RecordSource
from ptmcad.question.slice import Slice, have_free_lengths
from ptmcad.text.expressions import constant
from ptmcad.text.numerals import Numbers


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
    see `manyangles`; where that leaves the point undecided, the exact one with a basis by msolve,
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
        with loading("the certified engine"):
            from ptmcad.certified.plain.certifiedposes import plain_poses
        return plain_poses(model, parameters, digits)
    from ptmcad.exact.exactposes import exact_poses

    given = {n: v for n, v in parameters.items() if n not in model.free_lengths}
    most = None if model.whole is None else work_for(model)
    try:
        return exact_poses(model, given, digits, most)
    except LimitReached:
        if most is None:
            raise
    found = poses_by_search(model, parameters, digits)
    more = work_by_msolve() if found.status is Status.UNDECIDED else None
    try:
        return found if more is None else exact_poses(model, given, digits, more)
    except LimitReached:
        return found


def needs_intervals(model: Model, parameters: Numbers) -> bool:
    """Whether some spring has a free length at a point."""
    return have_free_lengths(model, {name: constant(value) for name, value in parameters.items()})
