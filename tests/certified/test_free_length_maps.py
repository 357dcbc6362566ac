"""Certified maps of the shipped slices with free lengths, against the exact engine and a dense
numerical search.
"""

from __future__ import annotations

import random
from fractions import Fraction
from pathlib import Path

import pytest

pytest.importorskip("numba")

from support.dense_search import dense_search
from support.maps import part_of_free02, shipped, shipped_certified

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.errors import LimitReached
from ptmcad.question.config import load, slice_from_options
from ptmcad.question.slice import Count, Slice

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
FREE = sorted(path.stem for path in CONFIGS.glob("free*.yaml"))
EXACT = ("fig2", "fig3", "fig4", "fig5-text", "fig5-caption")


def random_points(slice: Slice, number: int, seed: int) -> list[tuple[Fraction, Fraction]]:
    generator = random.Random(seed)
    points = []
    for _ in range(number):
        x, y = (
            axis.low + (axis.high - axis.low) * Fraction(generator.randrange(1, 10**9), 10**9)
            for axis in slice.axes
        )
        points.append((x, y))
    return points


def differing(
    result: RegionMap, number: int, seed: int, grid: int
) -> list[tuple[float, float, object, object]]:
    """The points at which the map's count is not that of the search."""
    slice, wrong = result.slice, []
    which = slice.count.value
    for x, y in random_points(slice, number, seed):
        told = result.locate(**dict(zip(slice.axis_names, (x, y), strict=True)))
        count = getattr(told, which)
        if count is None:
            assert told.status is Status.UNDECIDED
            continue
        values = {
            name: float(expression.evaluate(x, y)) for name, expression in slice.parameters.items()
        }
        # a coarse search may miss some; a finer one has the last word
        if not any(dense_search(values, fineness)[which] == count for fineness in (grid, 4 * grid)):
            wrong.append((float(x), float(y), count, dense_search(values, 4 * grid)[which]))
    return wrong


def certified(slice: Slice, tolerance: str, count: Count | None = None) -> RegionMap:
    return ptmcad.classify(slice, engine="certified", tolerance=Fraction(tolerance), count=count)


def agree_with_exact(name: str, free: str | None, tolerance: str) -> None:
    """Areas and 1000 random points of the certified map against the exact one."""
    slice = load(CONFIGS / f"{name}.yaml")
    exact = shipped(name)
    if free is None:
        result = shipped_certified(name, tolerance)
    else:
        result = certified(
            slice_from_options(CONFIGS / f"{name}.yaml", sets=[f"l0={free}"]), tolerance
        )
    window = (slice.axes[0].high - slice.axes[0].low) * (slice.axes[1].high - slice.axes[1].low)
    assert result.undetermined <= Fraction(tolerance)
    for stable in {region.stable for region in exact.regions}:
        low = sum(region.area[0] for region in result.regions if region.stable == stable)
        true = [
            sum(region.area[k] for region in exact.regions if region.stable == stable)
            for k in (0, 1)
        ]
        assert low <= true[1]
        assert true[0] <= low + result.undetermined * window
    for x, y in random_points(slice, 1000, 5):
        at = dict(zip(slice.axis_names, (x, y), strict=True))
        told, known = result.locate(**at), exact.locate(**at)
        assert told.stable is None or known.stable is None or told.stable == known.stable, at


@pytest.mark.parametrize("name", ["fig4", "fig5-text"])
@pytest.mark.slow_cases("fig5-text")
def test_without_free_lengths_the_engines_agree(name: str) -> None:
    agree_with_exact(name, None, "1/100")


@pytest.mark.slow
@pytest.mark.parametrize("free", [None, "1e-12"], ids=["zero", "1e-12"])
@pytest.mark.parametrize("name", EXACT)
def test_the_engines_agree_on_every_slice_of_the_paper(name: str, free: str | None) -> None:
    agree_with_exact(name, free, "1/200")


def check_free02(result: RegionMap, tolerance: Fraction) -> None:
    """Counts and areas are those of REFERENCE, from 160 x 160 grids and a map with 0.01 %
    undetermined.
    """
    assert result.status is Status.CERTIFIED
    assert result.undetermined <= tolerance
    for count, known in ((1, Fraction("2.569")), (2, Fraction("1.329"))):
        low = sum(r.area[0] for r in result.regions if r.stable == count)
        # what is undetermined of the window, whose area is 3.9, may belong to it
        assert (
            low - Fraction("0.002")
            < known
            < low + Fraction(39, 10) * result.undetermined + Fraction("0.002")
        )
    assert RegionMap.from_json(result.to_json()) == result
    assert differing(result, 12, 3, 40) == []


def test_a_dense_search_agrees_on_a_part_of_free02() -> None:
    result = part_of_free02()
    assert (result.status, result.undetermined <= Fraction(1, 50)) == (Status.CERTIFIED, True)
    assert sorted(region.stable for region in result.regions if region.stable) == [1, 1, 2, 2]
    assert RegionMap.from_json(result.to_json()) == result
    assert differing(result, 6, 3, 40) == []


@pytest.mark.slow
def test_free02_has_the_known_counts_and_areas() -> None:
    check_free02(shipped_certified("free02", "1/50"), Fraction(1, 50))


