"""The maps of a family's members, with the surfaces that they are cut from, and the values of the
free parameter at which the arrangement of their regions changes, as plain data.

Guarantee: each map is that of its member alone, timings apart. An `AlgebraicNumber` is a change,
exactly; an `Enclosure` has members of different arrangements at its ends, and so contains a change.
That there is no other change is said by ``complete``, and only with proof.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.arrangement import Arrangement
from ptmcad.answer.regionmap import RegionMap
from ptmcad.question.slice import Axes, Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure

if TYPE_CHECKING:
    from typing import Any

    from ptmcad.answer.boundarysurface import BoundarySurface

SpaceTerms = tuple[tuple[tuple[int, int, int], int], ...]
"""Exponents of the axes and the free parameter, and the coefficient: a polynomial in Z[x, y, z]."""


TOLERANCE = Fraction(1, 10**6)
"""Where no other one is asked for."""


@dataclass(frozen=True, slots=True)
class Change:
    """A value at which the arrangement changes.

    Attributes
    ----------
    value : exact, or enclosed between two members.
    words : what changes as the parameter grows, a sentence each. They describe: nothing rests on
        them.
    """

    value: AlgebraicNumber | Enclosure
    words: tuple[str, ...]

    @property
    def is_exact(self) -> bool:
        """Whether the value itself is known, and not two members between which it lies."""
        return isinstance(self.value, AlgebraicNumber)


@with_methods
@dataclass(frozen=True, slots=True, repr=False)
class Changes:
    """All changes that were found in the open range of the free parameter.

    Attributes
    ----------
    free : the free parameter with its range.
    changes : in increasing order.
    between : a value in each interval between neighbouring changes, or a change and an end of the
        range.
    arrangements : of the members at these values.
    others : further values at which curves meet, turn or pass the window's edge; on both sides of
        each the arrangement is the same.
    at_ends : what is otherwise at the lower and at the upper end of the range than beside it, a
        sentence each.
    complete : whether it is proved that the arrangement is the same from each change to the next.
    reason : how the changes were found, and why that is a proof or why it is none.
    tolerance : of the range, how near to a change members are compared in words, and how wide
        enclosures are.
    """

    free: Axis
    changes: tuple[Change, ...]
    between: tuple[Fraction, ...]
    arrangements: tuple[Arrangement, ...]
    others: tuple[AlgebraicNumber, ...]
    at_ends: tuple[tuple[str, ...], tuple[str, ...]]
    complete: bool
    reason: str
    tolerance: Fraction = TOLERANCE

    def __iter__(self) -> Iterator[Change]:
        return iter(self.changes)

    def __len__(self) -> int:
        return len(self.changes)

    def __repr__(self) -> str:
        known = "complete" if self.complete else "not proved complete"
        return f"<Changes of {self.free}: {len(self)}, {known}>"

    if TYPE_CHECKING:  # `ptmcad.methods` has it

        def table(self) -> str: ...


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
