"""The unloaded mechanism, which a reflection in the line of the slider leaves as it is, in coordinates that are regular
next to its flat configurations.

Guarantee: `has_flat_mirror` says True only where th1, th2 and -th1, -th2 have the same potential, at every point of the
slice, and the formulas of `Unfolding` are derivatives of it.

Flat configurations, th1 and th2 in {0, pi}, are equilibria for every design. All others come in pairs, and where a pair
leaves a flat one the Jacobian of E1, E2 and D loses rank. With a = th1 - th1*, b = th2 - th2* the angles from a flat
configuration, t = tan(a/2) and r = tan(b/2)/t, the potential is a function of v = t^2 and r that is smooth also where
v = 0, and its derivative by r is v times such a function.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from ptmcad.certified.formula import Formula, direction, length
from ptmcad.certified.ptm.statics import positive_everywhere
from ptmcad.certified.solved import with_formula
from ptmcad.question.slice import Slice

EXCHANGED = (("L1", "L2"), ("k1", "k2"), ("l0_1", "l0_2"))
_SQUARE = 5
"""The variable v, until t^2 is put for it."""


class Flat(NamedTuple):
    """A flat configuration, by the cosines of th1 and th2, each 1 or -1."""

    c1: int
    c2: int


FLAT = tuple(Flat(c1, c2) for c1 in (1, -1) for c2 in (1, -1))


@dataclass(frozen=True, slots=True)
class Direction:
    """An angle of which the cosine and the sine are formulas."""

    cosine: Formula
    sine: Formula

    def cos(self) -> Formula:
        """The cosine."""
        return self.cosine

    def sin(self) -> Formula:
        """The sine."""
        return self.sine

    def __add__(self, other: Direction) -> Direction:
        return Direction(
            self.cosine * other.cosine - self.sine * other.sine, self.sine * other.cosine + self.cosine * other.sine
        )


class Unfolding(NamedTuple):
    """The derivatives of the potential u(v, r), with g = u_r/v."""

    u_v: Formula
    u_vv: Formula
    g: Formula
    g_v: Formula
    g_r: Formula
    v: Formula

    def determinant(self) -> Formula:
        """(u_vv u_rr - u_vr^2)/v where g = 0."""
        return self.u_vv * self.g_r - self.v * self.g_v.squared()


def has_flat_mirror(slice: Slice) -> bool:
    """Whether there is no load, on a base and with springs' pulls that are each zero or certainly positive."""
    zero = all(not slice.parameters[name].numerator for name in slice.model.forces if name in slice.parameters)
    pulls = all(
        not slice.parameters[f"l0_{n}"].numerator
        or (positive_everywhere(slice, f"l0_{n}") and positive_everywhere(slice, f"k{n}"))
        for n in (1, 2, 3)
    )
    return zero and pulls and positive_everywhere(slice, "rho")


def exchanged(values: Mapping[str, Formula]) -> dict[str, Formula]:
    """The parameters of the unloaded mechanism with both bars exchanged."""
    result = dict(values)
    for one, other in EXCHANGED:
        result[one], result[other] = values[other], values[one]
    return result


def turned(t: Formula, side: int) -> Direction:
    """The angle at tan(a/2) = t from 0, if the side is 1, or pi."""
    scale = t.graph.constant(1) / (1 + t.squared())
    return Direction(side * ((1 - t.squared()) * scale), side * (2 * (t * scale)))


def unfolding(
    values: Mapping[str, Formula], inverses: tuple[Formula, ...], flat: Flat, t: Formula, r: Formula
) -> Unfolding:
    """The derivatives next to a flat configuration, where b is the smaller angle, |r| <= 1.

    Parameters
    ----------
    inverses : 1/l1, 1/l2 and 1/l3.
    t, r : variables.
    """
    graph = t.graph
    rho, bar1, bar2 = values["rho"], values["L1"], values["L2"]
    v = graph.variable(_SQUARE)
    one = graph.constant(1)
    # cos th1, and (cos th2 - cos th2*)/v and sin th1 sin th2/v
    near, far = one / (1 + v), one / (1 + r.squared() * v)
    cos1 = flat.c1 * ((1 - v) * near)
    open2 = -2 * flat.c2 * (r.squared() * far)
    both = 4 * flat.c1 * flat.c2 * (r * (near * far))
    # l_i^2/2 is a function of v, plus v b_i(v, r)
    b = (-(rho * bar2) * open2, graph.constant(0), bar2 * (-rho * open2 + bar1 * (cos1 * open2 - both)))
    along = (graph.constant(0), -(rho * bar1) * cos1, bar1 * ((flat.c2 * bar2 - rho) * cos1))
    square = t.squared()

    def placed(formula: Formula) -> Formula:
        return with_formula(_SQUARE, square, formula)

    def by(formula: Formula, *variables: int) -> Formula:
        for variable in variables:
            formula = graph.derivative(formula, variable)
        return placed(formula)

    sums = [graph.constant(0)] * 5
    for n in range(3):
        k, pull = values[f"k{n + 1}"], values[f"k{n + 1}"] * values[f"l0_{n + 1}"]
        half, ratio = along[n] + v * b[n], r.variable
        force, bend = k - pull * inverses[n], pull * (inverses[n] * inverses[n].squared())
        q_v, b_r = by(half, _SQUARE), by(b[n], ratio)
        terms = (
            force * q_v,
            force * by(half, _SQUARE, _SQUARE) + bend * q_v.squared(),
            force * b_r,
            force * by(b[n], ratio, _SQUARE) + bend * (q_v * b_r),
            force * by(b[n], ratio, ratio) + bend * (square * b_r.squared()),
        )
        sums = [total + term for total, term in zip(sums, terms, strict=True)]
    return Unfolding(*sums, square)


class FlatHessian(NamedTuple):
    """Of a flat configuration: its determinant and diagonal, times lengths of springs and other positive numbers.

    Finite, and of the right sign next to springs without length, as no direction has to be known.
    """

    determinant: Formula
    diagonal: tuple[Formula, Formula]


def flat_hessian(values: Mapping[str, Formula], flat: Flat) -> FlatHessian:
    """For H11/L1 = c1 (g2 rho + g3 d1), H22/L2 = c2 (g1 rho + g3 d2), H12/(L1 L2) = -c1 c2 g3, g_i = k_i - pull_i/l_i.

    Here d1 = rho - L2 c2, d2 = rho - L1 c1, d3 = rho - L1 c1 - L2 c2 and l_i = |d_i|, so that c1 c2 d1 d2 - L1 L2 =
    c1 c2 rho d3.
    """
    rho = values["rho"]
    zero = rho.graph.constant(0)
    arm1, arm2 = flat.c1 * values["L1"], flat.c2 * values["L2"]
    d1, d2, d3 = rho - arm2, rho - arm1, rho - arm1 - arm2
    l1, l2, l3 = (length(d, zero) for d in (d1, d2, d3))
    f1, f2, f3 = (
        values[f"k{n}"] * extent - values[f"k{n}"] * values[f"l0_{n}"] for n, extent in ((1, l1), (2, l2), (3, l3))
    )
    return FlatHessian(
        rho * (f1 * f2 * l3) + f3 * (f1 * (d1 * l2) + f2 * (d2 * l1)) + f3.squared() * (l1 * l2 * direction(d3, zero)),
        (
            flat.c1 * (rho * (f2 * l3) + d1 * (f3 * l2)),
            flat.c2 * (rho * (f1 * l3) + d2 * (f3 * l1)),
        ),
    )
