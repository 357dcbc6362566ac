"""The exact map against which every error is measured: counts at pixel centres, and walls as chords.

Guarantee: counts at centres are exact, a centre on a wall being reported as such; walls have proved distances to their
chords, and `Walls.gaps` are all parts of the base that no chord covers.

The base axis is the map's own; shares of the window run from 0 to 1 along the base and along the fibre.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import fmpq

from ptmcad.algebra.polynomials import UnivariatePolynomial
from ptmcad.algebra.real_roots import RealRoot, has_root_between, refine, sign_at
from ptmcad.algebra.window import Interval
from ptmcad.answer.regionmap import Cell, RegionMap, Status
from ptmcad.exact.cad.curves import Curve, by_component, curves_of, lines_of
from ptmcad.exact.cad.polyline import ROUNDING, UNPROVED, Branch, Chord, chords, reaching, to_share
from ptmcad.exact.cad.stacks import roots_over
from ptmcad.exact.regions import Link, merge
from ptmcad.question.slice import Count
from ptmcad.text.flint_numbers import from_fraction

MAX_CHORD_DISTANCE = Fraction(1, 2**18)
"""Largest distance between a wall and its chord, as a share of the window's side."""
GAP_HALF_WIDTH = Fraction(1, 2**32)
"""Half of the base's share around a critical value that is left to the gaps."""
MIN_STACK_WIDTH = Fraction(1, 2**24)
"""Share of the base of the narrowest panels; those on which nothing is proved go to the gaps."""
DEPTH = 12
"""Halvings of the fibre over a gap."""
COUNTS = ("stable", "total", "index")
"""The counts for which errors are reported; on the torus the index follows from the other two (the Euler sum)."""
CODE = 100


@dataclass(frozen=True, slots=True)
class Reference:
    """An exact map with its curves.

    Attributes
    ----------
    curves : components that are graphs over the base.
    lines : components across the base, as polynomials in the base coordinate.
    spans : for each stack its part of the base, as shares, without the gaps at its ends.
    critical : the critical values as numbers.
    """

    result: RegionMap
    base: Interval
    fibre: Interval
    curves: tuple[Curve, ...]
    lines: tuple[UnivariatePolynomial, ...]
    spans: tuple[tuple[Fraction, Fraction], ...]
    critical: tuple[RealRoot, ...]


Gap = tuple[Fraction, Fraction, tuple[tuple[Fraction, Fraction], ...]]
"""A part of the base, and the parts of the fibre that a wall may reach there."""


Reaches = dict[tuple[int, Fraction, Fraction], tuple[tuple[Fraction, Fraction], ...]]
"""For a component and a part of the base, the parts of the fibre that the component may reach there."""


@dataclass(frozen=True, slots=True)
class Walls:
    """What separates regions when they are distinguished by a count.

    Attributes
    ----------
    counts : of each region, see `shown_count`.
    areas : bounds of each region's share of the window's area.
    chords : each with the regions below and above it.
    tops : for each stack its span and the region of its topmost cell.
    gaps : parts of the base that no chord covers, or one of which the distance is unproved, each with the
        parts of the fibre that a wall may reach there.
    """

    counts: tuple[int, ...]
    areas: tuple[tuple[Fraction, Fraction], ...]
    chords: tuple[tuple[Chord, int, int], ...]
    tops: tuple[tuple[Fraction, Fraction, int], ...]
    gaps: tuple[Gap, ...]


def reference(result: RegionMap) -> Reference:
    """The curves of an exact map.

    Raises
    ------
    ValueError
        When the map is not exact, or its regions are not distinguished by the index.
    """
    if result.status is not Status.EXACT or result.slice.count is not Count.INDEX:
        raise ValueError("errors are measured against an exact map with regions distinguished by the index")
    axes = result.slice.axes
    base, fibre = ((from_fraction(axes[k].low), from_fraction(axes[k].high)) for k in (result.base, 1 - result.base))
    curves = tuple(curves_of(result.components, result.base))
    lines = tuple(lines_of(result.components, result.base).values())
    critical = tuple(
        RealRoot(UnivariatePolynomial(list(c.polynomial)), from_fraction(c.low), from_fraction(c.high))
        for c in result.critical_values
    )
    narrow = (base[1] - base[0]) * from_fraction(GAP_HALF_WIDTH) / 2
    ends = [(Fraction(0), GAP_HALF_WIDTH)]  # on the window's edge branches may meet too
    for value in critical:
        near = refine(value, narrow)
        low, high = to_share(near.low, base), to_share(near.high, base)
        ends.append(
            (
                (low / GAP_HALF_WIDTH).__floor__() * GAP_HALF_WIDTH - GAP_HALF_WIDTH,
                -((-high / GAP_HALF_WIDTH).__floor__()) * GAP_HALF_WIDTH + GAP_HALF_WIDTH,
            )
        )
    ends.append((1 - GAP_HALF_WIDTH, Fraction(1)))
    spans = tuple((left[1], right[0]) for left, right in pairwise(ends))
    return Reference(result, base, fibre, curves, lines, spans, critical)


