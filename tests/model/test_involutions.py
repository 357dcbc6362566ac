"""Involutions of models over a window, known by construction."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
import yaml

from ptmcad.model.involutions import Involution, involutions
from ptmcad.question.config import load, slice_from_mapping
from ptmcad.question.slice import Slice

CONFIGS = Path(__file__).parents[2] / "configs"


def _found(slice: Slice) -> list[Involution]:
    x, y = ((axis.low, axis.high) for axis in slice.axes)
    return involutions(slice.model, slice.parameters, (x, y))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        # in a mirror along A1A2, as there is no load
        ("free02-unloaded", Involution((0, 1), (-1, -1), (0, 0))),
        # in a mirror halfway between A1 and A2, as both rods and loads are equal
        ("free-load", Involution((1, 0), (1, 1), (0, 0))),
        # the same where the rods are the axes
        ("rods", Involution((1, 0), (1, 1), (0, 0), axes=(1, 0))),
        # in a mirror along A1A2, which turns the loads
        ("forces", Involution((0, 1), (-1, -1), (0, 0), axis_signs=(-1, -1))),
        ("systems/kuramoto-4", Involution((1, 0, 2), (1, 1, 1), (0, 0, 0), axes=(1, 0))),
    ],
)
def test_symmetries_of_shipped_records(name: str, expected: Involution) -> None:
    slice = load(CONFIGS / f"{name}.yaml")
    assert _found(slice) == [expected]
    assert involutions(slice.model, slice.parameters) == (
        [expected] if expected.keeps_points else []
    )


def test_no_symmetry_where_the_loads_differ() -> None:
    assert not _found(load(CONFIGS / "fig5-text.yaml"))


def _system(**changes: Any) -> Slice:
    record = yaml.safe_load("""
        name: three_rings
        parameters: {a: {kind: number}, b: {kind: number}}
        unknowns: {s: angle, t: angle, u: angle}
        potential: a*cos(s) + b*cos(t) + cos(u) + cos(s - t) + 2*cos(t - u)
    """)
    return slice_from_mapping(
        {"system": {**record, **changes}, "axes": {"a": [1, 3], "b": [-1, 1]}}
    )


def test_three_odd_unknowns() -> None:
    """Each equilibrium has its negative, and nothing else changes as b does, since all three angles
    feel each other.
    """
    kept, *others = _found(_system())
    assert kept == Involution((0, 1, 2), (-1, -1, -1), (0, 0, 0))
    assert kept.odd == 3
    assert not others


def test_a_perturbed_coefficient_breaks_the_symmetry() -> None:
    perturbed = "a*cos(s) + b*cos(t) + cos(u) + cos(s - t) + 2*cos(t - u) + sin(u)/1000000000000"
    assert not _found(_system(potential=perturbed))


def test_equations_in_another_order_and_with_other_signs() -> None:
    """x and y exchanged, as a and b are about the middle of the window; (x, y) to (-x, -y) changes
    all signs.
    """
    system = yaml.safe_load("""
        unknowns: {x: real, y: real}
        equations: [x^3 - a*x + y*(x^2 + y^2), y^3 - (4 - b)*y + x*(x^2 + y^2)]
        parameters: {a: {kind: number}, b: {kind: number}}
    """)
    found = _found(slice_from_mapping({"system": system, "axes": {"a": [0, 2], "b": [2, 4]}}))
    point = (Fraction(1, 2), Fraction(5, 2))
    assert {(f.images, f.signs, f.at(point)) for f in found} == {
        ((0, 1), (-1, -1), point),
        ((1, 0), (1, 1), (Fraction(3, 2), Fraction(7, 2))),
        ((1, 0), (-1, -1), (Fraction(3, 2), Fraction(7, 2))),
    }


def test_a_condition_is_kept() -> None:
    system = {
        "unknowns": {"x": "real"},
        "equations": ["x^3 - a*x - b"],
        "parameters": {"a": {"kind": "number"}, "b": {"kind": "number"}},
    }
    record = {"axes": {"a": [1, 2], "b": [-1, 1]}}
    assert len(_found(slice_from_mapping({"system": system, **record}))) == 1
    assert not _found(slice_from_mapping({"system": {**system, "positive": ["x + 2"]}, **record}))
    assert (
        len(_found(slice_from_mapping({"system": {**system, "positive": ["4 - x^2"]}, **record})))
        == 1
    )


def test_denominators_are_kept_where_the_axes_are() -> None:
    def found(value: str) -> list[Involution]:
        system = {
            "unknowns": {"x": "real"},
            "equations": ["x^3 - x*c"],
            "parameters": {"c": {"kind": "number"}},
        }
        record = {"system": system, "parameters": {"c": value}, "axes": {"a": [-1, 1], "b": [1, 2]}}
        return _found(slice_from_mapping(record))

    assert [(f.signs, f.keeps_points) for f in found("b/(a + 3*b)")] == [((-1,), True)]
    assert len(found("b + a^2")) == 3
