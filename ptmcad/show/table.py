"""Rows and lists as lines of text; the five-line table of a region map for the terminal, and those of
a family and its changes: a line for each member, and for each change.

Guarantee: areas are certified; the digits of an exact value of a change are right, the ends of an
enclosure are rounded outwards.
"""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from ptmcad.answer.counts import counted_by, key_text
from ptmcad.answer.regionmap import COMPILATION, Region, RegionMap
from ptmcad.answer.words import count_words, noun, several
from ptmcad.question.counts import Count
from ptmcad.show.units import area_unit
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.numerals import (
    Bounds,
    between,
    certified_digits,
    interval_text,
    magnitude,
    percent,
    shortest_text,
)

if TYPE_CHECKING:  # most maps are in no family
    from ptmcad.answer.family import Change, Changes, FamilyMap


WIDTH = 100
"""Characters of a line."""


def aligned(rows: Sequence[Sequence[str]], right: int = 0) -> list[str]:
    """Rows as lines with columns of equal width; so many of them, from the left, end where their
    longest entry does.
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    sides = [str.rjust] * right + [str.ljust] * (len(widths) - right)
    lines = (zip(sides, row, widths, strict=True) for row in rows)
    return ["  ".join(side(text, width) for side, text, width in line).rstrip() for line in lines]


def wrapped(label: str, parts: Sequence[str], separator: str = ", ") -> list[str]:
    """The parts after a label, on as many lines as they need; no part is broken."""
    whole = separator.join(part.replace(" ", "\0") for part in parts)
    lines = textwrap.wrap(
        whole, WIDTH, initial_indent=f"{label:8}", subsequent_indent=" " * 8, break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip
    return [line.replace("\0", " ") for line in lines]


def count_text(region: Region, count: Count) -> str:
    """The count by which regions are distinguished, as text."""
    return key_text(counted_by(region, count))


def index_text(numbers: Iterable[int]) -> str:
    """A count by index as text."""
    return f"({', '.join(map(str, numbers))})"


def in_order(text: str) -> list[int]:
    """A count's numbers, by which counts are in order: 10 comes after 2."""
    return [int(number) for number in re.findall(r"\d+", text)]


def area_text(result: RegionMap, bounds: Bounds) -> str:
    """An area as it is printed everywhere: one number of an exact map, both bounds of a certified
    one, and its unit.
    """
    known = area_unit(result.slice)
    return f"{area_digits(result, bounds)} {known}" if known else area_digits(result, bounds)


def area_digits(result: RegionMap, bounds: Bounds) -> str:
    """The same without the unit."""
    return certified_digits(bounds) if result.cover is None else interval_text(bounds)


NOT_COMPUTED = "not computed"
"""What is said of areas that are not known, which then all have the window's as their upper bound.
"""


def areas_are_known(result: RegionMap) -> bool:
    """Whether areas were computed: of an exact map that leaves them out, or is not as far, none has
    a lower bound.
    """
    return result.cover is not None or any(region.area[0] for region in result.regions)


def region_area(result: RegionMap, number: int) -> str:
    """The area of one region, as the legend and the table have it where no other one has its count."""
    return (
        area_text(result, result.regions[number].area) if areas_are_known(result) else NOT_COMPUTED
    )


def areas_by_key(result: RegionMap) -> dict[tuple[int, ...], tuple[int, Bounds]]:
    """The number of regions of each count, in increasing order, and bounds of their areas' sum."""
    areas: dict[tuple[int, ...], list[Bounds]] = {}
    for region in result.regions:
        areas.setdefault(counted_by(region, result.slice.count), []).append(region.area)
    return {
        key: (
            len(own),
            (sum((a for a, _ in own), Fraction(0)), sum((b for _, b in own), Fraction(0))),
        )
        for key, own in sorted(areas.items())
    }


