"""What is counted at a point, and what cells and regions say of it.

Guarantee: data only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ptmcad.answer.counts import Counted, MorseIndex
from ptmcad.answer.regionmap import Cell, RegionMap
from ptmcad.verification.normalform.boxes import Zero
from ptmcad.verification.report import Violation


def numbers_in(item: Counted) -> dict[str, int | MorseIndex]:
    """The counts that are known of a cell, a region or a place, by their names."""
    known = {"total": item.total, "stable": item.stable, "index": item.index, **item.further}
    return {name: value for name, value in known.items() if value is not None}


def contradiction_in(cell: Cell) -> str:
    """What counts of a cell cannot be; empty where they can."""
    if any(number < 0 for number in numbers_in(cell).values() if isinstance(number, int)):
        return "a negative count"
    for name, number in cell.further.items():
        if cell.stable is not None and number > cell.stable:
            return f"{number} {name} equilibria among {cell.stable} stable ones"
    return ""


def checked_members(r: RegionMap, number: int) -> tuple[int, ...]:
    """The cells of a region, which has the counts that all of them have, and the sample of one.

    Raises
    ------
    Violation
    """
    region = r.regions[number]
    members = tuple(n for n, cell in enumerate(r.cells) if cell.region == number)
    if not members or members != region.cells:
        raise Violation(f"region {number} is said to have cells {region.cells}, not {members}")
    said, cells = numbers_in(region), [numbers_in(r.cells[n]) for n in members]
    for name in dict.fromkeys(name for known in (said, *cells) for name in known):
        values = {known.get(name) for known in cells}
        expected = values.pop() if len(values) == 1 else None
        if said.get(name) != expected:
            raise Violation(f"region {number}: {name} is {expected}, not {said.get(name)}")
    if tuple(region.sample) not in {tuple(r.cells[n].sample) for n in members}:
        raise Violation(f"the sample of region {number} is not the sample of one of its cells")
    return members


@dataclass(frozen=True, slots=True)
class CellCounts(Counted):
    """What a `Count` asks for; None what it does not need."""

    total: int | None = None
    stable: int | None = None
    index: MorseIndex | None = None
    further: Mapping[str, int] = field(default_factory=dict)

    def __str__(self) -> str:
        return ", ".join(f"{name} {value}" for name, value in numbers_in(self).items())


def stored(cell: Cell) -> CellCounts:
    """The counts of a cell as they are stored."""
    return CellCounts(cell.total, cell.stable, cell.index, cell.further)


@dataclass(frozen=True, slots=True)
class CountedPoint:
    """All solutions at a point, or all minima and perhaps others where no more is asked for, and
    their counts.
    """

    counts: CellCounts
    found: Sequence[Zero]
