"""The paper's mechanism with springs of any free length: equilibrium, Hessian and what decides stability, as formulas.

Guarantee: derivatives are those of the potential; no term is typed in twice. A load, a horizontal load or a free length
that is zero leaves no trace in the formulas.

With d1 = A4 - A1, d2 = A3 - A2, d3 = A4 - A3 (d1 = (rho - L2 c2, L2 s2), d2 = -(rho - L1 c1, -L1 s1) up to sign, which
does not matter), l_i = |d_i| and u_i = d_i / l_i, the potential is the sum of k_i (l_i - l0_i)^2 / 2 minus the loads'
work. Everything is divided by k, an arbitrary positive unit of stiffness; E1 = (1/L1) dU/dth1 and E2 = (1/L2) dU/dth2
are polynomials in L1, L2, also where a length is zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.certified.formula import Formula, Graph, direction, inverse_length, length, meet
from ptmcad.mechanism import ptm

NAMES = ptm().variables
Vector = tuple[Formula, Formula]


def dot(p: Vector, q: Vector) -> Formula:
    return p[0] * q[0] + p[1] * q[1]


def cross(p: Vector, q: Vector) -> Formula:
    return p[0] * q[1] - p[1] * q[0]


@dataclass(frozen=True, slots=True)
class Hessian:
    """The Hessian H of U, scaled: P11 = H11/L1, P22 = H22/L2, q = H12/(L1 L2).

    D = P11 P22 - L1 L2 q^2 = det H/(L1 L2).
    """

    p11: Formula
    p22: Formula
    q: Formula
    determinant: Formula
    determinant_times_l3: Formula
    """l3 D: finite also where spring 3 has no length."""
    levelled: Formula
    """l1 l2 l3 D: finite everywhere."""


@dataclass(frozen=True, slots=True)
class Mechanism:
    """Formulas at a configuration (th1, th2).

    Attributes
    ----------
    equilibrium : E1, E2.
    hessian : formulas of the Hessian everywhere.
    at_equilibrium : formulas of the same numbers that hold, and are finite for shorter springs, only where E1 = E2 = 0;
        never to be differentiated.
    dependent : further formulas that vanish where E1 = E2 = 0: L1 E1 - L2 E2, the moment on both bars turned by one
        angle, which stays narrow for small rho; one that stays narrow where spring 3 is short; and with phi also
        d3 - l3 (cos phi, sin phi).
    unit : vanishes where E1 = E2 = 0, without the direction of spring 3; at l3 = 0 it vanishes where the cone swallows
        an equilibrium. None when spring 3 has no free length.
    lengths : l1, l2, l3.
    vectors : d1, d2, d3.
    free : the free lengths.
    """

    equilibrium: tuple[Formula, Formula]
    hessian: Hessian
    at_equilibrium: Hessian
    dependent: tuple[Formula, ...]
    unit: Formula | None
    lengths: tuple[Formula, Formula, Formula]
    vectors: tuple[Vector, Vector, Vector]
    free: tuple[Formula, Formula, Formula]
    residual: tuple[Formula, Formula]
    """E1 and E2 without the pull of spring 3's free length: E1 + k3 l0_3 u3.t1, E2 + k3 l0_3 u3.t2."""
    tangents: tuple[Vector, Vector]
    aligned: Formula | None
    """d3 x u, with u = (cos phi, sin phi); None without phi."""
    turn: Formula
    """The second derivative of U when both bars turn by the same angle, H11 - 2 H12 + H22; narrow for small rho."""
    turned: Formula
    """L2 D from the entries of H for the first bar alone and for both bars; holds where E1 = E2 = 0.

    Without loads, on a positive base, ``turn`` and ``turned`` have no factor rho.
    """
    unloaded: tuple[Formula, Formula] | None
    """Without loads, and with a base that is certainly positive: what L1 E1 - L2 E2 and L2 D are multiples of by rho.

    They may replace E2 and D: for small rho, where the whole mechanism hardly resists turning, they stay definite.
    """