def walls(exact: Reference, check: Callable[[], None] = lambda: None) -> dict[str, Walls]:
    """For each of `COUNTS` the walls that separate its regions."""
    curve_of = by_component(exact.curves)
    chains: dict[tuple[int, int], tuple[Chord, ...]] = {}
    reaches: Reaches = {}
    found: dict[str, Walls] = {}
    for count in COUNTS:
        region_of = regions(exact.result, count)
        sides: list[tuple[Chord, int, int]] = []
        tops: list[tuple[Fraction, Fraction, int]] = []
        separating: set[int] = set()
        for s, (stack, span) in enumerate(zip(exact.result.stacks, exact.spans, strict=True)):
            here = [region_of[n] for n in stack.cells]
            wide = span[0] < span[1]  # else the stack is narrower than the gaps at its ends
            if wide:
                tops.append((*span, here[-1]))
            for level, (wall, (below, above)) in enumerate(zip(stack.walls, pairwise(here), strict=True)):
                if below == above:
                    continue
                separating.add(wall.component)
                if not wide:
                    continue
                if (s, level) not in chains:
                    branch = Branch(curve_of[wall.component], wall.root, exact.base, exact.fibre)
                    chains[s, level] = chords(branch, span, MAX_CHORD_DISTANCE, MIN_STACK_WIDTH, check)
                sides += [(c, below, above) for c in chains[s, level]]
        meeting = [curve_of[n] for n in sorted(separating)]
        gaps = tuple(_gaps(exact, [c for c, _, _ in sides], meeting, reaches, check))
        found[count] = Walls(*_regions_by_count(exact.result, region_of, count), tuple(sides), tuple(tops), gaps)
    return found


def _regions_by_count(
    result: RegionMap, region_of: tuple[int, ...], count: str
) -> tuple[tuple[int, ...], tuple[tuple[Fraction, Fraction], ...]]:
    """Counts and areas of the regions; those of the map, which are distinguished by the index, are parts of them."""
    first, second = result.slice.axes
    window = (first.high - first.low) * (second.high - second.low)
    number = 1 + max(region_of)
    counts = {region: count_of(cell, count) for region, cell in zip(region_of, result.cells, strict=True)}
    areas = [(Fraction(0), Fraction(0))] * number
    for part in result.regions:
        n = region_of[part.cells[0]]
        areas[n] = (areas[n][0] + part.area[0] / window, areas[n][1] + part.area[1] / window)
    return tuple(counts[n] for n in range(number)), tuple(areas)


def _gaps(
    exact: Reference, known: list[Chord], meeting: list[Curve], reaches: Reaches, check: Callable[[], None]
) -> Iterator[Gap]:
    """Around the critical values, and where a wall's distance to its chord is not proved."""
    places = [x for low, high in exact.spans if low < high for x in (low, high)]
    around = zip([Fraction(0), *places[1::2]], [*places[::2], Fraction(1)], strict=True)
    unproved = {(c.left, c.right) for c in known if c.distance == UNPROVED}
    ends: dict[Fraction, list[Fraction]] = {}
    for c in known:
        ends.setdefault(c.left, []).append(c.at_left)
        ends.setdefault(c.right, []).append(c.at_right)
    width = exact.base[1] - exact.base[0]
    for left, right in [*around, *sorted(unproved)]:
        if left >= right:
            continue
        check()
        if any(has_root_between(p, *(exact.base[0] + width * from_fraction(x) for x in (left, right)))
               for p in exact.lines):  # fmt: skip
            yield left, right, ((Fraction(0), Fraction(1)),)
            continue
        for met in meeting:
            if (met.component, left, right) not in reaches:
                parts = reaching(met, (left, right), exact.base, exact.fibre, DEPTH)
                reaches[met.component, left, right] = tuple(_joined(sorted(parts)))
        reached = sorted(part for met in meeting for part in reaches[met.component, left, right])
        # a wall that goes on into the gap stays in the part in which it enters; the others are no boundary
        entries = [*ends.get(left, ()), *ends.get(right, ())]
        yield (
            left,
            right,
            tuple(
                (low, high)
                for low, high in _joined(reached)
                if any(low - ROUNDING <= at <= high + ROUNDING for at in entries)
            ),
        )


