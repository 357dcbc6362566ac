"""A sweep as one HTML page: all maps on a sheet, sliders, and areas, ranges and optima against what
is swept.

Guarantee: the page needs no network and no other file. Whatever a record, an error or a result says
stands in it as text; its policy allows this page's own script and style and nothing else. The same
sweep gives the same text.

Not guaranteed: all maps of a sweep with more than `MAX_MAPS` members. Then members at equal
distances are shown, and the page says so.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from html import escape
from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.sweep import Member, State, Sweep
from ptmcad.show.render.axes import heading_of, named, symbol
from ptmcad.show.render.colours import UNDETERMINED, Fill, fill_of
from ptmcad.show.render.outline import shapes
from ptmcad.show.render.polylines import GRID
from ptmcad.show.report.mapsvg import outline_data, paints, pattern_defs, shortened
from ptmcad.show.report.reportpage import asset, harmless, policy_of, template
from ptmcad.show.report.sections import swatch
from ptmcad.show.sweeptable import counts_in, middle
from ptmcad.show.table import count_text, in_order
from ptmcad.text.numerals import fraction_of
from ptmcad.version import __version__

SCRIPTS = ("theme.js", "atlas.js")
MAX_MAPS = 1024
"""Maps of a page."""
_MAX_ERROR = 200


SheetFrame = tuple[tuple[tuple[str, str, str], ...], str, str]
"""What all maps of a sweep have in common: the axes' names and windows as texts, a heading, and what
is counted.
"""


def chosen(sweep: Sweep) -> Sequence[int]:
    """The numbers of the members on the page."""
    every = -(-len(sweep) // MAX_MAPS)
    return range(0, len(sweep), every)


def atlas(
    sweep: Sweep, frame: SheetFrame, members: Sequence[Member], sketches: Mapping[int, Thumbnail]
) -> str:
    """The whole page as HTML text.

    Parameters
    ----------
    members : those on the page, by their numbers.
    sketches : the drawings of those that have a result.
    """
    axes, heading, counted = frame
    style = asset("page.css") + asset("atlas.css")
    script = "".join(asset(name) for name in SCRIPTS)
    fills = {fill for s in sketches.values() for fill in (s.plate, *(fill for fill, _ in s.paths))}
    values = {
        name: _sorted({member.parameters[name] for member in members}) for name in sweep.names
    }
    columns = len(values[sweep.names[-1]]) if _is_table(values, members) else 0
    return template("atlas.html").substitute(
        policy=escape(policy_of(style, script)),
        title=escape(heading or sweep.name),
        name=escape(sweep.name),
        banner="".join(_banners(sweep, members)),
        patterns=pattern_defs(sorted(fills, key=lambda fill: (fill.face, fill.hatch))),
        across=escape(_axis(*axes[0])),
        up=escape(_axis(*axes[1])),
        sheet="".join(_cell(sweep, member, sketches.get(member.number)) for member in members),
        side=str(SIDE),
        legend="".join(_legend(sketches.values(), counted)),
        order=escape(_order(sweep, columns)),
        version=escape(__version__),
        data=harmless(_data(sweep, frame, members, values, columns)),
        style=style,
        script=script,
    )


def _is_table(values: Mapping[str, Sequence[str]], members: Sequence[Member]) -> bool:
    """Whether two parameters are swept in all combinations, so that the sheet has a row for each
    value of the first.
    """
    if len(values) != 2:
        return False
    first, second = values.values()
    return (
        len(first) * len(second)
        == len({tuple(m.parameters.values()) for m in members})
        == len(members)
    )


def _order(sweep: Sweep, columns: int) -> str:
    if columns:
        return f"A row for each value of {symbol(sweep.names[0])}, a column for each of {symbol(sweep.names[1])}."
    return f"In the order of the sweep over {', '.join(map(symbol, sweep.names))}."


def _sorted(values: Iterable[str]) -> list[str]:
    return sorted(values, key=fraction_of)


def _axis(name: str, low: str, high: str) -> str:
    return f"{symbol(name)} from {low} to {high}"


def _banners(sweep: Sweep, members: Sequence[Member]) -> Iterator[str]:
    missing = [
        f"{number} {state.value}"
        for state, number in sweep.states.items()
        if state is not State.DONE
    ]
    if missing:
        yield f'<p class="banner">Of {len(sweep)} members {escape(", ".join(missing))}: these have no map.</p>'
    if len(members) < len(sweep):
        every = members[1].number - members[0].number if len(members) > 1 else len(sweep)
        yield f'<p class="banner">The page shows one of {every} members; the index has all {len(sweep)}.</p>'


def _cell(sweep: Sweep, member: Member, sketch: Thumbnail | None) -> str:
    """One map of the sheet, as a button."""
    label = ", ".join(
        f"{symbol(n)} = {shortened(fraction_of(member.parameters[n]))}" for n in sweep.names
    )
    if sketch is None:
        return (
            f'<button type="button" class="small none" data-m="{member.number}" aria-label="{escape(label)}: '
            f'{escape(member.state.value)}"></button>'
        )
    layers = ((sketch.plate, f"M0 0H{SIDE}V{SIDE}H0z"), *sketch.paths)
    drawn = [f'<path fill="{p}" d="{data}"/>' for fill, data in layers for p in paints(fill)]
    return (
        f'<button type="button" class="small" data-m="{member.number}" aria-label="{escape(label)}">'
        f'<svg viewBox="0 0 {SIDE} {SIDE}" aria-hidden="true">{"".join(drawn)}</svg></button>'
    )


def _legend(sketches: Collection[Thumbnail], counted: str) -> Iterator[str]:
    """The fills of all counts that occur, in the order of the counts, and that of what is
    undetermined.
    """
    found = {text: fill for each in sketches for text, fill in each.legend}
    shown = [(f"{counted}: {text}", found[text]) for text in sorted(found, key=in_order)]
    if any(each.plate == UNDETERMINED for each in sketches):
        shown.append(("undetermined", UNDETERMINED))
    for text, fill in shown:
        yield f"<li>{swatch(fill)}{escape(text)}</li>"


def _data(
    sweep: Sweep,
    frame: SheetFrame,
    members: Sequence[Member],
    values: Mapping[str, Sequence[str]],
    columns: int,
) -> dict[str, Any]:
    """What the script shows."""
    places = {name: {value: k for k, value in enumerate(found)} for name, found in values.items()}
    counts = counts_in(members)
    along = next((m.summary.widest.along for m in members if m.summary and m.summary.widest), "")
    over = next((name for name, _, _ in frame[0] if name != along), "")
    return {
        "columns": columns,
        "counted": frame[2],
        "along": symbol(along),
        "over": symbol(over),
        "axes": [{"name": symbol(name), "low": low, "high": high} for name, low, high in frame[0]],
        "swept": [
            {
                "name": symbol(name),
                "texts": list(map(shortened, found)),
                "values": list(map(float, found)),
            }
            for name, found in (
                (name, list(map(fraction_of, texts))) for name, texts in values.items()
            )
        ],
        "counts": counts,
        "members": [_member_data(sweep, m, places, counts) for m in members],
    }


def _member_data(
    sweep: Sweep, member: Member, places: Mapping[str, Mapping[str, int]], counts: Sequence[str]
) -> dict[str, Any]:
    found = member.summary
    data: dict[str, Any] = {
        "n": member.number,
        "p": [places[n][member.parameters[n]] for n in sweep.names],
    }
    if found is None:
        return data | {"e": f"{member.state.value}: {member.error}"[:_MAX_ERROR]}
    areas = {area.count: area for area in found.areas}
    data["a"] = [
        _rounded(middle(areas[c].area)) if c in areas and areas[c].area[0] else _absent(areas, c)
        for c in counts
    ]
    data["r"] = found.regions
    data["f"] = member.file
    if found.widest is not None and found.widest.width is not None:
        data["w"] = _rounded(middle(found.widest.width))
        data["s"] = found.widest.proof
        data["at"] = [
            sorted({_rounded(fraction_of(end)) for end in place})
            for place in found.widest.places[:4]
        ]
    return data


def _absent(areas: Mapping[str, Any], count: str) -> float | None:
    """The area of a count that no region has is zero; that of one whose areas were left out is not
    known.
    """
    return None if count in areas else 0.0


def _rounded(value: Fraction) -> float:
    return float(f"{float(value):.6g}")


def frame_of(sweep: Sweep, slice: Any, sketches: Iterable[Thumbnail]) -> SheetFrame:
    """What the maps have in common, from the slice of one of them and the drawings of all on the
    page.
    """
    axes = tuple((a.name, shortened(a.low), shortened(a.high)) for a in slice.axes)
    common = set[str](slice.fixed).intersection(*(sketch.fixed for sketch in sketches))
    fixed = [
        part
        for part in slice.fixed
        if part in common and part.partition(" = ")[0] not in sweep.names
    ]
    heading = (
        heading_of(slice)
        if slice.title
        else ", ".join(named(part, slice.parameters) for part in fixed)
    )
    return axes, heading, slice.count.value


SIDE = 800
"""Steps of the drawing's grid along a side of the window."""
TOLERANCE = 1 / 1600
MAX_CHARACTERS = 6000
"""Of one drawing; coarser outlines are taken for a map that needs more."""


