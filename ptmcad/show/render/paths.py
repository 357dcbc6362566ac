"""Pictures of the paths of poses: each followed pose along an axis, where it ends, and to which
pose it snaps.

Guarantee and what is not guaranteed: as of `ptmcad.show.render.ranges`.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

from matplotlib.figure import Figure

from ptmcad.answer.paths import Fate, PathPoint, PosePaths, Target
from ptmcad.answer.words import followed
from ptmcad.question.slice import Slice
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.colours import INK
from ptmcad.show.render.legend import Entry, line_mark, point_mark
from ptmcad.show.render.printing import settings
from ptmcad.show.render.rangeplate import EACH, LOOKS, middle_of, panelled, scaled, short
from ptmcad.show.units import unit_of_unknown, with_unit

_MARKERS = {
    Fate.SNAP: "o",
    Fate.MERGE: "s",
    Fate.VANISH: "x",
    Fate.UNSTABLE: "x",
    Fate.EXCLUDED: "x",
}
"""Where a path ends within the window."""


def draw_paths(slice: Slice, found: PosePaths, further: Sequence[Entry] = ()) -> Figure:
    """The unknowns of each followed pose along the axis, a panel for each; an arrow shows each
    snap.

    ``further`` are the legend's last entries, of what is going to be added.
    """
    model = found.model
    what = model.nouns.pose
    entries = [Entry((f"{followed(model)}s",), strong=True)]
    for k, path in enumerate(found.paths):
        words = f"{what} {path.number} at {symbol(found.along.name)} = {short(found.start)}"
        entries.append(Entry((words,), line_mark(_look(k))))
    ends = {
        "o": (f"a {what} vanishes (ring), with a", "snap to another one (arrow)"),
        "s": (f"the {what} goes on (square),", "without a snap"),
        "x": (f"a {what} ends (cross)",),
    }
    occurring = {_MARKERS.get(end.fate) for path in found.paths for end in (path.low, path.high)}
    for marker, lines in ends.items():
        if marker in occurring:
            entries.append(
                Entry(lines, point_mark(color=INK, marker=marker, fillstyle="none", markersize=6))
            )
    entries += further
    unknowns = model.sorted_unknowns
    names = [
        with_unit(symbol(name), unit_of_unknown(model, name, slice.units)) for name in unknowns
    ]
    kind = "Unknowns" if model.reals else "Angles"
    words = f"{kind} of {len(found.paths)} {followed(model)}s along {found.along.name}."
    with settings():
        figure, panels = panelled(slice, found, names, entries, words)
        for number, axes in enumerate(panels):
            for k, path in enumerate(found.paths):
                look = _look(k)
                colour = look["color"]
                xs = [scaled(p.value, found.along) for p in path.points]
                axes.plot(xs, [_angle(p, number) for p in path.points], **look)
                for end in (path.low, path.high):
                    if end.fate not in _MARKERS:
                        continue
                    x, y = scaled(end.last.value, found.along), _angle(end.last, number)
                    axes.plot(
                        [x], [y], _MARKERS[end.fate], color=colour, fillstyle="none", markersize=6
                    )
                    if end.fate is Fate.SNAP and end.target is not None:
                        tip = (scaled(middle_of(end.at), found.along), _angle(end.target, number))
                        axes.annotate("", tip, (x, y), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.0,
                                                                   "shrinkA": 4, "shrinkB": 1})  # fmt: skip
            axes.axhline(0, color=INK, linewidth=0.4)
    return figure


def _look(number: int) -> dict[str, Any]:
    return LOOKS["stable"] | {"color": EACH[number % len(EACH)]}


def _angle(point: PathPoint | Target, number: int) -> float:
    if number < len(point.angles):
        return degrees(float(point.angles[number]))
    return float(point.reals[number - len(point.angles)])
