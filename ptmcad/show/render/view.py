"""What a picture of a region map is drawn from: a view of its window, and the shapes seen in it,
whatever the engine.

Guarantee: none but that of the classes that have these methods, `ptmcad.show.render.outline` for
exact maps and `ptmcad.show.render.coveroutline` for certified ones. Positions are fractions of the
view's sides.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Generic, Protocol, TypeVar

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
WallShape = tuple[int, bool, Floats]
"""The component that a wall lies on, whether it separates two regions, and its polyline."""
T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Same(Generic[T]):
    """A key that only the very same object equals: to compare whole maps would take as long as to
    draw them.
    """

    it: T

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other.it is self.it

    def __hash__(self) -> int:
        return id(self.it)


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


def from_above(line: Floats, side: float) -> Floats:
    """Fractions of a view's sides in units of which a picture's side has so many, from its upper
    left corner.
    """
    placed: Floats = np.stack([line[:, 0], 1 - line[:, 1]], axis=1) * side
    return placed


class Shapes(Protocol):
    """The shapes of a map in a view."""

    @property
    def result(self) -> RegionMap:
        """The map."""
        ...

    @property
    def view(self) -> View:
        """The part of its window that is shown."""
        ...

    def in_view(self, view: View) -> Shapes:
        """The same map in another view."""
        ...

    def polygons(self, region: int, tolerance: float = 0.0) -> Iterator[Floats]:
        """Closed polygons, shape (k, 2), that together bound a region's part of the view.

        Parameters
        ----------
        tolerance : of the view's side; outlines may depart by as much, to have fewer corners, and
            still meet where they are the same wall. None is left out, even one that shrinks to a
            line or a point.
        """
        ...

    def cells(self, tolerance: float = 0.0) -> Iterator[CellShape]:
        """Every cell of the view and its closed polygons, with a tolerance as ``polygons`` has one."""
        ...

    def walls(self, tolerance: float = 0.0) -> Iterator[WallShape]:
        """Every wall, with such a tolerance."""
        ...

    def edges(self) -> Iterator[Floats]:
        """The rims of what is undetermined, as polylines."""
        ...

    def raster(self, columns: int, rows: int) -> NDArray[np.int64]:
        """The region at the centre of every pixel, shape (rows, columns), from the bottom; -1 where
        there is none.
        """
        ...