def mechanism(
    graph: Graph,
    values: Mapping[str, Formula],
    th1: Formula,
    th2: Formula,
    phi: Formula | None = None,
    creases: tuple[bool, bool] = (False, False),
    positive_base: bool = False,
) -> Mechanism:
    """The mechanism with parameters ``values`` (all of `NAMES`, stiffness and loads in one unit of stiffness).

    With ``phi`` the direction of spring 3 is a variable of its own, u3 = (cos phi, sin phi) and l3 = d3.u3, which makes
    every formula but 1/l3 smooth at l3 = 0; they mean the mechanism where `Mechanism.aligned` vanishes and l3 >= 0.

    ``positive_base`` says that rho is zero nowhere in the open window.

    ``creases`` shows whether rho = L2, so that d1 = 2 L2 sin(th2/2) (sin(th2/2), cos(th2/2)), and whether rho = L1, so
    that d2 = 2 L1 sin(th1/2) (sin(th1/2), -cos(th1/2)). The formulas then hold for 0 < th2 < 2 pi, or 0 < th1 < 2 pi.
    """
    p1, p2, rho = values["L1"], values["L2"], values["rho"]
    k1, k2, k3 = values["k1"], values["k2"], values["k3"]
    f1, f2, f3 = values["l0_1"], values["l0_2"], values["l0_3"]
    y3, y4, x3, x4 = values["F3"], values["F4"], values["F3x"], values["F4x"]
    s1, c1, s2, c2 = th1.sin(), th1.cos(), th2.sin(), th2.cos()
    s12, c12 = (th1 + th2).sin(), (th1 + th2).cos()
    d1 = (rho - p2 * c2, p2 * s2)
    d2 = (rho - p1 * c1, -(p1 * s1))
    d3 = (rho - p1 * c1 - p2 * c2, p2 * s2 - p1 * s1)
    u1, u2, u3 = ((direction(x, y), direction(y, x)) for x, y in (d1, d2, d3))
    r1, r2, r3 = (inverse_length(x, y) for x, y in (d1, d2, d3))
    l1, l2, l3 = (length(x, y) for x, y in (d1, d2, d3))
    if phi is not None:
        u3 = phi.cos(), phi.sin()
        l3 = dot(d3, u3)
    if creases[0]:
        half = th2 * Fraction(1, 2)
        u1, l1 = (half.sin(), half.cos()), 2 * p2 * half.sin()
        r1 = 1 / l1
    if creases[1]:
        half = th1 * Fraction(1, 2)
        u2, l2 = (half.sin(), -half.cos()), 2 * p1 * half.sin()
        r2 = 1 / l2
    # tangents: d(d2)/dth1 = d(d3)/dth1 = L1 t1, d(d1)/dth2 = d(d3)/dth2 = L2 t2; normals: dt1/dth1, dt2/dth2
    t1, t2 = (s1, -c1), (s2, c2)
    n1, n2 = (c1, s1), (c2, -s2)
    along21, along31, along12, along32 = dot(u2, t1), dot(u3, t1), dot(u1, t2), dot(u3, t2)
    # without free lengths: quadratic springs and loads; A3 = L1 (c1, s1), A4 = (rho - L2 c2, L2 s2)
    linear1 = k2 * (rho * s1) + k3 * (rho * s1 - p2 * s12) + x3 * s1 - y3 * c1
    linear2 = k1 * (rho * s2) + k3 * (rho * s2 - p1 * s12) - x4 * s2 - y4 * c2
    pull1, pull2, pull3 = k1 * f1, k2 * f2, k3 * f3
    residual1, residual2 = linear1 - pull2 * along21, linear2 - pull1 * along12
    e1, e2 = residual1 - pull3 * along31, residual2 - pull3 * along32
    across31, across32 = cross(u3, t1), cross(u3, t2)

    def hessian(q21: Formula, q31: Formula, q12: Formula, q32: Formula, q33: Formula) -> Hessian:
        """From the squared sines of the angles between springs and tangents; spring 3 enters D to the first power.

        ``q33`` is the product of the two sines of spring 3.
        """
        bend1 = (
            k2 * (rho * c1) + k3 * (rho * c1 - p2 * c12) + x3 * c1 + y3 * s1
            - pull2 * dot(u2, n1) - pull3 * dot(u3, n1)
        )  # fmt: skip
        bend2 = (
            k1 * (rho * c2) + k3 * (rho * c2 - p1 * c12) - x4 * c2 + y4 * s2
            - pull1 * dot(u1, n2) - pull3 * dot(u3, n2)
        )  # fmt: skip
        sway1, sway2 = p1 * (pull2 * q21), p2 * (pull1 * q12)
        rigid1, rigid2 = bend1 - r2 * sway1, bend2 - r1 * sway2
        tilt = pull3 * r3
        mixed = -(k3 * c12)
        q = mixed - tilt * q33

        def determinant(a: Formula, b: Formula, c: Formula, row1: Formula, row2: Formula, pull: Formula) -> Formula:
            """a b c D from a rigid1, b rigid2 and c tilt."""
            both = p1 * p2 * (a * b)
            return c * (row1 * row2 - both * mixed.squared()) - pull * (
                p1 * (q31 * (a * row2)) + p2 * (q32 * (b * row1)) - 2 * (both * (mixed * q33))
            )

        one = graph.constant(1)
        return Hessian(
            rigid1 - p1 * (tilt * q31),
            rigid2 - p2 * (tilt * q32),
            q,
            determinant(one, one, one, rigid1, rigid2, tilt),
            determinant(one, one, l3, rigid1, rigid2, pull3),
            determinant(l2, l1, l3, l2 * bend1 - sway1, l1 * bend2 - sway2, pull3),
        )

    everywhere = hessian(
        cross(u2, t1).squared(), across31.squared(), cross(u1, t2).squared(), across32.squared(), across31 * across32
    )

    def sine_squared(sine: Formula, cosine: Formula, others: Formula, pull: Formula) -> Formula:
        """sine^2 = 1 - cosine^2, where equilibrium demands pull * cosine = others."""
        if pull.value == 0:
            return sine.squared()
        return meet(sine.squared(), 1 - meet(cosine, others / pull).squared())

    def cosine(cosine: Formula, others: Formula, pull: Formula) -> Formula:
        """The same, where equilibrium demands pull * cosine = others."""
        return cosine if pull.value == 0 else meet(cosine, others / pull)

    cosine31, cosine32 = cosine(along31, residual1, pull3), cosine(along32, residual2, pull3)
    at_equilibrium = hessian(
        sine_squared(cross(u2, t1), along21, linear1 - pull3 * along31, pull2),
        sine_squared(across31, along31, residual1, pull3),
        sine_squared(cross(u1, t2), along12, linear2 - pull3 * along32, pull1),
        sine_squared(across32, along32, residual2, pull3),
        # t1.t2 = -c12 is the product of the cosines plus that of the sines
        meet(across31 * across32, -c12 - cosine31 * cosine32),
    )
    # t2 = -c12 t1 + s12 n1: in E2 + c12 E1 the direction of spring 3 is multiplied by s12
    dependent = residual2 + c12 * residual1 - pull3 * (s12 * dot(u3, n1))
    # the unit vector u3 with two given cosines to t1 and t2: its direction does not occur
    unit = (
        residual1.squared() + residual2.squared() + 2 * (residual1 * residual2 * c12) - pull3.squared() * s12.squared()
    )  # fmt: skip
    # both bars turned by the same angle: spring i feels only that rho turns the other way
    lift, give = graph.constant(0), graph.constant(0)
    for pull, k, d, u, r in ((pull1, k1, d1, u1, r1), (pull2, k2, d2, u2, r2), (pull3, k3, d3, u3, r3)):
        lift = lift + (pull * u[1] - k * d[1])
        give = give + (pull * (u[0] * (1 - rho * (u[0] * r))) - k * (d[0] - rho))
    there = at_equilibrium
    if positive_base and all(load.value == 0 for load in (x3, x4, y3, y4)):
        # L1 (P11 - L2 q) = H11 - H12 is the derivative of rho times lift by th1
        moment, turn = lift, give
        slip = (rho / p1) * graph.derivative(lift, th1.variable).squared()
    else:
        moment = rho * lift + p1 * (x3 * s1 - y3 * c1) + p2 * (x4 * s2 + y4 * c2)
        turn = rho * give + p1 * (x3 * c1 + y3 * s1) - p2 * (x4 * c2 - y4 * s2)
        slip = p1 * (there.p11 - p2 * there.q).squared()
    along = () if phi is None else tuple(x - length(*d3) * u for x, u in zip(d3, u3, strict=True))
    return Mechanism(
        (e1, e2),
        everywhere,
        at_equilibrium,
        (*((moment,) if pull3.value == 0 else (moment, dependent)), *along),
        None if pull3.value == 0 else unit,
        (l1, l2, l3),
        (d1, d2, d3),
        (f1, f2, f3),
        (residual1, residual2),
        (t1, t2),
        None if phi is None else cross(d3, u3),
        turn,
        there.p11 * turn - slip,
        None if moment is not lift else (lift, everywhere.p11 * turn - slip),
    )
