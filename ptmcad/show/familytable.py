"""The table of a family for the terminal: a line for each member.

Guarantee: areas are certified, rounded as in the table of a map.
"""

from __future__ import annotations

from ptmcad.answer.family import FamilyMap
from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.words import several
from ptmcad.show.changestable import changes_table
from ptmcad.show.table import NOT_COMPUTED, area_by_count, area_text, areas_are_known
from ptmcad.text.numerals import shortest_text


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
