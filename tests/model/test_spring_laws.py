"""The laws of springs between points, whose formulas are written by hand."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from ptmcad.model.elements import Law
from ptmcad.model.evaluate import value_at
from ptmcad.model.trees import derivative


@pytest.mark.parametrize("law", Law)
def test_the_formulas_of_a_law_belong_together(law: Law) -> None:
    """The force is the energy's slope; the energy is smooth - pull*l, but for what no length is in."""
    values = {"k": Fraction(3, 7), "f": Fraction(2, 5)}

    def at(tree: Any, length: Fraction, free: Fraction = values["f"]) -> Fraction:
        return value_at(tree, values | {"f": free, "l": length, "q": length * length})

    def rest(length: Fraction) -> Fraction:
        return at(law.energy, length) - at(law.smooth, length) + at(law.pull, length) * length

    for length in (Fraction(1, 3), Fraction(5, 2)):
        assert rest(length) == rest(Fraction(0))
        slope = at(derivative(law.energy, "l"), length) + 2 * length * at(derivative(law.energy, "q"), length)
        assert at(law.force, length) == slope
        assert at(law.density, length) * length == at(law.force, length, Fraction(0))
        assert at(law.pull, length, Fraction(0)) == 0
