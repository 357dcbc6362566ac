"""The energy's derivatives in balls of Arb, for springs with free lengths: written down once more, with square roots.

Guarantee: every ball contains the exact value at each configuration and for all parameters in the balls given; where a
spring may have length zero, its direction is any unit vector and nothing is claimed of second derivatives.

A *crease* is a circle of configurations in which a spring with a free length has no length: th2 = 0 where rho = L2,
th1 = 0 where rho = L1, th1 + th2 = pi where rho = 0 and L1 = L2. The energy is smooth on either side of it and can be
continued across it from each side, but the two continuations differ. `Energy.one_sided` gives them.

With q_i the square of a spring's length l_i, m_i = k_i - k_i l0_i / l_i and the loads F:

    q1 = (rho - L2)^2 + 4 rho L2 sin^2(th2/2),    q2 = (rho - L1)^2 + 4 rho L1 sin^2(th1/2),
    q3 = x^2 + y^2,   x = rho - L1 c1 - L2 c2,   y = L2 s2 - L1 s1,
    a = (dq3/dth1)/(2 L1) = rho s1 - L2 s12,      b = (dq3/dth2)/(2 L2) = rho s2 - L1 s12,
    e1 = (dU/dth1)/L1 = m2 rho s1 + m3 a - F3 c1 + F3x s1,   e2 = (dU/dth2)/L2 = m1 rho s2 + m3 b - F4 c2 - F4x s2.

The second engine has unit vectors instead of the roots, and differentiates a graph of formulas.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

from flint import arb

from ptmcad.verification.derivation import MECHANISM

NAMES = MECHANISM.variables
Pair = tuple[arb, arb]
Sides = tuple[int, int, int]
"""For each spring the side of its crease: 1 or -1, or 0 for the side that the balls are on."""
_ANY = arb(0, 1)


@dataclass(frozen=True, slots=True)
class Derivatives:
    """First derivatives e1, e2 as above, and e11 = de1/dth1, e12 = de1/dth2, e21 = de2/dth1, e22 = de2/dth2.

    Attributes
    ----------
    short : the number (1, 2, 3) of a spring that may have length zero, else 0; then second derivatives are meaningless.
    rest : e1 and e2 without the free length of spring 3, when spring 3 may have length zero.
    bare : e2 or e1 without the free length of spring 1 or 2, when ``short`` is its number.
    """

    e1: arb
    e2: arb
    e11: arb
    e12: arb
    e21: arb
    e22: arb
    short: int
    rest: Pair | None = None
    bare: arb | None = None


class Energy:
    """The derivatives as functions of two angles.

    Parameters
    ----------
    values : a ball for each of `NAMES`; lengths and stiffnesses positive, free lengths not negative.
    crease1, crease2 : whether rho = L2, rho = L1 hold exactly; spring 1, 2 then has length zero at th2 = 0, th1 = 0.
    crease3 : whether rho = 0 and L1 = L2 hold exactly; spring 3 then has length zero at th1 + th2 = pi.
    sides : the sides of the creases whose formulas are continued across them.
    """

    def __init__(
        self,
        values: Mapping[str, arb],
        crease1: bool = False,
        crease2: bool = False,
        crease3: bool = False,
        sides: Sides = (0, 0, 0),
    ):
        self.values = dict(values)
        self.length1, self.length2, self.rho = values["L1"], values["L2"], values["rho"]
        self.k1, self.k2, self.k3 = values["k1"], values["k2"], values["k3"]
        self.p1, self.p2, self.p3 = (values[f"k{i}"] * values[f"l0_{i}"] for i in (1, 2, 3))
        self.f3, self.f4, self.f3x, self.f4x = values["F3"], values["F4"], values["F3x"], values["F4x"]
        self.crease1, self.crease2, self.crease3, self.sides = crease1, crease2, crease3, sides
        zero = arb(0) if crease1 else self.rho - self.length2
        self.gap1 = zero * zero
        zero = arb(0) if crease2 else self.rho - self.length1
        self.gap2 = zero * zero
        self.product1, self.product2 = 4 * self.rho * self.length2, 4 * self.rho * self.length1
        # a ball that is not exactly zero: != would ask for one without zero
        self.free1, self.free2, self.free3 = (not (p == 0) for p in (self.p1, self.p2, self.p3))  # noqa: SIM201

    def __call__(self, th1: arb, th2: arb) -> Derivatives:
        """At all configurations in two balls."""
        rho, length1, length2, k3 = self.rho, self.length1, self.length2, self.k3
        s1, c1 = th1.sin_cos()
        s2, c2 = th2.sin_cos()
        s12, c12 = (th1 + th2).sin_cos()
        rs1, rs2, rc1, rc2 = rho * s1, rho * s2, rho * c1, rho * c2
        a, b = rs1 - length2 * s12, rs2 - length1 * s12
        ac, bc = rc1 - length2 * c12, rc2 - length1 * c12
        k3c12 = k3 * c12
        e1 = self.k2 * rs1 + k3 * a - self.f3 * c1 + self.f3x * s1
        e2 = self.k1 * rs2 + k3 * b - self.f4 * c2 - self.f4x * s2
        e11 = self.k2 * rc1 + k3 * ac + self.f3 * s1 + self.f3x * c1
        e22 = self.k1 * rc2 + k3 * bc + self.f4 * s2 - self.f4x * c2
        e12, e21 = -(length2 * k3c12), -(length1 * k3c12)
        short = 0
        if self.free2:
            slope, bend = self._turning(th1, rs1, rc1, length1, self.gap2, self.product2, self.crease2, self.sides[1])
            if bend is None:
                short = 2
            else:
                e1 -= self.p2 * slope
                e11 -= self.p2 * bend
        if self.free1:
            slope, bend = self._turning(th2, rs2, rc2, length2, self.gap1, self.product1, self.crease1, self.sides[0])
            if bend is None:
                e1 -= self.p2 * (_ANY if short == 2 else 0)
                short = 1
            else:
                e2 -= self.p1 * slope
                e22 -= self.p1 * bend
        if not self.free3:
            return self._finished(e1, e2, e11, e12, e21, e22, short)
        if self.crease3:
            # l3 = 2 L |cos((th1 + th2)/2)|, L = L1 = L2
            s, c = ((th1 + th2) / 2).sin_cos()
            side = _side(c, self.sides[2])
            if side:
                slope, bend = self.p3 * side * s, self.p3 * side * c / 2
                return self._finished(e1 + slope, e2 + slope, e11 + bend, e12 + bend, e21 + bend, e22 + bend, short)
        x, y = rho - length1 * c1 - length2 * c2, length2 * s2 - length1 * s1
        q3 = x * x + y * y
        if not q3 > 0:
            if short:
                d = self._finished(e1, e2, e11, e12, e21, e22, short)
                e1, e2 = d.e1, d.e2
            pull = self.p3 * _ANY
            return Derivatives(e1 - pull, e2 - pull, e11, e12, e21, e22, short or 3, (e1, e2))
        inverse = q3.rsqrt()
        u, v = unit(a * inverse), unit(b * inverse)
        pull = self.p3 * inverse
        e1 -= self.p3 * u
        e2 -= self.p3 * v
        mixed = c12 + u * v
        e11 -= pull * (ac - length1 * (u * u))
        e22 -= pull * (bc - length2 * (v * v))
        e12 += length2 * (pull * mixed)
        e21 += length1 * (pull * mixed)
        return self._finished(e1, e2, e11, e12, e21, e22, short)

    def _finished(self, e1: arb, e2: arb, e11: arb, e12: arb, e21: arb, e22: arb, short: int) -> Derivatives:
        """With any pull of a spring that may have length zero."""
        if short == 1:
            return Derivatives(e1, e2 - self.p1 * _ANY, e11, e12, e21, e22, short, None, e2)
        if short == 2:
            return Derivatives(e1 - self.p2 * _ANY, e2, e11, e12, e21, e22, short, None, e1)
        return Derivatives(e1, e2, e11, e12, e21, e22, short)

    def _turning(
        self, angle: arb, rs: arb, rc: arb, bar: arb, gap: arb, product: arb, crease: bool, given: int
    ) -> tuple[arb, arb | None]:
        """(dl/dth)/L and its derivative for the spring between a fixed point and the end of one bar of length L.

        On a crease l = 2 L |sin(th/2)|, of one sign on a side; these formulas are used on the side that is given, or
        that the angle's ball is on.
        """
        half = angle / 2
        s, c = half.sin_cos()
        if crease:
            side = _side(s, given)
            return (side * c, -side * s / 2) if side else (_ANY, None)
        q = gap + product * (s * s)
        if q > 0:
            inverse = q.rsqrt()
            slope = unit(rs * inverse)
            return slope, inverse * (rc - bar * (slope * slope))
        return _ANY, None

    @property
    def creased(self) -> bool:
        """Whether a spring with a free length has no length on a circle."""
        return (self.crease1 and self.free1) or (self.crease2 and self.free2) or (self.crease3 and self.free3)

    def one_sided(self, th1: arb, th2: arb) -> list[Energy]:
        """The energies that are continued across the creases that the balls meet, from either side; else nothing.

        A smooth equilibrium in the balls is one of at least one of them. The converse does not hold: a continuation may
        have a zero on the other side of its crease, or on it.
        """
        if not self.creased:
            return []
        choices = [
            (1, -1) if crease and free and value.contains(0) else (0,)
            for crease, free, value in (
                (self.crease1, self.free1, (th2 / 2).sin()),
                (self.crease2, self.free2, (th1 / 2).sin()),
                (self.crease3, self.free3, ((th1 + th2) / 2).cos()),
            )
        ]
        ways = list(itertools.product(*choices))
        if len(ways) == 1:
            return []
        creases = self.crease1, self.crease2, self.crease3
        return [Energy(self.values, *creases, (one, two, three)) for one, two, three in ways]

    def cone(self, th1: arb, th2: arb) -> arb:
        """w1^2 + w2^2 + 2 w1 w2 c12 - (p3 s12)^2, zero at an equilibrium, whatever the direction of spring 3.

        With w1, w2 what e1, e2 are without the free length of spring 3, an equilibrium demands w_i = p3 t_i . u for a
        unit vector u, with t1 . t2 = -c12; eliminating u: w1^2 + w2^2 + 2 w1 w2 c12 = p3^2 s12^2. Where l3 = 0, the
        cone outweighs the slope of the rest when this is negative.
        """
        derivatives = _without_third(self)(th1, th2)
        w1, w2 = derivatives.e1, derivatives.e2
        s12, c12 = (th1 + th2).sin_cos()
        one = w1 + c12 * w2
        return one * one + s12 * s12 * (w2 * w2 - self.p3 * self.p3)

    def lengths_squared(self, th1: arb, th2: arb) -> tuple[arb, arb, arb]:
        """q1, q2, q3."""
        s1, c1 = th1.sin_cos()
        s2, c2 = th2.sin_cos()
        h1, h2 = (th1 / 2).sin(), (th2 / 2).sin()
        x = self.rho - self.length1 * c1 - self.length2 * c2
        y = self.length2 * s2 - self.length1 * s1
        return self.gap1 + self.product1 * h2 * h2, self.gap2 + self.product2 * h1 * h1, x * x + y * y

    def peaks(self, th1: arb, th2: arb, d: Derivatives) -> bool:
        """Whether no equilibrium in the balls is a minimum, because spring 1 or 2, being short, bends the energy down.

        An equilibrium has slope w = S/p1 of spring 1, S being e2 without its free length; p1 adds
        -p1 (rho c2 - L2 w^2)/l1 to e22, where l1 may be zero but has an upper bound.
        """
        if d.bare is None:
            return False
        first = d.short == 1
        angle, pull, bar = (th2, self.p1, self.length2) if first else (th1, self.p2, self.length1)
        q1, q2, _ = self.lengths_squared(th1, th2)
        longest = (q1 if first else q2).abs_upper().sqrt()
        slope = d.bare / pull
        bend = self.rho * angle.cos() - bar * (slope * slope)
        return bool(bend > 0 and (d.e22 if first else d.e11) - pull * bend / longest < 0)

    def bends_down(self, th1: arb, th2: arb, d: Derivatives) -> bool:
        """Whether the Hessian has a negative eigenvalue wherever l3 is not zero in balls in which it may be.

        With G = J^T J, J being the derivative of A4 - A3 by the angles, tr(adj(G) Hess) of -p3 l3 is -p3 det G / l3 but
        for a part of at most p3 L1^2 L2^2 (1/L1 + 1/L2); adj(G) is positive semidefinite, so a negative trace decides.
        All is divided by L1 L2; d.e11 ... are those without the free length of spring 3.
        """
        s12, c12 = (th1 + th2).sin_cos()
        l1, l2 = self.length1, self.length2
        _, _, q3 = self.lengths_squared(th1, th2)
        longest = q3.abs_upper().sqrt()
        # trace of Gram^-1 H, times L1 L2 s12^2
        trace = l2 * d.e11 + l1 * d.e22 + c12 * (l2 * d.e21 + l1 * d.e12)
        turned = self.p3 * (l1 + l2)
        return bool(trace + turned - self.p3 * l1 * l2 * (s12 * s12) / longest < 0)


def _side(value: arb, given: int) -> int:
    """The sign of what is zero on a crease: the one that is given, or the one it surely has; else 0."""
    return given or int(value > 0) - int(value < 0)


def unit(value: arb) -> arb:
    """A ball for a number that is known to lie from -1 to 1, given one ball for it."""
    return value if value.rad() < 1 else _ANY


def _without_third(energy: Energy) -> Energy:
    values = dict(energy.values)
    values["l0_3"] = arb(0)
    return Energy(values, energy.crease1, energy.crease2, energy.crease3, energy.sides)
