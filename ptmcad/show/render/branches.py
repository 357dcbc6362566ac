"""A bifurcation diagram: quantities of all solutions along a line, stable branches solid and the
others broken.

Guarantee: as of `ptmcad.show.render.ranges`; lines join what is next to each other, which is no
claim.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from matplotlib.figure import Figure

from ptmcad.answer.branches import Branch, Branches
from ptmcad.answer.paths import PosePaths
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.branches import kind
from ptmcad.show.render.axes import with_symbols
from ptmcad.show.render.colours import INK
from ptmcad.show.render.legend import Entry, line_mark
from ptmcad.show.render.paths import draw_paths
from ptmcad.show.render.printing import settings
from ptmcad.show.render.rangeplate import LOOKS, panelled, scaled
from ptmcad.show.units import with_unit

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
            for branch in sorted(
                found.branches, key=lambda b: bool(b.stable)
            ):  # the stable ones on top
                look = _look(kind(branch, found.model))
                for xs, ys in _strokes(branch, number, found):
                    axes.plot(xs, ys, **look)
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
        for branch in others:
            for xs, ys in _strokes(branch, number, found):
                figure.axes[number].plot(
                    xs, ys, zorder=1.5, **(_look(kind(branch, found.model)) | _BEHIND)
                )
    return figure


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
