"""What each parameter needs to be, in records, in slices made by hand and on lines: narrow
violations are refused.

The slices break one hypothesis of docs/soundness.md each, in a dip of width 1e-9 or less, or of a
degree that was too high to be looked at once.
"""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import pytest
import yaml
from support.replacing import replace

from ptmcad.ask.lines.along import certified_intervals
from ptmcad.errors import ConfigError, GeometryError, PtmcadError
from ptmcad.exact.exactmap import exact_map
from ptmcad.model import Kind
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.domain import proved, sign_of
from ptmcad.question.slice import Axis, Slice, Subject
from ptmcad.text.expressions import axis, constant
from ptmcad.text.parsing import parse
from ptmcad.text.tree import Negative

DIPS = {
    "degree 20": "(m - 1/3)^20 - 1e-180",
    "middle": "(m - 1/3)^2 + (n + 1/7)^2 - 1e-18",
    "across": "(m - n - 1/3)^2 - 1e-18",
    "edge": "m + (n + 1/7)^2 - 1e-18",
    "corner": "m + n + 3 - 1e-9",
}
TOUCHING = {  # zero only at the window's edge
    "edge": "m + (n + 1/7)^2",
    "corner": "m + n + 3",
    "two edges": "m^3*(n + 3)",
}
ZERO_INSIDE = {"line": "(m - 1/3)^2", "point": "(m - 1/3)^2 + (n + 1/7)^2"}
POSITIVE = {"L1": "length", "L2": "length", "rho": "base length", "k": "stiffness", "k1": "stiffness",
            "k2": "stiffness", "k3": "stiffness"}  # fmt: skip
FREE = ("l0", "l0_1", "l0_2", "l0_3")


def record(**parameters: object) -> dict[str, Any]:
    return {
        "parameters": {"F3": "-m", "F4": "n", **parameters},
        "axes": {"m": [0, 2], "n": [-3, 1]},
    }


def refused(**parameters: object) -> str:
    with pytest.raises(ConfigError) as caught:
        slice_from_mapping(record(**parameters))
    return str(caught.value)


@pytest.mark.parametrize("dip", DIPS)
@pytest.mark.parametrize("name", [*POSITIVE, *FREE])
def test_a_narrow_dip_is_refused_with_the_place(name: str, dip: str) -> None:
    if dip == "across":  # no box has a corner in it
        with pytest.raises(
            GeometryError, match=r"it is not proved that .* its sign is not decided"
        ):
            proved(slice_from_mapping(record(**{name: DIPS[dip]})))
        return
    text = refused(**{name: DIPS[dip]})
    assert text.startswith(f"parameters.{name}: a {POSITIVE.get(name, 'free length')} must ")
    assert f"but {name} is " in text
    assert re.search(" (at|near) m = ", text)


@pytest.mark.parametrize("dip", DIPS)
@pytest.mark.parametrize("name", ["F3", "L1", "l0_2", "rho"])
def test_a_denominator_that_vanishes_narrowly_is_refused(name: str, dip: str) -> None:
    value = f"1/({DIPS[dip]})"
    if dip == "across":
        with pytest.raises(GeometryError, match="its sign is not decided near m = "):
            proved(slice_from_mapping(record(**{name: value})))
        return
    text = refused(**{name: value})
    assert "division by zero inside the window: the denominator" in text
    assert re.search(" (between|near) m = ", text)


@pytest.mark.parametrize("zero", ZERO_INSIDE)
@pytest.mark.parametrize("name", [*POSITIVE, *FREE])
def test_a_zero_inside_is_refused_where_it_may_not_be(name: str, zero: str) -> None:
    if zero == "point" or name not in FREE:
        # that it is one is not decided: the record is read, and no engine takes it
        with pytest.raises(GeometryError, match="its sign is not decided near m = "):
            proved(slice_from_mapping(record(**{name: ZERO_INSIDE[zero]})))
    else:
        assert slice_from_mapping(record(**{name: ZERO_INSIDE[zero]})).has_free_lengths


