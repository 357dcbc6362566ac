"""The equations of any model and their Jacobian in balls of Arb, over boxes of the unknowns and of the parameters.

Guarantee: every ball contains the exact value at each configuration and for all parameters in the balls given. Where a
spring with a free length may have no length, its direction is any unit vector, and nothing is said of the Jacobian.

The potential is V - sum of K |d|. With u = d/|d|, slopes g_i of d by the unknowns, second derivatives g_ij, and
c_i = u x g_i, a spring's part of the equations is -K u.g_i and of the Hessian -K (c_i c_j/|d| + u.g_ij). With closed
loops other vectors w_i are in the place of the g_i: of the equations -K u.w_i, and -K ((u x w_i) c_j/|d| + u.w_ij).
Where u is on a line that turns by n_j with the unknowns, c_j/|d| is n_j.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from math import inf
from types import MappingProxyType
from typing import NamedTuple

from flint import arb, arb_mat

from ptmcad.verification.certified.boxes import Unproved
from ptmcad.verification.certified.kinks import Sides
from ptmcad.verification.certified.terms import ball, power, square
from ptmcad.verification.certified.waves import Cone, Form, Waves
from ptmcad.verification.inertia import determinant

Matrix = list[list[arb]]
Vector = tuple[arb, arb]
_ANY = arb(0, 1)


class Spring(NamedTuple):
    """A spring in balls.

    Attributes
    ----------
    number : of the cone.
    length : |d|.
    slopes : g_i.
    weights : w_i, which are the g_i but with closed loops.
    part : K u.w_i.
    bends : K times an upper bound of |g_ii|.
    is_short : whether it may have no length.
    """

    number: int
    pull: arb
    length: arb
    slopes: tuple[Vector, ...]
    weights: tuple[Vector, ...]
    part: tuple[arb, ...]
    bends: tuple[arb, ...]
    is_short: bool


class Jet(NamedTuple):
    """The equations and their derivatives; these without the parts of springs that may have no length.

    Attributes
    ----------
    smooth : the equations without the springs' parts.
    conditions : what is positive at solutions that count.
    """

    values: list[arb]
    jacobian: Matrix
    smooth: list[arb]
    springs: tuple[Spring, ...]
    conditions: list[arb]

    @property
    def short(self) -> list[Spring]:
        """The springs that may have no length; if there are any, the Jacobian is not known."""
        return [s for s in self.springs if s.is_short]

    def balances(self, s: Spring) -> list[arb]:
        """Numbers that are zero at every solution, whatever the direction of a spring.

        With r_i what the equations are without it, a solution has r_i = K u.w_i for a unit vector u; for two unknowns
        adj(A) r = K det(A) u, A having the rows w_i and w_j.
        """
        others = [other for other in self.springs if other.number != s.number]
        rest = [value - sum((o.part[k] for o in others), arb(0)) for k, value in enumerate(self.smooth)]
        found = []
        for i, j in combinations(range(len(rest)), 2):
            (ai, bi), (aj, bj) = s.weights[i], s.weights[j]
            x, y = bj * rest[i] - bi * rest[j], ai * rest[j] - aj * rest[i]
            found.append(square(x) + square(y) - square(s.pull * (ai * bj - aj * bi)))
        return found

    def bends_down(self, s: Spring) -> bool:
        """Whether the Hessian has a negative eigenvalue wherever the one short spring has a length.

        Its trace is at most that of the rest plus K sum |g_ii| - K m/|d|, with m the least value of the sum of
        (u x g_i)^2 over all unit vectors: the smaller eigenvalue of the sum of the g_i g_i^T, at least its
        determinant over its trace.
        """
        if len(s.slopes) == 1:
            return False
        xx = sum((square(a) for a, _ in s.slopes), arb(0))
        yy = sum((square(b) for _, b in s.slopes), arb(0))
        # Lagrange's identity: no difference of large numbers
        gram = sum((square(a * d - b * c) for (a, b), (c, d) in combinations(s.slopes, 2)), arb(0))
        trace = sum((self.jacobian[i][i] + s.bends[i] for i in range(len(s.slopes))), arb(0))
        size = xx + yy
        if not (gram > 0 and size > 0):
            return False
        return bool(trace.upper() - (s.pull * gram / size).lower() / s.length.upper() < 0)


class Field:
    """The equations at given parameters as functions of the unknowns.

    Parameters
    ----------
    values : a ball for each parameter; no pull of a spring is negative.
    conditions : of the form's inequalities and conditions for stability those that are asked for.
    with_determinant : whether that of the Jacobian is a further condition, with its columns as `Form.closing` has them.
    sides : of springs on one line each, on which side of length zero solutions are looked for. There every one of these
        has its direction, also where it is short, and a further condition, which comes before all others.

    Raises
    ------
    Unproved
        When such a line may have no direction.
    """

    def __init__(
        self,
        form: Form,
        values: Mapping[str, arb],
        conditions: Sequence[Waves] = (),
        with_determinant: bool = False,
        sides: Sides = MappingProxyType({}),
    ):
        self.sides = sides
        self._with_determinant = with_determinant
        self.form, self.values, self._conditions = form, dict(values), len(conditions)
        self.cones: list[tuple[int, Cone, arb]] = []
        for number, cone in enumerate(form.cones):
            pull = ball(cone.pull, values)
            # one that pulls nothing at a point has its sides there, too, as all other choices of them have
            if cone.name in sides or not (pull == 0):  # noqa: SIM201 (not exactly zero: != asks for no zero in a ball)
                self.cones.append((number, cone, pull))
        rows: list[Waves] = [*form.equations, *form.jacobian]
        self._lines = {
            number: _pointed(cone, values, sides[cone.name]) for number, cone, _ in self.cones if cone.name in sides
        }
        for _, cone, _ in self.cones:
            for pair in (cone.vector, *cone.slopes, *(cone.weights if form.closing else ()), *cone.bends):
                rows += pair
        rows += conditions
        found = sorted({(turned, raised) for row in rows for turned, raised, _ in row})
        self.basis = found
        place = {key: 2 * k for k, key in enumerate(found)}
        entries = [arb(0)] * (len(rows) * 2 * len(found))
        for n, row in enumerate(rows):
            for (turned, raised, sine), terms in row.items():
                entries[n * 2 * len(found) + place[turned, raised] + sine] = ball(terms, values)
        self._matrix = arb_mat(len(rows), 2 * len(found), entries)
        self._turned = sorted({turned for turned, _ in found if any(turned)})

    @property
    def circles(self) -> tuple[bool, ...]:
        """Of each unknown, whether the equations are the same after a full turn: not where half of it turns a line."""
        lines = self._lines.values()
        return tuple(c and not any(line.twice[k] % 2 for line in lines) for k, c in enumerate(self.form.is_circle))

    def _waves(self, at: Sequence[arb]) -> arb_mat:
        waves = {}
        for turned in self._turned:
            angle = arb(0)
            for multiple, x in zip(turned, at, strict=True):
                if multiple:
                    angle = angle + (x if multiple == 1 else multiple * x)
            sine, cosine = angle.sin_cos()
            waves[turned] = cosine, sine
        column = []
        for turned, raised in self.basis:
            cosine, sine = waves.get(turned, (_ONE, _ZERO))
            for exponent, x in zip(raised, at, strict=True):
                if exponent:
                    factor = power(x, exponent)
                    cosine, sine = cosine * factor, sine * factor
            column += [cosine, sine]
        return arb_mat(len(column), 1, column)

    def __call__(self, at: Sequence[arb]) -> Jet:
        """At all configurations in a box."""
        n = self.form.size
        rows: list[arb] = (self._matrix * self._waves(at)).entries()
        smooth, place = rows[:n], n + n * n
        values, jacobian = list(smooth), [rows[n + n * i : n + n * i + n] for i in range(n)]
        springs, ahead = [], list[arb]()
        length = 2 + (4 if self.form.closing else 2) * n + 2 * n * n
        for number, _, pull in self.cones:
            line = self._lines[number].at(at) if number in self._lines else None
            new = _spring(number, pull, rows[place : place + length], jacobian, line)
            if line is not None:
                ahead.append(line.unit[0] * rows[place] + line.unit[1] * rows[place + 1])
            values = [value - part for value, part in zip(values, new.part, strict=True)]
            springs.append(new)
            place += length
        conditions = [*ahead, *rows[len(rows) - self._conditions :]]
        if self._with_determinant:
            known = not any(s.is_short for s in springs)
            ordered = [[row[k] for k in self.form.closing] for row in jacobian]
            conditions = [*conditions, determinant(ordered) if known else arb(0, inf)]
        return Jet(values, jacobian, smooth, tuple(springs), conditions)


def value_of(row: Waves, values: Mapping[str, arb], at: Sequence[arb]) -> arb:
    """One sum of waves, at all configurations in a box and for all parameters in balls."""
    total = _ZERO
    for (turned, raised, sine), terms in row.items():
        part = ball(terms, values)
        if any(turned):
            angle = sum((multiple * x for multiple, x in zip(turned, at, strict=True) if multiple), _ZERO)
            part *= angle.sin() if sine else angle.cos()
        for exponent, x in zip(raised, at, strict=True):
            part *= power(x, exponent)
        total += part
    return total


class _Pointed(NamedTuple):
    """The direction of a spring on one line, and the multiples of the unknowns in twice the sum that turns it."""

    unit: Vector
    twice: tuple[int, ...]

    @property
    def spins(self) -> list[arb]:
        """How fast it turns with the unknowns."""
        return [arb(n) / 2 for n in self.twice]

    def at(self, unknowns: Sequence[arb]) -> _Pointed:
        """Turned."""
        if not any(self.twice):
            return self
        (x, y), angle = self.unit, sum((n * q for n, q in zip(self.spins, unknowns, strict=True)), arb(0))
        sine, cosine = angle.sin_cos()
        return self._replace(unit=(unit(x * cosine - y * sine), unit(x * sine + y * cosine)))


def _pointed(cone: Cone, values: Mapping[str, arb], side: int) -> _Pointed:
    """The direction of a spring on one line before that turns."""
    line = cone.line
    assert line is not None
    x, y = (side * ball(terms, values) for terms in line.vector)
    squared = square(x) + square(y)
    if not squared > 0:
        raise Unproved(f"the line of spring {cone.name} may have no direction")
    return _Pointed((x / squared.sqrt(), y / squared.sqrt()), line.twice)


def _spring(number: int, pull: arb, rows: list[arb], jacobian: Matrix, line: _Pointed | None) -> Spring:
    """A spring from its vector and its derivatives; its part is taken off the Jacobian if it surely has a direction.

    Parameters
    ----------
    line : its direction, where it is on one line: then it turns as that does.
    """
    n = len(jacobian)
    a, b = rows[:2]
    slopes = tuple((rows[2 + 2 * i], rows[3 + 2 * i]) for i in range(n))
    bends = rows[len(rows) - 2 * n * n :]
    is_gradient = len(rows) == 2 + 2 * n + 2 * n * n
    weights = slopes if is_gradient else tuple((rows[2 * (n + i) + 2], rows[2 * (n + i) + 3]) for i in range(n))
    q = square(a) + square(b)
    outer = tuple(pull * size(*bends[2 * i * (n + 1) : 2 * i * (n + 1) + 2]) for i in range(n))
    reach = (square(a).upper() + square(b).upper()).sqrt()
    if line is None and not q > 0:
        part = tuple(pull * _ANY * size(*w) for w in weights)
        return Spring(number, pull, reach, slopes, weights, part, outer, True)
    inverse = _ONE if line else q.rsqrt()
    u, v = line.unit if line else (unit(a * inverse), unit(b * inverse))
    cross = line.spins if line else [u * gy - v * gx for gx, gy in slopes]
    lean = cross if is_gradient and not line else [u * wy - v * wx for wx, wy in weights]
    for i in range(n):
        for j in range(i if is_gradient else 0, n):
            across, up = bends[2 * (i * n + j)], bends[2 * (i * n + j) + 1]
            turning = square(cross[i]) if is_gradient and i == j and not line else lean[i] * cross[j]
            entry = pull * (turning * inverse + u * across + v * up)
            jacobian[i][j] = jacobian[i][j] - entry
            if is_gradient and i != j:
                jacobian[j][i] = jacobian[j][i] - entry
    part = tuple(pull * (u * x + v * y) for x, y in weights)
    return Spring(number, pull, q.sqrt() if q > 0 else reach, slopes, weights, part, outer, False)


_ZERO, _ONE = arb(0), arb(1)


def size(x: arb, y: arb) -> arb:
    """An upper bound of a vector's length."""
    a, b = x.abs_upper(), y.abs_upper()
    return (a * a + b * b).sqrt().upper()


def unit(value: arb) -> arb:
    """A ball for a number that is known to lie from -1 to 1, given one ball for it."""
    return value if value.rad() < 1 else _ANY


__all__ = ["Field", "Jet", "Matrix", "Spring", "size", "value_of"]
