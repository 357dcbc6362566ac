"""Equilibria found without ptmcad: a scan in floating point, then Newton's method with mpmath.

Everything is derived from the coordinates of the nodes by the chain rule. For fixed th2,
dU/dth1 = 0 is linear and homogeneous in (cos th1, sin th1), which leaves two opposite th1; along
both, the sign changes of dU/dth2 are looked for on a grid of th2. `Found` then has every quantity
of a pose to about 100 digits.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import mpmath
from mpmath import mpf

DIGITS = 110
GRID = 400


@dataclass(frozen=True)
class Found:
    """An equilibrium to `DIGITS` digits, the last few of which are not right."""

    angles: tuple[mpf, mpf]
    nodes: dict[str, tuple[mpf, mpf]]
    lengths: tuple[mpf, mpf, mpf]
    forces: tuple[mpf, mpf, mpf]
    energy: mpf
    eigenvalues: tuple[mpf, mpf]

    @property
    def index(self) -> int:
        return sum(value < 0 for value in self.eigenvalues)


def gradient_and_hessian(
    p: Mapping[str, mpf], th1: mpf, th2: mpf, lib: object
) -> tuple[list[mpf], list[mpf]]:
    """dU/dth1, dU/dth2 and U11, U12, U22 by the chain rule, from the coordinates of A3 and A4."""
    c1, s1, c2, s2 = lib.cos(th1), lib.sin(th1), lib.cos(th2), lib.sin(th2)  # type: ignore[attr-defined]
    x3, y3, x4, y4 = p["L1"] * c1, p["L1"] * s1, p["rho"] - p["L2"] * c2, p["L2"] * s2
    gx3 = p["k2"] * (x3 - p["rho"]) + p["k3"] * (x3 - x4) - p["F3x"]
    gy3 = p["k2"] * y3 + p["k3"] * (y3 - y4) - p["F3"]
    gx4 = p["k1"] * x4 + p["k3"] * (x4 - x3) - p["F4x"]
    gy4 = p["k1"] * y4 + p["k3"] * (y4 - y3) - p["F4"]
    gradient = [gy3 * p["L1"] * c1 - gx3 * p["L1"] * s1, gx4 * p["L2"] * s2 + gy4 * p["L2"] * c2]
    hessian = [
        (p["k2"] + p["k3"]) * p["L1"] ** 2 - gx3 * p["L1"] * c1 - gy3 * p["L1"] * s1,
        -p["k3"] * p["L1"] * p["L2"] * (c1 * c2 - s1 * s2),
        (p["k1"] + p["k3"]) * p["L2"] ** 2 + gx4 * p["L2"] * c2 - gy4 * p["L2"] * s2,
    ]
    return gradient, hessian


def starts(parameters: Mapping[str, Fraction], grid: int) -> list[tuple[float, float]]:
    """Approximate equilibria, in floating point."""
    p = {name: float(value) for name, value in parameters.items()}
    found = []
    for side in (0.0, math.pi):

        def pose(th2: float, side: float = side) -> tuple[float, float]:
            # dU/dth1 / L1 = y c1 - x s1
            x = -(p["k2"] + p["k3"]) * p["rho"] + p["k3"] * p["L2"] * math.cos(th2) - p["F3x"]
            y = -p["k3"] * p["L2"] * math.sin(th2) - p["F3"]
            return math.atan2(y, x) + side, th2

        def slope(th2: float) -> float:
            return gradient_and_hessian(p, *pose(th2), math)[0][1]  # type: ignore[arg-type]

        ends = [2 * math.pi * (k + 0.123) / grid for k in range(grid + 1)]
        values = [slope(th2) for th2 in ends]
        for left, right, a, b in zip(ends, ends[1:], values, values[1:], strict=False):
            if (a < 0) == (b < 0):
                continue
            low, high = left, right
            for _ in range(40):
                middle = (low + high) / 2
                low, high = (middle, high) if (slope(middle) < 0) == (a < 0) else (low, middle)
            found.append(pose((low + high) / 2))
    return found


def improved(parameters: Mapping[str, Fraction], start: Sequence[object]) -> Found:
    """Newton's method from an approximate equilibrium."""
    with mpmath.workdps(DIGITS):
        p = {name: mpf(v.numerator) / v.denominator for name, v in parameters.items()}
        th1, th2 = mpf(start[0]), mpf(start[1])
        for _ in range(60):
            (g1, g2), (a, b, c) = gradient_and_hessian(p, th1, th2, mpmath)
            determinant = a * c - b * b
            step1, step2 = (c * g1 - b * g2) / determinant, (a * g2 - b * g1) / determinant
            th1, th2 = th1 - step1, th2 - step2
            if abs(step1) + abs(step2) < mpf(10) ** (20 - DIGITS):
                break
        else:
            raise ArithmeticError("Newton's method does not converge")
        th1, th2 = _principal(th1), _principal(th2)
        x3, y3 = p["L1"] * mpmath.cos(th1), p["L1"] * mpmath.sin(th1)
        x4, y4 = p["rho"] - p["L2"] * mpmath.cos(th2), p["L2"] * mpmath.sin(th2)
        lengths = (
            mpmath.hypot(x4, y4),
            mpmath.hypot(x3 - p["rho"], y3),
            mpmath.hypot(x4 - x3, y4 - y3),
        )
        stiffnesses = (p["k1"], p["k2"], p["k3"])
        energy = sum(k * length**2 / 2 for k, length in zip(stiffnesses, lengths, strict=True))
        energy -= p["F3x"] * x3 + p["F3"] * y3 + p["F4x"] * x4 + p["F4"] * y4
        _, (a, b, c) = gradient_and_hessian(p, th1, th2, mpmath)
        root = mpmath.sqrt((a - c) ** 2 + 4 * b * b)
        return Found(
            (th1, th2),
            {"A1": (mpf(0), mpf(0)), "A2": (p["rho"], mpf(0)), "A3": (x3, y3), "A4": (x4, y4)},
            lengths,
            (p["k1"] * lengths[0], p["k2"] * lengths[1], p["k3"] * lengths[2]),
            energy,
            ((a + c - root) / 2, (a + c + root) / 2),
        )


def _principal(angle: mpf) -> mpf:
    """The same angle in (-pi, pi], but for rounding."""
    turn = 2 * mpmath.pi
    return angle - turn * mpmath.ceil((angle - mpmath.pi) / turn - mpf(10) ** (40 - DIGITS))


def equilibria(parameters: Mapping[str, Fraction], grid: int = GRID) -> list[Found]:
    """Every equilibrium that a scan with so many steps finds."""
    return [improved(parameters, start) for start in starts(parameters, grid)]
