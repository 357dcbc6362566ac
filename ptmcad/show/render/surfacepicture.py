"""A boundary surface in a picture in three dimensions: shaded sheets, and curves of members on
them.

Guarantee: each triangle is one of the surface's mesh or a part of it, each curve a member's own.

Not guaranteed: what hides what, where sheets or curves are nearer to one another than the pieces
are long: these are painted one after the other, from the back.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ptmcad.answer.boundarysurface import BoundarySurface
from ptmcad.answer.counts import key_text
from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import Region
from ptmcad.question.counts import Count, Shades
from ptmcad.show.render.colours import INK, THIN, Fill, Paint
from ptmcad.show.render.legend import Entry
from ptmcad.show.render.view import Floats

Pair = tuple[tuple[int, ...], tuple[int, ...]]
"""The counts on both sides of a sheet."""

BOX = (1.0, 1.0, 1.05)
"""Sides of the box as it is seen."""
MAX_PIECES = 20_000
"""Of a vector picture, SVG or PDF, some megabytes: of more pieces it has an image, in the
resolution of a PNG.
"""
_LIGHT = np.array([-0.35, -0.55, 0.76])
"""Where light comes from, in the box's own coordinates."""
_DARKEST, _FLATTEST = 0.66, 0.25
"""Of a colour's lightness, where a sheet is seen against the light; and of the shading's range,
what is never used.
"""
_LIFT = 0.018
"""Of the box: how far towards the eye curves are moved, so that the sheets on which they lie do not
hide them.
"""
MAX_SIDE = 0.03
"""Of the box: sides of triangles as they are painted."""
_OTHER = 0.15
"""Of a sheet's colour, what comes from the smaller count's."""
_LIGHTEST, _DEEPER = 0.75, 0.9
"""The lightness of sheets' colours, and what is left at most of a mixed colour's: so that shades
are seen on sheets, and they are distinct from the regions that they enclose."""
_SEAM = 0.3
"""Points by which triangles overlap, so that no gap is seen between them."""


def box_of(axes: Any) -> tuple[Floats, Floats]:
    """The box's corner, and a unit of its coordinates, from 0 to `BOX`, in data's units."""
    limits = np.array([axes.get_xlim3d(), axes.get_ylim3d(), axes.get_zlim3d()], dtype=float)
    return limits[:, 0], (limits[:, 1] - limits[:, 0]) / BOX


def towards_eye(axes: Any) -> Floats:
    """Unit vector towards the eye, in parallel projection, in the box's coordinates."""
    elevation, azimuth = np.deg2rad([axes.elev, axes.azim])
    flat = np.cos(elevation)
    return np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])


def sheet_colours(family: FamilyMap, surface: BoundarySurface, paint: Paint) -> dict[Pair, str]:
    """For each pair of counts that a sheet parts a colour: mostly that of the larger count, with
    some of the other.
    """
    from matplotlib.colors import to_hex, to_rgb

    count = family.members[0].slice.count
    some = family.members[0].regions[0]
    found = {}
    for pair in sorted({sheet.counts for sheet in surface.sheets}):
        # a count that none of the family's own members has is coloured as in any map
        regions = [_with_count(some, count, key) for key in pair]
        low, high = (np.array(to_rgb(paint.fill(region).face)) for region in regions)
        mixed = (1 - _OTHER) * high + _OTHER * low
        red, green, blue = (mixed * min(_DEEPER, _LIGHTEST / float(mixed.mean()))).tolist()
        found[pair] = to_hex((red, green, blue))
    return found


def _with_count(region: Region, count: Count, key: tuple[int, ...]) -> Region:
    """A region with another count."""
    if count.kind.shades is Shades.INDEX:
        return replace(region, index=key)
    (number,) = key
    if count.kind.predicate is not None:
        return replace(region, further={count.value: number})
    return replace(region, **{count.value: number})  # type: ignore[arg-type]  # the fields have the counts' names