def area_by_count(result: RegionMap) -> dict[str, Bounds]:
    """Bounds of the area of the regions with each count, by the count's text.

    What is undetermined is a part of several bounds of a certified map, but in their sum once.
    """
    undetermined = result.undetermined * result.slice.area
    return {
        key_text(key): (low, high if result.cover is None else min(high, low + undetermined))
        for key, (_, (low, high)) in areas_by_key(result).items()
    }


def _short(value: Fraction) -> str:
    """A number, not negative, in two digits, of any size."""
    return (
        "0.0e+00"
        if value == 0
        else f"{float(value):.1e}"
        if abs(magnitude(value)) < 300
        else f"1e{magnitude(value)}"
    )


def _curves(result: RegionMap) -> str:
    """The boundary curves with their degrees, or the size of the cover."""
    if result.cover is not None:
        rectangles = several(len(result.cover.rectangles), "rectangle")
        return f"cover     {rectangles} around the curves where counts change"
    names = result.slice.axis_names
    alike = Counter(
        (c.kind.value, c.polynomial.degrees, len(c.polynomial.terms))
        for c in result.components
        if c.separates
    )
    curves = "; ".join(
        f"{n} {kind} of degree {degrees[0]} in {names[0]}, {degrees[1]} in {names[1]} ({several(terms, 'term')})"
        for (kind, degrees, terms), n in alike.items()
    )
    lines = [f"curves    {curves or 'no curve changes the count'}"]
    many = noun(result.slice.model)
    lines += [
        f"continua  {found.value} {many} where {result.components[n].polynomial.text(names)} = 0"
        for n, found in result.continua.items()
    ]
    return "\n".join(lines)


def _time(result: RegionMap) -> str:
    """How long it took; what a machine does once, in its first run, is given separately."""
    seconds, once = result.timings.get("total"), result.timings.get(COMPILATION, 0.0)
    if seconds is None:
        return "not recorded"
    total = f"{seconds + once:.2f} s" if seconds + once < 10 else f"{seconds + once:.1f} s"
    return f"{total}, of which {once:.0f} s compilation (once)" if round(once) else total


def table(result: RegionMap) -> str:
    """Regions, counts, areas, boundary curves with degrees (or the cover), time and error."""
    count, model = result.slice.count, result.slice.model
    tally = Counter(
        f"{count_text(r, count)} {count_words(count.kind.tail, model, r.total or 0)}"
        for r in result.regions
    )
    counts = "; ".join(
        f"{text}: {several(n, 'region')}"
        for text, n in sorted(tally.items(), key=lambda item: in_order(item[0]))
    )
    bounds = [(count_text(r, count), r.area) for r in result.regions]
    if result.cover is not None:
        bounds = list(area_by_count(result).items())
    areas = "; ".join(f"{text}: {area_text(result, area)}" for text, area in bounds)
    missing = bool(result.regions) and not areas_are_known(result)
    if missing:
        areas = NOT_COMPUTED
    widths = [(high - low) / low for _, (low, high) in bounds if low]
    known = (
        widths and len(widths) == len(bounds) and min(widths) >= 0
    )  # a damaged file may say anything
    error = _short(max(widths)) if known else "unknown"
    bound = "no area bounds" if missing else f"area bounds within {error}"
    if result.cover is not None and bounds:
        # relative to a region that is hardly larger than its border a width says nothing
        bound = f"area bounds at most {_short(max(high - low for _, (low, high) in bounds))} apart"
    # nothing is misclassified by either engine, see docs/error.md
    wrong = (
        f"{percent(result.undetermined)} undetermined"
        if result.undetermined
        else "nothing undetermined"
    )
    return "\n".join(
        [
            f"regions   {len(result.regions)} of {len(result.cells)} cells, {result.status.value}",
            f"counts    {counts or 'none yet'}",
            f"areas     {areas or 'none yet'}",
            *(f"stable    {words}" for words in [stability_in_words(result)] if words),
            _curves(result),
            *_vanishing(result),
            f"time      {_time(result)}; {wrong}; {bound}",
        ]
    )


