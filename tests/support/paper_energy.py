"""An independent model of the paper's mechanism: slopes and bends of its energy, written down from
the nodes, in any arithmetic.

With d the vector of a spring, l its length and k (l - l0)^2/2 its energy, the slope by an angle i
is k (1 - l0/l) d.d_i and the bend by i and j is k (1 - l0/l) (d_i.d_j + d.d_ij) + k l0 (d.d_i)
(d.d_j)/l^3. Nothing here is ptmcad's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from flint import arb, fmpq

NAMES = ("rho", "L1", "L2", "k1", "k2", "k3", "l0_1", "l0_2", "l0_3", "F3", "F4", "F3x", "F4x")
Vector = tuple[Any, Any]


class Bent(NamedTuple):
    """A pose: the nodes A3 and A4, the springs' lengths, U, its slopes U1, U2, and U11, U12, U22."""

    a3: Vector
    a4: Vector
    lengths: tuple[Any, Any, Any]
    energy: Any
    slopes: Vector
    bends: tuple[Any, Any, Any]


def bent(p: Mapping[str, Any], th1: Any, th2: Any, lib: Any) -> Bent:
    """The energy at both angles; ``lib`` has cos, sin and sqrt, as math, mpmath, numpy and `arb`
    have."""
    across, up = p["L1"] * lib.cos(th1), p["L1"] * lib.sin(th1)
    back, rise = p["L2"] * lib.cos(th2), p["L2"] * lib.sin(th2)
    a3, a4, zero = (across, up), (p["rho"] - back, rise), (0 * across, 0 * across)
    by1, by11, by2, by22 = (-up, across), (-across, -up), (rise, back), (back, -rise)
    springs = (
        (a4, zero, by2, zero, by22),
        ((across - p["rho"], up), by1, zero, by11, zero),
        (_less(a4, a3), _less(zero, by1), by2, _less(zero, by11), by22),
    )
    u = -p["F3x"] * a3[0] - p["F3"] * up - p["F4x"] * a4[0] - p["F4"] * rise
    u1, u2 = p["F3x"] * up - p["F3"] * across, -p["F4x"] * rise - p["F4"] * back
    u11, u22 = p["F3x"] * across + p["F3"] * up, -p["F4x"] * back + p["F4"] * rise
    u12, lengths = zero[0], []
    for n, (d, d1, d2, d11, d22) in enumerate(springs, 1):
        k, free, square = p[f"k{n}"], p.get(f"l0_{n}", 0), _dot(d, d)
        length, along1, along2 = lib.sqrt(square), _dot(d, d1), _dot(d, d2)
        pull, turn = (k * (1 - free / length), k * free / (square * length)) if free else (k, 0)
        u = u + k * ((length - free) ** 2 if free else square) / 2
        u1, u2 = u1 + pull * along1, u2 + pull * along2
        u11 = u11 + pull * (_dot(d1, d1) + _dot(d, d11)) + turn * along1 * along1
        u22 = u22 + pull * (_dot(d2, d2) + _dot(d, d22)) + turn * along2 * along2
        u12 = u12 + pull * _dot(d1, d2) + turn * along1 * along2
        lengths.append(length)
    return Bent(a3, a4, (lengths[0], lengths[1], lengths[2]), u, (u1, u2), (u11, u12, u22))


def alike(
    rho: Any,
    length1: Any,
    length2: Any,
    free: Any,
    f3: Any,
    f4: Any,
    *,
    k: Any = 1,
    f3x: Any = 0,
    f4x: Any = 0,
) -> dict[str, Any]:
    """The parameters of springs that are alike."""
    springs = {f"k{n}": k for n in (1, 2, 3)} | {f"l0_{n}": free for n in (1, 2, 3)}
    loads = {"F3": f3, "F4": f4, "F3x": f3x, "F4x": f4x}
    return {"rho": rho, "L1": length1, "L2": length2, **springs, **loads}


def in_balls(value_of: Callable[[str], Fraction]) -> dict[str, arb]:
    """All parameters, from their exact values by name."""
    given = {name: value_of(name) for name in NAMES}
    return {name: arb(fmpq(v.numerator, v.denominator)) for name, v in given.items()}


def _less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1]


def _dot(a: Vector, b: Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1]
