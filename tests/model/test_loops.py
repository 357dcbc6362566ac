"""Closed loops: known curves, minima along a loop that is run through, two derivations, and what is
refused.
"""

from __future__ import annotations

import math
import random
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import ptmcad
from ptmcad.answer.regionmap import Component, Kind, Status
from ptmcad.errors import ConfigError, DegenerateSliceError
from ptmcad.exact.models.modelsystem import elements_of
from ptmcad.exact.stages import problem_of, variety_of
from ptmcad.model.compile import compiled

FOUR_BAR: dict[str, Any] = yaml.safe_load("""
name: four_bar
parameters:
  L1: {kind: length, default: 1}
  L2: {kind: length, default: 6/5}
  L3: {kind: length, default: 3/2}
  b: {kind: base, default: 2}
  k1: {kind: stiffness, default: 1}
  k2: {kind: stiffness, default: 1}
  F: {kind: force, default: 0}
  G: {kind: force, default: 0}
unknowns: {th1: angle, th2: angle}
points: {A0: [0, 0], B0: [b, 0], P: [L1*cos(th1), L1*sin(th1)], Q: [b + L2*cos(th2), L2*sin(th2)]}
bars: [[A0, P], [B0, Q]]
closing: [{between: [P, Q], length: L3}]
springs: [{between: [A0, Q], k: k1}, {between: [B0, P], k: k2}]
loads: {P: [0, F], Q: [0, G]}
""")
SIGNS = tuple(product((1, -1), repeat=3))
LOADS = {"axes": {"F": [-4, 4], "G": [-4, 4]}}
SLIDER_CRANK: dict[str, Any] = yaml.safe_load("""
name: slider_crank
parameters:
  r: {kind: length, default: 1}
  l: {kind: length, default: 2}
  k: {kind: stiffness, default: 1}
  W: {kind: force}
  M: {}
unknowns: {th: angle, x: length}
points: {O: [0, 0], P: [r*cos(th), r*sin(th)], S: [x, 0], A: [1, 1]}
bars: [[O, P]]
closing: [{between: [P, S], length: l}]
springs: [{between: [A, S], k: k}]
loads: {P: [0, -W]}
moments: {th: M}
""")


CONFIGS = Path(__file__).resolve().parents[2] / "configs" / "mechanisms"


def description(name: str) -> dict[str, Any]:
    return dict(yaml.safe_load((CONFIGS / f"{name}.yaml").read_text(encoding="utf-8"))["mechanism"])


FIVE_BAR, PLATFORM = description("five-bar"), description("platform-loop")


def slice_of(mechanism: dict[str, Any], **record: Any) -> ptmcad.Slice:
    return ptmcad.slice_from_mapping({"mechanism": mechanism, **record})


def components(slice: ptmcad.Slice) -> tuple[Component, ...]:
    return variety_of(problem_of(slice)).components


@pytest.mark.slow
def test_the_curve_of_a_four_bar_under_loads() -> None:
    """REFERENCE: 12 complex solutions; degree 18 with 100 terms, with a multiplier as well as with
    the tangent.
    """
    found = variety_of(problem_of(slice_of(FOUR_BAR, **LOADS)))
    assert found.complex_solutions == 12
    curve, *others = (c for c in found.components if c.kind is Kind.CRITICAL)
    assert not others
    assert (curve.polynomial.total_degree, len(curve.polynomial.terms)) == (18, 100)


@pytest.mark.slow
def test_lines_on_which_the_loop_folds_flat() -> None:
    """REFERENCE: over (k1, b) degree 78 with 523 terms, and 8 lines. The bars' lengths add up to b
    with some signs.
    """
    slice = slice_of(
        FOUR_BAR, axes={"k1": ["1/10", 4], "b": ["1/10", 4]}, parameters={"F": -1, "G": "-1/2"}
    )
    critical = [c.polynomial for c in components(slice) if c.kind is Kind.CRITICAL]
    (curve,) = (p for p in critical if p.total_degree > 1)
    assert (curve.total_degree, len(curve.terms)) == (78, 523)
    lengths = (Fraction(1), Fraction(6, 5), Fraction(3, 2))
    lines = {-Fraction(p.terms[1][2], p.terms[0][2]) for p in critical if p.total_degree == 1}
    assert lines == {
        sum((n * s for n, s in zip(lengths, signs, strict=True)), Fraction(0)) for signs in SIGNS
    }


