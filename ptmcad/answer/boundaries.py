"""Boundaries of regions as polylines and labels on a grid of pixels: a map as numbers for other
programs.

Guarantee: a polyline says how far from it the curve may be; labels are those of the pixels'
centres, exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.regionmap import Kind

if TYPE_CHECKING:
    from typing import Any

    import numpy as np
    from numpy.typing import NDArray

NONE = -1
"""The label where there is none: on a curve, or where a certified map is undetermined."""


@dataclass(frozen=True, slots=True, eq=False)
class Boundary:
    """A piece of the boundary between regions, or of another curve of the variety.

    Attributes
    ----------
    points : shape (n, 2), in the axes' order and units. In a certified map they go around a cell
        and end where they began.
    left, right : numbers of the regions at the left and right hand as one follows the points, the
        horizontal axis being the first; None where it is undetermined, or outside of the window.
    component : number of the variety's component on which it lies; None in a certified map.
    kind : of that component.
    distance : the curve is no further than that from the polyline, measured along the axis that is
        not the map's base; on a line across the base along the base. Rounding of the points to
        floats comes on top.
    """

    points: NDArray[np.float64]
    left: int | None
    right: int | None
    component: int | None = None
    kind: Kind | None = None
    distance: float = 0.0

    @property
    def separates(self) -> bool:
        """Whether there are different regions on its two sides."""
        return self.left != self.right

    def __repr__(self) -> str:
        return f"<Boundary of regions {self.left} and {self.right}, {len(self.points)} points>"


def extent_of(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Left, right, bottom and top of pixels with these centres."""
    (a, b), (c, d) = (
        (float(v[0] - half), float(v[-1] + half))
        for v in (x, y)
        for half in ((v[-1] - v[0]) / (2 * (len(v) - 1)) if len(v) > 1 else 0.5,)
    )
    return a, b, c, d


@with_methods
@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """What a map says at the centres of pixels that fill the window; `NONE` where it says nothing.

    Attributes
    ----------
    x, y : shapes (columns,) and (rows,): the centres' coordinates, rounded to floats.
    names : of the two axes.
    cell, region : shape (rows, columns), from the bottom: numbers of the cell and region at each
        centre.
    stable, total : the same for the numbers of solutions.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    names: tuple[str, str]
    cell: NDArray[np.int64]
    region: NDArray[np.int64]
    stable: NDArray[np.int64]
    total: NDArray[np.int64]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """The window as left, right, bottom, top: what `imshow` calls so, together with
        ``origin="lower"``.
        """
        return extent_of(self.x, self.y)

    def arrays(self) -> dict[str, Any]:
        """All arrays by name, as `numpy.savez` takes them."""
        return {
            name: getattr(self, name) for name in ("x", "y", "cell", "region", "stable", "total")
        }

    def __repr__(self) -> str:
        rows, columns = self.region.shape
        return f"<Grid of {columns} x {rows} pixels over {self.names[0]}, {self.names[1]}>"
