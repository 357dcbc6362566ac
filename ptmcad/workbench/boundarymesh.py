"""The boundary surface of a family: which members it is made of, and which neighbours a sheet
joins.

Guarantee: neighbours are joined where no listed change lies between them and their boundaries have
the same shape: over the same number of strips of the base the same walls part the same counts.
Where that fails, members are put nearer and nearer to one another, and a gap of at most `NARROWEST`
is left.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from heapq import heappop, heappush
from itertools import pairwise
from math import acos, cos, inf, pi
from typing import Any, NamedTuple

from ptmcad.answer.boundarysurface import BoundarySurface
from ptmcad.answer.family import Changes, FamilyMap
from ptmcad.ask.changes import Members
from ptmcad.ask.members import Common, in_common, restored
from ptmcad.errors import ConfigError
from ptmcad.exact.boundaries.boundarystrips import BoundaryStrips
from ptmcad.options import DEFAULTS, Options, Progress
from ptmcad.question.slice import within_doubles
from ptmcad.text.flint_numbers import simplest_fraction
from ptmcad.text.parsing import share_for
from ptmcad.workbench.triangulation import Joined, mesh_of

TOLERANCE = Fraction(1, 100)
MAX_MEMBERS = 120
NARROWEST = Fraction(1, 1000)
"""Of the free parameter's range: the widest gap that is left where the boundary's shape changes and
counts do not.
"""
NEAR = Fraction(1, 10**6)
"""Of the range: how near to a change the last member is."""
_TOO_FAR = 5
"""Sheets that are off by so many times the tolerance are none, when no more members are to be
computed.
"""
_SHARES = tuple((1 - cos(pi * k / 4)) / 2 for k in range(5))
"""Of a strip's width: where members are compared."""


