"""The discriminant variety over all designs, as the covers need it, and the longest interval with the
wanted count on the line of one design.

Guarantee: that of `surfaces` and `variety`: off the polynomials' zeros all counts are constant, but
for sets that do not cut the space. An interval is exact, for designs off a set without interior:
the ends are roots of the polynomials at the design, and the count is that of samples between all of
them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import gcd
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.bernstein import Table, on_lines, table_of
from ptmcad.algebra.polynomials import Coefficient, from_plane
from ptmcad.algebra.real_roots import Interval, disjoint, inside, isolate, refine, squarefree_part
from ptmcad.errors import DegenerateSliceError
from ptmcad.exact.familyprojection import surfaces_of
from ptmcad.exact.familyvariety import family_variety
from ptmcad.exact.models.system import SystemOnAxes
from ptmcad.exact.ranges.line import runs
from ptmcad.exact.stages import SliceProblem, count_at
from ptmcad.exact.variety import discriminant_variety
from ptmcad.text.flint_numbers import simplest_between
from ptmcad.text.numerals import equalities
from ptmcad.workbench.designs.designlines import Space


class Axes(NamedTuple):
    """Names and ranges of two or three coordinates, and which of them varies along lines."""

    names: tuple[str, ...]
    ranges: tuple[Interval, ...]
    along: int = 0

    @property
    def order(self) -> tuple[int, ...]:
        """The numbers of the coordinates, that along lines first."""
        return (self.along, *(k for k in range(len(self.names)) if k != self.along))


def space_of_family(on: SystemOnAxes, axes: Axes, working: int) -> Space | None:
    """The space of three coordinates; None where there is no variety that holds for all designs.

    Parameters
    ----------
    on : the system on the axes x, y and z.

    Raises
    ------
    InfiniteSolutionsError, DegenerateSliceError, NothingToCountError
        When every point is exceptional.
    """
    known = family_variety(on)
    if known is None:
        return None
    return _space(on, surfaces_of(on, known, axes.ranges), axes, working)


def space_of_slice(problem: SliceProblem, along: int, working: int) -> Space:
    """The space of a slice's two axes.

    Raises
    ------
    InfiniteSolutionsError, DegenerateSliceError, NothingToCountError
        When every point is exceptional.
    """
    variety = discriminant_variety(problem.on, problem.window)
    found = [from_plane(c.polynomial) for c in variety.components if not c.left_out]
    return _space(problem.on, found, Axes(problem.slice.axis_names, problem.window, along), working)


def _space(on: SystemOnAxes, found: Sequence[Coefficient], axes: Axes, working: int) -> Space:
    window = axes.ranges[axes.along]
    ordered = [
        [(_padded([int(powers[k]) for k in axes.order]), int(c)) for powers, c in p.terms()]
        for p in found
    ]
    power = (
        max(1, gcd(*(powers[0] for terms in ordered for powers, _ in terms)))
        if window[0] >= 0
        else 1
    )

    def count(value: fmpq, design: tuple[fmpq, fmpq]) -> int | None:
        point = [fmpq(0)] * len(axes.names)
        for number, coordinate in zip(axes.order, (value, *design), strict=False):
            point[number] = coordinate
        where = equalities(dict(zip(axes.names, point, strict=True)))
        try:
            return count_at(where, on, point).counts.working
        except DegenerateSliceError:
            return None

    return Space(tuple(_table(terms, power) for terms in ordered), power, window, count, working)


def _padded(powers: Sequence[int]) -> tuple[int, int, int]:
    first, second, third = (*powers, 0)[:3]
    return first, second, third


def _table(terms: Sequence[tuple[tuple[int, int, int], int]], power: int) -> Table:
    return table_of(((i // power, j, k), c) for (i, j, k), c in terms)


_WIDTH = fmpq(1, 2**80)
"""Of what isolates a root, against the window's power."""


def longest_on_line(space: Space, design: tuple[fmpq, ...]) -> tuple[Interval, Interval] | None:
    """The two ends of the longest interval, enclosed; equal ends where there is none.

    None where the design is on the variety, as far as that is seen.
    """
    at = (*design, fmpq(0))[:2]
    low, high = (end**space.power for end in space.window)
    product = on_lines(space.tables, (at[0], at[1]))
    if not product:
        return None
    found = disjoint(isolate(squarefree_part(product), low, high))
    roots = [refine(root, (high - low) * _WIDTH) for root in inside(found, (low, high))]
    ends = [(low, low), *((root.low, root.high) for root in roots), (high, high)]
    counts = []
    for (_, left), (right, _) in pairwise(ends):
        counts.append(space.count_at(simplest_between(*space.inside(left, right)), (at[0], at[1])))
    if None in counts:
        return None
    here = runs([count == space.working for count in counts])
    spans = [(space.outside(*ends[first]), space.outside(*ends[last])) for first, last in here]
    if not spans:
        return (space.window[0],) * 2, (space.window[0],) * 2
    return max(spans, key=lambda span: span[1][0] - span[0][1])
