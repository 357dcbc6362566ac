"""The map with the stable poses at some of its points around it, each led to its point: the paper's
own kind of figure.

Guarantee: points are where their exact coordinates are, and poses are those of the map's mechanism
there. Poses of all points are drawn at one scale. Lines to the points are straight and, at one side,
as short and as clear of text as exchanges of blocks make them.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import dist
from typing import Any

from matplotlib.figure import Figure
from matplotlib.text import Text

from ptmcad.errors import ConfigError
from ptmcad.show.drawable import no_drawing
from ptmcad.show.render.blocks import LINE, Block, Plan, PointPoses, arranged, sized
from ptmcad.show.render.colours import INK
from ptmcad.show.render.fitting import Layout, larger
from ptmcad.show.render.inches import stroke, write_lines
from ptmcad.show.render.labels import Box, Position, crosses
from ptmcad.show.render.mappicture import MapDrawing, left_out
from ptmcad.show.render.posepicture import draw_pose
from ptmcad.show.render.sketch import arrow_lengths
from ptmcad.show.style import MAX_SIDE, PictureStyle, Size, styled

DrawnMap = tuple[Figure, tuple[str, ...]]
"""A picture of a map, and what it leaves out, in words."""
MAX_POINTS = 12
_COVERED, _HALF = 10.0, 0.035
"""Inches of a line that are as bad as a text that it covers, and half a line's width with a little
space.
"""


def draw_around(drawing: MapDrawing, points: Sequence[PointPoses]) -> DrawnMap:
    """The map in the middle and poses at its sides; within `ptmcad.show.render.printing.settings`.

    Parameters
    ----------
    points : in the axes' order, with all that is known of the equilibria there.

    Returns
    -------
    The figure, and what of the map had no room, in words.

    Raises
    ------
    ConfigError
        For a system without points to draw, too many points, or a size in which poses have no room.
    """
    model = drawing.result.slice.model
    if model.whole is None:
        raise ConfigError(no_drawing(model), key="at")
    if len(points) > MAX_POINTS:
        raise ConfigError(f"poses of at most {MAX_POINTS} points fit around a map", key="at")
    try:
        return _drawn(drawing, points)
    except ConfigError as error:
        raise ConfigError(f"{error.message}: {_remedy(drawing, points)}", key=error.key) from error


def _remedy(drawing: MapDrawing, points: Sequence[PointPoses]) -> str:
    """The least size of the same shape in which poses have room, of a page that is given whole."""
    style = drawing.style
    if style.size is None or style.wide is not None:
        return "give fewer points, or a size of your own"
    for wide, tall in larger(style.size):
        if wide >= MAX_SIDE:
            break
        tried = styled(style, size=(wide, tall))
        try:
            _planned(drawing._replace(style=tried, overlay=()), points)
        except ConfigError:
            continue
        return f"give a size such as {wide + 0.005:.2f}x{tall + 0.005:.2f}in, or fewer points"
    return "give a larger size, or fewer points"


def _drawn(drawing: MapDrawing, points: Sequence[PointPoses]) -> DrawnMap:
    """The figure, and what of the map had no room.

    Raises
    ------
    ConfigError
        When poses, or the map beside them, have no room.
    """
    style = drawing.style
    plan, size, inner, (seen, layout) = _planned(drawing, points)
    figure = Figure(figsize=size, dpi=drawing.dpi, facecolor="white")
    axes = inner.draw_parts(figure, seen, layout.moved(plan.taken[0], size))
    figure.draw_without_rendering()  # which makes the numbers at the ticks
    inches = figure.dpi_scale_trans.inverted()
    texts: list[Box] = [
        text.get_window_extent().transformed(inches).extents
        for text in figure.findobj(Text)
        if text.get_text().strip() and text.get_visible()
    ]

    def cost(start: Position, tip: Position) -> float:
        covered = sum(crosses((start, tip, _HALF), box) for box in texts)
        return dist(start, tip) + _COVERED * covered

    tips = [_tip(axes, seen.whole.view.approximate_position(at)) for at, _ in points]
    for side in (0, 1):
        for block, corner, start in plan.placed(side, size[1], tips, cost):
            _draw_block(figure, block, corner, style)
            _lead(figure, (start, tips[block.number - 1]), block.number, style)
    return figure, left_out(seen, layout)


def _planned(
    drawing: MapDrawing, points: Sequence[PointPoses]
) -> tuple[Plan, Size, MapDrawing, tuple[Any, Layout]]:
    """The poses' places, the page's size, and what is found to fit for the map between them."""
    plan = arranged(drawing.result, points, drawing.style)
    size, style = sized(plan, drawing.style)
    inner = drawing._replace(style=style)
    try:
        return plan, size, inner, inner.fit()
    except ConfigError as error:
        raise ConfigError(
            "the map and its legend have no room beside the poses", key=error.key
        ) from error


def _tip(axes: Any, at: Position) -> Position:
    """A point of the map, which is given as fractions of the axes' sides, in inches."""
    width, tall = (float(side) for side in axes.figure.get_size_inches())
    chart = axes.get_position()
    return (chart.x0 + at[0] * chart.width) * width, (chart.y0 + at[1] * chart.height) * tall


def _draw_block(figure: Figure, block: Block, corner: Position, style: PictureStyle) -> None:
    """A point's head and poses, from an upper left corner."""
    (left, top), line, frame = corner, LINE * block.em, block.frame
    look = {"fontweight": "bold", "va": "center_baseline", "color": INK}
    write_lines(figure, (left, top - line / 2), block.head, style.base_font, line, **look)
    top -= line * len(block.head)
    mechanism = block.poses.model.whole
    assert mechanism is not None  # others have been refused
    arrows = arrow_lengths(block.poses)
    for k, pose in enumerate(block.shown):
        row, column = divmod(k, block.across)
        at = (left + column * frame.width / 72, top - (row + 1) * frame.height / 72)
        seen = frame.sketch(mechanism, pose, arrows)
        draw_pose(figure, seen, at, f"pose-{block.number}-{k + 1}", strong=True, framed=False)


def _lead(
    figure: Figure, ends: tuple[Position, Position], number: int, style: PictureStyle
) -> None:
    """A line to a point of the map, and a mark there."""
    xs, ys = zip(*ends, strict=True)
    stroke(figure, xs, ys, color="white", linewidth=2.2, zorder=8)
    stroke(figure, xs, ys, color=INK, linewidth=0.8, zorder=8, gid=f"leader-{number}")
    stroke(
        figure, xs[-1:], ys[-1:], marker="D", markersize=5.5 * style.base_font / 9, markerfacecolor="white",
        markeredgecolor=INK, markeredgewidth=1.2, linestyle="none", zorder=9, gid=f"point-{number}",
    )  # fmt: skip
