"""Pictures of solutions along a line: the paths of poses, where each one ends and to which it snaps,
and bifurcation diagrams, in which stable branches are solid and the others broken.

Guarantee and what is not guaranteed: as of `ptmcad.show.render.rangepicture`. Lines join what is
next to each other, which is no claim; they break where an angle comes round.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ptmcad.answer.paths import Branch, Branches, Fate, PathPoint, PosePaths, Target
from ptmcad.answer.words import followed
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.pathtable import kind
from ptmcad.show.render.axes import symbol, with_symbols
from ptmcad.show.render.colours import INK
from ptmcad.show.render.legend import Entry, line_mark, point_mark
from ptmcad.show.render.panels import SIZE, heading, panels, scaled, short, unit_along
from ptmcad.show.render.printing import settings
from ptmcad.show.render.view import Floats
from ptmcad.show.units import unit_of_unknown, with_unit

_PANEL = 2.0
"""Inches."""
_LOOKS: dict[str, dict[str, Any]] = {
    "stable": {"color": "#0b5394", "linewidth": 2.0, "linestyle": "-"},
    "saddle": {"color": "#b45f06", "linewidth": 1.2, "linestyle": (0, (5, 2))},
    "unstable": {"color": "#b45f06", "linewidth": 1.2, "linestyle": (0, (5, 2))},
    "maximum": {"color": "#666666", "linewidth": 1.2, "linestyle": (0, (1, 1.5))},
}
"""Lines of solutions, by what these are called: stable ones are solid, and no others are."""
_OTHER: dict[str, Any] = {"color": INK, "linewidth": 1.4, "linestyle": "-"}
_BEHIND: dict[str, Any] = {"color": "#8a8a8a", "linewidth": 0.9}
"""What changes where others are in front."""
_EACH = ("#0b5394", "#2a9d8f", "#741b47", "#7d9be0", "#274e13", "#c27ba0")
"""Of stable solutions that are distinguished from each other; no other kind has one of these colours.
"""
_MARKERS = {
    Fate.SNAP: "o",
    Fate.MERGE: "s",
    Fate.VANISH: "x",
    Fate.UNSTABLE: "x",
    Fate.EXCLUDED: "x",
}
"""Where a path ends within the window."""


def _panelled(
    slice: Slice,
    found: PosePaths | Branches,
    names: Sequence[tuple[str, str]],
    entries: Sequence[Entry],
    words: str,
) -> tuple[Figure, list[Any]]:
    """A panel for each name with its unit."""
    figure, column = panels(
        heading(slice, found.at),
        words,
        found.along,
        unit_along(slice, found.along),
        [_PANEL] * len(names),
        legend=entries,
    )
    for axes, name in zip(column, names, strict=True):
        axes.set_ylabel(with_unit(*name), fontsize=SIZE + 2)
    return figure, column


def draw_paths(slice: Slice, found: PosePaths, further: Sequence[Entry] = ()) -> Figure:
    """The unknowns of each followed pose along the axis, a panel for each; an arrow shows each
    snap.

    ``further`` are the legend's last entries, of what is going to be added.
    """
    model, along = found.model, found.along
    what = model.nouns.pose
    looks = [
        _LOOKS["stable"] | {"color": _EACH[number % len(_EACH)]}
        for number in range(len(found.paths))
    ]
    entries = [Entry((f"{followed(model)}s",), strong=True)]
    for path, look in zip(found.paths, looks, strict=True):
        words = f"{what} {path.number} at {symbol(along.name)} = {short(found.start)}"
        entries.append(Entry((words,), line_mark(look)))
    ends = {
        "o": (f"a {what} vanishes (ring), with a", "snap to another one (arrow)"),
        "s": (f"the {what} goes on (square),", "without a snap"),
        "x": (f"a {what} ends (cross)",),
    }
    mark: dict[str, Any] = {"fillstyle": "none", "markersize": 6}
    occurring = {_MARKERS.get(end.fate) for path in found.paths for end in (path.low, path.high)}
    entries += [
        Entry(lines, point_mark(color=INK, marker=marker, **mark))
        for marker, lines in ends.items()
        if marker in occurring
    ]
    unknowns = model.sorted_unknowns
    names = [(symbol(name), unit_of_unknown(model, name, slice.units)) for name in unknowns]
    kind = "Unknowns" if model.reals else "Angles"
    words = f"{kind} of {len(found.paths)} {followed(model)}s along {along.name}."
    with settings():
        figure, column = _panelled(slice, found, names, [*entries, *further], words)
        for path, look in zip(found.paths, looks, strict=True):
            rows = np.transpose([_unknowns(point) for point in path.points])
            xs = [scaled(point.value, along) for point in path.points]
            for axes, row in zip(column, rows, strict=True):
                axes.plot(xs, row, **look)
            for end in (path.low, path.high):
                if end.fate not in _MARKERS:
                    continue
                x, last = scaled(end.last.value, along), _unknowns(end.last)
                for axes, y in zip(column, last, strict=True):
                    axes.plot(x, y, _MARKERS[end.fate], color=look["color"], **mark)
                if end.fate is Fate.SNAP and end.target is not None:
                    arrow = {"arrowstyle": "-|>", "color": look["color"], "lw": 1.0, "shrinkA": 4, "shrinkB": 1}  # fmt: skip
                    tip = scaled(end.at, along)
                    for axes, y, fallen in zip(column, last, _unknowns(end.target), strict=True):
                        axes.annotate("", (tip, fallen), (x, y), arrowprops=arrow)
        for axes in column:
            axes.axhline(0, color=INK, linewidth=0.4)
    return figure


def _unknowns(point: PathPoint | Target) -> list[float]:
    """Angles in degrees."""
    return [*(degrees(float(angle)) for angle in point.angles), *map(float, point.reals)]


_TURN = 180
"""Degrees by which an angle of two neighbouring points differs only where it comes round."""


def draw_branches(slice: Slice, found: Branches) -> Figure:
    """A panel for each quantity."""
    kinds = _kinds(found, found.branches)
    entries = (
        Entry(("branches",), strong=True),
        *(Entry((name,), line_mark(_look(name))) for name in kinds),
    )
    shown = (with_symbols(name.replace(":", " ")) for name in found.quantities)
    names = list(zip(shown, found.units, strict=True))
    words = f"{', '.join(found.quantities)} of all solutions along {found.along.name}: {', '.join(kinds)}."
    with settings():
        figure, column = _panelled(slice, found, names, entries, words)
        # the stable ones on top
        _draw(column, found, sorted(found.branches, key=lambda b: bool(b.stable)))
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
    further = [
        Entry((f"{name}, not followed",), line_mark(_look(name) | _BEHIND))
        for name in _kinds(found, others)
    ]
    figure = draw_paths(slice, paths, further)
    _draw(figure.axes, found, others, zorder=1.5, **_BEHIND)
    return figure


def _draw(column: Sequence[Any], found: Branches, branches: Sequence[Branch], **look: Any) -> None:
    """The quantities along branches, in the looks of their kinds but for one of its own."""
    for branch in branches:
        xs = [scaled(point.value, found.along) for point in branch.points]
        rows = zip(*(point.numbers for point in branch.points), strict=True)
        for axes, name, row in zip(column, found.quantities, rows, strict=True):
            values = np.array([np.nan if value is None else float(value) for value in row])
            turns = name.removeprefix("angle:") in found.model.angles
            axes.plot(*_broken(xs, values, turns), **(_look(kind(branch, found.model)) | look))


def _broken(xs: Sequence[float], values: Floats, turns: bool) -> tuple[Floats, Floats]:
    """A line with a gap where an angle comes round."""
    gaps = np.flatnonzero(turns & (np.abs(np.diff(values)) > _TURN)) + 1
    return np.insert(xs, gaps, np.nan), np.insert(values, gaps, np.nan)


def _is_left(branch: Branch, paths: PosePaths, found: Branches) -> bool:
    """Whether not all stable branches beside this stable one are followed: the paths are drawn over
    those that are.
    """
    middle = branch.points[len(branch.points) // 2].value
    ranges = [(b.points[0].value, b.points[-1].value) for b in found.branches if b.stable]
    followed = [(path.points[0].value, path.points[-1].value) for path in paths.paths]
    number, known = (sum(low <= middle <= high for low, high in r) for r in (ranges, followed))
    return branch.stable is True and number > known


def _kinds(found: Branches, branches: Sequence[Branch]) -> list[str]:
    """What branches are, those with looks of their own first."""
    kinds = {kind(branch, found.model): None for branch in branches}
    return [*(name for name in _LOOKS if name in kinds), *(n for n in kinds if n not in _LOOKS)]


def _look(name: str) -> dict[str, Any]:
    return _LOOKS.get(name, _OTHER)
