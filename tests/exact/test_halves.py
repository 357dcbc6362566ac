"""Maps whose window an involution takes to itself: areas from one half are those of the whole
window.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

import ptmcad
from ptmcad.answer.counts import Counts
from ptmcad.answer.regionmap import RegionMap
from ptmcad.errors import DegenerateSliceError, GeometryError
from ptmcad.exact.exactmap import exact_map
from ptmcad.exact.stages import Sample, SliceProblem, problem_of
from ptmcad.options import Options
from ptmcad.question.config import load, slice_from_mapping
from ptmcad.question.slice import Slice
from ptmcad.text.flint_numbers import from_fraction, to_fraction

CONFIGS = Path(__file__).parents[2] / "configs"

NUMBERS = {"a": {"kind": "number"}, "b": {"kind": "number"}}
SYSTEMS: dict[str, tuple[list[str], dict[str, list[object]]]] = {
    "in the first axis": (["x^3 - x + a", "y^2 - b - a*x"], {"a": [-1, 1], "b": [0, 2]}),
    "in the second axis, beside zero": (["x^3 - a*x + b - 3"], {"a": ["1/2", 2], "b": [2, 4]}),
    "in a point": (["x^3 - a*b*x + b"], {"a": [-2, 2], "b": [-1, 1]}),
    "exchange": (["x^2 + a*y - b", "y^2 + b*x - a"], {"a": [-2, 2], "b": [-2, 2]}),
    "exchange beside the diagonal": (
        ["x^2 + a*y - b + 3", "y^2 + (b - 3)*x - a"],
        {"a": [-1, 2], "b": [2, 5]},
    ),
    "exchange and reflection beside it": (
        ["x^3 - x*(a - b + 3) + a*(b - 3)"],
        {"a": [-1, 2], "b": [1, 4]},
    ),
    "exchange and reflection": (
        ["x^2 - a", "y^2 + b", "z^3 - z + a*b*x*y"],
        {"a": [-1, 2], "b": [-2, 1]},
    ),
}
"""Equations in x, y and z that an involution keeps, over a window."""
POTENTIALS: dict[str, tuple[str, dict[str, list[object]]]] = {
    "negated: the swallowtail": ("x^5/5 - x^3/4 + a*x^2/2 + b*x", {"a": [-1, 1], "b": [-1, 1]}),
}
"""Of which one becomes its negative, so that the total count alone is kept."""


def _system(name: str) -> Slice:
    equations, axes = SYSTEMS[name]
    unknowns = {u: "real" for u in "xyz"[: len(equations)]}
    return slice_from_mapping(
        {
            "system": {"unknowns": unknowns, "equations": equations, "parameters": NUMBERS},
            "axes": axes,
        }
    )


def _record(name: str) -> Slice:
    if name in POTENTIALS:
        return _of_potential(name, "total")
    return _system(name) if name in SYSTEMS else load(CONFIGS / f"{name}.yaml")


def _of_potential(name: str, count: str) -> Slice:
    potential, axes = POTENTIALS[name]
    system = {"unknowns": {"x": "real"}, "potential": potential, "parameters": NUMBERS}
    return slice_from_mapping({"system": system, "axes": axes, "count": count})


@pytest.mark.parametrize("name", POTENTIALS)
def test_a_potential_that_becomes_its_negative_serves_total_counts_alone(name: str) -> None:
    assert problem_of(_of_potential(name, "total")).reflections
    assert not problem_of(_of_potential(name, "stable")).reflections
    assert not problem_of(_of_potential(name, "index")).reflections


@pytest.mark.parametrize(
    "name",
    [
        *SYSTEMS,
        *POTENTIALS,
        "rods",
        "mechanisms/slider-crank",
        "systems/kuramoto",
        "systems/orthogonal-3r",
    ],
)
@pytest.mark.slow_cases("systems/kuramoto", "systems/orthogonal-3r", "mechanisms/slider-crank")
def test_a_half_has_the_areas_of_the_whole_window(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    slice = _record(name)
    assert problem_of(slice).reflections
    half = exact_map(slice)
    monkeypatch.setattr(SliceProblem, "reflections", [])
    whole = exact_map(slice)
    assert _without_areas(half) == _without_areas(whole)
    for one, other in zip(half.regions, whole.regions, strict=True):
        assert one.area[0] <= other.area[1]
        assert other.area[0] <= one.area[1]
        assert one.area[1] - one.area[0] <= one.area[0] / 1000


@pytest.mark.parametrize(
    ("name", "moves"),
    [
        ("in the second axis, beside zero", "b -> -b + 6, x -> -x"),
        ("exchange beside the diagonal", "a -> b - 3, b -> a + 3, x -> y, y -> x"),
        ("rods", "L1 -> L2, L2 -> L1, th1 -> th2, th2 -> th1"),
    ],
)
def test_the_plan_says_which_involution_makes_one_half_enough(name: str, moves: str) -> None:
    said = f"left out: areas on one half of the window (its solutions are those of the other half, by {moves})"
    found = exact_map(_record(name))
    assert [str(step) for step in found.plan][-1] == said
    assert ptmcad.verify(found).ok
    for options in (Options(areas=False), Options(without=frozenset({"equal-counts"}))):
        assert said not in map(str, exact_map(_record(name), options).plan)


def test_the_plan_says_nothing_of_a_half_where_areas_are_those_of_the_whole_window(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("ptmcad.exact.areas.regionareas._images", lambda *given: None)
    found = exact_map(_record("rods"))
    assert not [step for step in found.plan if "half" in step.what]


def _without_areas(found: RegionMap) -> tuple[object, ...]:
    return (
        found.cells,
        found.adjacencies,
        [(r.cells, r.total, r.stable, r.index, r.sample) for r in found.regions],
    )


@pytest.mark.parametrize("name", [*SYSTEMS, *POTENTIALS, "rods", "forces", "systems/kuramoto"])
def test_counts_at_mirrored_points_are_the_same(name: str) -> None:
    problem = problem_of(_record(name))
    (low, high), (bottom, top) = problem.window
    share = st.fractions(0, 1, max_denominator=97).map(from_fraction)

    @settings(max_examples=10, deadline=None)
    @given(share, share)
    def agree(s: fmpq, t: fmpq) -> None:
        at = (low + (high - low) * s, bottom + (top - bottom) * t)
        for change in problem.reflections:
            x, y = change.at((to_fraction(at[0]), to_fraction(at[1])))
            assert _counts(problem, at) == _counts(problem, (from_fraction(x), from_fraction(y)))

    agree()


def _counts(problem: SliceProblem, at: Sample) -> Counts | int | type[Exception]:
    try:
        counts = problem.solved_at(at).counts
        return counts.total if problem.slice.count.value == "total" else counts
    except (DegenerateSliceError, GeometryError) as error:
        return type(error)
