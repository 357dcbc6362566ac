"""What QEPCAD is asked by hand is the right question."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import pytest
from support.sextic_question import Question, Task, Terms, formulas, question

from ptmcad.question import config

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


def value(terms: Terms, x: float, y: float, t: float) -> float:
    return math.fsum(float(c) * x**i * y**j * t**n for i, j, n, c in terms)


def roots(terms: Terms, x: float, y: float) -> list[float]:
    """The real roots in t, in floating point: good enough for points far from the variety."""
    numpy = pytest.importorskip("numpy")
    coefficients = [0.0] * 7
    for i, j, n, c in terms:
        coefficients[6 - n] += float(c * Fraction(x) ** i * Fraction(y) ** j)
    return [root.real for root in numpy.roots(coefficients) if abs(root.imag) < 1e-9]


@pytest.mark.parametrize(
    ("name", "point", "total", "stable"),
    [
        ("fig4", {"rho": 0.7, "L2": 1.5}, 6, 2),
        ("fig4", {"rho": 0.3, "L2": 1.5}, 4, 1),
        ("fig4", {"rho": 1.5, "L2": 0.5}, 4, 1),
        ("fig3", {"rho": 0.75, "F": -10.0}, 6, 2),
        ("fig3", {"rho": 0.1, "F": -10.0}, 4, 1),
        ("fig3", {"rho": 0.0015, "F": -10.0}, 6, 1),
        ("fig5-text", {"rho": 0.75, "F4": -20.0}, 6, 2),
        ("fig5-caption", {"rho": 0.5, "F4": -20.0}, 6, 2),
        ("fig5-caption", {"rho": 0.8, "F4": -20.0}, 4, 1),
    ],
)
def test_sextic_has_the_known_counts(
    name: str, point: dict[str, float], total: int, stable: int
) -> None:
    """Counts of the reference, from the sextic and from the sign conditions that QEPCAD is given."""
    slice = config.load(CONFIGS / f"{name}.yaml")
    asked = question(slice)
    assert isinstance(asked, Question)
    x, y = (point.get(axis, point.get("F")) for axis in slice.axis_names)
    assert x is not None and y is not None
    found = roots(asked.sextic, x, y)
    assert len(found) == total
    signs = [
        [math.copysign(1, value(p, x, y, t)) for p in (asked.v, asked.w, asked.slope)]
        for t in found
    ]
    assert sum(v == w == -slope for v, w, slope in signs) == stable


def test_unloaded_slice_has_no_sextic() -> None:
    assert "theta2 = pi" in str(question(config.load(CONFIGS / "fig2.yaml")))


def test_text_for_qepcad() -> None:
    asked = Question(
        sextic=[(0, 0, 2, Fraction(3, 2)), (1, 2, 0, Fraction(-1))],
        slope=[(0, 0, 1, Fraction(1))],
        v=[(0, 0, 1, Fraction(1))],
        w=[(1, 0, 1, Fraction(-2))],
        axes=config.slice_from_mapping({"axes": {"rho": ["1/2", 2], "F3": [-30, 0]}}).axes,
    )
    lines = asked.problem(Task.SIX, swapped=True).splitlines()
    assert lines[1:5] == [
        "(y,x,t)",
        "2",
        "(X6 t)[ 3/2 t^2 - x y^2 = 0 ].",
        r"assume [ x > 1/2 /\ x < 2 /\ y > -30 /\ y < 0 ]",
    ]
    stable = asked.problem(Task.TWO_STABLE)
    assert r"(X2 t)[ 3/2 t^2 - x y^2 = 0 /\ [[t > 0 /\ -2 x t > 0 /\ t < 0] \/" in stable


def test_qepcad_that_ends_without_an_answer_has_none() -> None:
    assert formulas("Failure occurred in: GCSI") == []
    one = "\nAn equivalent quantifier-free formula:\n\nx > 0 /\\\ny < 0\n\n\n"
    assert formulas(one + "QEPCAD" + one) == ["x > 0 /\\ y < 0"] * 2
