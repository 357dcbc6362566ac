"""The pictures of a motion: the map with the moving point, the mechanism, and the energy of the
followed pose.

Guarantee: all pictures of a motion have one scale, and fixed points of the mechanism stand still. A
picture of a fall says that it shows no equilibrium. What does not move is drawn once.

Not guaranteed: anything that only the pictures show. They are drawn in floating point.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from math import degrees, remainder
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ptmcad.answer.motion import Motion, Step
from ptmcad.answer.words import assignments, counted, noun
from ptmcad.errors import ConfigError
from ptmcad.model import Mechanism
from ptmcad.model.work import loads_at
from ptmcad.show.drawable import no_drawing
from ptmcad.show.render.axes import Dress, dress, symbol
from ptmcad.show.render.colours import INK, paint_of
from ptmcad.show.render.inches import axes_at, text_width, write
from ptmcad.show.render.labels import Label, Position
from ptmcad.show.render.legend import Entry, Rows, Type, count_entries, draw_rows, head_of, in_rows
from ptmcad.show.render.mappicture import whole_title
from ptmcad.show.render.mechanism import PALE, STRONG, draw_sketch
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.painting import paint_map
from ptmcad.show.render.sketch import Sketch, arrows_of, components, sketched
from ptmcad.show.render.view import Point, View
from ptmcad.show.style import PictureStyle, Size
from ptmcad.text.expressions import values_at

SIZE = (9.0, 5.1)
MIN_SIZE = (6.5, 3.4)
"""Inches in which all parts have room."""
LEFT, RIGHT, GAP, TOP, BOTTOM, LINE = 0.72, 0.15, 0.42, 0.62, 0.55, 0.19
"""Inches: at the map's left, the rim, between the parts, above them, below the map, a line of the
legend.
"""
CURVE, MIN_PANEL = 0.21, 1.4
"""The energy's chart, against the height, where so many inches are left for the mechanism."""
RIM = 27.0
"""Points around the mechanism, for supports, loads and labels."""
TURNS = 9
"""Of a spring, at any length: it is one and the same in all pictures."""
GLIDE = 4
"""Steps before and after, over which a label's place is averaged."""
SIZES = (10.0, 8.5, 7.5)
"""In points: the title, other text, numbers at the axes."""
TYPE = Type(SIZES[1], SIZES[1])
"""Of the legend."""
FALLING = "#a4133c"
FOLLOWED, STABLE, UNSTABLE = "#111111", "#3d6b8c", "#bdbdbd"

Pixels = NDArray[np.uint8]


