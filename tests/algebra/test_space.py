"""Discriminants, resultants and common zeros over Z[u, w], beside FLINT's own, and signs over
boxes.
"""

from __future__ import annotations

import random

import pytest
from flint import fmpq, fmpz_poly

from ptmcad.algebra.bernstein import nowhere_zero
from ptmcad.algebra.polynomials import PLANE, SPACE, Coefficient
from ptmcad.algebra.space import (
    at_value,
    common_zeros,
    discriminant,
    predicted_work,
    resultant,
    rows_in,
)

X, Y, Z = SPACE.gens()
U, W = PLANE.gens()


def polynomial(source: random.Random, degree: int, even: bool = False) -> Coefficient:
    """With terms at random, of a degree in y at least."""
    powers = [
        (source.randint(0, 3), source.randint(0, degree), source.randint(0, 3)) for _ in range(6)
    ]
    powers.append((source.randint(0, 2), degree, source.randint(0, 2)))
    scale = 2 if even else 1
    return SPACE.from_dict(
        {(i * scale, j, k * scale): source.choice([-7, -2, -1, 1, 3]) for i, j, k in powers}
    )


def in_plane(p: Coefficient) -> Coefficient:
    """A polynomial without y, by z and x."""
    return PLANE.from_dict({(int(k), int(i)): c for (i, _, k), c in p.terms()})


def proportional(p: Coefficient, q: Coefficient) -> bool:
    return (
        p.primitive()[1] in (q.primitive()[1], -q.primitive()[1])
        if not p.is_zero()
        else bool(q.is_zero())
    )


@pytest.mark.parametrize("seed", range(8))
def test_discriminants_and_resultants_are_those_of_flint(seed: int) -> None:
    source = random.Random(seed)
    p, q = (
        polynomial(source, degree, seed % 2 == 1)
        for degree in (source.randint(2, 4), source.randint(1, 3))
    )
    assert proportional(discriminant(rows_in(p, 1)), in_plane(p.discriminant("y")))
    assert proportional(resultant(rows_in(p, 1), rows_in(q, 1)), in_plane(p.resultant(q, "y")))
    assert resultant(rows_in(p, 1), rows_in(p, 1)).is_zero()
    assert predicted_work([rows_in(p, 1)]) > 0


def test_a_leading_coefficient_may_vanish_at_integers() -> None:
    p = Z * (Z - 1) * Y**3 + X * Y**2 + Z
    q = (Z + 1) * X * Y**2 + Z
    assert proportional(discriminant(rows_in(p, 1)), in_plane(p.discriminant("y")))
    assert proportional(resultant(rows_in(p, 1), rows_in(q, 1)), in_plane(p.resultant(q, "y")))


def test_values_and_coefficients() -> None:
    p = 2 * X * Y**2 - Z * Y + 3
    assert rows_in(p, 1) == (PLANE.constant(3), -U, 2 * W)
    assert rows_in(p, 0) == (3 - U * W, 2 * W**2)
    assert at_value(rows_in(p, 1), fmpq(3, 2)) == 2 * 9 * W - 6 * U + 12


@pytest.mark.parametrize(
    ("p", "roots"),
    [
        (Z * Y - X, [0]),  # over x = z = 0 every y is a zero
        ((Z**2 - 4) * Y**2 + (X - Z) * Y + X - 2, [-2, 2]),  # a root more than there is, at most
        (X * (Z - 3) * Y + (X - 1) * (Z - 3) + X * (X - 1), [3]),
        (Y**2 - X * Z, []),
        (X * Y + X + 1, []),
    ],
)
def test_where_a_surface_has_a_whole_line(p: Coefficient, roots: list[int]) -> None:
    found = [q for q in common_zeros(rows_in(p, 1)) if q.degree() > 0]
    assert set(roots) >= {int(-q[0] / q[1]) for q in found if q.degree() == 1}
    for z0 in roots:
        if _has_line(p, z0):
            assert any(q(z0) == 0 for q in found)


def _has_line(p: Coefficient, z0: int) -> bool:
    """Whether all coefficients have a zero in common at z = z0."""
    common = fmpz_poly([])
    for row in rows_in(p, 1):
        values = [0] * (int(row.degrees()[1]) + 1)
        for (k, i), c in row.terms():
            values[int(i)] += int(c) * z0 ** int(k)
        common = common.gcd(fmpz_poly(values))
    return bool(common.degree() > 0)


def test_signs_over_a_box() -> None:
    box = [(fmpq(0), fmpq(2)), (fmpq(-1), fmpq(1)), (fmpq(1, 2), fmpq(3))]
    assert nowhere_zero(X, box)  # it is zero on a face only
    assert nowhere_zero(-(X**2) - Y**2 - 2 * Z, box)
    assert not nowhere_zero(Y, box)
    assert not nowhere_zero(X - Z, box)
    assert nowhere_zero(X - Z - 2, box)
