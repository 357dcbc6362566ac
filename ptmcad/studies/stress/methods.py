"""The equilibria at a point: to a hundred digits with proof, and in double precision as they are computed in practice.

Neither shares anything with `ptmcad.solve` but FLINT's numbers; both begin with the sextic in t = tan(th2/2)
(`ptmcad.studies.byhand`) where no spring has a free length.

Guarantee of `newton_pose`: a pose that it gives is the only zero of the gradient (`ptmcad.studies.byhand`) in its
box, with a nonsingular Hessian.

Guarantee of `sextic_poses`: all equilibria are there, each proved and in the balls that are given. The real roots are
isolated with proof; th2 = pi counts as a root for each degree that is missing. Where V and W vanish both signs hold,
elsewhere that of V W. Nothing is lost, as multiplicities are compared.

`double_poses` guarantees nothing; it is the baseline that can be wrong. Without free lengths: eigenvalues of the
companion matrix, th1 from the first equation, the Hessian's signs in floats. It is treated kindly: th2 = pi, which t
cannot reach, is put back where the leading coefficients vanish. With free lengths: Newton's method from a grid of
starts. Deciding which roots are real, which are one, and what is zero takes tolerances; they are usual ones.

References: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations (1990), theorem 5.1.8;
Rump, Acta Numerica 19 (2010), section 13.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx, fmpq, fmpq_poly
from numpy.typing import NDArray

from ptmcad.mechanism import ptm
from ptmcad.studies.byhand import Derivatives, derivatives, parts, sextic
from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction

BITS = (600, 2400, 9600)
"""Of precision, tried in turn."""
REAL_TOLERANCE = 1e-8
"""A root is taken for real when its imaginary part is at most this much of 1 + its modulus."""
ZERO_TOLERANCE = 1e-12
"""A coefficient is taken for zero when it is at most this much of the largest."""
STARTS = 24
"""Starts of Newton's method along each angle."""
ROUNDS = 60
"""Of Newton's method."""
RESIDUAL = 1e-9
"""A gradient is taken for zero when it is at most this much of the largest force times length."""
SAME_POSE = 1e-6
"""Poses no farther apart than this (radians) are taken for one."""


@dataclass(frozen=True, slots=True)
class IndexedPose:
    """A pose that is, or is taken for, an equilibrium: its angles, and the Hessian's number of negative eigenvalues."""

    th1: Any
    th2: Any
    index: int


class Degenerate(ArithmeticError):
    """Some equilibrium has a singular Hessian, or there are infinitely many."""


def in_balls(parameters: Mapping[str, arb], angles: Sequence[arb]) -> tuple[arb_mat, arb_mat]:
    """Gradient and Hessian at a pose, or over a box of angles."""
    (g1, g2), (h11, h12, h22) = derivatives(parameters, [(a.cos(), a.sin()) for a in angles], arb.sqrt)
    return arb_mat([[g1], [g2]]), arb_mat([[h11, h12], [h12, h22]])


def sign(value: arb) -> int:
    """The sign of a ball, 0 when it contains zero."""
    return int(value > 0) - int(value < 0)


