"""The map itself: regions filled, walls drawn, in colours and lines of a style; and on it points of
a caller's own, such as measured ones.

Guarantee: a point with a count of its own is marked by whether the map has the same count there;
kinds of marks differ in shape or lightness, not in hue alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Any

import numpy as np

from ptmcad.answer.words import several
from ptmcad.show.render.colours import CORE, INK, RIM, RIM_INK, Paint
from ptmcad.show.render.legend import Entry, point_mark
from ptmcad.show.render.view import Floats, Point, Shapes, View

_OVER = 0.004
"""Of the view's sides: more than half a rim's width."""


def paint_map(axes: Any, seen: Shapes, prefix: str, paint: Paint, place: Any = None) -> None:
    """Fill the regions and draw the walls; ``place`` takes the view to the page: if not given, to
    all of the axes.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.patches import PathPatch, Rectangle
    from matplotlib.path import Path as Curve

    result, place = seen.result, axes.transAxes if place is None else place
    if result.cover is not None:
        axes.add_artist(
            Rectangle(
                (0, 0), 1, 1, transform=place, facecolor=paint.undetermined.face, linewidth=0, snap=False,
                gid=f"{prefix}undetermined", hatch=paint.undetermined.hatch or None,
                edgecolor=RIM_INK if paint.undetermined.hatch else None,
            )
        )  # fmt: skip
    rim = (CORE + 2 * RIM) * paint.scale if result.cover is not None else 0.0
    for number, outlines in enumerate(seen.polygons()):
        if not outlines:
            continue
        polygons = [Curve(_beyond(np.vstack([p, p[:1]])), closed=True) for p in outlines]
        fill = paint.fill(result.regions[number])
        # one path for all parts: where two of them share an edge, their coverage adds up and no
        # seam is left
        axes.add_artist(
            PathPatch(
                Curve.make_compound_path(*polygons), transform=place, facecolor=fill.face, edgecolor=INK,
                hatch=fill.hatch or None, linewidth=rim, joinstyle="round", snap=False,
                gid=f"{prefix}region-{number}",
            )
        )  # fmt: skip
    edges = [Curve(_beyond(edge), closed=True) for edge in seen.rims()]
    if edges:
        # all but the regions, whose outlines have them at the left hand, and a line's width of
        # them: what is undetermined is seen between its rims, however narrow it is
        around = Curve([(-1, -1), (-1, 2), (2, 2), (2, -1), (-1, -1)], closed=True)
        axes.add_artist(
            PathPatch(
                Curve.make_compound_path(around, *edges), transform=place, edgecolor=paint.undetermined.face,
                facecolor="none" if paint.undetermined.hatch else paint.undetermined.face,
                linewidth=CORE * paint.scale, joinstyle="round", snap=False, zorder=2, gid=f"{prefix}edges",
            )
        )  # fmt: skip
    lines: dict[tuple[bool, int], list[Any]] = {}
    continua = result.continua
    for component, separates, line in seen.walls():
        if separates or component in continua or paint.thin_walls:
            lines.setdefault((separates, component), []).append(line)
    for (separates, component), parts in sorted(lines.items()):
        axes.add_artist(
            LineCollection(
                parts, transform=place, colors=INK, linewidths=paint.strong if separates else paint.thin,
                linestyles="dashed" if component in continua else "solid" if separates else paint.thin_lines,
                capstyle="round", joinstyle="round", zorder=3 if separates else 2,
                gid=f"{prefix}curve-{component}" + ("" if separates else "-thin"),
            )
        )  # fmt: skip


def _beyond(outline: Floats) -> Floats:
    """An outline with what is on the frame moved over it, so that the frame has no rim."""
    moved: Floats = outline + _OVER * (
        np.isclose(outline, 1, 0, 1e-9) * 1.0 - np.isclose(outline, 0, 0, 1e-9)
    )
    return moved


class Agreement(Enum):
    """Whether the map says of a point what its own count says."""

    UNTOLD = "measured point"
    SAME = "measured, count as in the map"
    OTHER = "measured, another count"


_SHAPES: dict[Agreement, dict[str, Any]] = {
    Agreement.UNTOLD: {"marker": "o", "markerfacecolor": "white", "markersize": 4.5},
    Agreement.SAME: {"marker": "o", "markerfacecolor": INK, "markersize": 4.5},
    Agreement.OTHER: {"marker": "X", "markerfacecolor": "#d81b3c", "markersize": 7.0},
}


Measured = tuple[Point, str, Agreement]
"""A point in the axes' order, with a label that may be empty."""
Overlay = Sequence[Measured]


def overlay_entries(overlay: Overlay) -> tuple[Entry, ...]:
    """What the marks mean, with their numbers."""
    found = []
    for kind in Agreement:
        number = sum(agreement is kind for _, _, agreement in overlay)
        if number:
            found.append(
                Entry((kind.value, several(number, "point")), point_mark(**_style(kind, 1.0)))
            )
    return tuple(found)


def _style(kind: Agreement, scale: float) -> dict[str, Any]:
    shape = dict(_SHAPES[kind])
    shape["markersize"] *= scale
    return {**shape, "linestyle": "none", "markeredgecolor": "white" if kind is Agreement.OTHER else INK,
            "markeredgewidth": 0.8 * scale}  # fmt: skip


def draw_overlay(axes: Any, view: View, overlay: Overlay, scale: float, size: float) -> None:
    """The points and their labels, in axes of a picture's own.

    Parameters
    ----------
    scale : of marks, against a picture in 9 points.
    size : of the labels' text, in points.
    """
    for kind in Agreement:
        at = [view.approximate_position(point) for point, _, own in overlay if own is kind]
        if at:
            x, y = zip(*at, strict=True)
            axes.plot(
                x, y, transform=axes.transAxes, zorder=6.5, clip_on=False, gid=f"measured-{kind.name.lower()}",
                **_style(kind, scale),
            )  # fmt: skip
    for point, label, _ in overlay:
        if not label:
            continue
        place = view.approximate_position(point)
        right, high = place[0] < 0.8, place[1] > 0.9
        away = ((4 if right else -4) * scale, (-4 if high else 4) * scale)
        axes.annotate(
            label, xy=place, xycoords="axes fraction", xytext=away, textcoords="offset points",
            ha="left" if right else "right", va="top" if high else "bottom", fontsize=size, color=INK,
            zorder=6.4, annotation_clip=False,
            bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none"},
        )  # fmt: skip
