"""All equilibria of the mechanism at one rational point, by the engine that the point needs."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.answer.poses import DIGITS, MAX_DIGITS, Poses
from ptmcad.ask.manyangles import poses_by_search, work_for
from ptmcad.errors import A_MODEL, ConfigError, LimitReached, expect, shown
from ptmcad.mechanism import Mechanism, Model, ptm
from ptmcad.process.memory import check_room, loading
from ptmcad.question.config import point_from_mapping
from ptmcad.question.examples import FIRST, SECOND
from ptmcad.question.slice import have_free_lengths
from ptmcad.text.expressions import constant


def solve(digits: int = DIGITS, model: Model | None = None, **parameters: object) -> Poses:
    """All equilibria of the paper's mechanism, or solutions of another model, at a rational point.

    >>> poses = solve(rho="1", L2="3/2")
    >>> [pose.angles[0].text(6) for pose in poses.equilibria if pose.stable]
    ['0.812756', '-0.812756']

    Parameters
    ----------
    digits : significant digits that every number settles, 1 to `MAX_DIGITS`; more digits cost more time.
    model : the mechanism or system; the paper's mechanism when None.
    parameters : by the names of a problem record (of the paper's mechanism L1, L2, rho, k or k1, k2, k3, F3, F4, F3x,
        F4x, l0 or l0_1, l0_2, l0_3), with its defaults: lengths 1, stiffness 100, no load, free lengths 0. Text, int,
        Fraction, Decimal, float (its exact binary value) or one of numpy's numbers.

    Raises
    ------
    ConfigError
        For a name or a value that is wrong, with the name.
    """
    if not isinstance(digits, int | float | str):
        raise ConfigError(
            f"expected the parameters' values by name, as in solve({FIRST}=1, {SECOND}='3/2'), and what they are of as "
            f"model=slice.model, not an object of type {type(digits).__name__}"
        )
    if isinstance(digits, bool) or not isinstance(digits, int) or not 1 <= digits <= MAX_DIGITS:
        raise ConfigError(f"{shown(repr(digits), 60)} is not a number of digits from 1 to {MAX_DIGITS}", key="digits")
    if model is None:
        model = ptm()
    expect(model, Model, "model", A_MODEL)
    return poses_at(model, point_from_mapping(parameters, model), digits)


def poses_at(model: Model, parameters: Mapping[str, Fraction], digits: int) -> Poses:
    """All solutions of a model; only the engine that is used is loaded.

    Of a mechanism with more than three angles whose basis grows too large it is the certified one, see `manyangles`.

    Parameters
    ----------
    parameters : all of the model's, with the free lengths if some is not zero.
    digits : significant digits that every enclosure settles.

    Raises
    ------
    ConfigError
        For springs with a free length in a mechanism that the certified engine does not take.
    """
    if isinstance(model, Mechanism) and needs_intervals(model, parameters):
        with loading("the certified engine"):
            from ptmcad.certified.plain.poses import plain_poses
            from ptmcad.certified.poses import certified_poses
        check_room("the certified engine")
        return certified_poses(parameters, digits) if model == ptm() else plain_poses(model, parameters, digits)
    from ptmcad.exact.poses import exact_poses

    given = {n: v for n, v in parameters.items() if n not in model.free_lengths}
    most = work_for(model) if isinstance(model, Mechanism) else None
    try:
        return exact_poses(model, given, digits, most)
    except LimitReached:
        assert isinstance(model, Mechanism)  # no other is limited
        return poses_by_search(model, parameters, digits)


def needs_intervals(model: Model, parameters: Mapping[str, Fraction]) -> bool:
    """Whether some spring has a free length at a point."""
    return have_free_lengths(model, {name: constant(value) for name, value in parameters.items()})