def newton_pose(
    parameters: Mapping[str, Fraction], start: tuple[arb | float, arb | float], bits: int = BITS[0]
) -> IndexedPose | None:
    """The equilibrium that Newton's method finds from a start, proved by Krawczyk's test; None when it finds none.

    Parameters
    ----------
    start : th1, th2 in radians.
    bits : of precision; the pose is enclosed within 2^(-2/3 bits) of its angles.
    """
    with ctx.workprec(bits):
        p, radius = {name: ball_of(v) for name, v in parameters.items()}, arb(2) ** (-2 * bits // 3)
        middle = [arb(arb(a).mid()) for a in start]
        try:
            for _ in range(ROUNDS):
                gradient, hessian = in_balls(p, middle)
                step = (hessian.mid().inv() * gradient).entries()
                middle = [arb((a - s).mid()) for a, s in zip(middle, step, strict=True)]
                if all(abs(s) < radius for s in step):
                    break
            box = [a + radius * arb(0, 1) for a in middle]
            gradient, hessian = in_balls(p, middle)[0], in_balls(p, box)[1]
            inverse = hessian.mid().inv().mid()
        except ZeroDivisionError:  # a Hessian that is singular, or not finite
            return None
        at, rest = inverse * gradient, arb_mat(2, 2, 1) - inverse * hessian
        reaches = [abs(at[n, 0]) + (abs(rest[n, 0]) + abs(rest[n, 1])) * radius for n in (0, 1)]
        determinant, first = sign(hessian.det()), sign(hessian[0, 0])
        if not all(reach < radius for reach in reaches) or not determinant or (determinant > 0 and not first):
            return None
        return IndexedPose(box[0], box[1], 1 if determinant < 0 else 0 if first > 0 else 2)


def sextic_poses(parameters: Mapping[str, Fraction]) -> tuple[IndexedPose, ...]:
    """All equilibria of a mechanism whose springs have no free length.

    Raises
    ------
    Degenerate
        When some equilibrium is, or when N has no finite number of roots.
    """
    p = {name: from_fraction(v) for name, v in parameters.items()}
    for bits in BITS:
        with ctx.workprec(bits):
            candidates = _candidates(p)
        poses = [newton_pose(parameters, c, bits) if c else None for c in candidates]
        found = tuple(pose for pose in poses if pose is not None)
        if len(found) == len(poses):
            return found
    raise ArithmeticError(f"{BITS[-1]} bits do not settle the equilibria")


def _candidates(p: Mapping[str, fmpq]) -> list[tuple[arb, arb] | None]:
    """The angles that belong to the real roots of N, None where the precision is too low for a sign."""
    polynomial, v, w, square = (fmpq_poly(list(c)) for c in sextic(p))
    missing = 6 - polynomial.degree()
    # at th2 = pi, V = -F3 and W = F4
    flat = p["F3"] == 0 and p["F4"] == 0
    if missing not in ((0, 2) if flat else (0, 1)) or (missing == 1 and p["F3"] == 0):
        raise Degenerate("the sextic vanishes, or th2 = pi is a multiple solution")
    found = _angles(p, None, flat) if missing else []
    for factor, multiplicity in polynomial.numer().factor()[1]:
        v_zero, w_zero, square_zero = ((q % fmpq_poly(factor)).degree() < 0 for q in (v, w, square))
        both = v_zero and w_zero
        pairs: Any = factor.complex_roots()  # FLINT's stub says otherwise
        for root in (root.real for root, _ in pairs if root.imag == 0):
            if multiplicity != (2 if both else 1) or (both and square_zero):
                raise Degenerate("the sextic has a multiple root, or the first equation leaves th1 free")
            found += _angles(p, root, both)
    return found


def _angles(p: Mapping[str, fmpq], t: arb | None, both: bool) -> list[tuple[arb, arb] | None]:
    """th1 and th2 of a root (None for th2 = pi), with both signs of (cos th1, sin th1), or with that of V W."""
    c2, s2 = (arb(-1), arb(0)) if t is None else ((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t))
    v, w, x, y = parts({name: arb(value) for name, value in p.items()}, c2, s2)
    th2 = arb.pi() if t is None else 2 * t.atan()
    sides = (1, -1) if both else (sign(v * w),)
    return [(arb.atan2(arb((y * side).mid()), arb((x * side).mid())), th2) if side else None for side in sides]


# ---------------------------------------------------------------------------------------------------------- in doubles

Floats = NDArray[np.float64]


def in_doubles(parameters: Mapping[str, float], th1: Floats, th2: Floats) -> Derivatives:
    """The derivatives at many poses."""
    return derivatives(parameters, [(np.cos(a), np.sin(a)) for a in (th1, th2)], np.sqrt)


def angle_error(a: float, b: float) -> float:
    """The distance of two angles on the circle."""
    return abs((a - b + np.pi) % (2 * np.pi) - np.pi)


def different(poses: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The poses without those that are taken for one before them."""
    found: list[tuple[float, float]] = []
    for pose in poses:
        if all(max(map(angle_error, pose, other)) > SAME_POSE for other in found):
            found.append(pose)
    return found


def guesses(parameters: Mapping[str, float], starts: int) -> list[tuple[float, float]]:
    """Different poses to which Newton's method leads from a grid with so many starts along each angle."""
    grid = 2 * np.pi * (np.arange(starts) + 0.37) / starts - np.pi
    th1, th2 = (a.ravel() for a in np.meshgrid(grid, grid))
    with np.errstate(all="ignore"):
        for _ in range(ROUNDS):
            (g1, g2), (h11, h12, h22) = in_doubles(parameters, th1, th2)
            determinant = h11 * h22 - h12 * h12
            step1, step2 = (h22 * g1 - h12 * g2) / determinant, (h11 * g2 - h12 * g1) / determinant
            longest = np.maximum(1.0, 2 * np.hypot(step1, step2))  # steps of at most half a radian
            th1, th2 = th1 - step1 / longest, th2 - step2 / longest
        (g1, g2), _ = in_doubles(parameters, th1, th2)
        good = (np.hypot(g1, g2) <= RESIDUAL * scale(parameters)) & np.isfinite(th1) & np.isfinite(th2)
    turned = ((angles[good] + np.pi) % (2 * np.pi) - np.pi for angles in (th1, th2))
    return different(list(zip(*(angles.tolist() for angles in turned), strict=True)))


def scale(p: Mapping[str, float]) -> float:
    """The largest summand of the gradient: of a spring's or a load's moment about a joint."""
    mechanism = ptm()
    longest = max(p["L1"], p["L2"])
    span = max(p["rho"], longest, *(p.get(name, 0.0) for name in mechanism.free_lengths))
    loads = max(abs(p.get(name, 0.0)) for name in mechanism.forces)
    return max(max(p[name] for name in mechanism.stiffnesses) * span, loads) * longest


def double_poses(parameters: Mapping[str, Fraction]) -> tuple[IndexedPose, ...] | None:
    """The equilibria in double precision; None when numbers overflow or the eigenvalue method fails."""
    p = {name: float(value) for name, value in parameters.items()}
    with np.errstate(all="ignore"):
        free = any(p.get(name) for name in ptm().free_lengths)
        angles = guesses(p, STARTS) if free else _companion(p)
        return None if angles is None else tuple(_pose(p, *pair) for pair in angles)


def _pose(p: Mapping[str, float], th1: float, th2: float) -> IndexedPose:
    h11, h12, h22 = in_doubles(p, np.array(th1), np.array(th2)).hessian
    return IndexedPose(th1, th2, int((np.linalg.eigvalsh([[h11, h12], [h12, h22]]) < 0).sum()))


def _companion(p: Mapping[str, float]) -> list[tuple[float, float]] | None:
    """Different pairs of angles."""
    coefficients = np.array(sextic(p)[0][::-1])
    largest = float(np.max(np.abs(coefficients), initial=0.0))
    if not np.isfinite(largest) or largest == 0:
        return None
    leading = int(np.argmax(np.abs(coefficients) > ZERO_TOLERANCE * largest))
    try:
        roots = np.roots(coefficients[leading:])
    except np.linalg.LinAlgError:
        return None
    second = [2 * float(np.arctan(r.real)) for r in roots if abs(r.imag) <= REAL_TOLERANCE * (1 + abs(r))]
    return different([(th1, th2) for th2 in second + [float(np.pi)] * leading for th1 in _first_angles(p, th2)])


def _first_angles(p: Mapping[str, float], th2: float) -> list[float]:
    """The angles th1 that belong to th2: both where the mechanism is flat."""
    v, w, x, y = parts(p, np.cos(th2), np.sin(th2))
    a1, a2, *_ = parts(p, 0.0, 1.0)
    flat = abs(v) <= SAME_POSE * abs(a1) and abs(w) <= SAME_POSE * abs(a2)
    return [float(np.arctan2(sign * y, sign * x)) for sign in ((1.0, -1.0) if flat else (np.sign(v * w),))]
