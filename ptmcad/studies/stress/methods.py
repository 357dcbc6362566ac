"""The equilibria at a point: to a hundred digits with proof, and in double precision as they are computed in practice.

Neither shares anything with `ptmcad.solve` but FLINT's numbers; both begin with the sextic in t = tan(th2/2)
(`ptmcad.studies.sextic`) where no spring has a free length.

Guarantee of `sextic_poses`: all equilibria are there, each proved and in the balls that are given. The real roots are
isolated with proof; th2 = pi counts as a root for each degree that is missing. Where V and W vanish both signs hold,
elsewhere that of V W. Nothing is lost, as multiplicities are compared. From there
`ptmcad.studies.equilibria.newton_pose` goes on.

`double_poses` guarantees nothing; it is the baseline that can be wrong. Without free lengths: eigenvalues of the
companion matrix, th1 from the first equation, the Hessian's signs in floats. It is treated kindly: th2 = pi, which t
cannot reach, is put back where the leading coefficients vanish. With free lengths: Newton's method from a grid of
starts. Deciding which roots are real, which are one, and what is zero takes tolerances; they are usual ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq, fmpq_poly

from ptmcad.mechanism import ptm
from ptmcad.studies.equilibria import SAME_POSE, IndexedPose, different, guesses, in_doubles, newton_pose, sign
from ptmcad.studies.sextic import parts, sextic
from ptmcad.text.flint_numbers import from_fraction

BITS = (600, 2400, 9600)
"""Of precision, tried in turn."""
REAL_TOLERANCE = 1e-8
"""A root is taken for real when its imaginary part is at most this much of 1 + its modulus."""
ZERO_TOLERANCE = 1e-12
"""A coefficient is taken for zero when it is at most this much of the largest."""
STARTS = 24
"""Starts of Newton's method along each angle."""


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
