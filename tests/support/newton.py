"""Equilibria found without ptmcad: a scan in floating point, then Newton's method with mpmath.

The energy is that of `paper_energy`. For fixed th2, dU/dth1 = 0 is linear and homogeneous in
(cos th1, sin th1), which leaves two opposite th1; along both, the sign changes of dU/dth2 are
looked for on a grid of th2. `Found` then has every quantity of a pose to about 100 digits.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import mpmath
from mpmath import mpf

from support.paper_energy import bent

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
            return float(bent(p, *pose(th2), math).slopes[1])

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
            *_, (g1, g2), (a, b, c) = bent(p, th1, th2, mpmath)
            determinant = a * c - b * b
            step1, step2 = (c * g1 - b * g2) / determinant, (a * g2 - b * g1) / determinant
            th1, th2 = th1 - step1, th2 - step2
            if abs(step1) + abs(step2) < mpf(10) ** (20 - DIGITS):
                break
        else:
            raise ArithmeticError("Newton's method does not converge")
        th1, th2 = _principal(th1), _principal(th2)
        a3, a4, lengths, energy, _, (a, b, c) = bent(p, th1, th2, mpmath)
        root = mpmath.sqrt((a - c) ** 2 + 4 * b * b)
        return Found(
            (th1, th2),
            {"A1": (mpf(0), mpf(0)), "A2": (p["rho"], mpf(0)), "A3": a3, "A4": a4},
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
