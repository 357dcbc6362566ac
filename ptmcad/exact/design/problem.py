"""The discriminant variety over all designs, as the covers need it.

Guarantee: that of `familyprojection` and `discriminant_variety`: off the polynomials' zeros all counts are constant, but
for sets that do not cut the space.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import gcd
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.bernstein import Table, table_of
from ptmcad.algebra.polynomials import Coefficient, from_plane
from ptmcad.algebra.real_roots import Interval
from ptmcad.errors import DegenerateSliceError
from ptmcad.exact.design.cover import Space
from ptmcad.exact.discriminant_variety import discriminant_variety
from ptmcad.exact.family import family_variety
from ptmcad.exact.familyprojection import surfaces_of
from ptmcad.exact.models.system import SystemOnAxes
from ptmcad.exact.stages import SliceProblem, count_at
from ptmcad.text.numerals import equalities


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
