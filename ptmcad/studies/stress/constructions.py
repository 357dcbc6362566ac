"""Parameters at which an equilibrium is known exactly to be degenerate, and which side of them has more equilibria.

Guarantee: exact. At the parameters of `fold` and `cusp` the given rational pose is an equilibrium with a singular
Hessian; the signs that distinguish the sides are computed in rational numbers.

Derivation. The potential is phi_1(th1) + phi_2(th2) + G cos(th1 + th2), with G = k3 L1 L2 and phi_i a sine wave. So at
an equilibrium, writing h_ij for the Hessian, c12 and s12 for cosine and sine of th1 + th2,

    h12 = -G c12,    U_111 = U_222 = 0,    U_112 = U_122 = G s12,
    U_1111 = -h11,   U_2222 = -h22,        every mixed fourth derivative is -h12.

*Fold.* With h11 h22 = h12^2, kernel v = (h12, -h11) and b = 3 G s12 v1 v2 (v1 + v2) not zero, a load that changes the
gradient along v by a has two more equilibria near by on the side where a b < 0 (saddle-node). They are a minimum and a
saddle if the other eigenvalue, whose sign is that of h11, is positive, and else a saddle and a maximum.

*Cusp.* With h11 = h12 = h22 = h the kernel is v = (1, -1) and b = 0. The fourth derivative along the centre manifold is
q = U(v, v, v, v) - 3 w.w / (2 h) with U(v, v, v, v) = 0 and w = -G s12 (1, 1), so q = -3 (G s12)^2 / h. Changing h22 by
d while the pose stays an equilibrium gives d s^2 / 2 + q s^4 / 24 along v: three equilibria where d q < 0, else one.

On the torus there are 4 or 6 equilibria in all (minima - saddles + maxima = 0), so the counts on both sides follow.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

Parameters = Mapping[str, Fraction]
Pose = tuple[Fraction, Fraction, Fraction, Fraction]
"""cos th1, sin th1, cos th2, sin th2."""


@dataclass(frozen=True, slots=True)
class Degenerate:
    """Parameters of a degenerate equilibrium.

    Attributes
    ----------
    many, few : (total, stable) on the two sides.
    side : sign of the change, along `beside_fold` or `beside_cusp`, that leads to ``many``.
    """

    parameters: Parameters
    pose: Pose
    many: tuple[int, int]
    few: tuple[int, int]
    side: int


def rational_pose(t1: Fraction, t2: Fraction) -> Pose:
    """The pose whose half angles have these tangents."""
    c1, s1 = (1 - t1 * t1) / (1 + t1 * t1), 2 * t1 / (1 + t1 * t1)
    c2, s2 = (1 - t2 * t2) / (1 + t2 * t2), 2 * t2 / (1 + t2 * t2)
    return c1, s1, c2, s2


def fold(lengths: tuple[Fraction, Fraction], rho: Fraction, springs: tuple[Fraction, ...], pose: Pose) -> Degenerate:
    """Loads under which a pose is an equilibrium on a fold; F3x is zero.

    Raises
    ------
    ValueError
        When the pose is on no fold: a cosine, h11 or the third derivative along the kernel is zero.
    """
    first, second = lengths
    _, k2, k3 = springs
    c1, s1, c2, s2 = pose
    c12, s12 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2
    a1 = (k2 + k3) * rho
    if c1 == 0 or c2 == 0:
        raise ValueError("no vertical load balances a vertical bar")
    h11, h12 = first * (a1 - k3 * second * c2) / c1, -k3 * first * second * c12
    if h11 == 0:
        raise ValueError("h11 is zero")
    a2 = k3 * first * c1 + c2 * h12 * h12 / (second * h11)
    third = 3 * k3 * first * second * s12 * h12 * -h11 * (h12 - h11)
    if third == 0:
        raise ValueError("the third derivative along the kernel is zero")
    # a larger F3 adds -L1 c1 to the first component of the gradient
    turn = -first * c1 * h12
    many, few = ((6, 2), (4, 1)) if h11 > 0 else ((6, 1), (4, 1))
    return Degenerate(_loaded(lengths, rho, springs, pose, a1, a2), pose, many, few, -1 if turn * third > 0 else 1)


def beside_fold(at: Degenerate, distance: Fraction) -> Parameters:
    """The parameters with F3 changed by so many times the force k2 rho; positive is towards more equilibria."""
    p = at.parameters
    return {**p, "F3": p["F3"] + at.side * distance * p["k2"] * p["rho"]}


def cusp(lengths: tuple[Fraction, Fraction], rho: Fraction, springs: tuple[Fraction, ...], pose: Pose) -> Degenerate:
    """Loads under which a pose is an equilibrium at a cusp of the folds.

    Raises
    ------
    ValueError
        When the pose is at no cusp: a cosine, or the cosine or sine of th1 + th2, is zero.
    """
    first, second = lengths
    c1, s1, c2, s2 = pose
    c12, s12 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2
    if 0 in (c1, c2, c12, s12):
        raise ValueError("a cosine or a sine is zero")
    k3 = springs[2]
    h = -k3 * first * second * c12
    a1, a2 = k3 * second * c2 + h * c1 / first, k3 * first * c1 + h * c2 / second
    many, few = ((6, 2), (4, 1)) if h > 0 else ((6, 1), (4, 1))
    return Degenerate(_loaded(lengths, rho, springs, pose, a1, a2), pose, many, few, 1 if h > 0 else -1)


def beside_cusp(at: Degenerate, distance: Fraction) -> Parameters:
    """The parameters with h22 changed by this much, relative to k3 L2^2, the pose being kept an equilibrium."""
    p = at.parameters
    _, _, c2, s2 = at.pose
    change = at.side * distance * p["k3"] * p["L2"]  # of h22 / L2
    # h22 / L2 = (a2 - k3 L1 c1) / c2 and F4 = (a2 s2 - k3 L1 s12) / c2
    shift = change * c2
    return {**p, "F4x": p["F4x"] - shift, "F4": p["F4"] + shift * s2 / c2}


def _loaded(
    lengths: tuple[Fraction, Fraction],
    rho: Fraction,
    springs: tuple[Fraction, ...],
    pose: Pose,
    a1: Fraction,
    a2: Fraction,
) -> Parameters:
    """The parameters for which (k2 + k3) rho + F3x = a1, (k1 + k3) rho - F4x = a2 and the pose is an equilibrium."""
    first, second = lengths
    k1, k2, k3 = springs
    c1, s1, c2, s2 = pose
    s12 = s1 * c2 + c1 * s2
    return {
        "L1": first,
        "L2": second,
        "rho": rho,
        "k1": k1,
        "k2": k2,
        "k3": k3,
        "F3": s1 * (a1 - k3 * second * c2) / c1 - k3 * second * s2,
        "F4": (a2 * s2 - k3 * first * s12) / c2,
        "F3x": a1 - (k2 + k3) * rho,
        "F4x": (k1 + k3) * rho - a2,
    }
