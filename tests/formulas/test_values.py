"""Formulas' values in an arithmetic that is given: rationals that count how often they are
multiplied.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import pytest

from ptmcad.formulas.evaluation import evaluated, values
from ptmcad.formulas.graph import Formula, Graph


class Counted:
    """Rationals, at 3/5 for a cosine and 4/5 for a sine."""

    def __init__(self) -> None:
        self.cosines = 0

    def constant(self, value: Fraction) -> Fraction:
        return value

    def variable(self, number: int) -> Fraction:
        return Fraction(number + 2)

    def cos(self, number: int) -> Fraction:
        self.cosines += 1
        return Fraction(3, 5)

    def sin(self, number: int) -> Fraction:
        return Fraction(4, 5)


class Bar(NamedTuple):
    name: str
    end: tuple[Formula, Formula]


def test_each_node_has_one_value() -> None:
    graph, arithmetic = Graph(), Counted()
    length, angle = graph.variable(0), graph.variable(1)
    x, y = length * angle.cos(), length * angle.sin()
    assert values([x * x + y * y, x - 1], arithmetic) == [4, Fraction(1, 5)]
    assert arithmetic.cosines == 1


def test_a_structure_keeps_its_shape() -> None:
    """And what is no formula in it."""
    graph, arithmetic = Graph(), Counted()
    length, angle = graph.variable(0), graph.variable(1)
    bar = Bar("crank", (length * angle.cos(), length * angle.sin()))
    found = evaluated(({"P": bar.end}, (bar,), None), arithmetic)
    end = (Fraction(6, 5), Fraction(8, 5))
    assert found == ({"P": end}, (Bar("crank", end),), None)  # type: ignore[arg-type]
    assert isinstance(found[1][0], Bar)
    assert arithmetic.cosines == 1


def test_a_quotient_has_no_value_among_numbers_without_quotients() -> None:
    graph = Graph()
    with pytest.raises(AttributeError, match="divide"):
        values([1 / graph.variable(0)], Counted())
