"""The outlines of a certified map's regions in a view, as polygons for drawing, and what it leaves
open between them.

Guarantee: without simplification the polygons are the components of the cover's complement exactly,
but for the rounding of positions to floats; simplification moves no point of them by more than
`TOLERANCE` of the view's size.

Not guaranteed: that two simplified outlines with less than twice the tolerance between them do not
cross. Nothing but pictures may be decided by an outline.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.remembered import remembered
from ptmcad.cover import components
from ptmcad.cover.complement import Components, outlines
from ptmcad.show.render.polylines import simplified_polygon
from ptmcad.show.render.view import FAR, CellShape, Floats, Shapes, View

TOLERANCE = 1.5e-4
"""Of the view's side; 0.05 pt where the side is 4.6 inches."""


@dataclass(frozen=True, slots=True)
class CoverOutline(Shapes):
    """The shapes of a certified map.

    Attributes
    ----------
    corners : for each cell its polygons' corners in lattice steps, with the cell at the left hand.
    region_at : region of each component of the complement, -1 for those without a cell.
    """

    complement: Components
    corners: tuple[tuple[NDArray[np.int64], ...], ...]
    region_at: NDArray[np.int64]

    def in_view(self, view: View) -> CoverOutline:
        """The same map in another view."""
        return replace(self, view=view)

    def cells(self, tolerance: float = 0.0) -> Iterator[CellShape]:
        """Every cell's outlines; with a tolerance those that collapse are among them, as a line or
        a point.
        """
        for cell, found in enumerate(_polygons(self, tolerance)):
            if found:
                yield cell, list(found)

    def raster(self, columns: int, rows: int) -> NDArray[np.int64]:
        """The region just right of and above each pixel's centre, shape (rows, columns), from the
        bottom; -1: none.
        """
        steps = self.complement.cover.steps
        x, y = (
            np.array(
                [int(start + (k + Fraction(1, 2)) * step) for k in range(n)], dtype=np.int64
            ).clip(0, steps - 1)
            for axis, (low, high), n in zip(
                self.result.slice.axes, (self.view.x, self.view.y), (columns, rows), strict=True
            )
            for start, step in [(axis.share(low) * steps, (high - low) / axis.width * steps / n)]
        )
        image: NDArray[np.int64] = self.region_at[self.complement.raster(x, y)]
        return image


@remembered(16)
def _polygons(seen: CoverOutline, tolerance: float) -> tuple[tuple[Floats, ...], ...]:
    """Each cell's outlines in the view: without a tolerance of one's own those that do not
    collapse.

    All at once, as the fill of every region and the lines along them ask for the same ones.
    """
    found: list[list[Floats]] = [[] for _ in seen.result.cells]
    cells = np.array(
        [cell for cell, polygons in enumerate(seen.corners) for _ in polygons], dtype=np.int64
    )
    corners = [polygon for polygons in seen.corners for polygon in polygons]
    if not corners:
        return tuple(map(tuple, found))
    sizes = np.array([len(polygon) for polygon in corners])
    points = np.clip(_in_view(np.concatenate(corners), seen), *FAR)
    starts = np.cumsum(sizes) - sizes
    there = _meets_view(np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts))
    points, sizes, cells = points[np.repeat(there, sizes)], sizes[there], cells[there]
    least = 1 if tolerance else 3
    # where no polygon is left there is one part without a point
    parts = np.split(points, np.cumsum(sizes)[:-1])
    for cell, part in zip(cells.tolist(), parts, strict=False):
        polygon = simplified_polygon(part, tolerance or TOLERANCE)
        if len(polygon) >= least and _meets_view(polygon.min(axis=0), polygon.max(axis=0)):
            found[cell].append(polygon)
    return tuple(map(tuple, found))


def _in_view(corners: NDArray[np.int64], seen: CoverOutline) -> Floats:
    """Lattice points in the view's coordinates."""
    columns = []
    for k, (axis, shown) in enumerate(
        zip(seen.result.slice.axes, (seen.view.x, seen.view.y), strict=True)
    ):
        width = shown[1] - shown[0]
        scale = float(axis.width / width / seen.complement.cover.steps)
        columns.append(corners[:, k] * scale + float((axis.low - shown[0]) / width))
    return np.stack(columns, axis=1)


def _meets_view(low: Floats, high: Floats) -> NDArray[np.bool_]:
    """Whether boxes, given by their lower left and upper right corners, reach into the view."""
    return np.logical_and((high > 0).all(axis=-1), (low < 1).all(axis=-1))


@remembered(8)
def cover_outline(result: RegionMap) -> CoverOutline:
    """The outlines of a certified map over its whole window; traced once for several pictures of
    it.

    Raises
    ------
    ValueError
        When the map contradicts itself: a sample is in no component of its own, or a rectangle is
        none.
    """
    assert result.cover is not None  # others have no such outline
    complement = components(result.cover)
    view = View.whole(result)
    number_of = complement.numbered((cell.sample for cell in result.cells), (view.x, view.y))
    region_at = np.full(len(complement.areas) + 1, -1, dtype=np.int64)
    for number, cell in number_of.items():
        region_at[number] = result.cells[cell].region
    traced = outlines(complement, list(number_of))
    return CoverOutline(result, view, complement, traced, region_at)
