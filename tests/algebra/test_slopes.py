"""Tangents of plane curves in given directions: known curves, and the curve of the paper's fig. 4."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import fmpq

from ptmcad.algebra.polynomials import from_plane
from ptmcad.algebra.real_roots import isolate
from ptmcad.algebra.slopes import Direction, may_be_tangent, tangent_resultant
from ptmcad.studies.paper.maps import curves
from ptmcad.text.flint_numbers import to_fraction
from ptmcad.text.plane import PlanePolynomial

FOLD: Direction = (1, 0)
UPRIGHT: Direction = (0, 1)
HALF: Direction = (1, 2)
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


def test_where_a_circle_is_tangent() -> None:
    """(4, -3) is tangent at (3, 4), not at (-3, 4), which has the same height."""
    top = isolate(tangent_resultant(CIRCLE, (4, -3)), fmpq(0), fmpq(10))[0]
    assert may_be_tangent(CIRCLE, (4, -3), top, fmpq(2), fmpq(7, 2))
    assert not may_be_tangent(CIRCLE, (4, -3), top, fmpq(-4), fmpq(2))


def test_parabola_has_one_horizontal_tangent() -> None:
    assert heights(PARABOLA, FOLD) == [0]
    assert heights(PARABOLA, UPRIGHT) == []


def test_a_line_of_the_direction_is_refused() -> None:
    line = from_plane(PlanePolynomial.parse("x^2 - 2*x*y + y^2"))  # (x - y)^2
    with pytest.raises(ArithmeticError, match="contains a line"):
        tangent_resultant(line, (1, 1))


@pytest.mark.slow
def test_the_low_end_of_fig_4_reaches_slope_one_half() -> None:
    """At L2 = 1.5298 (seen by differences of the ends)."""
    p = from_plane(curves("fig4")[0].polynomial)
    tangents = tangent_resultant(p, HALF)

    def never(high: Fraction) -> bool:
        found = isolate(tangents, fmpq(1), fmpq(high.numerator, high.denominator))
        return not any(may_be_tangent(p, HALF, y, fmpq(1, 10), fmpq(2)) for y in found)

    assert never(Fraction(3, 2))
    assert never(Fraction(15298, 10000))
    assert not never(Fraction(15299, 10000))
