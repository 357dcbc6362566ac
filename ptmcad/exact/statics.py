"""The statics of one equilibrium: its geometry, spring forces, energy and stiffness as exact numbers, then as a pose.

Guarantee: a number that is rational is given exactly (so what is zero is known to be zero), and every other one is
enclosed so narrowly that the digits asked for are settled. A number is found to be rational by algebra, never by its
enclosure: cosines, sines, coordinates, squared lengths and the energy are elements of the real field of the solution;
an eigenvalue is a root of a quadratic over it; and an angle is a rational number of radians only when it is zero
(Lindemann), of degrees only when its cosine is that of a root of unity.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, isqrt
from typing import TypeVar

from flint import arb, ctx, fmpq, nmod

from ptmcad.algebra.number_field import Element
from ptmcad.algebra.points import RealPoint, value_at
from ptmcad.algebra.polynomials import to_fraction
from ptmcad.answer.poses import Pose, Spring, Vector
from ptmcad.exact.models.system import RationalPolynomial
from ptmcad.text.balls import ball_of, enclosed
from ptmcad.text.enclosure import Enclosure

_Ring = TypeVar("_Ring", fmpq, nmod)
MAX_BITS = 2**22
"""Parameters of a thousand digits need a hundredth of them: a number that is still open is rational unnoticed."""
_ORDERS = range(3, 43)
"""Orders of roots of unity: a field of degree d has cosines of those with totient at most 2d, and d is at most 6."""


@dataclass(frozen=True, slots=True)
class Model:
    """The mechanism at rational values of its parameters: polynomials in cosines and sines of the angles.

    Attributes
    ----------
    springs : name, ends and stiffness of each.
    hessian : its entries 11, 12 and 22.
    """

    springs: tuple[tuple[str, str, str, Fraction], ...]
    nodes: Mapping[str, tuple[RationalPolynomial, RationalPolynomial]]
    potential: RationalPolynomial
    hessian: tuple[RationalPolynomial, RationalPolynomial, RationalPolynomial]


@dataclass(frozen=True, slots=True)
class State:
    """One equilibrium in exact numbers: elements of one real field.

    Attributes
    ----------
    unknowns : cos th1, sin th1, cos th2, sin th2.
    nodes : coordinates x, y of each node.
    squares : the springs' lengths squared.
    trace, determinant, spread : of the Hessian; the last is the squared difference of its eigenvalues.
    eigenvalue : a rational one, when there is one and the other is irrational, or both are equal.
    """

    point: RealPoint
    unknowns: tuple[Element, ...]
    nodes: Mapping[str, tuple[Element, Element]]
    squares: tuple[Element, ...]
    energy: Element
    trace: Element
    determinant: Element
    spread: Element
    eigenvalue: Fraction | None

    def conjugate(self, point: RealPoint) -> State:
        """The equilibrium at another root of the same polynomial: the same residues."""
        field = point.field
        return State(
            point,
            point.unknowns,
            {name: (x.conjugate(field), y.conjugate(field)) for name, (x, y) in self.nodes.items()},
            tuple(square.conjugate(field) for square in self.squares),
            self.energy.conjugate(field),
            self.trace.conjugate(field),
            self.determinant.conjugate(field),
            self.spread.conjugate(field),
            self.eigenvalue,
        )


@dataclass(frozen=True, slots=True)
class _Number:
    """A number as its exact value where it is rational, and a ball."""

    exact: Fraction | None
    ball: arb

    def enclosure(self, digits: int) -> Enclosure | None:
        if self.exact is not None:
            return Enclosure(self.exact, self.exact)
        return enclosed(self.ball, digits)


def state_at(model: Model, point: RealPoint) -> State:
    """The equilibrium at a real point of the fibre.

    Raises
    ------
    ArithmeticError
        When the Hessian is singular at a simple point or regular at a multiple one.
    """
    nodes = {name: (value_at(point, x), value_at(point, y)) for name, (x, y) in model.nodes.items()}
    squares = []
    for _, start, end, _ in model.springs:
        dx, dy = (nodes[end][i] - nodes[start][i] for i in (0, 1))
        squares.append(dx * dx + dy * dy)
    h11, h12, h22 = (value_at(point, h) for h in model.hessian)
    trace, determinant = h11 + h22, h11 * h22 - h12 * h12
    if determinant.is_zero != (point.multiplicity > 1):
        raise ArithmeticError(f"a point of multiplicity {point.multiplicity} contradicts its Hessian")
    difference = h11 - h22
    spread = difference * difference + (h12 * h12).times(fmpq(4))
    energy = value_at(point, model.potential)
    eigenvalue = _rational_eigenvalue(trace, determinant)
    return State(point, point.unknowns, nodes, tuple(squares), energy, trace, determinant, spread, eigenvalue)


def pose_of(model: Model, state: State, digits: int) -> tuple[Pose, int]:
    """The pose with all numbers settled to so many digits, and the bits that this took.

    Raises
    ------
    ArithmeticError
        When `MAX_BITS` do not settle a number, which would be a fault of this program.
    """
    bits = 64 + 4 * digits
    settled: list[Enclosure | None] = []
    while True:
        with ctx.workprec(bits):
            balls = list(_numbers(model, state))
            # what a lower precision settled stays as it is
            settled = [
                n.enclosure(digits) if known is None else known
                for n, known in zip(balls, settled or [None] * len(balls), strict=True)
            ]
        numbers = [n for n in settled if n is not None]
        if len(numbers) == len(settled):
            return _assembled(model, state, iter(numbers)), bits
        bits *= 2
        if bits > MAX_BITS:
            raise ArithmeticError(
                f"{len(settled) - len(numbers)} numbers of a pose are not settled by {bits // 2} bits"
            )


def _numbers(model: Model, state: State) -> Iterator[_Number]:
    """The numbers of a pose at the context's precision, in the order in which `_assembled` takes them."""
    at = state.point.field.evaluation()

    def number(element: Element) -> _Number:
        exact = element.rational
        return _Number(exact, element.ball(at) if exact is None else ball_of(exact))

    yield from map(number, state.unknowns)
    for cosine, sine in (state.unknowns[:2], state.unknowns[2:]):
        angle = _angle(number(cosine), number(sine))
        yield angle
        yield _degrees(angle, cosine)
    for x, y in state.nodes.values():
        yield number(x)
        yield number(y)
    for (*_, k), square in zip(model.springs, state.squares, strict=True):
        length = _square_root(number(square))
        yield length
        yield _Number(None if length.exact is None else k * length.exact, length.ball * ball_of(k))
    yield number(state.energy)
    yield from _eigenvalues(number(state.trace), number(state.spread), state.eigenvalue)


