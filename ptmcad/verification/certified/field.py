"""The equations of any model and their Jacobian in balls of Arb, over boxes of the unknowns and of the parameters.

Guarantee: every ball contains the exact value at each configuration and for all parameters in the balls given. Where a
spring with a free length may have no length, its direction is any unit vector, and nothing is said of the Jacobian.

The potential is V - sum of K |d|. With u = d/|d|, slopes g_i of d by the unknowns, second derivatives g_ij, and
c_i = u x g_i, a spring's part of the equations is -K u.g_i and of the Hessian -K (c_i c_j/|d| + u.g_ij). With closed
loops other vectors w_i are in the place of the g_i: of the equations -K u.w_i, and -K ((u x w_i) c_j/|d| + u.w_ij).
Where u is on a line that turns by n_j with the unknowns, c_j/|d| is n_j.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import chain, combinations
from math import inf
from types import MappingProxyType
from typing import NamedTuple

from flint import arb, arb_mat

from ptmcad.verification.certified.boxes import Unproved
from ptmcad.verification.certified.kinks import Sides
from ptmcad.verification.certified.terms import ball, power, square
from ptmcad.verification.certified.waves import Form, Multi, SpringCone, Waves
from ptmcad.verification.inertia import determinant

Matrix = list[list[arb]]
Vector = tuple[arb, arb]
_ANY = arb(0, 1)


class ConeBalls(NamedTuple):
    """A spring with a free length, or several that are one, in balls.

    Attributes
    ----------
    number : its place among those that pull.
    squared : |d|^2.
    slopes : g_i.
    weights : w_i, which are the g_i but with closed loops.
    part : K u.w_i.
    turns : the spring's direction and how the Jacobian follows from it; None where it may have no length.
    shape : where its parts are not nothing.
    """

    number: int
    pull: arb
    squared: arb
    slopes: tuple[Vector, ...]
    weights: tuple[Vector, ...]
    part: list[arb]
    turns: _Turns | None
    shape: _Shape

    @property
    def length(self) -> arb:
        """|d|; an upper bound where it may be nothing."""
        return (self.squared if self.squared > 0 else self.squared.abs_upper()).sqrt()

    @property
    def is_short(self) -> bool:
        """Whether it may have no length."""
        return self.turns is None


class _Shape(NamedTuple):
    """Equations with a part of a spring, and entries of the Jacobian; in a symmetric one each pair once."""

    equations: tuple[int, ...]
    entries: tuple[tuple[int, int], ...]


class _Turns(NamedTuple):
    """The direction u, 1/|d|, and on one line how fast that turns with the unknowns, then with 1 for 1/|d|."""

    unit: Vector
    inverse: arb
    spins: list[arb] | None


@dataclass(frozen=True)
class BallJet:
    """The equations and their derivatives; these without the parts of springs that may have no length.

    Attributes
    ----------
    smooth : the equations without the springs' parts.
    conditions : what is positive at solutions that count.
    derivatives : of `smooth`, row by row, and after them of each spring's weights by the unknowns, row by row.
    """

    values: list[arb]
    smooth: list[arb]
    cones: tuple[ConeBalls, ...]
    conditions: list[arb]
    derivatives: Callable[[], list[arb]]

    @cached_property
    def _derivatives(self) -> list[arb]:
        return self.derivatives()

    @cached_property
    def jacobian(self) -> Matrix:
        """The derivatives, which points and most boxes that are discarded do without."""
        n = len(self.values)
        found = [self._derivatives[n * i : n * i + n] for i in range(n)]
        for s in self.cones:
            if s.turns is not None:
                _take_off(found, s, s.turns, self._bends(s))
        return found

    def _bends(self, s: ConeBalls) -> list[Vector]:
        """The derivatives of a spring's weights by the unknowns, row by row."""
        n = len(self.values)
        rows = self._derivatives[n * n * (2 * s.number + 1) : n * n * (2 * s.number + 3)]
        return list(zip(rows[::2], rows[1::2], strict=True))

    @property
    def short(self) -> list[ConeBalls]:
        """The springs that may have no length; if there are any, the Jacobian is not known."""
        return [s for s in self.cones if s.is_short]

    def balances(self, s: ConeBalls) -> list[arb]:
        """Numbers that are zero at every solution, whatever the direction of a spring.

        With r_i what the equations are without it, a solution has r_i = K u.w_i for a unit vector u; for two unknowns
        adj(A) r = K det(A) u, A having the rows w_i and w_j.
        """
        others = [other for other in self.cones if other.number != s.number]
        rest = [value - sum((o.part[k] for o in others), arb(0)) for k, value in enumerate(self.smooth)]
        found = []
        for i, j in combinations(range(len(rest)), 2):
            (ai, bi), (aj, bj) = s.weights[i], s.weights[j]
            x, y = bj * rest[i] - bi * rest[j], ai * rest[j] - aj * rest[i]
            found.append(square(x) + square(y) - square(s.pull * (ai * bj - aj * bi)))
        return found

    def bends_down(self, s: ConeBalls) -> bool:
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
        n, bends = len(s.slopes), self._bends(s)
        trace = sum((self.jacobian[i][i] + s.pull * size(*bends[i * n + i]) for i in range(n)), arb(0))
        if not (gram > 0 and xx + yy > 0):
            return False
        return bool(trace.upper() - (s.pull * gram / (xx + yy)).lower() / s.length.upper() < 0)


