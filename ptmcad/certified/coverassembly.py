"""From a cover and counts at points to a region map.

Guarantee: every cell's counts are proved at its sample, and hold in the whole cell because no curve
enters it. A component of the cover's complement gets no cell when its counts were not decided, or
when it is a pocket: so small that it may be an artefact of the boxes, with the same counts as a
larger component next to it. Its area is then undetermined.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import islice

from ptmcad.answer.counts import counted_by
from ptmcad.answer.regionmap import Cell, Region, RegionMap, Status
from ptmcad.certified.plain.pointcounts import BranchCounter
from ptmcad.certified.plain.zeros import PointCount
from ptmcad.certified.statement import system_text
from ptmcad.cover.complement import Components, samples
from ptmcad.question.counts import Count
from ptmcad.question.slice import Point, Slice

MAX_COUNTED = 500
"""Components whose counts are computed; smaller ones are undetermined."""
POCKET_SHARE = Fraction(1, 4000)
"""Share of the window, or a tenth of the cover's if that is less: smaller components with the
counts of a larger one next to them are taken for artefacts. So a region that is there in truth
appears as the cover shrinks."""


def assembled(
    complement: Components,
    slice: Slice,
    counter: BranchCounter,
    status: Status,
    late: Callable[[], bool] = lambda: False,
) -> RegionMap:
    """The map of the window outside a cover, without a plan, versions and timings.

    Parameters
    ----------
    late : asked before each count but the first; components that are not counted when it says True,
        the smallest ones, stay undetermined.
    """
    cover = complement.cover
    pocket = min(POCKET_SHARE * cover.steps**2, Fraction(sum(complement.cluster_areas), 10))
    counted = _counts(complement, slice, counter, pocket, late)
    kept = [n for n in counted if not _is_pocket(n, pocket, complement, counted, slice.count)]
    known = frozenset(kept)
    square = slice.area / cover.steps**2
    cells, regions = [], []
    for region, n in enumerate(kept):
        sample, count = counted[n]
        cells.append(
            Cell(
                None,
                n,
                sample,
                region,
                count.total,
                count.stable,
                count.index,
                count.solutions,
                count.further,
            )
        )
        low, high = complement.area_bounds(n, known)
        area = (low * square, high * square)
        regions.append(
            Region(count.stable, count.total, count.index, area, (region,), sample, count.further)
        )
    open_area = cover.steps**2 - sum(complement.areas[n] for n in kept)
    return RegionMap(
        slice=slice,
        status=status,
        system=system_text(slice.model, slice.has_free_lengths),
        cells=tuple(cells),
        regions=tuple(regions),
        undetermined=Fraction(open_area, cover.steps**2),
        versions={},
        cover=cover,
    )


def _counts(
    complement: Components,
    slice: Slice,
    counter: BranchCounter,
    pocket: Fraction,
    late: Callable[[], bool],
) -> dict[int, tuple[Point, PointCount]]:
    """Samples and counts of the components, largest first, as far as they are decided; small ones
    only easily.
    """
    horizontal, vertical = slice.axes
    window = ((horizontal.low, horizontal.high), (vertical.low, vertical.high))
    counted = {}
    for n in range(min(len(complement.areas), MAX_COUNTED)):
        if n > 0 and late():
            break
        large = complement.areas[n] >= pocket
        for x, y in islice(samples(complement, n, window), 3 if large else 1):
            sample = Point((horizontal.name, vertical.name), x, y)
            count = counter.at(sample[0], sample[1], slice.count, thorough=large)
            if count.decided:
                counted[n] = (sample, count)
                break
    return counted


def _is_pocket(
    n: int,
    least: Fraction,
    complement: Components,
    counted: Mapping[int, tuple[Point, PointCount]],
    which: Count,
) -> bool:
    """Whether a component is smaller than ``least`` and a larger one at the same cluster has the
    same count.
    """
    if complement.areas[n] >= least:
        return False
    near = set(complement.clusters_at[n])
    mine = counted_by(counted[n][1], which)
    return any(
        m < n
        and counted_by(counted[m][1], which) == mine
        and near.intersection(complement.clusters_at[m])
        for m in counted
    )
