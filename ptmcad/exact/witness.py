"""A point that shows what is wrong with a slice that is degenerate at every point.

Guarantee: exact, of that point. That nothing else degenerates there is likely, as it is the one of
some points with the most solutions, and not proved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction

from flint import fmpq

from ptmcad.algebra.polynomials import Values
from ptmcad.errors import (
    DegenerateSliceError,
    HypothesisError,
    InfiniteSolutionsError,
    NothingToCountError,
)
from ptmcad.exact.models.system import ParametricSystem, SystemOnAxes
from ptmcad.exact.point_system import solutions_at
from ptmcad.text.flint_numbers import from_fraction

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
    error: DegenerateSliceError | InfiniteSolutionsError,
    on: SystemOnAxes,
    window: Sequence[Point],
    place: Callable[[Point], str],
) -> DegenerateSliceError | InfiniteSolutionsError:
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


def points(window: Sequence[Point]) -> Iterator[Point]:
    """Some points of a window."""
    for shares in SHARES:
        x, y = (
            low + (high - low) * from_fraction(s)
            for (low, high), s in zip(window, shares, strict=True)
        )  # fmt: skip
        yield x, y
