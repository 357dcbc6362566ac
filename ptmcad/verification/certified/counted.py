"""What is counted at a point, and where solutions may be.

Guarantee: data only.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence, Set
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from ptmcad.answer.counts import MorseIndex
from ptmcad.answer.regionmap import Cell, RegionMap
from ptmcad.question.counts import Count
from ptmcad.verification.certified.boxes import Box, Floats
from ptmcad.verification.derivation import SignMeaning
from ptmcad.verification.report import Violation

NAMES = ("total", "stable", "index", "admissible")
_NEEDED = {
    Count.STABLE: {"stable"},
    Count.ADMISSIBLE: {"stable", "admissible"},
}


def needed_for(count: Count, meaning: SignMeaning) -> Set[str]:
    """The names of the counts that a certified map has; without an index all solutions, or stable ones alone."""
    return _NEEDED.get(count, meaning.with_all)


def names_in(item: object) -> set[str]:
    """The names of the counts that a cell or a region has."""
    return {name for name in NAMES if getattr(item, name) is not None}


def contradiction_in(cell: Cell) -> str:
    """What counts of a cell cannot be; empty where they can."""
    if any(getattr(cell, name) < 0 for name in names_in(cell) - {"index"}):
        return "a negative count"
    if cell.admissible is not None and cell.stable is not None and cell.admissible > cell.stable:
        return f"{cell.admissible} admissible equilibria among {cell.stable} stable ones"
    return ""


def check_region(r: RegionMap, number: int, members: Collection[int]) -> None:
    """A region has the counts that all of its cells have, and the sample of one of them.

    Raises
    ------
    Violation
    """
    region = r.regions[number]
    for name in NAMES:
        values = {getattr(r.cells[n], name) for n in members}
        expected = values.pop() if len(values) == 1 else None
        if getattr(region, name) != expected:
            raise Violation(f"region {number}: {name} is {expected}, not {getattr(region, name)}")
    if tuple(region.sample) not in {tuple(r.cells[n].sample) for n in members}:
        raise Violation(f"the sample of region {number} is not the sample of one of its cells")


@dataclass(frozen=True, slots=True)
class CellCounts:
    """What a `Count` asks for; None what it does not need."""

    total: int | None
    stable: int | None
    index: MorseIndex | None
    admissible: int | None

    def __str__(self) -> str:
        parts = [("total", self.total), ("stable", self.stable), ("index", self.index), ("admissible", self.admissible)]
        return ", ".join(f"{name} {value}" for name, value in parts if value is not None)


def with_further(counts: CellCounts, count: Count, number: Callable[[], int]) -> CellCounts:
    """The counts, and the number of those stable solutions of which a kind of count asks more."""
    return replace(counts, admissible=number()) if count is Count.ADMISSIBLE else counts


def stored(cell: Cell) -> CellCounts:
    """The counts of a cell as they are stored."""
    return CellCounts(cell.total, cell.stable, cell.index, cell.admissible)


def differs(cell: Cell, true: CellCounts) -> bool:
    """Whether the stored counts of a cell are not these."""
    return stored(cell) != true


@dataclass(frozen=True, slots=True)
class CountedPoint:
    """All solutions at a point, or all minima and perhaps others where no more is asked for, and their counts."""

    counts: CellCounts
    found: Sequence[Any]
    values: Any


@dataclass(frozen=True, slots=True)
class Where:
    """Boxes in which all solutions are that are asked for, in place of all configurations.

    Attributes
    ----------
    boxes : for each choice of sides of springs on one line each, in the order of `kinks.sides`; they may be looked for
        when they are asked for.
    whole : half the width of all configurations, in each unknown.
    """

    boxes: Sequence[Iterable[Box]]
    whole: Floats


Places = Callable[[tuple[Fraction, Fraction], tuple[Fraction, Fraction]], Where | None]
"""Where the solutions may be over a rectangle of the window, in lattice steps; None where nothing is told of it."""
