"""What every exact map of the paper's mechanism must satisfy, whatever the slice."""

from __future__ import annotations

import ptmcad
from ptmcad import RegionMap
from ptmcad.answer.regionmap import Cell, Status
from ptmcad.question.slice import Count


def key(cell: Cell, count: Count) -> object:
    """What the cell has of this count."""
    return {Count.STABLE: cell.stable, Count.TOTAL: cell.total, Count.INDEX: cell.index}[count]


def check_structure(result: RegionMap) -> None:
    """Raise AssertionError when the map contradicts itself: the checker accepts it, theorem 1 holds
    in each cell, areas make up the window, and samples are found where they are.
    """
    report = ptmcad.verify(result)
    assert report.ok, report.violation
    assert (result.status, result.undetermined) == (Status.EXACT, 0)
    assert {(c.total, c.stable) for c in result.cells} <= {(4, 1), (6, 1), (6, 2)}, "theorem 1"
    x, y = result.slice.axes
    low, high = (sum(region.area[k] for region in result.regions) for k in (0, 1))
    assert low <= (x.high - x.low) * (y.high - y.low) <= high
    for n, cell in enumerate(result.cells):
        found = result.locate(**cell.sample)
        assert (found.cell, found.region) == (n, cell.region)