class BallEquations:
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
        self._pulling: list[_Pulling] = []
        first, derivatives = list[Waves](form.equations), list[Waves](form.jacobian)
        for cone in form.cones:
            pull = ball(cone.pull, values)
            # one that pulls nothing at a point has its sides there, too, as all other choices of them have
            if cone.name in sides or not (pull == 0):  # noqa: SIM201 (not exactly zero: != asks for no zero in a ball)
                line = _pointed(cone, values, sides[cone.name]) if cone.name in sides else None
                self._pulling.append(_Pulling(pull, _shape(form, cone), line))
                first += chain(cone.vector, *cone.slopes, *(cone.weights if form.closing else ()))
                derivatives += chain(*cone.bends)
        first += conditions
        found = sorted({(turned, raised) for row in (*first, *derivatives) for turned, raised, _ in row})
        self._first, self._derivatives = (_Rows(rows, found, values) for rows in (first, derivatives))
        self._turned = {turned: _nonzero(turned) for turned, _ in found if any(turned)}
        self._columns = [(turned, _nonzero(raised)) for turned, raised in found]

    @property
    def circles(self) -> tuple[bool, ...]:
        """Of each unknown, whether the equations are the same after a full turn: not where half of it turns a line."""
        lines = [s.line for s in self._pulling if s.line is not None]
        return tuple(c and not any(line.twice[k] % 2 for line in lines) for k, c in enumerate(self.form.is_circle))

    def _waves(self, at: Sequence[arb]) -> arb_mat:
        waves = {}
        for turned, multiples in self._turned.items():
            angle = _ZERO
            for k, multiple in multiples:
                angle = angle + (at[k] if multiple == 1 else multiple * at[k])
            sine, cosine = angle.sin_cos()
            waves[turned] = cosine, sine
        column = []
        for turned, exponents in self._columns:
            cosine, sine = waves.get(turned, (_ONE, _ZERO))
            for k, exponent in exponents:
                factor = power(at[k], exponent)
                cosine, sine = cosine * factor, sine * factor
            column += [cosine, sine]
        return arb_mat(len(column), 1, column)

    def __call__(self, at: Sequence[arb]) -> BallJet:
        """At all configurations in a box."""
        n, waves = self.form.size, self._waves(at)
        rows = self._first(waves)
        smooth, place = rows[:n], n
        values, cones, ahead = list(smooth), list[ConeBalls](), list[arb]()
        length = 2 + (4 if self.form.closing else 2) * n
        for number, pulling in enumerate(self._pulling):
            line = None if pulling.line is None else pulling.line.at(at)
            new = _spring(number, pulling, rows[place : place + length], n, line)
            if line is not None:
                ahead.append(line.unit[0] * rows[place] + line.unit[1] * rows[place + 1])
            for k in new.shape.equations:
                values[k] = values[k] - new.part[k]
            cones.append(new)
            place += length
        conditions = [*ahead, *rows[place:]]
        jet = BallJet(values, smooth, tuple(cones), conditions, partial(self._derivatives, waves))
        if self._with_determinant:
            ordered = [[row[k] for k in self.form.closing] for row in jet.jacobian]
            conditions.append(arb(0, inf) if jet.short else determinant(ordered))
        return jet


class _Pulling(NamedTuple):
    """Of a spring with a free length what is the same in all boxes: its pull, where its parts are, and its line."""

    pull: arb
    shape: _Shape
    line: _Pointed | None