@pytest.mark.slow
def test_free02_resumed_has_the_known_counts_and_areas() -> None:
    """The largest number of stable equilibria, 3, has a tiny region near (0.22, 1)."""
    coarse = shipped_certified("free02", "1/50")
    check_free02(
        ptmcad.classify(coarse.slice, tolerance=Fraction(1, 200), resume=coarse), Fraction(1, 200)
    )


def test_jobs_do_not_change_the_map() -> None:
    slice = load(CONFIGS / "fig4.yaml")
    one = ptmcad.classify(slice, engine="certified", tolerance=Fraction(1, 50), jobs=1)
    assert one.to_json(timings=False) == shipped_certified("fig4", "1/50").to_json(timings=False)


@pytest.mark.slow
def test_a_limit_leaves_a_map_from_which_the_search_goes_on() -> None:
    slice = load(CONFIGS / "fig4.yaml")
    coarse = shipped_certified("fig4", "1/50")
    fine = ptmcad.classify(slice, engine="certified", tolerance=Fraction(1, 200), resume=coarse)
    assert fine.undetermined <= Fraction(1, 200)
    assert sum(r.area[0] for r in fine.regions) > sum(r.area[0] for r in coarse.regions)
    partial, timeout = None, 1
    while partial is None:  # as long as the limit comes before anything is decided
        with pytest.raises(LimitReached) as stopped:
            ptmcad.classify(
                slice, engine="certified", tolerance=Fraction(1, 10**13), timeout=timeout
            )
        partial, timeout = stopped.value.partial, 2 * timeout
    assert isinstance(partial, RegionMap)
    assert partial.status is Status.PARTIAL


def test_a_map_that_is_fine_enough_is_not_searched_again() -> None:
    slice = load(CONFIGS / "fig4.yaml")
    fine = shipped_certified("fig4", "1/100")
    again = ptmcad.classify(slice, engine="certified", tolerance=Fraction(1, 50), resume=fine)
    assert again.cover == fine.cover
    assert again.status is Status.CERTIFIED
    assert [region.area for region in again.regions] == [region.area for region in fine.regions]


def test_a_search_that_hardly_begins_keeps_the_map_it_goes_on_from() -> None:
    slice = load(CONFIGS / "fig4.yaml")
    known = shipped_certified("fig4", "1/100")
    with pytest.raises(LimitReached) as stopped:
        ptmcad.classify(
            slice, engine="certified", tolerance=Fraction(1, 10**5), timeout=0.01, resume=known
        )
    assert isinstance(stopped.value.partial, RegionMap)
    assert stopped.value.partial.undetermined <= known.undetermined


@pytest.mark.parametrize("bar", ["L1", "L2"])
@pytest.mark.slow_cases("L1")
@pytest.mark.slow
def test_a_slice_that_is_a_crease_has_total_counts(bar: str) -> None:
    """A spring has no length on a circle of configurations at each point: it points along a line
    that turns.
    """
    slice = slice_from_options(
        slice="rho,F",
        ranges=["rho=1:2", "F=-10:-5"],
        sets=[f"{bar}=rho", "F3=F", "l0=1/5"],
        count="total",
    )
    found = ptmcad.classify(slice, tolerance="1/20", jobs=1)
    assert found.cells
    assert differing(found, 10, 11, 40) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", FREE)
def test_a_dense_search_agrees_at_1000_random_points(name: str) -> None:
    result = certified(load(CONFIGS / f"{name}.yaml"), "1/100")
    assert differing(result, 1000, 11, 40) == []


@pytest.mark.slow
@pytest.mark.parametrize("count", [Count.TOTAL, Count.ADMISSIBLE, Count.INDEX])
def test_a_dense_search_agrees_on_other_counts(count: Count) -> None:
    result = certified(load(CONFIGS / "free02.yaml"), "1/50", count)
    assert differing(result, 200, 11, 80) == []


TOUCHING = {
    "a free length is zero along a line inside": (
        {"l0_1": 0, "l0_2": 0, "l0_3": "(m-2/3)^2", "F3": -3, "F4": -5}, {"rho": ["1", "3/2"], "m": ["1/2", "1"]}
    ),
    "a free length is zero on two edges": (
        {"l0": "m^3*(2-rho)", "F3": -6, "F4": -9}, {"rho": ["1/2", "2"], "m": ["0", "1"]}
    ),
    "a stiffness is zero on an edge": (
        {"k3": "100*m", "l0": "1/5", "F3": -6, "F4": -9}, {"rho": ["1/2", "3/2"], "m": ["0", "1/2"]}
    ),
    "a length is zero in a corner": (
        {"L1": "m+rho-1/2", "l0": "1/5", "F3": -6, "F4": -9}, {"rho": ["1/2", "3/2"], "m": ["0", "1"]}
    ),
    "a denominator is zero in a corner": (
        {"l0_1": "m/(m+rho-1/2)", "l0": "1/10", "F3": -6, "F4": -9}, {"rho": ["1/2", "1"], "m": ["0", "1/2"]}
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", TOUCHING)
def test_slices_that_only_touch_the_limits_of_the_domain(name: str) -> None:
    """Signs that are allowed, zeros among them: the certified counts are those of a dense search."""
    parameters, axes = TOUCHING[name]
    slice = ptmcad.slice_from_mapping(
        {"parameters": {"L1": 1, "L2": 1, "k": 100, **parameters}, "axes": axes}
    )
    assert not differing(certified(slice, "1/5"), 40, 3, 60)
