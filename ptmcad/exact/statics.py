"""The statics of one equilibrium: its geometry, spring forces, energy and stiffness as exact
numbers, then as a pose.

Guarantee: a number that is rational is given exactly (so what is zero is known to be zero), and
every other one is enclosed so narrowly that the digits asked for are settled. A number is found to
be rational by algebra, never by its enclosure: cosines, sines, coordinates, squared lengths and the
energy are elements of the real field of the solution; an eigenvalue is a root of a polynomial over
it; and an angle is a rational number of radians only when it is zero (Lindemann), of degrees, as
far as that is looked for, where the square of its cosine is rational.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Any, NamedTuple

from flint import arb, ctx, fmpq

from ptmcad.algebra.number_field import FieldElement, RealPoint, value_at
from ptmcad.algebra.polynomials import Values
from ptmcad.answer.poses import Pose, springs_of
from ptmcad.exact.point_system import PointSystem
from ptmcad.exact.stiffness import RealNumber, Stiffness, eigenvalues, square_root, stiffness_of
from ptmcad.formulas.evaluation import evaluated, values
from ptmcad.model.compile import CompiledSystem
from ptmcad.model.criterion import Criterion
from ptmcad.text.balls import ball_of
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.flint_numbers import from_fraction

MAX_BITS = 2**22
"""Parameters of a thousand digits need a hundredth of them: a number that is still open is rational
unnoticed.
"""
_OPEN = Enclosure(Fraction(0), Fraction(0))
"""Stands for the enclosure of a number that is not settled, in a pose that nobody is given."""
_COMMON_DEGREES = 15
"""Of which 0, 30, 45, 60 and 90 degrees are multiples."""


class Quantities(NamedTuple):
    """What a pose lists, as formulas of a compiled model, or as elements of a solution's field in
    their place.

    Attributes
    ----------
    turns : cosine and sine of each unknown angle.
    energy : of springs and loads, or the potential; None where there is none.
    """

    turns: tuple[tuple[Any, Any], ...]
    reals: tuple[Any, ...]
    points: Mapping[str, tuple[Any, Any]]
    elastic: tuple[tuple[Any, ...], tuple[Any, ...]]
    energy: Any

    @classmethod
    def of(cls, known: CompiledSystem) -> Quantities:
        """As formulas."""
        angles, reals = (
            tuple(map(known.graph.variable, numbers)) for numbers in (known.angles, known.reals)
        )
        energy = known.smooth if known.has_energy else None
        return cls(
            tuple((a.cos(), a.sin()) for a in angles), reals, known.points, known.elastic, energy
        )


class _AtSolution:
    """Elements of a solution's field, as an arithmetic for formulas; parameters have values."""

    def __init__(self, known: CompiledSystem, parameters: Values, point: RealPoint) -> None:
        self._names, self._parameters, self._field = known.names, parameters, point.field
        unknowns = iter(point.unknowns)
        self._turned = {number: (next(unknowns), next(unknowns)) for number in known.angles}
        self._reals = dict(zip(known.reals, unknowns, strict=True))
        for follower in known.followers:
            cosine, sine, below = values((follower.cosine, follower.sine, follower.below), self)
            inverse = below.inverse()
            self._turned[follower.variable] = (cosine * inverse, sine * inverse)

    def constant(self, value: Fraction) -> FieldElement:
        return self._field.constant(from_fraction(value))

    def variable(self, number: int) -> FieldElement:
        if number in self._reals:
            return self._reals[number]
        return self._field.constant(self._parameters[self._names[number]])

    def cos(self, number: int) -> FieldElement:
        return self._turned[number][0]

    def sin(self, number: int) -> FieldElement:
        return self._turned[number][1]


@dataclass(frozen=True, slots=True)
class ExactSolution:
    """One solution in exact numbers: elements of one real field, which those at other roots of its
    polynomial share.

    Attributes
    ----------
    inequalities, stability : the conditions' values.
    """

    point: RealPoint
    quantities: Quantities
    stiffness: Stiffness
    inequalities: tuple[FieldElement, ...]
    stability: tuple[FieldElement, ...]
    criterion: Criterion

    def all_positive(self, conditions: Iterable[FieldElement]) -> bool:
        """Whether all of these numbers of the field are greater than zero at this solution, decided
        exactly.
        """
        return all(sign_of(condition.conjugate(self.point.field)) > 0 for condition in conditions)


def solution_at(
    known: CompiledSystem, system: PointSystem, parameters: Values, point: RealPoint
) -> ExactSolution:
    """The solution at a real point of the fibre.

    Parameters
    ----------
    system : the model's at the values of its parameters.

    Raises
    ------
    ArithmeticError
        When the Jacobian is singular at a simple point or regular at a multiple one.
    """

    def at(p: Mapping[tuple[int, ...], fmpq]) -> FieldElement:
        return value_at(point, p)

    jacobian = tuple(tuple(map(at, row)) for row in system.jacobian)
    stiffness = stiffness_of(jacobian, jacobian[: known.criterion.order])
    if bool(stiffness.nullity) != (point.multiplicity > 1):
        raise ArithmeticError(
            f"a point of multiplicity {point.multiplicity} contradicts its Jacobian"
        )
    quantities = evaluated(Quantities.of(known), _AtSolution(known, parameters, point))
    inequalities, stability = (
        tuple(map(at, some)) for some in (system.inequalities, system.stability)
    )
    return ExactSolution(point, quantities, stiffness, inequalities, stability, known.criterion)


