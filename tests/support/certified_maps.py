"""Certified maps made by hand: squares around the zeros of a function, and counts that are given."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import hypot

from ptmcad.answer.regionmap import Cell, Region, RegionMap, Status, System
from ptmcad.cover import components
from ptmcad.cover.complement import samples
from ptmcad.cover.rectangles import Cover, Rectangle
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Point

Function = Callable[[float, float], tuple[float, float]]
"""Value at a point of the unit square, and a bound of the gradient's length on the whole square."""


def around(function: Function, depth: int) -> Cover:
    """Squares of side 2^-depth that hold every zero of a function on the unit square."""
    steps = 2**depth
    found: list[Rectangle] = []
    waiting = [(0, 0, steps)]
    while waiting:
        x, y, side = waiting.pop()
        value, slope = function((x + side / 2) / steps, (y + side / 2) / steps)
        if abs(value) > slope * side / steps * 0.71:
            continue
        if side == 1:
            found.append((x, x + 1, y, y + 1))
            continue
        half = side // 2
        waiting += [(x + i * half, y + j * half, half) for i in (0, 1) for j in (0, 1)]
    return Cover(steps, tuple(sorted(found)))


def certified(
    cover: Cover,
    stable: Callable[[float, float], int],
    count: Count = Count.STABLE,
    status: Status = Status.CERTIFIED,
) -> RegionMap:
    """The map of a cover over rho in [0, 2], L2 in [0, 2], one region for each component, largest
    first.
    """
    record = {
        "name": "by-hand",
        "parameters": {"L1": 1, "k": 100, "F3": -10, "F4": -10, "l0": "1/5"},
        "axes": {"rho": [0, 2], "L2": [0, 2]},
        "count": count.value,
    }
    slice = slice_from_mapping(record)
    window = ((slice.axes[0].low, slice.axes[0].high), (slice.axes[1].low, slice.axes[1].high))
    complement = components(cover)
    square = (window[0][1] - window[0][0]) * (window[1][1] - window[1][0]) / cover.steps**2
    cells, regions = [], []
    for n in range(len(complement.areas)):
        x, y = next(samples(complement, n, window))
        low, high = complement.area_bounds(n, range(len(complement.areas)))
        minima = stable(float(x) / 2, float(y) / 2)
        point = Point(slice.axis_names, x, y)
        total, index = 2 * minima + 2, (minima, minima + 1, 1)
        cells.append(Cell(None, n, point, n, total, minima, index, (), {"admissible": minima}))
        regions.append(
            Region(
                minima,
                total,
                index,
                (low * square, high * square),
                (n,),
                point,
                {"admissible": minima},
            )
        )
    open_area = cover.steps**2 - sum(complement.areas)
    system = System(("th1", "th2"), (), "", (), ())
    return RegionMap(
        slice=slice, status=status, system=system, cells=tuple(cells), regions=tuple(regions),
        undetermined=Fraction(open_area, cover.steps**2), versions={}, cover=cover,
    )  # fmt: skip


@cache
def circle(depth: int = 9) -> RegionMap:
    """A circle of radius 1/2 around the window's centre: 3 stable inside, 2 outside."""

    def function(x: float, y: float) -> tuple[float, float]:
        return hypot(x - 0.5, y - 0.5) - 0.25, 1.0

    return certified(
        around(function, depth), lambda x, y: 3 if hypot(x - 0.5, y - 0.5) < 0.25 else 2
    )


@cache
def cusp(depth: int = 13) -> RegionMap:
    """A curve with a cusp, which bounds a thin region at the cusp: 4 stable inside, 1 outside."""

    def function(x: float, y: float) -> tuple[float, float]:
        u, v = x - 0.2, y - 0.5
        return v * v - u * u * u, 2.2

    return certified(
        around(function, depth),
        lambda x, y: 4 if x > 0.2 and (y - 0.5) ** 2 < (x - 0.2) ** 3 else 1,
    )


@cache
def crossing(depth: int = 10) -> RegionMap:
    """Two crossing curves and a strip that is undetermined as a whole: counts 1, 2, 3 and 2."""

    def function(x: float, y: float) -> tuple[float, float]:
        return (y - 0.3 - 0.5 * x) * (y - 0.8 + 0.4 * x), 2.0

    cover = around(function, depth)
    strip = (0, cover.steps // 32, 0, cover.steps)
    cover = Cover(cover.steps, tuple(sorted({*cover.rectangles, strip})))
    return certified(cover, lambda x, y: 1 + (y > 0.3 + 0.5 * x) + (y > 0.8 - 0.4 * x))
