"""Loops that fold flat at every point of a slice, as a parallelogram's and a kite's do: told apart
from other faults.

The poses of such a loop are several branches, which meet where it is flat; of a loop of four bars
they are named.

Guarantee: exact. Where a loop folds flat at a point is decided by the ideal of its equations and
the tangent.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from flint import fmpq

from ptmcad.algebra.bases import quotient
from ptmcad.algebra.trigonometric import TrigonometricPolynomial
from ptmcad.errors import DegenerateSliceError, InfiniteSolutionsError
from ptmcad.exact.models.potential import elements_of
from ptmcad.exact.models.system import SystemOnAxes, at_point, polynomial_at
from ptmcad.exact.witness import Point
from ptmcad.model import Mechanism, Model
from ptmcad.model.compile import compiled
from ptmcad.model.description import looped
from ptmcad.model.fourbars import IN_TWO_WAYS, closed_by, four_bars
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.flint_numbers import to_fraction

Degenerate = DegenerateSliceError | InfiniteSolutionsError


def with_folds(
    error: Degenerate,
    model: Model,
    on: SystemOnAxes,
    at: Iterable[Point],
) -> Degenerate:
    """The error, or one that says that it is a loop which folds flat all over the slice.

    Parameters
    ----------
    at : points of the slice that nobody has chosen.
    """
    mechanism = looped(model)
    if mechanism is None:
        return error
    flat = elements_of(model, compiled(model).tangent)
    seen = {p: found for p in at if (found := _folds_at(flat, on, p)) is not None}
    if not seen or not all(seen.values()):
        return error
    why = _branches(mechanism, on, tuple(seen))
    return DegenerateSliceError(
        f"at every point of the slice the loop that {closed_by(mechanism)} closes can fold flat{why}",
        part=error.part,
    )


def _folds_at(
    tangent: Sequence[TrigonometricPolynomial], on: SystemOnAxes, at: Point
) -> bool | None:
    """Whether some pose, real or complex, has a tangent that is zero; None where a parameter has no
    value.
    """
    try:
        values = on.values(at)
    except ZeroDivisionError:
        return None
    system = on.system
    flat = [polynomial_at(system, p, values) for p in tangent]
    circles = [{m: fmpq(c) for m, c in circle.items()} for circle in system.ring.circles]
    found = quotient(
        [e for e in (*at_point(system, values)[0], *flat) if e] + circles, system.ring.width
    )
    return found is None or found.dimension > 0


def _branches(mechanism: Mechanism, on: SystemOnAxes, at: Sequence[Point]) -> str:
    """What the branches are that meet in flat poses, where they can be named, and how to describe
    each by itself.
    """
    for loop in four_bars(mechanism) if len(mechanism.closing) == 1 else ():
        folds = [loop.fold(_expressions(on, p)) for p in at]
        if folds and folds[0] and len(set(folds)) == 1:
            return loop.named(folds[0])
    return IN_TWO_WAYS


def _expressions(on: SystemOnAxes, at: Point) -> dict[str, Expression]:
    return {name: constant(to_fraction(value)) for name, value in on.values(at).items()}
