"""The discriminant variety over all designs, as the covers need it, and the longest interval with the
wanted count on the line of one design.

Guarantee: that of `familyprojection` and `discriminant_variety`: off the polynomials' zeros all counts are constant, but
for sets that do not cut the space. An interval is exact, for designs off a set without interior:
the ends are roots of the polynomials at the design, and the count is that of samples between all of
them.

Where along a line the wanted count can occur, for all designs of a box at once.

Guarantee: `Run`s hold every point of the line at which, for some design of the box off a set
without interior, the count is the wanted one; see `refined` for the proof.

Why. The line's window is cut into parts. A part on which no polynomial of the discriminant variety
has a zero, for any design in the interior of the box, is a connected piece of the parameter space
without the variety, so that all counts are constant there, and one exact sample has them. Two
such parts side by side are in one piece if every polynomial has the same sign on both: an
irreducible one that vanished on all of the common face would be the face's own equation, and of
different signs. Parts that meet a known piece, for a box inside of the one it was known for, belong
to it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from math import gcd
from typing import NamedTuple

from flint import fmpq, fmpz

from ptmcad.algebra.bernstein import Table, halves, on_lines, over, sign, table_of
from ptmcad.algebra.polynomials import Coefficient, from_plane
from ptmcad.algebra.real_roots import Interval, disjoint, inside, isolate, refine, squarefree_part
from ptmcad.errors import DegenerateSliceError
from ptmcad.exact.discriminant_variety import discriminant_variety
from ptmcad.exact.familyprojection import surfaces_of
from ptmcad.exact.familyvariety import family_variety
from ptmcad.exact.models.system import SystemOnAxes
from ptmcad.exact.ranges.exactline import runs
from ptmcad.exact.stages import SliceProblem, count_at
from ptmcad.text.flint_numbers import simplest_between
from ptmcad.text.numerals import equalities

Box = tuple[Interval, Interval]
"""Ranges of the two design parameters; that of one which there is not is never looked at."""
Signs = tuple[int, ...]
_BITS = 64
"""Of roots, after the binary point."""
_SHARES = (fmpq(1, 2), fmpq(7, 16), fmpq(9, 17), fmpq(10, 19))
"""Where samples are tried in a box, one after another."""


class Space(NamedTuple):
    """What is known of the mechanism over all designs.

    Attributes
    ----------
    tables : the irreducible polynomials of the discriminant variety in the line's parameter to a
        power, and the design.
    power : that power: of lines from 0 on the largest of whose multiples alone occur.
    window : of the line's parameter, not of its power.
    count_at : of what there is at a value of the line's parameter and a design; None where a
        solution is singular.
    working : the wanted count.
    """

    tables: tuple[Table, ...]
    power: int
    window: Interval
    count_at: Callable[[fmpq, tuple[fmpq, fmpq]], int | None]
    working: int

    def whole(self) -> tuple[Run, ...]:
        """The line as one run of which nothing is known."""
        low, high = (value**self.power for value in self.window)
        return (Run((_LinePart(low, high, None, None),), None, None),)

    def length(self, low: fmpq, high: fmpq) -> fmpq:
        """An upper bound for the length of a part, given by the powers of its ends; exact where the
        power is 1.
        """
        first, last = self.outside(low, high)
        return last - first

    def least(self, low: fmpq, high: fmpq) -> fmpq:
        """A lower bound of the same."""
        first, last = self.inside(low, high)
        return last - first

    def outside(self, low: fmpq, high: fmpq) -> Interval:
        """Values of the line's parameter just beyond those with these powers, or these values."""
        return root_bound(low, self.power, up=False), root_bound(high, self.power, up=True)

    def inside(self, low: fmpq, high: fmpq) -> Interval:
        """Values just between them."""
        return root_bound(low, self.power, up=True), root_bound(high, self.power, up=False)


class _LinePart(NamedTuple):
    """A part of the line, by the powers of its ends.

    Attributes
    ----------
    signs : of the polynomials for all designs inside of the box; None where they may have zeros.
    here : whether the count is the wanted one; None where it is not known.
    """

    low: fmpq
    high: fmpq
    signs: Signs | None
    here: bool | None


