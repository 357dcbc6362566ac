"""A family in three dimensions: its members' maps one above the other, or the surface between
different counts.

Guarantee: every curve that is drawn is one of a member's map. Between members nothing is drawn but
the sheets of a boundary surface, where one is given; the picture says that they are interpolated.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ptmcad.answer.boundarysurface import BoundarySurface
from ptmcad.answer.counts import counted_by
from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.axes import axis_name, symbol
from ptmcad.show.render.chartgrid import (
    head_and_foot,
    in_words,
    map_entries,
    title_of,
    value_text,
)
from ptmcad.show.render.colours import INK, STRONG, THIN, Paint, paint_of
from ptmcad.show.render.inches import Box, text_width
from ptmcad.show.render.legend import Entry
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.printing import settings
from ptmcad.show.render.surfacepicture import BOX, add_sheets, sheet_colours, sheet_entries
from ptmcad.show.style import MIN_FONT, LegendPlace, PictureStyle
from ptmcad.show.units import unit_of_free, with_unit

SIZE = (5.8, 5.5)
_BOX_DIAGONAL = 1.7
"""Of the box's side: how much the picture's width or height shows, about; widths of lines on a
surface rest on it.
"""
MAX_FLOORS = 7
"""Of filled maps: more would hide each other."""


def solid_figure(
    family: FamilyMap, dpi: int, style: PictureStyle, surface: BoundarySurface | None = None
) -> Figure:
    """The picture: at most `MAX_FLOORS` maps are filled, of the other members there are the curves.

    Parameters
    ----------
    surface : drawn instead of the maps, with the members' curves on it.
    """
    with settings(style):
        figure = _figure(family, dpi, style, surface)
    words = "" if surface is None else f". Surface: {surface.words()}"
    figure.set_label(f"{title_of(family)}, in three dimensions\n{in_words(family)}{words}")
    return figure


def _figure(
    family: FamilyMap, dpi: int, style: PictureStyle, surface: BoundarySurface | None
) -> Figure:
    font = style.base_font
    em, small = font / 72, max(MIN_FONT, 0.85 * font)
    wide, tall = style.size or SIZE
    figure = Figure(figsize=(wide, tall), dpi=dpi, facecolor="white")
    paint = paint_of(style, *family.members)
    colours = {} if surface is None else sheet_colours(family, surface, paint)
    legend = map_entries(paint, *family.members)
    if surface is None:
        legend += _of_floors(family)
    else:
        fills = [entry for entry in legend if entry.mark != STRONG]
        legend = sheet_entries(surface, colours, fills if _lowest(family) else fills[:1])
    head, foot, draw = head_and_foot(
        title_of(family), legend, wide, style._replace(thin_lines="solid")
    )
    if style.legend is LegendPlace.NONE:
        foot = 0.0
    # names of axes are so many letters below the box, whose lowest corner is a tenth above the
    # axes' end
    foot += max(0.0, 4.8 * em - 0.1 * (tall - head - foot))
    # members' values stand at the left of the box, which is not as wide as its axes
    before = (
        0.0
        if surface is not None
        else 0.5 * max(text_width(value_text(family, v), small) for v in family.values)
    )
    left = max(0.02, before / wide)
    box = (left, foot / tall, 0.94 - left, (tall - head - foot) / tall)
    axes = _axes(figure, box, family, font)
    # what is added is taken for further data, beside limits that matplotlib leaves at infinity
    with np.errstate(over="ignore", invalid="ignore"):
        if surface is None:
            _add_floors(axes, family, paint, small)
        else:
            for value, result in _lowest(family):
                _floor(axes, result, float(value), paint, _least(result))
            inches = min(box[2] * wide, box[3] * tall) / _BOX_DIAGONAL
            add_sheets(axes, surface, colours, _curves(family), 0.6 * paint.strong / 72 / inches)
    _limit(axes, family)
    draw(figure)
    return figure


def _axes(figure: Figure, box: Box, family: FamilyMap, font: float) -> Any:
    """Empty axes in three dimensions, in parallel projection."""
    from matplotlib.ticker import MaxNLocator
    from mpl_toolkits.mplot3d import Axes3D

    slice = family.members[0].slice
    axes: Any = Axes3D(figure, rect=box, auto_add_to_figure=False)
    figure.add_axes(axes)
    axes.set_proj_type("ortho")
    axes.view_init(elev=22, azim=-62)
    axes.computed_zorder = False
    _limit(axes, family)
    how = {"fontsize": 0.95 * font, "labelpad": 0.3 * font}
    axes.set_xlabel(axis_name(slice, 0), **how)
    axes.set_ylabel(axis_name(slice, 1), **how)
    axes.set_zlabel(
        with_unit(symbol(family.free.name), unit_of_free(slice, family.free.name, family.text)),
        **how,
    )
    axes.tick_params(labelsize=max(MIN_FONT, 0.85 * font), pad=0)
    for each, end in ((axes.xaxis, "upper"), (axes.yaxis, "lower"), (axes.zaxis, None)):
        # at the corner that two axes share, one number would lie on the other
        each.set_major_locator(MaxNLocator(nbins=4, steps=[1, 2, 2.5, 5, 10], prune=end))
    axes.set_box_aspect(BOX, zoom=0.95)
    return axes


def _of_floors(family: FamilyMap) -> list[Entry]:
    """What the legend says of maps one above the other."""
    legend = []
    if len(family.values) > MAX_FLOORS:
        legend.append(Entry(("curves of the other members",), THIN))
    if len(family.values) > 1:
        legend.append(Entry(("paler: seen through a map above it",), heads=0))
    if any(
        not separates for result in family.members for _, separates, _ in shapes(result).walls()
    ):
        legend.append(Entry(("other curves left out",), heads=0))
    return legend


def _add_floors(axes: Any, family: FamilyMap, paint: Paint, small: float) -> None:
    least = _least(*family.members)
    number = len(family.values)
    floors = set(np.linspace(0, number - 1, min(MAX_FLOORS, number)).round().astype(int))
    for k, (value, result) in enumerate(family):
        _floor(axes, result, float(value), paint, least if k in floors else None)
        if k in floors:
            axes.text(
                *(_ends(axis)[0] for axis in family.axes), float(value), f"{value_text(family, value)} ",
                fontsize=small, color=INK, ha="right", va="center", zorder=1e9, gid=f"member-{k}",
            )  # fmt: skip


def _least(*members: RegionMap) -> tuple[int, ...]:
    """The least count that a region has."""
    return min(counted_by(r, result.slice.count) for result in members for r in result.regions)


def _lowest(family: FamilyMap) -> list[tuple[Fraction, RegionMap]]:
    """The member at the lower end of the range, if there is one: on the box's floor its map hides
    nothing.
    """
    return [member for member in family if member[0] == family.free.low]


def _curves(family: FamilyMap) -> list[Any]:
    """The members' curves at which counts change, at their heights."""
    return [line for value, result in family for line in _lifted(result, float(value))]


