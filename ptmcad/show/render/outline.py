"""The outline of a region map in a view: the walls of its stacks as polylines, for drawing; of a
certified map that of `ptmcad.show.render.coveroutline`.

Guarantee: each wall is the branch that the map names, from exact root isolation of the stored
polynomials at rational abscissae; every vertex is within 2^-17 of the view's size of the branch
(2^-14 in a coarser outline), and two neighbouring vertices are so near that their chord misses the
branch's middle by at most `TOLERANCE`, or what is asked for, of the view's size, up to the depth of
subdivision.

Not guaranteed: the shape between the vertices. Nothing but pictures may be decided by an outline.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import cos, pi

import numpy as np
from numpy.typing import NDArray

from ptmcad.algebra.real_roots import refine
from ptmcad.answer.regionmap import RegionMap, Stack
from ptmcad.answer.remembered import remembered
from ptmcad.exact.boundaries.polyline import critical_shares, lines_across
from ptmcad.exact.cad.projection import FibredCurve, by_component, curves_of
from ptmcad.show.render.polylines import refined, simplified_line
from ptmcad.show.render.view import FAR, CellShape, Floats, Interval, Shapes, View, WallShape
from ptmcad.text.flint_numbers import from_fraction, to_fraction

TOLERANCE = 1.5e-4
DEPTH = 7
_BITS, _COARSE_BITS = 17, 14
_LIMIT = Fraction(1, 2**48)
"""A stack's ends are seen as limits from this fraction of its width: a square root's error is 2^-24
of its size.
"""


@dataclass(frozen=True, slots=True)
class _StackOutline:
    """The part of a stack in the view.

    Attributes
    ----------
    number : the stack's number in the map.
    lines : shape (walls + 2, n, 2): the window's lower edge, the walls, the window's upper edge, at
        the same increasing positions on the base axis; in the view's coordinates and the axes' order.
    """

    number: int
    lines: Floats


@dataclass(frozen=True, slots=True)
class Outline(Shapes):
    """The shapes of an exact map.

    Attributes
    ----------
    stacks : from left to right.
    across : (position on the base axis, number of the stack at its left, number of its component)
        for lines across the base.
    """

    stacks: tuple[_StackOutline, ...]
    across: tuple[tuple[float, int, int], ...]

    def in_view(self, view: View) -> Outline:
        """The same map in another view."""
        return outline(self.result, view)

    def cells(self, tolerance: float = 0.0) -> Iterator[CellShape]:
        """Stack after stack from below; neighbours meet where they have the same wall, and none is
        left out, even one that shrinks to a line or a point.
        """
        for stack in self.stacks:
            lines = _simplified(stack, tolerance)
            for number, sides in zip(
                self.result.stacks[stack.number].cells, pairwise(lines), strict=True
            ):
                yield number, [np.concatenate([sides[0], sides[1][::-1]])]

    def walls(self, tolerance: float = 0.0) -> Iterator[WallShape]:
        """Every wall, and pieces of lines across the base."""
        for stack in self.stacks:
            walls = self.result.stacks[stack.number].walls
            sides = pairwise(self._regions(stack))
            lines = _simplified(stack, tolerance)[1:-1]
            for wall, (below, above), line in zip(walls, sides, lines, strict=True):
                yield wall.component, below != above, line
        by_number = {stack.number: stack for stack in self.stacks}
        for position, left, component in self.across:
            if left in by_number and left + 1 in by_number:
                yield from self._pieces(position, component, by_number[left], by_number[left + 1])

    def _pieces(
        self, position: float, component: int, left: _StackOutline, right: _StackOutline
    ) -> Iterator[WallShape]:
        base = self.result.base
        ends = [left.lines[:, -1, 1 - base], right.lines[:, 0, 1 - base]]
        beside = [np.array(self._regions(stack)) for stack in (left, right)]
        for low, high in pairwise(np.unique(np.concatenate(ends))):
            middle = (low + high) / 2
            regions = [
                own[np.clip(np.searchsorted(heights, middle) - 1, 0, len(own) - 1)]
                for own, heights in zip(beside, ends, strict=True)
            ]
            line = np.array([(position, low), (position, high)])
            yield component, bool(regions[0] != regions[1]), line[:, ::-1] if base else line

    def _regions(self, stack: _StackOutline) -> list[int]:
        """Those of the stack's cells."""
        cells = self.result.stacks[stack.number].cells
        return [self.result.cells[number].region for number in cells]

    def raster(self, columns: int, rows: int) -> NDArray[np.int64]:
        """The region at the centre of every pixel, shape (rows, columns), from the bottom; -1 where
        there is none.
        """
        base = self.result.base
        centres, heights = (
            (np.arange(number) + 0.5) / number
            for number in ((rows, columns) if base else (columns, rows))
        )
        image = np.full((len(heights), len(centres)), -1, dtype=np.int64)
        for stack in self.stacks:
            along, levels = stack.lines[0, :, base], stack.lines[..., 1 - base]
            inside = np.flatnonzero((along[0] < centres) & (centres < along[-1]))
            below = sum(heights[:, None] > np.interp(centres[inside], along, row) for row in levels)
            image[:, inside] = np.array([-1, *self._regions(stack), -1])[below]
        return image.T if base else image


