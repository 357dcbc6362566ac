"""Four-bar loops on springs with free lengths that fold flat all over a slice are named, and no
other loop is.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
import yaml

import ptmcad
from ptmcad.answer.regionmap import Status
from ptmcad.ask.checking import check
from ptmcad.ask.lines.along import certified_intervals
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.problem import problem_of
from ptmcad.errors import DegenerateSliceError, LimitReached
from ptmcad.model import ClosedMechanism
from ptmcad.model.fourbars import Fold, flat_everywhere, four_bars
from ptmcad.question.slice import Count
from ptmcad.text.expressions import constant

pytest.importorskip("numba")

RECORD = yaml.safe_load(
    (Path(__file__).parents[2] / "configs" / "mechanisms" / "four-bar-free.yaml").read_text(
        encoding="utf-8"
    )
)
FOUR_BAR: dict[str, Any] = RECORD["mechanism"]
LOADS = {"F": [0, 4], "G": [0, 4]}


def slice_of(
    lengths: dict[str, Any],
    axes: dict[str, Any] | None = None,
    mechanism: dict[str, Any] | None = None,
    **more: Any,
) -> ptmcad.Slice:
    record = {
        "name": "loop",
        "mechanism": FOUR_BAR | (mechanism or {}),
        "parameters": lengths,
        "axes": axes or LOADS,
    }
    return ptmcad.slice_from_mapping(record | more)


def lengths(first: Any, second: Any, coupler: Any, ground: Any) -> dict[str, Any]:
    return {"L1": first, "L2": second, "L3": coupler, "b": ground}


KINDS = [
    pytest.param(lengths(1, 1, 2, 2), "a parallelogram with two branches, on one A0P and B0Q are parallel",
                 id="parallelogram"),
    pytest.param(lengths(2, 1, 1, 2), "a kite with two branches, on one P stays at B0", id="kite of P"),
    pytest.param(lengths(2, 1, 2, 1), "a kite with two branches, on one Q stays at A0", id="kite of Q"),
    pytest.param(lengths(1, 1, 1, 1), "a rhombus with three branches", id="rhombus"),
    pytest.param(lengths(1, 2, 3, 2), "add up alike", id="equal sums"),
]  # fmt: skip


@pytest.mark.parametrize("count", ["total", "stable"])
@pytest.mark.parametrize(("numbers", "said"), KINDS)
@pytest.mark.slow_cases(
    "kite of P-stable",
    "kite of Q-stable",
    "rhombus-total",
    "equal sums-stable",
    "parallelogram-total",
)
def test_a_loop_that_is_flat_everywhere_is_named_before_anything_is_searched(
    numbers: dict[str, Any], said: str, count: str
) -> None:
    slice = slice_of(numbers, count=count)
    for ask in (check, ptmcad.classify, lambda s: certified_intervals(s, "F", {"G": 1}, 10)):
        with pytest.raises(DegenerateSliceError) as caught:
            ask(slice)
        assert said in str(caught.value)
        assert "not even that of stable equilibria" in str(caught.value)


@pytest.mark.parametrize(("numbers", "said"), KINDS)
def test_at_a_point_it_is_undecided_by_name(numbers: dict[str, Any], said: str) -> None:
    found = ptmcad.solve(slice_of(numbers), F=1, G="1/3")
    assert (found.status, found.equilibria) == (Status.UNDECIDED, ())
    assert said.partition(",")[0] in found.remark
    assert "on one line" in found.remark
    assert len(found.remark) <= 300


@pytest.mark.parametrize(
    "numbers",
    [{"L1": "r", "L2": "r", "L3": "(b^2 - 1)/(b - 1) - 1"}, {"L1": "b", "L2": "r", "L3": "r"}],
)
def test_lengths_that_are_functions_of_the_axes(numbers: dict[str, Any]) -> None:
    mechanism = {"parameters": FOUR_BAR["parameters"] | {"r": {"kind": "length"}}}
    axes = {"r": ["1/2", 1], "b": ["3/2", 2]}
    with pytest.raises(DegenerateSliceError, match=r"parallelogram|kite"):
        problem_of(slice_of(numbers, axes, mechanism))


def test_flat_on_a_curve_only_is_no_fault_and_named_on_the_curve() -> None:
    slice = slice_of({"L1": 1, "L2": 1, "F": "1/2"}, {"b": [1, 2], "L3": [1, 2]})
    assert problem_of(slice).closing == 1
    assert "rhombus" in ptmcad.solve(slice, b=1, L3=1).remark
    assert ptmcad.solve(slice, b=1, L3="13/10").status is Status.CERTIFIED


def test_by_the_certified_engine_without_free_lengths_too() -> None:
    slice = slice_of({**lengths(1, 1, 2, 2), "l0": 0})
    with pytest.raises(DegenerateSliceError, match=r"parallelogram.*x-joint"):
        ptmcad.classify(slice, engine="certified")


TURNING = [
    pytest.param(["cos(th1)", "sin(th1)"], ["2 + cos(th2)", "sin(th2)"], True, id="two cranks"),
    pytest.param(["sin(th1 + th2)", "cos(th1 + th2)"], ["2 + cos(th2)", "sin(th2)"], True, id="relative"),
    pytest.param(["cos(th1 - th2)", "sin(th1 - th2)"], ["2 + cos(2*th1 - 2*th2)", "sin(2*th1 - 2*th2)"], False,
                 id="one turns with the other"),
]  # fmt: skip


@pytest.mark.parametrize(("p", "q", "free"), TURNING)
def test_flat_poses_are_there_only_where_both_sides_turn(
    p: list[str], q: list[str], free: bool
) -> None:
    """Where a gear joins the cranks nothing says that the loop gets flat."""
    description = FOUR_BAR | {
        "points": {"A0": [0, 0], "B0": [2, 0], "P": p, "Q": q},
        "loads": {"P": [0, 1]},
    }
    description |= {"parameters": {"L3": {"kind": "length"}}, "springs": []}
    model, values = ptmcad.Mechanism(description), {"L3": constant(2)}
    assert isinstance(model, ClosedMechanism)
    mechanism = model.mechanism
    (loop,) = four_bars(mechanism)
    assert loop.fold(values) is Fold.PARALLELOGRAM
    assert loop.turns_freely() is free
    assert (flat_everywhere(mechanism, values) is not None) is free


HELD: dict[str, Any] = {
    "unknowns": {"th1": "angle", "th2": "angle", "x": "length"},
    "points": FOUR_BAR["points"] | {"S": ["x", 3]},
    "closing": [{"between": ["P", "Q"], "length": "L3"}, {"between": ["S", "Q"], "length": "5/2"}],
}
"""A parallelogram that a slider above holds up: it cannot get flat."""


def test_a_parallelogram_that_another_loop_keeps_from_folding_is_decided() -> None:
    slice = slice_of(lengths(1, 1, 2, 2), mechanism=HELD)
    assert (
        "A0 P Q B0 is a parallelogram with two branches: nothing is decided wherever"
        in check(slice).cost
    )
    counts = plain_counter(slice).at(Fraction(1, 3), Fraction(1, 5), Count.TOTAL)
    assert counts.decided
    assert counts.total == 8
    with pytest.raises(LimitReached, match="A0 P Q B0 is a parallelogram"):
        ptmcad.classify(slice, tolerance="1/1000", timeout=0.3)


BRANCHES = {
    "crossed": (
        lengths(1, 1, 2, 2),
        ["b + (s - 2*b*cos(ph))*cos(ph)", "(s - 2*b*cos(ph))*sin(ph)"],
        (8, 4),
    ),
    "symmetric": (lengths(2, 1, 1, 2), ["b*cos(2*ph)", "b*sin(2*ph)"], (4, 2)),
}


SPRINGS = [
    {"between": ["A0", "Q"], "k": "k1", "free": "l0"},
    {"between": ["C", "P"], "k": "k2", "free": "l0"},
]


@pytest.mark.parametrize("branch", BRANCHES)
def test_a_branch_as_it_is_told_to_be_described(branch: str) -> None:
    """By the angle and the length of A0Q, with P as a mirror image: each pose is found twice.

    REFERENCE: the energy at 20000 places of the circle that Q describes.
    """
    numbers, image, known = BRANCHES[branch]
    mechanism = {
        "parameters": {
            name: value
            for name, value in FOUR_BAR["parameters"].items()
            if name not in ("L1", "L3")
        },
        "unknowns": {"ph": "angle", "s": "length"},
        "points": {
            "A0": [0, 0],
            "B0": ["b", 0],
            "C": [1, 3],
            "Q": ["s*cos(ph)", "s*sin(ph)"],
            "P": image,
        },
        "bars": [],
        "closing": [{"between": ["Q", "B0"], "length": "L2"}],
        "supports": {},
        "springs": SPRINGS,
    }
    slice = slice_of({name: numbers[name] for name in ("L2", "b")}, mechanism=mechanism)
    for f, g in (("1/3", "1/5"), ("17/13", "25/11")):
        found = ptmcad.solve(slice, F=f, G=g)
        assert found.status is Status.CERTIFIED, found.remark
        assert (len(found.equilibria), found.stable) == known
