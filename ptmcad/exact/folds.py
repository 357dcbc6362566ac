"""Loops that fold flat at every point of a slice, as a parallelogram's and a kite's do: told apart from other faults.

Guarantee: exact. Where a loop folds flat at a point is decided by the ideal of its equations and the tangent.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from flint import fmpq

from ptmcad.algebra.bases import quotient
from ptmcad.algebra.polynomials import Ratio, evaluate
from ptmcad.errors import DegenerateSliceError, InfiniteSolutionsError
from ptmcad.exact.models.potential import elements_of
from ptmcad.exact.models.system import ParametricSystem, at_point, polynomial_at
from ptmcad.exact.witness import Point
from ptmcad.mechanism import ClosedMechanism, Model

Degenerate = DegenerateSliceError | InfiniteSolutionsError


def with_folds(
    error: Degenerate,
    model: Model,
    system: ParametricSystem,
    parameters: Mapping[str, Ratio],
    at: Iterable[Point],
) -> Degenerate:
    """The error, or one that says that it is a loop which folds flat all over the slice.

    Parameters
    ----------
    at : points of the slice that nobody has chosen.
    """
    if not isinstance(model, ClosedMechanism):
        return error
    seen = [found for p in at if (found := _folds_at(model, system, parameters, p)) is not None]
    if not seen or not all(seen):
        return error
    bars = " and ".join(f"{c.start}{c.end}" for c in model.mechanism.closing)
    return DegenerateSliceError(
        f"at every point of the slice the loop that {bars} closes can fold flat, as those of parallelograms and kites "
        "can: two ways of assembling it meet there, and flat poses are multiple solutions whatever the loads are; give "
        "its bars other lengths, or write the branch that you mean as an open chain",
        part=error.part,
    )


def _folds_at(
    model: ClosedMechanism, system: ParametricSystem, parameters: Mapping[str, Ratio], at: Point
) -> bool | None:
    """Whether some pose, real or complex, has a tangent that is zero; None where a parameter has no value."""
    below = [evaluate(b, *at) for _, b in parameters.values()]
    if not all(below):
        return None
    values = {name: evaluate(a, *at) / b for (name, (a, _)), b in zip(parameters.items(), below, strict=True)}
    flat = [polynomial_at(system, p, values) for p in elements_of(model, model.tangent)]
    circles = [{m: fmpq(c) for m, c in circle.items()} for circle in system.ring.circles]
    found = quotient([e for e in (*at_point(system, values)[0], *flat) if e] + circles, system.ring.width)
    return found is None or found.dimension > 0
