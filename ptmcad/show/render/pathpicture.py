"""Pictures of solutions along a line: the paths of poses, where each one ends and to which it snaps,
and bifurcation diagrams, in which stable branches are solid and the others broken.

Guarantee and what is not guaranteed: as of `ptmcad.show.render.rangepicture`. Lines join what is
next to each other, which is no claim.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees
from typing import Any

from matplotlib.figure import Figure

from ptmcad.answer.paths import Branch, Branches, Fate, PathPoint, PosePaths, Target
from ptmcad.answer.words import followed
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.pathtable import kind
from ptmcad.show.render.axes import symbol, with_symbols
from ptmcad.show.render.colours import INK
from ptmcad.show.render.legend import Entry, line_mark, point_mark
from ptmcad.show.render.printing import settings
from ptmcad.show.render.rangepicture import EACH, LOOKS, middle_of, panelled, scaled, short
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
        entries.append(Entry((words,), line_mark(_look_of_path(k))))
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
                look = _look_of_path(k)
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


def _look_of_path(number: int) -> dict[str, Any]:
    return LOOKS["stable"] | {"color": EACH[number % len(EACH)]}


def _angle(point: PathPoint | Target, number: int) -> float:
    if number < len(point.angles):
        return degrees(float(point.angles[number]))
    return float(point.reals[number - len(point.angles)])


_OTHER: dict[str, Any] = {"color": INK, "linewidth": 1.4, "linestyle": "-"}
_BEHIND: dict[str, Any] = {"color": "#8a8a8a", "linewidth": 0.9}
"""What changes where others are in front."""
_TURN = 180
"""Degrees by which an angle of two neighbouring points differs only where it comes round."""


def draw_branches(slice: Slice, found: Branches) -> Figure:
    """A panel for each quantity."""
    kinds = list(dict.fromkeys(kind(b, found.model) for b in found.branches))
    kinds.sort(key=_rank)
    entries = (
        Entry(("branches",), strong=True),
        *(Entry((name,), line_mark(_look(name))) for name in kinds),
    )
    shown = (with_symbols(name.replace(":", " ")) for name in found.quantities)
    names = [with_unit(*pair) for pair in zip(shown, found.units, strict=True)]
    words = f"{', '.join(found.quantities)} of all solutions along {found.along.name}: {', '.join(kinds)}."
    with settings():
        figure, panels = panelled(slice, found, names, entries, words)
        for number, axes in enumerate(panels):
            # the stable ones on top
            _draw(axes, number, found, sorted(found.branches, key=lambda b: bool(b.stable)))
    return figure


def draw_paths_and_branches(slice: Slice, paths: PosePaths, found: Branches) -> Figure:
    """The paths of poses, and behind them the branches that no path follows; ``found`` has the
    unknowns, in order.
    """
    others = [
        branch
        for branch in found.branches
        if branch.stable is False or _is_left(branch, paths, found)
    ]
    kinds = sorted({kind(branch, found.model) for branch in others}, key=_rank)
    further = [
        Entry((f"{name}, not followed",), line_mark(_look(name) | _BEHIND)) for name in kinds
    ]
    figure = draw_paths(slice, paths, further)
    for number in range(len(found.quantities)):
        _draw(figure.axes[number], number, found, others, zorder=1.5, **_BEHIND)
    return figure


def _draw(axes: Any, number: int, found: Branches, branches: Sequence[Branch], **look: Any) -> None:
    """A quantity along branches, in the looks of their kinds but for one of its own."""
    for branch in branches:
        for xs, ys in _strokes(branch, number, found):
            axes.plot(xs, ys, **(_look(kind(branch, found.model)) | look))


def _is_left(branch: Branch, paths: PosePaths, found: Branches) -> bool:
    """Whether not all stable branches beside this stable one are followed: the paths are drawn over
    those that are.
    """
    middle = branch.points[len(branch.points) // 2].value
    ranges = [(b.points[0].value, b.points[-1].value) for b in found.branches if b.stable]
    followed = [(path.points[0].value, path.points[-1].value) for path in paths.paths]
    number, known = (sum(low <= middle <= high for low, high in r) for r in (ranges, followed))
    return branch.stable is True and number > known


def _strokes(
    branch: Branch, number: int, found: Branches
) -> Iterator[tuple[list[float], list[float]]]:
    """The line of a quantity, cut where it has none, and where an angle comes round."""
    turns = found.quantities[number].removeprefix("angle:") in found.model.angles
    xs: list[float] = []
    ys: list[float] = []
    for point in branch.points:
        value = point.numbers[number]
        y = None if value is None else float(value)
        x = scaled(point.value, found.along)
        if xs and y is None:
            yield xs, ys
            xs, ys = [], []
        elif xs and y is not None and turns and abs(y - ys[-1]) > _TURN:
            # it leaves at one edge and comes in at the other
            edge = _TURN if ys[-1] > 0 else -_TURN
            before, after = abs(edge - ys[-1]), abs(edge + y)
            between = xs[-1] + (x - xs[-1]) * before / max(before + after, 1e-300)
            yield [*xs, between], [*ys, edge]
            xs, ys = [between], [-edge]
        if y is not None:
            xs.append(x)
            ys.append(y)
    if xs:
        yield xs, ys


def _look(name: str) -> dict[str, Any]:
    return LOOKS.get(name, _OTHER)


def _rank(name: str) -> int:
    return list(LOOKS).index(name) if name in LOOKS else len(LOOKS)
