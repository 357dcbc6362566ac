"""The intervals of constant count along a line of a slice, with exact ends.

Guarantee: exact. The window's part of the line, less the critical values, is cut into open
intervals; in each the solutions are nondegenerate, their number and indices are constant, and they
were counted at a rational sample. Ends are real algebraic numbers. Neighbours with equal counts are
joined, and the critical value between them is kept among the changes.

The line's own discriminant variety is computed, in one parameter: its components are the
irreducible factors of the norm of det H over Q(x), or of the Jacobian's determinant where there is
no potential. So nothing depends on how a basis over the plane specialises, and that the ends are
those of the map's walls is a test of both.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import groupby, pairwise
from typing import Any

from flint import fmpq

from ptmcad.algebra.real_roots import in_order, roots_in
from ptmcad.answer.counts import operation_number
from ptmcad.answer.intervals import Change, CountInterval, CountIntervals, End, lower, upper
from ptmcad.answer.regionmap import Component
from ptmcad.answer.words import noun
from ptmcad.errors import DegenerateSliceError, InfiniteSolutionsError
from ptmcad.exact.discriminant_variety import discriminant_variety
from ptmcad.exact.models import system_from
from ptmcad.exact.models.system import SystemOnAxes, on_axes
from ptmcad.exact.stages import count_at
from ptmcad.exact.witness import points, with_folds
from ptmcad.question.line import Line, line_of
from ptmcad.question.slice import Slice
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.flint_numbers import from_fraction, interval_of, simplest_fraction
from ptmcad.text.numerals import equalities, shortest_text

END_WIDTH = Fraction(1, 2**100)
"""Width of the ends' isolating intervals, against the window's."""


def intervals(
    slice: Slice, along: str, at: Mapping[str, Any], working: int | None = None
) -> CountIntervals:
    """The intervals of constant count on a line of a slice.

    Parameters
    ----------
    along : the axis that varies, over its window.
    at : the other axis with its value: text or a number, of which a float stands for its shortest
        decimal.
    working : the number of stable solutions in an operation range; by `operation_number` on this
        line when None.

    Raises
    ------
    ConfigError
        See `line_of`.
    DegenerateSliceError
        When the line lies inside the discriminant variety: every point of it has a singular
        equilibrium.
    InfiniteSolutionsError
        When every point of it has infinitely many equilibria.
    GeometryError
        When a length or a stiffness is not positive on it.
    """
    line = line_of(slice, along, at)
    found, on = critical_values(line), system_on(line)
    ends: list[End] = [line.along.low, *(number for number, _ in found), line.along.high]
    samples = [simplest_fraction(upper(low), lower(high)) for low, high in pairwise(ends)]
    counts = [count_at(line.place(x), on, (from_fraction(x), fmpq(0))).counts for x in samples]
    changes = tuple(
        Change(number, *sides, part.kind, part.continuum)
        for (number, part), sides in zip(found, pairwise(counts), strict=True)
    )
    # neighbours with equal counts are one interval
    joined = [list(group) for _, group in groupby(range(len(counts)), lambda k: counts[k])]
    return CountIntervals(
        slice.name,
        slice.model,
        line.along,
        line.at,
        line.parameters,
        tuple(
            CountInterval(ends[k[0]], ends[k[-1] + 1], counts[k[0]], samples[k[0]]) for k in joined
        ),
        changes,
        operation_number(slice.model, counts) if working is None else working,
    )


def system_on(line: Line) -> SystemOnAxes:
    """The model's system on the line, for the engine."""
    return on_axes(system_from(line.model), line.parameters)


def critical_values(line: Line) -> tuple[tuple[AlgebraicNumber, Component], ...]:
    """The line's discriminant variety in the window, in increasing order, each number with its
    component.

    The isolating intervals are disjoint.

    Raises
    ------
    DegenerateSliceError, InfiniteSolutionsError
        See `intervals`.
    """
    on = system_on(line)
    low, high = line.along.low, line.along.high
    # the second axis does not occur, so any range serves for it
    window = (interval_of(line.along), (fmpq(0), fmpq(1)))
    where = equalities(line.at, shortest_text)
    try:
        components, _, _ = discriminant_variety(on, window, frozenset({"infinity"}))
    except DegenerateSliceError as error:
        explained = with_folds(error, line.model, on, points(window))
        if explained is not error:
            raise explained from error
        raise DegenerateSliceError(
            f"the line {where} lies inside the discriminant variety: at every {line.along.name} some "
            f"{noun(line.model, 1)} has a singular {on.system.criterion.matrix}; fix another value"
        ) from error
    except InfiniteSolutionsError as error:
        raise InfiniteSolutionsError(
            f"on the line {where} the equations have infinitely many solutions at every {line.along.name} (complex "
            "ones included); fix another value"
        ) from error
    numbers, parts = [], {}
    for component in components:
        if not component.left_out:
            for number in roots_in(component.polynomial, low, high):
                numbers.append(number)
                parts[number.polynomial] = component
    ordered = in_order(numbers, low, high, (high - low) * END_WIDTH)
    return tuple((number, parts[number.polynomial]) for number in ordered)


def runs(here: Sequence[bool]) -> Iterator[tuple[int, int]]:
    """Where the longest runs of gaps in which something holds begin, and where they end."""
    for holds, group in groupby(range(len(here)), lambda k: here[k]):
        numbers = list(group)
        if holds:
            yield numbers[0], numbers[-1] + 1
