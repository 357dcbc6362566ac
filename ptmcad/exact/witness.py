"""What is wrong with a slice that is degenerate at every point: a point that shows it, or a loop that
folds flat, as a parallelogram's and a kite's do.

The poses of such a loop are several branches, which meet where it is flat; of a loop of four bars
they are named.

Guarantee: exact, of that point. Whether a loop folds flat there is decided by the ideal of its
equations and the tangent. That nothing else degenerates there is likely, as it is the one of
some points with the most solutions, and not proved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction

from flint import fmpq

from ptmcad.algebra.bases import quotient
from ptmcad.algebra.polynomials import Values
from ptmcad.algebra.real_roots import Window
from ptmcad.algebra.trigonometric_ring import TrigonometricPolynomial
from ptmcad.errors import (
    DegenerateSliceError,
    HypothesisError,
    InfiniteSolutionsError,
    NothingToCountError,
)
from ptmcad.exact.models.modelsystem import elements_of
from ptmcad.exact.models.system import ParametricSystem, SystemOnAxes, at_point, polynomial_at
from ptmcad.exact.point_system import solutions_at
from ptmcad.model import Mechanism, Model
from ptmcad.model.compile import compiled
from ptmcad.model.description import looped
from ptmcad.model.fourbars import IN_TWO_WAYS, closed_by, four_bars
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.flint_numbers import from_fraction, to_fraction

Degenerate = DegenerateSliceError | InfiniteSolutionsError
Point = tuple[fmpq, fmpq]
SHARES = tuple(
    (Fraction(a, b), Fraction(c, d))
    for a, b, c, d in (
        (10, 21, 19, 35),
        (5, 11, 4, 13),
        (7, 17, 12, 19),
        (9, 23, 13, 29),
        (14, 31, 15, 37),
    )
)
"""Of the window: rarely on a curve that a person has in mind."""
Solutions = tuple[int, int]
"""With multiplicity, and different ones."""


def with_witness(
    error: Degenerate,
    on: SystemOnAxes,
    window: Window,
    place: Callable[[Point], str],
) -> Degenerate:
    """The error, with a point of the window that shows it added to its words; as it is where none
    was found.

    Parameters
    ----------
    place : a point in words.
    """
    examples = []
    for at in points(window):
        try:
            values = on.values(at)
        except ZeroDivisionError:
            continue
        words, solutions = _example(error, on.system, values)
        if words:
            examples.append((solutions, words, at))
    if not examples:
        return error
    # where the fewest solutions have left to infinity or coincide by chance, the first of such
    # points
    _, words, at = max(examples, key=lambda example: example[0])
    return type(error)(f"{error}; for example at {place(at)}{words}", part=error.part)


def _example(
    error: HypothesisError, system: ParametricSystem, values: Values
) -> tuple[str, Solutions]:
    """What shows a point's fault in words, none where it does not show, and the numbers of
    solutions there.
    """
    if isinstance(error, NothingToCountError):
        return _nothing(system, values), (0, 0)
    different, multiplicity = solutions_at(system, values, saturated=True)
    if isinstance(error, InfiniteSolutionsError):
        return " there are infinitely many solutions" if different is None else "", (0, 0)
    if different is None or different == multiplicity:
        return "", (0, 0)
    return f" only {different} of {multiplicity} solutions are different", (multiplicity, different)


def _nothing(system: ParametricSystem, values: Values) -> str:
    """How it shows at a point that there is nothing to count, in words."""
    counted = solutions_at(system, values, saturated=True)[0]
    if counted is None or counted > 0:
        return ""
    different = solutions_at(system, values)[0]
    if different is None:
        return " infinitely many solutions are all excluded"
    if not different:
        return " there is none"
    return (
        f" the equations have {different} different solution{'s' * (different > 1)}, all excluded"
    )


def points(window: Window) -> Iterator[Point]:
    """Some points of a window."""
    for shares in SHARES:
        x, y = (
            low + (high - low) * from_fraction(s)
            for (low, high), s in zip(window, shares, strict=True)
        )  # fmt: skip
        yield x, y


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
