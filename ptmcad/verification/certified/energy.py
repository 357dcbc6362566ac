"""The energy's derivatives in balls of Arb, for springs with free lengths: square roots of what the description says.

Guarantee: every ball contains the exact value at each configuration and for all parameters in the balls given; where a
spring may have length zero, its direction is any unit vector and nothing is claimed of second derivatives.

A *crease* is a circle of configurations in which a spring with a free length has no length: th2 = 0 where rho = L2,
th1 = 0 where rho = L1, th1 + th2 = pi where rho = 0 and L1 = L2. The energy is smooth on either side of it and can be
continued across it from each side, but the two continuations differ. `Energy.one_sided` gives them.

The energy of springs without free lengths and of the loads, and the square q of a spring's length l, are sums of waves
(`ptmcad.verification.certified.vectors`). A free length l0 adds -k l0 l and a constant, with derivatives by

    l_i = q_i/(2 l),    l_ij = (q_ij/2 - l_i l_j)/l.

Derivatives are divided by the lengths of the bars that the angles turn. The second engine has unit vectors instead of
the roots, and differentiates a graph of formulas.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import NamedTuple

from flint import arb, arb_mat

from ptmcad.verification.certified.vectors import BARS, CROSSING, ORDER, ROWS, SPRINGS, Spring, Terms, ball

Pair = tuple[arb, arb]
Sides = tuple[int, ...]
"""For each spring the side of its crease: 1 or -1, or 0 for the side that the balls are on."""
_ANY = arb(0, 1)
_CROSSING = SPRINGS.index(CROSSING)


class Derivatives(NamedTuple):
    """First derivatives by the angles over the bars' lengths, e1 and e2, and e11, e12, e21, e22, those of e1 and e2.

    Attributes
    ----------
    rest : e1 and e2 without the free length of the spring between the bars.
    short : numbers of the springs that may have length zero; if there are any, second derivatives are meaningless.
    bare : where the first of them is turned by one angle, and the one between the bars is not among them, the first
        derivative by this angle without the spring's free length, and the second derivative of half its square.
    """

    e1: arb
    e2: arb
    e11: arb
    e12: arb
    e21: arb
    e22: arb
    short: tuple[int, ...]
    rest: Pair
    bare: Pair | None = None

    @property
    def crossing(self) -> bool:
        """Whether the spring between the bars may have length zero."""
        return _CROSSING in self.short


class _Pull(NamedTuple):
    """A spring at given parameters."""

    number: int
    spring: Spring
    free: arb
    pull: arb
    zero: arb
    gap: arb
    product: arb
    root: arb
    crease: bool
    side: int
    row: int

    @property
    def pulls(self) -> bool:
        # a ball that is not exactly zero: != would ask for one without zero
        return not (self.pull == 0)  # noqa: SIM201

    def crease_at(self, one: arb, two: arb) -> arb:
        """What vanishes on the crease."""
        return ((one + two) / 2).cos() if self.spring.angle is None else ((one, two)[self.spring.angle] / 2).sin()


class Energy:
    """The derivatives as functions of two angles.

    Parameters
    ----------
    values : a ball for each parameter in the energy; lengths and stiffnesses positive, free lengths not negative.
    creases : for each spring, whether it has surely length zero on a circle; none has where nothing is said.
    sides : the sides of the creases whose formulas are continued across them.
    """

    def __init__(self, values: Mapping[str, arb], creases: tuple[bool, ...] = (), sides: Sides = ()):
        self.values, self.creases = dict(values), creases or (False,) * len(SPRINGS)
        self.bars = tuple(self._value(b) for b in BARS)
        self.springs: list[_Pull] = []
        rows = [*ROWS]
        for number, (spring, crease, side) in enumerate(
            zip(SPRINGS, self.creases, sides or (0,) * len(SPRINGS), strict=True)
        ):
            free, zero, product = self._value(spring.free), self._value(spring.zero), self._value(spring.product)
            zero = arb(0) if crease else zero
            pull = self._value(spring.stiffness) * free
            root = arb(1) if spring.angle is None else product.sqrt() / (2 * self.bars[spring.angle])
            new = _Pull(number, spring, free, pull, zero, zero * zero, product, root, crease, side, len(rows))
            self.springs.append(new)
            if new.pulls:
                rows += spring.rows if spring.angle is None else spring.rows[spring.angle : 4 : 2]
        self.turned = [s for s in self.springs if s.pulls and s.spring.angle is not None]
        self.between = self.springs[_CROSSING]
        zero = arb(0)
        self._matrix = arb_mat(
            [[self._value(row[key]) if key in row else zero for key in (((0, 0), 0), *ORDER)] for row in rows]
        )

    def _value(self, terms: Terms) -> arb:
        return ball(terms, self.values)

    def _rows(self, one: arb, two: arb) -> list[arb]:
        """The sums of waves that the derivatives are made of."""
        s1, c1 = one.sin_cos()
        s2, c2 = two.sin_cos()
        s12, c12 = (one + two).sin_cos()
        rows: list[arb] = (self._matrix * arb_mat(7, 1, [_ONE, c1, s1, c2, s2, c12, s12])).entries()
        return rows

    def __call__(self, one: arb, two: arb) -> Derivatives:
        """At all configurations in two balls."""
        rows = self._rows(one, two)
        slopes, bends = rows[:2], rows[2:4]
        length1, length2 = self.bars
        short, bare = [], None
        for s in self.turned:
            k = s.spring.angle or 0
            slope, bend = self._turning(s, (one, two)[k], rows[s.row], rows[s.row + 1])
            if bend is None:
                bare = bare or (slopes[k], rows[s.row + 1])
                short.append(s.number)
            else:
                bends[k] -= s.pull * bend
            slopes[k] -= s.pull * slope
        e12, e21, rest = length2 * rows[4], length1 * rows[4], (slopes[0], slopes[1])
        s = self.between
        if not s.pulls:
            return Derivatives(*rest, bends[0], e12, e21, bends[1], tuple(short), rest, bare)
        if s.crease:
            # l = 2 L |cos((one + two)/2)|, both bars being of length L
            sine, cosine = ((one + two) / 2).sin_cos()
            side = _side(cosine, s.side)
            if side:
                slope, bend = s.pull * side * sine, s.pull * side * cosine / 2
                return Derivatives(slopes[0] + slope, slopes[1] + slope, bends[0] + bend, e12 + bend, e21 + bend,
                                   bends[1] + bend, tuple(short), rest, bare)  # fmt: skip
        q = rows[5] * rows[5] + rows[6] * rows[6]
        if not q > 0:
            pull = s.pull * _ANY
            return Derivatives(
                slopes[0] - pull, slopes[1] - pull, bends[0], e12, e21, bends[1], (*short, s.number), rest
            )  # fmt: skip
        a, b, a1, b2, mixed = rows[s.row : s.row + 5]
        inverse = q.rsqrt()
        u, v = unit(a * inverse), unit(b * inverse)
        pull = s.pull * inverse
        cross = rows[4] - pull * (mixed - u * v)
        return Derivatives(
            slopes[0] - s.pull * u, slopes[1] - s.pull * v, bends[0] - pull * (a1 - length1 * (u * u)),
            length2 * cross, length1 * cross, bends[1] - pull * (b2 - length2 * (v * v)), tuple(short), rest, bare,
        )  # fmt: skip

    def _turning(self, s: _Pull, angle: arb, slope: arb, bend: arb) -> tuple[arb, arb | None]:
        """(dl/dth)/L and its derivative, from those of l^2/2, for a spring that one angle turns, on a bar of length L.

        On a crease l = 2 L |sin(th/2)|, of one sign on a side; these formulas are used on the side that is given, or
        that the angle's ball is on.
        """
        bar = self.bars[s.spring.angle or 0]
        sine, cosine = (angle / 2).sin_cos()
        if s.crease:
            side = _side(sine, s.side)
            return (side * cosine, -side * sine / 2) if side else (_ANY, None)
        wave = s.product * (sine * sine)
        if wave > s.gap:
            # the same without the quotient of two numbers that vary with the sine
            short = (1 + s.gap / wave).rsqrt()
            turned, inverse = cosine * s.root * short, short * wave.rsqrt()
            turned = unit(turned if sine > 0 else -turned)
        elif s.gap + wave > 0:
            inverse = (s.gap + wave).rsqrt()
            turned = unit(slope * inverse)
        else:
            return _ANY, None
        return turned, inverse * (bend - bar * (turned * turned))

    @property
    def creased(self) -> bool:
        """Whether a spring with a free length has no length on a circle."""
        return any(s.crease and s.pulls for s in self.springs)

    def resolution(self, smallest: float) -> tuple[float, float]:
        """Half widths of the smallest squares worth looking at: small, also against a spring's length next to a crease.

        A spring that one angle turns, if it is that short, turns once around while the angle changes by about its
        length over the bar's.
        """
        sizes = [smallest, smallest]
        for s in self.turned:
            k = s.spring.angle or 0
            sizes[k] = min(smallest, float(s.zero.abs_lower() / self.bars[k]) / 256 or smallest)
        return sizes[0], sizes[1]

    def one_sided(self, one: arb, two: arb) -> list[Energy]:
        """The energies that are continued across the creases that the balls meet, from either side; else nothing.

        A smooth equilibrium in the balls is one of at least one of them. The converse does not hold: a continuation may
        have a zero on the other side of its crease, or on it.
        """
        if not self.creased:
            return []
        ways = list(itertools.product(*(
            (1, -1) if s.crease and s.pulls and s.crease_at(one, two).contains(0) else (0,) for s in self.springs
        )))  # fmt: skip
        return [Energy(self.values, self.creases, sides) for sides in ways] if len(ways) > 1 else []

    def cone(self, one: arb, two: arb, d: Derivatives) -> arb:
        """w1^2 + w2^2 - 2 w1 w2 g - p^2 (1 - g^2), zero at an equilibrium, whatever the crossing spring's direction.

        With w1, w2 what e1, e2 are without the free length of the spring between the bars, an equilibrium demands
        w_i = p t_i . u for a unit vector u, with unit vectors t1 . t2 = g; the formula is what eliminating u leaves.
        Where the spring has no length, the cone outweighs the slope of the rest when this is negative.
        """
        w1, w2 = d.rest
        sine, cosine = (one + two).sin_cos()
        first, pull = w1 + cosine * w2, self.between.pull
        return first * first + sine * sine * (w2 * w2 - pull * pull)

    def squares(self, one: arb, two: arb) -> list[arb]:
        """The squares of the springs' lengths."""
        x, y = self._rows(one, two)[5:7]
        return [x * x + y * y if s.spring.angle is None else s.gap + s.product * s.crease_at(one, two) ** 2
                for s in self.springs]  # fmt: skip

    def peaks(self, one: arb, two: arb, d: Derivatives) -> bool:
        """Whether no equilibrium in the balls is a minimum, because a short spring on one bar bends the energy down.

        An equilibrium has slope w = S/p of the spring, S being its angle's e without the free length; p adds
        -p (q''/2 - L w^2)/l to the second derivative, where l may be zero but has an upper bound.
        """
        if d.bare is None:
            return False
        s = self.springs[d.short[0]]
        k = s.spring.angle or 0
        longest = self.squares(one, two)[s.number].abs_upper().sqrt()
        slope = d.bare[0] / s.pull
        bend = d.bare[1] - self.bars[k] * (slope * slope)
        return bool(bend > 0 and (d.e11, d.e22)[k] - s.pull * bend / longest < 0)

    def bends_down(self, one: arb, two: arb, d: Derivatives) -> bool:
        """Whether the Hessian has a negative eigenvalue wherever the crossing spring's length l is not zero.

        With G = J^T J, J being the derivative of the spring's vector by the angles, tr(adj(G) Hess) of -p l is
        -p det G / l but for a part of at most p L1^2 L2^2 (1/L1 + 1/L2); adj(G) is positive semidefinite, so a negative
        trace decides. All is divided by L1 L2; d.e11 ... are those without the free length of the spring.
        """
        s12, c12 = (one + two).sin_cos()
        l1, l2 = self.bars
        pull = self.between.pull
        longest = self.squares(one, two)[self.between.number].abs_upper().sqrt()
        # trace of Gram^-1 H, times L1 L2 s12^2
        trace = l2 * d.e11 + l1 * d.e22 + c12 * (l2 * d.e21 + l1 * d.e12)
        return bool(trace + pull * (l1 + l2) - pull * l1 * l2 * (s12 * s12) / longest < 0)


_ONE = arb(1)


def _side(value: arb, given: int) -> int:
    """The sign of what is zero on a crease: the one that is given, or the one it surely has; else 0."""
    return given or int(value > 0) - int(value < 0)


def unit(value: arb) -> arb:
    """A ball for a number that is known to lie from -1 to 1, given one ball for it."""
    return value if value.rad() < 1 else _ANY