class Stage:
    """The pictures of a motion, one for each of its steps; to be used within `printing.settings`.

    Raises
    ------
    ConfigError
        For a system, which has no points to be drawn, and for a size that is too small.
    """

    def __init__(self, motion: Motion, style: PictureStyle, dpi: int):
        model = motion.result.slice.model
        if model.drawable is None:
            raise ConfigError(no_drawing(model))
        self.motion, self.mechanism = motion, model.drawable
        size = style.size or SIZE
        if size[0] < MIN_SIZE[0] or size[1] < MIN_SIZE[1]:
            raise ConfigError(
                f"a film needs at least {MIN_SIZE[0]:g}x{MIN_SIZE[1]:g}in", key="size"
            )
        self.figure = Figure(figsize=size, dpi=dpi, facecolor="white")
        canvas: Any = FigureCanvasAgg(self.figure)
        self.canvas = canvas
        width, tall = size
        title = whole_title(motion.result) if style.title is None else style.title
        for line in textwrap.wrap(title, int(11 * width), max_lines=1, placeholder=" …"):
            self._text((LEFT, tall - 0.2), line, SIZES[0])
        top = tall - (TOP if title else TOP - 0.28)
        key = _key(motion, style, width - LEFT - RIGHT)
        foot = BOTTOM + LINE * len(key)
        side = min(0.5 * width - LEFT, top - foot)
        self.chart = axes_at(self.figure, (LEFT, top - side, side, side), "map")
        self._map(style)
        draw_rows(self.figure, key, (LEFT, foot - BOTTOM + 0.04), LINE, TYPE)
        self._right(LEFT + side + GAP, top, foot)
        self.where = (LEFT, top + 0.13)
        self.sketches = _sketches(motion, self.mechanism, self.sides)
        self.canvas.draw()
        self.background = self.canvas.copy_from_bbox(self.figure.bbox)

    def _right(self, left: float, top: float, foot: float) -> None:
        """The mechanism and, where there is an energy and room for it, its chart below."""
        width, tall = (float(side) for side in self.figure.get_size_inches())
        wide, chart = width - left - RIGHT, CURVE * tall
        has_energy = all(step.height is not None for step in self.motion.steps)
        curved = has_energy and top - foot - chart - 0.55 >= MIN_PANEL
        low = foot + chart + 0.55 if curved else foot
        sides = (wide * 72, (top - low) * 72)
        self.panel = axes_at(self.figure, (left, low, wide, top - low), "mechanism")
        self.panel.set(xlim=(0, sides[0]), ylim=(0, sides[1]), xticks=[], yticks=[])
        self.sides = sides
        self.above, self.below = (left, top + 0.13), (left, low - 0.15)
        self.curve: Any = None
        if curved:
            self.curve = axes_at(self.figure, (left + 0.35, foot, wide - 0.35, chart), "energy")
            self._energy()

    def frame(self, number: int) -> Pixels:
        """The picture of a step as an array of red, green and blue, shape (height, width, 3)."""
        self.canvas.restore_region(self.background)
        for artists in self._moving(number):
            for artist in sorted(artists, key=lambda a: a.get_zorder()):
                artist.draw(self.canvas.get_renderer())
            for artist in artists:
                artist.remove()
        return np.asarray(self.canvas.buffer_rgba())[..., :3].copy()

    def _moving(self, number: int) -> Iterator[list[Any]]:
        """What is drawn for a step, one after the other."""
        motion = self.motion
        step = motion.steps[number]
        yield self._point(number)
        before = set(self.panel.get_children())
        if step.falling:
            begun = next(
                k for k in range(number, -1, -1) if k == 0 or not motion.steps[k - 1].falling
            )
            draw_sketch(self.panel, replace(self.sketches[begun], labels=()), PALE, "")
            yield [a for a in self.panel.get_children() if a not in before]
        draw_sketch(self.panel, self.sketches[number], STRONG, "")
        yield [a for a in self.panel.get_children() if a not in before]
        if self.curve is not None:
            yield self._marble(number)
        yield list(self._said(step))

    def _point(self, number: int) -> list[Any]:
        """The way so far, and the point."""
        steps = self.motion.steps[: number + 1]
        view = View.whole(self.motion.result)
        places = [view.approximate_position(step.at) for step in steps]
        colour = FALLING if steps[-1].falling else FOLLOWED
        marker = {
            "markersize": 9,
            "markerfacecolor": "white",
            "markeredgecolor": colour,
            "markeredgewidth": 2.2,
        }
        return _trail(self.chart, places, 7, marker, linewidth=2.0, transform=self.chart.transAxes)

    def _marble(self, number: int) -> list[Any]:
        """The followed pose's energy so far, and where it is."""
        steps = self.motion.steps[: number + 1]
        places = [(100 * step.share, step.height) for step in steps]
        face = FALLING if steps[-1].falling else "white"
        marker = {"markersize": 7, "markerfacecolor": face, "markeredgecolor": INK}
        return _trail(self.curve, places, 4, marker, linewidth=1.4)

    def _said(self, step: Step) -> Iterator[Any]:
        """Where the point is, what is drawn, and its unknowns."""
        names, model = self.motion.result.slice.axis_names, self.mechanism
        where = ",  ".join(
            f"{symbol(n)} = {float(v):.4g}" for n, v in zip(names, step.at, strict=True)
        ).replace("-", "−")
        yield self._text(self.where, where, SIZES[1])
        if step.falling:
            what = "the pose has vanished: steepest descent, no equilibrium"
        elif step.total is not None:
            stable = f", {step.stable} stable" if step.stable is not None else ""
            what = f"one of exactly {counted(model, step.total)}{stable}"
        elif step.stable is not None:
            what = f"equilibrium; exactly {step.stable} stable here"
        else:
            what = "equilibrium; the number of all is not known here"
        wide = self.sides[0] / 72
        size = min(SIZES[1], SIZES[1] * wide / text_width(what, SIZES[1]))
        yield self._text(self.above, what, size, FALLING if step.falling else INK)
        turns = len(model.angles)
        angles = (f"{remainder(degrees(angle), 360):.1f}°" for angle in step.unknowns[:turns])
        texts = assignments(model, angles, (f"{x:.4g}" for x in step.unknowns[turns:]), symbol)
        yield self._text(self.below, ",  ".join(texts).replace("-", "−"), SIZES[1])

    def _map(self, style: PictureStyle) -> None:
        result = self.motion.result
        whole = shapes(result)
        paint_map(self.chart, whole, "", paint_of(style, result))
        dress(
            self.chart, result.slice, whole.view.x, whole.view.y, Dress(SIZES[2], SIZES[1], (6, 6))
        )
        xs, ys = zip(*map(whole.view.approximate_position, self.motion.path), strict=True)
        self.chart.plot(
            xs, ys, color=INK, linewidth=0.9, linestyle=(0, (4, 2)), transform=self.chart.transAxes, zorder=6
        )  # fmt: skip

    def _energy(self) -> None:
        """The chart's frame, and behind the followed pose all equilibria whose energy lies in it."""
        steps, axes = self.motion.steps, self.curve
        heights = [step.height for step in steps if step.height is not None]
        low, high = min(heights), max(heights)
        room = 0.1 * (high - low) or 0.1 * abs(high) or 1.0
        which = f"all {noun(self.mechanism)}"
        for wanted, colour in ((False, UNSTABLE), (True, STABLE)):
            dots = [(100 * s.share, h) for s in steps for h, stable in s.others if stable == wanted]
            inside = [(x, h) for x, h in dots if low - room < h < high + room]
            if len(inside) < len(dots):
                which = f"{noun(self.mechanism)} within the frame"
            if inside:
                axes.plot(
                    *zip(*inside, strict=True), "o", markersize=1.6, color=colour, zorder=2 + wanted
                )
        axes.set(xlim=(0, 100), ylim=(low - room, high + room))
        from matplotlib.ticker import MaxNLocator

        axes.yaxis.set_major_locator(MaxNLocator(nbins=3))
        axes.tick_params(labelsize=SIZES[2], length=2.5)
        axes.set_xlabel("% of the path", fontsize=SIZES[1], labelpad=1)
        axes.set_ylabel("energy", fontsize=SIZES[1], labelpad=2)
        if any(s.others for s in steps):
            axes.set_title(
                f"dots: {which}, stable ones blue", fontsize=SIZES[2], loc="right", pad=2
            )

    def _text(self, at: Position, text: str, size: float, colour: str = INK) -> Any:
        return write(self.figure, at, text, size, color=colour)


