"""The equilibria at a point to a hundred digits, by methods that share nothing with `ptmcad.solve` but FLINT's numbers.

Guarantee: every pose is proved to be an equilibrium, and lies in the balls that are given. For springs without free
length all equilibria are there; with free lengths those to which some start leads.

Without free lengths: for a given th2 the first equation is homogeneous and linear in (cos th1, sin th1), so that these
are +-(X, Y)/|(X, Y)|; put into the second, squared, it leaves a sextic N in t = tan(th2/2),

    N = (k3 L1)^2 P^2 (1 + t^2) - Q^2 W,   P = F3 (1 - t^2) + 2 a1 t,   Q = 2 a2 t - F4 (1 - t^2),
    W = (1 + t^2) |(X, Y)|^2,   X = a1 - k3 L2 cos th2,   Y = F3 + k3 L2 sin th2,
    a1 = (k2 + k3) rho + F3x,   a2 = (k1 + k3) rho - F4x.

Its roots are isolated with proof; th2 = pi counts as a root for each degree that is missing. Where P and Q vanish both
signs hold, elsewhere that of P Q. Nothing is lost, as multiplicities are compared. With free lengths: Newton's method
in balls, proved by Krawczyk's operator.

References: Krawczyk, Computing 4 (1969); Rump, Acta Numerica 19 (2010), section 13.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, ctx, fmpq, fmpq_poly

DIGITS = 100
_BITS = 400
_MAX_BITS = 2**15


class Degenerate(ArithmeticError):
    """Some equilibrium has a singular Hessian, or there are infinitely many."""


@dataclass(frozen=True, slots=True)
class ReferencePose:
    """An equilibrium: its angles, to `DIGITS` digits or more, and the number of negative eigenvalues of its Hessian."""

    th1: arb
    th2: arb
    index: int


@dataclass(frozen=True, slots=True)
class _Candidate:
    """A real t (None for th2 = pi) with the sign of the branch of (cos th1, sin th1)."""

    t: arb | None
    sign: int


def sextic_poses(parameters: Mapping[str, Fraction]) -> tuple[ReferencePose, ...]:
    """All equilibria of a mechanism whose springs have no free length.

    Raises
    ------
    Degenerate
        When some equilibrium is, or when N has no finite number of roots.
    """
    p = {name: fmpq(v.numerator, v.denominator) for name, v in parameters.items()}
    bits = _BITS
    while bits <= _MAX_BITS:
        with ctx.workprec(bits):
            candidates = _candidates(p)
            poses = [_pose(p, c) for c in candidates] if candidates is not None else [None]
            found = tuple(pose for pose in poses if pose is not None)
            if len(found) == len(poses):
                return found
        bits *= 2
    raise ArithmeticError(f"{_MAX_BITS} bits do not settle the equilibria")


def _candidates(p: Mapping[str, fmpq]) -> list[_Candidate] | None:
    """The real roots of N with their signs; None when the precision is too low for a sign."""
    a1, a2 = (p["k2"] + p["k3"]) * p["rho"] + p["F3x"], (p["k1"] + p["k3"]) * p["rho"] - p["F4x"]
    g = p["k3"] * p["L2"]
    first_moment = fmpq_poly([p["F3"], 2 * a1, -p["F3"]])
    second_moment = fmpq_poly([-p["F4"], 2 * a2, p["F4"]])
    square = a1 * a1 + p["F3"] * p["F3"] + g * g
    length = fmpq_poly([square - 2 * a1 * g, 4 * g * p["F3"], square + 2 * a1 * g])
    sextic = (
        first_moment * first_moment * fmpq_poly([1, 0, 1]) * (p["k3"] * p["L1"]) ** 2
        - second_moment * second_moment * length
    )
    if sextic.degree() < 0:
        raise Degenerate("the sextic vanishes")
    found: list[_Candidate] = []
    missing = 6 - sextic.degree()
    if missing:
        # at th2 = pi, P = -F3 and Q = F4
        if p["F3"] == 0 and p["F4"] == 0 and missing == 2:
            found += [_Candidate(None, 1), _Candidate(None, -1)]
        elif missing == 1 and p["F3"] != 0:
            found.append(_Candidate(None, 1 if -p["F3"] * p["F4"] > 0 else -1))
        else:
            raise Degenerate("th2 = pi is a multiple solution")
    for factor, multiplicity in sextic.numer().factor()[1]:
        of_factor = fmpq_poly(factor)
        both = (first_moment % of_factor).degree() < 0 and (second_moment % of_factor).degree() < 0
        for root in _real_roots(factor):
            if multiplicity != (2 if both else 1):
                raise Degenerate("the sextic has a multiple root")
            if both and (length % of_factor).degree() < 0:
                raise Degenerate("the first equation leaves th1 free")
            if both:
                found += [_Candidate(root, 1), _Candidate(root, -1)]
                continue
            sign = _sign(_at(first_moment, root) * _at(second_moment, root))
            if sign == 0:
                return None
            found.append(_Candidate(root, sign))
    return found


def _real_roots(factor: Any) -> list[arb]:
    """The real roots of an irreducible polynomial over Z, isolated with proof at the context's precision."""
    return [root.real for root, _ in factor.complex_roots() if root.imag == 0]


