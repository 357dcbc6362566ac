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
from typing import Any, NamedTuple, Protocol

from ptmcad.certified.formula import Formula, Graph, direction, inverse_length, length, meet
from ptmcad.certified.parameters import parameter_formulas
from ptmcad.question.slice import Slice
from ptmcad.text.expressions import axis

TH1, TH2 = 2, 3
"""Numbers of the angles' variables."""
PHI_UNIT = 4
"""The search bisects the widest variable; with this factor it bisects phi, which follows from th1 and th2, later."""
TURN = (-3.0, -3.0 + 6.2832)
"""A little more than a full turn, cut where no symmetric solution lies."""
Vector = tuple[Formula, Formula]


def dot(p: Vector, q: Vector) -> Formula:
    return p[0] * q[0] + p[1] * q[1]


def cross(p: Vector, q: Vector) -> Formula:
    return p[0] * q[1] - p[1] * q[0]


def present(formula: Formula | None) -> list[Formula]:
    return [] if formula is None else [formula]


class Angle(Protocol):
    """An angle as a formula, or what has formulas for its cosine and its sine."""

    def cos(self) -> Formula: ...
    def sin(self) -> Formula: ...
    def __add__(self, other: Any, /) -> Angle: ...


class Angles(NamedTuple):
    """The angles of a configuration, and which formulas are written in them.

    With ``phi`` the direction of spring 3 is a variable of its own, u3 = (cos phi, sin phi) and l3 = d3.u3, which makes
    every formula but 1/l3 smooth at l3 = 0; they mean the mechanism where `Statics.aligned` vanishes and l3 >= 0.

    ``creases`` shows whether rho = L2, so that d1 = 2 L2 sin(th2/2) (sin(th2/2), cos(th2/2)), and whether rho = L1, so
    that d2 = 2 L1 sin(th1/2) (sin(th1/2), -cos(th1/2)). The formulas then hold for 0 < th2 < 2 pi, or 0 < th1 < 2 pi.
    """

    th1: Angle
    th2: Angle
    phi: Formula | None = None
    creases: tuple[bool, bool] = (False, False)


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
    diagonal_times_l3: tuple[Formula, ...]
    """l3 P11 and l3 P22; empty when spring 3 has no free length."""


@dataclass(frozen=True, slots=True)
class Statics:
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
    pull : another formula of ``unit``, the narrower one at a point: that spring 3 pulls by no more and no less than
        k3 l0_3. None when spring 3 has no free length.
    lengths : l1, l2, l3.
    vectors : d1, d2, d3.
    free : the free lengths.
    """

    equilibrium: tuple[Formula, Formula]
    hessian: Hessian
    at_equilibrium: Hessian
    dependent: tuple[Formula, ...]
    unit: Formula | None
    pull: Formula | None
    lengths: tuple[Formula, ...]
    vectors: tuple[Vector, ...]
    free: tuple[Formula, ...]
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


def slice_statics(graph: Graph, slice: Slice, *, phi: bool = False, factored: bool = True) -> Statics:
    """The slice's mechanism in variables x, y, th1, th2 and, if asked for, v, which is phi / PHI_UNIT.

    ``factored`` says whether the unloaded mechanism's factor rho may be left out where rho is positive.
    """
    values = parameter_formulas(graph, slice)
    angles = Angles(graph.variable(TH1), graph.variable(TH2), PHI_UNIT * graph.variable(4) if phi else None)
    return statics(values, angles, positive_base=factored and positive_base(slice))


def positive_base(slice: Slice) -> bool:
    """Whether rho is certainly positive in the open window."""
    return positive_everywhere(slice, "rho")


def positive_everywhere(slice: Slice, name: str) -> bool:
    """Whether a parameter that is nowhere negative is certainly positive in the open window."""
    value = slice.parameters[name]
    # an axis is positive in the open window; of other expressions only constants are known to be
    return value in (axis(0), axis(1)) or (value.is_constant and value.constant() > 0)


def statics(values: Mapping[str, Formula], angles: Angles, *, positive_base: bool = False) -> Statics:
    """The mechanism with parameters ``values`` (all variables of the description, stiffness and loads in one unit).

    ``positive_base`` says that rho is zero nowhere in the open window.
    """
    z = _configuration(values, angles)
    first, second, third = z.springs
    linear, cosines = _linear(z), _cosines(z)
    residual = linear[0] - second.pull * cosines.along21, linear[1] - first.pull * cosines.along12
    equilibrium = residual[0] - third.pull * cosines.along31, residual[1] - third.pull * cosines.along32
    hessian = _hessian(z, _squared_sines(z))
    there = _hessian(z, _squared_sines_at_equilibrium(z, linear, residual, cosines))
    pulls = third.pull.value != 0
    # t2 = -c12 t1 + s12 n1: in E2 + c12 E1 the direction of spring 3 is multiplied by s12
    dependent = residual[1] + z.c12 * residual[0] - third.pull * (z.s12 * dot(third.direction, z.n1))
    unloaded = positive_base and all(load.value == 0 for load in z.loads)
    turning = _unloaded_turning(z) if unloaded else _turning(z, there)
    d3, u3 = third.vector, third.direction
    along = () if angles.phi is None else tuple(x - length(*d3) * u for x, u in zip(d3, u3, strict=True))
    turned = there.p11 * turning.turn - turning.slip
    return Statics(
        equilibrium,
        hessian,
        there,
        (turning.moment, *((dependent,) if pulls else ()), *along),
        _unit(z, residual) if pulls else None,
        _pull(z, residual) if pulls else None,
        tuple(spring.length for spring in z.springs),
        tuple(spring.vector for spring in z.springs),
        tuple(spring.free for spring in z.springs),
        None if angles.phi is None else cross(d3, u3),
        turning.turn,
        turned,
        (turning.moment, hessian.p11 * turning.turn - turning.slip) if unloaded else None,
    )


class _Spring(NamedTuple):
    """A spring's vector d, d/l, l and 1/l, with its stiffness and free length."""

    vector: Vector
    direction: Vector
    length: Formula
    inverse: Formula
    k: Formula
    free: Formula
    pull: Formula
    """k times the free length."""


