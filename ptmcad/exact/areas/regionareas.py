"""Areas of a map's regions; where an involution maps the window to itself, those of one half and of
its images.

Guarantee: each area lies in its bounds. A region's part in the other half is the image of its
image's part in this one: an involution keeps areas, and takes regions to regions, as these do not
depend on how they were cut into cells. The stacks of the half cover it, the walls over each are all
that lie in it, and the last cell of a stack is cut off by the half's ceiling.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import accumulate, pairwise
from math import prod

from flint import fmpq

from ptmcad.algebra.chords import on_graph
from ptmcad.algebra.polynomials import RationalUnivariate, UnivariatePolynomial
from ptmcad.algebra.real_roots import (
    RealRoot,
    halve,
    inside,
    isolate,
    numbered_disjoint,
    order,
    squarefree_part,
)
from ptmcad.algebra.resultants import Check
from ptmcad.answer.regionmap import Wall
from ptmcad.exact.areas.area import RegionStacks, region_areas
from ptmcad.exact.cad.decomposition import Decomposition, members
from ptmcad.exact.cad.stacks import BaseEnd, StackData, level_at
from ptmcad.exact.stages import Areas, Cells, SliceProblem
from ptmcad.model.involutions import Involution
from ptmcad.text.flint_numbers import from_fraction, simplest_between, to_fraction
from ptmcad.text.numerals import decimal, fraction_of


def areas_of(
    problem: SliceProblem, cells: Cells, tolerance: Fraction, without: frozenset[str], check: Check
) -> Areas:
    """Bounds of the regions' areas.

    Parameters
    ----------
    tolerance : largest relative width of each region's bounds before they are written in decimals.
    """
    region_of = cells.neighbours.region_of
    if "equal-counts" in without:
        each_cell = region_stacks(cells.cut, range(len(region_of)))
        of_cells, bits = region_areas(each_cell, tolerance, check)
        sums = (
            _sum_of([of_cells[n] for n in region], problem.slice.area)
            for region in members(region_of)
        )
        return Areas(tuple(map(_in_decimals, sums)), bits)
    whole = region_stacks(cells.cut, region_of)
    half, change = _half_of(whole, cells, problem.reflections)
    bounds, bits = region_areas(half, tolerance, check)
    return Areas(tuple(map(_in_decimals, bounds)), bits, change)


def _in_decimals(bounds: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
    """The bounds rounded outwards."""
    low, high = bounds
    return fraction_of(decimal(low, up=False)), fraction_of(decimal(high, up=True))


def region_stacks(cut: Decomposition, regions: Iterable[int]) -> RegionStacks:
    """The decomposition with the region of each of its cells, as areas are computed from it."""
    return RegionStacks(cut.stacks, cut.rows(regions), cut.variety.curves, cut.base, cut.fibre)


def _sum_of(
    areas: Sequence[tuple[Fraction, Fraction]], most: Fraction
) -> tuple[Fraction, Fraction]:
    return sum((low for low, _ in areas), Fraction(0)), min(
        sum((high for _, high in areas), Fraction(0)), most
    )


def _half_of(
    whole: RegionStacks, cells: Cells, reflections: Sequence[Involution]
) -> tuple[RegionStacks, Involution | None]:
    """The half of the window that an involution maps to the other one, and the involution; the
    whole where there is none, or where it is not seen what it maps regions to.
    """
    base = cells.cut.variety.base
    # the halves before and behind an abscissa need no cuts, and are the cheapest
    change = min(reflections, key=lambda c: (c.axes, c.axis_signs[base]), default=None)
    images = None if change is None else _images(cells, change)
    if change is None or images is None:
        return whole, None
    parts = whole._replace(images=images)
    shift = from_fraction(change.shifts[base])
    if change.axes == (1, 0):  # the points are fixed where v = sign (u - shift)
        sign = change.axis_signs[base]
        half = below(parts, RationalUnivariate([-sign * shift, sign]))
    elif change.axis_signs[base] < 0:
        half = before(parts, shift / 2)
    else:
        half = below(parts, RationalUnivariate([from_fraction(change.shifts[1 - base]) / 2]))
    return half, change


def _images(cells: Cells, change: Involution) -> tuple[int, ...] | None:
    """The image of each region; None where all samples of one have their images on lines over
    critical abscissae.

    Raises
    ------
    ArithmeticError
        When the decomposition or the counts contradict the involution.
    """
    region_of, keys = cells.neighbours.region_of, cells.counts.keys
    images = []
    for region in members(region_of):
        points = (
            change.at((to_fraction(x), to_fraction(y)))
            for x, y in (cells.cut.points[n] for n in region)
        )
        places = (cells.cut.cell_at((from_fraction(x), from_fraction(y))) for x, y in points)
        image = next((n for n in places if n is not None), None)
        if image is None:
            return None
        if keys[image] != keys[region[0]]:
            raise ArithmeticError("a region's mirror image is no region of the same count")
        images.append(region_of[image])
    if any(images[images[i]] != i for i in images):
        raise ArithmeticError("the mirror image of a region's mirror image is another region")
    return tuple(images)


def before(parts: RegionStacks, middle: fmpq) -> RegionStacks:
    """The half before an abscissa."""
    stacks, rows = [], []
    for stack, row in zip(parts.stacks, parts.regions, strict=True):
        left, right = (_apart(end, middle) for end in (stack.left, stack.right))
        if left.root.middle >= middle:
            break
        if right.root.middle > middle:
            right = BaseEnd(RealRoot.of(middle), None)
        stacks.append(_between(left, right, stack.walls, stack.heights))
        rows.append(row)
    return parts._replace(stacks=stacks, regions=rows)


def below(parts: RegionStacks, line: RationalUnivariate) -> RegionStacks:
    """The half below a line, which is within the window: its stacks end where walls cross the line,
    too.
    """
    ends = [stack.right.root for stack in parts.stacks[:-1]]
    on_line = (q for c in parts.curves if (q := on_graph(c.in_v, line)))
    crossings = squarefree_part(prod(on_line, start=UnivariatePolynomial([1])))
    for k, end in enumerate(ends):
        if k == 0 or end.polynomial != ends[k - 1].polynomial:
            crossings //= crossings.gcd(end.polynomial)
    numbered = numbered_disjoint([*ends, *isolate(crossings, *parts.base)])
    cuts = inside([root for _, root in numbered], parts.base)
    edges = map(RealRoot.of, parts.base)
    places = [BaseEnd(place, None) for place in (next(edges), *cuts, next(edges))]
    # the numbers of the abscissae come first: behind each of them the next stack begins
    begun = accumulate((number < len(ends) for number, _ in numbered), initial=0)
    stacks, rows = [], []
    for (left, right), number in zip(pairwise(places), begun, strict=True):
        walls, heights = parts.stacks[number].walls, parts.stacks[number].heights
        stack = _between(left, right, walls, heights)
        level = level_at(parts.curves, stack.sample, line(stack.sample), parts.fibre)
        stacks.append(stack._replace(walls=walls[:level], heights=heights[: level + 1]))
        rows.append(parts.regions[number][: level + 1])
    return parts._replace(stacks=stacks, regions=rows, ceiling=line)


def _apart(end: BaseEnd, middle: fmpq) -> BaseEnd:
    """The end with the interval of its root before or behind an abscissa, or as that abscissa."""
    root = end.root
    if order(middle, root) == 0:
        return BaseEnd(RealRoot(root.polynomial, middle, middle), None)
    while root.low <= middle <= root.high:
        root = halve(root)
    return BaseEnd(root, None)


def _between(
    left: BaseEnd, right: BaseEnd, walls: Sequence[Wall], heights: Sequence[fmpq]
) -> StackData:
    return StackData(
        left, right, simplest_between(left.root.high, right.root.low), tuple(walls), tuple(heights)
    )
