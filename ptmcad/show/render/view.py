"""What a picture of a region map is drawn from, whatever the engine: a view of its window, and the
shapes that are seen in it.

`ptmcad.show.render.outline` has the shapes of exact maps, `ptmcad.show.render.coveroutline` those of
certified ones. Positions are fractions of the view's sides.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.labels import Position

Floats = NDArray[np.float64]
Interval = tuple[Fraction, Fraction]
Point = tuple[Fraction, Fraction]
"""Of a map, in the order of its axes."""
CellShape = tuple[int, list[Floats]]
"""A cell's number and its closed polygons."""
FAR = (-1.0, 2.0)
"""Positions beyond are moved there: what is out of the view has no shape."""
WallShape = tuple[int, bool, Floats]
"""The component that a wall lies on, whether it separates two regions, and its polyline."""


@dataclass(frozen=True, slots=True)
class View:
    """The rectangle that is shown: intervals of the two axes, in their order."""

    x: Interval
    y: Interval

    @classmethod
    def whole(cls, result: RegionMap) -> View:
        """The map's window."""
        first, second = result.slice.axes
        return cls((first.low, first.high), (second.low, second.high))

    def along(self, axis: int) -> Interval:
        """The interval of axis 0 or 1."""
        return self.y if axis else self.x

    def approximate_position(self, point: Point) -> Position:
        """A point in the view's own coordinates, (0, 0) to (1, 1)."""
        (left, right), (bottom, top) = self.x, self.y
        return float((point[0] - left) / (right - left)), float(
            (point[1] - bottom) / (top - bottom)
        )


@dataclass(frozen=True, slots=True)
class Shapes:
    """The shapes of a map in a view; outlines and walls may depart from their places by a tolerance,
    a share of the view's side, to have fewer corners.
    """

    result: RegionMap
    view: View

    def in_view(self, view: View) -> Self:
        """The same map in another view."""
        raise NotImplementedError

    def cells(self, tolerance: float = 0.0) -> Iterator[CellShape]:
        """Every cell of the view with its closed polygons, shape (k, 2), all with the same
        orientation but for those around holes.
        """
        raise NotImplementedError

    def walls(self, tolerance: float = 0.0) -> Iterator[WallShape]:
        """Every wall: none of a certified map, which knows no curve, only what encloses the curves."""
        return iter(())

    def raster(self, columns: int, rows: int) -> NDArray[np.int64]:
        """The region at the centre of every pixel, shape (rows, columns), from the bottom; -1 where
        there is none.
        """
        raise NotImplementedError

    def polygons(self, tolerance: float = 0.0) -> list[list[Floats]]:
        """For each region the polygons of its cells."""
        found: list[list[Floats]] = [[] for _ in self.result.regions]
        for number, polygons in self.cells(tolerance):
            found[self.result.cells[number].region] += polygons
        return found

    def rims(self, tolerance: float = 0.0) -> list[Floats]:
        """The outlines of all cells as closed lines, where something between them is undetermined."""
        shown = () if self.result.cover is None else self.cells(tolerance)
        return [np.vstack([rim, rim[:1]]) for _, polygons in shown for rim in polygons]

    def borders(self, tolerance: float = 0.0) -> list[Floats]:
        """Where counts change: walls between regions, and the rims of what is undetermined."""
        walls = [line for _, separates, line in self.walls(tolerance) if separates]
        return walls + self.rims(tolerance)


def from_above(line: Floats, side: float) -> Floats:
    """Fractions of a view's sides in units of which a picture's side has so many, from its upper
    left corner.
    """
    placed: Floats = np.stack([line[:, 0], 1 - line[:, 1]], axis=1) * side
    return placed
