"""Texts of polynomials in a result, compared with what follows from the description: at a random
point modulo a random prime.

At a point each parameter and each real unknown is a random residue, and the cosine and the sine of
each angle are a point of the circle. Each spring's length is a root of its squared length d.d:
points are drawn until there are such roots, and all choices of their signs are tried. So each
coefficient of a product of lengths is compared by itself. It is a polynomial over Q; of degree d,
not zero and modulo a prime p, it is zero at a random point with a probability under d/p.

Guarantee: no true text is refused. A false one passes with a probability under 2^-60: p is over
2^60 times the degree, the bits of coefficients, and the share of points that have roots. No
denominator is zero at a point: divisions are by numbers alone, which are no multiples of p. A root
is read only where it is a spring's length, and an angle stands outside of cosines and sines only
where a moment works on it.
"""

from __future__ import annotations

import random
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product

from flint import fmpq, fmpq_mpoly, fmpz

from ptmcad.text.tree import (
    Call,
    Chain,
    Name,
    Negative,
    Number,
    Power,
    Step,
    Tree,
    names_of,
    to_text,
)
from ptmcad.verification.coordinates import circle_names, multiples, turned
from ptmcad.verification.derivation import Derivation, SpringVector
from ptmcad.verification.report import Violation

LARGEST_TEXT = 1_000_000
"""Letters beyond which a text is not compared."""
LARGEST_SIZE = 2**32
"""Of the degree and of the bits of numbers, beyond which a text is not compared."""
MOST_LENGTHS = 10
"""Different lengths of springs beyond which not all choices of signs are tried."""
_DEEPEST = 200
_LARGEST_ANGLE = 10_000
_TOKEN = re.compile(
    r" *(?:(?P<number>[0-9]{1,4000}(?:\.[0-9]{1,400})?(?:e[+-]?[0-9]{1,3})?(?![A-Za-z0-9_.]))"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]{0,80})|(?P<sign>[-+*/^()]))",
    re.ASCII,
)


class TooLarge(Exception):
    """Why a text is not compared."""


class _Reader:
    """A text as a tree: sums and products of any length, and parentheses to some depth."""

    def __init__(self, text: str, what: str) -> None:
        if len(text) > LARGEST_TEXT:
            raise TooLarge(f"the stored {what} is longer than {LARGEST_TEXT} letters")
        self.what, self.next, place = what, 0, 0
        self.tokens: list[tuple[str, str]] = []
        while place < len(text):
            found = _TOKEN.match(text, place)
            if found is None:
                raise _unread(what, text[place:])
            self.tokens.append((str(found.lastgroup), found[0].strip()))
            place = found.end()
        self.tokens.append(("end", ""))

    def whole(self) -> Tree:
        tree = self._sum(0)
        kind, token = self.tokens[self.next]
        if kind != "end":
            raise _unread(self.what, token)
        return tree

    def _taken(self, signs: str) -> str:
        """The next token, if it is one of some signs."""
        kind, token = self.tokens[self.next]
        if kind != "sign" or token not in signs:
            return ""
        self.next += 1
        return token

    def _sum(self, depth: int) -> Tree:
        first = Negative(self._product(depth)) if self._taken("-") else self._product(depth)
        steps = []
        while sign := self._taken("+-"):
            steps.append(Step(sign, self._product(depth)))
        return Chain(first, tuple(steps)) if steps else first

    def _product(self, depth: int) -> Tree:
        first, steps = self._factor(depth), []
        while sign := self._taken("*/"):
            steps.append(Step(sign, self._factor(depth)))
        return Chain(first, tuple(steps)) if steps else first

    def _factor(self, depth: int) -> Tree:
        base = self._atom(depth)
        if not self._taken("^"):
            return base
        kind, token = self.tokens[self.next]
        if kind != "number" or not token.isdigit() or len(token) > 9:
            raise _unread(self.what, f"^{token}")
        self.next += 1
        return Power(base, Number(Fraction(token)))

    def _atom(self, depth: int) -> Tree:
        kind, token = self.tokens[self.next]
        if kind == "end" or (kind == "sign" and token != "(") or depth == _DEEPEST:
            raise _unread(self.what, token)
        self.next += 1
        if kind == "number":
            return Number(Fraction(token))
        if kind == "name" and not self._taken("("):
            return Name(token)
        inner = self._sum(depth + 1)
        if not self._taken(")"):
            raise _unread(self.what, self.tokens[self.next][1])
        return Call(token, inner) if kind == "name" else inner