def _trail(
    axes: Any, places: Sequence[Any], zorder: int, marker: dict[str, Any], **look: Any
) -> list[Any]:
    """A line through places, and a marker on the last."""
    xs, ys = zip(*places, strict=True)
    look |= {"color": FOLLOWED, "solid_capstyle": "round"}
    line = axes.plot(xs, ys, zorder=zorder, **look)
    marker |= {"marker": "o", "linestyle": "none", "zorder": zorder + 1, "clip_on": False}
    return [*line, *axes.plot(xs[-1:], ys[-1:], **(look | marker))]


def _places(motion: Motion, mechanism: Mechanism, sides: Size) -> Iterator[dict[str, Position]]:
    """The points on paper at each step: one scale for all steps, and their middle in the middle."""
    places = np.array([step.points for step in motion.steps])
    low, high = places.min(axis=(0, 1)), places.max(axis=(0, 1))
    paper, wide = np.array(sides), high > low
    room = np.maximum(paper - 2 * RIM, 10.0)
    k = (room[wide] / (high - low)[wide]).min() if wide.any() else 1.0
    for step in k * (places - (low + high) / 2) + paper / 2:
        yield {name: (x, y) for name, (x, y) in zip(mechanism.points, step.tolist(), strict=True)}


def _sketches(motion: Motion, mechanism: Mechanism, sides: Size) -> list[Sketch]:
    """The mechanism at each step; labels keep their side while they can, and glide where they
    cannot: they stand at the mean of where they would in the steps around, and no lines lead to them.
    """
    arrows, sketches = _arrows(motion, mechanism), list[Sketch]()
    ways: list[dict[str, Position]] = [{}]
    for step, nodes in zip(motion.steps, _places(motion, mechanism, sides), strict=True):
        seen = sketched(mechanism, nodes, sides, arrows[step.at], TURNS, ways[-1])
        sketches.append(seen)
        ways.append({p.text: (p.center[0] - p.at[0], p.center[1] - p.at[1]) for p in seen.labels})

    def glided(placed: Label, number: int) -> Label:
        near = ways[max(1, number - GLIDE + 1) : number + GLIDE + 2]
        x, y = (sum(way[placed.text][k] for way in near) / len(near) for k in (0, 1))
        center = (placed.at[0] + x, placed.at[1] + y)
        return replace(placed, center=center, leader=None)

    return [
        replace(seen, labels=tuple(glided(placed, k) for placed in seen.labels))
        for k, seen in enumerate(sketches)
    ]


def _arrows(motion: Motion, mechanism: Mechanism) -> dict[Point, dict[str, float]]:
    """For each point the lengths of its loads' arrows, in proportion to the largest load of the
    motion.
    """
    parameters = motion.result.slice.parameters
    forces = {
        at: components(loads_at(mechanism, values_at(parameters, *at)))
        for at in {step.at for step in motion.steps}
    }
    largest = max(
        (abs(force) for own in forces.values() for force in own.values()), default=Fraction(0)
    )
    return {at: arrows_of(own, largest) for at, own in forces.items()}


def _key(motion: Motion, style: PictureStyle, width: float) -> Rows:
    """The legend in rows: each entry with its distance from the left, in inches."""
    result = motion.result
    entries = [Entry((head_of(result.slice)[0],)), *count_entries(paint_of(style, result), result)]
    return in_rows(entries, width + 0.2, TYPE)
