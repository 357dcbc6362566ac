"""Mechanisms and systems from Python's objects, and the exact engine's steps one by one on them."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np
import pytest
import sympy
import yaml

import ptmcad
from ptmcad.errors import ConfigError
from ptmcad.exact.point_system import DegeneratePoint
from ptmcad.model import described

PENDULUM: dict[str, Any] = yaml.safe_load("""
name: pendulum
parameters: {k: {kind: stiffness, default: 1}, W: {kind: force}, H: {kind: force}}
unknowns: {th: angle}
points: {O: [0, 0], P: [sin(th), cos(th)], G: [0, cos(th)]}
bars: [[O, P]]
springs: [{between: [G, P], k: k}]
loads: {P: [H, -W]}
""")
AXES = {"H": ["-3/2", "3/2"], "W": ["-3/2", "3/2"]}


def in_sympy() -> Any:
    th, k, w, h = sympy.symbols("th k W H")
    return ptmcad.Mechanism(
        name="pendulum",
        parameters=PENDULUM["parameters"],
        unknowns={th: "angle"},
        points={
            "O": (0, 0),
            "P": (sympy.sin(th), sympy.cos(th)),
            "G": (sympy.Integer(0), sympy.cos(th)),
        },
        bars=[("O", "P")],
        springs=[{"between": ("G", "P"), "k": k}],
        loads={"P": (h, -w)},
    )


def test_strings_and_sympys_expressions_say_the_same() -> None:
    assert ptmcad.Mechanism(PENDULUM) == described(PENDULUM) == in_sympy()
    x, a, b = sympy.symbols("x a b")
    mine = ptmcad.System(unknowns={x: "real"}, equations=[x**3 - a * x + b / 2])
    assert ptmcad.counts_at(mine, a=1, b=Fraction(1, 10)) == ptmcad.counts_at(
        ptmcad.System({"unknowns": {"x": "real"}}, equations=["x^3 - a*x + b/2"]), a="1", b="0.1"
    )


@pytest.mark.parametrize(
    "mechanism", [ptmcad.Mechanism(PENDULUM), in_sympy(), PENDULUM], ids=["", "sympy", "mapping"]
)
def test_a_mapping_with_a_mechanism_is_classified(mechanism: Any) -> None:
    """The astroid's area, 3 pi/8."""
    result = ptmcad.classify(
        {"mechanism": mechanism, "parameters": {"k": sympy.Integer(1)}, "axes": AXES}
    )
    (two,) = [region for region in result.regions if region.stable == 2]
    assert float(two.area[0]) == pytest.approx(3 * pi / 8, rel=1e-3)
    assert result.locate(H=0, W="1/2").stable == 2
    again = ptmcad.RegionMap.from_json(result.to_json())
    assert again.slice == result.slice


def test_numbers_equations_and_arrays_of_other_libraries() -> None:
    x, a, b = sympy.symbols("x a b")
    cubic = ptmcad.System(unknowns={"x": "real"}, equations=["x^3 - (a*x - b)"])
    equation = sympy.Eq(x**3, a * x - b)
    for equations in (
        [equation],
        np.array([equation], dtype=object),
        sympy.Matrix([x**3 - (a * x - b)]),
    ):
        other = ptmcad.System(unknowns={x: "real"}, equations=equations)
        at = ptmcad.counts_at(other, a=sympy.Integer(1), b=sympy.Rational(1, 10))
        assert at == ptmcad.counts_at(cubic, a=1, b="1/10")
    # a float of SymPy's is the decimal that it prints, as in an expression
    assert ptmcad.counts_at(cubic, a=sympy.Float(1), b=sympy.Float("0.1")) == at
    question = {"system": cubic, "axes": {"a": np.array([-1, 1]), "b": np.linspace(-1, 1, 2)}}
    assert ptmcad.slice_from_mapping(question) == ptmcad.slice_from_mapping(
        {"system": cubic, "axes": {"a": [-1, 1], "b": [-1, 1]}}
    )
    pose = ptmcad.solve(
        model=ptmcad.Mechanism(PENDULUM), W=sympy.Rational(1, 10), H=sympy.Rational(-1, 3)
    )
    assert pose.parameters["H"] == Fraction(-1, 3)


