"""Where a point lies in a region map, as `ptmcad.ask.location` finds it."""

from __future__ import annotations

from dataclasses import dataclass

from ptmcad.answer.counts import MorseIndex
from ptmcad.answer.regionmap import Status


@dataclass(frozen=True, slots=True)
class Location:
    """Where a point lies; region, cell and counts are None unless the point is decided and in a cell."""

    status: Status
    region: int | None = None
    cell: int | None = None
    total: int | None = None
    stable: int | None = None
    index: MorseIndex | None = None
    admissible: int | None = None
