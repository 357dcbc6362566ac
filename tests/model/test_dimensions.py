"""Systems of one, three and four angles: indices are right, and what has two angles' formulas
inside refuses.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import comb

import pytest
from flint import fmpq
from support.counting import system_of
from support.signatures import count_by_isolation, count_by_signature

from ptmcad.algebra.polynomials import ONE, PLANE, Ratio
from ptmcad.algebra.trigonometric_ring import TrigonometricRing
from ptmcad.answer.counts import Counts
from ptmcad.answer.regionmap import Kind
from ptmcad.exact.discriminant_variety import discriminant_variety
from ptmcad.exact.models import ParametricSystem
from ptmcad.exact.models.system import SystemOnAxes, from_equations
from ptmcad.exact.point_system import solutions_at
from ptmcad.model.criterion import by_hessian

VALUES = {"k": fmpq(1, 100), "F": fmpq(1)}


def chain(angles: int) -> ParametricSystem:
    """Pendulums, neighbours joined by springs between their ends: U = sum of F cos th_i - k
    cos(th_i - th_i+1).

    Where k is small against F, the equilibria are the 2^n with all sines zero, one for each choice
    of signs, and a cosine of -1 (up) adds one to the index: binomial numbers of each index.
    """
    names = tuple(f"th{i}" for i in range(1, angles + 1))
    ring = TrigonometricRing(("k", "F"), names)
    energy = ring.context.constant(0)
    for name in names:
        energy -= ring.parameter("F") * ring.cos(name)
    for one, two in pairwise(names):
        energy -= ring.parameter("k") * (
            ring.cos(one) * ring.cos(two) + ring.sin(one) * ring.sin(two)
        )
    potential = ring.reduce(energy)
    slopes = [ring.reduce(ring.derivative(potential, name)) for name in names]
    return from_equations(
        ring, slopes, potential=potential, positive=("k",), criterion=by_hessian(angles)
    )


@pytest.mark.parametrize("angles", [1, 2, 3, pytest.param(4, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "count", [count_by_isolation, count_by_signature], ids=lambda f: f.__name__
)
def test_indices_are_binomial_numbers(count: Callable[..., Counts], angles: int) -> None:
    """Of three angles (1, 3, 3, 1), where formulas for two would say (2, 4, 2)."""
    found = count(chain(angles), VALUES)
    assert found.index == tuple(comb(angles, k) for k in range(angles + 1))
    assert (found.total, found.stable) == (2**angles, 1)


def ratios() -> dict[str, Ratio]:
    """k = x and F = y."""
    x, y = PLANE.gens()
    return {"k": (x, ONE), "F": (y, ONE)}


def test_numbers_of_complex_solutions_are_general() -> None:
    different, multiplicity = solutions_at(chain(3), VALUES)
    assert different == multiplicity
    assert multiplicity >= 8
    assert solutions_at(chain(1), VALUES) == (2, 2)


def test_the_variety_is_general() -> None:
    """For one pendulum det H is F cos, and vanishes at the solutions where F does."""
    window = ((fmpq(1), fmpq(2)), (fmpq(-1), fmpq(1)))
    found = discriminant_variety(SystemOnAxes(chain(1), ratios()), window)
    components, complex_solutions, _ = found
    assert complex_solutions == 2
    assert {c.polynomial.text(("k", "F")) for c in components if not c.left_out} == {"F"}
    assert {c.kind for c in components} == {
        Kind.BOUNDARY
    }  # there the equation vanishes identically
    assert (
        discriminant_variety(
            SystemOnAxes(chain(1), ratios()), window, without=frozenset({"sign-curve"})
        )
        == found
    )


def test_the_variety_of_three_angles() -> None:
    """Of the Hessian at each choice of signs: F times the signs, and k times a path's signed
    Laplacian.

    Its determinant is 0 only on lines through the origin, F = m k; by F to -F (all angles turned by
    pi) with each line comes its mirror image.
    """
    components, complex_solutions, _ = discriminant_variety(
        SystemOnAxes(chain(3), ratios()), ((fmpq(1), fmpq(2)), (fmpq(-1), fmpq(1)))
    )
    critical = {c.polynomial.text(("k", "F")) for c in components if c.kind is Kind.CRITICAL}
    assert critical == {"F", "k - F", "k + F", "3*k - F", "3*k + F"}
    assert complex_solutions == 10


def test_the_mechanism_has_two_angles() -> None:
    assert system_of("ptm").dimension == 2
