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

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby, pairwise
from math import cos, pi
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ptmcad.algebra.polynomials import UnivariatePolynomial
from ptmcad.algebra.real_roots import refine
from ptmcad.answer.regionmap import RegionMap, Stack
from ptmcad.exact.boundaries.polyline import critical_shares
from ptmcad.exact.cad.projection import FibredCurve, by_component, curves_of, lines_of
from ptmcad.show.render.polylines import simplified_line
from ptmcad.show.render.view import CellShape, Floats, Interval, View, WallShape, remembered
from ptmcad.text.flint_numbers import from_fraction, to_fraction

if TYPE_CHECKING:  # a map of the exact engine has no cover
    from ptmcad.show.render.coveroutline import CoverOutline

TOLERANCE = 1.5e-4
DEPTH = 7
_BITS, _COARSE_BITS = 17, 14
_LIMIT = Fraction(1, 2**48)
"""A stack's ends are seen as limits from this fraction of its width: a square root's error is 2^-24
of its size.
"""


@dataclass(frozen=True, slots=True)
class _StackOutline:
    """The part of a stack in the view, in the view's coordinates.

    Attributes
    ----------
    number : the stack's number in the map.
    along : shape (n,), increasing: positions on the base axis.
    heights : shape (walls + 2, n): the window's lower edge, the walls, the window's upper edge;
        clipped to [-1, 2].
    """

    number: int
    along: Floats
    heights: Floats


@dataclass(frozen=True, slots=True)
class Outline:
    """All that a picture of a view needs.

    Attributes
    ----------
    swapped : whether the stacks stand over the vertical axis.
    lines : (position on the base axis, number of the stack at its left, number of its component)
        for vertical lines.
    """

    result: RegionMap
    view: View
    swapped: bool
    stacks: tuple[_StackOutline, ...]
    lines: tuple[tuple[float, int, int], ...]

    def in_view(self, view: View) -> Outline:
        """The same map in another view."""
        return outline(self.result, view)

    def points(self, along: Floats, heights: Floats) -> Floats:
        """Positions as an array of shape (n, 2) in the order of the picture's axes."""
        pair = (heights, along) if self.swapped else (along, heights)
        return np.stack(pair, axis=-1)

    def line(self, stack: _StackOutline, row: int, tolerance: float) -> Floats:
        """One of the stack's lines, an edge or a wall, the same for all that it bounds."""
        points = self.points(stack.along, stack.heights[row])
        return simplified_line(points, tolerance) if tolerance else points

    def polygons(self, region: int, tolerance: float = 0.0) -> Iterator[Floats]:
        """Closed polygons, shape (k, 2), that bound a region's part of the view: the parts over each
        stack, neighbouring cells joined; all with the same orientation.

        Parameters
        ----------
        tolerance : of the view's side; outlines may depart by as much, to have fewer corners, and
            still meet where they are the same wall. None is left out, even one that shrinks to a
            line or a point.
        """
        for stack in self.stacks:
            levels = range(len(stack.heights) - 1)
            own = [self.region(stack.number, k) == region for k in levels]
            for inside, run in groupby(levels, own.__getitem__):
                if inside:
                    first, *rest = run
                    bottom = self.line(stack, first, tolerance)
                    top = self.line(stack, first + len(rest) + 1, tolerance)
                    yield np.concatenate([bottom, top[::-1]])

    def cells(self, tolerance: float = 0.0) -> Iterator[CellShape]:
        """Every cell of the view with its outline, stack after stack from below."""
        for stack in self.stacks:
            for level, number in enumerate(self.result.stacks[stack.number].cells):
                bottom, top = (self.line(stack, row, tolerance) for row in (level, level + 1))
                yield number, [np.concatenate([bottom, top[::-1]])]

    def edges(self) -> Iterator[Floats]:
        """None: an exact map leaves nothing open between its cells."""
        return iter(())

    def walls(self, tolerance: float = 0.0) -> Iterator[WallShape]:
        """Every wall."""
        for stack in self.stacks:
            for level, wall in enumerate(self.result.stacks[stack.number].walls):
                separates = self.region(stack.number, level) != self.region(stack.number, level + 1)
                yield wall.component, separates, self.line(stack, level + 1, tolerance)
        by_number = {stack.number: stack for stack in self.stacks}
        for position, left, component in self.lines:
            if left in by_number and left + 1 in by_number:
                yield from self._line(position, component, by_number[left], by_number[left + 1])

    def _line(
        self, position: float, component: int, left: _StackOutline, right: _StackOutline
    ) -> Iterator[WallShape]:
        before, after = left.heights[:, -1], right.heights[:, 0]
        for low, high in pairwise(np.unique(np.concatenate([before, after]))):
            middle = (low + high) / 2
            regions = [
                self.region(s.number, min(max(int(np.searchsorted(h, middle)) - 1, 0), len(h) - 2))
                for s, h in ((left, before), (right, after))
            ]
            yield (
                component,
                regions[0] != regions[1],
                self.points(np.full(2, position), np.array([low, high])),
            )

    def region(self, stack: int, level: int) -> int:
        """The region of a stack's cell."""
        return self.result.cells[self.result.stacks[stack].cells[level]].region

    def raster(self, columns: int, rows: int) -> NDArray[np.int64]:
        """The region at the centre of every pixel, shape (rows, columns), from the bottom; -1 where
        there is none.
        """
        across, up = (rows, columns) if self.swapped else (columns, rows)
        image = np.full((up, across), -1, dtype=np.int64)
        centres = (np.arange(across) + 0.5) / across
        heights = (np.arange(up) + 0.5) / up
        for stack in self.stacks:
            inside = np.flatnonzero((stack.along[0] < centres) & (centres < stack.along[-1]))
            if not len(inside):
                continue
            edges = np.array(
                [np.interp(centres[inside], stack.along, row) for row in stack.heights]
            )
            regions = np.array([self.region(stack.number, k) for k in range(len(edges) - 1)])
            for k, column in enumerate(inside):
                level = np.searchsorted(edges[:, k], heights) - 1
                valid = (level >= 0) & (level < len(regions))
                image[valid, column] = regions[level[valid]]
        return image.T if self.swapped else image


