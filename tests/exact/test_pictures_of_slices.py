"""The arrangement of a slice is that of its region map, whichever axis the window is cut over."""

from __future__ import annotations

from fractions import Fraction

import pytest

import ptmcad
from ptmcad.answer.arrangement import correspondence
from ptmcad.answer.counts import counted_by
from ptmcad.answer.regionmap import Merge
from ptmcad.errors import ConfigError
from ptmcad.exact.slicearrangement import picture_of
from ptmcad.text.flint_numbers import from_fraction

SLICES = ("fig2", "fig4", "fig5-caption", "rods", "systems/kuramoto", "systems/cubic-and-quadratic")


@pytest.mark.parametrize("name", SLICES)
@pytest.mark.fast_cases("fig2", "rods")
def test_regions_and_neighbours_are_those_of_the_map(name: str) -> None:
    slice = ptmcad.load(f"configs/{name}.yaml")
    result = ptmcad.classify(slice, areas=False)
    found = picture_of(slice, base=result.base).arrangement
    assert found.keys == tuple(counted_by(region, slice.count) for region in result.regions)
    region_of = [cell.region for cell in result.cells]
    pairs = {tuple(sorted((region_of[a.first], region_of[a.second]))) for a in result.adjacencies
             if a.merge is Merge.SEPARATED}  # fmt: skip
    assert found.neighbours == pairs


@pytest.mark.parametrize("name", SLICES)
@pytest.mark.fast_cases("fig2", "rods")
def test_it_does_not_depend_on_the_base(name: str) -> None:
    slice = ptmcad.load(f"configs/{name}.yaml")
    first, second = (picture_of(slice, base=base) for base in (0, 1))
    assert correspondence(first.arrangement, second.arrangement) is not None


@pytest.mark.parametrize("name", SLICES)
@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.fast_cases("0-fig2", "1-fig2")
def test_sides_and_points_are_where_the_map_has_them(name: str, base: int) -> None:
    slice = ptmcad.load(f"configs/{name}.yaml")
    picture, result = picture_of(slice, base=base), ptmcad.classify(slice, areas=False)
    arrangement = picture.arrangement
    x, y = slice.axes
    beside = Fraction(1, 10**24)
    for number, side in enumerate(arrangement.sides):
        along, across = (y, x) if number < 2 else (x, y)
        edge = across.high - beside if number % 2 else across.low + beside
        seen: list[int] = []
        for k in range(30):
            free = along.low + (along.high - along.low) * Fraction(
                200 * k + 101, 6_001
            )  # where no region has a tip
            point = (edge, free) if number < 2 else (free, edge)
            region = picture.region_at((from_fraction(point[0]), from_fraction(point[1])))
            located = result.locate(**dict(zip(slice.axis_names, point, strict=True)))
            if region is not None:
                assert arrangement.keys[region] == counted_by(located, slice.count)
                if not seen or seen[-1] != region:
                    seen.append(region)
        assert _is_subsequence(seen, side)  # short stretches may lie between the points


def test_free_lengths_are_the_other_engine_s() -> None:
    with pytest.raises(ConfigError, match="an arrangement is"):
        picture_of(ptmcad.load("configs/free02.yaml"))


def _is_subsequence(short: list[int], long: tuple[int, ...]) -> bool:
    rest = iter(long)
    return all(any(n == m for m in rest) for n in short)