class _Rows:
    """Sums of waves at given parameters, as a matrix by the waves, in which those of no wave have no row."""

    def __init__(self, rows: Sequence[Waves], waves: Sequence[tuple[Multi, Multi]], values: Mapping[str, arb]):
        self._number, self._places = len(rows), [n for n, row in enumerate(rows) if row]
        columns = {key: 2 * k for k, key in enumerate(waves)}
        entries = [_ZERO] * (len(self._places) * 2 * len(waves))
        for n, place in enumerate(self._places):
            for (turned, raised, sine), terms in rows[place].items():
                entries[n * 2 * len(waves) + columns[turned, raised] + sine] = ball(terms, values)
        self._matrix = arb_mat(len(self._places), 2 * len(waves), entries)

    def __call__(self, waves: arb_mat) -> list[arb]:
        """The sums where the cosines and sines of the waves are these."""
        found = [_ZERO] * self._number
        for place, value in zip(self._places, (self._matrix * waves).entries(), strict=True):
            found[place] = value
        return found


def _nonzero(numbers: Sequence[int]) -> list[tuple[int, int]]:
    """The numbers that are not zero, each after its place."""
    return [(k, number) for k, number in enumerate(numbers) if number]


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


def _pointed(cone: SpringCone, values: Mapping[str, arb], side: int) -> _Pointed:
    """The direction of a spring on one line before that turns."""
    line = cone.line
    assert line is not None
    x, y = (side * ball(terms, values) for terms in line.vector)
    squared = square(x) + square(y)
    if not squared > 0:
        raise Unproved(f"the line of spring {cone.name} may have no direction")
    return _Pointed((x / squared.sqrt(), y / squared.sqrt()), line.twice)


def _shape(form: Form, cone: SpringCone) -> _Shape:
    n = form.size
    turned = [cone.line is not None or any(pair) for pair in cone.slopes]
    equations = tuple(i for i in range(n) if any(cone.weights[i]))
    entries = tuple(
        (i, j)
        for i in range(n)
        for j in range(0 if form.closing else i, n)
        if (i in equations and turned[j]) or any(cone.bends[i * n + j])
    )
    return _Shape(equations, entries)


def _spring(number: int, pulling: _Pulling, rows: list[arb], n: int, line: _Pointed | None) -> ConeBalls:
    """A spring from its vector, n slopes, and with closed loops n weights.

    Parameters
    ----------
    line : its direction, where it is on one line: then it turns as that does.
    """
    (a, b), *pairs = zip(rows[::2], rows[1::2], strict=True)
    pull, shape, slopes = pulling.pull, pulling.shape, tuple(pairs[:n])
    weights = tuple(pairs[n:]) or slopes
    q, part = square(a) + square(b), [_ZERO] * n
    turns = None
    if line is not None:
        turns = _Turns(line.unit, _ONE, line.spins)
    elif q > 0:
        inverse = q.rsqrt()
        turns = _Turns((unit(a * inverse), unit(b * inverse)), inverse, None)
    for i in shape.equations:
        x, y = weights[i]
        part[i] = pull * (_ANY * size(x, y) if turns is None else turns.unit[0] * x + turns.unit[1] * y)
    return ConeBalls(number, pull, q, slopes, weights, part, turns, shape)


def _take_off(jacobian: Matrix, s: ConeBalls, turns: _Turns, bends: Sequence[Vector]) -> None:
    """Take a spring's part off the Jacobian."""
    n, (u, v) = len(jacobian), turns.unit
    is_gradient = s.weights is s.slopes
    for i, j in s.shape.entries:
        (gx, gy), (wx, wy), (across, up) = s.slopes[j], s.weights[i], bends[i * n + j]
        cross = turns.spins[j] if turns.spins else u * gy - v * gx
        is_square = is_gradient and i == j and not turns.spins
        turning = square(cross) if is_square else (u * wy - v * wx) * cross
        entry = s.pull * (turning * turns.inverse + u * across + v * up)
        jacobian[i][j] = jacobian[i][j] - entry
        if is_gradient and i != j:
            jacobian[j][i] = jacobian[j][i] - entry


_ZERO, _ONE = arb(0), arb(1)


def size(x: arb, y: arb) -> arb:
    """An upper bound of a vector's length."""
    a, b = x.abs_upper(), y.abs_upper()
    return (a * a + b * b).sqrt().upper()


def unit(value: arb) -> arb:
    """A ball for a number that is known to lie from -1 to 1, given one ball for it."""
    return value if value.rad() < 1 else _ANY


__all__ = ["BallEquations", "BallJet", "ConeBalls", "Matrix", "size"]
