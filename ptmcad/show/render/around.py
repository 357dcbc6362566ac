"""The map with the stable poses at some of its points around it, each led to its point: the paper's own kind of figure.

Guarantee: points are where their exact coordinates are, and poses are those of the map's mechanism there. Poses of all
points are drawn at one scale. Lines to the points cross neither each other nor text where
`ptmcad.show.render.leaders` finds such courses.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import counted
from ptmcad.errors import ConfigError
from ptmcad.mechanism import Mechanism
from ptmcad.show.drawable import no_drawing
from ptmcad.show.render.clearance import Box, Position
from ptmcad.show.render.layout import Layout
from ptmcad.show.render.leaders import Berth, Course, Order, routed
from ptmcad.show.render.legend import INK
from ptmcad.show.render.mechanism import STRONG, draw_sketch
from ptmcad.show.render.overlay import Overlay
from ptmcad.show.render.poses import assigned, in_order
from ptmcad.show.render.regionmap import draw_parts, fit, left_out
from ptmcad.show.render.shapes import shapes
from ptmcad.show.render.sketch import Frame, Scene, arrow_lengths, frame_of
from ptmcad.show.render.textwidth import wrapped
from ptmcad.show.style import PAGE_HEIGHT, Place, Style

Point = tuple[Fraction, Fraction]

PANEL, LEAST_PANEL = 138.0, 104.0
"""Width of a pose in points, and the least at which its letters have room."""
_TALLEST = 120.0
_MAP = 5.4, 6.9
"""Inches of the map with its legend, in 9 points."""
_GAP, _NEAR, _GUTTER = 0.16, 0.04, 0.11
"""Inches around poses, and from them to where their line begins and where it may bend."""
_SHARE = 0.58
"""Of a given width, for the poses."""
MAX_POINTS = 12


@dataclass(frozen=True, slots=True)
class _Block:
    """What stands beside the map for a point: a head and below it poses, so many side by side."""

    number: int
    at: Point
    head: Sequence[str]
    poses: Poses
    shown: tuple[Pose, ...]
    across: int

    def height(self, frame: Frame, em: float) -> float:
        """In inches, with the space below."""
        rows = ceil(len(self.shown) / self.across)
        return len(self.head) * 1.3 * em + rows * frame.height / 72 + _GAP

    def width(self, frame: Frame) -> float:
        return max(1, min(len(self.shown), self.across)) * frame.width / 72


@dataclass(frozen=True, slots=True)
class _Slot:
    """Where a block stands, in inches: left end, top and width; ``before`` at the left of the map."""

    left: float
    top: float
    width: float
    before: bool

    def start(self, block: _Block, frame: Frame) -> float:
        """The block's left end: blocks stand as near to the map as they can."""
        return self.left + (self.width - block.width(frame) if self.before else 0.0)

    def berth(self, block: _Block, frame: Frame, em: float) -> Berth:
        """Where the line to the block's point may begin."""
        edge, towards = (self.left + self.width, 1.0) if self.before else (self.left, -1.0)
        low = self.top - block.height(frame, em) + _GAP + _NEAR
        # not beside the head, unless there is nothing else
        high = self.top - 1.3 * em * len(block.head) - _NEAR
        if not block.shown:
            low = high = self.top - 0.65 * em
        return Berth(edge + towards * _NEAR, low, high, edge + towards * _GUTTER)


@dataclass(frozen=True, slots=True)
class _Page:
    """A page's width and, where it does not grow, its height; a panel's width in points, and how many side by side."""

    width: float
    height: float | None
    panel: float
    across: int


