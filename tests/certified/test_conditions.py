"""Inequalities and conditions for stability by intervals, and unknowns on the line that bound one
another.
"""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest
import yaml
from support.places import area_with, assert_same_areas
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import Status
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.pointcounts import plain_counter as point_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.certified.plain.unknownranges import ranges
from ptmcad.certified.plain.zeros import PointCount
from ptmcad.errors import ConfigError, DegenerateSliceError
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.slice import Count, Slice
from ptmcad.show.report import page

PAIR = {"x": "real", "y": "real"}
SYSTEMS: dict[str, dict[str, Any]] = yaml.safe_load("""
schloegl:
  system:
    unknowns: {x: real}
    equations: [a*x^2 - x^3 - x + b]
    positive: [x]
    stable: [3*x^2 - 2*a*x + 1]
  axes: {a: [0, 4], b: [-1, 1]}
brusselator:
  system:
    unknowns: {x: real, y: real}
    equations: [a + x^2*y - (b + 1)*x, b*x - x^2*y]
    positive: [x, y]
    stable: [1 + x^2 + b - 2*x*y, x^2*(b + 1) - 2*x^3*y + 2*x^3*y - b*x^2]
  axes: {a: [1/10, 2], b: [1/10, 4]}
selkov:
  system:
    unknowns: {x: real, y: real}
    equations: [-x + a*y + x^2*y, b - a*y - x^2*y]
    positive: [x, y]
    stable: [1 - 2*x*y + a + x^2, a + x^2]
  axes: {a: [1/100, 1/5], b: [1/10, 6/5]}
competition:
  system:
    unknowns: {x: real, y: real}
    equations: [x*(a - x - y/2), y*(b - x/3 - y)]
    positive: [x, y]
  axes: {a: [0, 2], b: [0, 2]}
toggle:
  system:
    unknowns: {x: real, y: real}
    equations: [x*(1 + y^2) - a, y*(1 + x^2) - b]
    positive: [x, y]
    stable: [(1 + y^2)*(1 + x^2) - 4*x^2*y^2]
  axes: {a: [0, 4], b: [0, 4]}
double well:
  system: {unknowns: {x: real}, potential: x^4/4 - a*x^2/2 + b*x, positive: [x + 1/3]}
  axes: {a: [-1, 2], b: [-1, 1]}
torus:
  system:
    unknowns: {s: angle, t: angle}
    positive: [cos(s) + b*sin(t)]
    potential: -cos(s) - a*cos(t) - b*cos(s - t) - sin(s)/5
  axes: {a: [1/10, 2], b: ['-2', 2]}
""")
WINDOW: dict[str, list[Any]] = {"a": [0, 1], "b": [-3, 3]}


def slice_of(name: str, **changes: Any) -> Slice:
    return slice_from_mapping({"name": "small", **SYSTEMS[name], **changes})


def small(system: dict[str, Any], axes: dict[str, list[Any]], **more: Any) -> Slice:
    return slice_from_mapping({"name": "small", "system": system, "axes": axes, **more})


@pytest.mark.parametrize(("name", "count"), [
    pytest.param(name, count, marks=() if (k + j) % 2 else pytest.mark.slow)
    for j, count in enumerate(("total", "stable"))
    for k, name in enumerate(("schloegl", "selkov", "toggle", "double well"))
])  # fmt: skip
@pytest.mark.slow_cases("selkov-total", "toggle-stable", "double well-total")
def test_maps_agree_with_the_exact_engine(name: str, count: str) -> None:
    slice = slice_of(name, count=count)
    exact, certified = (
        ptmcad.classify(slice),
        ptmcad.classify(slice, engine="certified", tolerance="1/40", jobs=1),
    )
    assert_same_areas(certified, exact, count)
    for cell in certified.cells:
        at = exact.locate(**dict(zip(slice.axis_names, cell.sample, strict=True)))
        assert getattr(at, count) == getattr(cell, count)
        others = (
            {"admissible"}
            if slice.model.criterion.order
            else {"total", "stable", "index"} - {count}
        )
        assert not any(getattr(cell, other) is not None for other in others)


def test_a_sample_at_which_stability_changes_says_nothing_of_it() -> None:
    """The brusselator's simplest sample, (1, 2), is on b = 1 + a^2, where the trace is zero."""
    slice = slice_of("brusselator", count="total")
    result = ptmcad.classify(slice, engine="certified", tolerance="1/20", jobs=1)
    (cell,) = result.cells
    assert cell.sample == (1, 2)
    assert [solution.signs for solution in cell.solutions] == [""]
    assert ptmcad.classify(slice).locate(a=1, b=2).status is Status.ON_VARIETY
    assert "at the samples" not in result.table()


