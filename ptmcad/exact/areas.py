"""Areas of a map's regions; where an involution maps the window to itself, those of one half and of
its images.

Guarantee: each area lies in its bounds. A region's part in the other half is the image of its
image's part in this one: an involution keeps areas, and takes regions to regions, as these do not
depend on how they were cut into cells.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from ptmcad.algebra.polynomials import RationalPolynomial
from ptmcad.algebra.resultants import Check
from ptmcad.exact.cad.area import RegionStacks, region_areas
from ptmcad.exact.cad.halves import before, below
from ptmcad.exact.decomposition import Decomposition
from ptmcad.exact.regions import members
from ptmcad.exact.stages import Areas, Cells, SliceProblem
from ptmcad.model.involutions import Involution
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.numerals import decimal, fraction_of


def areas_of(
    problem: SliceProblem, known: Cells, tolerance: Fraction, without: frozenset[str], check: Check
) -> Areas:
    """Bounds of the regions' areas.

    Parameters
    ----------
    tolerance : largest relative width of each region's bounds before they are written in decimals.
    """
    base, region_of = known.cut.variety.base, known.neighbours.region_of
    alone = "equal-counts" in without
    parts = region_stacks(known.cut, range(len(region_of)) if alone else region_of)
    # the halves before and behind an abscissa need no cuts, and are the cheapest
    reflections = sorted(
        problem.reflections, key=lambda change: (change.axes, change.axis_signs[base])
    )
    used = None
    for change in () if alone else reflections[:1]:
        images = _images(known, change)
        if images is not None:
            parts, used = _half(parts._replace(images=images), change, base), change
    bounds, bits = region_areas(parts, tolerance, check)
    if alone:
        bounds = tuple(
            _sum_of([bounds[n] for n in cells], problem.slice.area) for cells in members(region_of)
        )
    rounded = (
        (fraction_of(decimal(low, up=False)), fraction_of(decimal(high, up=True)))
        for low, high in bounds
    )
    return Areas(tuple(rounded), bits, used)


def region_stacks(cut: Decomposition, regions: Iterable[int]) -> RegionStacks:
    """The decomposition with the region of each of its cells, as areas are computed from it."""
    return RegionStacks(cut.stacks, cut.rows(regions), cut.variety.curves, cut.base, cut.fibre)


def _sum_of(
    areas: Sequence[tuple[Fraction, Fraction]], most: Fraction
) -> tuple[Fraction, Fraction]:
    return sum((low for low, _ in areas), Fraction(0)), min(
        sum((high for _, high in areas), Fraction(0)), most
    )


def _half(parts: RegionStacks, change: Involution, base: int) -> RegionStacks:
    """The half of the window that an involution, which moves some points, maps to the other one."""
    fixed = from_fraction(change.shifts[base])
    if change.axes == (1, 0):  # the points are fixed where v = sign (u - shift)
        sign = change.axis_signs[base]
        return below(parts, RationalPolynomial([-sign * fixed, sign]))
    if change.axis_signs[base] < 0:
        return before(parts, fixed / 2)
    return below(parts, RationalPolynomial([from_fraction(change.shifts[1 - base]) / 2]))


def _images(known: Cells, change: Involution) -> tuple[int, ...] | None:
    """The image of each region; None where all samples of one have their images on lines over
    critical abscissae.

    Raises
    ------
    ArithmeticError
        When the decomposition or the counts contradict the involution.
    """
    region_of, keys = known.neighbours.region_of, known.counts.keys
    images = []
    for cells in members(region_of):
        points = (
            change.at((to_fraction(x), to_fraction(y)))
            for x, y in (known.cut.points[n] for n in cells)
        )
        places = (known.cut.cell_at((from_fraction(x), from_fraction(y))) for x, y in points)
        image = next((n for n in places if n is not None), None)
        if image is None:
            return None
        if keys[image] != keys[cells[0]]:
            raise ArithmeticError("a region's mirror image is no region of the same count")
        images.append(region_of[image])
    if any(images[images[i]] != i for i in images):
        raise ArithmeticError("the mirror image of a region's mirror image is another region")
    return tuple(images)
