"""Two maps and their difference side by side, with one legend below.

Guarantee: every area shown is certified; changes of count are distinguished by colour or hatch.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from matplotlib.figure import Figure

from ptmcad.answer.comparison import Bounds, Change, Comparison
from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.render.axes import symbol
from ptmcad.show.render.chartgrid import Chart, Page, grid_figure, map_entries
from ptmcad.show.render.colours import GREYS, HATCHES, Fill, paint_of, undetermined_fill
from ptmcad.show.render.legend import Entry
from ptmcad.show.render.mappicture import whole_title
from ptmcad.show.render.outline import shapes
from ptmcad.show.style import PictureStyle
from ptmcad.show.table import area_text, count_text
from ptmcad.text.numerals import Numbers, percent, share_text, shortest_text

SIDE = 2.7
"""Inches of a map in 9 points, in a picture that grows with what it shows."""
CHANGES = ("#d55e00", "#0072b2", "#cc79a7", "#009e73", "#f0e442")
"""Of Okabe & Ito, none of which a count has."""
_EQUAL = Fill("#ffffff")
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
    pair, changes = (comparison.first, comparison.second), comparison.changes
    paint, fills = paint_of(style, *pair), _fills(comparison, style)
    regions = comparison.decomposition.regions
    of_cells = {region.cells: fills.get(n, _EQUAL) for n, region in enumerate(regions)}
    bare = replace(
        paint, fill=lambda region: of_cells[region.cells], strong=style.strong / 4, thin_walls=False
    )
    heads = [
        f"{letter}: {own}" if own else letter
        for letter, own in zip(LETTERS, own_words(*pair), strict=True)
    ]
    charts = [Chart(shapes(result), paint, head) for result, head in zip(pair, heads, strict=True)]
    names = {change.region: change_text(comparison, change) for change in changes}
    charts.append(
        Chart(
            shapes(comparison.decomposition),
            bare,
            f"Difference, {' → '.join(LETTERS)}",
            [names.get(n, "") for n in range(len(regions))],
            fills,
        )
    )
    titles = dict.fromkeys(map(whole_title, pair))
    page = Page(
        " and ".join(titles),
        " ".join(difference_words(comparison)),
        [*map_entries(paint, *pair), *_differences(comparison, fills, style)],
        len(charts),
        style.widest,
        style.size[1] if style.size is not None and style.wide is None else None,
        SIDE,
    )
    return grid_figure(charts, page, dpi, style)


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


def _differences(
    comparison: Comparison, fills: Mapping[int, Fill], style: PictureStyle
) -> list[Entry]:
    open_part = _undetermined(comparison)
    where = "where both are determined" if open_part else "everywhere"
    head = f"The counts are the same {where}"
    if comparison.changes:
        area = _area(comparison, comparison.area)
        head = f"Counts differ on {_share(comparison)}, area {area}"
    legend = [Entry((head,), strong=True)]
    for change in comparison.changes:
        words = f"{change_text(comparison, change)}, area {_area(comparison, change.area)}"
        legend.append(Entry((words,), fills[change.region]))
    if open_part:
        words = f"undetermined {open_part}, by one map or both"
        legend.append(Entry((words,), undetermined_fill(style.palette)))
    return legend