def sheet_entries(
    surface: BoundarySurface, colours: Mapping[Pair, str], legend: Sequence[Entry]
) -> list[Entry]:
    """The legend: which counts the sheets part, and how the surface was made.

    Parameters
    ----------
    legend : the entries above: what is counted, and the fills of a map on the floor.
    """
    found = list(legend)
    found += [
        Entry((f"between {' and '.join(map(key_text, pair))}",), Fill(face))
        for pair, face in colours.items()
    ]
    found.append(Entry(("boundary of a member",), THIN))
    found.append(
        Entry((f"sheets: linear between {len(surface.members)} exact boundaries",), heads=0)
    )
    if not surface.complete:
        found.append(Entry(("(not proved that nothing changes between them)",), heads=0))
    return found


def add_sheets(
    axes: Any,
    surface: BoundarySurface,
    colours: Mapping[Pair, str],
    curves: Sequence[Floats],
    width: float,
) -> None:
    """Paint the sheets and curves of members.

    Parameters
    ----------
    colours : of the sheets, by the counts that they part.
    curves : polylines, each of shape (n, 3).
    width : of the curves, as a share of the box.
    """
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    (low, size), towards = box_of(axes), towards_eye(axes)
    corners = ((surface.vertices - low) / size)[surface.faces]
    plain = np.array([to_rgb(colours[sheet.counts]) for sheet in surface.sheets]).reshape(-1, 3)
    faces = plain[surface.sheet] * _brightness(corners)[:, None]
    corners, faces = halved(corners, faces)
    ribbons = [_ribbons((line - low) / size + _LIFT * towards, towards, width) for line in curves]
    lines = np.concatenate([np.zeros((0, 3, 3)), *ribbons])
    lines, inks = halved(lines, np.tile(to_rgb(INK), (len(lines), 1)))
    pieces = np.concatenate([corners, lines]) * size + low
    shades = np.concatenate([faces, inks])
    if len(pieces):
        axes.add_collection3d(
            Poly3DCollection(
                pieces, facecolors=shades, edgecolors=shades, linewidths=_SEAM, zsort="average", gid="sheets",
                rasterized=len(pieces) > MAX_PIECES,
            )
        )  # fmt: skip


def halved(corners: Floats, colours: Floats) -> tuple[Floats, Floats]:
    """Triangles cut in two along their longest sides until none is longer than `MAX_SIDE`, with
    their colours.

    Pieces are sorted by their middles' distance from the eye, which says little of long ones.
    """
    while True:
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        long = sides.max(axis=1, initial=0.0) > MAX_SIDE
        if not long.any():
            return corners, colours
        first = sides[long].argmax(axis=1)
        turned = np.take_along_axis(
            corners[long], (first[:, None] + np.arange(3))[:, :, None] % 3, axis=1
        )
        a, b, c = turned[:, 0], turned[:, 1], turned[:, 2]
        middle = (a + b) / 2
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        corners = np.concatenate([corners[~long], *halves])
        colours = np.concatenate([colours[~long], colours[long], colours[long]])


def _brightness(corners: Floats) -> Floats:
    """Of triangles, shape (m, 3, 3), by how they face the light; both sides alike."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    facing = np.abs(normals @ (_LIGHT / np.linalg.norm(_LIGHT)))
    share = np.divide(facing, length, out=np.ones_like(facing), where=length > 0)
    bright: Floats = _DARKEST + (1 - _DARKEST) * np.minimum(1.0, _FLATTEST + share)
    return bright


def _ribbons(line: Floats, towards: Floats, width: float) -> Floats:
    """Two triangles for each piece of a polyline, so wide as seen by the eye; shape (2 n - 2, 3,
    3).
    """
    along = np.diff(line, axis=0)
    across = np.cross(along, towards)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    half = width / 2 * np.divide(across, length, out=np.zeros_like(across), where=length > 0)
    a, b, c, d = line[:-1] - half, line[1:] - half, line[1:] + half, line[:-1] + half
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
