"""Taylor arithmetic against Arb's series, and tubes around known curves."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, arb_series, ctx

pytest.importorskip("numba")

from ptmcad.certified.curvetubes import Tubes, tubes
from ptmcad.certified.equationsystem import system
from ptmcad.formulas.graph import Formula, Graph, direction, length
from ptmcad.formulas.intervalarithmetic import program
from ptmcad.formulas.tape import record
from ptmcad.formulas.taylor import extend, series

ORDER = 6


def formulas(graph: Graph) -> list[Formula]:
    """All operations, of two variables."""
    x, y = graph.variable(0), graph.variable(1)
    return [
        x * y - 3 * x.squared(), (x + y).sin(), (x - y).cos(), x / (2 + y), length(x, y),
        direction(x, y), direction(y, x) * x.cos(), (x * y).sin() / length(1 + x, y),
    ]  # fmt: skip


def by_arb(x: arb_series, y: arb_series) -> list[arb_series]:
    def size(a: arb_series, b: arb_series) -> arb_series:
        return (a * a + b * b).sqrt()

    return [
        x * y - 3 * x * x, (x + y).sin(), (x - y).cos(), x / (2 + y), size(x, y),
        x / size(x, y), y / size(x, y) * x.cos(), (x * y).sin() / size(1 + x, y),
    ]  # fmt: skip


def test_coefficients_of_all_operations_hold_those_of_arb() -> None:
    rng = random.Random(5)
    graph = Graph()
    tape = record([formulas(graph)])
    ctx.cap, ctx.prec = ORDER + 1, 200
    try:
        for wide in (0.0, 0.125):
            for _ in range(20):
                given = np.array(
                    [
                        [rng.uniform(0.5, 2)] + [rng.uniform(-1, 1) for _ in range(ORDER)]
                        for _ in (0, 1)
                    ]
                )
                values = series(len(tape), ORDER)
                extend(program(tape), given - wide, given + wide, values, 0, ORDER, len(tape))
                there = [
                    [arb(c + wide * rng.choice((-1, 0, 1))) for c in row] for row in given.tolist()
                ]
                for place, expected in zip(
                    tape.outputs[0], by_arb(*map(arb_series, there)), strict=True
                ):
                    for k in range(ORDER + 1):
                        low, high = values.low[place, k], values.high[place, k]
                        assert arb(low) <= expected[k] <= arb(high)
                        assert wide or high - low < 1e-10
    finally:
        ctx.cap, ctx.prec = 10, 53


def exponential(order: int, most: float, end: float = 0.5) -> Tubes:
    """Tubes around y = 1/(1 - x), by two equations in x, y and z = y^2, over [-end, end]."""
    graph = Graph()
    x, y, z = (graph.variable(k) for k in range(3))
    curve = system([y - x * y - 1, z - y.squared()], (0, 1, 2))
    boxes = np.array(
        [[a, 1 / (1 - a) - 0.01, (1 / (1 - a)) ** 2 - 0.1, b, 1 / (1 - b) + 0.01, (1 / (1 - b)) ** 2 + 0.1]
         for k in range(16) for a, b in [(end * (k - 8) / 8, end * (k - 7) / 8)]]
    )  # fmt: skip
    limits = (order, most, 4000)
    return tubes(
        curve.arguments(), curve.alone().arguments(), boxes, np.ones(3), (0, -end, end), limits
    )


def test_a_tube_holds_its_curve_and_is_thinner_with_a_higher_order() -> None:
    """About the middle the polynomial leaves t^(n + 1)/(1 - x), which the half width has to cover:
    red if the bound of the next coefficient over the whole interval is left out."""
    widths = []
    for order in (3, 6, 12):
        found = exponential(order, 0.5, 0.3)
        assert found.left == 0 and len(found.half) == 1
        for k in range(-40, 41):
            x = Fraction(3 * k, 400)
            t = (x - Fraction(found.middle)) / Fraction(found.radius)
            center = sum(
                (Fraction(c) * t**j for j, c in enumerate(found.coefficients[0].tolist())),
                Fraction(0),
            )
            assert abs(1 / (1 - x) - center) <= Fraction(found.half[0])
        widths.append(float(found.half[0]))
    assert widths[0] > 20 * widths[1] > 400 * widths[2]


def test_boxes_of_a_second_branch_are_in_a_tube_of_their_own() -> None:
    """y^2 = 1 + x: red if boxes far from a tube were taken for empty."""
    graph = Graph()
    x, y = graph.variable(0), graph.variable(1)
    curve = system([y.squared() - 1 - x], (0, 1))
    boxes = np.array([[-0.25, s * 1.0 - 0.2, 0.25, s * 1.0 + 0.2] for s in (-1, 1)])
    both = [curve.arguments(), curve.alone().arguments()]
    found = tubes(both[0], both[1], boxes, np.ones(2), (0, -0.25, 0.25), (8, 1e-4, 400))
    assert found.left == 0
    assert sorted(np.sign(found.coefficients[:, 0]).tolist()) == [-1, 1]


def test_where_the_curve_turns_back_no_tube_is_found() -> None:
    """x = y^2 over an interval around its fold: the derivative by y is zero there."""
    graph = Graph()
    x, y = graph.variable(0), graph.variable(1)
    curve = system([x - y.squared()], (0, 1))
    boxes = np.array([[-0.01, -0.5, 0.25, 0.5]])
    found = tubes(
        curve.arguments(),
        curve.alone().arguments(),
        boxes,
        np.ones(2),
        (0, -0.01, 0.25),
        (8, 1e-3, 300),
    )
    assert found.left > 0
