"""Pictures of the paths of poses: each followed pose along an axis, where it ends, and to which pose it snaps.

Guarantee and what is not guaranteed: as of `ptmcad.show.render.ranges`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import degrees
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ptmcad.answer.paths import Fate, PathEnd, PathPoint, PosePaths, Target
from ptmcad.model import Mechanism
from ptmcad.question.slice import Slice
from ptmcad.show.render.axes import heading_of, scale_of, symbol
from ptmcad.show.render.legend import INK, Entry, draw_legend, height, width
from ptmcad.show.render.printing import settings
from ptmcad.show.render.rangeplate import (
    EACH,
    LEFT,
    LOOKS,
    RIGHT,
    SIZE,
    WIDE,
    axes_in,
    axis_name,
    beside,
    scaled,
    short,
)
from ptmcad.show.units import unit_of_unknown, with_unit

_LOST = (Fate.VANISH, Fate.UNSTABLE, Fate.EXCLUDED)


def draw_paths(slice: Slice, found: PosePaths, further: Sequence[Entry] = ()) -> Figure:
    """The unknowns of each followed pose along the axis, a panel for each; an arrow shows each snap.

    ``further`` are the legend's last entries, of what is going to be added.
    """
    fixed = ", ".join(f"{symbol(n)} = {short(v)}" for n, v in found.at.items())
    heading = f"{heading_of(slice)}; {fixed}"
    model = found.model
    what = "pose" if isinstance(model, Mechanism) else "solution"
    stable = "stable " * model.tells_stability
    entries = [Entry((f"{stable}{what}s",), strong=True)]
    for k, path in enumerate(found.paths):
        entries.append(Entry((f"{what} {path.number} at {symbol(found.along.name)} = {short(found.start)}",), _line(k)))
    if any(e.fate is Fate.SNAP for p in found.paths for e in (p.low, p.high)):
        entries.append(Entry((f"a {what} vanishes (ring), with a", "snap to another one (arrow)"), _snap_mark))
    if any(e.fate is Fate.MERGE for p in found.paths for e in (p.low, p.high)):
        entries.append(Entry((f"the {what} goes on (square),", "without a snap"), _merge_mark))
    if any(e.fate in _LOST for p in found.paths for e in (p.low, p.high)):
        entries.append(Entry((f"a {what} ends (cross)",), _loss_mark))
    entries += further
    panel, foot = 2.0, 0.55
    names = (*model.angles, *model.reals)
    last = len(names) - 1
    tall = len(names) * panel + 0.25 * last + foot
    spare = max(0.0, height(tuple(entries)) + 0.2 - tall)
    tall += spare
    kind = "Unknowns" if model.reals else "Angles"
    words = f"{kind} of {len(found.paths)} {stable}{what}s along {found.along.name}."
    with settings():
        figure = beside(heading, width(entries), tall, words)
        scale = scale_of(found.along.low, found.along.high)
        for number, name in enumerate(names):
            axes = axes_in(figure, (LEFT, foot + spare + (last - number) * (panel + 0.25), WIDE, panel))
            for k, path in enumerate(found.paths):
                look = _look(k)
                colour = look["color"]
                xs = [scaled(p.value, found.along) for p in path.points]
                axes.plot(xs, [_angle(p, number) for p in path.points], **look)
                for end in (path.low, path.high):
                    if end.fate in (Fate.WINDOW, Fate.UNDECIDED):
                        continue
                    x, y = scaled(end.last.value, found.along), _angle(end.last, number)
                    marker = {Fate.SNAP: "o", Fate.MERGE: "s"}.get(end.fate, "x")
                    axes.plot([x], [y], marker, color=colour, fillstyle="none", markersize=6)
                    if end.fate is Fate.SNAP and end.target is not None:
                        tip = (scaled(_middle(end), found.along), _angle(end.target, number))
                        axes.annotate("", tip, (x, y), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.0,
                                                                   "shrinkA": 4, "shrinkB": 1})  # fmt: skip
            axes.axhline(0, color=INK, linewidth=0.4)
            axes.set_xlim(scale.low, scale.high)
            axes.margins(y=0.08)
            axes.tick_params(labelsize=SIZE, labelbottom=number == last)
            axes.set_ylabel(with_unit(symbol(name), unit_of_unknown(slice, name)), fontsize=SIZE + 2)
            if number == last:
                axes.set_xlabel(axis_name(slice, found.along), fontsize=SIZE + 2, labelpad=2)
        draw_legend(figure, tuple(entries), LEFT + WIDE + RIGHT, tall - 0.05)
    return figure


def _look(number: int) -> dict[str, Any]:
    return LOOKS["stable"] | {"color": EACH[number % len(EACH)]}


def _line(number: int) -> Any:
    def mark(figure: Any, left: float, middle: float) -> None:
        line = Line2D((left, left + 0.28), (middle, middle), transform=figure.dpi_scale_trans, **_look(number))
        figure.add_artist(line)

    return mark


def _snap_mark(figure: Any, left: float, middle: float) -> None:
    _marker(figure, left, middle, "o")


def _merge_mark(figure: Any, left: float, middle: float) -> None:
    _marker(figure, left, middle, "s")


def _loss_mark(figure: Any, left: float, middle: float) -> None:
    _marker(figure, left, middle, "x")


def _marker(figure: Any, left: float, middle: float, marker: str) -> None:
    figure.add_artist(Line2D((left + 0.14,), (middle,), transform=figure.dpi_scale_trans, color=INK, marker=marker,
                             fillstyle="none", markersize=6))  # fmt: skip


def _middle(end: PathEnd) -> Fraction:
    at = end.at
    return at if isinstance(at, Fraction) else (at.low + at.high) / 2


def _angle(point: PathPoint | Target, number: int) -> float:
    if number < len(point.angles):
        return degrees(float(point.angles[number]))
    return float(point.reals[number - len(point.angles)])
