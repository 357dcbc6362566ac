"""The number of equilibria at random points of every shipped slice against msolve, an optional
program.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
import sympy
from support.maps import shipped
from support.programs import ProgramError, needs_msolve, real_solutions
from support.singular_slice import SHIPPED, axes, parameters

from ptmcad.answer.regionmap import Status

pytestmark = needs_msolve

POINTS = 8
UNKNOWNS = sympy.symbols("c1 s1 c2 s2")


def equilibria(name: str, point: tuple[Fraction, Fraction]) -> list[str]:
    """Equations in cosines and sines, from the energy of the nodes' coordinates in SymPy."""
    at = dict(
        zip(axes(name), (sympy.Rational(v.numerator, v.denominator) for v in point), strict=True)
    )
    value = {
        p: sympy.sympify(text, locals=at, rational=True) for p, text in parameters(name).items()
    }
    c1, s1, c2, s2 = UNKNOWNS
    a2, a3 = sympy.Matrix([value["rho"], 0]), value["L1"] * sympy.Matrix([c1, s1])
    a4 = sympy.Matrix([value["rho"] - value["L2"] * c2, value["L2"] * s2])
    springs = ((value["k1"], a4), (value["k2"], a3 - a2), (value["k3"], a4 - a3))
    energy = sum(k * length.dot(length) / 2 for k, length in springs)
    energy -= a3.dot(sympy.Matrix([value["F3x"], value["F3"]])) + a4.dot(
        sympy.Matrix([value["F4x"], value["F4"]])
    )
    torques = [
        c * sympy.diff(energy, s) - s * sympy.diff(energy, c) for c, s in ((c1, s1), (c2, s2))
    ]
    equations = [c1**2 + s1**2 - 1, c2**2 + s2**2 - 1, *torques]
    return [
        str(sympy.Poly(e, *UNKNOWNS).clear_denoms()[1].as_expr()).replace("**", "^")
        for e in equations
    ]


def random_points(name: str) -> list[tuple[Fraction, Fraction]]:
    random = Random(name)
    x, y = shipped(name).slice.axes
    return [
        (
            x.low + (x.high - x.low) * Fraction(random.randrange(1, 997), 997),
            y.low + (y.high - y.low) * Fraction(random.randrange(1, 991), 991),
        )
        for _ in range(POINTS)
    ]


@pytest.mark.parametrize(
    "name",
    [
        name if name in ("fig2", "fig4") else pytest.param(name, marks=pytest.mark.slow)
        for name in SHIPPED
    ],
)
def test_equilibria_at_random_points_and_samples(name: str) -> None:
    """Random points, and one sample for each count of the map, so that no count goes untested."""
    result = shipped(name)
    samples = {cell.index: (cell.sample[0], cell.sample[1]) for cell in result.cells}
    for point in (*random_points(name), *samples.values()):
        at = result.locate(**dict(zip(axes(name), point, strict=True)))
        assert at.status is Status.EXACT
        assert real_solutions([str(u) for u in UNKNOWNS], equilibria(name, point)) == at.total, (
            point
        )


def test_a_false_count_is_noticed() -> None:
    """4 and 6 equilibria on the two sides of fig. 4's boundary at rho = 1.041433, L2 = 3/2."""
    inside, outside = ((Fraction(rho), Fraction(3, 2)) for rho in ("1.04", "1.05"))
    numbers = [
        real_solutions([str(u) for u in UNKNOWNS], equilibria("fig4", point))
        for point in (inside, outside)
    ]
    assert numbers == [6, 4]


def test_what_msolve_can_not_do_is_an_error() -> None:
    with pytest.raises(ProgramError):
        real_solutions(["x", "y"], ["x*y-y"])