def _at(polynomial: fmpq_poly, t: arb) -> arb:
    total = arb(0)
    for c in reversed(polynomial.coeffs()):
        total = total * t + arb(c)
    return total


def _pose(p: Mapping[str, fmpq], candidate: _Candidate) -> ReferencePose | None:
    """The pose of a candidate; None when the precision is too low."""
    t = candidate.t
    if t is None:
        th2, c2, s2 = arb.pi(), arb(-1), arb(0)
    else:
        th2 = 2 * t.atan()
        c2, s2 = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
    g = arb(p["k3"] * p["L2"])
    x = (arb((p["k2"] + p["k3"]) * p["rho"] + p["F3x"]) - g * c2) * candidate.sign
    y = (arb(p["F3"]) + g * s2) * candidate.sign
    length = (x * x + y * y).sqrt()
    if not length > 0:
        return None
    th1 = arb(0) if y.is_exact() and y == 0 and x > 0 else arb.atan2(y, x)
    c1, s1 = x / length, y / length
    h11 = arb(p["L1"]) * length * candidate.sign
    h12 = -g * arb(p["L1"]) * (c1 * c2 - s1 * s2)
    pull = arb(p["k3"] * p["L1"])
    a2 = arb((p["k1"] + p["k3"]) * p["rho"] - p["F4x"])
    h22 = arb(p["L2"]) * ((a2 - pull * c1) * c2 + (pull * s1 + arb(p["F4"])) * s2)
    determinant = _sign(h11 * h22 - h12 * h12)
    if determinant == 0 or not (_fine(th1) and _fine(th2)):
        return None
    return ReferencePose(th1, th2, 1 if determinant < 0 else 0 if h11 > 0 else 2)


def _sign(value: arb) -> int:
    """The sign of a ball, 0 when it contains zero."""
    return int(value > 0) - int(value < 0)


def _fine(angle: arb) -> bool:
    """Whether an angle is known to `DIGITS` digits, or to be tiny (exactly zero, perhaps)."""
    radius = arb(angle.rad())
    return bool(radius < abs(angle) * arb(10) ** -DIGITS or abs(angle) + radius < arb(10) ** (-3 * DIGITS))


# ---------------------------------------------------------------------------------------------------- free lengths


def newton_pose(parameters: Mapping[str, Fraction], start: tuple[float, float]) -> ReferencePose | None:
    """The equilibrium that Newton's method finds from a start, proved; None when it finds none.

    Parameters
    ----------
    start : th1, th2 in radians.
    """
    bits = 512
    with ctx.workprec(bits):
        p = {name: arb(fmpq(v.numerator, v.denominator)) for name, v in parameters.items()}
        angles = [arb(start[0]), arb(start[1])]
        for _ in range(60):
            value, hessian = _gradient_and_hessian(p, angles)
            step = _solved(hessian, value)
            if step is None or not all(s.is_finite() for s in step):
                return None
            angles = [arb((a - s).mid()) for a, s in zip(angles, step, strict=True)]
            if all(abs(s) < arb(2) ** -(bits - 60) for s in step):
                break
        radius = arb(2) ** -(bits - 100)
        box = [a + radius * arb(0, 1) for a in angles]
        value, _ = _gradient_and_hessian(p, angles)
        _, hessian = _gradient_and_hessian(p, box)
        inverse = _inverse([arb(h.mid()) for h in hessian])
        if inverse is None or not all(h.is_finite() for h in hessian):
            return None
        if not all(b.contains_interior(i) for b, i in zip(box, _krawczyk(angles, radius, value, hessian, inverse),
                                                          strict=True)):  # fmt: skip
            return None
        determinant = _sign(hessian[0] * hessian[2] - hessian[1] * hessian[1])
        if determinant == 0:
            return None
        return ReferencePose(box[0], box[1], 1 if determinant < 0 else 0 if hessian[0] > 0 else 2)


