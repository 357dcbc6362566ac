"""What every exact map of the paper's mechanism must satisfy, whatever the slice: checked from the
stored map alone, with exact numbers.
"""

from __future__ import annotations

from ptmcad import RegionMap
from ptmcad.answer.regionmap import Cell, Status
from ptmcad.question.slice import Count
from ptmcad.verification.claims import Claims
from ptmcad.verification.merging import check_merges, check_regions, check_shape


def key(cell: Cell, count: Count) -> object:
    """What the cell has of this count."""
    return {Count.STABLE: cell.stable, Count.TOTAL: cell.total, Count.INDEX: cell.index}[count]


def check_structure(result: RegionMap) -> None:
    """Raise AssertionError or a violation when the map contradicts itself: its tables fit each
    other, theorem 1 holds in each cell, areas make up the window, samples and segments are where
    their cells are.
    """
    for check in (check_shape, check_merges, check_regions):
        check(Claims(result))
    assert (result.status, result.undetermined) == (Status.EXACT, 0)
    assert {(c.total, c.stable) for c in result.cells} <= {(4, 1), (6, 1), (6, 2)}, "theorem 1"
    assert all(c.index and c.index[0] + c.index[2] == c.index[1] for c in result.cells), "Euler"
    x, y = result.slice.axes
    low, high = (sum(region.area[k] for region in result.regions) for k in (0, 1))
    assert low <= (x.high - x.low) * (y.high - y.low) <= high
    for n, cell in enumerate(result.cells):
        found = result.locate(**cell.sample)
        assert (found.cell, found.region) == (n, cell.region)
    base, other = (result.slice.axis_names[k] for k in (result.base, 1 - result.base))
    for a in result.adjacencies:
        if a.segment is not None:
            *ends, height = a.segment
            cells = [result.locate(**{base: u, other: height}).cell for u in ends]
            assert cells == [a.first, a.second]