class _Configuration(NamedTuple):
    """The mechanism in one configuration.

    Tangents: d(d2)/dth1 = d(d3)/dth1 = L1 t1, d(d1)/dth2 = d(d3)/dth2 = L2 t2; normals: n1 = dt1/dth1, n2 = dt2/dth2.
    """

    rho: Formula
    p1: Formula
    p2: Formula
    loads: tuple[Formula, Formula, Formula, Formula]
    """F3x, F3, F4x, F4"""
    c12: Formula
    s12: Formula
    t1: Vector
    t2: Vector
    n1: Vector
    n2: Vector
    springs: tuple[_Spring, _Spring, _Spring]


def _configuration(values: Mapping[str, Formula], angles: Angles) -> _Configuration:
    th1, th2 = angles.th1, angles.th2
    p1, p2, rho = values["L1"], values["L2"], values["rho"]
    s1, c1, s2, c2 = th1.sin(), th1.cos(), th2.sin(), th2.cos()
    d1 = (rho - p2 * c2, p2 * s2)
    d2 = (rho - p1 * c1, -(p1 * s1))
    d3 = (rho - p1 * c1 - p2 * c2, p2 * s2 - p1 * s1)
    springs = []
    for n, d in enumerate((d1, d2, d3), start=1):
        u, extent, inverse = (direction(*d), direction(*d[::-1])), length(*d), inverse_length(*d)
        if n == 3 and angles.phi is not None:
            u = angles.phi.cos(), angles.phi.sin()
            extent = dot(d, u)
        elif n < 3 and angles.creases[n - 1]:
            turned, bar, side = ((th2, p2, 1), (th1, p1, -1))[n - 1]
            assert isinstance(turned, Formula)
            half = turned * Fraction(1, 2)
            u, extent = (half.sin(), side * half.cos()), 2 * bar * half.sin()
            inverse = 1 / extent
        k, free = values[f"k{n}"], values[f"l0_{n}"]
        springs.append(_Spring(d, u, extent, inverse, k, free, k * free))
    return _Configuration(
        rho, p1, p2, (values["F3x"], values["F3"], values["F4x"], values["F4"]),
        (th1 + th2).cos(), (th1 + th2).sin(), (s1, -c1), (s2, c2), (c1, s1), (c2, -s2),
        (springs[0], springs[1], springs[2]),
    )  # fmt: skip


