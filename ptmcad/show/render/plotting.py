"""A map as objects of matplotlib's, for a caller who goes on with them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.transforms import Affine2D

from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import expect
from ptmcad.show.render.around import draw_around
from ptmcad.show.render.axes import axis_name
from ptmcad.show.render.blocks import PointPoses
from ptmcad.show.render.colours import INK, fills_by_count, paint_of
from ptmcad.show.render.legend import head_of
from ptmcad.show.render.mappicture import MapDrawing, description, whole_title
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.painting import Overlay, paint_map
from ptmcad.show.render.posewords import describe
from ptmcad.show.render.printing import save, settings
from ptmcad.show.style import DEFAULT, LegendPlace, PictureStyle, styled


def plot(
    result: RegionMap,
    ax: Any,
    style: str | PictureStyle,
    samples: bool,
    dpi: int,
    options: dict[str, Any],
) -> Any:
    """A figure of its own, or the axes that were given, with the map in them.

    Raises
    ------
    ConfigError
        For an unknown style or option, a value that cannot be drawn, or what does not fit into the
        size.
    """
    made = styled(style, **options)
    if ax is not None:
        from matplotlib.axes import Axes

        expect(ax, Axes, "ax", "axes of matplotlib's")
        draw_on(ax, result, samples, made)
        return ax
    with settings(made):
        return MapDrawing(result, made, dpi, samples).figure()


def draw_on(axes: Any, result: RegionMap, samples: bool, style: PictureStyle) -> None:
    """The map in a caller's axes, in the units of its own axes, so that the caller can add to it.

    Without insets and arrows; its legend stands at the axes' right.
    """
    whole, paint = shapes(result), paint_of(style, result)
    sides = [tuple(float(end) for end in whole.view.along(k)) for k in (0, 1)]
    unit_square = (
        Affine2D().scale(*(high - low for low, high in sides)).translate(*(low for low, _ in sides))
    )
    paint_map(axes, whole, "", paint, unit_square + axes.transData)
    if samples:
        points = np.array([c.sample for c in result.cells], dtype=float)
        axes.plot(*points.T, "o", markersize=2.5 * paint.scale, color=INK, gid="samples")
    axes.set(
        xlim=sides[0],
        ylim=sides[1],
        xlabel=axis_name(result.slice, 0),
        ylabel=axis_name(result.slice, 1),
    )
    title = whole_title(result) if style.title is None else style.title
    if title:
        axes.set_title(title, loc="left", wrap=True)
    if style.legend is not LegendPlace.NONE:
        handles = [
            Patch(
                facecolor=fill.face,
                hatch=fill.hatch or None,
                edgecolor=INK,
                linewidth=0.4,
                label=text,
            )
            for text, fill in fills_by_count(paint, result).items()
        ]
        below = style.legend is LegendPlace.BELOW
        axes.legend(
            handles=handles, title=head_of(result.slice)[0], ncols=len(handles) if below else 1, borderaxespad=0,
            loc="upper left", bbox_to_anchor=(0.0, -0.2) if below else (1.03, 1.0), frameon=False,
        )  # fmt: skip


def draw_with_poses(
    result: RegionMap,
    points: Sequence[PointPoses],
    path: Path,
    dpi: int,
    style: PictureStyle,
    overlay: Overlay,
) -> tuple[str, ...]:
    """Write the map with the stable poses at points around it; what had no room is returned, in
    words.

    Raises
    ------
    ValueError
        For another suffix than those of `ptmcad.show.render.printing.FORMATS`.
    ConfigError
        As `ptmcad.show.render.around.draw_around` does.
    OSError
        When the file cannot be written.
    """
    figure, missing = with_poses(result, points, dpi, style, overlay)
    save(figure, path, dpi=dpi, style=style)
    return missing


def with_poses(
    result: RegionMap,
    points: Sequence[PointPoses],
    dpi: int = 150,
    style: PictureStyle = DEFAULT,
    overlay: Overlay = (),
) -> tuple[Figure, tuple[str, ...]]:
    """What `draw_with_poses` writes, and what had no room, in words."""
    words = " ".join(f"At point {n}: {describe(poses)}" for n, (_, poses) in enumerate(points, 1))
    with settings(style):
        figure, missing = draw_around(MapDrawing(result, style, dpi, overlay=overlay), points)
    figure.set_label(f"{whole_title(result)}\n{description(result)} {words}")
    return figure, missing
