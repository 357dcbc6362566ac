"""Where poses stand around a map: blocks of them for each point, at its two sides, on a page of
some size.

Guarantee: poses of all points have one scale, and no block overlaps another one or the map. What
has no room is refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import counted
from ptmcad.errors import ConfigError
from ptmcad.show.render.clearance import Position
from ptmcad.show.render.leaders import Berth, Order
from ptmcad.show.render.poses import assigned
from ptmcad.show.render.sketch import PanelFrame, frame_of
from ptmcad.show.render.textwidth import wrapped
from ptmcad.show.render.view import Point
from ptmcad.show.style import PAGE_HEIGHT, LegendPlace, PictureStyle

PointPoses = tuple[Point, Poses]
"""A point of the map, in the order of its axes, with the solutions there."""

PANEL, MIN_PANEL = 138.0, 104.0
"""Width of a pose in points, and the least at which its letters have room."""
_TALLEST = 120.0
_MAP = 5.4, 6.9
"""Inches of the map with its legend, in 9 points."""
GAP, _NEAR, _GUTTER = 0.16, 0.04, 0.11
"""Inches around poses, and from them to where their line begins and where it may bend."""
_SHARE = 0.58
"""Of a given width, for the poses."""


@dataclass(frozen=True, slots=True)
class Block:
    """What stands beside the map for a point: a head and below it poses, so many side by side."""

    number: int
    at: Point
    head: Sequence[str]
    poses: Poses
    shown: tuple[Pose, ...]
    across: int

    def height(self, frame: PanelFrame, em: float) -> float:
        """In inches, with the space below."""
        rows = ceil(len(self.shown) / self.across)
        return len(self.head) * 1.3 * em + rows * frame.height / 72 + GAP

    def width(self, frame: PanelFrame) -> float:
        return max(1, min(len(self.shown), self.across)) * frame.width / 72


@dataclass(frozen=True, slots=True)
class Slot:
    """Where a block stands, in inches: left end, top and width; ``before`` at the left of the map."""

    left: float
    top: float
    width: float
    before: bool

    def start(self, block: Block, frame: PanelFrame) -> float:
        """The block's left end: blocks stand as near to the map as they can."""
        return self.left + (self.width - block.width(frame) if self.before else 0.0)

    def berth(self, block: Block, frame: PanelFrame, em: float) -> Berth:
        """Where the line to the block's point may begin."""
        edge, towards = (self.left + self.width, 1.0) if self.before else (self.left, -1.0)
        low = self.top - block.height(frame, em) + GAP + _NEAR
        # not beside the head, unless there is nothing else
        high = self.top - 1.3 * em * len(block.head) - _NEAR
        if not block.shown:
            low = high = self.top - 0.65 * em
        return Berth(edge + towards * _NEAR, low, high, edge + towards * _GUTTER)


@dataclass(frozen=True, slots=True)
class _PosePage:
    """A page's width and, where it does not grow, its height; a panel's width in points, and how
    many side by side.
    """

    width: float
    height: float | None
    panel: float
    across: int


@dataclass(frozen=True, slots=True)
class Plan:
    """The points' blocks, and the numbers of those at the left and at the right of the map, from
    above.
    """

    page: _PosePage
    frame: PanelFrame
    blocks: Sequence[Block]
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
        return max(heights) + 2 * GAP


def sized(
    plan: Plan, style: PictureStyle, points: int
) -> tuple[Position, list[float], PictureStyle]:
    """The page's size, inches that poses take at the left and at the right, and the style of the
    map between.

    Raises
    ------
    ConfigError
        When the poses are taller than the page.
    """
    page = plan.page
    taken = [_taken(number, page.panel) for number in plan.most]
    width = page.width - sum(taken)
    tall = _height(page, plan.tall(style.base_font / 72), width, style, points)
    inner = style._replace(
        size=(width, tall), font_size=style.base_font, legend=style.legend or LegendPlace.BELOW
    )
    return (page.width, tall), taken, inner