def test_a_slider_is_an_unknown_on_the_line() -> None:
    """With x = r cos th + s (l^2 - r^2 sin^2 th)^(1/2), on one side s = 1 and on the other s = -1,
    as r < l.
    """
    record = {"mechanism": SLIDER_CRANK, "axes": {"W": [-2, 2], "M": [-2, 2]}}
    th = 2 * math.pi * (np.arange(40000) + 0.5) / 40000
    for load, moment in ((0, "1/3"), ("1/2", "-1/4"), (1, "1/5"), ("-3/2", "1/7")):
        slopes = []
        for side in (1, -1):
            x = np.cos(th) + side * np.sqrt(4 - np.sin(th) ** 2)
            u = (x - 1) ** 2 / 2 + float(Fraction(load)) * np.sin(th)
            slopes.append(
                (np.roll(u, -1) - np.roll(u, 1)) / (2 * (th[1] - th[0])) - float(Fraction(moment))
            )
        rising = sum(int(((f < 0) & (np.roll(f, -1) > 0)).sum()) for f in slopes)
        found = ptmcad.solve(record, W=str(load), M=moment)
        assert sum(bool(e.stable) for e in found.equilibria) == rising
        total = sum(int((np.sign(f) != np.sign(np.roll(f, -1))).sum()) for f in slopes)
        assert len(found.equilibria) == total


@pytest.mark.parametrize(
    ("change", "key", "said"),
    [
        (
            {"closing": [*FOUR_BAR["closing"], {"between": ["A0", "Q"], "length": 1}]},
            "closing",
            "no degree of freedom",
        ),
        (
            {"symmetries": [{"th1": "-th1", "th2": "-th2", "F": "-F", "G": "-G"}]},
            "symmetries",
            "leave them out",
        ),
        ({"closing": [{"between": ["P", "Q"]}]}, "closing.1.length", "is missing"),
        ({"closing": [{"between": ["P", "R"], "length": 1}]}, "closing.1.between", "no point"),
        ({"closing": [{"between": ["P", "Q"], "length": "cos(th1)"}]}, "closing.1.length", "th1"),
        ({"closing": "PQ"}, "closing", "list"),
        (
            {"closing": [{"between": ["A0", "P"], "length": "L3"}]},
            "closing.1.between",
            "closes no loop",
        ),
        (
            {"closing": [*FOUR_BAR["closing"], {"between": ["Q", "P"], "length": 1}]},
            "closing.2.between",
            "number 1",
        ),
        (
            {"closing": [{"between": ["P", "Q"], "length": -2}]},
            "closing.1.length",
            "a length is positive",
        ),
        (
            {"closing": [{"between": ["P", "Q"], "length": 0}]},
            "closing.1.length",
            "a length is positive",
        ),
    ],
)
def test_what_is_not_computed_is_refused_by_its_key(
    change: dict[str, Any], key: str, said: str
) -> None:
    with pytest.raises(ConfigError) as caught:
        ptmcad.Mechanism({**FOUR_BAR, **change})
    wrong = [fault for fault in caught.value.faults if (fault.key or "").endswith(key)]
    assert any(said in fault.message for fault in wrong), [
        (f.key, f.message) for f in caught.value.faults
    ]


CHAIN = {
    **{key: value for key, value in PLATFORM.items() if key != "closing"},
    "unknowns": {"phi": "angle", "th": "angle"},
    "points": {**PLATFORM["points"], "P": ["L*cos(th)", "L*sin(th)"]},
}
"""The same platform as an open chain."""
LEG = {"axes": {"L": ["1/10", 3], "W": [-3, 3]}, "count": "stable"}


def test_two_degrees_of_freedom_are_those_of_an_open_chain() -> None:
    random.seed(11)
    loop, chain = slice_of(PLATFORM, **LEG), slice_of(CHAIN, **LEG)
    seen = set()
    for _ in range(8):
        at = {
            "L": Fraction(random.randrange(10, 300), 100),
            "W": Fraction(random.randrange(-300, 300), 100),
        }
        found, known = ptmcad.solve(loop, **at), ptmcad.solve(chain, **at)
        kinds = [
            [(p.stable, p.known_energy.text(8)) for p in poses.equilibria]
            for poses in (found, known)
        ]
        assert kinds[0] == kinds[1]
        seen.add(len(kinds[0]))
    assert seen == {4, 6}


def test_two_degrees_of_freedom_have_the_curves_of_an_open_chain() -> None:
    """All of them: of the conditions for stability none brings a curve of its own."""
    found, known = (
        {c.polynomial: c.kind for c in components(slice_of(mechanism, **LEG))}
        for mechanism in (PLATFORM, CHAIN)
    )
    assert found == known


def test_a_tension_is_what_a_longer_bar_saves() -> None:
    """The energy of a pose changes with the bar's length at minus the tension."""
    slice, step = slice_of(PLATFORM, **LEG), Fraction(1, 1000)
    below, here, above = (ptmcad.solve(slice, L=1 + k * step, W=-2).equilibria for k in (-1, 0, 1))
    assert len(here) == 4
    for one, pose, two in zip(below, here, above, strict=True):
        slope = (two.known_energy.center - one.known_energy.center) / (2 * step)
        assert float(slope) == pytest.approx(-float(pose.reals[-1].center), rel=1e-4)


def test_a_five_bar_has_44_complex_solutions() -> None:
    found = ptmcad.solve(slice_of(FIVE_BAR, axes={"F": [-3, 3], "G": [-3, 3]}), F=2, G=2)
    assert (len(found.equilibria), found.stable) == (10, 1)