def _unread(what: str, rest: str) -> Violation:
    place = f"at {rest[:30]!r}" if rest else "to its end"
    return Violation(f"the stored {what} cannot be read {place}")


def _read(what: str, text: str) -> Tree:
    """A text as a tree.

    Raises
    ------
    Violation, TooLarge
    """
    tree = _Reader(text, what).whole()
    if _size(tree) > LARGEST_SIZE:
        raise TooLarge(f"the stored {what} has too high a degree or too long numbers")
    return tree


def _size(tree: Tree) -> int:
    """A bound of the degree and of the bits of all coefficients, numerators and denominators."""
    match tree:
        case Number(value):
            return value.numerator.bit_length() + value.denominator.bit_length()
        case Name():
            return 1
        case Negative(operand):
            return _size(operand)
        case Call(_, argument):
            return _LARGEST_ANGLE + _size(argument)
        case Chain(first, steps):
            return _size(first) + sum(_size(step.operand) for step in steps)
        case Power(base, exponent):
            return _size(base) * int(_number_in(exponent))


def _number_in(tree: Tree) -> Fraction:
    assert isinstance(tree, Number)  # the reader knows no other exponents
    return tree.value


@dataclass(frozen=True, slots=True)
class Residue:
    """A residue modulo a prime, and its slope by one unknown."""

    value: int
    slope: int
    prime: int

    def __add__(self, other: Residue) -> Residue:
        return self._made(self.value + other.value, self.slope + other.slope)

    def __neg__(self) -> Residue:
        return self._made(-self.value, -self.slope)

    def __sub__(self, other: Residue) -> Residue:
        return self._made(self.value - other.value, self.slope - other.slope)

    def __mul__(self, other: Residue) -> Residue:
        slope = self.value * other.slope + self.slope * other.value
        return self._made(self.value * other.value, slope)

    def power(self, exponent: int) -> Residue:
        """A power; the exponent may be negative for a number that is not zero."""
        if exponent == 0:
            return self._made(1, 0)
        below = pow(self.value, exponent - 1, self.prime)
        return self._made(below * self.value, exponent * below * self.slope)

    def _made(self, value: int, slope: int) -> Residue:
        return Residue(value % self.prime, slope % self.prime, self.prime)


@dataclass(frozen=True)
class ResiduePoint:
    """Residues at a point.

    Attributes
    ----------
    values : of the ring's variables and of its angles, by name.
    roots : of the springs' squared lengths, by the residues of these.
    by : the unknown by which slopes are.
    """

    prime: int
    values: Mapping[str, int]
    roots: Mapping[int, int] = field(default_factory=dict)
    by: str = ""

    def constant(self, value: Fraction) -> Residue:
        number = value.numerator * pow(value.denominator, -1, self.prime)
        return Residue(number % self.prime, 0, self.prime)

    def named(self, name: str) -> Residue:
        cosine, sine = circle_names(self.by)
        slope = int(name == self.by)
        if name == cosine:
            slope = -self.values[sine] % self.prime
        elif name == sine:
            slope = self.values[cosine]
        return Residue(self.values[name], slope, self.prime)

    def circle(self, angle: str) -> tuple[Residue, Residue]:
        """Cosine and sine of an angle."""
        cosine, sine = map(self.named, circle_names(angle))
        return cosine, sine

    def length(self, square: Residue) -> Residue:
        """The length whose square is given.

        Raises
        ------
        KeyError
            When no spring has it.
        """
        root = self.roots[square.value]
        slope = square.slope * pow(2 * root, -1, self.prime) if square.slope else 0
        return Residue(root, slope % self.prime, self.prime)


