"""Certified maps made by hand: a cross of rectangles that parts the window into four cells, one of
them undecided.
"""

from __future__ import annotations

from fractions import Fraction

from ptmcad.answer.regionmap import Cell, PlanStep, Region, RegionMap, Solution, Status, System
from ptmcad.cover.rectangles import Cover
from ptmcad.question.config import slice_from_options
from ptmcad.question.slice import Count, Point, Slice
from support.replacing import replace

STEPS = 16
CROSS = ((0, 16, 7, 8), (10, 11, 0, 16), (10, 11, 3, 5))
"""Of 31 squares: the row between 7 and 8 and the column between 10 and 11; the third rectangle is
inside the second.
"""


def free_slice(count: Count = Count.STABLE) -> Slice:
    """A slice whose window is [0, 2] x [1, 3], so that a lattice step is 1/8."""
    return slice_from_options(
        slice="rho,L2",
        ranges=["rho=0:2", "L2=1:3"],
        sets=["l0=1/5", "F3=-10", "F4=-10"],
        count=count,
    )


def certified_map(count: Count = Count.STABLE, status: Status = Status.CERTIFIED) -> RegionMap:
    """The upper right quarter of the cross has no cell: its counts were not decided."""
    slice = free_slice(count)
    names = slice.axis_names
    # upper left, lower left, lower right, in the order of their areas in squares of a step
    samples = [("1/2", "5/2"), ("1/2", "3/2"), ("3/2", "3/2")]
    squares = [80, 70, 35]
    counts = [(5, 2, (2, 3, 0), 1), (3, 1, (1, 2, 0), 1), (7, 2, (2, 4, 1), 2)]
    solution = Solution((Fraction(3, 2**30), Fraction(-5, 2**7)), Fraction(1, 2**40), "++")
    cells, regions = [], []
    for n, ((x, y), area, (total, stable, index, admissible)) in enumerate(
        zip(samples, squares, counts, strict=True)
    ):
        sample = Point(names, Fraction(x), Fraction(y))
        bounds = (Fraction(area, 64), Fraction(area + 31, 64))
        further = {} if admissible is None else {"admissible": admissible}
        cells.append(
            Cell(None, n, sample, n, total, stable, index, (solution,) if n == 0 else (), further)
        )
        regions.append(Region(stable, total, index, bounds, (n,), sample, further))
    # components by area: 80 upper left, 70 lower left, 40 upper right (undecided), 35 lower right
    cells[2] = replace(cells[2], level=3)
    return RegionMap(
        slice=slice,
        status=status,
        system=System(("th1", "th2"), (), "1/2*k1*(sqrt(rho^2) - l0_1)^2", (), ()),
        cells=tuple(cells),
        regions=tuple(regions),
        plan=(PlanStep("fold of a stable equilibrium", True, "enclosed by branch and prune"),),
        undetermined=Fraction(31 + 40, 256),
        versions={"ptmcad": "0"},
        timings={"total": 1.5},
        cover=Cover(STEPS, tuple(sorted(CROSS))),
    )
