"""Springs side by side (Lemma S7): they answer as the one spring that they are together."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("numba")

from support.examples import examples

import ptmcad
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import Status
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain import problem as plain_problem
from ptmcad.certified.plain.certifiedposes import plain_poses
from ptmcad.certified.plain.problem import problem_of
from ptmcad.model import Mechanism
from ptmcad.options import Options

Springs = list[dict[str, Any]]
TOGETHER: Springs = [
    {"between": ["A", "P"], "k": 3, "free": "2/3"},
    {"between": ["B", "P"], "k": 1, "free": "1/3"},
]
"""1 (l - 1)^2 + 2 (l - 1/2)^2 is 3 (l - 2/3)^2 and a constant."""
APART: dict[str, Springs] = {
    "same ends": [
        {"between": ["A", "P"], "k": 1, "free": 1},
        {"between": ["A", "P"], "k": 2, "free": "1/2"},
        TOGETHER[1],
    ],
    "ends in the other order": [
        TOGETHER[1],
        {"between": ["P", "A"], "k": 1, "free": 1},
        {"between": ["A", "P"], "k": 2, "free": "1/2"},
    ],
    # 4 (l/2 - 1/4)^2 is (l - 1/2)^2, and so on
    "to a point between": [
        {"between": ["A", "P"], "k": 1, "free": 1},
        {"between": ["M", "A"], "k": 8, "free": "1/4"},
        TOGETHER[1],
    ],
    "to a point beyond": [
        {"between": ["A", "N"], "k": "1/4", "free": 2},
        {"between": ["A", "P"], "k": 2, "free": "1/2"},
        TOGETHER[1],
    ],
}


def bead(springs: Springs, count: str = "index") -> dict[str, Any]:
    """A point in the plane, held by springs."""
    return {
        "name": "bead",
        "mechanism": {
            "name": "bead",
            "parameters": {"F": {"kind": "force"}, "G": {"kind": "force"}},
            "unknowns": {"x": "length", "y": "length"},
            "points": {
                "A": [0, 0],
                "B": [2, 0],
                "P": ["x", "y"],
                "M": ["x/2", "y/2"],
                "N": ["-2*x", "-2*y"],
            },
            "springs": springs,
            "loads": {"P": ["F", "G"]},
        },
        "axes": {"F": [-2, 2], "G": [-2, 2]},
        "count": count,
    }


def poses(springs: Springs, force: Fraction, up: Fraction) -> Poses:
    model = ptmcad.slice_from_mapping(bead(springs)).model
    assert isinstance(model, Mechanism)
    return plain_poses(model, {"F": force, "G": up}, 8)


@pytest.mark.parametrize("how", list(APART))
def test_springs_side_by_side_are_one_cone(how: str) -> None:
    """They take off twice what the first one of them alone would per its length."""
    slice = ptmcad.slice_from_mapping(bead(APART[how]))
    strength = {"AN": Fraction(1)}.get(
        next(s for s in ("AN", "AP") if s in named(how)), Fraction(2)
    )
    pulls = {cone.name.count("+"): cone.pull.constant() for cone in problem_of(slice).cones}
    assert pulls == {0: Fraction(1, 3), 1: strength}


def named(how: str) -> list[str]:
    return ["".join(spring["between"]) for spring in APART[how]]


@pytest.mark.parametrize("count", ["stable", "total", "index"])
@pytest.mark.parametrize("how", list(APART))
@pytest.mark.fast_cases("to a point between-index")
def test_they_have_the_map_of_the_one_spring(how: str, count: str) -> None:
    options = Options(tolerance=Fraction(1, 50), jobs=1)
    one, many = (
        certified_map(ptmcad.slice_from_mapping(bead(s, count)), options)
        for s in (TOGETHER, APART[how])
    )
    assert many.undetermined < Fraction(1, 50)
    # the boxes may differ, where the first spring is longer: not what is counted, nor the bounds of
    # what it covers
    assert len(one.regions) == len(many.regions)
    for r, s in zip(one.regions, many.regions, strict=True):
        assert (r.stable, r.total, r.index) == (s.stable, s.total, s.index)
        assert max(r.area[0], s.area[0]) <= min(r.area[1], s.area[1])


forces = st.fractions(min_value=-2, max_value=2, max_denominator=16)


@settings(max_examples=examples(15), deadline=None)
@given(st.sampled_from(list(APART)), forces, forces)
def test_they_have_the_equilibria_of_the_one_spring(
    how: str, force: Fraction, up: Fraction
) -> None:
    one, many = poses(TOGETHER, force, up), poses(APART[how], force, up)
    assert one.status is many.status
    pairs = list(zip(one.equilibria, many.equilibria, strict=True))
    assert [a.index for a, _ in pairs] == [b.index for _, b in pairs]
    for a, b in pairs:
        assert all(
            max(p.low, q.low) <= min(p.high, q.high) for p, q in zip(a.reals, b.reals, strict=True)
        )


def test_apart_nothing_is_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where both have no length, each direction is free."""
    monkeypatch.setattr(plain_problem, "shares", lambda *_: None)
    assert poses(APART["same ends"], Fraction(-1, 2), Fraction(1, 3)).status is Status.UNDECIDED