def test_where_all_are_counted_the_samples_say_which_are_stable() -> None:
    slice = slice_of("schloegl", count="total")
    result = ptmcad.classify(slice, engine="certified", tolerance="1/20", jobs=1)
    exact = ptmcad.classify(slice)
    pairs = set()
    for cell in result.cells:
        stable = sum(set(s.signs) == {"+"} for s in cell.solutions)
        assert (
            stable == exact.locate(**dict(zip(slice.axis_names, cell.sample, strict=True))).stable
        )
        pairs |= {f"{stable} of {cell.total}"} if cell.total else set()
    assert any(stable < total for stable, total in (map(int, p.split(" of ")) for p in pairs))
    said = f"at the samples {', '.join(sorted(pairs))}; it may change within a region, see --count stable"
    assert f"stable    {said}" in result.table() and said in page(result)


def test_false_signs_of_conditions_are_rejected() -> None:
    result = ptmcad.classify(
        slice_of("schloegl", count="total"), engine="certified", tolerance="1/20", jobs=1
    )
    assert ptmcad.verify(result, boxes=2).ok

    def altered(signs: str) -> ptmcad.RegionMap:
        cells = tuple(
            replace(
                c,
                solutions=tuple(
                    replace(s, signs=signs) if "-" in s.signs else s for s in c.solutions
                ),
            )
            for c in result.cells
        )
        return replace(result, cells=cells)

    assert ptmcad.verify(altered(""), boxes=0).ok  # as older files are
    for false in ("+", "0", "--"):
        found = ptmcad.verify(altered(false), boxes=0)
        assert not found.ok and "the conditions for stability at the solution" in repr(found)


ROOTS: dict[str, Any] = {"unknowns": {"x": "real"}, "equations": ["x^2 - b"]}
AT: dict[str, list[Any]] = {"a": [-2, 2], "b": [-1, 2]}


def test_a_solution_stops_to_count_where_an_inequality_vanishes_and_nowhere_else() -> None:
    """The roots of x^2 = b beyond a: on one side of a parabola, whose vertex is the fold's only
    point that matters.
    """
    slice = small({**ROOTS, "positive": ["x - a"]}, AT)
    assert [curve.name for curve in curves(slice, Count.TOTAL)] == [
        "fold",
        "point where x - a is 0",
    ]
    result = ptmcad.classify(slice, engine="certified", tolerance="1/100", jobs=1)
    for number, area in (
        (1, 2 ** (7 / 2) / 3),
        (2, 4 - 2 ** (5 / 2) / 3),
        (0, 8 - 2 ** (5 / 2) / 3),
    ):
        low, high = area_with(result, "total", number)
        assert low <= area <= high


def test_a_stable_solution_loses_its_stability_where_a_condition_vanishes() -> None:
    system = {**ROOTS, "positive": ["x"], "stable": ["x - a", "1 - x"]}
    stable = ptmcad.classify(
        small(system, AT, count="stable"), engine="certified", tolerance="1/100", jobs=1
    )
    low, high = area_with(stable, "stable", 1)
    assert low <= Fraction(8, 3) <= high  # a < sqrt b < 1
    assert {s.signs for cell in stable.cells for s in cell.solutions} == {"++"}
    total = ptmcad.classify(
        small(system, AT, count="total"), engine="certified", tolerance="1/100", jobs=1
    )
    assert {cell.total for cell in total.cells} == {0, 1}
    low, high = area_with(total, "total", 1)
    assert low <= 8 <= high  # the conditions for stability are no curves of this map
    assert total.system.inequalities == ("x",)
    assert total.system.stability == ("x - a", "1 - x")


def test_folds_of_what_does_not_count_are_left_out() -> None:
    """The cubic's fold at x = -1 lies where the inequality is violated."""
    system = {"unknowns": {"x": "real"}, "equations": ["x^3 - 3*x + a"], "positive": ["x"]}
    result = ptmcad.classify(
        small(system, {"a": [-4, 4], "b": [0, 1]}), engine="certified", tolerance="1/100", jobs=1
    )
    assert [result.locate(a=a, b="1/2").total for a in (-3, -1, "9/8", 3)] == [1, 1, 2, 0]
    assert result.locate(a=-2, b="1/2").total == 1  # in a cell, though x = -1 is a double root