def draw_around(
    result: RegionMap, points: Sequence[tuple[Point, Poses]], style: Style, dpi: int, overlay: Overlay = ()
) -> tuple[Figure, tuple[str, ...]]:
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
    mechanism = result.slice.model
    if not isinstance(mechanism, Mechanism):
        raise ConfigError(no_drawing(mechanism), key="at")
    if len(points) > MAX_POINTS:
        raise ConfigError(f"poses of at most {MAX_POINTS} points fit around a map", key="at")
    em = style.base_font / 72
    plan = _arranged(result, points, style)
    page, frame, blocks = plan.page, plan.frame, plan.blocks
    taken = [_taken(number, page.panel) for number in plan.most]
    size = (page.width, _height(page, plan.tall(em), page.width - sum(taken), style, len(points)))
    inner_style = style._replace(
        size=(size[0] - sum(taken), size[1]), font_size=style.base_font, legend=style.legend or Place.BELOW
    )
    seen, layout = fit(result, shapes(result), False, dpi, inner_style, overlay)
    figure = Figure(figsize=size, dpi=dpi, facecolor="white")
    moved = _moved(layout, taken[0], size)
    axes = draw_parts(figure, seen, moved, inner_style, False, overlay)
    texts = [*_texts(figure), *_legend_boxes(moved)]
    for before, side, number in zip((True, False), plan.sides, plan.most, strict=True):
        wide = number * page.panel / 72
        slot = _Slot(_GAP if before else size[0] - wide - _GAP, size[1] - _GAP, wide, before)
        tips = [_tip(axes, seen.whole.view.approximate_position(points[n][0])) for n in side]
        along = _Side([blocks[n] for n in side], slot, frame, em, size[1])
        chart = moved.chart
        order, courses = routed(tips, along.berths, texts, (chart[1] + 0.05, chart[1] + chart[3] - 0.05))
        for k, (block, place) in enumerate(along.placed(order)):
            _draw_block(figure, block, frame, place, style)
            _lead(figure, courses[k], block.number, style)
    return figure, left_out(seen, layout)


@dataclass(frozen=True, slots=True)
class _Plan:
    """The points' blocks, and the numbers of those at the left and at the right of the map, from above."""

    page: _Page
    frame: Frame
    blocks: Sequence[_Block]
    sides: tuple[list[int], list[int]]

    @property
    def most(self) -> list[int]:
        """Poses side by side, at the left and at the right."""
        return [
            max((min(self.page.across, max(1, len(self.blocks[n].shown))) for n in side), default=0)
            for side in self.sides
        ]

    def tall(self, em: float) -> float:
        """The height that the poses need, in inches."""
        heights = [sum(self.blocks[n].height(self.frame, em) for n in side) for side in self.sides]
        return max(heights) + 2 * _GAP


def _arranged(result: RegionMap, points: Sequence[tuple[Point, Poses]], style: Style) -> _Plan:
    """Half of the points at each side of the map, few all at the right; on a page of a given width as fits best."""
    shown = [_shown(poses) for _, poses in points]
    usual = len(points) // 2 if len(points) > 3 else 0
    most = PAGE_HEIGHT if style.wide is not None else style.size[1] if style.size is not None else None
    found: list[tuple[float, _Plan]] = []
    refused: ConfigError | None = None
    for left in sorted(range(len(points)), key=lambda n: abs(n - usual)):
        sides = _sides([at for at, _ in points], left)
        try:
            page = _page(style, [[max(1, len(shown[n])) for n in side] for side in sides])
        except ConfigError as error:
            refused = refused or error
            continue
        blocks = [_block(result, n, points[n], shown[n], page, style) for n in range(len(points))]
        plan = _Plan(page, _frame(shown, page.panel), blocks, sides)
        found.append((plan.tall(style.base_font / 72), plan))
        if most is None or found[-1][0] <= most:
            return plan
    if not found:
        assert refused is not None  # there is at least one point
        raise refused
    return min(found, key=lambda each: each[0])[1]