def _linear(z: _Configuration) -> tuple[Formula, Formula]:
    """E1 and E2 of quadratic springs and loads, without free lengths; A3 = L1 (c1, s1), A4 = (rho - L2 c2, L2 s2)."""
    (k1, k2, k3), (x3, y3, x4, y4) = (spring.k for spring in z.springs), z.loads
    (c1, s1), (s2, c2) = z.n1, z.t2
    return (
        k2 * (z.rho * s1) + k3 * (z.rho * s1 - z.p2 * z.s12) + x3 * s1 - y3 * c1,
        k1 * (z.rho * s2) + k3 * (z.rho * s2 - z.p1 * z.s12) - x4 * s2 - y4 * c2,
    )


class _Cosines(NamedTuple):
    """Of the angles between springs 2 and 3 and the first tangent, and between springs 1 and 3 and the second."""

    along21: Formula
    along31: Formula
    along12: Formula
    along32: Formula


def _cosines(z: _Configuration) -> _Cosines:
    u1, u2, u3 = (spring.direction for spring in z.springs)
    return _Cosines(dot(u2, z.t1), dot(u3, z.t1), dot(u1, z.t2), dot(u3, z.t2))


class _SquaredSines(NamedTuple):
    """Of the same angles, in the same order; ``product`` is that of the two sines of spring 3."""

    across21: Formula
    across31: Formula
    across12: Formula
    across32: Formula
    product: Formula


def _squared_sines(z: _Configuration) -> _SquaredSines:
    u1, u2, u3 = (spring.direction for spring in z.springs)
    across31, across32 = cross(u3, z.t1), cross(u3, z.t2)
    return _SquaredSines(
        cross(u2, z.t1).squared(), across31.squared(), cross(u1, z.t2).squared(), across32.squared(),
        across31 * across32,
    )  # fmt: skip


def _squared_sines_at_equilibrium(
    z: _Configuration, linear: tuple[Formula, Formula], residual: tuple[Formula, Formula], cosines: _Cosines
) -> _SquaredSines:
    """The same, also as 1 - cosine^2, where equilibrium demands pull * cosine = the other terms of E1 or E2."""
    pull1, pull2, pull3 = (spring.pull for spring in z.springs)
    anywhere = _squared_sines(z)

    def narrowed(cosine: Formula, others: Formula, pull: Formula) -> Formula:
        return cosine if pull.value == 0 else meet(cosine, others / pull)

    def squared_sine(known: Formula, cosine: Formula, others: Formula, pull: Formula) -> Formula:
        return known if pull.value == 0 else meet(known, 1 - narrowed(cosine, others, pull).squared())

    along21, along31, along12, along32 = cosines
    cosine31, cosine32 = narrowed(along31, residual[0], pull3), narrowed(along32, residual[1], pull3)
    return _SquaredSines(
        squared_sine(anywhere.across21, along21, linear[0] - pull3 * along31, pull2),
        squared_sine(anywhere.across31, along31, residual[0], pull3),
        squared_sine(anywhere.across12, along12, linear[1] - pull3 * along32, pull1),
        squared_sine(anywhere.across32, along32, residual[1], pull3),
        # t1.t2 = -c12 is the product of the cosines plus that of the sines
        meet(anywhere.product, -z.c12 - cosine31 * cosine32),
    )