def boundary_surface(
    found: FamilyMap,
    tolerance: Any = TOLERANCE,
    *,
    max_members: int = MAX_MEMBERS,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> BoundarySurface:
    """The surface between regions of different counts in the space of the two axes and the free
    parameter.

    Parameters
    ----------
    found : of a family whose changes are known; its members are computed again, with as many
        further ones as it takes.
    tolerance : members are added until the boundary of one halfway between neighbours is this near
        to the sheet between them, as a share of the window.
    max_members : the most members that are computed; what is left then, `BoundarySurface.deviation`
        says.
    timeout : seconds after which `LimitReached` is raised.
    progress : called as progress(stage, done, total).

    Raises
    ------
    ConfigError
        When the family's changes are not known, for a family that the exact engine does not take,
        and for a tolerance that is not between 0 and 1.
    """
    share = share_for("tolerance", tolerance)
    if max_members < 2:
        raise ConfigError("a surface needs two members at least", key="max_members")
    if found.changes is None:
        raise ConfigError(
            "a sheet must not reach past a change of the arrangement, and the changes are not known: find them first, "
            "with --changes or ptmcad.family(record, changes=True)",
            key="surface",
        )
    options = Options(timeout=timeout, progress=progress)
    return surface_of(in_common(restored(found)), found.changes, share, max_members, options)


def surface_of(
    common: Common,
    changes: Changes,
    tolerance: Fraction = TOLERANCE,
    max_members: int = MAX_MEMBERS,
    options: Options = DEFAULTS,
) -> BoundarySurface:
    """The boundary surface of a family of which it is known what its members have in common, and
    its changes.

    Parameters
    ----------
    tolerance : how near sheets are to come to the members between them.
    max_members : the most members.

    Raises
    ------
    LimitReached
        When the time is over.
    ConfigError
        For numbers beyond doubles.
    """
    search = _SurfaceSearch(common, changes, tolerance, max_members, options)
    search.run()
    axes, free, runs = common.family.axes, common.family.free, search.runs()
    with within_doubles(common.family.member(changes.between[0])):
        mesh = mesh_of(runs, axes, tolerance / 4)
    members = tuple(sorted({value for run in runs for value, _ in run}))
    return BoundarySurface(
        (axes[0].name, axes[1].name, free.name),
        *mesh,
        members,
        search.deviation,
        search.unresolved,
        changes.complete,
    )


Slab = tuple[Fraction, Fraction]
"""From one value to another."""


_Placed = tuple[float, Fraction]
"""A member of an interval without changes: its place, from 0 to 1, and its value. Values are the
denser the nearer they are to the interval's ends.
"""


class _Gap(NamedTuple):
    """Between two members of an interval without changes.

    Attributes
    ----------
    slab : that interval.
    members : the lower one, one between them, and the upper one.
    deviation : of the middle member from the sheet between the other two, infinite where there is
        none.
    """

    slab: Slab
    members: tuple[_Placed, _Placed, _Placed]
    deviation: float

    @property
    def values(self) -> list[Fraction]:
        """Of the three members."""
        return [value for _, value in self.members]

    @property
    def width(self) -> Fraction:
        return self.members[-1][1] - self.members[0][1]


_Entry = tuple[float, Fraction, _Gap]


class _SurfaceSearch:
    """The search for members, worst gaps first.

    Attributes
    ----------
    joined : neighbouring values between which there is a sheet.
    deviation, unresolved : as of `BoundarySurface`.
    """

    def __init__(
        self,
        common: Common,
        changes: Changes,
        tolerance: Fraction,
        max_members: int,
        options: Options,
    ) -> None:
        first = Members(common, options)
        base = next(
            (p.cut.variety.base for v in changes.between if (p := first.tried(v)) is not None), None
        )
        self.members = Members(common, options, base)
        self.tolerance, self.max_members = tolerance, max_members
        self.slabs = _slabs(changes, self.members)
        self.width = changes.free.width
        self.stated = common.family.values
        self.sizes = tuple(a.width for a in common.family.axes)
        self.joined: set[Slab] = set()
        self.deviation, self.unresolved = 0.0, 0
        self._known: dict[Fraction, BoundaryStrips | None] = {}

    def run(self) -> None:
        """Look at gaps until sheets join all members that they can, near enough."""
        heap: list[_Entry] = []
        for slab in self.slabs:
            stated = [(_place(slab, v), v) for v in self.stated if slab[0] < v < slab[1]] or [
                (0.5, _value(slab, 0.5, slab))
            ]
            for start, end in pairwise([(0.0, slab[0]), *stated, (1.0, slab[1])]):
                self._push(heap, slab, start, end)
        while heap:
            gap = heappop(heap)[2]
            self.members.report("members of the surface", len(self._known), self.max_members)
            if gap.deviation <= self.tolerance:
                self._join(gap)
            elif self._is_last(gap):
                self._close(gap)
            else:
                for half in pairwise(gap.members):
                    self._push(heap, gap.slab, *half)

    def runs(self) -> list[Joined]:
        """Members in increasing order that sheets join each to the next."""
        found: list[Joined] = []
        for low, high in sorted(self.joined):
            if not found or found[-1][-1][0] != low:
                found.append([(low, self._strips(low))])
            found[-1].append((high, self._strips(high)))
        return found

    def _is_last(self, gap: _Gap) -> bool:
        # where boundaries have the same shape, they come nearer and nearer, but for a jump at which
        # their strips do
        narrowest = NARROWEST if gap.deviation == inf else NARROWEST / 16
        return gap.width <= narrowest * self.width or len(self._known) >= self.max_members

    def _join(self, gap: _Gap) -> None:
        self.joined |= {*pairwise(gap.values)}
        self.deviation = max(self.deviation, gap.deviation)

    def _close(self, gap: _Gap) -> None:
        """What sheets there can be in a gap that is not looked into any further."""
        if gap.deviation <= _TOO_FAR * self.tolerance:
            self._join(gap)
            return
        if gap.deviation < inf:
            self.unresolved += gap.width > NARROWEST * self.width
            return
        for low, high in pairwise(gap.values):
            first, second = self._boundary(low), self._boundary(high)
            if first is not None and second is not None and first.shape == second.shape:
                self.joined.add((low, high))
            elif high - low > NARROWEST * self.width:
                self.unresolved += 1

    def _push(self, heap: list[_Entry], slab: Slab, first: _Placed, last: _Placed) -> None:
        """Enter the gap between two members."""
        (start, low), (end, high) = first, last
        middle = (start + end) / 2
        value = _value(slab, middle, (low, high))
        deviation = self._deviation(low, value, high)
        share = float((high - low) / self.width)
        gap = _Gap(slab, (first, (middle, value), last), deviation)
        heappush(heap, (-min(deviation, share), low, gap))

    def _boundary(self, value: Fraction) -> BoundaryStrips | None:
        """None where a member has no arrangement."""
        if value not in self._known:
            picture = self.members.tried(value)
            self._known[value] = None if picture is None else BoundaryStrips(picture)
        return self._known[value]

    def _strips(self, value: Fraction) -> BoundaryStrips:
        found = self._boundary(value)
        assert found is not None  # no sheet ends at a member that has none
        return found

    def _deviation(self, low: Fraction, middle: Fraction, high: Fraction) -> float:
        """How far the middle member's boundary is from the sheet between the others, as a share of
        the window.
        """
        found = [self._boundary(value) for value in (low, middle, high)]
        if any(each is None or each.shape != (found[0] and found[0].shape) for each in found):
            return inf
        a, b, c = (each for each in found if each is not None)
        weight = (middle - low) / (high - low)
        base = self.sizes[a.base], self.sizes[1 - a.base]
        most = Fraction(0)
        for number, strip in enumerate(a.strips):
            for share in _SHARES if len(strip.keys) > 1 else ():
                points = [each.at(number, share) for each in (a, b, c)]
                for k, (p, q, r) in enumerate(zip(*points, strict=True)):
                    most = max(most, abs(p + (r - p) * weight - q) / base[min(k, 1)])
        return float(most)


def _value(slab: Slab, place: float, around: Slab) -> Fraction:
    """One with few digits near a place, between two others; denser at the slab's ends, where
    boundaries move fast.
    """
    low, high = slab
    share = Fraction((1 - cos(pi * place)) / 2)
    value, near = low + (high - low) * share, (high - low) * min(share, 1 - share) / 2**6
    fourth = (around[1] - around[0]) / 4
    least, most = max(value - near, around[0] + fourth), min(value + near, around[1] - fourth)
    if least >= most:
        least, most = around[0] + fourth, around[1] - fourth
    return simplest_fraction(least, most)


def _place(slab: Slab, value: Fraction) -> float:
    """That of a value, about: `_value` has others with fewer digits."""
    return acos(1 - 2 * float((value - slab[0]) / (slab[1] - slab[0]))) / pi


def _slabs(changes: Changes, members: Members) -> list[Slab]:
    """The intervals between changes, from member to member, without the nearest surroundings of
    changes.
    """
    free = changes.free
    near = NEAR * free.width

    def end(value: Fraction, words: Sequence[str], inner: Fraction) -> Fraction:
        return simplest_fraction(value, inner) if words or members.tried(value) is None else value

    lows, highs = [end(free.low, changes.at_ends[0], free.low + near)], []
    for change in changes:
        # of an enclosure the ends are members themselves
        low, high = change.value.low, change.value.high
        highs.append(simplest_fraction(low - near, low) if change.is_exact else low)
        lows.append(simplest_fraction(high, high + near) if change.is_exact else high)
    highs.append(end(free.high, changes.at_ends[1], free.high - near))
    return [slab for slab in zip(lows, highs, strict=True) if slab[0] < slab[1]]