def test_a_vector_the_other_way_is_as_long() -> None:
    """Without |c| the sum would be 1 - 1."""
    slice = ptmcad.slice_from_mapping(bead(APART["ends in the other order"]))
    assert [c.pull.constant() for c in problem_of(slice).cones if "+" in c.name] == [2]


def test_a_rational_equilibrium_has_its_exact_numbers() -> None:
    """At x = 2/3 one spring has its free length and the load balances the other: nothing but
    arithmetic tells so.
    """
    found = poses(TOGETHER, Fraction(-1), Fraction(0))
    forces = [[spring.force.exact for spring in pose.springs] for pose in found.equilibria]
    assert [Fraction(0), Fraction(1)] in forces


SCALED: dict[str, Any] = {
    "unknowns": {"x": "length", "y": "length"},
    "parameters": {
        "F": {"kind": "force"},
        "a": {"kind": "length"},
        "b": {"kind": "length"},
        "c": {},
    },
    "points": {
        "A": [0, 0],
        "B": [2, 0],
        "P": ["x", "y"],
        "M": ["a*x", "a*y"],
        "N": ["-b*x", "-b*y"],
        "C": ["c*x", "c*y"],
        "S": ["a*x", "b*y"],
    },
    "loads": {"P": ["F", "1/3"]},
}
NEAR: dict[str, Any] = {"between": ["B", "P"], "k": 1, "free": "1/3"}


def scaled(
    ends: str, axes: dict[str, Any], parameters: dict[str, Any], count: str = "stable"
) -> ptmcad.Slice:
    """Springs to these points from A, all with k l0 = 1/2."""
    springs = [{"between": ["A", end], "k": 2, "free": "1/4"} for end in ends]
    values = {name: parameters.get(name, 1) for name in SCALED["parameters"] if name not in axes}
    record = {
        "mechanism": {**SCALED, "springs": [*springs, NEAR]},
        "axes": axes,
        "parameters": values,
    }
    return ptmcad.slice_from_mapping({**record, "name": "scaled", "count": count})


OVER_A = {"F": [-3, 1], "a": [1, 2]}
"""Near F = -5/3 springs from A balance the rest where they are short."""


@pytest.mark.parametrize(
    ("ends", "axes", "parameters", "engine"),
    [
        # 1/2 |d| + 1/2 |a d|, with a an axis, a fixed parameter or a function of an axis
        ("PM", OVER_A, {}, "1/2 + 1/2*y"),
        ("MP", OVER_A, {}, "1/2 + 1/2*y"),
        ("PM", {"F": [-2, 2], "b": [1, 2]}, {"a": "3/2"}, "5/4"),
        # half the vector
        ("NP", {"F": [-2, 2], "t": [1, 2]}, {"b": "t/2"}, "1 + 1/2*y"),
        # a d and -b d, of which neither is a polynomial times the other
        ("MN", {"a": [1, 2], "b": [0, 3]}, {}, "1/2*y + 1/2*x"),
        (
            "PMN",
            {"a": [1, 2], "b": [0, 3]},
            {},
            "1/2 + 1/2*y + 1/2*x",
        ),
        # negative all over the window
        ("PC", {"F": [-2, 2], "c": [-2, 0]}, {}, "1/2 - 1/2*y"),
        # parallel at every point of the slice, not for other parameters
        (
            "PS",
            {"F": [-2, 2], "t": [1, 2]},
            {"a": "t", "b": "t"},
            "1/2 + 1/2*y",
        ),
        ("PS", {"F": [-2, 2], "c": [1, 2]}, {"a": "3/2", "b": "3/2"}, "5/4"),
    ],
)
def test_the_ratio_is_a_function_of_the_axes(
    ends: str,
    axes: dict[str, Any],
    parameters: dict[str, Any],
    engine: str,
) -> None:
    slice = scaled(ends, axes, parameters)
    told = {cone.name.count("+"): cone.pull.to_text() for cone in problem_of(slice).cones}
    assert told == {0: "1/3", len(ends) - 1: engine}


@pytest.mark.parametrize(
    ("ends", "axes", "parameters"),
    [
        # c is positive at some points and negative at others, or zero along a line inside
        ("PC", {"F": [-2, 2], "c": [-1, 2]}, {}),
        ("PC", {"F": [-2, 2], "t": [-1, 2]}, {"c": "t^2"}),
        # parallel where a = b, which is not everywhere
        ("PS", {"a": [1, 2], "b": [1, 2]}, {}),
        ("PS", {"F": [-2, 2], "t": [1, 2]}, {"a": "t", "b": "3/2"}),
    ],
)
def test_what_is_parallel_or_turns_at_some_points_only_stays_apart(
    ends: str, axes: dict[str, Any], parameters: dict[str, Any]
) -> None:
    slice = scaled(ends, axes, parameters)
    assert len(problem_of(slice).cones) == 3


def test_counts_over_an_axis_are_those_at_its_points() -> None:
    """At a point the ratio is a number."""
    slice = scaled("MP", OVER_A, {}, "total")
    result = certified_map(slice, Options(tolerance=Fraction(1, 50), jobs=1))
    for cell in result.cells:
        values = {name: e.evaluate(*cell.sample) for name, e in slice.parameters.items()}
        assert isinstance(slice.model, Mechanism)
        found = plain_poses(slice.model, values, 8)
        assert (found.status, len(found.equilibria)) == (Status.CERTIFIED, cell.total)