def _limit(axes: Any, family: FamilyMap) -> None:
    axes.set(xlim=_ends(family.axes[0]), ylim=_ends(family.axes[1]), zlim=_ends(family.free))


def _ends(axis: Any) -> tuple[float, float]:
    return float(axis.low), float(axis.high)


def _floor(
    axes: Any, result: RegionMap, height: float, paint: Paint, least: tuple[int, ...] | None
) -> None:
    """A member's map at its height, filled so that one sees through where the count is least, or
    its curves alone.
    """
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Curve
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, pathpatch_2d_to_3d

    seen = shapes(result)
    scale, origin = _frame(result)
    if least is not None:
        for number, (region, outlines) in enumerate(
            zip(result.regions, seen.polygons(), strict=True)
        ):
            if outlines:
                polygons = [Curve(outline * scale + origin) for outline in outlines]
                # one path for all parts, as on the page: where two of them share an edge no seam is
                # left
                patch = PathPatch(
                    Curve.make_compound_path(*polygons), facecolor=paint.fill(region).face, linewidth=0, zorder=height,
                    alpha=0.3 if counted_by(region, result.slice.count) == least else 0.85, gid=f"{height}-{number}",
                )  # fmt: skip
                axes.add_patch(patch)
                pathpatch_2d_to_3d(patch, z=height)
    strong = _lifted(result, height)
    if strong:
        axes.add_collection3d(
            Line3DCollection(
                strong, colors=INK, linewidths=paint.strong if least is not None else 0.4 * paint.strong,
                alpha=1.0 if least is not None else 0.55, zorder=height + 1e-9 * (1 + abs(height)),
            )
        )  # fmt: skip


def _frame(result: RegionMap) -> tuple[Any, Any]:
    """The window's sides and its lower left corner."""
    (left, right), (low, high) = (_ends(axis) for axis in result.slice.axes)
    return np.array([right - left, high - low]), np.array([left, low])


def _lifted(result: RegionMap, height: float) -> list[Any]:
    """The curves of a map at which counts change, and the rims of what is undetermined, at a
    height.
    """
    scale, origin = _frame(result)
    return [
        np.column_stack([line * scale + origin, np.full(len(line), height)])
        for line in shapes(result).borders()
    ]
