"""Affine forms enclose what they say, next to springs without length too; their rows lose no
solution.
"""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx
from numpy.typing import NDArray

pytest.importorskip("numba")

from ptmcad.certified.contraction import survives, workspace
from ptmcad.certified.equationsystem import EquationSystem, quotients, system
from ptmcad.certified.linear import contract_linear, space_for
from ptmcad.formulas.affine import CENTER, ERROR, FIRST, LANES, frame_for, run_affine, set_frame
from ptmcad.formulas.ballarithmetic import run_arb
from ptmcad.formulas.graph import Formula, Graph, direction, inverse_length, length, meet
from ptmcad.formulas.intervalarithmetic import run
from ptmcad.formulas.tape import Tape, record

Floats = NDArray[np.float64]


def forms_of(
    tape: Tape, low: Floats, high: Floats, unknowns: list[int]
) -> tuple[Floats, Floats, Floats]:
    """Middles and radii of the variables, and the forms of the tape on the box."""
    values = np.empty((2, len(tape)))
    assert run(tape.program, low, high, values[0], values[1], 0, len(tape))
    frame = frame_for(np.array(unknowns), len(low))
    set_frame(frame, low, high)
    forms = np.zeros((len(tape) + 1, FIRST + LANES))
    assert run_affine(tape.program, frame, values[0], values[1], forms, len(tape))
    return frame.middle, frame.radius, forms


def exact_arb(value: float) -> arb:
    fraction = Fraction(value)
    return arb(fraction.numerator) / fraction.denominator


def excess(tape: Tape, box: Floats, unknowns: list[int], rng: random.Random) -> float:
    """By how much of its error a node is farther from its form than that, at most, at random points
    of the box.
    """
    low, high = box
    middle, radius, forms = forms_of(tape, low, high, unknowns)
    worst = 0.0
    for _ in range(12):
        point = [
            rng.choice([a, b, a + (b - a) * rng.random()]) for a, b in zip(low, high, strict=True)
        ]
        with ctx.workprec(200):
            values = run_arb(
                tape,
                [exact_arb(min(max(p, a), b)) for p, a, b in zip(point, low, high, strict=True)],
                200,
            )
            for k in range(len(tape)):
                if not forms[k, ERROR] < np.inf:
                    continue
                linear = exact_arb(forms[k, CENTER])
                for j, x in enumerate(unknowns):
                    place = exact_arb(min(max(point[x], low[x]), high[x])) - exact_arb(middle[x])
                    linear += exact_arb(forms[k, FIRST + j]) * place / exact_arb(radius[x])
                worst = max(
                    worst,
                    float((abs(values[k] - linear) / exact_arb(forms[k, ERROR] + 1e-300)).lower()),
                )
    return worst


def formulas(graph: Graph) -> dict[str, list[Formula]]:
    x, y, z = (graph.variable(k) for k in range(3))
    third = graph.constant(1) / 3
    return {
        "linear": [x + third * y - z, -(x - y), (x + y) - (y - third)],
        "products": [
            x * y,
            (x + y) * (x - z),
            (x - x * y) * (y + third),
            (third * x) * (third * x),
        ],
        "squares": [x.squared(), (x - y).squared(), (x * y).squared().squared()],
        "sines": [x.sin(), x.cos(), (x + y).cos(), (3 * x - y).sin(), (x * y).sin()],
        "polar": [
            f(a, b)
            for f in (direction, length, inverse_length)
            for a, b in ((x, y), (y, x), (x - y * z, third - x), (x.cos() - y, x.sin()))
        ],
        "quotients": [
            1 / x,
            x / y,
            (x + y) / (1 + z.squared()),
            -z / (x * y),
            1 / (-2 - x.squared()),
        ],
        "meets": [meet(x * x, x.squared()), meet((x + y).squared(), x * x + 2 * (x * y) + y * y)],
    }


@pytest.mark.parametrize("what", formulas(Graph()))
@pytest.mark.fast_cases("squares", "sines")
def test_values_lie_within_the_error_of_their_form(what: str) -> None:
    """For wide boxes and such as are hardly wider than the rounding; of z only an interval is
    known.
    """
    rng, tape = random.Random(what), record([formulas(Graph())[what]])
    for width in (1.0, 0.3, 0.03, 1e-4, 1e-9, 1e-13):
        for _ in range(4):
            low = np.array([rng.uniform(-2, 2) for _ in range(3)])
            if width < 0.1:
                low[2] = rng.choice([0.0, 1.0])
            box = np.array([low, low + width * np.array([rng.uniform(0.1, 1) for _ in range(3)])])
            assert excess(tape, box, [0, 1], rng) <= 1


