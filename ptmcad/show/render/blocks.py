"""Where poses stand around a map: blocks of them for each point, at its two sides, on a page of
some size.

Guarantee: poses of all points have one scale, and no block overlaps another one or the map. What
has no room is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from math import ceil

from matplotlib.path import Path

from ptmcad.answer.poses import Pose, Poses
from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import counted
from ptmcad.errors import ConfigError
from ptmcad.show.render.inches import wrapped
from ptmcad.show.render.labels import Position
from ptmcad.show.render.posewords import assigned
from ptmcad.show.render.sketch import PanelFrame, frame_of
from ptmcad.show.render.view import Point
from ptmcad.show.style import PAGE_HEIGHT, LegendPlace, PictureStyle, Size

PointPoses = tuple[Point, Poses]
"""A point of the map, in the order of its axes, with the solutions there."""

PANEL, MIN_PANEL = 138.0, 104.0
"""Width of a pose in points, and the least at which its letters have room."""
_TALLEST = 120.0
_MAP = 5.4, 6.9
"""Inches of the map with its legend, in 9 points."""
GAP, _NEAR = 0.16, 0.04
"""Inches around poses, and from them to where their line begins."""
_CROSSING, _STARTS = 100.0, 6
"""What it costs that two lines cross, and steps along a block's edge, at which its line may begin."""
LINE = 1.3
"""Between the lines of a head, in sizes of their type."""
_SHARE = 0.58
"""Of a given width, for the poses."""


@dataclass(frozen=True, slots=True)
class Block:
    """What stands beside the map for a point: a head and below it poses, so many side by side.

    ``frame`` is that of a pose, and ``em`` the size of the text, in inches.
    """

    number: int
    head: Sequence[str]
    poses: Poses
    shown: tuple[Pose, ...]
    across: int
    frame: PanelFrame
    em: float

    @property
    def height(self) -> float:
        """In inches, with the space below."""
        rows = ceil(len(self.shown) / self.across)
        return LINE * self.em * len(self.head) + rows * self.frame.height / 72 + GAP

    @property
    def columns(self) -> int:
        """Poses side by side, or the room of one where there is none."""
        return max(1, min(len(self.shown), self.across))


@dataclass(frozen=True, slots=True)
class Plan:
    """The points' blocks, the numbers of those at the left and at the right of the map, from above,
    and the page: its width and, where it does not grow, its height.
    """

    width: float
    height: float | None
    blocks: Sequence[Block]
    sides: tuple[list[int], list[int]]

    @property
    def taken(self) -> list[float]:
        """Inches that poses take at the left and at the right."""
        most = [max((self.blocks[n].columns for n in side), default=0) for side in self.sides]
        return [_taken(number, self.blocks[0].frame.width) for number in most]

    @property
    def tall(self) -> float:
        """The height that the poses need, in inches."""
        return max(sum(self.blocks[n].height for n in side) for side in self.sides) + 2 * GAP

    def placed(
        self,
        side: int,
        page: float,
        tips: Sequence[Position],
        cost: Callable[[Position, Position], float],
    ) -> list[tuple[Block, Position, Position]]:
        """The blocks at one side of the map from above with their upper left corners and where the lines to their points
        begin; equal spaces between, and the lines as cheap as exchanges of blocks make them.

        Parameters
        ----------
        side : 0 at the left of the map, to which blocks are as near as they can be; 1 at the right.
        page : inches of its height.
        tips : of the lines, by the points' numbers.
        cost : of a line, from its start to its tip.
        """
        order = self.sides[side]
        found = self._with_lines(side, page, order, tips, cost)
        improved = True
        while improved:
            improved = False
            for a, b in combinations(range(len(order)), 2):
                tried = list(order)
                tried[a], tried[b] = tried[b], tried[a]
                other = self._with_lines(side, page, tried, tips, cost)
                if other[0] < found[0] - 1e-9:
                    found, order, improved = other, tried, True
        return found[1]

    def _with_lines(
        self,
        side: int,
        page: float,
        order: Sequence[int],
        tips: Sequence[Position],
        cost: Callable[[Position, Position], float],
    ) -> tuple[float, list[tuple[Block, Position, Position]]]:
        """What is placed in an order, and what the lines cost."""
        width = self.taken[side] - 2 * GAP
        left = self.width - width - GAP if side else GAP
        edge = left - _NEAR if side else left + width + _NEAR
        heights = sum(self.blocks[n].height for n in order)
        free = (page - 2 * GAP - heights) / max(1, len(order))
        top, total = page - GAP, 0.0
        found, lines = [], list[Path]()
        for n in order:
            block, tip = self.blocks[n], tips[n]
            own = block.columns * block.frame.width / 72
            # beside the poses, not beside the head, unless there is nothing else
            low = top - block.height + GAP + _NEAR
            high = top - LINE * block.em * len(block.head) - _NEAR
            if not block.shown:
                low = high = top - LINE / 2 * block.em
            heights_tried = [low + (high - low) * k / _STARTS for k in range(_STARTS + 1)]
            heights_tried.append(min(max(tip[1], low), high))
            least, start = min((cost((edge, at), tip), (edge, at)) for at in heights_tried)
            corner = (left + (0.0 if side else width - own), top)
            found.append((block, corner, start))
            total += least
            lines.append(Path([start, tip]))
            top -= block.height + free
        crossed = sum(a.intersects_path(b, filled=False) for a, b in combinations(lines, 2))
        return total + _CROSSING * crossed, found


