"""An independent model of the paper's mechanism: slopes and bends of its energy, written down from
the nodes.

With d the vector of a spring, l its length and k (l - l0)^2/2 its energy, the slope by an angle i
is k (1 - l0/l) d.d_i and the bend by i and j is k (1 - l0/l) (d_i.d_j + d.d_ij) + k l0 (d.d_i)
(d.d_j)/l^3. Nothing here is ptmcad's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, fmpq

NAMES = ("rho", "L1", "L2", "k1", "k2", "k3", "l0_1", "l0_2", "l0_3", "F3", "F4", "F3x", "F4x")
Vector = tuple[Any, Any]
Turned = tuple[Vector, Vector, Vector, Vector, Vector]
"""Of a spring its vector, the slopes of that by both angles and the bends by either."""


@dataclass(frozen=True)
class Derivatives:
    """Slopes e1, e2, each over the length of the angle's bar, and the slopes of these."""

    e1: Any
    e2: Any
    e11: Any
    e12: Any
    e21: Any
    e22: Any


@dataclass(frozen=True)
class PaperEnergy:
    """The energy at given parameters, as a function of both angles."""

    values: Mapping[str, Any]

    @property
    def bars(self) -> Vector:
        return self.values["L1"], self.values["L2"]

    def _vectors(self, one: Any, two: Any) -> tuple[Vector, Vector, list[Turned]]:
        """A3, A4 and the springs."""
        p = self.values
        across, up = p["L1"] * one.cos(), p["L1"] * one.sin()
        back, rise = p["L2"] * two.cos(), p["L2"] * two.sin()
        a3, a4, zero = (across, up), (p["rho"] - back, rise), (0 * across, 0 * across)
        by1, by11 = (-up, across), (-across, -up)
        by2, by22 = (rise, back), (back, -rise)
        springs = [
            (a4, zero, by2, zero, by22),
            ((across - p["rho"], up), by1, zero, by11, zero),
            (_less(a4, a3), _less(zero, by1), by2, _less(zero, by11), by22),
        ]
        return a3, a4, springs

    def squares(self, one: Any, two: Any) -> list[Any]:
        """The squares of the springs' lengths."""
        return [_dot(d, d) for d, *_ in self._vectors(one, two)[2]]

    def __call__(self, one: Any, two: Any) -> Derivatives:
        p = self.values
        (across, up), (x4, rise), springs = self._vectors(one, two)
        back = p["rho"] - x4
        u1, u2 = p["F3x"] * up - p["F3"] * across, -p["F4x"] * rise - p["F4"] * back
        u11, u22 = p["F3x"] * across + p["F3"] * up, -p["F4x"] * back + p["F4"] * rise
        u12: Any = 0
        for n, (d, by1, by2, by11, by22) in enumerate(springs, 1):
            k, free, square = p[f"k{n}"], p[f"l0_{n}"], _dot(d, d)
            length = square.sqrt()
            pull, turn = k * (1 - free / length), k * free / (square * length)
            one_, two_ = _dot(d, by1), _dot(d, by2)
            u1, u2 = u1 + pull * one_, u2 + pull * two_
            u11 = u11 + pull * (_dot(by1, by1) + _dot(d, by11)) + turn * one_ * one_
            u22 = u22 + pull * (_dot(by2, by2) + _dot(d, by22)) + turn * two_ * two_
            u12 = u12 + pull * _dot(by1, by2) + turn * one_ * two_
        l1, l2 = self.bars
        return Derivatives(u1 / l1, u2 / l2, u11 / l1, u12 / l1, u12 / l2, u22 / l2)


def energy_at(value_of: Callable[[str], Fraction]) -> PaperEnergy:
    """The energy in balls, at exact parameters by their names."""
    given = {name: value_of(name) for name in NAMES}
    return PaperEnergy({name: arb(fmpq(v.numerator, v.denominator)) for name, v in given.items()})


def _less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1]


def _dot(a: Vector, b: Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1]
