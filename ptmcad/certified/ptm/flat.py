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
from ptmcad.certified.parameters import values_at
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
class Turned:
    """An angle, 0 or pi by its ``side`` (1 or -1) and turned by a, of which tan(a/2) = rise/run."""

    side: int
    run: Formula
    rise: Formula

    def cos(self) -> Formula:
        """The cosine."""
        return self.side * (2 * direction(self.run, self.rise).squared() - 1)

    def sin(self) -> Formula:
        """The sine."""
        return 2 * self.side * (direction(self.run, self.rise) * direction(self.rise, self.run))

    def __add__(self, other: Turned) -> Turned:
        return Turned(
            self.side * other.side,
            self.run * other.run - self.rise * other.rise,
            self.run * other.rise + other.run * self.rise,
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
    """Whether there is no load, on a base that is certainly positive, with pulls that are zero or certainly positive.

    Where a pull vanished on a line only, minima could run into a configuration in which its spring has no length. Free
    lengths that are small beside the lengths of the mechanism are left to the general formulas, which are faster there:
    those of `Unfolding` are told apart from their poles only in boxes as small as the free lengths.
    """
    given = slice.parameters
    loaded = any(given[name].numerator for name in slice.model.forces if name in given)
    pulls = all(
        not given[free].numerator or (positive_everywhere(slice, free) and positive_everywhere(slice, stiffness))
        for free, stiffness in (("l0_1", "k1"), ("l0_2", "k2"), ("l0_3", "k3"))
        if free in given
    )
    return pulls and not loaded and positive_everywhere(slice, "rho") and not _is_weak(slice)


def _is_weak(slice: Slice) -> bool:
    """Whether a free length is positive and, in the middle of the window, under a sixth of a bar or of the base there.

    It decides how long the search takes, and nothing else.
    """
    middle = [(a.low + a.high) / 2 for a in slice.axes]
    values = values_at(slice, middle[0], middle[1])
    longest = max(values[name] for name in ("rho", "L1", "L2"))
    return any(0 < values[name] < longest / 6 for name in ("l0_1", "l0_2", "l0_3"))


def exchanged(values: Mapping[str, Formula]) -> dict[str, Formula]:
    """The parameters of the unloaded mechanism with both bars exchanged."""
    result = dict(values)
    for one, other in EXCHANGED:
        result[one], result[other] = values[other], values[one]
    return result


def unfolding(
    values: Mapping[str, Formula], inverses: tuple[Formula, ...], flat: Flat, t: Formula, r: Formula
) -> Unfolding:
    """The derivatives next to a flat configuration, where b is the smaller angle, |r| <= 1.

    Parameters
    ----------
    inverses : 1/l1, 1/l2 and 1/l3.
    t, r : variables of the graph.
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
    u_v, u_vv, g, g_v, g_r = sums
    return Unfolding(u_v, u_vv, g, g_v, g_r, square)


class FlatHessian(NamedTuple):
    """Of a flat configuration, times lengths of springs with a pull and other positive numbers.

    They are finite, and have the right signs, also next to springs without length: no direction has to be known.
    """

    determinant: Formula
    diagonal: tuple[Formula, Formula]


def flat_hessian(values: Mapping[str, Formula], flat: Flat) -> FlatHessian:
    """Of P11 = c1 (g2 rho + g3 d1), P22 = c2 (g1 rho + g3 d2) and q = -c1 c2 g3, where g_i = k_i - pull_i/l_i.

    Here d1 = rho - L2 c2, d2 = rho - L1 c1, d3 = rho - L1 c1 - L2 c2 and l_i = |d_i|, so that c1 c2 d1 d2 - L1 L2 =
    c1 c2 rho d3 and D = c1 c2 rho (rho g1 g2 + g1 g3 d1 + g2 g3 d2 + g3^2 d3).
    """
    rho = values["rho"]
    zero, one = rho.graph.constant(0), rho.graph.constant(1)
    arm1, arm2 = flat.c1 * values["L1"], flat.c2 * values["L2"]
    d1, d2, d3 = rho - arm2, rho - arm1, rho - arm1 - arm2
    pulls = [values[f"k{n}"] * values[f"l0_{n}"] for n in (1, 2, 3)]
    scales = [length(d, zero) if pull.value != 0 else one for d, pull in zip((d1, d2, d3), pulls, strict=True)]
    (l1, l2, l3), (f1, f2, f3) = scales, (values[f"k{n + 1}"] * scales[n] - pulls[n] for n in range(3))
    side3 = direction(d3, zero) if pulls[2].value != 0 else d3
    return FlatHessian(
        rho * (f1 * f2 * l3) + f3 * (f1 * (d1 * l2) + f2 * (d2 * l1)) + f3.squared() * (l1 * l2 * side3),
        (flat.c1 * (rho * (f2 * l3) + d1 * (f3 * l2)), flat.c2 * (rho * (f1 * l3) + d2 * (f3 * l1))),
    )
