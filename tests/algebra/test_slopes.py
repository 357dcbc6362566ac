"""Tangents of plane curves in given directions: known curves."""

from __future__ import annotations

import pytest
from flint import fmpq

from ptmcad.algebra.chords import Direction, tangent_resultant
from ptmcad.algebra.polynomials import from_plane
from ptmcad.algebra.real_roots import isolate
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.text.plane import PlanePolynomial

FOLD: Direction = (1, 0)
UPRIGHT: Direction = (0, 1)
CIRCLE = from_plane(PlanePolynomial.parse("x^2 + y^2 - 25"))
PARABOLA = from_plane(PlanePolynomial.parse("x^2 - y"))


def heights(p: object, direction: Direction) -> list[float]:
    roots = isolate(tangent_resultant(p, direction), fmpq(-10), fmpq(10))  # type: ignore[arg-type]
    return [float(to_fraction(r.middle)) for r in roots]


@pytest.mark.parametrize(("direction", "expected"), [
    ((1, 0), [-5, 5]),  # horizontal tangents at the top and the bottom
    ((0, 1), [0]),
    ((4, -3), [-4, 4]),  # at (3, 4) and (-3, -4)
], ids=["horizontal", "upright", "oblique"])  # fmt: skip
def test_circle(direction: Direction, expected: list[int]) -> None:
    roots = isolate(tangent_resultant(CIRCLE, direction), fmpq(-10), fmpq(10))
    assert len(roots) == len(expected)
    assert all(r.low <= y <= r.high for r, y in zip(roots, expected, strict=True))


def test_parabola_has_one_horizontal_tangent() -> None:
    assert heights(PARABOLA, FOLD) == [0]
    assert heights(PARABOLA, UPRIGHT) == []


def test_a_line_of_the_direction_is_refused() -> None:
    line = from_plane(PlanePolynomial.parse("x^2 - 2*x*y + y^2"))  # (x - y)^2
    with pytest.raises(ArithmeticError, match="contains a line"):
        tangent_resultant(line, (1, 1))