class Texts:
    """The texts of one result, and the points at which they are compared with polynomials.

    Parameters
    ----------
    true : the polynomials of the model, in all parameters.
    names : for the names in texts those of the ring's variables and of angles.
    springs : those whose lengths are in the energy.
    outside : the names that may stand outside of cosines and sines.
    """

    def __init__(
        self,
        true: Derivation,
        names: Mapping[str, str],
        seed: str,
        springs: Sequence[SpringVector] = (),
        outside: Collection[str] = (),
    ) -> None:
        self.true, self.ring, self.names, self.outside = true, true.ring, names, outside
        self.springs = springs
        self.squares: list[fmpq_mpoly] = []
        for square in (self.ring.normal(s.squared) for s in springs):
            if square not in self.squares:
                self.squares.append(square)
        self.source = random.Random(f"texts {seed}")
        bits = 2 * LARGEST_SIZE.bit_length() + 2 * len(self.squares) + 32
        self.prime = self.source.getrandbits(bits) | 1 << bits | 3
        while not fmpz(self.prime).is_prime():
            self.prime += 4  # 3 modulo 4, so that roots are powers
        self._point: ResiduePoint | None = None

    def compare(self, what: str, text: str, true: fmpq_mpoly) -> str:
        """Why a text was not compared with a polynomial; empty when they are equal.

        Raises
        ------
        Violation
            When they differ.
        """
        try:
            tree = _read(what, text)
            differs = any(
                self._value(what, tree, point).value != self._polynomial(true, point).value
                for point in self._signed()
            )
        except TooLarge as reason:
            return str(reason)
        if differs:
            expected = self.ring.text(true)
            raise Violation(f"the stored {what} differs from the mechanism's, {expected}")
        return ""

    def compare_potential(
        self, text: str, moments: Mapping[str, fmpq_mpoly], *, varying: bool = False
    ) -> str:
        """The same of the potential: the energy, less the work of moments.

        Parameters
        ----------
        varying : whether the work of moments' constant parts is not in it: of a force along a line
            that is its value where the unknown is zero.
        """
        try:
            fault = self._fault_in_work(_read("potential", text), moments, varying)
        except TooLarge as reason:
            return str(reason)
        if fault is not None:
            raise Violation(f"the stored potential differs from the mechanism's{fault}")
        return ""

    def _fault_in_work(
        self, tree: Tree, moments: Mapping[str, fmpq_mpoly], varying: bool
    ) -> str | None:
        """In which slope the work is wrong, which is the energy less the potential: so no moment is
        integrated. None where nothing is wrong.
        """
        if all(moment.is_zero() for moment in moments.values()):
            differs = any(self._work(tree, point).value for point in self._signed())
            assert self.true.energy is not None
            return f", {self.ring.text(self.true.energy)}" if differs else None
        for unknown, moment in moments.items():
            points = list(self._signed(unknown))
            missing = {
                (self._polynomial(moment, p).value - self._work(tree, p).slope) % self.prime
                for p in points
            }
            if varying:
                other = self._moved(points[0])
                slope = self._work(tree, other).slope
                missing.add((self._polynomial(moment, other).value - slope) % self.prime)
                is_steady = (
                    unknown in self.ring.angles
                    or not self._work(
                        tree, replace(other, values={**other.values, unknown: 0})
                    ).slope
                )
            else:
                missing.add(0)
                is_steady = True
            if len(missing) > 1 or not is_steady:
                return f" in its slope by {unknown}"
        at_zero = self._drawn(at_zero=True)
        return " where all unknowns are zero" if self._work(tree, at_zero).value else None

    def _work(self, tree: Tree, point: ResiduePoint) -> Residue:
        """The energy less the potential."""
        assert self.true.energy is not None
        energy = self._polynomial(self.true.energy, point)
        for spring in self.springs:
            pull, collapsed, square = (
                self._polynomial(p, point) for p in (spring.pull, spring.collapsed, spring.squared)
            )
            energy += collapsed - pull * point.length(square)
        return energy - self._value("potential", tree, point)

    def _signed(self, by: str = "") -> Iterator[ResiduePoint]:
        """The point of all texts, with each choice of the lengths' signs."""
        point = self._point = self._point or self._drawn()
        for signs in product((1, -1), repeat=len(point.roots)):
            roots = {
                square: sign * root
                for sign, (square, root) in zip(signs, point.roots.items(), strict=True)
            }
            yield replace(point, roots=roots, by=by)

    def _drawn(self, *, at_zero: bool = False) -> ResiduePoint:
        """A random point at which springs have lengths; or one where all unknowns are zero.

        Raises
        ------
        TooLarge
        """
        if len(self.squares) > MOST_LENGTHS:
            raise TooLarge(f"springs have more than {MOST_LENGTHS} different lengths")
        names = self.ring.names[self.true.coordinates :]
        while True:
            values = {name: self.source.randrange(self.prime) for name in names}
            values |= self._unknowns(at_zero)
            point, roots = ResiduePoint(self.prime, values), dict[int, int]()
            for p in self.squares:
                square = self._polynomial(p, point).value
                root = pow(square, (self.prime + 1) // 4, self.prime)
                if root * root % self.prime != square:
                    break
                roots[square] = root
            else:
                return replace(point, roots=roots)

    def _moved(self, point: ResiduePoint) -> ResiduePoint:
        """With the same parameters, and other unknowns."""
        return replace(point, values={**point.values, **self._unknowns()})

    def _unknowns(self, at_zero: bool = False) -> dict[str, int]:
        found = {}
        for unknown in self.true.unknowns:
            t = 0 if at_zero else self.source.randrange(self.prime)
            found[unknown] = t
            if unknown in self.ring.angles:
                below = pow(1 + t * t, -1, self.prime)  # -1 is no square
                circle = (1 - t * t) * below % self.prime, 2 * t * below % self.prime
                found |= dict(zip(circle_names(unknown), circle, strict=True))
                found[unknown] = 0 if at_zero else self.source.randrange(self.prime)
        return found

    def _polynomial(self, p: fmpq_mpoly, point: ResiduePoint) -> Residue:
        values = [fmpq(point.values[name]) for name in self.ring.names]

        def residue(q: fmpq_mpoly) -> int:
            found = fmpq(q(*values))
            return int(found.p) * pow(int(found.q), -1, self.prime) % self.prime

        slope = residue(self.ring.by(p, point.by)) if point.by else 0
        return Residue(residue(p), slope, self.prime)

    def _value(self, what: str, tree: Tree, point: ResiduePoint) -> Residue:
        """The residue of a text.

        Raises
        ------
        Violation
            When a part of it is no formula.
        """

        def value(tree: Tree) -> Residue:
            match tree:
                case Number(number):
                    return point.constant(number)
                case Name(name) if self.names.get(name) in self.outside:
                    return point.named(self.names[name])
                case Negative(operand):
                    return -value(operand)
                case Chain(first, steps):
                    total = value(first)
                    for step in steps:
                        total = joined(total, step)
                    return total
                case Power(base, exponent):
                    return value(base).power(int(_number_in(exponent)))
                case Call("sqrt", argument):
                    try:
                        return point.length(value(argument))
                    except KeyError:
                        raise Violation(
                            f"the stored {what} has a root of what is no spring's length: "
                            f"{to_text(tree)[:60]!r}"
                        ) from None
                case Call("cos" | "sin" as function, argument):
                    return circle(argument)[0 if function == "cos" else 1]
            raise _no_formula(what, tree)

        def joined(total: Residue, step: Step) -> Residue:
            one = value(step.operand)
            match step.operator:
                case "+":
                    return total + one
                case "-":
                    return total - one
                case "*":
                    return total * one
            if not _is_number(step.operand) or not one.value:
                raise _no_formula(what, step.operand)
            return total * one.power(-1)

        def circle(argument: Tree) -> tuple[Residue, Residue]:
            found = point.constant(Fraction(1)), point.constant(Fraction(0))
            try:
                turns = (
                    multiples(argument) if _size(argument) < _LARGEST_ANGLE else {"": Fraction(1)}
                )
            except NotImplementedError:
                raise _no_formula(what, argument) from None
            for name, multiple in turns.items():
                angle = self.names.get(name)
                if not multiple:
                    continue
                if angle not in self.ring.angles or multiple.denominator != 1:
                    raise _no_formula(what, argument)
                if abs(multiple) > _LARGEST_ANGLE:
                    raise TooLarge(f"the stored {what} has too large a multiple of an angle")
                found = turned(found, point.circle(angle), int(multiple))
            return found

        return value(tree)


def _no_formula(what: str, tree: Tree) -> Violation:
    return Violation(f"the stored {what} has a part that is no formula: {to_text(tree)[:60]!r}")


def _is_number(tree: Tree) -> bool:
    """Whether a tree has no names."""
    return not names_of(tree)
