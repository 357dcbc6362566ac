"""The maps of a family's members, with the surfaces that they are cut from, as plain data.

Guarantee: each map is that of its member alone, timings apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.changes import Changes
from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.slice import Axes, Axis

if TYPE_CHECKING:
    from typing import Any

    from ptmcad.answer.boundarysurface import BoundarySurface

SpaceTerms = tuple[tuple[tuple[int, int, int], int], ...]
"""Exponents of the axes and the free parameter, and the coefficient: a polynomial in Z[x, y, z]."""


@with_methods
@dataclass(frozen=True, slots=True)
class FamilyMap:
    """The region maps at values of the free parameter.

    Attributes
    ----------
    title : of pictures; the name when empty.
    free : the free parameter with its range.
    values : of it, in increasing order.
    members : the map at each of the values.
    surfaces : irreducible polynomials of the surfaces on which solutions meet, in the axes and the
        free parameter; empty where algebra does not compute the family in common, as with free
        lengths.
    text : what each parameter of the members is written as, in the axes, the free parameter and one
        another.
    changes : where between the ends of the range the arrangement of the regions changes; None when
        not asked for.
    """

    name: str
    free: Axis
    values: tuple[Fraction, ...]
    members: tuple[RegionMap, ...]
    surfaces: tuple[SpaceTerms, ...] = ()
    title: str = ""
    changes: Changes | None = None
    text: Mapping[str, str] = field(default_factory=dict)

    @property
    def axes(self) -> Axes:
        """Of every member."""
        return self.members[0].slice.axes

    def at(self, value: Fraction) -> RegionMap:
        """The map at one of the values.

        Raises
        ------
        KeyError
            When there is none at this value.
        """
        try:
            return self.members[self.values.index(value)]
        except ValueError:
            raise KeyError(value) from None

    def __iter__(self) -> Iterator[tuple[Fraction, RegionMap]]:
        return iter(zip(self.values, self.members, strict=True))

    def __repr__(self) -> str:
        window = ", ".join(map(str, (*self.axes, self.free)))
        return f"<FamilyMap {self.name}: {window}, {len(self.values)} members>"

    if TYPE_CHECKING:  # `ptmcad.methods` has it

        def table(self) -> str: ...

        def plot(self, style: Any = "default", **options: Any) -> Any: ...

        def boundary_surface(self, tolerance: Any = "1/100", **options: Any) -> BoundarySurface: ...

        def _repr_html_(self) -> str: ...

        def _repr_png_(self) -> bytes: ...