@dataclass(frozen=True, slots=True)
class _Side:
    """The blocks at one side of the map, from the slot at the top downwards on a page of some height."""

    blocks: Sequence[_Block]
    first: _Slot
    frame: Frame
    em: float
    page: float

    def placed(self, order: Order) -> Iterator[tuple[_Block, _Slot]]:
        """In this order, with equal spaces between."""
        heights = [block.height(self.frame, self.em) for block in self.blocks]
        free = (self.page - 2 * _GAP - sum(heights)) / max(1, len(heights))
        slot = self.first
        for n in order:
            yield self.blocks[n], slot
            slot = replace(slot, top=slot.top - heights[n] - free)

    def berths(self, order: Order) -> list[Berth]:
        return [slot.berth(block, self.frame, self.em) for block, slot in self.placed(order)]


def _block(
    result: RegionMap, n: int, point: tuple[Point, Poses], shown: tuple[Pose, ...], page: _Page, style: Style
) -> _Block:
    at, poses = point
    wide = min(max(1, len(shown)), page.across) * page.panel
    return _Block(n + 1, at, _lines(_head(result, n + 1, at, poses), wide, style), poses, shown, page.across)


def _shown(poses: Poses) -> tuple[Pose, ...]:
    told = poses.model.tells_stability
    return tuple(pose for pose in in_order(poses) if pose.stable or not told)


def _sides(points: Sequence[Point], left: int) -> tuple[list[int], list[int]]:
    """Numbers of the points at the left of the map, which are so many, and at the right, from above."""
    order = sorted(range(len(points)), key=lambda n: points[n][0])
    before, after = (sorted(part, key=lambda n: -points[n][1]) for part in (order[:left], order[left:]))
    return before, after


def _taken(number: int, panel: float) -> float:
    """Inches that so many poses side by side take beside the map, in panels of a width in points."""
    return number * panel / 72 + 2 * _GAP if number else 0.0


def _page(style: Style, numbers: Sequence[Sequence[int]]) -> _Page:
    """The page for so many poses at each point at the left and at the right: side by side where that has room."""
    scale = style.base_font / 9
    largest = max(max(side, default=0) for side in numbers)
    width = style.widest
    if width is None:
        most = [max(side, default=0) for side in numbers]
        return _Page(scale * _MAP[0] + sum(_taken(number, PANEL) for number in most), None, PANEL, largest)
    for across in range(largest, 0, -1):
        most = [max((min(number, across) for number in side), default=0) for side in numbers]
        # nearly half of the page is the map's; on a large page the poses do not grow beyond what they need
        gaps = sum(_taken(number, 0.0) for number in most)
        room = (_SHARE * width - gaps) * 72 / sum(most)
        if room >= LEAST_PANEL:
            height = None if style.wide is not None or style.size is None else style.size[1]
            return _Page(width, height, min(room, PANEL * max(1.0, scale)), across)
    least = sum(_taken(number, LEAST_PANEL) for number in most) / _SHARE
    raise ConfigError(f"poses beside the map need a width of {least + 0.01:.2f} inches", key="size")


def _frame(shown: Sequence[tuple[Pose, ...]], panel: float) -> Frame:
    """The panels' sides and scale."""
    everything = [pose for poses in shown for pose in poses]
    if not everything:
        return Frame(Fraction(1), 0.0, panel)
    return frame_of(everything, panel, min(_TALLEST, 0.9 * panel))


def _height(page: _Page, tall: float, inner: float, style: Style, points: int) -> float:
    """Of the page, whose poses are so tall and whose map is so wide with its numbers."""
    if page.height is None and style.wide is None:
        return max(_MAP[1] / _MAP[0] * inner, tall)
    there = PAGE_HEIGHT if page.height is None else page.height
    if tall > there:
        more = "" if page.height is not None else ": fewer points fit a page, or a --size of your own"
        raise ConfigError(
            f"poses at {points} points need a height of {tall + 0.01:.2f} inches, {there:.2f} are there{more}",
            key="size",
        )
    return there if page.height is not None else min(there, max(_MAP[1] / _MAP[0] * inner, tall))


def _head(result: RegionMap, number: int, at: Point, poses: Poses) -> str:
    where = ", ".join(assigned(axis.name, value) for axis, value in zip(result.slice.axes, at, strict=True))
    if poses.model.tells_stability:
        return f"{number}:  {where}; {poses.stable}\N{NO-BREAK SPACE}stable"
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