class Run(NamedTuple):
    """A largest part of the line without a part where the count is proved to be another one.

    Attributes
    ----------
    parts : side by side, from its lower end to its upper one.
    left, right : the signs of the polynomials beyond its ends; None at the window's edge.
    """

    parts: tuple[_LinePart, ...]
    left: Signs | None
    right: Signs | None

    @property
    def ends(self) -> Interval:
        """The powers of its ends."""
        return self.parts[0].low, self.parts[-1].high


def refined(space: Space, box: Box, runs: Sequence[Run], resolution: fmpq) -> tuple[Run, ...]:
    """The runs over a box.

    Parameters
    ----------
    runs : of a box that this one is in.
    resolution : parts that are shorter are not cut any more.
    """
    return tuple(found for run in runs for found in _refined(space, box, run, resolution))


def longest(space: Space, runs: Sequence[Run]) -> fmpq:
    """An upper bound of the length of any interval with the wanted count, for every design."""
    return max((space.length(*run.ends) for run in runs), default=fmpq(0))


def measure(space: Space, runs: Sequence[Run]) -> fmpq:
    """An upper bound of the length of all intervals with the wanted count together, for every
    design.
    """
    return sum((space.length(*run.ends) for run in runs), fmpq(0))


def certain(space: Space, runs: Sequence[Run]) -> fmpq:
    """A lower bound of the length of the longest interval with the wanted count, for every design."""
    return max(
        (space.least(p.low, p.high) for run in runs for p in run.parts if p.here), default=fmpq(0)
    )


def _refined(space: Space, box: Box, run: Run, resolution: fmpq) -> Iterator[Run]:
    parts: list[_LinePart] = []
    for part in run.parts:
        if part.here is None and (part.signs is None or len(part.signs) < len(space.tables)):
            ends = part.low, part.high
            tables = {
                number: over(table, (ends, *box)) for number, table in enumerate(space.tables)
            }
            parts += _pieces(space, tables, {}, ends, resolution)
        else:
            parts.append(part)
    parts = _joined(parts)
    for end, beyond in ((0, run.left), (-1, run.right)):
        if beyond is not None and parts[end].signs == beyond:
            parts[end] = parts[end]._replace(here=False)
    parts = [
        _counted(space, box, part) if part.signs is not None and part.here is None else part
        for part in parts
    ]
    left, kept = run.left, list[_LinePart]()
    for part in parts:
        if part.here is not False:
            kept.append(part)
            continue
        if kept:
            yield Run(tuple(kept), left, part.signs)
        left, kept = part.signs, []
    if kept:
        yield Run(tuple(kept), left, run.right)


def _pieces(
    space: Space, tables: dict[int, Table], known: dict[int, int], place: Interval, resolution: fmpq
) -> Iterator[_LinePart]:
    """A part in pieces that are free of the variety, or too short to be cut; of polynomials that
    are not ``known`` to have a sign there.
    """
    signs = {number: sign(table) for number, table in tables.items()}
    known = known | {number: found for number, found in signs.items() if found}
    tables = {number: table for number, table in tables.items() if number not in known}
    low, high = place
    if not tables:
        yield _LinePart(low, high, tuple(known[number] for number in range(len(known))), None)
        return
    if space.length(low, high) <= resolution:
        yield _LinePart(low, high, None, None)
        return
    middle = (low + high) / 2
    cut = {number: halves(table) for number, table in tables.items()}
    for side, half in enumerate(((low, middle), (middle, high))):
        part = {number: pair[side] for number, pair in cut.items()}
        yield from _pieces(space, part, known, half, resolution)


def _joined(parts: Sequence[_LinePart]) -> list[_LinePart]:
    """Neighbours of equal signs as one."""
    found: list[_LinePart] = []
    for part in parts:
        if found and found[-1].signs == part.signs:
            here = part.here if found[-1].here is None else found[-1].here
            found[-1] = _LinePart(found[-1].low, part.high, part.signs, here)
        else:
            found.append(part)
    return found