def test_functions_in_place_of_symbols_are_refused() -> None:
    q = sympy.Function("q")(sympy.Symbol("t"))
    refusal = (
        r"q\(t\) is a function of SymPy's: use a symbol in its place, such as sympy.Symbol\('q'\)"
    )
    with pytest.raises(ConfigError, match=refusal):
        ptmcad.System(unknowns={q: "real"}, equations=["x"])
    with pytest.raises(ConfigError, match=refusal):
        ptmcad.System(unknowns={"q": "real"}, equations=[sympy.cos(q) - q])


def test_the_steps_one_by_one() -> None:
    """Every part of the window has a point, and counts there are the map's."""
    system = ptmcad.System(unknowns={"x": "real"}, equations=["x^3 - a*x + b"])
    question = {"system": system, "axes": {"a": [-2, 2], "b": [-2, 2]}}
    variety = ptmcad.discriminant_variety(question)
    assert [c.polynomial.text(("a", "b")) for c in variety.components] == ["4*a^3 - 27*b^2"]
    points = ptmcad.open_cad(question)
    result = ptmcad.classify(question)
    assert set(points) == {cell.sample for cell in result.cells}
    for point in points:
        assert ptmcad.counts_at(system, **dict(point)).total == result.locate(**dict(point)).total


def test_what_is_wrong_is_said() -> None:
    with pytest.raises(ConfigError) as caught:
        ptmcad.Mechanism(
            {**PENDULUM, "springs": [{"between": ["O", "Q"], "k": "K"}], "bars": [["G", "P"]]}
        )
    assert [fault.key for fault in caught.value.faults] == [
        "mechanism.springs.1.between", "mechanism.springs.1.k", "mechanism.bars.1",
    ]  # fmt: skip
    with pytest.raises(ConfigError, match=r"use ptmcad\.System"):
        ptmcad.Mechanism(unknowns={"x": "real"}, equations=["x"])
    with pytest.raises(ConfigError, match="expected a mapping"):
        ptmcad.System("x^3")  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match="is not an exact number"):
        ptmcad.Mechanism({**PENDULUM, "points": {**PENDULUM["points"], "O": [object(), 0]}})
    with pytest.raises(
        ConfigError,
        match=r"system\.equations\.1: <class 'int'> of type type is not an exact number",
    ):
        ptmcad.System(unknowns={"x": "real"}, equations=[int])
    with pytest.raises(ConfigError, match="unknown parameter 'K'"):
        ptmcad.counts_at(ptmcad.Mechanism(PENDULUM), K=1)
    with pytest.raises(ConfigError, match=r"use ptmcad\.solve"):
        ptmcad.counts_at(ptmcad.slice_from_options(slice="rho,L2").model, l0="1/5")
    with pytest.raises(DegeneratePoint, match="singular"):
        ptmcad.counts_at(ptmcad.Mechanism(PENDULUM), W=1)


def test_sympy_is_not_loaded() -> None:
    program = (
        "import sys, ptmcad; s = ptmcad.System(unknowns={'x': 'real'}, equations=['x^2 - a']); "
        "ptmcad.classify({'system': s, 'axes': {'a': [-1, 1], 'b': [0, 1]}}); sys.exit('sympy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False, timeout=100).returncode == 0


def test_counts_are_of_a_model_and_not_of_a_slice() -> None:
    slice = ptmcad.slice_from_mapping({"mechanism": PENDULUM, "axes": AXES})
    assert ptmcad.counts_at(slice.model, H=0, W=2).total == 2
    with pytest.raises(ConfigError, match="give the slice's model"):
        ptmcad.counts_at(slice, H=0, W=0)  # type: ignore[arg-type]
