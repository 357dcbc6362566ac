"""Polynomials over Q in the coordinates of a model's unknowns and in its parameters, trees of
descriptions as such, and their values.

Guarantee: exact for exact numbers and functions. Trees are read by a walk of its own; the
coordinates of an angle are its cosine and its sine. Balls contain the value for each number in the
balls given; a power is no product of balls that have nothing to do with one another, which would
enclose it poorly.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import prod
from typing import Any, Generic, TypeVar

from flint import Ordering, arb, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.text.balls import ball_of
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.tree import OPERATORS, Call, Chain, Name, Negative, Number, Power, Tree, names_of

_SHOWN = 400
Circle = tuple[fmpq_mpoly, fmpq_mpoly]
"""Cosine and sine of an angle."""
R = TypeVar("R", bound=Any)


def circle_names(angle: str) -> tuple[str, str]:
    """The names of an angle's coordinates, which no description has."""
    return f"cos({angle})", f"sin({angle})"


class TreeValues(Generic[R]):
    """A ring in which trees have values."""

    def constant(self, value: Fraction) -> R:
        raise NotImplementedError

    def named(self, name: str) -> R:
        raise NotImplementedError

    def circle_of(self, angle: str) -> tuple[R, R]:
        """Cosine and sine of an angle."""
        raise NotImplementedError

    def root(self, square: R, tree: Tree) -> R:
        """The value of a root, given that of its argument."""
        raise NotImplementedError("the checker knows no roots")

    def value(self, tree: Tree) -> R:
        """What a tree of the description is."""
        match tree:
            case Number(number):
                return self.constant(number)
            case Name(name):
                return self.named(name)
            case Negative(operand):
                opposite: R = -self.value(operand)
                return opposite
            case Chain(first, steps):
                total = self.value(first)
                for step in steps:
                    total = OPERATORS[step.operator](total, self.value(step.operand))
                return total
            case Power(base, exponent):
                power: R = self.value(base) ** _whole(exponent)
                return power
            case Call("sqrt", argument):
                return self.root(self.value(argument), tree)
            case Call(function, argument):
                return self.circle(argument)[0 if function == "cos" else 1]

    def circle(self, argument: Tree) -> tuple[R, R]:
        """Cosine and sine of a sum of multiples of angles."""
        cosine, sine = self.constant(Fraction(1)), self.constant(Fraction(0))
        for angle, multiple in multiples(argument).items():
            if multiple.denominator != 1 or (multiple and not angle):
                raise NotImplementedError(
                    "the checker knows sums of whole multiples of angles, such as 2*a - b, only"
                )
            for _ in range(abs(int(multiple))):
                c, s = self.circle_of(angle)
                up = s if multiple > 0 else -s
                cosine, sine = cosine * c - sine * up, sine * c + cosine * up
        return cosine, sine


@dataclass(frozen=True)
class CoordinateRing(TreeValues[fmpq_mpoly]):
    """A ring of polynomials.

    Attributes
    ----------
    names : of the variables, in lexicographic order: of the angles the `circle_names`, of all else
        their own.
    angles : those of which coordinates are variables.
    numbers : of parameters in the place of variables.
    """

    names: tuple[str, ...]
    angles: tuple[str, ...]
    numbers: Mapping[str, fmpq] = field(default_factory=dict)

    @cached_property
    def context(self) -> fmpq_mpoly_ctx:
        """FLINT's ring, whose own names are plain: those of a description may be any."""
        return fmpq_mpoly_ctx.get(tuple(f"x{k}" for k in range(len(self.names))), Ordering.lex)

    @cached_property
    def elements(self) -> Mapping[str, fmpq_mpoly]:
        """What each name stands for."""
        known = {name: self.context.constant(number) for name, number in self.numbers.items()}
        return known | dict(zip(self.names, self.context.gens(), strict=True))

    @cached_property
    def circles(self) -> Mapping[str, Circle]:
        """Cosine and sine of each angle."""
        return {angle: self._circle_of(angle) for angle in self.angles}

    def _circle_of(self, angle: str) -> Circle:
        cosine, sine = (self.elements[name] for name in circle_names(angle))
        return cosine, sine

    @cached_property
    def relations(self) -> tuple[fmpq_mpoly, ...]:
        """What is zero on the circles of the angles."""
        return tuple(c * c + s * s - 1 for c, s in self.circles.values())

    def normal(self, p: fmpq_mpoly) -> fmpq_mpoly:
        """The normal form modulo the circles: at most the first power of each cosine."""
        for relation in self.relations:
            p = divmod(p, relation)[1]
        return p

    def by(self, p: fmpq_mpoly, unknown: str) -> fmpq_mpoly:
        """The derivative by an unknown, also where an angle stands outside of cosines and sines."""
        slope = self.context.constant(0)
        if unknown in self.names:
            slope += p.derivative(self.names.index(unknown))
        if unknown in self.angles:
            (c, s), (across, up) = (
                self.circles[unknown],
                map(self.names.index, circle_names(unknown)),
            )
            slope += c * p.derivative(up) - s * p.derivative(across)
        return slope

    def gradient(self, p: fmpq_mpoly, unknowns: Iterable[str]) -> tuple[fmpq_mpoly, ...]:
        """The derivatives by unknowns."""
        return tuple(self.by(p, unknown) for unknown in unknowns)

    def taken(self, p: fmpq_mpoly, ring: CoordinateRing) -> fmpq_mpoly:
        """A polynomial of another ring, of which this one has all variables that are in it."""
        nothing = self.context.constant(0)
        return p.compose(
            *(self.elements.get(name, nothing) for name in ring.names), ctx=self.context
        )

    def text(self, p: fmpq_mpoly) -> str:
        """The beginning of a polynomial's text."""
        return re.sub(r"x([0-9]+)", lambda found: self.names[int(found[1])], str(p)[:_SHOWN])[:80]

    def constant(self, value: Fraction) -> fmpq_mpoly:
        return self.context.constant(from_fraction(value))

    def named(self, name: str) -> fmpq_mpoly:
        return self.elements[name]

    def circle_of(self, angle: str) -> Circle:
        if angle not in self.circles:
            raise NotImplementedError("the checker knows no angle that is a cosine or sine")
        return self.circles[angle]


