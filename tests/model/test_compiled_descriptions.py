"""Descriptions compiled: nothing in one goes unnoticed, and numbers in the place of parameters
change no value.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from fractions import Fraction
from types import MappingProxyType

import pytest
import yaml

import ptmcad
from ptmcad.formulas.evaluation import nodes_of, substituted, values
from ptmcad.formulas.graph import Graph
from ptmcad.model import ClosedMechanism, Mechanism, System
from ptmcad.model.compile import compiled, compiled_with

PENDULUM = ptmcad.Mechanism(yaml.safe_load("""
parameters: {l0: {kind: free length}, W: {kind: force}, c: {kind: stiffness, default: 2}}
unknowns: {th: angle}
points: {O: [0, 0], A: [0, 3], P: [sin(th), cos(th)]}
springs: [{between: [A, P], k: 1, free: l0}]
torsion: [{angle: th, k: c}]
loads: {P: {weight: W}}
"""))  # fmt: skip

NAMES = {"name", "title", "source", "parameters", "unknowns"}
DRAWN = {"bars", "bodies", "supports", "symmetries"}
"""What changes no equation."""
READ = {"points", "springs", "torsion", "loads", "moments", "closing", "xjoints"}
EQUATIONS = {"equations", "potential", "inequalities", "stability"}


@pytest.mark.parametrize(
    ("kind", "known"),
    [
        (Mechanism, NAMES | DRAWN | READ),
        (System, NAMES | EQUATIONS),
        (ClosedMechanism, NAMES | {"mechanism"}),
    ],
)
def test_all_that_a_description_has_is_compiled(kind: type, known: set[str]) -> None:
    """A new part of descriptions has to be read by `ptmcad.model.compile`, or listed here as one
    that says nothing.
    """
    assert {f.name for f in fields(kind)} == known


class _Place:
    """A place on the circle with rational coordinates, and numbers for parameters by the names of a
    system.
    """

    def __init__(
        self, names: tuple[str, ...] = (), numbers: Mapping[str, Fraction] = MappingProxyType({})
    ):
        self.names, self.numbers = names, numbers

    def constant(self, value: Fraction) -> Fraction:
        return value

    def variable(self, number: int) -> Fraction:
        return self.numbers[self.names[number]]

    def cos(self, _: int) -> Fraction:
        return Fraction(3, 5)

    def sin(self, _: int) -> Fraction:
        return Fraction(4, 5)


def test_numbers_in_the_place_of_parameters_change_no_value() -> None:
    system = compiled(PENDULUM)
    numbers = {"l0": Fraction(1, 2), "W": Fraction(3), "c": Fraction(2)}
    graph = Graph()
    at = compiled_with(
        PENDULUM,
        {"th": graph.variable(0)}
        | {name: graph.constant(value) for name, value in numbers.items()},
    )
    assert values(system.equations, _Place(system.names, numbers)) == values(at.equations, _Place())
    # (k d . d')/1 + c sin th - W sin th, with d = (sin th, cos th - 3)
    assert values(at.equations, _Place()) == [Fraction(4, 5) * (3 + 2 - 3)]


def test_what_has_no_value_in_an_arithmetic_is_refused() -> None:
    graph = Graph()
    quotient = graph.constant(1) / graph.variable(0)
    with pytest.raises(AttributeError):
        compiled(PENDULUM).values([quotient], _Integers())
    assert [node.number for node in nodes_of([quotient])] == [0, 1, 2]
    with pytest.raises(ZeroDivisionError):
        substituted(quotient, {0: graph.constant(0)})


class _Integers:
    """A ring in which every name is 1."""

    def constant(self, value: Fraction) -> int:
        return int(value)

    def parameter(self, _: str) -> int:
        return 1

    cos = sin = parameter
