"""How far a search has come, for a bar: on the logarithm of the share of the window that is
undetermined.

Guarantee: the number never falls, and reaches `PARTS` at no share above the tolerance.

Each level of the search about halves the share, and takes longer than all before: on the share
itself a bar would stand at its end nearly all of the time.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from sys import float_info

PARTS = 1000
"""Of the whole way, from a window of which all is undetermined to the tolerance."""
LEVEL_SHRINKAGE = 0.5
"""What a level leaves of the share, about: half as wide boxes along a curve are twice as many."""


@dataclass(slots=True)
class SearchProgress:
    """The way to a tolerance, and how much of it is behind."""

    tolerance: float
    reached: int = 0

    def __post_init__(self) -> None:
        # one below all floats has become zero, which has no logarithm
        self.tolerance = max(self.tolerance, float_info.min)

    def at(self, share: float, level: float) -> int:
        """The part of the way that is behind when a level that began at a share is done to the part
        ``level``.

        >>> way = SearchProgress(1e-3)
        >>> way.at(1.0, 0.0), way.at(0.1, 0.0), way.at(0.2, 0.5), way.at(0.0, 1.0)
        (0, 333, 333, 1000)
        """
        left = max(share * LEVEL_SHRINKAGE ** min(max(level, 0.0), 1.0), self.tolerance)
        part = log(min(left, 1.0)) / log(self.tolerance)
        self.reached = max(
            self.reached, min(int(PARTS * part), PARTS - 1 if share > self.tolerance else PARTS)
        )
        return self.reached