@pytest.mark.parametrize(("offset", "total"), [("0", None), ("1/10^40", 1), ("-1/10^40", 2)])
def test_a_condition_that_is_nearly_zero_is_decided_and_one_that_is_zero_is_not(
    offset: str, total: int | None
) -> None:
    """x = -1 and x = 1, beyond -1 and a little."""
    counter = point_counter(small({**ROOTS, "positive": ["x - a"]}, AT))
    small_one = Fraction(offset.replace("1/10^40", "1")) / 10**40
    assert counter.at(Fraction(-1) + small_one, Fraction(1), Count.TOTAL).total == total


def test_a_condition_that_is_zero_at_a_solution_all_over_the_window_is_named() -> None:
    for positive in ("x - a", "(x - a)*(x + 5)", "a^2 - x*a"):
        slice = small(
            {"unknowns": PAIR, "equations": ["x - a", "y - b"], "positive": [positive]},
            {"a": [1, 2], "b": [1, 2]},
        )
        with pytest.raises(DegenerateSliceError, match="at a solution at a = 31/21"):
            ptmcad.classify(slice, engine="certified", tolerance="1/10")
    once = small(
        {"unknowns": PAIR, "equations": ["x - a", "y - b"], "positive": ["x - 10/21"]},
        {"a": [0, 1], "b": [1, 2]},
    )
    assert {
        c.total for c in ptmcad.classify(once, engine="certified", tolerance="1/10", jobs=1).cells
    } == {0, 1}


def test_a_condition_without_unknowns_is_a_curve_and_a_number_is_none() -> None:
    system = {"unknowns": {"x": "real"}, "equations": ["x - a"], "positive": ["a - b", "2"]}
    slice = small(system, {"a": [0, 1], "b": [0, 1]})
    assert [curve.name for curve in curves(slice, Count.TOTAL)] == [
        "fold",
        "point where a - b is 0",
    ]
    result = ptmcad.classify(slice, engine="certified", tolerance="1/50", jobs=1)
    assert (result.locate(a="3/4", b="1/4").total, result.locate(a="1/4", b="3/4").total) == (1, 0)
    for never in ("0", "-1", "x - x"):
        with pytest.raises(ConfigError, match=r"no solution (counts|would be counted)"):
            point_counter(small({**system, "positive": [never]}, {"a": [0, 1], "b": [0, 1]}))


def test_where_a_species_must_live_its_extinction_is_no_solution() -> None:
    """Divided by what is not zero; without the inequality, or with one that says less, nothing is."""
    equations = ["x^2*(x - a)", "y - b"]
    axes: dict[str, list[Any]] = {"a": [-1, 1], "b": [1, 2]}

    def degrees(*positive: str) -> list[int]:
        (f, _) = problem_of(
            small({"unknowns": PAIR, "equations": equations, "positive": list(positive)}, axes)
        ).equations
        return sorted(e[0] for _, e in f.terms)

    assert degrees("x") == degrees("b*x*y") == [0, 1]
    assert degrees() == degrees("y") == degrees("x + 1") == [2, 3]
    potential = small(
        {"unknowns": {"x": "real"}, "potential": "x^4/4 - a*x^3/3", "positive": ["x"]}, axes
    )
    assert sorted(e[0] for _, e in problem_of(potential).equations[0].terms) == [
        2,
        3,
    ]  # its Jacobian is a Hessian


ONE_ANOTHER: list[tuple[list[str], dict[str, Any], tuple[float, ...]]] = [
    (["x^2 + y^2 - 1 - a", "x - b*y"], {"a": [0, 1], "b": [0, 1]}, (1.4, 1.4)),
    (["x*(1 + y^2) - a", "y*(1 + x^2) - b"], {"a": [-3, 3], "b": [-3, 3]}, (3.0, 3.0)),
    (["y - x^2 - a", "x*y + x - b"], {"a": [-1, 1], "b": [-1, 1]}, (1.0, 1.0)),
    (["x - y^3 - a", "y + x^3 - b"], {"a": [-1, 1], "b": [-1, 1]}, (1.0, 1.0)),
    (["x^3 - 3*x*y^2 - a", "3*x^2*y - y^3 - b"], {"a": [-1, 1], "b": [-1, 1]}, (1.0, 1.0)),
]


