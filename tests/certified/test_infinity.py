"""Solutions that leave to infinity within the window: the curves on which they do are enclosed like folds."""

from __future__ import annotations

import random
from fractions import Fraction
from math import log
from typing import Any

import pytest
from support.few import few
from support.random_models import random_system

import ptmcad
from ptmcad.certified.plain.curves import curves
from ptmcad.certified.plain.infinity import patches
from ptmcad.certified.plain.points import plain_counter as point_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.errors import ConfigError, HypothesisError
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice

ONE = {"x": "real"}
PAIR = {"x": "real", "y": "real"}


def small(system: dict[str, Any], axes: dict[str, list[Any]], **more: Any) -> Slice:
    return slice_from_mapping({"name": "small", "system": system, "axes": axes, **more})


def certified(slice: Slice, tolerance: str = "1/100") -> ptmcad.RegionMap:
    return ptmcad.classify(slice, engine="certified", tolerance=tolerance, jobs=1)


def area(result: ptmcad.RegionMap, total: int) -> tuple[Fraction, Fraction]:
    """Of the regions with a count, when the undetermined part belongs to them or not."""
    across, up = result.slice.axes
    found = sum((r.area[0] for r in result.regions if r.total == total), Fraction(0))
    return found, found + result.undetermined * (across.high - across.low) * (up.high - up.low)


def test_two_roots_leave_to_infinity_on_a_line() -> None:
    """a x^2 + a + 1 has two roots where -1 < a < 0; at a = 0 none is double."""
    slice = small({"unknowns": ONE, "equations": ["a*x^2 + a + 1"]}, {"a": [-2, 2], "b": [0, 1]})
    names = [curve.name for curve in curves(slice, Count.TOTAL)]
    assert names == [
        "fold", *["fold with x large", "solution of which x is infinite with x large"] * 2,
    ]  # fmt: skip
    result = certified(slice)
    low, high = area(result, 2)
    assert low <= 1 <= high and len(result.regions) == 3
    assert ptmcad.verify(result).ok


def test_a_fold_far_away_is_found_in_the_inverse_of_the_unknown() -> None:
    """a x^2 - 2 x + b: roots meet at x = 1/a where a b = 1, and one of them leaves where a = 0."""
    slice = small({"unknowns": ONE, "equations": ["a*x^2 - 2*x + b"]}, {"a": [-1, 1], "b": [-8, 8]})
    result = certified(slice, "1/50")
    none = 2 * (7 - log(8))
    low, high = area(result, 0)
    assert low <= none <= high
    low, high = area(result, 2)
    assert low <= 32 - none <= high


def test_inequalities_hold_at_infinity_too() -> None:
    """1/a is positive on one side only; where it is not, that it leaves to infinity changes nothing."""
    axes: dict[str, list[Any]] = {"a": [-1, 1], "b": [0, 1]}
    positive = certified(small({"unknowns": ONE, "equations": ["a*x - 1"], "positive": ["x"]}, axes))
    assert (positive.locate(a="-1/2", b="1/2").total, positive.locate(a="1/2", b="1/2").total) == (0, 1)
    nowhere = small({"unknowns": ONE, "equations": ["a*x - 1"], "positive": ["1 - x^2"]}, axes)
    assert len(patches(problem_of(nowhere), nowhere.axes)) == 1
    result = certified(nowhere)
    assert {cell.total for cell in result.cells} == {0} and result.undetermined < Fraction(1, 1000)


@pytest.mark.parametrize("count", ["total", "index", "stable"])
def test_critical_points_that_come_from_infinity(count: str) -> None:
    """a x + b x^3 has a minimum and a maximum where a b < 0; they leave at b = 0 and meet at a = 0."""
    slice = small({"unknowns": ONE, "potential": "a*x + b*x^3"}, {"a": [-1, 1], "b": [-1, 1]}, count=count)
    result = certified(slice)
    for a, b in (("1/2", "1/2"), ("-1/2", "1/2"), ("1/2", "-1/2"), ("-1/2", "-1/2")):
        there = Fraction(a) * Fraction(b) < 0
        expected: dict[str, Any] = {"total": 2 * there, "stable": int(there), "index": (int(there),) * 2}
        assert getattr(result.locate(a=a, b=b), count) == expected[count]


