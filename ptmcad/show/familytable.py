"""A family and its changes as tables for the terminal: a line for each member, and for each change.

Guarantee: areas are certified, rounded as in the table of a map; the digits of an exact value of a
change are right, the ends of an enclosure are rounded outwards.
"""

from __future__ import annotations

from ptmcad.answer.changes import Change, Changes
from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import several
from ptmcad.show.columns import aligned
from ptmcad.show.table import NOT_COMPUTED, area_by_count, area_text, areas_are_known
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.numerals import decimal, shortest_text


def family_table(family: FamilyMap) -> str:
    """Value of the free parameter, regions, cells and areas of each member, and the surfaces."""
    values = [shortest_text(value) for value in family.values]
    width = max(len(family.free.name), *(len(value) for value in values))
    lines = [f"{family.free.name:>{width}}  regions  cells  areas by count"]
    for value, result in zip(values, family.members, strict=True):
        lines.append(
            f"{value:>{width}}  {len(result.regions):>7}  {len(result.cells):>5}  {_areas(result)}"
        )
    if family.surfaces:
        sizes = ", ".join(
            f"{several(len(terms), 'term')} of degree {_degree(terms)}" for terms in family.surfaces
        )
        many = "surfaces" if len(family.surfaces) > 1 else "surface"
        lines.append(f"computed once for all: {many} where solutions meet, {sizes}")
    if family.changes is not None:
        lines.append(changes_table(family.changes))
    return "\n".join(lines)


def _degree(terms: tuple[tuple[tuple[int, int, int], int], ...]) -> int:
    return max(sum(powers) for powers, _ in terms)


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
    rows = [(value_text(change), _kind(change), change.words) for change in found.changes]
    width = max((len(value) for value, _, _ in rows), default=0)
    cells = [
        ["", "" if number else value.rjust(width), "" if number else kind, text]
        for value, kind, words in rows
        for number, text in enumerate(words)
    ]
    lines = [f"{title}: {len(rows) or 'none'}", *aligned(cells)]
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
    low, high = change.value.low, change.value.high
    return f"{decimal(low, up=False, digits=_DIGITS)} to {decimal(high, up=True, digits=_DIGITS)}"


def _kind(change: Change) -> str:
    if not isinstance(change.value, AlgebraicNumber):
        return "enclosed"
    degree = change.value.degree
    return "exact" if degree == 1 else f"exact, of degree {degree}"