def test_a_moment_on_another_unknown_needs_one_degree_of_freedom() -> None:
    with pytest.raises(ConfigError, match="one degree of freedom, not 2"):
        ptmcad.Mechanism({**FIVE_BAR, "moments": {"a": "sin(b)"}})


def test_a_tension_has_a_name_of_its_own() -> None:
    with pytest.raises(
        ConfigError, match="'force_density_CQ' is the name of a closing bar's force density"
    ):
        ptmcad.Mechanism({**FIVE_BAR, "parameters": {**FIVE_BAR["parameters"], "force_density_CQ": {"kind": "force"}},
                          "loads": {"C": ["F", "-G"], "Q": ["force_density_CQ", 0]}})  # fmt: skip


@pytest.mark.parametrize(
    ("lengths", "said"),
    [
        (
            (1, 1, 2, 2),
            "A0 P Q B0 is a parallelogram with two branches, on one A0P and B0Q are parallel",
        ),
        (("3/2", "3/2", 1, 1), "A0 P Q B0 is a parallelogram"),
        ((2, 1, 1, 2), "A0 P Q B0 is a kite with two branches, on one P stays at B0"),
        ((2, 1, 2, 1), "A0 P Q B0 is a kite with two branches, on one Q stays at A0"),
        ((1, 1, 1, 1), "A0 P Q B0 is a rhombus with three branches"),
        ((1, 2, 3, 2), "as lengths of its bars add up alike"),
    ],
    ids=str,
)
def test_a_loop_that_folds_flat_everywhere_is_told_with_its_branches(
    lengths: tuple[Any, ...], said: str
) -> None:
    numbers = dict(zip(("L1", "L2", "L3", "b"), lengths, strict=True))
    with pytest.raises(DegenerateSliceError) as caught:
        components(slice_of(FOUR_BAR, **LOADS, parameters=numbers))
    assert "the loop that PQ closes can fold flat" in str(caught.value)
    assert said in str(caught.value)


def test_a_spring_along_a_closing_bar_does_nothing() -> None:
    with pytest.raises(ConfigError, match=r"springs.3: the length of QP is constant"):
        ptmcad.Mechanism(
            {**FOUR_BAR, "springs": [*FOUR_BAR["springs"], {"between": ["Q", "P"], "k": 1}]}
        )


def test_lengths_and_stiffnesses_written_where_they_are_used_are_proved_positive() -> None:
    for change, part in (
        ({"closing": [{"between": ["P", "Q"], "length": "L3 + F"}]}, "closing.1.length"),
        (
            {"springs": [{"between": ["A0", "Q"], "k": "k1 + F"}, FOUR_BAR["springs"][1]]},
            "springs.1.k",
        ),
    ):
        with pytest.raises(
            ConfigError, match=rf"{part}: a \w+ must be positive in the whole window"
        ):
            slice_of({**FOUR_BAR, **change}, **LOADS)


FLAT = {"L1": 1, "L2": 1, "L3": 2, "b": 2}


def test_a_flat_loop_is_told_on_a_line_and_at_a_point() -> None:
    slice = slice_of(FOUR_BAR, **LOADS, parameters=FLAT)
    with pytest.raises(DegenerateSliceError, match="the loop that PQ closes can fold flat"):
        ptmcad.intervals(slice, "F", {"G": 1})
    found = ptmcad.solve(slice, F=1, G="1/3")
    assert found.status is Status.ON_VARIETY
    assert "degenerate: poses meet there, or the loop is flat" in found.remark
    assert len(found.remark) < 200


def test_without_any_solution_there_are_none() -> None:
    """Real or complex: the algebra is zero."""
    system = {"unknowns": {"x": "real"}, "equations": ["a*x - b"]}
    found = ptmcad.solve({"system": system, "axes": {"a": [-1, 1], "b": [-1, 1]}}, a=0, b="1/2")
    assert found.equilibria == ()
    assert found.status is Status.EXACT


@pytest.mark.parametrize(
    ("text", "by", "slope"),
    [
        ("a*x^3/2 - 4*x + b", "x", "3*a*x^2/2 - 4"),
        ("(x + a)^2*(x - 1)/3", "x", "(2*(x + a)*(x - 1) + (x + a)^2)/3"),
        ("-cos(2*t - s)*x", "t", "2*sin(2*t - s)*x"),
        ("sin(s - 3*t)^2", "t", "-6*sin(s - 3*t)*cos(s - 3*t)"),
        ("a^0*(b - 1)*x^1", "x", "b - 1"),
    ],
)
def test_derivatives_of_compiled_expressions(text: str, by: str, slope: str) -> None:
    model = ptmcad.System(
        unknowns={"t": "angle", "s": "angle", "x": "real"},
        equations=[text, slope, "cos(t) + sin(s) + x + a + b"],
    )
    system = compiled(model)
    derivative = system.graph.derivative(system.equations[0], system.names.index(by))
    found, wanted = elements_of(model, (derivative, system.equations[1]))
    assert found == wanted
