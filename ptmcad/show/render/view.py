"""What a picture of a region map is drawn from, whatever the engine: a view of its window, and the
kinds of shapes that are seen in it.

`ptmcad.show.render.outline` has the shapes of exact maps, `ptmcad.show.render.coveroutline` those of
certified ones, by methods of the same names. Positions are fractions of the view's sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, wraps
from typing import Any, TypeVar, cast

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
Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True, slots=True, eq=False)
class _Same:
    """A key that only the very same object equals."""

    it: object

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.it is self.it

    def __hash__(self) -> int:
        return id(self.it)


def remembered(most: int) -> Callable[[Function], Function]:
    """A decorator that keeps so many answers, by the identity of the first argument: to compare whole
    maps would take as long as to draw them.
    """

    def decorated(function: Function) -> Function:
        kept = lru_cache(most)(lambda of, *others: function(of.it, *others))
        found: Any = wraps(function)(lambda it, *others: kept(_Same(it), *others))
        return cast(Function, found)

    return decorated


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