def _angle(cosine: _Number, sine: _Number) -> _Number:
    """The angle in (-pi, pi]."""
    if sine.exact != 0:
        return _Number(None, arb.atan2(sine.ball, cosine.ball))
    return _Number(Fraction(0), arb(0)) if cosine.exact == 1 else _Number(None, arb.pi())


def _degrees(angle: _Number, cosine: Element) -> _Number:
    """The angle in degrees; it is exact when it is rational, that is when cos + i sin is a root of unity."""
    if angle.exact is not None:
        return angle
    if cosine.rational == -1:
        return _Number(Fraction(180), arb(180))
    turns = angle.ball / (2 * arb.pi())
    if turns.rel_accuracy_bits() < ctx.prec // 2:
        return _Number(None, arb.nan())  # a wide ball holds many fractions, and each is tried by algebra
    for order in _ORDERS:
        number = (turns * order).unique_fmpz()
        # other fractions are in lowest terms with a smaller order, and 0 and 1/2 are where the sine is zero
        if number is not None and gcd(int(number), order) == 1 and _chebyshev(order, cosine).rational == 1:
            return _Number(Fraction(360 * int(number), order), turns * 360)
    return _Number(None, turns * 360)


def _chebyshev(order: int, cosine: Element) -> Element:
    """cos(order * angle)."""
    last, this = cosine.field.constant(fmpq(1)), cosine
    for _ in range(order - 1):
        last, this = this, (cosine * this).times(fmpq(2)) - last
    return this


