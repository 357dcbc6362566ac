"""Two maps and their difference side by side, each with its own legend below.

Guarantee: every area shown is certified; changes of count are distinguished by colour or hatch.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from matplotlib.figure import Figure

from ptmcad.answer.comparison import Bounds, Change, Comparison
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.chartgrid import LINE, Panel, draw_panels
from ptmcad.show.render.colours import GREYS, HATCHES, Fill, Paint, paint_of, undetermined_fill
from ptmcad.show.render.fitting import rewrapped
from ptmcad.show.render.inches import few, wrapped
from ptmcad.show.render.legend import Entry, Type, entries, hidden_entries
from ptmcad.show.render.mappicture import whole_title
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.printing import settings
from ptmcad.show.render.slivers import arrows_of, seen_thin_walls
from ptmcad.show.style import LegendPlace, PictureStyle, Size
from ptmcad.show.table import area_text, count_text
from ptmcad.text.numerals import Numbers, percent, share_text, shortest_text

SIDE = 2.7
"""Inches of a map in 9 points, in a picture that grows with what it shows."""
CHANGES = ("#d55e00", "#0072b2", "#cc79a7", "#009e73", "#f0e442")
"""Of Okabe & Ito, none of which a count has."""
_EQUAL = Fill("#ffffff")
_MAX_HEAD = 3
LETTERS = ("A", "B")
"""Of the two maps, so that a change of counts has a direction: from A to B."""
_MAX_NAMES = 3


def traced(result: RegionMap) -> None:
    """Make ready what the picture takes of a map.

    Raises
    ------
    ValueError, IndexError, ArithmeticError
        When the map contradicts itself.
    """
    seen = shapes(result)
    seen.polygons()
    deque(seen.walls(), maxlen=0)


def difference_words(comparison: Comparison) -> list[str]:
    """The areas of all changes, and of each kind, as sentences."""
    open_part = _undetermined(comparison)
    if not comparison.changes:
        where = f" where both are determined; {open_part} is not" if open_part else ""
        return [f"The maps have the same counts everywhere{where}."]
    lines = [
        f"The counts differ on an area of {_area(comparison, comparison.area)}, {_share(comparison)} of the window."
    ]
    lines += [
        f"{change_text(comparison, c)}: area {_area(comparison, c.area)}."
        for c in comparison.changes
    ]
    return lines + ([f"One map or both leave {open_part} undetermined."] if open_part else [])


def _area(comparison: Comparison, bounds: Bounds) -> str:
    return area_text(comparison.decomposition, bounds)


def _share(comparison: Comparison) -> str:
    """How much of the window is different."""
    return share_text(comparison.share, comparison.undetermined is not None)


def _undetermined(comparison: Comparison) -> str:
    """How much of the window is undetermined; empty of exact maps."""
    return percent(comparison.decomposition.undetermined) if comparison.undetermined else ""


def change_text(comparison: Comparison, change: Change) -> str:
    """Such as ``2 → 1``."""
    count = comparison.first.slice.count
    before = count_text(comparison.first.regions[change.before], count)
    return f"{before} → {count_text(comparison.second.regions[change.after], count)}"


def comparison_figure(comparison: Comparison, dpi: int, style: PictureStyle) -> Figure:
    """The picture.

    Raises
    ------
    ConfigError
        When it does not fit into the style's size.
    """
    em = style.base_font / 72
    width = style.widest if style.widest is not None else 3 * (SIDE * style.base_font / 9 + 6 * em)
    side, given = width / 3 - 5.5 * em, style.size if style.wide is None else None
    with settings(style):
        panels = _panels(comparison, style, (side, given[1] / 2 if given else side), dpi)
        foot = max(Type.of(style).height(panel.legend) for panel in panels) + 0.2
        heads = LINE * em * max(len(panel.head) for panel in panels)
        size = given or (width, side + foot + heads + 4.5 * em)
        figure = Figure(figsize=size, dpi=dpi, facecolor="white", layout="constrained")
        draw_panels(figure, panels, 3, (0.0, foot), style, shared=False)
    title = f"{whole_title(comparison.first)} and {whole_title(comparison.second)}"
    figure.set_label(f"{title}\n{' '.join(difference_words(comparison))}")
    return figure


def _panels(comparison: Comparison, style: PictureStyle, sides: Size, dpi: int) -> list[Panel]:
    """The two maps and the difference, with text as wide as they are."""
    type, side = Type.of(style), sides[0]

    def panel(
        title: str, legend: Iterable[Entry], names: Sequence[str] | None, **drawn: Any
    ) -> Panel:
        marks, hidden = arrows_of(drawn["seen"], sides, dpi, type.detail, names)
        below = [rewrapped(entry, side, type) for entry in (*legend, *hidden_entries(hidden))]
        if style.legend is LegendPlace.NONE:
            below = []
        head = few(wrapped(title, side, type.head, True), _MAX_HEAD)
        return Panel(head=head, legend=below, arrows=marks, **drawn)

    found = []
    pair = (comparison.first, comparison.second)
    for letter, own, result in zip(LETTERS, own_words(*pair), pair, strict=True):
        seen = shapes(result)
        thin = seen_thin_walls(seen, (72 * sides[0], 72 * sides[1]))
        paint = replace(paint_of(style, result), thin_walls=thin)
        title = whole_title(result) if style.title is None else own
        legend = entries(result, thin, paint)
        named = f"{letter}: {title}" if title else letter
        found.append(panel(named, legend, None, seen=seen, paint=paint))
    fills = _fills(comparison, style)
    decomposition = comparison.decomposition
    of_cells = {
        region.cells: fills.get(n, _EQUAL) for n, region in enumerate(decomposition.regions)
    }
    strong = style.strong / 4
    bare = Paint(
        lambda region: of_cells[region.cells],
        undetermined_fill(style.palette),
        strong,
        strong,
        thin_walls=False,
    )
    names = [""] * len(decomposition.regions)
    for change in comparison.changes:
        names[change.region] = change_text(comparison, change)
    title, changes = f"Difference, {' → '.join(LETTERS)}", _differences(comparison, style)
    whole = shapes(decomposition)
    return [*found, panel(title, changes, names, seen=whole, paint=bare, outlined=fills)]


def own_words(first: RegionMap, second: RegionMap) -> tuple[str, str]:
    """What each of two maps has and the other has not, in few words: parameters of other values;
    else their names.
    """
    both = [
        {
            name: value.constant()
            for name, value in result.slice.parameters.items()
            if value.is_constant
        }
        for result in (first, second)
    ]
    other = [name for name in both[0] if name in both[1] and both[0][name] != both[1][name]]
    if 0 < len(other) <= _MAX_NAMES:
        return _assignments(both[0], other), _assignments(both[1], other)
    names = first.slice.name, second.slice.name
    return names if names[0] != names[1] else ("", "")


def _assignments(values: Numbers, names: Sequence[str]) -> str:
    """Such as ``F₃ = F₄ = −40, k = 100``."""
    equal: dict[Fraction, list[str]] = {}
    for name in names:
        equal.setdefault(values[name], []).append(symbol(name))
    return ", ".join(
        " = ".join((*symbols, shortest_text(value).replace("-", "−")))
        for value, symbols in equal.items()
    )


def _fills(comparison: Comparison, style: PictureStyle) -> dict[int, Fill]:
    """Of each change, by the number of its region; others are white."""
    faces = GREYS[2:] if style.palette == "grey" else CHANGES
    found: dict[int, Fill] = {}
    for n, change in enumerate(comparison.changes):
        rounds, step = divmod(n, len(faces))
        found[change.region] = Fill(
            faces[step], HATCHES[(rounds - 1) % len(HATCHES)] if rounds else ""
        )
    return found


def _differences(comparison: Comparison, style: PictureStyle) -> list[Entry]:
    fills, open_part = _fills(comparison, style), _undetermined(comparison)
    if comparison.changes:
        area = _area(comparison, comparison.area)
        legend = [Entry((f"Counts differ on {_share(comparison)}", f"area {area}"), strong=True)]
    else:
        where = "where both are determined" if open_part else "everywhere"
        legend = [Entry(("The counts are the same", where), strong=True)]
    for change in comparison.changes:
        area = _area(comparison, change.area)
        legend.append(
            Entry((change_text(comparison, change), f"area {area}"), fills[change.region])
        )
    if open_part:
        legend.append(
            Entry(
                (f"undetermined {open_part}", "by one map or both"),
                undetermined_fill(style.palette),
            )
        )
    return legend