@pytest.mark.parametrize(("equations", "axes", "reach"), ONE_ANOTHER)
@pytest.mark.fast_cases("equations0-axes0-reach0", "equations1-axes1-reach1")
def test_unknowns_that_bound_one_another(
    equations: list[str], axes: dict[str, Any], reach: tuple[float, ...]
) -> None:
    slice = small({"unknowns": PAIR, "equations": equations}, axes)
    found = ranges(problem_of(slice), slice.axes)
    for (low, high), least in zip(found, reach, strict=True):
        assert least <= high <= 16 * least and -16 * least <= low <= -least / 16


def test_inequalities_bound_what_equations_alone_do_not() -> None:
    """a x + y = 1 and x = b y + 1/2: without y > 0 a solution leaves to infinity where a b = -1."""
    linear = {"unknowns": PAIR, "equations": ["a*x + y - 1", "x - b*y - 1/2"]}
    for positive in ([], ["x"], ["x", "x + 1"]):
        with pytest.raises(ConfigError, match="no bound of the unknown"):
            slice = small({**linear, "positive": positive}, WINDOW)
            ranges(problem_of(slice), slice.axes)
    slice = small({**linear, "positive": ["x", "y"]}, WINDOW)
    (x_low, x_high), (y_low, y_high) = ranges(problem_of(slice), slice.axes)
    assert x_low == y_low == 0
    assert 3.5 <= x_high <= 8 and 1 <= y_high <= 2
    result = ptmcad.classify(slice, engine="certified", tolerance="1/20", jobs=1)
    assert (result.locate(a="1/2", b=1).total, result.locate(a="1/2", b=-1).total) == (1, 0)


@pytest.mark.parametrize(
    ("coefficient", "bounded"),
    [
        ("(a - 1/3)^2 + 1/10^4", True),
        ("(a - 1/3)^2", False),
        ("(a - 1/3)^2 - 1/10^12", False),
        ("a", False),
        ("-a", False),
    ],
)
def test_a_solution_that_leaves_to_infinity_somewhere_in_the_closed_window(
    coefficient: str, bounded: bool
) -> None:
    slice = small({"unknowns": {"x": "real"}, "equations": [f"({coefficient})*x - 1"]}, WINDOW)
    if bounded:
        ((_, high),) = ranges(problem_of(slice), slice.axes)
        assert 10**4 <= high <= 4 * 10**4
    else:
        with pytest.raises(ConfigError, match="no bound of the unknown x"):
            ranges(problem_of(slice), slice.axes)


@pytest.mark.parametrize("name", [n for n in SYSTEMS if n != "torus"])
@pytest.mark.slow_cases("brusselator", "selkov", "toggle")
def test_no_solution_that_counts_is_outside_of_the_ranges(name: str) -> None:
    """Solutions of the exact engine, at corners of the window and at random points."""
    slice = slice_of(name)
    found, rng = ranges(problem_of(slice), slice.axes), random.Random(name)
    across, up = slice.axes
    points = [(x, y) for x in (across.low, across.high) for y in (up.low, up.high)]
    points += [
        (
            across.low + (across.high - across.low) * Fraction(rng.randint(0, 50), 50),
            up.low + (up.high - up.low) * t,
        )
        for t in (Fraction(rng.randint(0, 50), 50) for _ in range(4))
    ]
    for x, y in points:
        names = zip(slice.axis_names, map(str, (x, y)), strict=True)
        for pose in ptmcad.solve(model=slice.model, digits=5, **dict(names)).equilibria:
            assert all(
                low <= z.center <= high for z, (low, high) in zip(pose.reals, found, strict=True)
            ), (x, y)


def test_nothing_is_counted_where_a_condition_is_not_decided() -> None:
    """A solution at which a condition is zero leaves its point undecided, also where others count."""
    system = {
        "unknowns": {"x": "real"},
        "equations": ["(x - a)*(x - 2)*(x + 2)"],
        "positive": ["x - 1/2"],
    }
    counter = point_counter(small(system, {"a": [0, 1], "b": [0, 1]}))
    assert counter.at(Fraction(1, 2), Fraction(1, 3), Count.TOTAL) == PointCount()
    assert counter.at(Fraction(1, 3), Fraction(1, 3), Count.TOTAL).total == 1
    assert counter.at(Fraction(2, 3), Fraction(1, 3), Count.TOTAL).total == 2
