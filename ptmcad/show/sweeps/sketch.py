"""A map as a small drawing: the regions as paths of few characters, for a sheet of many maps.

Guarantee: the same map gives the same text. A point of an outline is within `TOLERANCE` of the
window's side, and the rounding to the drawing's grid, of the outline that the other pictures have.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.colours import UNDETERMINED, Fill, fill_of
from ptmcad.show.render.shapes import shapes
from ptmcad.show.render.simplification import distinct, simplified_line
from ptmcad.show.render.view import Floats, from_above
from ptmcad.show.table import count_text

SIDE = 800
"""Steps of the drawing's grid along a side of the window."""
TOLERANCE = 1 / 1600
MAX_CHARACTERS = 6000
"""Of one drawing; coarser outlines are taken for a map that needs more."""


@dataclass(frozen=True, slots=True)
class Thumbnail:
    """What is painted: the plate's fill, and over it fills with the data of their SVG paths.

    Attributes
    ----------
    legend : the counts that occur, as text, with their fills.
    fixed : what is fixed in the map's slice, in words.
    """

    plate: Fill
    paths: tuple[tuple[Fill, str], ...]
    legend: tuple[tuple[str, Fill], ...]
    fixed: tuple[str, ...] = ()


def sketch(result: RegionMap) -> Thumbnail:
    """The drawing of a map.

    Raises
    ------
    ValueError, IndexError, ArithmeticError
        When the map contradicts itself.
    """
    seen = shapes(result)
    largest = max(range(len(result.regions)), key=lambda k: result.regions[k].area, default=None)
    plate = UNDETERMINED
    if result.cover is None and largest is not None:
        plate = fill_of(result.regions[largest], result.slice.count)
    count = result.slice.count
    legend = {count_text(region, count): fill_of(region, count) for region in result.regions}
    pieces: dict[Fill, list[Floats]] = {}
    for number, region in enumerate(result.regions):
        fill = fill_of(region, result.slice.count)
        if fill != plate:
            pieces.setdefault(fill, []).extend(seen.polygons(number))
    for factor in (1, 3, 9):
        drawn = Thumbnail(plate, tuple((fill, _data(found, factor * TOLERANCE)) for fill, found in pieces.items()),
                       tuple(legend.items()), result.slice.fixed)  # fmt: skip
        if sum(len(data) for _, data in drawn.paths) <= MAX_CHARACTERS:
            break
    return drawn


def _data(polygons: list[Floats], tolerance: float) -> str:
    """Polygons as the data of one path, without those that have no area on the grid."""
    parts = []
    for polygon in polygons:
        half = len(polygon) // 2
        kept = np.concatenate(
            [simplified_line(part, tolerance) for part in (polygon[:half], polygon[half:])]
        )
        placed = distinct(np.rint(from_above(kept, SIDE)).astype(np.int64))
        if len(placed) > 2:
            corners = " ".join(f"{x} {y}" for x, y in placed.tolist())
            parts.append(f"M{corners}z")
    return "".join(parts)
