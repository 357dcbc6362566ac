"""The surface between a family's regions of different counts, over its free parameter, as a mesh of
triangles.

Guarantee: every vertex lies on the boundary of a member's regions, to within `ACCURACY` of the
window; triangles join neighbouring members' boundaries, and none reaches past a change of the
arrangement that is listed. Between its vertices a triangle is linear interpolation, of which
nothing is proved; `BoundarySurface.deviation` says what was seen of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ACCURACY = Fraction(1, 2**20)
"""Of the window's side: how far vertices are from the boundary at most, along the axis that is not
members' base.
"""


@dataclass(frozen=True, slots=True)
class Sheet:
    """A part of the surface: one wall between two regions, from one member to another without a
    gap.

    Attributes
    ----------
    counts : that of the record's ``count`` on both sides, the smaller one first; of its one number,
        or of each index.
    low, high : the first and the last member's value.
    """

    counts: tuple[tuple[int, ...], tuple[int, ...]]
    low: Fraction
    high: Fraction


@with_methods
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class BoundarySurface:
    """The mesh.

    Attributes
    ----------
    names : of the two axes and of the free parameter, the coordinates of the vertices.
    vertices : shape (n, 3), in the units of the axes and of the free parameter, rounded to floats.
    faces : shape (m, 3): numbers of each triangle's vertices.
    sheet : shape (m,): the number of each triangle's sheet.
    member : shape (n,): the number of each vertex's member, in ``members``.
    sheets : what each of them parts.
    members : the values of the free parameter at which the boundary is exact, in increasing order.
    deviation : how far from the interpolated sheets the boundaries of members halfway were at most,
        as a share of the window, before these members were added to the mesh; an estimate of what
        is left, no bound.
    unresolved : number of gaps between members, further apart than the narrowest that are looked
        at, that were left open as the most members had been computed.
    complete : whether it is proved that the arrangement changes between no two members that a sheet
        joins.
    """

    names: tuple[str, str, str]
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    sheet: NDArray[np.int64]
    member: NDArray[np.int64]
    sheets: tuple[Sheet, ...]
    members: tuple[Fraction, ...]
    deviation: float
    unresolved: int
    complete: bool

    def words(self) -> str:
        """How the surface was made, in a sentence or two."""
        known = "" if self.complete else "; that nothing changes between them is not proved"
        left = (
            f"; {self.unresolved} gaps were left open at the most members"
            if self.unresolved
            else ""
        )
        return (
            f"sheets interpolated linearly between {len(self.members)} exact members; of members halfway that were "
            f"looked at none was further away than {100 * self.deviation:.2g} % of the window{known}{left}"
        )

    def __repr__(self) -> str:
        return (
            f"<BoundarySurface over {', '.join(self.names)}: {len(self.vertices)} vertices, {len(self.faces)} faces, "
            f"{len(self.sheets)} sheets, {len(self.members)} members>"
        )

    if TYPE_CHECKING:  # `ptmcad.methods` has them

        def to_obj(self) -> str: ...

        def to_ply(self) -> str: ...