@pytest.mark.parametrize("edge", TOUCHING)
@pytest.mark.parametrize("name", [*POSITIVE, *FREE, "F3"])
def test_a_zero_on_the_edge_is_no_fault(name: str, edge: str) -> None:
    slice = slice_from_mapping(
        record(**{name: f"1/({TOUCHING[edge]})" if name == "F3" else TOUCHING[edge]})
    )
    if edge == "edge":  # no corner of a halved box is there
        with pytest.raises(GeometryError, match="its sign is not decided near m = "):
            proved(slice)
    else:
        proved(slice)


def test_a_base_that_is_zero_everywhere_is_in_the_domain() -> None:
    proved(slice_from_mapping(record(rho=0, L2=2, l0="1/5")))


def bare(**parameters: str) -> Slice:
    """A slice that no reader has looked at."""
    names = {"m": axis(0), "n": axis(1)}
    slice = slice_from_mapping(record(l0="1/5"))
    given = {name: parse(text, names) for name, text in parameters.items()}
    return replace(slice, parameters={**slice.parameters, **given})


@pytest.mark.parametrize("name", ["L1", "L2", "rho", "k1", "k2", "k3", "l0_1", "l0_2", "l0_3"])
def test_the_certified_engine_trusts_no_reader(name: str) -> None:
    engine = pytest.importorskip("ptmcad.certified.engine")
    with pytest.raises(GeometryError, match=f"but {name} is -.* at m = "):
        engine.certified_map(bare(**{name: DIPS["middle"]}))
    with pytest.raises(GeometryError, match=f"the denominator of {name} vanishes between m = "):
        engine.certified_map(bare(**{name: f"1/({DIPS['middle']})"}))


def test_a_zero_function_is_no_length() -> None:
    with pytest.raises(
        GeometryError,
        match="a length must be positive in the whole window, but L1 is 0 at m = 1, n = -1",
    ):
        proved(bare(L1="0"))
    with pytest.raises(GeometryError, match="stiffness must be positive"):
        proved(bare(k3="0*m - 2"))
    with pytest.raises(GeometryError, match="base length must be positive"):
        proved(bare(rho="0*m - 2"))


def test_undecided_is_read_but_not_certified() -> None:
    """Each engine asks for a proof first."""
    engine = pytest.importorskip("ptmcad.certified.engine")
    slice = slice_from_mapping(record(L1="(m^3 + n^3 - m*n - 1/7)^2 + 1e-40", l0="1/5"))
    assert sign_of(
        Subject("L1", Kind.LENGTH, slice.parameters["L1"]), slice.axes
    ).problem.startswith(
        "it is not proved that L1 is positive in the whole window: its sign is not decided near m = "
    )
    with pytest.raises(GeometryError, match="not proved that L1 is positive"):
        engine.certified_map(slice)
    with pytest.raises(GeometryError, match="not proved that L1 is positive"):
        exact_map(slice_from_mapping(record(L1="(m^3 + n^3 - m*n - 1/7)^2 + 1e-40")))


@pytest.mark.parametrize("changed", ["parameter", "window", "spring"])
def test_a_proof_is_not_taken_for_that_of_another_slice(changed: str) -> None:
    """What is carried says of which function in which window it is."""
    mechanism = yaml.safe_load("""
        parameters: {g: {default: 1}, m: {}, n: {}}
        unknowns: {th: angle}
        points: {A: ['-2', '0'], P: [sin(th), cos(th)]}
        springs: [{between: [A, P], k: g*m}]
        loads: {P: [n, '0']}
    """)
    slice = proved(
        slice_from_mapping({"mechanism": mechanism, "axes": {"m": [0, 2], "n": [-3, 1]}})
    )
    first, second = slice.axes
    other = {
        "parameter": lambda: replace(slice, parameters={**slice.parameters, "g": constant(-1)}),
        "window": lambda: replace(slice, axes=(replace(first, low=Fraction(-1)), second)),
        "spring": lambda: replace(slice, model=replace(slice.model, springs=(
            slice.model.springs[0]._replace(stiffness=Negative(slice.model.springs[0].stiffness)),))),
    }[changed]()  # fmt: skip
    with pytest.raises(GeometryError) as caught:
        proved(other)
    assert caught.value.part == "springs.1.k"