Shapes: TypeAlias = "Outline | CoverOutline"
"""The shapes of a map in a view."""


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
            traced = _traced(result, view, curves, stack, ends, tolerance)
            stacks.append(_StackOutline(number, *traced))
    lines, across = [], lines_of(result.components, base)
    for k, root in enumerate(roots):
        component = _vertical_component(result, k, across)
        at = ((root[0] + root[1]) / 2 - low) / (high - low)
        if component is not None and 0 <= at <= 1:
            lines.append((float(at), k, component))
    return Outline(result, view, base == 1, tuple(stacks), tuple(lines))


def _ends(result: RegionMap, stack: Stack, critical: tuple[Interval, ...]) -> Interval:
    """Rational ends of a stack, just inside of it where an end is irrational."""
    axis = result.slice.axes[result.base]
    low = axis.low if stack.left is None else critical[stack.left][1]
    high = axis.high if stack.right is None else critical[stack.right][0]
    return low, high


def _vertical_component(
    result: RegionMap, critical: int, across: Mapping[int, UnivariatePolynomial]
) -> int | None:
    """The component that is a line over this critical abscissa, if one of those across the base is."""
    value = list(result.critical_values[critical].polynomial)
    for n, line in across.items():
        own = [int(c) for c in line.coeffs()]
        if value in (own, [-c for c in own]):
            return n
    return None


def _traced(
    result: RegionMap, view: View, curves: dict[int, FibredCurve], stack: Stack, ends: Interval, tolerance: float
) -> tuple[Floats, Floats]:  # fmt: skip
    """Positions and heights of a stack's walls from end to end, or to the view's edge."""
    axis = result.slice.axes[1 - result.base]
    fibre = (from_fraction(axis.low), from_fraction(axis.high))
    base, shown = view.along(result.base), view.along(1 - result.base)
    bits = _BITS if tolerance <= TOLERANCE else _COARSE_BITS
    width = from_fraction((shown[1] - shown[0]) / 2**bits)
    components = {wall.component for wall in stack.walls}

    def position(at: Fraction) -> float:
        return float((at - base[0]) / (base[1] - base[0]))

    def height(at: Fraction) -> float:
        scaled = (at - shown[0]) / (shown[1] - shown[0])
        return float(min(max(scaled, Fraction(-1)), Fraction(2)))

    def column(at: Fraction, drawn_at: Fraction | None = None) -> tuple[float, ...]:
        """Position on the base axis, then the heights of the lower edge, the walls and the upper
        edge.
        """
        u = from_fraction(at)
        roots = {n: curves[n].roots_over(u, fibre) for n in components}
        walls = (refine(roots[w.component][w.root], width).middle for w in stack.walls)
        heights = (height(to_fraction(middle)) for middle in walls)
        return (position(at if drawn_at is None else drawn_at), edges[0], *heights, edges[1])

    edges = height(axis.low), height(axis.high)
    low, high = max(ends[0], base[0]), min(ends[1], base[1])
    inner = (high - low) * _LIMIT
    columns = {0.0: column(low + inner, low), 1.0: column(high - inner, high)}
    wide = position(high) - position(low) > 0.01
    steps = (0.0, 0.25, 0.5, 0.75, 1.0) if wide else (0.0, 0.5, 1.0)
    for s in steps[1:-1] if stack.walls else ():
        columns[s] = column(_between(low, high, s))
    pending = list(pairwise(steps)) if stack.walls else []
    for _ in range(DEPTH):
        following = []
        for s, t in pending:
            middle = (s + t) / 2
            columns[middle] = column(_between(low, high, middle))
            if _deviation(columns[s], columns[middle], columns[t]) > tolerance:
                following += [(s, middle), (middle, t)]
        pending = following
    ordered = np.array([columns[s] for s in sorted(columns)])
    return ordered[:, 0], np.maximum.accumulate(ordered[:, 1:].T, axis=0)


def _between(low: Fraction, high: Fraction, s: float) -> Fraction:
    """An abscissa with few digits near low + (high - low) (1 - cos(pi s))/2, dense near both ends."""
    share = Fraction((1 - cos(pi * s)) / 2)
    near = (high - low) * min(share, 1 - share)
    step = Fraction(2) ** (near.numerator.bit_length() - near.denominator.bit_length() - 5)
    return round((low + (high - low) * share) / step) * step


def _deviation(
    first: tuple[float, ...], middle: tuple[float, ...], last: tuple[float, ...]
) -> float:
    """The largest distance of a wall's middle point from its chord."""
    a, b, c = np.array(first), np.array(middle), np.array(last)
    across, up = c[0] - a[0], c[1:] - a[1:]
    length = np.hypot(across, up)
    cross = np.abs(across * (b[1:] - a[1:]) - up * (b[0] - a[0]))
    return float(np.max(np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)))