def _krawczyk(
    middle: Sequence[arb], radius: arb, value: Sequence[arb], hessian: Sequence[arb], inverse: Sequence[arb]
) -> list[arb]:
    """Krawczyk's operator: if it maps the box into its interior there is exactly one zero."""
    h11, h12, h22 = hessian
    y11, y12, y22 = inverse
    rest = ((1 - y11 * h11 - y12 * h12, y11 * h12 + y12 * h22), (y12 * h11 + y22 * h12, 1 - y12 * h12 - y22 * h22))
    moved = (y11 * value[0] + y12 * value[1], y12 * value[0] + y22 * value[1])
    spread = radius * arb(0, 1)
    return [m - d + (abs(r[0]) + abs(r[1])) * spread for m, d, r in zip(middle, moved, rest, strict=True)]


def _inverse(h: Sequence[arb]) -> list[arb] | None:
    determinant = h[0] * h[2] - h[1] * h[1]
    if _sign(determinant) == 0:
        return None
    return [arb((e / determinant).mid()) for e in (h[2], -h[1], h[0])]


def _solved(h: Sequence[arb], value: Sequence[arb]) -> tuple[arb, arb] | None:
    determinant = h[0] * h[2] - h[1] * h[1]
    if _sign(determinant) == 0:
        return None
    return ((h[2] * value[0] - h[1] * value[1]) / determinant, (h[0] * value[1] - h[1] * value[0]) / determinant)


def _gradient_and_hessian(p: Mapping[str, arb], angles: Sequence[arb]) -> tuple[list[arb], list[arb]]:
    """dU/dth1, dU/dth2 and U11, U12, U22: each spring's force and stiffness, pulled back to the angles."""
    c1, s1, c2, s2 = angles[0].cos(), angles[0].sin(), angles[1].cos(), angles[1].sin()
    zero = arb(0)
    x3, y3 = p["L1"] * c1, p["L1"] * s1
    turned, y4 = p["L2"] * c2, p["L2"] * s2
    x4 = p["rho"] - turned
    # the nodes' velocities by th1 (A3) and by th2 (A4)
    v3, v4 = (-y3, x3), (y4, turned)
    gradient = [-(p["F3x"] * v3[0] + p["F3"] * v3[1]), -(p["F4x"] * v4[0] + p["F4"] * v4[1])]
    h11, h12, h22 = p["F3x"] * x3 + p["F3"] * y3, zero, -p["F4x"] * turned + p["F4"] * y4
    for number, dx, dy, by1, by2 in (
        ("1", x4, y4, 0, 1), ("2", x3 - p["rho"], y3, 1, 0), ("3", x4 - x3, y4 - y3, -1, 1),
    ):  # fmt: skip
        k, free = p[f"k{number}"], p.get(f"l0_{number}", zero)
        slack = k
        bend = zero
        if not free.is_zero():
            length = (dx * dx + dy * dy).sqrt()
            slack, bend = k * (1 - free / length), k * free / length**3
        along = [by1 * (dx * v3[0] + dy * v3[1]), by2 * (dx * v4[0] + dy * v4[1])]
        gradient = [g + slack * a for g, a in zip(gradient, along, strict=True)]
        # accelerations: A3's by th1 twice is -A3, A4's by th2 twice is A2 - A4 = (turned, -y4)
        h11 += bend * along[0] * along[0] + slack * by1 * (by1 * p["L1"] ** 2 - (dx * x3 + dy * y3))
        h22 += bend * along[1] * along[1] + slack * by2 * (by2 * p["L2"] ** 2 + dx * turned - dy * y4)
        h12 += bend * along[0] * along[1] + slack * by1 * by2 * (v3[0] * v4[0] + v3[1] * v4[1])
    return gradient, [h11, h12, h22]