def sized(plan: Plan, style: PictureStyle) -> tuple[Size, PictureStyle]:
    """The page's size, and the style of the map between the poses.

    Raises
    ------
    ConfigError
        When the poses are taller than the page.
    """
    inner = plan.width - sum(plan.taken)
    tall = max(_MAP[1] / _MAP[0] * inner, plan.tall)
    if plan.height is not None or style.wide is not None:
        there = PAGE_HEIGHT if plan.height is None else plan.height
        if plan.tall > there:
            raise ConfigError(
                f"poses at {len(plan.blocks)} points need a height of {plan.tall + 0.01:.2f} inches, "
                f"and there are {there:.2f}",
                key="size",
            )
        tall = there if plan.height is not None else min(there, tall)
    legend = style.legend or LegendPlace.BELOW
    return (plan.width, tall), style._replace(
        size=(inner, tall), font_size=style.base_font, legend=legend
    )


def arranged(result: RegionMap, points: Sequence[PointPoses], style: PictureStyle) -> Plan:
    """Half of the points at each side of the map, few all at the right; on a page of a given width
    as fits best.

    Raises
    ------
    ConfigError
        When poses have no room beside the map.
    """
    usual = len(points) // 2 if len(points) > 3 else 0
    most = style.size[1] if style.size is not None else None
    most = PAGE_HEIGHT if style.wide is not None else most
    found: list[Plan] = []
    refused: ConfigError | None = None
    for left in sorted(range(len(points)), key=lambda n: abs(n - usual)):
        try:
            plan = _plan(result, points, _sides([at for at, _ in points], left), style)
        except ConfigError as error:
            refused = refused or error
            continue
        if most is None or plan.tall <= most:
            return plan
        found.append(plan)
    if not found:
        assert refused is not None  # there is at least one point
        raise refused
    return min(found, key=lambda plan: plan.tall)


def _plan(
    result: RegionMap,
    points: Sequence[PointPoses],
    sides: tuple[list[int], list[int]],
    style: PictureStyle,
) -> Plan:
    """The plan with these points at both sides."""
    shown = [poses.working for _, poses in points]
    numbers = [[max(1, len(shown[n])) for n in side] for side in sides]
    width, panel, across = _page(style, numbers)
    every = [pose for own in shown for pose in own]
    frame = PanelFrame(Fraction(1), 0.0, panel)
    if every:
        frame = frame_of(every, panel, min(_TALLEST, 0.9 * panel))
    blocks = []
    for n, (at, poses) in enumerate(points):
        wide = max(min(max(1, len(shown[n])), across) * panel, MIN_PANEL) / 72
        head = wrapped(_head(result, n + 1, at, poses), wide, style.base_font, True)
        blocks.append(Block(n + 1, head, poses, shown[n], across, frame, style.base_font / 72))
    height = None if style.wide is not None or style.size is None else style.size[1]
    return Plan(width, height, blocks, sides)


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


def _page(style: PictureStyle, numbers: Sequence[Sequence[int]]) -> tuple[float, float, int]:
    """The page's width, a panel's in points, and poses side by side, for so many poses at each point
    at the left and at the right: side by side where that has room.
    """
    scale = style.base_font / 9
    largest = max(max(side, default=0) for side in numbers)
    width = style.widest
    if width is None:
        most = [max(side, default=0) for side in numbers]
        return scale * _MAP[0] + sum(_taken(number, PANEL) for number in most), PANEL, largest
    for across in range(largest, 0, -1):
        most = [max((min(number, across) for number in side), default=0) for side in numbers]
        # nearly half of the page is the map's; on a large page the poses do not grow beyond what
        # they need
        gaps = sum(_taken(number, 0.0) for number in most)
        room = (_SHARE * width - gaps) * 72 / sum(most)
        if room >= MIN_PANEL:
            return width, min(room, PANEL * max(1.0, scale)), across
    least = sum(_taken(number, MIN_PANEL) for number in most) / _SHARE
    raise ConfigError(
        f"poses beside the map need a width of {least + 0.01:.2f} inches, and there are {width:.2f}",
        key="size",
    )


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
