"""Where a point lies in a region map, as `ptmcad.ask.location` finds it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ptmcad.answer.counts import Counted, MorseIndex
from ptmcad.answer.regionmap import Status


@dataclass(frozen=True, slots=True)
class Location(Counted):
    """Where a point lies; region, cell and counts are None unless the point is decided and in a
    cell.

    A point on a curve that no count feels has counts of its own, and the region on both sides; it
    is in no cell.
    """

    status: Status
    region: int | None = None
    cell: int | None = None
    total: int | None = None
    stable: int | None = None
    index: MorseIndex | None = None
    further: Mapping[str, int] = field(default_factory=dict)
    remark: str = ""
