"""The equilibria at a point to a hundred digits, by methods that share nothing with `ptmcad.solve` but FLINT's numbers.

Guarantee: every pose is proved to be an equilibrium, and lies in the balls that are given. For springs without free
length all equilibria are there; with free lengths those to which some start leads.

Without free lengths: the real roots of the sextic (`ptmcad.studies.sextic`) are isolated with proof; th2 = pi counts as
a root for each degree that is missing. Where V and W vanish both signs hold, elsewhere that of V W. Nothing is lost, as
multiplicities are compared. With free lengths: Newton's method in balls, proved by Krawczyk's operator.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from ptmcad.studies.equilibria import IndexedPose, balls, in_balls, inverse, proved, sign
from ptmcad.studies.sextic import sextic
from ptmcad.text.flint_numbers import from_fraction

DIGITS = 100
"""To which the angles of a pose are known, or more."""
_BITS = 400
_MAX_BITS = 2**15

Candidate = tuple[arb | None, int]
"""A real t (None for th2 = pi) with the sign of the branch of (cos th1, sin th1)."""


class Degenerate(ArithmeticError):
    """Some equilibrium has a singular Hessian, or there are infinitely many."""


def sextic_poses(parameters: Mapping[str, Fraction]) -> tuple[IndexedPose, ...]:
    """All equilibria of a mechanism whose springs have no free length.

    Raises
    ------
    Degenerate
        When some equilibrium is, or when N has no finite number of roots.
    """
    p = {name: from_fraction(v) for name, v in parameters.items()}
    bits = _BITS
    while bits <= _MAX_BITS:
        with ctx.workprec(bits):
            candidates = _candidates(p)
            poses = [None] if candidates is None else [_pose(parameters, p, *c) for c in candidates]
            found = tuple(pose for pose in poses if pose is not None)
            if len(found) == len(poses):
                return found
        bits *= 2
    raise ArithmeticError(f"{_MAX_BITS} bits do not settle the equilibria")


def _candidates(p: Mapping[str, fmpq]) -> list[Candidate] | None:
    """The real roots of N with their signs; None when the precision is too low for a sign."""
    by_hand = sextic(p)
    parts = (by_hand.coefficients, by_hand.v, by_hand.w, by_hand.square)
    polynomial, v, w, square = (fmpq_poly(list(c)) for c in parts)
    if polynomial.degree() < 0:
        raise Degenerate("the sextic vanishes")
    found: list[Candidate] = []
    missing = 6 - polynomial.degree()
    if missing:
        # at th2 = pi, V = -F3 and W = F4
        if p["F3"] == 0 and p["F4"] == 0 and missing == 2:
            found += [(None, 1), (None, -1)]
        elif missing == 1 and p["F3"] != 0:
            found.append((None, 1 if -p["F3"] * p["F4"] > 0 else -1))
        else:
            raise Degenerate("th2 = pi is a multiple solution")
    for factor, multiplicity in polynomial.numer().factor()[1]:
        v_zero, w_zero, square_zero = ((q % fmpq_poly(factor)).degree() < 0 for q in (v, w, square))
        both = v_zero and w_zero
        pairs: Any = factor.complex_roots()  # FLINT's stub says otherwise
        for root in (root.real for root, _ in pairs if root.imag == 0):
            if multiplicity != (2 if both else 1):
                raise Degenerate("the sextic has a multiple root")
            if both and square_zero:
                raise Degenerate("the first equation leaves th1 free")
            signs = (1, -1) if both else (sign(arb_poly(v)(root) * arb_poly(w)(root)),)
            if 0 in signs:
                return None
            found += [(root, side) for side in signs]
    return found


def _pose(parameters: Mapping[str, Fraction], p: Mapping[str, fmpq], t: arb | None, side: int) -> IndexedPose | None:
    """The pose of a candidate; None when the precision is too low."""
    if t is None:
        th2, c2, s2 = arb.pi(), arb(-1), arb(0)
    else:
        th2, c2, s2 = 2 * t.atan(), (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
    g = arb(p["k3"] * p["L2"])
    x = (arb((p["k2"] + p["k3"]) * p["rho"] + p["F3x"]) - g * c2) * side
    y = (arb(p["F3"]) + g * s2) * side
    th1 = arb(0) if y.is_exact() and y == 0 and x > 0 else arb.atan2(y, x)
    h11, h12, h22 = in_balls(balls(parameters), (th1, th2)).hessian
    determinant = sign(h11 * h22 - h12 * h12)
    if not determinant or (determinant > 0 and not sign(h11)) or not (_fine(th1) and _fine(th2)):
        return None
    return IndexedPose(th1, th2, 1 if determinant < 0 else 0 if h11 > 0 else 2)


def _fine(angle: arb) -> bool:
    """Whether an angle is known to `DIGITS` digits, or to be tiny (exactly zero, perhaps)."""
    radius = arb(angle.rad())
    return bool(radius < abs(angle) * arb(10) ** -DIGITS or abs(angle) + radius < arb(10) ** (-3 * DIGITS))


def newton_pose(parameters: Mapping[str, Fraction], start: tuple[float, float]) -> IndexedPose | None:
    """The equilibrium that Newton's method finds from a start, proved; None when it finds none.

    Parameters
    ----------
    start : th1, th2 in radians.
    """
    bits = 512
    with ctx.workprec(bits):
        p = balls(parameters)
        angles = [arb(start[0]), arb(start[1])]
        for _ in range(60):
            value, hessian, _ = in_balls(p, angles)
            rough = inverse(hessian)
            if rough is None:
                return None
            y11, y12, y22 = rough
            step = (y11 * value[0] + y12 * value[1], y12 * value[0] + y22 * value[1])
            if not all(s.is_finite() for s in step):
                return None
            angles = [arb((a - s).mid()) for a, s in zip(angles, step, strict=True)]
            if all(abs(s) < arb(2) ** -(bits - 60) for s in step):
                break
        found = proved(p, angles, arb(2) ** -(bits - 100))
        return None if found is None else IndexedPose(*found.box, found.negative)
