"""Two maps of the same window compared: where they have different counts, and how large that is.

Guarantee: areas are certified bounds, in the product of the axes' units. What a certified map
leaves undetermined is in upper bounds only.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ptmcad.answer import with_methods
from ptmcad.answer.regionmap import RegionMap
from ptmcad.text.numerals import share_text

Bounds = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class Change:
    """Where the first map has one count and the second another, or both the same one.

    Attributes
    ----------
    before, after : numbers of regions, one of each map, that have these counts.
    region : number of the region of `Comparison.decomposition` that is all of it.
    """

    before: int
    after: int
    region: int
    area: Bounds


@with_methods
@dataclass(frozen=True, slots=True)
class Comparison:
    """What is different between two exact maps, or two certified ones.

    Attributes
    ----------
    decomposition : the window cut along the curves of both maps; its regions, which need not be
        connected, are where both maps have the same pair of counts. It has neither equations nor
        counts of its own; of certified maps it has the rectangles of both covers as its own.
    changes : the pairs of counts that differ.
    undetermined : the area where one of the maps is undetermined, or both; None of exact maps.
    """

    first: RegionMap
    second: RegionMap
    decomposition: RegionMap
    changes: tuple[Change, ...]
    undetermined: Fraction | None = None

    @property
    def area(self) -> Bounds:
        """Of all changes together: between what is certain, and that with all that is undetermined."""
        low, high = (sum((change.area[k] for change in self.changes), Fraction(0)) for k in (0, 1))
        # upper bounds of several changes hold the same undetermined parts
        return low, high if self.undetermined is None else low + self.undetermined

    @property
    def share(self) -> Bounds:
        """Of the window's area."""
        whole = self.first.slice.area
        low, high = self.area
        return low / whole, min(high / whole, Fraction(1))

    def __repr__(self) -> str:
        share = share_text(self.share, self.undetermined is not None)
        return (
            f"<Comparison of {self.first.slice.name} and {self.second.slice.name}: {share} differ>"
        )
