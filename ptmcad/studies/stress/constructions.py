"""Parameters at which an equilibrium is known exactly to be degenerate, and which side of them has more equilibria.

Guarantee: exact. At the parameters the given rational pose is an equilibrium with a singular Hessian; the signs that
distinguish the sides are computed in rational numbers.

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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

Parameters = Mapping[str, Fraction]
Pose = tuple[Fraction, Fraction, Fraction, Fraction]
"""cos th1, sin th1, cos th2, sin th2."""
FEW = (4, 1)
"""Equilibria and stable ones on the side that has fewer."""


@dataclass(frozen=True, slots=True)
class Degenerate:
    """Parameters of a degenerate equilibrium.

    Attributes
    ----------
    many : (total, stable) on the side that has more.
    side : sign of the change in `beside` that leads to ``many``.
    """

    parameters: Parameters
    pose: Pose
    cusp: bool
    many: tuple[int, int]
    side: int

    def beside(self, distance: Fraction) -> Parameters:
        """The parameters at a distance; positive is towards more equilibria.

        Of a fold F3 is changed by so many times the force k2 rho; of a cusp h22 by so many times k3 L2^2, while the
        pose is kept an equilibrium.
        """
        p, (_, _, c2, s2) = self.parameters, self.pose
        change = self.side * distance
        if not self.cusp:
            return {**p, "F3": p["F3"] + change * p["k2"] * p["rho"]}
        # h22 / L2 = (a2 - k3 L1 c1) / c2 and F4 = (a2 s2 - k3 L1 s12) / c2
        shift = change * p["k3"] * p["L2"] * c2
        return {**p, "F4x": p["F4x"] - shift, "F4": p["F4"] + shift * s2 / c2}


def degenerate(
    tangents: Sequence[Fraction],
    *,
    cusp: bool,
    lengths: Sequence[Fraction] = (Fraction(1), Fraction(3, 2)),
    rho: Fraction = Fraction(7, 10),
    springs: Sequence[Fraction] = (Fraction(100),) * 3,
) -> Degenerate:
    """Loads under which a pose, by its half angles' tangents, lies on a fold, with F3x zero, or at a cusp of the folds.

    Raises
    ------
    ValueError
        When there are none: a cosine, h11, h12 or the derivative that tells the sides is zero.
    """
    (first, second), (k1, k2, k3) = lengths, springs
    (c1, s1), (c2, s2) = (((1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)) for t in tangents)
    c12, s12 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2
    if c1 == 0 or c2 == 0:
        raise ValueError("no vertical load balances a vertical bar")
    h12 = -k3 * first * second * c12
    h11 = h12 if cusp else first * ((k2 + k3) * rho - k3 * second * c2) / c1
    if h11 == 0:
        raise ValueError("h11 is zero")
    third = -3 * k3 * first * second * s12 * h12 * h11 * (h12 - h11)
    if s12 == 0 or (third == 0 and not cusp):
        raise ValueError("the derivative along the kernel is zero")
    # a larger F3 adds -L1 c1 to the first component of the gradient
    towards = h11 if cusp else first * c1 * h12 * third
    # (k2 + k3) rho + F3x = a1 and (k1 + k3) rho - F4x = a2
    a1, a2 = k3 * second * c2 + h11 * c1 / first, k3 * first * c1 + h12 * h12 / h11 * c2 / second
    parameters = {
        **dict(zip(("L1", "L2", "rho", "k1", "k2", "k3"), (first, second, rho, *springs), strict=True)),
        "F3": s1 * (a1 - k3 * second * c2) / c1 - k3 * second * s2,
        "F4": (a2 * s2 - k3 * first * s12) / c2,
        "F3x": a1 - (k2 + k3) * rho,
        "F4x": (k1 + k3) * rho - a2,
    }
    return Degenerate(parameters, (c1, s1, c2, s2), cusp, (6, 2) if h11 > 0 else (6, 1), 1 if towards > 0 else -1)


NAMED = {
    name: degenerate([Fraction(t) for t in tangents], cusp="cusp" in name)
    for name, tangents in {
        "fold": ("1/3", "2/5"), "other fold": ("3/2", "1/5"), "fold of maxima": ("-2", "3"),
        "cusp": ("1/2", "3/7"), "cusp of maxima": ("1/3", "2/5"),
    }.items()
}  # fmt: skip
"""Those that the named cases lie beside."""
