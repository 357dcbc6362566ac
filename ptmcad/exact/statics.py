"""The statics of one equilibrium: its geometry, spring forces, energy and stiffness as exact numbers, then as a pose.

Guarantee: a number that is rational is given exactly (so what is zero is known to be zero), and every other one is
enclosed so narrowly that the digits asked for are settled. A number is found to be rational by algebra, never by its
enclosure: cosines, sines, coordinates, squared lengths and the energy are elements of the real field of the solution;
an eigenvalue is a root of a quadratic over it; and an angle is a rational number of radians only when it is zero
(Lindemann), of degrees only when its cosine is that of a root of unity.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import gcd

from flint import arb, ctx, fmpq

from ptmcad.algebra.number_field import Element
from ptmcad.algebra.points import RealPoint, value_at
from ptmcad.answer.poses import Pose, Spring, TorsionSpring, Vector
from ptmcad.exact.models.system import RationalPolynomial
from ptmcad.exact.stiffness import Number, Stiffness, eigenvalues, square_root, stiffness_of
from ptmcad.model.elements import second_bar
from ptmcad.text.balls import ball_of
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.flint_numbers import from_fraction

MAX_BITS = 2**22
"""Parameters of a thousand digits need a hundredth of them: a number that is still open is rational unnoticed."""
_MIN_ORDER = 42
"""Orders of roots of unity that are tried at least: up to degree 6 a field has cosines of no others."""


@dataclass(frozen=True, slots=True)
class PointModel:
    """A mechanism or system at rational values of its parameters: polynomials in the coordinates of the unknowns.

    Attributes
    ----------
    angles : their number; their cosines and sines are the first coordinates.
    springs : name, ends and stiffness of each.
    potential : None where there is none.
    jacobian : of a potential its Hessian.
    inequalities, stability : the system's.
    torsion : name and stiffness of each torsion spring.
    deflections : cosine and sine of their angles, each less the one at rest.
    energy : of springs and loads, where there is no Hessian: with closed loops.
    second_bars : of X-joints: number of the first bar's angle, the bars' length, the base's. Nodes, energy and
        deflections are polynomials in their cosines and sines too, which stand after those of the unknown angles.
    """

    angles: int
    springs: tuple[tuple[str, str, str, Fraction], ...]
    nodes: Mapping[str, tuple[RationalPolynomial, RationalPolynomial]]
    potential: RationalPolynomial | None
    jacobian: tuple[tuple[RationalPolynomial, ...], ...]
    inequalities: tuple[RationalPolynomial, ...] = ()
    stability: tuple[RationalPolynomial, ...] = ()
    torsion: tuple[tuple[str, Fraction], ...] = ()
    deflections: tuple[tuple[RationalPolynomial, RationalPolynomial], ...] = ()
    energy: RationalPolynomial | None = None
    second_bars: tuple[tuple[int, fmpq, fmpq], ...] = ()


@dataclass(frozen=True, slots=True)
class State:
    """One solution in exact numbers: elements of one real field.

    Attributes
    ----------
    unknowns : cosine and sine of each angle, then the real unknowns.
    nodes : coordinates x, y of each node.
    squares : the springs' lengths squared.
    energy : the potential; None where there is none.
    conditions : the values of inequalities and stability conditions.
    deflections : cosine and sine of each torsion spring's.
    """

    point: RealPoint
    unknowns: tuple[Element, ...]
    nodes: Mapping[str, tuple[Element, Element]]
    squares: tuple[Element, ...]
    energy: Element | None
    stiffness: Stiffness
    conditions: tuple[Element, ...]
    deflections: tuple[tuple[Element, Element], ...] = ()

    def conjugate(self, point: RealPoint) -> State:
        """The solution at another root of the same polynomial: the same residues."""
        field = point.field

        def moved(element: Element) -> Element:
            return element.conjugate(field)

        def moved_or_none(element: Element | None) -> Element | None:
            return None if element is None else element.conjugate(field)

        stiffness = self.stiffness
        return State(
            point,
            point.unknowns,
            {name: (moved(x), moved(y)) for name, (x, y) in self.nodes.items()},
            tuple(map(moved, self.squares)),
            moved_or_none(self.energy),
            stiffness._replace(
                matrix=tuple(tuple(map(moved, row)) for row in stiffness.matrix),
                trace=moved_or_none(stiffness.trace),
                spread=moved_or_none(stiffness.spread),
            ),
            tuple(map(moved, self.conditions)),
            tuple((moved(cosine), moved(sine)) for cosine, sine in self.deflections),
        )


def state_at(model: PointModel, point: RealPoint) -> State:
    """The solution at a real point of the fibre.

    Raises
    ------
    ArithmeticError
        When the Jacobian is singular at a simple point or regular at a multiple one.
    """
    whole = _with_second_bars(model, point)
    nodes = {name: (value_at(whole, x), value_at(whole, y)) for name, (x, y) in model.nodes.items()}
    squares = []
    for _, start, end, _ in model.springs:
        dx, dy = (nodes[end][i] - nodes[start][i] for i in (0, 1))
        squares.append(dx * dx + dy * dy)
    matrix = tuple(tuple(value_at(point, entry) for entry in row) for row in model.jacobian)
    stiffness = stiffness_of(matrix, model.potential is not None)
    if bool(stiffness.nullity) != (point.multiplicity > 1):
        raise ArithmeticError(f"a point of multiplicity {point.multiplicity} contradicts its Jacobian")
    potential = model.energy if model.potential is None else model.potential
    energy = None if potential is None else value_at(whole, potential)
    conditions = tuple(value_at(point, p) for p in (*model.inequalities, *model.stability))
    deflections = tuple((value_at(whole, cosine), value_at(whole, sine)) for cosine, sine in model.deflections)
    return State(point, point.unknowns, nodes, tuple(squares), energy, stiffness, conditions, deflections)


def _with_second_bars(model: PointModel, point: RealPoint) -> RealPoint:
    """The point with the cosines and sines of X-joints' second bars after those of the unknown angles."""
    turns = list(point.unknowns[: 2 * model.angles])
    for number, bars, length in model.second_bars:
        far, near = point.field.constant(bars), point.field.constant(length)
        cosine, sine, below = second_bar(far, near, *turns[2 * number : 2 * number + 2])
        inverse = below.inverse()
        turns += [cosine * inverse, sine * inverse]
    return replace(point, unknowns=(*turns, *point.unknowns[2 * model.angles :]))


