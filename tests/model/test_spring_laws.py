"""The laws of springs between points, whose formulas are written by hand."""

from __future__ import annotations

import pytest
import sympy

from ptmcad.model.elements import Law
from ptmcad.text.tree import Tree, to_text

LENGTH, FREE = sympy.symbols("l f")


def formula(tree: Tree) -> sympy.Expr:
    """In the length, its square put in."""
    return sympy.sympify(to_text(tree).replace("^", "**"), rational=True).subs(
        sympy.Symbol("q"), LENGTH**2
    )


@pytest.mark.parametrize("law", Law)
def test_the_formulas_of_a_law_belong_together(law: Law) -> None:
    """The force is the energy's slope; the energy is smooth - pull*l, but for what no length is in."""
    energy, smooth, density, pull, force = map(
        formula, (law.energy, law.smooth, law.density, law.pull, law.force)
    )
    assert sympy.expand(energy.diff(LENGTH) - force) == 0
    assert sympy.expand(energy - smooth + pull * LENGTH).diff(LENGTH) == 0
    assert sympy.expand(density * LENGTH - force.subs(FREE, 0)) == 0
    assert pull.subs(FREE, 0) == 0 and not pull.has(LENGTH)