def _hessian(z: _Configuration, sines: _SquaredSines) -> Hessian:
    """From the squared sines of the angles between springs and tangents; spring 3 enters D to the first power."""
    (first, second, third), (x3, y3, x4, y4) = z.springs, z.loads
    (c1, s1), (s2, c2) = z.n1, z.t2
    smooth1 = (
        second.k * (z.rho * c1) + third.k * (z.rho * c1 - z.p2 * z.c12) + x3 * c1 + y3 * s1
        - second.pull * dot(second.direction, z.n1)
    )  # fmt: skip
    smooth2 = (
        first.k * (z.rho * c2) + third.k * (z.rho * c2 - z.p1 * z.c12) - x4 * c2 + y4 * s2
        - first.pull * dot(first.direction, z.n2)
    )  # fmt: skip
    bend1 = smooth1 - third.pull * dot(third.direction, z.n1)
    bend2 = smooth2 - third.pull * dot(third.direction, z.n2)
    sway1, sway2 = z.p1 * (second.pull * sines.across21), z.p2 * (first.pull * sines.across12)
    rigid1, rigid2 = bend1 - second.inverse * sway1, bend2 - first.inverse * sway2
    tilt, mixed = third.pull * third.inverse, -(third.k * z.c12)

    def determinant(a: Formula | int, b: Formula | int, c: Formula | int, rows: Vector, pull: Formula) -> Formula:
        """a b c D from the rows a rigid1 and b rigid2 and from c tilt."""
        both = z.p1 * z.p2 * (a * b)
        row1, row2 = rows
        return c * (row1 * row2 - both * mixed.squared()) - pull * (
            z.p1 * (sines.across31 * (a * row2))
            + z.p2 * (sines.across32 * (b * row1))
            - 2 * (both * (mixed * sines.product))
        )

    rigid = rigid1, rigid2
    levelled = second.length * bend1 - sway1, first.length * bend2 - sway2
    return Hessian(
        rigid1 - z.p1 * (tilt * sines.across31),
        rigid2 - z.p2 * (tilt * sines.across32),
        mixed - tilt * sines.product,
        determinant(1, 1, 1, rigid, tilt),
        determinant(1, 1, third.length, rigid, third.pull),
        determinant(second.length, first.length, third.length, levelled, third.pull),
        (
            third.length * (smooth1 - second.inverse * sway1)
            - third.pull * dot(third.vector, z.n1)
            - third.pull * (z.p1 * sines.across31),
            third.length * (smooth2 - first.inverse * sway2)
            - third.pull * dot(third.vector, z.n2)
            - third.pull * (z.p2 * sines.across32),
        )
        if third.pull.value != 0
        else (),
    )


def _unit(z: _Configuration, residual: tuple[Formula, Formula]) -> Formula:
    """The unit vector u3 with two given cosines to t1 and t2: its direction does not occur."""
    r1, r2 = residual
    return r1.squared() + r2.squared() + 2 * (r1 * r2 * z.c12) - z.springs[2].pull.squared() * z.s12.squared()


def _pull(z: _Configuration, residual: tuple[Formula, Formula]) -> Formula:
    """That spring 3 pulls by no more and no less than its pull, in terms that are smooth.

    E1 = r1 - g.t1 and E2 = r2 - g.t2 with a vector g of this length. Solved for g: |g|^2 s12^2 = r1^2 + r2^2 + 2 r1 r2
    c12 = (r1 + c12 r2)^2 + s12^2 r2^2. Where spring 3 is short its direction is not known, but |g| is.
    """
    r1, r2 = residual
    c12, s12 = -dot(z.t1, z.t2), cross(z.t1, z.t2)
    return (r1 + c12 * r2).squared() + s12.squared() * (r2.squared() - z.springs[2].pull.squared())


class _Turning(NamedTuple):
    """Both bars turned by the same angle: the moment, its derivative by the angle, and ((H11 - H12)^2)/L1.

    Unloaded, the first two are divided by rho, and the last by rho^2.
    """

    moment: Formula
    turn: Formula
    slip: Formula


def _lift(z: _Configuration) -> tuple[Formula, Formula]:
    """The springs' part of the moment, and of its derivative, over rho: a spring feels only that rho turns back."""
    lift, give = z.rho.graph.constant(0), z.rho.graph.constant(0)
    for spring in z.springs:
        (dx, dy), (ux, uy) = spring.vector, spring.direction
        lift = lift + (spring.pull * uy - spring.k * dy)
        give = give + (spring.pull * (ux * (1 - z.rho * (ux * spring.inverse))) - spring.k * (dx - z.rho))
    return lift, give


def _unloaded_turning(z: _Configuration) -> _Turning:
    lift, give = _lift(z)
    # L1 (P11 - L2 q) = H11 - H12 is the derivative of rho times lift by th1
    slip = (z.rho / z.p1) * lift.graph.derivative(lift, TH1).squared()
    return _Turning(lift, give, slip)


def _turning(z: _Configuration, there: Hessian) -> _Turning:
    (lift, give), (x3, y3, x4, y4) = _lift(z), z.loads
    (c1, s1), (s2, c2) = z.n1, z.t2
    return _Turning(
        z.rho * lift + z.p1 * (x3 * s1 - y3 * c1) + z.p2 * (x4 * s2 + y4 * c2),
        z.rho * give + z.p1 * (x3 * c1 + y3 * s1) - z.p2 * (x4 * c2 - y4 * s2),
        z.p1 * (there.p11 - z.p2 * there.q).squared(),
    )