def test_an_isolated_zero_is_refused_by_the_exact_engine_too() -> None:
    """Between lines of a grid, at a point with irrational coordinates: once an exact map was made
    of it.
    """
    with pytest.raises(PtmcadError, match="sign is not decided near m = "):
        exact_map(slice_from_mapping(record(L1="(m^2 - 2)^2 + (n^2 - 3)^2")))


@pytest.mark.parametrize(
    ("at", "sign"), [("1/20", True), ("1/10", True), ("100000001/10^9", False), ("1", False)]
)
def test_a_line_need_not_lie_in_the_window(at: str, sign: bool) -> None:
    """Counts were once certified on lines outside of the window on which a free length is negative."""
    slice = slice_from_mapping(
        {"parameters": {"l0": "1/5", "l0_3": "1/10 - m"}, "axes": {"rho": [1, 2], "m": [0, "1/20"]}}
    )
    value = parse(at).constant()
    on_line = {**slice.parameters, "l0_3": parse("1/10 - m", {"m": parse(at)})}
    line = replace(slice, axes=(slice.axes[0], Axis("m", value, value)), parameters=on_line)
    if sign:
        proved(line)
    else:
        with pytest.raises(GeometryError, match="l0_3 is -"):
            proved(line)
        pytest.importorskip("numba")
        with pytest.raises(GeometryError, match=r"l0_3 is -.* at rho = 3/2, m = 1"):
            certified_intervals(slice, "rho", {"m": at}, 6)


@pytest.mark.parametrize(
    ("stiffness", "free", "torsion", "part"),
    [
        ("g", "0", "1", "springs.1.k"),
        ("1", "g - 1", "1", "springs.1.free"),
        ("1", "0", "g*m", "torsion.1.k"),
    ],
)
def test_what_springs_are_given_is_proved_by_engines(
    stiffness: str, free: str, torsion: str, part: str
) -> None:
    """They trust no reader: in the slice as read all of it is right."""
    mechanism = {
        "parameters": {"g": {"default": 1}, "m": {}, "n": {}},
        "unknowns": {"th": "angle"},
        "points": {"A": ["-2", "0"], "P": ["sin(th)", "cos(th)"]},
        "springs": [{"between": ["A", "P"], "k": stiffness, "free": free}],
        "torsion": [{"angle": "th", "k": torsion}],
        "loads": {"P": ["n", "g*m"]},
    }
    slice = slice_from_mapping({"mechanism": mechanism, "axes": {"m": [0, 2], "n": [-3, 1]}})
    proved(slice)
    dip = parse("(m - 1/3)^2 + (n + 1/7)^2 - 1e-18", {"m": axis(0), "n": axis(1)})
    with pytest.raises(GeometryError) as caught:
        proved(replace(slice, parameters={**slice.parameters, "g": dip}))
    assert caught.value.part == part


def test_an_expression_in_a_spring_has_a_degree_that_can_be_computed() -> None:
    mechanism = yaml.safe_load("""
        parameters: {L: {kind: length}, g: {}}
        unknowns: {th: angle}
        points: {A: ['-2', '0'], P: [L*sin(th), L*cos(th)]}
        springs: [{between: [A, P], k: g^20}]
    """)
    with pytest.raises(ConfigError, match="has degree 40 in the axes: at most 32 can be computed"):
        slice_from_mapping({
            "mechanism": mechanism, "parameters": {"g": "1 + u*L"}, "axes": {"L": [0, 1], "u": [0, 1]},
        })  # fmt: skip
    with pytest.raises(
        ConfigError, match=r"springs\.1\.k: cannot be judged: the power is too large"
    ):
        slice_from_mapping({
            "mechanism": mechanism, "parameters": {"g": "(1 + u + L)^8"}, "axes": {"L": [0, 1], "u": [0, 1]},
        })  # fmt: skip
