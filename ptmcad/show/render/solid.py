"""A family in three dimensions: its members' maps one above the other, with the curves at which counts change between.

Guarantee: every curve that is drawn is one of a member's map. Between members nothing is drawn but the members that
were asked for to fill the gaps.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ptmcad.answer.counts import counted_by
from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.axes import axis_name
from ptmcad.show.render.legend import INK, STRONG, THIN, Entry, Type, draw_legend
from ptmcad.show.render.multiples import family_entries, in_words, paint_of_family, title_of, value_text
from ptmcad.show.render.painting import Paint
from ptmcad.show.render.printing import save, settings
from ptmcad.show.render.shapes import shapes
from ptmcad.show.render.textwidth import text_width
from ptmcad.show.style import MIN_FONT, Place, Style

SIZE = (6.4, 5.2)
MAX_FLOORS = 7
"""Of filled maps: more would hide each other."""


def draw_solid(family: FamilyMap, path: Path, dpi: int, style: Style) -> None:
    """Write the picture, as `ptmcad.show.render.printing.save` does."""
    figure = solid_figure(family, dpi, style)
    figure.set_label(f"{title_of(family)}, in three dimensions\n{in_words(family)}")
    save(figure, path, dpi=dpi, style=style)


def solid_figure(family: FamilyMap, dpi: int, style: Style) -> Figure:
    """The picture: at most `MAX_FLOORS` maps are filled, of the other members there are the curves."""
    with settings(style):
        return _figure(family, dpi, style)


def _figure(family: FamilyMap, dpi: int, style: Style) -> Figure:
    from matplotlib.ticker import MaxNLocator
    from mpl_toolkits.mplot3d import Axes3D

    font = style.base_font
    em, small = font / 72, max(MIN_FONT, 0.85 * font)
    wide, tall = style.size or SIZE
    slice = family.members[0].slice
    figure = Figure(figsize=(wide, tall), dpi=dpi, facecolor="white")
    title = title_of(family) if style.title is None else style.title
    paint = paint_of_family(family, style)
    type = Type(font, max(MIN_FONT, 0.89 * font), font / 9, style.strong, style.strong * THIN / STRONG)
    told = family_entries(family, paint)
    if len(family.values) > MAX_FLOORS:
        told.append(Entry(("curves of the other members",), THIN))
    if len(family.values) > 1:
        told.append(Entry(("paler: seen through", "a map above it"), heads=2))
    if any(not separates for result in family.members for _, separates, _ in shapes(result).walls()):
        told.append(Entry(("other curves left out",)))
    entries = [] if style.legend is Place.NONE else told
    legend = max((type.entry_width(entry) for entry in entries), default=0.0) + (1.2 * em if entries else 0.0)
    head = 2 * em if title else 0.0
    # members' values, which name the third axis, stand at the left of the box, which is not as wide as its axes
    before = 0.5 * max(text_width(value_text(family, value), small) for value in family.values)
    axes: Any = Axes3D(
        figure, rect=(before / wide, 0.03, (wide - legend - before - em) / wide, (tall - head) / tall - 0.03),
        auto_add_to_figure=False,
    )  # fmt: skip
    figure.add_axes(axes)
    axes.set_proj_type("ortho")
    axes.view_init(elev=22, azim=-62)
    axes.computed_zorder = False
    least = min(counted_by(r, slice.count) for result in family.members for r in result.regions)
    floors = set(np.linspace(0, len(family.values) - 1, min(MAX_FLOORS, len(family.values))).round().astype(int))
    axes.set(xlim=_ends(slice.axes[0]), ylim=_ends(slice.axes[1]), zlim=_ends(family.free))
    # what is added is taken for further data, beside limits that matplotlib leaves at infinity
    with np.errstate(over="ignore", invalid="ignore"):
        for number, (value, result) in enumerate(family):
            _floor(axes, result, float(value), paint, least if number in floors else None)
            if number in floors:
                axes.text(
                    *(_ends(axis)[0] for axis in slice.axes), float(value), f"{value_text(family, value)} ",
                    fontsize=small, color=INK, ha="right", va="center", zorder=1e9,
                    gid=f"member-{number}",
                )  # fmt: skip
    how = {"fontsize": 0.95 * font, "labelpad": 0.3 * font}
    axes.set(
        xlim=_ends(slice.axes[0]), ylim=_ends(slice.axes[1]), zlim=_ends(family.free),
    )  # fmt: skip
    axes.set_xlabel(axis_name(slice, 0), **how)
    axes.set_ylabel(axis_name(slice, 1), **how)
    axes.tick_params(labelsize=small, pad=0)
    for each, end in ((axes.xaxis, "upper"), (axes.yaxis, "lower"), (axes.zaxis, None)):
        # at the corner that two axes share, one number would lie on the other
        each.set_major_locator(MaxNLocator(nbins=4, steps=[1, 2, 2.5, 5, 10], prune=end))
    axes.set_box_aspect((1, 1, 1.05), zoom=0.92)
    if title:
        figure.text(
            0.6 * em, tall - em, title, fontsize=font, fontweight="bold", va="center",
            transform=figure.dpi_scale_trans, color=INK,
        )  # fmt: skip
    draw_legend(figure, entries, wide - legend, tall - head - em, type)
    return figure


def _ends(axis: Any) -> tuple[float, float]:
    return float(axis.low), float(axis.high)


def _floor(axes: Any, result: RegionMap, height: float, paint: Paint, least: tuple[int, ...] | None) -> None:
    """A member's map at its height, filled so that one sees through where the count is least, or its curves alone."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Curve
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, pathpatch_2d_to_3d

    seen = shapes(result)
    (left, right), (low, high) = (_ends(axis) for axis in result.slice.axes)
    scale, origin = np.array([right - left, high - low]), np.array([left, low])

    def lifted(points: Any) -> Any:
        return np.column_stack([points * scale + origin, np.full(len(points), height)])

    if least is not None:
        for number, region in enumerate(result.regions):
            polygons = [Curve(polygon * scale + origin, closed=False) for polygon in seen.polygons(number)]
            if polygons:
                # one path for all parts, as on the page: where two of them share an edge no seam is left
                patch = PathPatch(
                    Curve.make_compound_path(*polygons), facecolor=paint.fill(region).face, linewidth=0, zorder=height,
                    alpha=0.3 if counted_by(region, result.slice.count) == least else 0.85, gid=f"{height}-{number}",
                )  # fmt: skip
                axes.add_patch(patch)
                pathpatch_2d_to_3d(patch, z=height)
    strong = [lifted(line) for _, separates, line in seen.walls() if separates]
    strong += [lifted(line) for line in seen.edges()]
    if strong:
        axes.add_collection3d(
            Line3DCollection(
                strong, colors=INK, linewidths=paint.strong if least is not None else 0.4 * paint.strong,
                alpha=1.0 if least is not None else 0.55, zorder=height + 1e-9 * (1 + abs(height)),
            )
        )  # fmt: skip
