"""Functions of two parameters that are just positive over a window, or just not."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, axis, constant

Q = Fraction
AXES = (Axis("rho", Q(0), Q(2)), Axis("F", Q(-3), Q(1)))
NAMES = {"rho": axis(0), "F": axis(1)}
X, Y = axis(0), axis(1)
THIN = Q(1, 10**9)


def thin_dip(kind: str) -> tuple[Expression, Expression]:
    """A function with a dip of width 1e-9 below zero; and the same one, raised until it is
    positive.
    """
    third, seventh = Q(1, 3), Q(-1, 7)
    low, deep = THIN**2, THIN**20
    return {
        "middle": (
            (X - third) ** 2 + (Y - seventh) ** 2 - low,
            (X - third) ** 2 + (Y - seventh) ** 2 + low,
        ),
        "line": ((X - third) ** 2 - low, (X - third) ** 2 + low),
        "diagonal": ((X - Y - third) ** 2 - low, (X - Y - third) ** 2 + low),
        "edge": (X + (Y - seventh) ** 2 - low, X + (Y - seventh) ** 2),
        "upper edge": (1 - Y + (X - third) ** 2 - low, 1 - Y + (X - third) ** 2),
        "corner": (X + Y + 3 - THIN, X + Y + 3),
        "far corner": (2 - X + (1 - Y) * 5 - THIN, 2 - X + (1 - Y) * 5),
        "degree 20": ((X - third) ** 20 - deep, (X - third) ** 20 + deep),
        "degree 20 in both": (
            (X - third) ** 20 + (Y - seventh) ** 10 - deep,
            (X - third) ** 20 + (Y - seventh) ** 10 + deep,
        ),
        "degree 8 in both": (
            (X - third) ** 8 + (Y - seventh) ** 6 - THIN**8,
            (X - third) ** 8 + (Y - seventh) ** 6 + THIN**8,
        ),
        "irrational": (
            (X**2 - 2) ** 2 + (Y**2 - third) ** 2 - low,
            (X**2 - 2) ** 2 + (Y**2 - third) ** 2 + low,
        ),
        "high power": (Q(1, 10) - X**13 + 8191, 8193 - X**13 + 0 * Y),
    }[kind]


DIPS = ("middle", "line", "diagonal", "edge", "upper edge", "corner", "far corner", "degree 20", "degree 8 in both",
        "irrational", "high power", pytest.param("degree 20 in both", marks=pytest.mark.slow))  # fmt: skip


def random_square(rng: random.Random, degree: int) -> Expression:
    """A sum of squares of random polynomials of half the degree, none of which is constant."""
    total = constant(0)
    for _ in range(2):
        p = constant(rng.randint(-3, 3))
        for i in range(degree // 2 + 1):
            for j in range(degree // 2 + 1 - i):
                if i + j and rng.random() < 0.7:
                    p = p + rng.randint(-3, 3) * X**i * Y**j
        total = total + p * p
    return total