def _texts(figure: Figure) -> list[Box]:
    """What text covers, in inches."""
    canvas: Any = FigureCanvasAgg(figure)
    renderer: Any = canvas.get_renderer()
    found: list[Box] = []
    for axes in figure.axes:
        axes.get_tightbbox(renderer)  # which makes the numbers at the ticks
    for text in figure.findobj(Text):
        if text.get_text().strip() and text.get_visible():
            box = text.get_window_extent(renderer)
            patch = text.get_bbox_patch()
            box = box if patch is None else patch.get_window_extent(renderer)
            found.append((box.x0 / figure.dpi, box.y0 / figure.dpi, box.x1 / figure.dpi, box.y1 / figure.dpi))
    return found


def _legend_boxes(layout: Layout) -> Iterator[Box]:
    """What the entries of a legend cover, with their marks, and the insets, in inches."""
    for (left, top), part in layout.legend:
        under = top
        for entry in part:
            bottom = under - layout.type.entry_height(entry)
            yield left, bottom, left + layout.type.entry_width(entry), under
            under = bottom
    for left, bottom, wide, high in layout.insets:
        yield left, bottom, left + wide, bottom + high


def _tip(axes: Any, at: Position) -> Position:
    """A point of the map, which is given as fractions of the axes' sides, in inches."""
    width, tall = (float(side) for side in axes.figure.get_size_inches())
    chart = axes.get_position()
    return (chart.x0 + at[0] * chart.width) * width, (chart.y0 + at[1] * chart.height) * tall


def _draw_block(figure: Figure, block: _Block, frame: Frame, slot: _Slot, style: Style) -> None:
    """A point's head and poses."""
    width, tall = (float(side) for side in figure.get_size_inches())
    inches, em = figure.dpi_scale_trans, style.base_font / 72
    left = slot.start(block, frame)
    for k, line in enumerate(block.head):
        figure.text(
            left, slot.top - 1.3 * em * (k + 0.5), line, transform=inches, fontsize=style.base_font, fontweight="bold",
            va="center_baseline", color=INK,
        )  # fmt: skip
    top = slot.top - 1.3 * em * len(block.head)
    mechanism = block.poses.model
    assert isinstance(mechanism, Mechanism)  # others have been refused
    scene = Scene(mechanism, frame, arrow_lengths(block.poses))
    for k, pose in enumerate(block.shown):
        row, column = divmod(k, block.across)
        box = (left + column * frame.width / 72, top - (row + 1) * frame.height / 72, frame.width / 72,
               frame.height / 72)  # fmt: skip
        panel = figure.add_axes((box[0] / width, box[1] / tall, box[2] / width, box[3] / tall))
        panel.set_gid(f"pose-{block.number}-{k + 1}")
        panel.set(xlim=(0, frame.width), ylim=(0, frame.height), xticks=[], yticks=[])
        for spine in panel.spines.values():
            spine.set(color="#b5b5b5", linewidth=0.6)
        draw_sketch(panel, scene.of(pose), STRONG, f"pose-{block.number}-{k + 1}-")


def _lead(figure: Figure, course: Course, number: int, style: Style) -> None:
    """A line to a point of the map, and a mark there."""
    inches, tip = figure.dpi_scale_trans, course[-1]
    for thickness, colour in ((2.2, "white"), (0.8, INK)):
        figure.add_artist(
            Line2D(*zip(*course, strict=True), transform=inches, color=colour, linewidth=thickness, zorder=8,
                   solid_joinstyle="round", gid=f"leader-{number}" if colour == INK else None)
        )  # fmt: skip
    figure.add_artist(
        Line2D((tip[0],), (tip[1],), transform=inches, marker="D", markersize=5.5 * style.base_font / 9,
               markerfacecolor="white", markeredgecolor=INK, markeredgewidth=1.2, linestyle="none", zorder=9,
               gid=f"point-{number}")
    )  # fmt: skip
