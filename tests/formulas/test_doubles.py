"""Formulas in doubles and as a script's instructions, against the same expression in Python."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from ptmcad.formulas.graph import Formula, Graph, length
from ptmcad.formulas.instructions import Doubles, Instruction, script


def formula_and_value() -> tuple[Formula, Formula, Any]:
    """An expression with each operation of compiled systems, its slope, and the expression again."""
    graph = Graph()
    p, x, y = (graph.variable(k) for k in range(3))
    f = -((p + x).squared() * Fraction(1, 3) + x.cos() * y.sin() * length(x * 2, y - p))

    def value(p: Any, x: Any, y: Any) -> Any:
        return -((p + x) ** 2 / 3 + np.cos(x) * np.sin(y) * np.hypot(2 * x, y - p))

    return f, graph.derivative(f, 1), value


def test_values_at_a_point_and_at_many() -> None:
    f, slope, value = formula_and_value()
    at = Doubles({"f": f, "pairs": (("name", slope),), "none": None}, math).at(
        {0: 0.3, 1: 0.7, 2: -1.1}
    )
    assert (at["f"], at["none"], at["pairs"][0][0]) == (
        pytest.approx(value(0.3, 0.7, -1.1)),
        None,
        "name",
    )
    x, y = np.random.default_rng(1).uniform(-2, 2, (2, 4, 3))
    found, steep = Doubles((f, slope), np).at({0: 0.3, 1: x, 2: y})
    assert found == pytest.approx(value(0.3, x, y))
    assert steep == pytest.approx(
        (value(0.3, x + 1e-6, y) - value(0.3, x - 1e-6, y)) / 2e-6, abs=1e-6
    )


def run(
    instructions: Sequence[Instruction], parameters: Sequence[float], unknowns: Sequence[float]
) -> list[float]:
    found: list[float] = []
    for kind, *operands in instructions:
        a, *b = operands
        match kind:
            case "=":
                found.append(a)
            case "p":
                found.append(parameters[a])
            case "u" | "c" | "s":
                found.append({"u": float, "c": math.cos, "s": math.sin}[kind](unknowns[a]))
            case "r":
                found.append(math.sqrt(found[a]))
            case _:
                left, right = found[a], found[b[0]]
                found.append(
                    left * right if kind == "*" else left + right if kind == "+" else left - right
                )
    return found


def test_instructions_of_a_script_have_the_same_values() -> None:
    f, _, value = formula_and_value()
    instructions, places = script({"f": f, "again": (f,)}, {0: ("p", 0), 1: ("u", 0), 2: ("u", 1)})
    assert len(set(instructions)) == len(instructions)
    assert places["again"] == (places["f"],)
    assert run(instructions, [0.3], [0.7, -1.1])[places["f"]] == pytest.approx(
        value(0.3, 0.7, -1.1)
    )


def test_a_constant_beyond_what_products_hold_is_infinite() -> None:
    graph = Graph()
    instructions, _ = script({"f": graph.variable(0) * 10**100}, {0: ("u", 0)})
    assert ("=", math.inf) in instructions