def stability_in_words(result: RegionMap) -> str:
    """Of how many solutions are stable where a certified map does not say it of its cells; empty
    where there is none.

    Where all solutions are counted, no curve is enclosed across which one of them loses its
    stability.
    """
    criterion = result.slice.model.criterion
    if result.slice.count.is_of_stable or result.cover is None or not result.cells:
        return ""
    found = set()
    for cell in result.cells:
        stable = [criterion.is_stable(solution.signs) for solution in cell.solutions]
        if stable and None not in stable:
            found.add(f"{criterion.number(stable)} of {len(stable)}")
    at = f"at the samples {', '.join(sorted(found))}; " if found else ""
    return criterion.may_vary and at + criterion.may_vary


def _vanishing(result: RegionMap) -> list[str]:
    """Where a condition for stability is zero all over a cell, as a solution is not stable there."""
    cells = sum(any("0" in e.signs for e in cell.solutions) for cell in result.cells)
    if not cells:
        return []
    return [
        f"zero      in {several(cells, 'cell')} a condition for stability is 0 at a solution, which counts as unstable"
    ]


def family_table(family: FamilyMap) -> str:
    """Value of the free parameter, regions, cells and areas of each member, and the surfaces."""
    rows = [[family.free.name, "regions", "cells", "areas by count"]]
    for value, result in family:
        numbers = map(str, map(len, (result.regions, result.cells)))
        rows.append([shortest_text(value), *numbers, _areas(result)])
    lines = aligned(rows, right=3)
    if family.surfaces:
        sizes = ", ".join(
            f"{several(len(terms), 'term')} of degree {max(sum(powers) for powers, _ in terms)}"
            for terms in family.surfaces
        )
        many = "surfaces" if len(family.surfaces) > 1 else "surface"
        lines.append(f"computed once for all: {many} where solutions meet, {sizes}")
    if family.changes is not None:
        lines.append(changes_table(family.changes))
    return "\n".join(lines)


def _areas(result: RegionMap) -> str:
    known = area_by_count(result)
    if known and not areas_are_known(result):
        return f"{NOT_COMPUTED}; counts {', '.join(known)}"
    return "; ".join(f"{count}: {area_text(result, bounds)}" for count, bounds in known.items())


_DIGITS = 10
_OTHERS = 8
"""Values at which nothing changes that are listed; more are counted."""


def changes_table(found: Changes) -> str:
    """Value, how it is known, and what changes, line by line; then what is known of completeness."""
    free = found.free
    title = f"changes of the arrangement for {free.name} between {shortest_text(free.low)} and {shortest_text(free.high)}"
    rows = [
        ["", *(("", "") if number else (value_text(change), _kind(change))), text]
        for change in found
        for number, text in enumerate(change.words)
    ]
    lines = [f"{title}: {len(found) or 'none'}", *aligned(rows, right=2)]
    for end, words in zip((free.low, free.high), found.at_ends, strict=True):
        if words:
            lines.append(f"  at {free.name} = {shortest_text(end)} itself: {'; '.join(words)}")
    lines.append(found.reason)
    if found.others:
        listed = ", ".join(number.text(6) for number in found.others[:_OTHERS])
        more = f" and {len(found.others) - _OTHERS} more" if len(found.others) > _OTHERS else ""
        lines.append(
            f"where curves meet or turn and the arrangement is the same on both sides: {listed}{more}"
        )
    return "\n".join(lines)


def value_text(change: Change) -> str:
    """The value with ten digits, or the two ends of its enclosure."""
    if isinstance(change.value, AlgebraicNumber):
        return change.value.text()
    return between(change.value.low, change.value.high, _DIGITS)


def _kind(change: Change) -> str:
    if not isinstance(change.value, AlgebraicNumber):
        return "enclosed"
    degree = change.value.degree
    return "exact" if degree == 1 else f"exact, of degree {degree}"