def is_positive(element: Element) -> bool:
    """Whether a number is greater than zero, decided exactly."""
    if element.is_zero:
        return False
    bits = 64
    while True:
        with ctx.workprec(bits):
            ball = element.ball(element.field.evaluation())
            if not ball.contains(0):
                return bool(ball > 0)
        bits *= 2


def pose_of(model: PointModel, state: State, digits: int) -> tuple[Pose, int]:
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


def _numbers(model: PointModel, state: State) -> Iterator[Number]:
    """The numbers of a pose at the context's precision, in the order in which `_assembled` takes them."""
    at = state.point.field.evaluation()

    def number(element: Element) -> Number:
        exact = element.rational
        return Number(exact, element.ball(at) if exact is None else ball_of(exact))

    yield from map(number, state.unknowns)
    for k in range(model.angles):
        cosine, sine = state.unknowns[2 * k : 2 * k + 2]
        angle = _angle(number(cosine), number(sine))
        yield angle
        yield _degrees(angle, cosine)
    for x, y in state.nodes.values():
        yield number(x)
        yield number(y)
    for (*_, stiffness), square in zip(model.springs, state.squares, strict=True):
        length = square_root(number(square))
        yield length
        yield Number(None if length.exact is None else stiffness * length.exact, length.ball * ball_of(stiffness))
    for (_, stiffness), (cosine, sine) in zip(model.torsion, state.deflections, strict=True):
        angle = _angle(number(cosine), number(sine))
        yield angle
        yield _degrees(angle, cosine)
        yield number(sine.times(from_fraction(stiffness)))
    if state.energy is not None:
        yield number(state.energy)
    if model.potential is not None:
        yield from eigenvalues(state.stiffness, number)


def _angle(cosine: Number, sine: Number) -> Number:
    """The angle in (-pi, pi]."""
    if sine.exact != 0:
        return Number(None, arb.atan2(sine.ball, cosine.ball))
    return Number(Fraction(0), arb(0)) if cosine.exact == 1 else Number(None, arb.pi())


def _degrees(angle: Number, cosine: Element) -> Number:
    """The angle in degrees; it is exact when it is rational, that is when cos + i sin is a root of unity."""
    if angle.exact is not None:
        return angle
    if cosine.rational == -1:
        return Number(Fraction(180), arb(180))
    turns = angle.ball / (2 * arb.pi())
    if turns.rel_accuracy_bits() < ctx.prec // 2:
        return Number(None, arb.nan())  # a wide ball holds many fractions, and each is tried by algebra
    # a field of degree d has cosines of those of totient at most 2d, and n is at most twice its totient's square
    degree = cosine.field.modulus.degree
    for order in range(3, (_MIN_ORDER if degree <= 6 else 8 * degree**2) + 1):
        number = (turns * order).unique_fmpz()
        # other fractions are in lowest terms with a smaller order, and 0 and 1/2 are where the sine is zero
        if number is not None and gcd(int(number), order) == 1 and _chebyshev(order, cosine).rational == 1:
            return Number(Fraction(360 * int(number), order), turns * 360)
    return Number(None, turns * 360)


def _chebyshev(order: int, cosine: Element) -> Element:
    """cos(order * angle)."""
    last, this = cosine.field.constant(fmpq(1)), cosine
    for _ in range(order - 1):
        last, this = this, (cosine * this).times(fmpq(2)) - last
    return this


def _assembled(model: PointModel, state: State, numbers: Iterator[Enclosure]) -> Pose:
    """The pose from its numbers in the order of `_numbers`."""
    unknowns = tuple(next(numbers) for _ in state.unknowns)
    turns = [(next(numbers), next(numbers)) for _ in range(model.angles)]
    nodes: dict[str, Vector] = {name: (next(numbers), next(numbers)) for name in state.nodes}
    springs = tuple(
        Spring(name, start, end, stiffness, next(numbers), next(numbers))
        for name, start, end, stiffness in model.springs
    )
    torsion = tuple(
        TorsionSpring(name, stiffness, next(numbers), next(numbers), next(numbers)) for name, stiffness in model.torsion
    )
    energy = None if state.energy is None else next(numbers)
    values = tuple(numbers)
    multiplicity = state.point.multiplicity
    index = stable = None
    if multiplicity == 1 and model.potential is not None:
        index = sum(value.high < 0 for value in values)
        stable = index == 0
    elif multiplicity == 1 and model.stability:
        stable = all(map(is_positive, state.conditions[len(model.inequalities) :]))
    return Pose(
        angles=tuple(radians for radians, _ in turns),
        degrees=tuple(degrees for _, degrees in turns),
        cosines_sines=unknowns[: 2 * model.angles],
        nodes=nodes,
        springs=springs,
        energy=energy,
        eigenvalues=values,
        multiplicity=multiplicity,
        index=index,
        stable=stable,
        flat=bool(state.nodes) and all(y.is_zero for _, y in state.nodes.values()),
        reals=unknowns[2 * model.angles :],
        torsion=torsion,
    )