def _counted(space: Space, box: Box, part: _LinePart) -> _LinePart:
    """The part with what a sample says of its count."""
    low, high = space.inside(part.low, part.high)
    if low >= high:
        return part
    for share in _SHARES:
        first, second = (a + (b - a) * share for a, b in box)
        third = (high - low) / 3
        found = space.count_at(simplest_between(low + third, high - third), (first, second))
        if found is not None:
            return part._replace(here=found == space.working)
    return part


def root_bound(value: fmpq, power: int, up: bool) -> fmpq:
    """A rational bound of a root of a number that is not negative; the number itself where the
    power is 1.
    """
    if power == 1:
        return value
    scaled = (value.p << (_BITS * power)) // value.q
    found = fmpz(scaled).root(power)
    exact = found**power * value.q == value.p << (_BITS * power)
    return fmpq(found if exact or not up else found + 1, 1 << _BITS)


def space_of_family(
    on: SystemOnAxes, names: Sequence[str], ranges: Sequence[Interval], along: int, working: int
) -> Space | None:
    """The space of three coordinates; None where there is no variety that holds for all designs.

    Parameters
    ----------
    on : the system on the axes x, y and z.
    names, ranges : of these.
    along : which of them varies along lines.

    Raises
    ------
    InfiniteSolutionsError, DegenerateSliceError, NothingToCountError
        When every point is exceptional.
    """
    known = family_variety(on)
    if known is None:
        return None
    return _space(on, surfaces_of(on, known, ranges), names, ranges, along, working)


def space_of_slice(problem: SliceProblem, along: int, working: int) -> Space:
    """The space of a slice's two axes.

    Raises
    ------
    InfiniteSolutionsError, DegenerateSliceError, NothingToCountError
        When every point is exceptional.
    """
    components, _, _ = discriminant_variety(problem.on, problem.window)
    found = [from_plane(c.polynomial) for c in components if not c.left_out]
    return _space(problem.on, found, problem.slice.axis_names, problem.window, along, working)


def _space(
    on: SystemOnAxes,
    found: Sequence[Coefficient],
    names: Sequence[str],
    ranges: Sequence[Interval],
    along: int,
    working: int,
) -> Space:
    window = ranges[along]
    order = (along, *(k for k in range(len(names)) if k != along))
    ordered = [
        [([int(powers[k]) for k in order] + [0], int(c)) for powers, c in p.terms()] for p in found
    ]
    power = (
        max(1, gcd(*(powers[0] for terms in ordered for powers, _ in terms)))
        if window[0] >= 0
        else 1
    )

    def count(value: fmpq, design: tuple[fmpq, fmpq]) -> int | None:
        point = [fmpq(0)] * len(names)
        for number, coordinate in zip(order, (value, *design), strict=False):
            point[number] = coordinate
        where = equalities(dict(zip(names, point, strict=True)))
        try:
            return count_at(where, on, point).counts.working
        except DegenerateSliceError:
            return None

    tables = (
        table_of(((first // power, *others[:2]), c) for (first, *others), c in terms)
        for terms in ordered
    )
    return Space(tuple(tables), power, window, count, working)


_WIDTH = fmpq(1, 2**80)
"""Of what isolates a root, against the window's power."""


def longest_on_line(space: Space, design: tuple[fmpq, ...]) -> tuple[Interval, Interval] | None:
    """The two ends of the longest interval, enclosed; equal ends where there is none.

    None where the design is on the variety, as far as that is seen.
    """
    at = (*design, fmpq(0))[:2]
    low, high = (end**space.power for end in space.window)
    product = on_lines(space.tables, (at[0], at[1]))
    if not product:
        return None
    found = disjoint(isolate(squarefree_part(product), low, high))
    roots = [refine(root, (high - low) * _WIDTH) for root in inside(found, (low, high))]
    ends = [(low, low), *((root.low, root.high) for root in roots), (high, high)]
    counts = []
    for (_, left), (right, _) in pairwise(ends):
        counts.append(space.count_at(simplest_between(*space.inside(left, right)), (at[0], at[1])))
    if None in counts:
        return None
    here = runs([count == space.working for count in counts])
    spans = [(space.outside(*ends[first]), space.outside(*ends[last])) for first, last in here]
    if not spans:
        return (space.window[0],) * 2, (space.window[0],) * 2
    return max(spans, key=lambda span: span[1][0] - span[0][1])
