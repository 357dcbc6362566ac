"""What solutions of a model satisfy, derived here once more from its description.

That is the potential of a mechanism from its points, springs and loads, or what the record of a system lists.

Guarantee: nothing is taken from what the engines derive; the description's trees are read here by a walk of its own, in
whatever numbers or polynomials the caller has for parameters, real unknowns, cosines and sines. Springs have no free
length, unless their lengths are asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import prod
from typing import Any, NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from ptmcad.model import ClosedMechanism, Kind, Mechanism, Model, System
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.tree import Call, Chain, Name, Negative, Number, Power, Tree, names_of
from ptmcad.verification import loops, xjoints


def parameters_of(model: Model) -> tuple[str, ...]:
    """The parameters of a model's polynomials: no free lengths of springs, which would bring in roots."""
    return model.without_free_lengths if isinstance(model, Mechanism | ClosedMechanism) else model.variables


def shorthands_of(model: Model) -> tuple[str, ...]:
    """The parameters that a slice may name beside what they stand for."""
    return tuple(name for name in model.shorthands if model.kind(name) is not Kind.FREE_LENGTH)


def coordinates_of(model: Model) -> tuple[str, ...]:
    """The coordinates of the unknowns, as the exact engine names them: those of the angles come first."""
    return tuple(f"{function}_{angle}" for angle in model.angles for function in ("cos", "sin")) + model.reals


class Formulas(NamedTuple):
    """What solutions of a model satisfy.

    Attributes
    ----------
    energy : whose derivatives by the angles and the real unknowns, less the moments, are zero at a solution; None where
        there are equations.
    equations : each zero at a solution; none where there is an energy.
    inequalities, stability : positive at a solution that counts, and at a stable one.
    moments : generalised forces on the angles and the real unknowns; they may depend on these (`has_index`).
    """

    energy: Any | None
    equations: tuple[Any, ...] = ()
    inequalities: tuple[Any, ...] = ()
    stability: tuple[Any, ...] = ()
    moments: tuple[Any, ...] = ()

    def moment(self, k: int) -> Any:
        """The generalised force on the unknown number k, angles first."""
        return self.moments[k] if self.moments else fmpq(0)


def has_index(model: Model) -> bool:
    """Whether solutions are critical points, near each of a function, so that the matrix of derivatives is a Hessian.

    A moment that no unknown but its own is in is the slope of such a function; with one that depends on another unknown
    nothing may be stored of indices and of what is stable.
    """
    if isinstance(model, System):
        return model.potential is not None
    assert isinstance(model, Mechanism)
    unknowns = {*model.angles, *model.reals}
    return all(unknowns.intersection(names_of(tree)) <= {unknown} for unknown, tree in model.moments)


def tells_stability(model: Model) -> bool:
    """Whether it is known what a stable solution is."""
    return has_index(model) or (isinstance(model, System) and bool(model.stability))


@dataclass(frozen=True, slots=True)
class Configuration:
    """Values of parameters and real unknowns, and cosine and sine of each angle, in numbers that can be added and
    multiplied together.
    """

    parameters: Mapping[str, Any]
    circles: Mapping[str, tuple[Any, Any]]

    def value(self, tree: Tree) -> Any:
        """The value of a tree of the description."""
        match tree:
            case Number(number):
                return from_fraction(number)
            case Name(name):
                return self.parameters[name]
            case Negative(operand):
                return -self.value(operand)
            case Chain(first, steps):
                total = self.value(first)
                for step in steps:
                    one = self.value(step.operand)
                    match step.operator:
                        case "+":
                            total = total + one
                        case "-":
                            total = total - one
                        case "*":
                            total = total * one
                        case _:
                            total = total * (1 / one)
                return total
            case Power(base, exponent):
                number = self.value(base)
                return prod([number] * int(self.value(exponent)), start=fmpq(1))
            case Call(function, argument):
                return self.circle(argument)[0 if function == "cos" else 1]

    def circle(self, argument: Tree) -> tuple[Any, Any]:
        """Cosine and sine of a sum of multiples of angles."""
        if isinstance(argument, Name):
            return self.circles[argument.name]
        cosine, sine = fmpq(1), fmpq(0)
        for angle, multiple in _multiples(argument).items():
            if multiple.denominator != 1 or (multiple and not angle):
                raise NotImplementedError("the checker knows sums of whole multiples of angles, such as 2*a - b, only")
            if not angle:
                continue
            c, s = self.circles[angle]
            for _ in range(abs(int(multiple))):
                turned = s if multiple > 0 else -s
                cosine, sine = cosine * c - sine * turned, sine * c + cosine * turned
        return cosine, sine

    def points(self, mechanism: Mechanism) -> dict[str, tuple[Any, Any]]:
        """The coordinates of all points."""
        return {name: (self.value(x), self.value(y)) for name, (x, y) in mechanism.points.items()}