def test_a_length_that_may_be_zero_leaves_every_direction_and_every_inverse() -> None:
    graph = Graph()
    x, y = graph.variable(0), graph.variable(1)
    tape = record([[direction(x, y), inverse_length(x, y), x * inverse_length(x, y), 1 / (x + y)]])
    for corner in (0.0, -0.5, -1.0):  # zero in a corner, inside, in the other corner
        *_, forms = forms_of(tape, np.full(2, corner), np.full(2, corner + 1), [0, 1])
        u, r, s, q = (forms[place] for place in tape.outputs[0])
        assert u[CENTER] - u[ERROR] <= -1
        assert u[CENTER] + u[ERROR] >= 1
        assert not u[FIRST:].any()
        assert r[ERROR] == s[ERROR] == q[ERROR] == np.inf


def plane_system(rng: random.Random, kind: str) -> tuple[EquationSystem, Floats]:
    """A system in four unknowns that vanishes, and has nonnegative formulas, at a point that comes
    with it.
    """
    graph = Graph()
    point = np.array([rng.uniform(-1, 1) for _ in range(4)])
    x = [graph.variable(k) for k in range(4)]
    at = [graph.constant(Fraction(float(v))) for v in point]

    def combination() -> Formula:
        """Zero at the point."""
        p, q, r = (rng.randrange(4) for _ in range(3))
        a, b, c = (Fraction(rng.randint(-9, 9), 5) for _ in range(3))
        return (
            a * (x[p] - at[p])
            + b * (x[q] * x[r] - at[q] * at[r])
            + c * (x[r] - at[r]).sin() * (2 + x[p].cos())
        )

    def sines() -> Formula:
        """Zero at the point, without the first unknown: then that is known as well as the others
        are.
        """
        p, q = (rng.randrange(1, 4) for _ in range(2))
        return Fraction(rng.randint(-9, 9), 5) * (x[p] - at[p]).sin() * (2 + x[q].cos())

    equations = [combination() for _ in range(3)]
    vanishing: list[Formula] = []
    if (
        kind == "conditional"
    ):  # formulas that hold at solutions only, one of them for a number that the other misses
        vanishing = [
            meet(f + equations[0] * (3 + x[1].squared()), f) for f in (combination(), combination())
        ]
        vanishing = [v - 0 for v in vanishing]
    nonnegative = (
        [combination() + Fraction(1, 3), -combination().squared()] if kind == "nonnegative" else []
    )
    solved = (
        quotients([x[0] - at[0] + f for f in (sines(), sines())], (0,)) if kind == "solved" else ()
    )
    equations += [x[0] - at[0] + sines()] if kind == "solved" else []
    return system(equations[-3:], (0, 1, 2, 3), ((), vanishing), nonnegative, solved=solved), point


@pytest.mark.parametrize("kind", ["equations", "conditional", "nonnegative", "solved"])
@pytest.mark.fast_cases("nonnegative", "equations")
def test_rows_keep_every_solution(kind: str) -> None:
    """Of random systems, in boxes in which the solution is anywhere, on the edge too."""
    rng, kept, narrowed = random.Random(kind), 0, 0
    for _ in range(150):
        found, point = plane_system(rng, kind)
        arguments = found.arguments
        space, work = space_for(arguments, 4), workspace(arguments, 4)
        for width in (1.0, 0.1, 1e-3):
            low = point - width * np.array([rng.choice([0.0, 1.0, rng.random()]) for _ in range(4)])
            high = np.maximum(low + width, point)
            before = high - low
            if not survives(arguments, low, high, work):
                pytest.fail("the solution was lost by intervals")
            assert contract_linear(arguments, low, high, work.low, work.high, space) >= 0
            assert (low <= point).all()
            assert (point <= high).all()
            kept += 1
            narrowed += bool((high - low < 0.9 * before).any())
    assert narrowed > kept / 4
