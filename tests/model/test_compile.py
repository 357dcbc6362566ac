"""Compiled systems: whose formulas they are."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import pytest
import yaml
from support.shipped_records import CONFIGS

from ptmcad.exact.models.modelsystem import system_from
from ptmcad.formulas.evaluation import values
from ptmcad.formulas.graph import Graph
from ptmcad.model import Model, described
from ptmcad.model.closed import without_loops
from ptmcad.model.compile import compiled, compiled_with
from ptmcad.question.config import load

LOOP: dict[str, Any] = yaml.safe_load("""
name: loop
parameters: {a: {default: 1}, k: {kind: stiffness, default: 1}, F: {kind: force, default: 1}}
unknowns: {t: angle, s: angle}
points: {A: [0, 0], B: [2, 0], P: [a*cos(t), a*sin(t)], Q: [2 + a*cos(s), a*sin(s)]}
bars: [[A, P], [B, Q]]
closing: [{between: [P, Q], length: 3/2}]
springs: [{between: [A, Q], k: k}]
loads: {P: [0, F]}
""")


def closed(record: dict[str, Any]) -> Model:
    return without_loops(described(record))


def test_loops_with_the_same_equations_have_points_of_their_own() -> None:
    """A point that nothing is fixed to changes no equation."""
    plain = closed(LOOP)
    marked = closed({**LOOP, "points": {**LOOP["points"], "M": ["a*cos(t)/2", "a*sin(t)/2"]}})
    assert system_from(plain) == system_from(marked)
    assert "M" not in compiled(plain).points
    assert "M" in compiled(marked).points


def test_heights_are_those_of_points_that_no_loop_holds() -> None:
    """One for each point that rises; of the loop's none."""
    open_chain = {key: value for key, value in LOOP.items() if key != "closing"}
    assert len(compiled(closed(open_chain)).heights) == 2
    assert compiled(closed(LOOP)).heights == ()


@pytest.mark.parametrize(
    "name", ["x-joint", "two-x-joints", "four-bar", "platform-loop", "slider-crank"]
)
def test_formulas_do_not_depend_on_what_variables_are_called(name: str) -> None:
    """Parameters as numbers and unknowns with other numbers: a path of an X-joint took parameters
    for unknowns.
    """
    model = load(CONFIGS / "mechanisms" / f"{name}.yaml").model
    own = compiled(model)
    choose = random.Random(len(name))
    numbers = {k: Fraction(choose.randint(1, 9), 7) for k in range(len(own.names))}
    graph = Graph()
    given = {
        each: graph.constant(numbers[k]) if each in model.variables else graph.variable(90 - k)
        for k, each in enumerate(own.names)
    }
    other = compiled_with(model, given)
    formulas = [(*known.equations, *known.inequalities, *known.stability) for known in (own, other)]
    places = (numbers, {90 - k: value for k, value in numbers.items()})
    first, second = (values(some, _Place(at)) for some, at in zip(formulas, places, strict=True))
    assert first == second


@dataclass(frozen=True)
class _Place:
    """Numbers in the place of variables; of an angle the tangent of its half."""

    at: Mapping[int, Fraction]

    def constant(self, value: Fraction) -> Fraction:
        return value

    def variable(self, number: int) -> Fraction:
        return self.at[number]

    def cos(self, number: int) -> Fraction:
        return (1 - self.at[number] ** 2) / (1 + self.at[number] ** 2)

    def sin(self, number: int) -> Fraction:
        return 2 * self.at[number] / (1 + self.at[number] ** 2)