def _joined(parts: list[tuple[Fraction, Fraction]]) -> list[tuple[Fraction, Fraction]]:
    """Overlapping or touching intervals put together; the intervals are sorted."""
    joined: list[tuple[Fraction, Fraction]] = []
    for low, high in parts:
        if joined and low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], high))
        else:
            joined.append((low, high))
    return joined


def regions(result: RegionMap, count: str) -> tuple[int, ...]:
    """The region of every cell when regions are distinguished by a count; numbers from 0."""
    keys = [count_of(cell, count) for cell in result.cells]
    return merge(keys, [Link(a.first, a.second, a.component) for a in result.adjacencies])


def count_of(cell: Cell, count: str) -> int:
    if cell.stable is None or cell.total is None:
        raise ValueError("the map does not give both the stable and the total counts of its cells")
    return int(shown_count(cell.stable, cell.total, count))


def shown_count(stable: Any, total: Any, count: str) -> Any:
    """One number for the count that is asked for, from numbers or arrays; for the index both in one.

    >>> shown_count(2, 6, "index")
    602
    """
    return {"stable": stable, "total": total, "index": CODE * total + stable}[count]


Column = tuple[tuple[int, int, int], ...]
"""Runs (cell, first, end) of the pixels, from below, whose centres lie in the cell; first <= row < end."""


def centres(exact: Reference, n: int) -> tuple[Column, ...]:
    """For each column of an n x n grid along the base, from the left, in which cell the centres of its pixels lie.

    A centre on a wall is in no run.
    """
    return tuple(_column(exact, n, k) for k in range(n))


def _column(exact: Reference, n: int, k: int) -> Column:
    width = exact.base[1] - exact.base[0]
    u = exact.base[0] + width * from_fraction(Fraction(2 * k + 1, 2 * n))
    number = 0
    for critical in exact.critical:
        side = _compare(critical, u)
        if side == 0:
            return _located(exact, n, k)
        if side > 0:
            break
        number += 1
    height = exact.fibre[1] - exact.fibre[0]
    runs: list[tuple[int, int, int]] = []
    first = 0
    roots = roots_over(exact.curves, u, exact.fibre)
    cells = exact.result.stacks[number].cells
    for cell, (_, root) in zip(cells[:-1], roots, strict=True):
        end, on_wall = _rank(refine(root, height / (4 * n)), exact.fibre, n)
        runs.append((cell, first, end))
        first = end + on_wall
    runs.append((cells[-1], first, n))
    return tuple(run for run in runs if run[1] < run[2])


def _rank(root: RealRoot, fibre: Interval, n: int) -> tuple[int, bool]:
    """How many of the n centres are below the root, and whether it is one; it is known to a quarter of a pixel."""
    height = fibre[1] - fibre[0]
    row = int(((root.high - fibre[0]) / height * n + from_fraction(Fraction(1, 2))).floor()) - 1
    centre = fibre[0] + height * from_fraction(Fraction(2 * row + 1, 2 * n))
    # centres 0 to row are at most root.high; all below it are less than root.low
    if row < 0 or centre < root.low:
        return row + 1, False
    at = sign_at(root.polynomial, centre)
    if at == 0:
        return row, True
    return (row + 1 if at == sign_at(root.polynomial, root.low) else row), False


def _compare(root: RealRoot, u: fmpq) -> int:
    """The sign of the root minus u."""
    if u < root.low or u > root.high:
        return 1 if u < root.low else -1
    at = sign_at(root.polynomial, u)
    if at == 0:
        return 0
    return 1 if at == sign_at(root.polynomial, root.low) else -1


def _located(exact: Reference, n: int, k: int) -> Column:
    """A column over a critical value: its centres are located one by one."""
    slice = exact.result.slice
    along, up = slice.axes[exact.result.base], slice.axes[1 - exact.result.base]
    x = along.low + (along.high - along.low) * Fraction(2 * k + 1, 2 * n)
    runs: list[tuple[int, int, int]] = []
    for row in range(n):
        y = up.low + (up.high - up.low) * Fraction(2 * row + 1, 2 * n)
        cell = exact.result.locate(**{along.name: x, up.name: y}).cell
        if cell is None:
            continue
        if runs and runs[-1][0] == cell and runs[-1][2] == row:
            runs[-1] = (cell, runs[-1][1], row + 1)
        else:
            runs.append((cell, row, row + 1))
    return tuple(runs)