def sign_of(element: FieldElement) -> int:
    """-1, 0 or 1, decided exactly."""
    if element.is_zero:
        return 0
    bits = 64
    while True:
        with ctx.workprec(bits):
            ball = element.ball(element.field.evaluation())
            if not ball.contains(0):
                return 1 if ball > 0 else -1
        bits *= 2


def pose_of(solution: ExactSolution, digits: int) -> tuple[Pose, int]:
    """The pose with all numbers settled to so many digits, and the bits that this took.

    Raises
    ------
    ArithmeticError
        When `MAX_BITS` do not settle a number, which would be a fault of this program.
    """
    bits = 64 + 4 * digits
    known: dict[int, Enclosure] = {}  # by their order in a pose; what is settled stays as it is
    while True:
        places = count()

        def settled(number: RealNumber, places: Iterator[int] = places) -> Enclosure:
            place = next(places)
            if place not in known and (found := number.enclosure(digits)) is not None:
                known[place] = found
            return known.get(place, _OPEN)

        with ctx.workprec(bits):
            pose = _pose(solution, settled)
        still_open = next(places) - len(known)
        if not still_open:
            return pose, bits
        bits *= 2
        if bits > MAX_BITS:
            raise ArithmeticError(
                f"{still_open} numbers of a pose are not settled by {bits // 2} bits"
            )


def _pose(solution: ExactSolution, settled: Callable[[RealNumber], Enclosure]) -> Pose:
    """The pose at the context's precision."""
    seen, stiffness = solution.quantities, solution.stiffness
    at = solution.point.field.evaluation()

    def number(element: FieldElement) -> RealNumber:
        exact = element.rational
        return RealNumber(exact, element.ball(at) if exact is None else ball_of(exact))

    def enclosed(element: FieldElement) -> Enclosure:
        return settled(number(element))

    def angle(cosine: FieldElement, sine: FieldElement) -> tuple[Enclosure, Enclosure]:
        radians = _angle(number(cosine), number(sine))
        return settled(radians), settled(_degrees(radians, cosine))

    def constant(element: FieldElement) -> Fraction:
        assert element.rational is not None
        return element.rational

    def stretch(spring: Any) -> tuple[Enclosure, Enclosure]:
        force = square_root(
            number(spring.square * spring.density * spring.density)
        )  # without a free length
        return settled(square_root(number(spring.square))), settled(force)

    def turn(spring: Any) -> tuple[Enclosure, ...]:
        return *angle(spring.cosine, spring.sine), enclosed(spring.moment)

    angles = [angle(*turn) for turn in seen.turns]
    eigen, signs = tuple(map(settled, eigenvalues(stiffness, number))), ""
    if solution.point.multiplicity == 1:
        signs = "".join("-" if value.high < 0 else "+" for value in eigen)
        signs = signs or ("+" if solution.all_positive(solution.stability) else "-")
    return Pose(
        angles=tuple(radians for radians, _ in angles),
        degrees=tuple(degrees for _, degrees in angles),
        cosines_sines=tuple(enclosed(x) for turn in seen.turns for x in turn),
        nodes={name: (enclosed(x), enclosed(y)) for name, (x, y) in seen.points.items()},
        energy=None if seen.energy is None else enclosed(seen.energy),
        eigenvalues=eigen,
        multiplicity=solution.point.multiplicity,
        index=solution.criterion.morse_index(signs),
        stable=solution.criterion.is_stable(signs),
        flat=bool(seen.points) and all(y.is_zero for _, y in seen.points.values()),
        reals=tuple(map(enclosed, seen.reals)),
        **springs_of(seen.elastic, constant, stretch, turn),
    )


def _angle(cosine: RealNumber, sine: RealNumber) -> RealNumber:
    """The angle in (-pi, pi]."""
    if sine.exact != 0:
        return RealNumber(None, arb.atan2(sine.ball, cosine.ball))
    return RealNumber(Fraction(0), arb(0)) if cosine.exact == 1 else RealNumber(None, arb.pi())


def _degrees(angle: RealNumber, cosine: FieldElement) -> RealNumber:
    """The angle in degrees; exact where four times the square of the cosine is a whole number.

    That is where both are rational (Niven).
    """
    if angle.exact is not None:
        return angle
    degrees = angle.ball * 180 / arb.pi()
    if (cosine * cosine).times(fmpq(4)).rational not in range(5):
        return RealNumber(None, degrees)
    number = (degrees / _COMMON_DEGREES).unique_fmpz()
    if number is None:
        return RealNumber(None, arb.nan())
    return RealNumber(Fraction(_COMMON_DEGREES * int(number)), degrees)
