"""Where the arrangement of a family's regions changes: values known by hand, bisection beside
elimination.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

import ptmcad
from ptmcad.answer.arrangement import correspondence
from ptmcad.answer.family import Change, Changes
from ptmcad.ask import changes as asking
from ptmcad.ask.members import in_common
from ptmcad.errors import ConfigError, DegenerateSliceError, LimitReached
from ptmcad.options import DEFAULTS
from ptmcad.question.config import family_from

SQUARE = {"a": [-1, 1], "b": [-1, 1]}


def of(equations: str | list[str], low: Any, high: Any, **further: Any) -> dict[str, Any]:
    """A system in real unknowns over the square, with the free parameter c."""
    texts = [equations] if isinstance(equations, str) else equations
    unknowns = {name: "real" for name in "uv"[: len(texts)]}
    return {
        "system": {"unknowns": unknowns, "equations": texts},
        "axes": SQUARE,
        "free": {"c": [low, high]},
        **further,
    }


def exact_texts(found: Changes) -> list[str]:
    assert found.complete
    return [change.value.text(8) for change in found]


ASTROID = {
    "system": {
        "unknowns": {"t": "angle"},
        "equations": ["a*sin(t) - b*cos(t) + 2*c*sin(t)*cos(t)"],
    },
    "axes": SQUARE,
    "free": {"c": ["1/10", 2]},
}


@pytest.mark.parametrize(
    ("question", "values", "first"),
    [
        pytest.param(of("u^2 - c + a^2 + b^2", -1, 3), ["0", "1", "2"], "a region of 2 solutions appears",
                     id="a disc of radius sqrt c: appears, reaches all sides, fills the window"),
        pytest.param(of("u^2 - c^2 + a^2 + b^2", "1/2", 2), ["1", "1.4142136"],
                     "the region of 0 solutions splits into 4", id="a disc of radius c, corners at sqrt 2"),
        pytest.param(of("u^2 - c^2 + a^2 + b^2", -2, 2), ["-1.4142136", "-1", "0", "1", "1.4142136"],
                     "4 regions of 0 solutions appear", id="symmetric, and vanishing at one value only"),
        pytest.param(of("u^2 - (a^2 - 1/4)^2 - b^2 + c", "-1/4", "1/4"), ["0", "0.0625"],
                     "2 regions of 0 solutions appear", id="two ovals of Cassini's appear, and join at 1/16"),
        pytest.param(of(["u^2 - c^2 + (a - 1/3)^2 + b^2", "v^2 - c^2 + (a + 1/3)^2 + b^2"], "1/10", "3/5"),
                     ["0.33333333"], "a region of 4 solutions appears", id="two discs of radius c touch at 1/3"),
        pytest.param(of(["u^2 - b + a + c", "v^2 - 1/4 + a^2 + b^2"], 0, 1), ["0.70710678"],
                     "a region of 4 solutions vanishes", id="a line leaves a circle: two surfaces touch"),
        pytest.param(of("(a - c)*u^3 + u - b", -2, 2), ["-1", "-0.85185185", "1", "1.1481481"],
                     "a region of 3 solutions appears", id="two roots leave to infinity where a = c"),
        pytest.param(ASTROID, ["0.5", "1.4142136"], "the region of 2 solutions splits into 4",
                     id="the pendulum's astroid: its cusps reach the sides, its arcs the corners"),
        pytest.param(of("u^2 - c*b + a", -2, 2), ["-1", "1"], "the region of 2 solutions leaves a = 1",
                     id="a line that turns: the surface has a whole line over a = c = 0"),
        pytest.param(of("c*u^2 + a*u + b", -1, 1), ["-0.25", "0", "0.25"], "",
                     id="a coefficient that vanishes: where the basis does not specialise"),
        pytest.param(of("u^2 - c^3 + 2*c + a/10", "1/2", 2), ["1.3885175", "1.4385802"], "",
                     id="a line that sweeps the window between roots of two cubics"),
    ],
)  # fmt: skip
def test_values_known_by_hand(question: dict[str, Any], values: list[str], first: str) -> None:
    found = ptmcad.changes(question)
    assert exact_texts(found) == values
    assert all(change.is_exact for change in found)
    if first:
        assert found.changes[0].words[0] == first


def test_what_is_the_same_on_both_sides_is_told_apart() -> None:
    found = ptmcad.changes(of("u^2 - c*b + a", -2, 2))
    assert [number.text() for number in found.others] == [
        "0"
    ]  # over which the surface vanishes identically
    assert len(found.between) == len(found.arrangements) == 3
    assert found.reason.endswith("but at 3 values")
    assert repr(found) == "<Changes of c in [-2, 2]: 2, complete>"
    assert "the arrangement is the same on both sides: 0" in found.table()
    assert "changes of the arrangement" in found._repr_html_()


def test_a_rational_value_is_looked_at_itself() -> None:
    found = ptmcad.changes(of("u^2 - a^2 - b^2 + c^2", -1, 1))
    assert [(change.value.text(), change.words) for change in found] == [
        ("0", ("at this value alone: a region of 0 solutions vanishes",))
    ]
    assert correspondence(*found.arrangements) is not None


def test_the_ends_of_the_range_are_told_apart() -> None:
    found = ptmcad.changes(of("u^2 - c + a^2 + b^2", 0, 1))
    assert not found.changes
    assert found.complete
    assert found.at_ends[0] == ("a region of 2 solutions vanishes",)
    assert found.at_ends[1] == (
        "the region of 0 solutions splits into 4",
    )  # the disc touches sides in points only


def sampled(question: dict[str, Any], tolerance: Fraction = Fraction(1, 1000)) -> Changes:
    members = asking.Members(in_common(family_from(question)), DEFAULTS)
    return asking.changes_among(members, "as a test", tolerance)


def agree(exact: Changes, enclosed: Changes) -> None:
    """Each enclosure holds an exact change, and each sample lies between changes with its
    arrangement.
    """
    assert not enclosed.complete
    for change in enclosed:
        assert any(_within(known, change) for known in exact), change
    for value, arrangement in zip(enclosed.between, enclosed.arrangements, strict=True):
        place = [change.value.compare(value) for change in exact]  # type: ignore[union-attr]
        if 0 not in place:
            assert correspondence(arrangement, exact.arrangements[place.count(-1)]) is not None


def _within(known: Change, enclosure: Change) -> bool:
    value = known.value
    assert isinstance(value, ptmcad.AlgebraicNumber)
    return value.compare(enclosure.value.low) >= 0 >= value.compare(enclosure.value.high)


@pytest.mark.parametrize(
    "question", [of("u^2 - c + a^2 + b^2", -1, 3), of("u^3 - a*u + b + c*u^2", -4, 4), ASTROID]
)
@pytest.mark.fast_cases("question0")
def test_bisection_encloses_what_elimination_finds(question: dict[str, Any]) -> None:
    exact, enclosed = ptmcad.changes(question), sampled(question)
    agree(exact, enclosed)
    for known in exact:
        assert any(_within(known, change) for change in enclosed), known
    width = Fraction(1, 1000) * (exact.free.high - exact.free.low)
    assert all(change.value.high - change.value.low <= width for change in enclosed)


small = st.integers(-3, 3)


@pytest.mark.slow
@settings(max_examples=examples(12), deadline=None)
@given(st.tuples(*[small] * 6), st.tuples(small, small, small))
def test_random_quadrics(quadric: tuple[int, ...], plane: tuple[int, ...]) -> None:
    terms = ("a^2", "a*b", "b^2", "a", "b", "1")
    text = "+".join(f"({k})*{term}" for k, term in zip(quadric, terms, strict=True))
    line = "+".join(f"({k})*{term}" for k, term in zip(plane, ("a", "b", "1"), strict=True))
    question = of(f"u^2 - ({text}) - c*({line}) - c^2", -2, 2)
    try:
        exact = ptmcad.changes(question)
    except DegenerateSliceError:  # a square all over the slice
        return
    agree(exact, sampled(question, Fraction(1, 100)))


def test_bad_questions_and_limits_are_told() -> None:
    with pytest.raises(ConfigError, match="is not between 0 and 1"):
        ptmcad.changes(of("u^2 - c", -1, 3), tolerance=0)
    free_length = yaml.safe_load("""
        axes: {rho: [0, 2], L2: [0, 2]}
        parameters: {l0: 1/5}
        free: {F3: [-4, 0]}
    """)
    with pytest.raises(ConfigError, match="certified engine"):
        ptmcad.changes(free_length)
    with pytest.raises(ConfigError, match="choose stable"):
        ptmcad.changes(LOADS | {"count": "admissible"})
    with pytest.raises(LimitReached):
        ptmcad.changes(of("u^2 - c + a^2 + b^2", -1, 3), timeout=1e-9)
    with pytest.raises(DegenerateSliceError, match="at c = "):
        ptmcad.changes(of("u^2", -1, 3, parameters={}) | {"system": {"unknowns": {"u": "real"},
                                                                     "equations": ["(u - c*a)^2"]}})  # fmt: skip


LOADS = yaml.safe_load("""
axes: {rho: [0, 2], L2: [0, 2]}
parameters: {F3: F, F4: F}
free: {F: [-40, 0]}
""")


@pytest.mark.slow
def test_the_loads_of_figure_4_change_nothing_between_0_and_40() -> None:
    found = ptmcad.changes(LOADS)
    assert found.complete
    assert not found.changes
    assert [number.text(6) for number in found.others] == ["-39.1565", "-15.2618", "-14.9773"]