def formulas(configuration: Configuration, model: Model) -> Formulas:
    """What solutions satisfy, in the configuration's numbers."""
    if isinstance(model, Mechanism):
        return Formulas(potential(configuration, model), moments=_moments(configuration, model))
    assert isinstance(model, System)
    if isinstance(model, ClosedMechanism):
        return _with_loops(configuration, model)
    value = configuration.value
    return Formulas(
        None if model.potential is None else value(model.potential),
        tuple(map(value, model.equations)),
        tuple(map(value, model.inequalities)),
        tuple(map(value, model.stability)),
    )


def _moving(configuration: Configuration, model: ClosedMechanism) -> Configuration:
    """The same with derivatives by the unknowns, angles first."""
    size = len(model.unknowns)
    values = {name: loops.constant(value, size) for name, value in configuration.parameters.items()}
    for k, name in enumerate(model.reals, len(model.angles)):
        values[name] = loops.line(k, configuration.parameters[name], size)
    circles = {a: loops.circle(k, *configuration.circles[a], size) for k, a in enumerate(model.angles)}
    return Configuration(values, circles)


def along_loops(configuration: Configuration, model: ClosedMechanism) -> list[tuple[Any, Any]]:
    """Of each spring's vector the derivative along closed loops with one degree of freedom left."""
    moving, nothing = _moving(configuration, model), loops.constant(fmpq(0), len(model.unknowns))
    points = moving.points(model.mechanism)
    kept = loops.distances(model.mechanism, points, moving.value)
    found = []
    for spring in model.mechanism.springs:
        vector = [points[spring.end][i] - points[spring.start][i] + nothing for i in (0, 1)]
        across, up = loops.turned(kept, vector)
        found.append((across, up))
    return found


def _with_loops(configuration: Configuration, model: ClosedMechanism) -> Formulas:
    """Of a mechanism with closed loops, from the mechanism itself."""
    size, moving = len(model.unknowns), _moving(configuration, model)
    if model.mechanism.xjoints:
        return _with_xjoints(moving, model)
    if model.multipliers:
        return _stationary(moving, model)
    equations, stability = loops.conditions(
        model.mechanism,
        potential(moving, model.mechanism) + loops.constant(fmpq(0), size),
        moving.points(model.mechanism),
        moving.value,
        [m + loops.constant(fmpq(0), size) for m in _moments(moving, model.mechanism)],
    )
    return Formulas(None, equations, (), (stability,))


def _stationary(moving: Configuration, model: ClosedMechanism) -> Formulas:
    """With a tension for each closing bar."""
    nothing = loops.constant(fmpq(0), len(model.unknowns))
    equations, stability = loops.stationary(
        model.mechanism,
        potential(moving, model.mechanism) + nothing,
        moving.points(model.mechanism),
        moving.value,
        [moving.parameters[name] for name in model.multipliers],
        [m + nothing for m in _moments(moving, model.mechanism)],
    )
    return Formulas(None, equations, (), stability)


def _with_xjoints(first: Configuration, model: ClosedMechanism) -> Formulas:
    """Of a mechanism with X-joints, from the mechanism itself; the first bars' angles are known."""
    mechanism, joints = model.mechanism, model.mechanism.xjoints
    nothing = loops.constant(fmpq(0), len(model.unknowns))
    equations, distances, stability = xjoints.conditions(
        [model.angles.index(joint.angle) for joint in joints],
        _in_units(first, mechanism),
        _powers(mechanism),
        [(first.value(joint.length) + nothing, first.value(joint.bars) + nothing) for joint in joints],
        [first.circles[joint.angle] for joint in joints],
        [m + nothing for m in _moments(first, mechanism)],
    )
    return Formulas(None, equations, distances, stability)


