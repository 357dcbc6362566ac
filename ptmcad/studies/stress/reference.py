"""The equilibria at a point to a hundred digits, by methods that share nothing with `ptmcad.solve` but FLINT's numbers.

Guarantee: every pose is proved to be an equilibrium, and lies in the balls that are given. For springs without free
length all equilibria are there; with free lengths those to which some start leads.

Without free lengths: the real roots of the sextic (`ptmcad.studies.sextic`) are isolated with proof; th2 = pi counts as
a root for each degree that is missing. Where V and W vanish both signs hold, elsewhere that of V W. Nothing is lost, as
multiplicities are compared. With free lengths no more is known than where to start. From either
`ptmcad.studies.equilibria.newton_pose` goes on.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from flint import arb, ctx, fmpq, fmpq_poly

from ptmcad.studies.equilibria import IndexedPose, newton_pose, sign
from ptmcad.studies.sextic import parts, sextic
from ptmcad.text.flint_numbers import from_fraction

BITS = (600, 2400, 9600)
"""Of precision, tried in turn."""


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
    if missing > 6:
        raise Degenerate("the sextic vanishes")
    # at th2 = pi, V = -F3 and W = F4
    flat = p["F3"] == 0 and p["F4"] == 0
    if missing not in ((0, 2) if flat else (0, 1)) or (missing == 1 and p["F3"] == 0):
        raise Degenerate("th2 = pi is a multiple solution")
    found = _angles(p, None, flat) if missing else []
    for factor, multiplicity in polynomial.numer().factor()[1]:
        v_zero, w_zero, square_zero = ((q % fmpq_poly(factor)).degree() < 0 for q in (v, w, square))
        both = v_zero and w_zero
        pairs: Any = factor.complex_roots()  # FLINT's stub says otherwise
        for root in (root.real for root, _ in pairs if root.imag == 0):
            if multiplicity != (2 if both else 1):
                raise Degenerate("the sextic has a multiple root")
            if both and square_zero:
                raise Degenerate("the first equation leaves th1 free")
            found += _angles(p, root, both)
    return found


def _angles(p: Mapping[str, fmpq], t: arb | None, both: bool) -> list[tuple[arb, arb] | None]:
    """th1 and th2 of a root (None for th2 = pi), with both signs of (cos th1, sin th1), or with that of V W."""
    c2, s2 = (arb(-1), arb(0)) if t is None else ((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t))
    v, w, x, y = parts({name: arb(value) for name, value in p.items()}, c2, s2)
    th2 = arb.pi() if t is None else 2 * t.atan()
    sides = (1, -1) if both else (sign(v * w),)
    return [(arb.atan2(arb((y * side).mid()), arb((x * side).mid())), th2) if side else None for side in sides]
