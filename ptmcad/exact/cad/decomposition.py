"""A window cut along curves: stacks of cells over a base axis, which of the cells are neighbours, and
the regions that they make up.

Guarantee: no step decides anything by rounding without an error bound. Two cells are in one region
exactly when a chain of neighbours with equal counts joins them: across artefacts of the
decomposition, where counts must agree, and across walls. The regions do not depend on which axis was
the base.
"""

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from itertools import accumulate, islice, pairwise
from typing import NamedTuple, TypeVar

from flint import fmpq

from ptmcad.algebra.polynomials import UnivariatePolynomial
from ptmcad.algebra.real_roots import Interval, Window, order, sign_at
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.answer.regionmap import HARMLESS, Adjacency, Component, Merge, Segment
from ptmcad.exact.cad.crossings import Crossing, Separator, cross
from ptmcad.exact.cad.projection import (
    FibredCurve,
    Projection,
    curves_of,
    lines_of,
    predicted_cost,
    project,
)
from ptmcad.exact.cad.stacks import StackData, level_at, lift
from ptmcad.question.slice import Point
from ptmcad.text.flint_numbers import to_fraction

Link = tuple[int, int, int | None]
"""Two cells that share an open arc, and the variety's component on it, or None."""


def region_numbers(keys: Sequence[Hashable], links: Sequence[Link]) -> tuple[int, ...]:
    """The region of every cell, numbered from 0 in the order of their first cells.

    Parameters
    ----------
    keys : the count by which regions are distinguished, for each cell.

    Raises
    ------
    ArithmeticError
        When an open link joins cells of different counts: the decomposition contradicts itself.
    """
    parent = list(range(len(keys)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for first, second, component in links:
        equal = keys[first] == keys[second]
        if component is None and not equal:
            raise ArithmeticError(
                f"cells {first} and {second} are joined off the variety but differ in count"
            )
        if equal:
            a, b = root(first), root(second)
            parent[max(a, b)] = min(a, b)
    numbers: dict[int, int] = {}
    return tuple(numbers.setdefault(root(i), len(numbers)) for i in range(len(keys)))


def members(region_of: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """The cells of every region."""
    cells: list[list[int]] = [[] for _ in range(1 + max(region_of))]
    for n, number in enumerate(region_of):
        cells[number].append(n)
    return tuple(map(tuple, cells))


_T = TypeVar("_T")
Sample = tuple[fmpq, fmpq]
Report = Callable[[int, int], None]
"""Called as report(done, total); may raise to stop."""


def unreported(_done: int, _total: int) -> None:
    """No report."""


class Variety(NamedTuple):
    """The discriminant variety as seen from the base axis.

    Attributes
    ----------
    curves : the components that are used, but for lines across the base.
    lines : the lines across the base, as polynomials in u by the components' numbers.
    costs : predicted for each of the two base axes.
    excludes : whether solutions at which an inequality's polynomial is zero were left out, as they
        are in the way.
    """

    components: tuple[Component, ...]
    complex_solutions: int
    base: int
    curves: Sequence[FibredCurve]
    lines: dict[int, UnivariatePolynomial]
    costs: tuple[int, int]
    excludes: bool = False


def seen_from(
    components: Sequence[Component],
    complex_solutions: int = 0,
    excludes: bool = False,
    base: int | None = None,
) -> Variety:
    """Components over a base axis; over that of the cheaper decomposition when None."""
    views = [curves_of(components, axis) for axis in (0, 1)]
    costs = (predicted_cost(views[0]), predicted_cost(views[1]))
    if base is None:
        base = int(costs[1] < costs[0])
    lines = lines_of(components, base)
    return Variety(tuple(components), complex_solutions, base, views[base], lines, costs, excludes)


class Decomposition(NamedTuple):
    """The stacks over the base, and the sample of every cell, stack by stack from below."""

    window: Window
    variety: Variety
    projection: Projection
    stacks: tuple[StackData, ...]
    points: tuple[Sample, ...]

    @property
    def base(self) -> Interval:
        """The range of the axis over which the stacks stand."""
        return self.window[self.variety.base]

    @property
    def fibre(self) -> Interval:
        """The range of the axis along which the cells of a stack lie."""
        return self.window[1 - self.variety.base]

    @property
    def first_cells(self) -> list[int]:
        """The number of each stack's lowest cell, and at the end the number of all cells."""
        return list(accumulate((len(stack.heights) for stack in self.stacks), initial=0))

    @property
    def places(self) -> list[tuple[int, int]]:
        """The stack of every cell, and its level there."""
        return [
            (s, level) for s, stack in enumerate(self.stacks) for level in range(len(stack.heights))
        ]

    def samples(self, names: tuple[str, str]) -> tuple[Point, ...]:
        """The points as answers have them, by the axes' names."""
        return tuple(Point(names, to_fraction(x), to_fraction(y)) for x, y in self.points)

    def rows(self, values: Iterable[_T]) -> list[tuple[_T, ...]]:
        """What there is for every cell, as a row for each stack."""
        numbers = iter(values)
        return [tuple(islice(numbers, len(stack.heights))) for stack in self.stacks]

    @property
    def lines_across(self) -> list[int | None]:
        """The component that is a line over each abscissa, if one is."""
        lines = {_coefficients(p): n for n, p in self.variety.lines.items()}
        return [lines.get(_coefficients(r.polynomial)) for r in self.projection.abscissae]

    def cell_at(self, at: Sample) -> int | None:
        """The cell in which a point of the window lies; None on the curves, and on lines over
        critical abscissae.
        """
        u, v = at[self.variety.base], at[1 - self.variety.base]
        sides = [order(u, r) for r in self.projection.abscissae]
        if 0 in sides or any(sign_at(c.polynomial_over(u), v) == 0 for c in self.variety.curves):
            return None
        first = self.first_cells[sides.count(1)]
        return first + level_at(self.variety.curves, u, v, self.fibre)


class Neighbours(NamedTuple):
    """What separates the cells and what does not.

    Attributes
    ----------
    crossings : between neighbouring stacks.
    adjacencies : all pairs of cells with an open arc in common.
    region_of : the region of each cell.
    """

    crossings: tuple[Crossing, ...]
    adjacencies: tuple[Adjacency, ...]
    region_of: tuple[int, ...]


def projection_of(
    window: Window, variety: Variety, without: frozenset[str] = frozenset(), check: Check = nothing
) -> Projection:
    """The abscissae over which the order of the curves can change."""
    base = variety.base
    return project(
        variety.curves, list(variety.lines.values()), window[base], window[1 - base], check, without
    )


def stacks_of(window: Window, variety: Variety, projection: Projection) -> Decomposition:
    """The stacks between the critical abscissae, with samples."""
    base = variety.base
    # on these real solutions stay regular, but complex ones are lost, and the solutions over a point
    # may not be finitely many; curves left out for want of a point in the window contain no sample
    lines = lines_of(variety.components, base, HARMLESS)
    stacks = lift(
        variety.curves,
        projection.abscissae,
        window[base],
        window[1 - base],
        curves_of(variety.components, base, HARMLESS),
        list(lines.values()),
    )
    points = (
        ((s.sample, height) if base == 0 else (height, s.sample))
        for s in stacks
        for height in s.heights
    )
    return Decomposition(window, variety, projection, stacks, tuple(points))


def cut_along(window: Window, variety: Variety, check: Check = nothing) -> Decomposition:
    """The window cut along a variety: projection and stacks in one."""
    return stacks_of(window, variety, projection_of(window, variety, check=check))


def crossings_of(
    cut: Decomposition, report: Report = unreported, check: Check = nothing
) -> tuple[Crossing, ...]:
    """What is adjacent across each abscissa, with proof."""
    crossings = []
    for k, (left, right) in enumerate(pairwise(cut.stacks)):
        report(k, len(cut.stacks) - 1)
        crossings.append(cross(cut.variety.curves, left, right, cut.fibre, check))
    return tuple(crossings)


def neighbours_of(
    cut: Decomposition, keys: Sequence[tuple[int, ...]], crossings: tuple[Crossing, ...]
) -> Neighbours:
    """The adjacencies, and the cells merged into regions.

    Parameters
    ----------
    keys : of each cell, distinguishing regions.

    Raises
    ------
    ArithmeticError
        When the counts contradict the decomposition.
    """
    adjacencies = tuple(adjacencies_of(cut, crossings, keys))
    region_of = region_numbers(keys, [(a.first, a.second, a.component) for a in adjacencies])
    return Neighbours(crossings, adjacencies, region_of)


def joined_cells(cut: Decomposition, crossings: Sequence[Crossing]) -> tuple[int, ...]:
    """The connected part of the variety's complement in which each cell lies, as far as it is
    proved that cells are joined.

    Parts are numbered in the order of their first cells. Any two cells of one are joined by a path
    that does not meet the variety. On it no solution comes, goes, or changes its signs, so that
    counts are equal in all cells of the part.
    """
    keys = [()] * len(cut.points)
    links = adjacencies_of(cut, crossings, keys)
    return region_numbers(keys, [(a.first, a.second, None) for a in links if a.component is None])


def adjacencies_of(
    cut: Decomposition, crossings: Sequence[Crossing], keys: Sequence[tuple[int, ...]]
) -> Iterator[Adjacency]:
    """Pairs of cells within each stack, and then with the next one."""

    def link(first: int, second: int, component: int | None, segment: Segment | None) -> Adjacency:
        if component is None:
            kind = Merge.PROVEN
        else:
            kind = Merge.EQUAL_COUNT if keys[first] == keys[second] else Merge.SEPARATED
        return Adjacency(first, second, component, segment, kind)

    across = cut.lines_across
    for s, (first, following) in enumerate(pairwise(cut.first_cells)):
        for level, wall in enumerate(cut.stacks[s].walls):
            yield link(first + level, first + level + 1, wall.component, None)
        if s < len(crossings):
            for p in crossings[s].separators:
                yield link(first + p.left, following + p.right, across[s], segment_of(p))


def segment_of(separator: Separator) -> Segment:
    """The open segment by which a separator joins two cells, as answers have it."""
    return (to_fraction(separator.low), to_fraction(separator.high), to_fraction(separator.height))


def _coefficients(p: UnivariatePolynomial) -> tuple[int, ...]:
    return tuple(int(c) for c in p.coeffs())