def arranged(result: RegionMap, points: Sequence[PointPoses], style: PictureStyle) -> Plan:
    """Half of the points at each side of the map, few all at the right; on a page of a given width
    as fits best.
    """
    shown = [poses.working for _, poses in points]
    usual = len(points) // 2 if len(points) > 3 else 0
    most = (
        PAGE_HEIGHT if style.wide is not None else style.size[1] if style.size is not None else None
    )
    found: list[tuple[float, Plan]] = []
    refused: ConfigError | None = None
    for left in sorted(range(len(points)), key=lambda n: abs(n - usual)):
        sides = _sides([at for at, _ in points], left)
        try:
            page = _page(style, [[max(1, len(shown[n])) for n in side] for side in sides])
        except ConfigError as error:
            refused = refused or error
            continue
        blocks = []
        for n, (at, poses) in enumerate(points):
            wide = max(min(max(1, len(shown[n])), page.across) * page.panel, MIN_PANEL) / 72
            head = wrapped(_head(result, n + 1, at, poses), wide, style.base_font, True)
            blocks.append(Block(n + 1, at, head, poses, shown[n], page.across))
        every = [pose for own in shown for pose in own]
        frame = PanelFrame(Fraction(1), 0.0, page.panel)
        if every:
            frame = frame_of(every, page.panel, min(_TALLEST, 0.9 * page.panel))
        plan = Plan(page, frame, blocks, sides)
        found.append((plan.tall(style.base_font / 72), plan))
        if most is None or found[-1][0] <= most:
            return plan
    if not found:
        assert refused is not None  # there is at least one point
        raise refused
    return min(found, key=lambda each: each[0])[1]


@dataclass(frozen=True, slots=True)
class BlockColumn:
    """The blocks at one side of the map, from the slot at the top downwards on a page of some
    height.
    """

    blocks: Sequence[Block]
    first: Slot
    frame: PanelFrame
    em: float
    page: float

    def placed(self, order: Order) -> Iterator[tuple[Block, Slot]]:
        """In this order, with equal spaces between."""
        heights = [block.height(self.frame, self.em) for block in self.blocks]
        free = (self.page - 2 * GAP - sum(heights)) / max(1, len(heights))
        slot = self.first
        for n in order:
            yield self.blocks[n], slot
            slot = replace(slot, top=slot.top - heights[n] - free)

    def berths(self, order: Order) -> list[Berth]:
        return [slot.berth(block, self.frame, self.em) for block, slot in self.placed(order)]


def _sides(points: Sequence[Point], left: int) -> tuple[list[int], list[int]]:
    """Numbers of the points at the left of the map, which are so many, and at the right, from
    above.
    """
    order = sorted(range(len(points)), key=lambda n: points[n][0])
    before, after = (
        sorted(part, key=lambda n: -points[n][1]) for part in (order[:left], order[left:])
    )
    return before, after


def _taken(number: int, panel: float) -> float:
    """Inches that so many poses side by side take beside the map, in panels of a width in points."""
    return number * panel / 72 + 2 * GAP if number else 0.0


def _page(style: PictureStyle, numbers: Sequence[Sequence[int]]) -> _PosePage:
    """The page for so many poses at each point at the left and at the right: side by side where
    that has room.
    """
    scale = style.base_font / 9
    largest = max(max(side, default=0) for side in numbers)
    width = style.widest
    if width is None:
        most = [max(side, default=0) for side in numbers]
        return _PosePage(
            scale * _MAP[0] + sum(_taken(number, PANEL) for number in most), None, PANEL, largest
        )
    for across in range(largest, 0, -1):
        most = [max((min(number, across) for number in side), default=0) for side in numbers]
        # nearly half of the page is the map's; on a large page the poses do not grow beyond what
        # they need
        gaps = sum(_taken(number, 0.0) for number in most)
        room = (_SHARE * width - gaps) * 72 / sum(most)
        if room >= MIN_PANEL:
            height = None if style.wide is not None or style.size is None else style.size[1]
            return _PosePage(width, height, min(room, PANEL * max(1.0, scale)), across)
    least = sum(_taken(number, MIN_PANEL) for number in most) / _SHARE
    raise ConfigError(
        f"poses beside the map need a width of {least + 0.01:.2f} inches, and there are {width:.2f}",
        key="size",
    )


def _height(page: _PosePage, tall: float, inner: float, style: PictureStyle, points: int) -> float:
    """Of the page, whose poses are so tall and whose map is so wide with its numbers."""
    natural = max(_MAP[1] / _MAP[0] * inner, tall)
    if page.height is None and style.wide is None:
        return natural
    there = PAGE_HEIGHT if page.height is None else page.height
    if tall > there:
        raise ConfigError(
            f"poses at {points} points need a height of {tall + 0.01:.2f} inches, and there are {there:.2f}",
            key="size",
        )
    return there if page.height is not None else min(there, natural)


def _head(result: RegionMap, number: int, at: Point, poses: Poses) -> str:
    where = ", ".join(
        assigned(axis.name, value) for axis, value in zip(result.slice.axes, at, strict=True)
    )
    stable = poses.known_stable
    what = (
        counted(poses.model, len(poses.equilibria))
        if stable is None
        else f"{stable}\N{NO-BREAK SPACE}stable"
    )
    return f"{number}:  {where}; {what}"
