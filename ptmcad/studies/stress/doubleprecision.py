"""The equilibria at a point: to a hundred digits with proof, and in double precision as they are
computed in practice.

Neither shares anything with `ptmcad.solve` but FLINT's numbers; both begin with the sextic in
t = tan(th2/2) (`ptmcad.studies.byhand`) where no spring has a free length.

Guarantee of `newton_pose`: a pose that it gives is the only zero of the gradient
(`ptmcad.studies.byhand`) in its box, with a nonsingular Hessian.

Guarantee of `sextic_poses`: all equilibria are there, each proved and in the balls that are given.
The real roots are isolated with proof; th2 = pi counts as a root for each degree that is missing.
No more equilibria than its multiplicity belong to a root, and as many are proved as all roots have
together.

`double_poses` guarantees nothing; it is the baseline that can be wrong (`ptmcad.studies.byhand`):
companion matrices without free lengths, and Newton's method from a grid of starts with them.

References: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations
(1990), theorem 5.1.8; Rump, Acta Numerica 19 (2010), section 13.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx, fmpq, fmpq_poly

from ptmcad.studies import byhand
from ptmcad.studies.byhand import derivatives, parts, sextic
from ptmcad.studies.stress.case import Parameters, free_lengths
from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction

BITS = (600, 2400, 9600)
"""Of precision, tried in turn."""
STARTS = 24
"""Starts of Newton's method along each angle."""
ROUNDS = 60
"""Of Newton's method."""


IndexedPose = tuple[Any, Any, int]
"""The angles of a pose that is, or is taken for, an equilibrium, and the Hessian's number of
negative eigenvalues.
"""


def in_balls(parameters: Mapping[str, arb], angles: Sequence[arb]) -> tuple[arb_mat, arb_mat]:
    """Gradient and Hessian at a pose, or over a box of angles."""
    (g1, g2), (h11, h12, h22) = derivatives(
        parameters, [(a.cos(), a.sin()) for a in angles], arb.sqrt
    )
    return arb_mat([[g1], [g2]]), arb_mat([[h11, h12], [h12, h22]])


def newton_pose(
    parameters: Parameters, start: tuple[arb | float, arb | float], bits: int = BITS[0]
) -> IndexedPose | None:
    """The equilibrium that Newton's method finds from a start, proved by Krawczyk's test; None when
    it finds none.

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
        around = arb_mat([[radius * arb(0, 1)]] * 2)
        determinant, first = hessian.det(), hessian[0, 0]
        undecided = not determinant < 0 and not (determinant > 0 and not first.contains(0))
        if undecided or not all(abs(x) < radius for x in (rest * around - at).entries()):
            return None
        return box[0], box[1], 1 if determinant < 0 else 0 if first > 0 else 2


def apart(first: IndexedPose, second: IndexedPose) -> arb:
    """The larger of the distances of both angles, on the circle."""
    gaps = [arb(a) - b for a, b in zip(first[:2], second[:2], strict=True)]
    turn = 2 * arb.pi()
    one, other = (abs(gap - turn * (gap / turn + 0.5).mid().floor()) for gap in gaps)
    return arb(one.max(other))


def proved_poses(
    parameters: Parameters,
    starts: Iterable[tuple[Any, Any]],
    bits: int = BITS[0],
    most: float = np.inf,
) -> tuple[IndexedPose, ...]:
    """The different equilibria that Newton's method finds from starts, each proved; not more than
    are asked for.
    """
    known: list[IndexedPose] = []
    for start in starts:
        pose = newton_pose(parameters, start, bits) if len(known) < most else None
        if pose is not None and not any(apart(pose, other).contains(0) for other in known):
            known.append(pose)
    return tuple(known)


def sextic_poses(parameters: Parameters) -> tuple[IndexedPose, ...]:
    """All equilibria of a mechanism whose springs have no free length.

    Raises
    ------
    ArithmeticError
        When some equilibrium is degenerate, when N has no finite number of roots, or when the bits
        do not settle it.
    """
    p = {name: from_fraction(v) for name, v in parameters.items()}
    polynomial = fmpq_poly(list(sextic(p)[0]))
    missing = 6 - polynomial.degree()
    for bits in BITS if polynomial else ():
        with ctx.workprec(bits):
            factors: Any = polynomial.numer().factor()[1]
            real = [
                (root.real, multiplicity)
                for factor, multiplicity in factors
                for root, _ in factor.complex_roots()
                if root.imag == 0
            ]
            seconds = [2 * t.atan() for t, _ in real] + [arb.pi()] * (missing > 0)
            number = sum(multiplicity for _, multiplicity in real) + missing
            starts = [_start(p, th2, side) for side in (1, -1) for th2 in seconds]
            found = proved_poses(parameters, starts, bits, number)
        if len(found) == number:
            return found
    raise ArithmeticError("the sextic vanishes, or has a multiple root that is not two equilibria")


def _start(p: Mapping[str, fmpq], th2: arb, side: int) -> tuple[arb, arb]:
    """A pose at which the first equation holds: th1 along (X, Y) times the sign of V W, for side -1
    against it.
    """
    v, w, x, y = (
        arb(e.mid())
        for e in parts({name: arb(value) for name, value in p.items()}, th2.cos(), th2.sin())
    )
    side = -side if v * w < 0 else side
    return arb.atan2(y * side, x * side), th2


def double_poses(parameters: Parameters) -> tuple[IndexedPose, ...] | None:
    """The equilibria in double precision; None when numbers overflow or the eigenvalue method
    fails.
    """
    p = {name: np.array([float(value)]) for name, value in parameters.items()}
    try:
        with np.errstate(all="ignore"):
            th1, th2 = byhand.newton(p, STARTS) if free_lengths(parameters) else byhand.companion(p)
            kept = byhand.distinct(th1, th2)
            h11, h12, h22 = byhand.at(p, th1[kept], th2[kept])[1]
            eigenvalues = np.linalg.eigvalsh(np.array([[h11, h12], [h12, h22]]).transpose(2, 0, 1))
    except np.linalg.LinAlgError:
        return None
    indices = (eigenvalues < 0).sum(axis=1)
    return tuple(zip(*(values.tolist() for values in (th1[kept], th2[kept], indices)), strict=True))
