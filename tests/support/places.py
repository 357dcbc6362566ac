"""Random points of a slice, and areas of regions with a count in certified and in exact maps."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

from ptmcad import RegionMap, Slice


def random_points(slice: Slice, number: int, seed: int) -> list[tuple[Fraction, Fraction]]:
    """Rational points of the open window."""
    rng = random.Random(seed)
    one, two = (
        [a.low + (a.high - a.low) * Fraction(rng.randrange(1, 10**6), 10**6) for _ in range(number)]
        for a in slice.axes
    )
    return list(zip(one, two, strict=True))


def area_with(result: RegionMap, count: str, value: Any) -> tuple[Fraction, Fraction]:
    """The area of the regions with a count, when the undetermined part belongs to them or not."""
    across, up = result.slice.axes
    area = sum((r.area[0] for r in result.regions if getattr(r, count) == value), Fraction(0))
    return area, area + result.undetermined * (across.high - across.low) * (up.high - up.low)


def assert_same_areas(certified: RegionMap, exact: RegionMap, count: str = "stable") -> None:
    """Of each count of the exact map, whose bounds are close."""
    for value in {getattr(region, count) for region in exact.regions}:
        low, high = area_with(certified, count, value)
        areas = [r.area for r in exact.regions if getattr(r, count) == value]
        assert low <= sum(area[1] for area in areas)
        assert sum(area[0] for area in areas) <= high