def _in_units(first: Configuration, mechanism: Mechanism) -> xjoints.Units:
    """The energy as a polynomial in the units of the second bars."""
    count = len(mechanism.xjoints)
    none = xjoints.Units({}, count)
    lifted = {a: (none + c, none + s) for a, (c, s) in first.circles.items()}
    second = {joint.other: xjoints.unit_circle(k, count) for k, joint in enumerate(mechanism.xjoints)}
    known = {name: none + value for name, value in first.parameters.items()}
    energy: Any = potential(Configuration(known, lifted | second), mechanism)
    found: xjoints.Units = none + energy
    return found


@lru_cache(maxsize=8)
def _powers(mechanism: Mechanism) -> tuple[int, ...]:
    """Of the units in the energy, with a variable for everything else."""
    names = (*parameters_of(mechanism), *coordinates_of(mechanism))
    ring: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(names, Ordering.lex)
    known = {name: ring.gen(k) for k, name in enumerate(names)}
    circles = {a: (known[f"cos_{a}"], known[f"sin_{a}"]) for a in mechanism.angles}
    return xjoints.powers_in(_in_units(Configuration(known, circles), mechanism))


def _moments(configuration: Configuration, mechanism: Mechanism) -> tuple[Any, ...]:
    """The generalised forces on the unknowns; none where the description has none."""
    if not mechanism.moments:
        return ()
    unknowns = mechanism.angles + mechanism.reals
    total: list[Any] = [fmpq(0)] * len(unknowns)
    for unknown, tree in mechanism.moments:
        k = unknowns.index(unknown)
        total[k] = total[k] + configuration.value(tree)
    return tuple(total)


def potential(configuration: Configuration, mechanism: Mechanism, length: Callable[[Any], Any] | None = None) -> Any:
    """Half the stiffness times the squared length of each spring, without free lengths, less the work of the loads.

    Parameters
    ----------
    length : the length by its square; if it is given, lengths are those beyond the free lengths.
    """
    points = configuration.points(mechanism)
    energy: Any = fmpq(0)
    for load in mechanism.loads:
        for force, coordinate in zip((load.x, load.y), points[load.point], strict=True):
            energy = energy - coordinate * configuration.value(force)
    for spring in mechanism.springs:
        across, up = (points[spring.end][i] - points[spring.start][i] for i in (0, 1))
        square = across * across + up * up
        if length is not None:
            stretch = length(square) - configuration.value(spring.free)
            square = stretch * stretch
        energy = energy + square * (configuration.value(spring.stiffness) * fmpq(1, 2))
    for torsion in mechanism.torsion:
        cosine, sine = configuration.circle(torsion.angle)
        at_rest = [from_fraction(value) for value in torsion.rest]
        difference = cosine * at_rest[0] + sine * at_rest[1]
        energy = energy + configuration.value(torsion.stiffness) * (fmpq(1) - difference)
    return energy


def _multiples(tree: Tree) -> dict[str, Fraction]:
    """The angles of a sum, each with its factor; what is no multiple of an angle has the empty name."""
    match tree:
        case Number(number):
            return {"": number}
        case Name(name):
            return {name: Fraction(1)}
        case Negative(operand):
            return {name: -multiple for name, multiple in _multiples(operand).items()}
        case Chain(first, steps):
            total = _multiples(first)
            for step in steps:
                total = _joined(total, step.operator, _multiples(step.operand))
            return total
        case Power(base, exponent):
            return {"": _number(_multiples(base)) ** int(_number(_multiples(exponent)))}
        case Call():
            raise NotImplementedError("the checker knows no angle that is a cosine or sine")


def _joined(left: dict[str, Fraction], operator: str, right: dict[str, Fraction]) -> dict[str, Fraction]:
    if operator in "+-":
        sign = 1 if operator == "+" else -1
        return left | {name: left.get(name, Fraction(0)) + sign * multiple for name, multiple in right.items()}
    if operator == "*" and left.keys() == {""}:
        left, right = right, left
    factor = _number(right) if operator == "*" else 1 / _number(right)
    return {name: multiple * factor for name, multiple in left.items()}


def _number(multiples: dict[str, Fraction]) -> Fraction:
    if multiples.keys() != {""}:
        raise NotImplementedError("the checker knows no products of angles")
    return multiples[""]