def _square_root(square: _Number) -> _Number:
    if square.exact is None:
        return _Number(None, square.ball.sqrt())
    numerator, denominator = isqrt(square.exact.numerator), isqrt(square.exact.denominator)
    root = Fraction(numerator, denominator)
    return _Number(root if root * root == square.exact else None, ball_of(square.exact).sqrt())


def _rational_eigenvalue(trace_element: Element, determinant_element: Element) -> Fraction | None:
    """A rational eigenvalue of the Hessian when there is one and the other is irrational, or both are equal.

    With coefficients t_i of the trace and d_i of the determinant in powers of the field's generator, q^2 - q trace +
    determinant = 0 says q t_i = d_i for each i > 0, which leaves one candidate unless the trace is rational. In that
    case a rational eigenvalue makes the other one rational too. The equation holds modulo a prime too, q being integral
    over the numbers without that prime in their denominators; so most often residues modulo the prime exclude it.
    """
    t, d = trace_element.image_coefficients(), determinant_element.image_coefficients()
    if t is not None and d is not None and any(t[1:]) and _eigenvalue(t, d) is None:
        return None
    q = _eigenvalue(trace_element.coefficients(), determinant_element.coefficients())
    return None if q is None else to_fraction(q)


def _eigenvalue(trace: Sequence[_Ring], determinant: Sequence[_Ring]) -> _Ring | None:
    """The q of the field's ground ring, when the trace's coefficients behind the first are not all zero."""
    for t, d in zip(trace[1:], determinant[1:], strict=True):
        if t != 0:
            q = d / t
            holds = q * q - q * trace[0] + determinant[0] == 0 and all(
                q * a == b for a, b in zip(trace[1:], determinant[1:], strict=True)
            )
            return q if holds else None
    return None


def _eigenvalues(trace: _Number, spread: _Number, rational: Fraction | None) -> tuple[_Number, _Number]:
    """The Hessian's eigenvalues, the smaller first; a ball that is not finite stands for one not yet known."""
    root = _square_root(spread)
    balls = ((trace.ball - root.ball) / 2, (trace.ball + root.ball) / 2)
    if trace.exact is not None and root.exact is not None:
        return _Number((trace.exact - root.exact) / 2, balls[0]), _Number((trace.exact + root.exact) / 2, balls[1])
    if rational is not None:
        if (excess := 2 * ball_of(rational) - trace.ball) > 0:
            return _Number(None, balls[0]), _Number(rational, balls[1])
        if excess < 0:
            return _Number(rational, balls[0]), _Number(None, balls[1])
        return _Number(None, arb.nan()), _Number(None, arb.nan())
    return _Number(None, balls[0]), _Number(None, balls[1])


def _assembled(model: Model, state: State, numbers: Iterator[Enclosure]) -> Pose:
    """The pose from its numbers in the order of `_numbers`."""
    c1, s1, c2, s2 = (next(numbers) for _ in range(4))
    first, degrees1, second, degrees2 = (next(numbers) for _ in range(4))
    nodes: dict[str, Vector] = {name: (next(numbers), next(numbers)) for name in state.nodes}
    springs = tuple(
        Spring(name, start, end, stiffness, next(numbers), next(numbers))
        for name, start, end, stiffness in model.springs
    )
    energy, low, high = numbers
    multiplicity = state.point.multiplicity
    index = (low.high < 0) + (high.high < 0) if multiplicity == 1 else None
    return Pose(
        angles=(first, second),
        degrees=(degrees1, degrees2),
        cosines_sines=(c1, s1, c2, s2),
        nodes=nodes,
        springs=springs,
        energy=energy,
        eigenvalues=(low, high),
        multiplicity=multiplicity,
        index=index,
        stable=None if index is None else index == 0,
        flat=state.unknowns[1].is_zero and state.unknowns[3].is_zero,
    )