def test_a_stable_fold_is_found_where_the_unknown_is_inverted() -> None:
    """There the Jacobian is no Hessian, whose minors would not be negative: its first entry changes its sign."""
    system = {"unknowns": {"x": "real", "t": "angle"}, "potential": "a*x^3/3 + b*x - 2*cos(t) + x*sin(t)"}
    slice = small(system, {"a": [-1, 1], "b": [-2, 2]}, count="stable")
    result = certified(slice, "1/40")
    assert compared(slice, result, 200, 1) > 150
    low, high = (sum((r.area[0] for r in result.regions if r.stable == n), Fraction(0)) for n in (0, 1))
    assert low > 2 and high > 2


@pytest.mark.parametrize("equations", [
    pytest.param(["a*x + y - 1", "x - b*y - 1/2"], marks=pytest.mark.slow),
    ["x*y - a", "x + y*a - b"],
    pytest.param(["b*x*y - 1", "x + y - a"], marks=pytest.mark.slow),
])  # fmt: skip
def test_maps_of_pairs_agree_with_the_exact_engine(equations: list[str]) -> None:
    slice = small({"unknowns": PAIR, "equations": equations}, {"a": [-1, 2], "b": [-3, 3]})
    assert len(patches(problem_of(slice), slice.axes)) > 1
    assert compared(slice, certified(slice, "1/40"), 60, 1) > 45


INFINITE = (3, 9, 22, 23, 33, 46)
CONDITIONED = (10, 14, 20, 36, 44, 62)


@pytest.mark.parametrize("seed", few([*INFINITE, *CONDITIONED], 3, 22, 33, 46, *CONDITIONED))
@pytest.mark.fast_cases("46", "20")
def test_maps_of_random_systems_agree_with_the_exact_engine(seed: int) -> None:
    record = random_system(seed)
    slice = slice_from_mapping({"name": "small", **record})
    many = len(patches(problem_of(slice), slice.axes)) > 1
    assert many if seed in INFINITE else "positive" in record["system"]
    result = certified(slice, "1/20")
    assert compared(slice, result, 40, seed) > 25


def compared(slice: Slice, result: ptmcad.RegionMap, number: int, seed: int) -> int:
    """How many random points of the cells have the exact engine's count; all that could be compared."""
    rng, found = random.Random(seed), 0
    for _ in range(number):
        at = {a.name: a.low + (a.high - a.low) * Fraction(rng.randint(1, 9972), 9973) for a in slice.axes}
        told = getattr(result.locate(**at), slice.count.value)
        if told is None:
            continue
        try:
            true = ptmcad.counts_at(slice.model, **{n: str(v) for n, v in at.items() if n in slice.model.variables})
        except HypothesisError:
            continue
        assert told == getattr(true, slice.count.value), at
        found += 1
    return found


def test_at_a_point_the_solutions_that_are_finite_there_are_counted() -> None:
    slice = small({"unknowns": ONE, "equations": ["(a*x - 1)*(x - b)"]}, {"a": [-1, 1], "b": [0, 1]})
    counter = point_counter(slice)
    third = Fraction(1, 3)
    assert counter.at(Fraction(0), third, Count.TOTAL).total == 1
    assert counter.at(Fraction(1, 10**6), third, Count.TOTAL).total == 2


def test_what_is_infinite_all_over_the_window_is_refused_by_name() -> None:
    """y is nothing's value where x is zero, whatever a and b are."""
    system = {"unknowns": PAIR, "equations": ["x*(y - a)", "x^2 - b*x"]}
    with pytest.raises(ConfigError, match="no bound of the unknown y"):
        certified(small(system, {"a": [-1, 1], "b": [1, 2]}))
