"""The map with the stable poses at some of its points around it, each led to its point: the paper's own kind of figure.

Guarantee: points are where their exact coordinates are, and poses are those of the map's mechanism there. Poses of all
points are drawn at one scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import counted
from ptmcad.errors import ConfigError
from ptmcad.mechanism import Mechanism
from ptmcad.show.drawable import no_drawing
from ptmcad.show.render.layout import Layout
from ptmcad.show.render.legend import INK
from ptmcad.show.render.mechanism import STRONG, draw_sketch
from ptmcad.show.render.overlay import Overlay
from ptmcad.show.render.poses import assigned, in_order
from ptmcad.show.render.regionmap import draw_parts, fit
from ptmcad.show.render.shapes import shapes
from ptmcad.show.render.sketch import Frame, Scene, arrow_lengths, frame_of
from ptmcad.show.render.textwidth import wrapped
from ptmcad.show.style import Place, Style

Point = tuple[Fraction, Fraction]

PANEL, LEAST_PANEL = 138.0, 104.0
"""Width of a pose in points, and the least at which its letters have room."""
_TALLEST = 120.0
_MAP = 5.4, 6.9
"""Inches of the map with its legend, in 9 points."""
_GAP = 0.16
_SHARE = 0.58
"""Of a given width, for the poses."""
MAX_POINTS = 12


@dataclass(frozen=True, slots=True)
class _Block:
    """What stands beside the map for a point: a head and poses side by side."""

    number: int
    at: Point
    head: Sequence[str]
    poses: Poses
    shown: tuple[Pose, ...]


@dataclass(frozen=True, slots=True)
class _Slot:
    """Where a block stands, in inches: left end, top and width; ``before`` at the left of the map."""

    left: float
    top: float
    width: float
    before: bool


def draw_around(
    result: RegionMap, points: Sequence[tuple[Point, Poses]], style: Style, dpi: int, overlay: Overlay = ()
) -> Figure:
    """The map in the middle and poses at its sides; within `ptmcad.show.render.printing.settings`.

    Parameters
    ----------
    points : in the axes' order, with all that is known of the equilibria there.

    Raises
    ------
    ConfigError
        For a system without points to draw, too many points, or a size in which poses have no room.
    """
    mechanism = result.slice.model
    if not isinstance(mechanism, Mechanism):
        raise ConfigError(no_drawing(mechanism), key="at")
    if len(points) > MAX_POINTS:
        raise ConfigError(f"poses of at most {MAX_POINTS} points fit around a map", key="at")
    em = style.base_font / 72
    shown = [_shown(poses) for _, poses in points]
    sides = _sides([at for at, _ in points])
    most = [max((max(1, len(shown[n])) for n in side), default=0) for side in sides]
    size, panel = _page(style, most)
    everything = [pose for poses in shown for pose in poses]
    frame = frame_of(everything, panel, min(_TALLEST, 0.9 * panel)) if everything else Frame(Fraction(1), 0.0, panel)
    wide = [number * panel / 72 for number in most]
    blocks = [
        _Block(n + 1, at, _lines(_head(result, n + 1, at, poses), len(shown[n]) * panel, style), poses, shown[n])
        for n, (at, poses) in enumerate(points)
    ]
    heights = [len(b.head) * 1.3 * em + (frame.height / 72 if b.shown else 0.0) + _GAP for b in blocks]
    tall = max(sum(heights[n] for n in side) for side in sides)
    if style.size is None:
        size = (size[0], max(size[1], tall + 2 * _GAP))
    elif tall + _GAP > size[1]:
        raise ConfigError(
            f"poses at {len(points)} points need a height of {tall + 1.5 * _GAP:.2f} inches, {size[1]:.2f} are there",
            key="size",
        )
    taken = [_taken(number, panel) for number in most]
    left = taken[0]
    inner = (size[0] - sum(taken), size[1])
    inner_style = style._replace(size=inner, font_size=style.base_font, legend=style.legend or Place.BELOW)
    seen, layout = fit(result, shapes(result), False, dpi, inner_style, overlay)
    figure = Figure(figsize=size, dpi=dpi, facecolor="white")
    axes = draw_parts(figure, seen, _moved(layout, left, size), inner_style, False, overlay)
    for number, side in enumerate(sides):
        slot = _Slot(_GAP if number == 0 else size[0] - wide[1] - _GAP, size[1] - _GAP, wide[number], number == 0)
        free = (size[1] - 2 * _GAP - sum(heights[n] for n in side)) / max(1, len(side))
        for n in side:
            at = seen.whole.view.approximate_position(points[n][0])
            _lead(axes, _draw_block(figure, blocks[n], frame, slot, style), at, n + 1, style)
            slot = replace(slot, top=slot.top - heights[n] - free)
    return figure


def _shown(poses: Poses) -> tuple[Pose, ...]:
    told = poses.model.tells_stability
    return tuple(pose for pose in in_order(poses) if pose.stable or not told)


def _sides(points: Sequence[Point]) -> tuple[list[int], list[int]]:
    """Numbers of the points at the left and at the right of the map, from above; few points all at the right."""
    order = sorted(range(len(points)), key=lambda n: points[n][0])
    half = len(points) // 2 if len(points) > 3 else 0
    left, right = (sorted(part, key=lambda n: -points[n][1]) for part in (order[:half], order[half:]))
    return left, right


def _taken(number: int, panel: float) -> float:
    """Inches that so many poses side by side take beside the map, in panels of a width in points."""
    return number * panel / 72 + 2 * _GAP if number else 0.0


def _page(style: Style, most: Sequence[int]) -> tuple[tuple[float, float], float]:
    """The page's size and a panel's width in points, for so many poses side by side at the left and at the right."""
    scale = style.base_font / 9
    if style.size is None:
        return (scale * _MAP[0] + sum(_taken(number, PANEL) for number in most), scale * _MAP[1]), PANEL
    # nearly half of the page is the map's; on a large page the poses do not grow beyond what they need
    gaps = sum(_taken(number, 0.0) for number in most)
    room = (_SHARE * style.size[0] - gaps) * 72 / sum(most)
    if room < LEAST_PANEL:
        least = sum(_taken(number, LEAST_PANEL) for number in most) / _SHARE
        raise ConfigError(f"poses beside the map need a width of {least + 0.01:.2f} inches", key="size")
    return style.size, min(room, PANEL * max(1.0, scale))


def _head(result: RegionMap, number: int, at: Point, poses: Poses) -> str:
    where = ", ".join(assigned(axis.name, value) for axis, value in zip(result.slice.axes, at, strict=True))
    if poses.model.tells_stability:
        return f"{number}:  {where}; {poses.stable} stable"
    return f"{number}:  {where}; {counted(poses.model, len(poses.equilibria))}"


def _lines(head: str, points: float, style: Style) -> Sequence[str]:
    """A head over poses of this width in points, or over the room for one."""
    return wrapped(head, max(points, LEAST_PANEL) / 72, style.base_font, True)


def _moved(layout: Layout, left: float, size: tuple[float, float]) -> Layout:
    """The layout further to the right on a wider page."""
    return replace(
        layout,
        size=size,
        chart=(layout.chart[0] + left, *layout.chart[1:]),
        title_at=(layout.title_at[0] + left, layout.title_at[1]),
        legend=tuple(((x + left, y), part) for (x, y), part in layout.legend),
        insets=tuple((box[0] + left, *box[1:]) for box in layout.insets),
    )


def _draw_block(figure: Figure, block: _Block, frame: Frame, slot: _Slot, style: Style) -> tuple[float, float]:
    """A point's head and poses; where the line to the point begins."""
    width, tall = (float(side) for side in figure.get_size_inches())
    inches, em = figure.dpi_scale_trans, style.base_font / 72
    used = max(1, len(block.shown)) * frame.width / 72
    left = slot.left + (slot.width - used if slot.before else 0.0)
    for k, line in enumerate(block.head):
        figure.text(
            left, slot.top - 1.3 * em * (k + 0.5), line, transform=inches, fontsize=style.base_font, fontweight="bold",
            va="center_baseline", color=INK,
        )  # fmt: skip
    bottom = slot.top - 1.3 * em * len(block.head) - frame.height / 72
    mechanism = block.poses.model
    assert isinstance(mechanism, Mechanism)  # others have been refused
    scene = Scene(mechanism, frame, arrow_lengths(block.poses))
    for k, pose in enumerate(block.shown):
        box = (left + k * frame.width / 72, bottom, frame.width / 72, frame.height / 72)
        panel = figure.add_axes((box[0] / width, box[1] / tall, box[2] / width, box[3] / tall))
        panel.set_gid(f"pose-{block.number}-{k + 1}")
        panel.set(xlim=(0, frame.width), ylim=(0, frame.height), xticks=[], yticks=[])
        for spine in panel.spines.values():
            spine.set(color="#b5b5b5", linewidth=0.6)
        draw_sketch(panel, scene.of(pose), STRONG, f"pose-{block.number}-{k + 1}-")
    edge = left + used + 0.03 if slot.before else left - 0.05
    return edge, (bottom + slot.top) / 2 if block.shown else slot.top - 0.65 * em


def _lead(axes: Any, start: tuple[float, float], at: tuple[float, float], number: int, style: Style) -> None:
    """A line to a point of the map, which is given as fractions of the axes' sides, and a mark there."""
    figure: Any = axes.figure
    width, tall = (float(side) for side in figure.get_size_inches())
    inches, chart = figure.dpi_scale_trans, axes.get_position()
    tip = ((chart.x0 + at[0] * chart.width) * width, (chart.y0 + at[1] * chart.height) * tall)
    for thickness, colour in ((2.2, "white"), (0.8, INK)):
        figure.add_artist(
            Line2D(*zip(start, tip, strict=True), transform=inches, color=colour, linewidth=thickness, zorder=8,
                   gid=f"leader-{number}" if colour == INK else None)
        )  # fmt: skip
    figure.add_artist(
        Line2D((tip[0],), (tip[1],), transform=inches, marker="D", markersize=5.5 * style.base_font / 9,
               markerfacecolor="white", markeredgecolor=INK, markeredgewidth=1.2, linestyle="none", zorder=9,
               gid=f"point-{number}")
    )  # fmt: skip