@dataclass(frozen=True, slots=True)
class Thumbnail:
    """What is painted: the plate's fill, and over it fills with the data of their SVG paths.

    Attributes
    ----------
    legend : the counts that occur, as text, with their fills.
    fixed : what is fixed in the map's slice, in words.
    """

    plate: Fill
    paths: tuple[tuple[Fill, str], ...]
    legend: tuple[tuple[str, Fill], ...]
    fixed: tuple[str, ...] = ()


def sketch(result: RegionMap) -> Thumbnail:
    """The drawing of a map.

    Raises
    ------
    ValueError, IndexError, ArithmeticError
        When the map contradicts itself.
    """
    seen = shapes(result)
    largest = max(range(len(result.regions)), key=lambda k: result.regions[k].area, default=None)
    plate = UNDETERMINED
    if result.cover is None and largest is not None:
        plate = fill_of(result.regions[largest], result.slice.count)
    count = result.slice.count
    legend = {count_text(region, count): fill_of(region, count) for region in result.regions}
    for factor in (1, 3, 9):
        paths: dict[Fill, str] = {}
        for region, polygons in zip(result.regions, seen.polygons(factor * TOLERANCE), strict=True):
            fill = fill_of(region, count)
            if fill != plate:
                data = outline_data(polygons, SIDE / GRID)
                paths[fill] = paths.get(fill, "") + data
        drawn = Thumbnail(plate, tuple(paths.items()), tuple(legend.items()), result.slice.fixed)
        if sum(map(len, paths.values())) <= MAX_CHARACTERS:
            break
    return drawn