def _simplified(stack: _StackOutline, tolerance: float) -> list[Floats]:
    """The stack's lines, each the same for all that it bounds."""
    return [simplified_line(line, tolerance) if tolerance else line for line in stack.lines]


def shapes(result: RegionMap) -> Shapes:
    """The shapes of a map over its whole window.

    Raises
    ------
    ValueError, IndexError, ArithmeticError
        When the map contradicts itself.
    """
    if result.cover is not None:
        from ptmcad.show.render.coveroutline import cover_outline

        return cover_outline(result)
    return outline(result)


# a map is drawn into several files, in several sizes and into the report
@remembered(32)
def outline(result: RegionMap, view: View | None = None, tolerance: float = TOLERANCE) -> Outline:
    """The outline of a map in a view, the whole window when None.

    Parameters
    ----------
    tolerance : how far a chord may miss its branch, as a share of the view's size; the vertices are
        on it in any case.
    """
    view, base = view or View.whole(result), result.base
    curves = by_component(curves_of(result.components, base))
    axis = result.slice.axes[base]
    roots = tuple((axis.at(low), axis.at(high)) for low, high in critical_shares(result))
    low, high = view.along(base)
    stacks = []
    for number, stack in enumerate(result.stacks):
        ends = _ends(result, stack, roots)
        if ends[0] < high and ends[1] > low:
            lines = _traced(result, view, curves, stack, ends, tolerance)
            stacks.append(_StackOutline(number, lines))
    places = ((sum(roots[k]) / 2, k, component) for component, k in lines_across(result))
    across = tuple(
        (float((at - low) / (high - low)), k, component)
        for at, k, component in places
        if low <= at <= high
    )
    return Outline(result, view, tuple(stacks), across)


def _ends(result: RegionMap, stack: Stack, critical: tuple[Interval, ...]) -> Interval:
    """Rational ends of a stack, just inside of it where an end is irrational."""
    axis = result.slice.axes[result.base]
    low = axis.low if stack.left is None else critical[stack.left][1]
    high = axis.high if stack.right is None else critical[stack.right][0]
    return low, high


def _traced(
    result: RegionMap, view: View, curves: dict[int, FibredCurve], stack: Stack, ends: Interval, tolerance: float
) -> Floats:  # fmt: skip
    """The lines of a stack from end to end, or to the view's edge."""
    base = result.base
    axis, shown = result.slice.axes[1 - base], view.along(1 - base)
    fibre = (from_fraction(axis.low), from_fraction(axis.high))
    bits = _BITS if tolerance <= TOLERANCE else _COARSE_BITS
    width = from_fraction((shown[1] - shown[0]) / 2**bits)
    components = {wall.component for wall in stack.walls}
    whole = view.along(base)
    low, high = max(ends[0], whole[0]), min(ends[1], whole[1])
    inner = (high - low) * _LIMIT

    def column(share: float) -> Floats:
        """The points of all lines at a share of the stack's width."""
        u = _between(low + inner, high - inner, share)
        roots = {n: curves[n].roots_over(from_fraction(u), fibre) for n in components}
        walls = (refine(roots[w.component][w.root], width).middle for w in stack.walls)
        heights = (axis.low, *map(to_fraction, walls), axis.high)
        points = [view.approximate_position((v, u) if base else (u, v)) for v in heights]
        return np.clip(points, *FAR)

    is_wide = high - low > (whole[1] - whole[0]) / 100
    places = np.linspace(0, 1, 2 if not stack.walls else 5 if is_wide else 3).tolist()
    lines = np.stack([*refined(column, places, tolerance, DEPTH).values()], axis=1)
    lines[..., 1 - base] = np.maximum.accumulate(lines[..., 1 - base])
    return lines


def _between(low: Fraction, high: Fraction, s: float) -> Fraction:
    """An abscissa with few digits near low + (high - low) (1 - cos(pi s))/2, dense near both ends."""
    share = Fraction((1 - cos(pi * s)) / 2)
    near = (high - low) * min(share, 1 - share)
    if not near:
        return high if share else low
    step = Fraction(2) ** (near.numerator.bit_length() - near.denominator.bit_length() - 5)
    return round((low + (high - low) * share) / step) * step