def multiples(tree: Tree) -> dict[str, Fraction]:
    """The angles of a sum, each with its factor; what is no multiple of an angle has the empty
    name.
    """
    names = names_of(tree)
    try:
        p = CoordinateRing((*names, ""), ()).value(tree)
    except ValueError as error:
        raise NotImplementedError("the checker divides by no angle") from error
    found = [(to_fraction(c), factors) for c, factors in monomials(p, names)]
    if any(sum(power for _, power in factors) > 1 for _, factors in found):
        raise NotImplementedError("the checker knows no products of angles")
    return {factors[0][0] if factors else "": c for c, factors in found}


def _whole(exponent: Tree) -> int:
    """A whole exponent: a root would be another function, with values that are not compared."""
    match exponent:
        case Number(number) if number.denominator == 1:
            return int(number)
    found = multiples(exponent)
    if found.keys() - {""} or found.get("", Fraction(0)).denominator != 1:
        raise NotImplementedError("the checker knows whole exponents only")
    return int(found.get("", 0))


_ZERO, _ONE = arb(0), arb(1)


def monomials(
    p: fmpq_mpoly, names: Sequence[str] = ()
) -> Iterator[tuple[fmpq, list[tuple[str, int]]]]:
    """The coefficients of a polynomial, each with the names of what it is next to and their powers.

    Parameters
    ----------
    names : of the first variables, if they are not the ring's own.
    """
    names = names or p.context().names()
    for powers, c in p.terms():
        yield c, [(name, int(power)) for name, power in zip(names, powers, strict=False) if power]


def evaluated(p: fmpq_mpoly, values: Mapping[str, Any], names: Sequence[str] = ()) -> Any:
    """The value of a polynomial for exact numbers, functions or balls; of one without names a
    fraction, or 0.
    """
    total: Any = 0
    number = Fraction(0)  # exact: a quotient of integers would be a double
    for c, factors in monomials(p, names):
        if factors:
            term = prod(
                [_raised(values[name], exponent) for name, exponent in factors], start=int(c.p)
            )
            total = total + (term / int(c.q) if c.q != 1 else term)
        else:
            number = to_fraction(c)
    if not number:
        return total
    return total + (from_fraction(number) if isinstance(total, arb) else number)


def _raised(value: Any, exponent: int) -> Any:
    """A power: of a ball with both signs an even one is not negative."""
    if exponent == 1:
        return value
    return power(value, exponent) if isinstance(value, arb) else value**exponent


def ball(p: fmpq_mpoly, values: Mapping[str, Any]) -> arb:
    """The value of a polynomial for balls, also of one without names."""
    found = evaluated(p, values)
    return found if isinstance(found, arb) else ball_of(Fraction(found))


def ball_at(x: Sequence[arb]) -> Callable[[fmpq_mpoly], arb]:
    """The values of polynomials in so many variables, which have their monomials in common."""
    known: dict[tuple[int, ...], arb] = {}

    def value(p: fmpq_mpoly) -> arb:
        total = _ZERO
        for powers, c in p.terms():
            if powers not in known:
                known[powers] = prod(
                    (power(b, int(k)) for b, k in zip(x, powers, strict=True) if k), start=_ONE
                )
            total += known[powers] * c
        return total

    return value


def square(x: arb) -> arb:
    """The square."""
    if x > 0 or x < 0:
        return x * x
    most = x.abs_upper()
    return _ZERO.union(most * most)


def power(x: arb, exponent: int) -> arb:
    """A power; an even one of a ball with both signs is not negative."""
    if exponent == 0:
        return _ONE
    if exponent % 2 == 0 and x.contains(0):
        return _ZERO.union(_product(x.abs_upper(), exponent))
    if x.rad() == 0:
        return _product(x, exponent)
    return _product(x.lower(), exponent).union(_product(x.upper(), exponent))


def _product(x: arb, exponent: int) -> arb:
    """Not by the operator, which has no answer for balls around 0."""
    return prod([x] * exponent, start=_ONE)
