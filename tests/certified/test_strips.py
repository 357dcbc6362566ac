"""Strips and their pieces: known points of curves are in them, exactly, and they are thin."""

from __future__ import annotations

from fractions import Fraction
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

pytest.importorskip("numba")

from ptmcad.certified.boxstrips import areas_of_pieces, pieces, strips
from ptmcad.certified.equationsystem import EquationSystem, system
from ptmcad.formulas.graph import Graph


def polynomial_curve(p: list[Fraction], q: list[Fraction]) -> EquationSystem:
    """x = p(t), y = q(t), as the sum and the difference of two equations in x, y, t."""
    graph = Graph()
    x, y, t = (graph.variable(k) for k in range(3))

    def at(coefficients: list[Fraction]):  # type: ignore[no-untyped-def]
        value = graph.constant(coefficients[-1])
        for coefficient in reversed(coefficients[:-1]):
            value = value * t + graph.constant(coefficient)
        return value

    f, g = x - at(p), y - at(q)
    return system([f + g, f - g], (0, 1, 2))


def value(coefficients: list[Fraction], t: Fraction) -> Fraction:
    return sum((c * t**k for k, c in enumerate(coefficients)), Fraction(0))


def box_around(p: list[Fraction], q: list[Fraction], low: float, high: float) -> np.ndarray:  # type: ignore[type-arg]
    """A box that holds the curve over [low, high], a little larger, as floats."""
    samples = [Fraction(low) + (Fraction(high) - Fraction(low)) * k / 8 for k in range(9)]
    sides = []
    for coefficients in (p, q):
        values = [value(coefficients, t) for t in samples]
        rim = (max(values) - min(values)) / 8 + Fraction(1, 10**6)
        sides.append((float(min(values) - rim), float(max(values) + rim)))
    return np.array([[sides[0][0], sides[1][0], low, sides[0][1], sides[1][1], high]])


@settings(deadline=None, max_examples=examples(200))
@given(
    st.fractions(-1, 1, max_denominator=100),
    st.sampled_from((0.5, 0.1, 1e-3)),
    st.sampled_from((inf, 1e-3, 0.0)),
)
def test_points_of_a_circle_are_in_pieces_of_its_strips(
    s: Fraction, width: float, area: float
) -> None:
    """x^2 + y^2 = 1, t = y: the strip's slope is uncertain here, and nothing else is."""

    def point(s: Fraction) -> tuple[Fraction, Fraction]:
        return (1 - s**2) / (1 + s**2), 2 * s / (1 + s**2)

    graph = Graph()
    x, y, t = (graph.variable(k) for k in range(3))
    circle = system([x.squared() + y.squared() - graph.constant(Fraction(1)), y - t], (0, 1, 2))
    u, v = map(float, point(s))
    box = np.array([[u - width, v - width, v - width, u + width, v + width, v + width]])
    rectangles = pieces(strips(circle.arguments, box), area).tolist()
    for k in range(-40, 41):
        x0, y0 = point(s + Fraction(width) * k / 40)
        if box[0, 0] <= x0 <= box[0, 3] and box[0, 1] <= y0 <= box[0, 4]:
            assert any(r[0] <= x0 <= r[2] and r[1] <= y0 <= r[3] for r in rectangles), (x0, y0)


def test_the_finest_pieces_of_a_smooth_curve_are_as_thin_as_it_is_bent() -> None:
    """A box of half the width has a strip of a quarter of the thickness, so pieces of an eighth of
    the area.
    """
    p, q = [Fraction(0), Fraction(1), Fraction(1, 2)], [Fraction(1), Fraction(2), Fraction(-1)]
    areas = []
    for width in (0.02, 0.01, 0.005):
        found = strips(polynomial_curve(p, q).arguments, box_around(p, q, 0.3, 0.3 + width))
        rectangles = pieces(found, 0.0)
        assert len(rectangles) > 8
        exact = float(
            ((rectangles[:, 2] - rectangles[:, 0]) * (rectangles[:, 3] - rectangles[:, 1])).sum()
        )
        assert exact <= 1.001 * areas_of_pieces(found, 0.0).sum()
        areas.append(exact)
    assert areas[1] < 0.3 * areas[0]
    assert areas[2] < 0.3 * areas[1]


def test_a_box_without_solutions_has_no_strip() -> None:
    p, q = [Fraction(0), Fraction(1)], [Fraction(0), Fraction(1)]
    found = strips(polynomial_curve(p, q).arguments, np.array([[0.0, 0.5, 0.0, 0.1, 0.6, 0.1]]))
    assert len(found) == 0


def test_a_box_with_an_unbounded_derivative_stays_whole() -> None:
    """x = 1/t over an interval with t = 0: the natural test cannot exclude it, and nothing linear
    can be said.
    """
    graph = Graph()
    x, y, t = (graph.variable(k) for k in range(3))
    curve = system([x - graph.constant(Fraction(1)) / t, y - t], (0, 1, 2))
    box = np.array([[-1.0, -1.0, -1.0, 1.0, 1.0, 1.0]])
    found = strips(curve.arguments, box)
    assert pieces(found, 0.0).tolist() == [[-1.0, -1.0, 1.0, 1.0]]
