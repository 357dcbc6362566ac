"""The map itself: regions filled, walls drawn, in colours and lines of a style."""

from __future__ import annotations

from typing import Any

import numpy as np

from ptmcad.show.render.colours import CORE, INK, RIM, RIM_INK, Paint
from ptmcad.show.render.outline import Shapes
from ptmcad.show.render.view import Floats

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
    for number, region in enumerate(result.regions):
        polygons = [
            Curve(_beyond(np.vstack([p, p[:1]])), closed=True) for p in seen.polygons(number)
        ]
        if not polygons:
            continue
        fill = paint.fill(region)
        # one path for all parts: where two of them share an edge, their coverage adds up and no
        # seam is left
        axes.add_artist(
            PathPatch(
                Curve.make_compound_path(*polygons), transform=place, facecolor=fill.face, edgecolor=INK,
                hatch=fill.hatch or None, linewidth=rim, joinstyle="round", snap=False,
                gid=f"{prefix}region-{number}",
            )
        )  # fmt: skip
    edges = [Curve(_beyond(edge), closed=True) for edge in seen.edges()]
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
