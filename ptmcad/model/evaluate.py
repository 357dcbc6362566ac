"""The value of a tree in any ring that has the parameters, and the cosines and sines of the unknown
angles.

Guarantee: exact as far as the ring is; constants are computed as fractions before they meet the
ring. A cosine or sine of a sum of multiples of angles is expanded by the addition theorems, so the
ring needs those of single angles only. Division is by constants only: a coordinate is a polynomial.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from ptmcad.errors import ExpressionError
from ptmcad.text.syntax import NOT_INTEGER
from ptmcad.text.tree import OPERATORS, Call, Name, Number, Power, Step, Tree, interpret

MAX_EXPONENT = 64
MAX_BITS = 13_000
MAX_MULTIPLE = 64
"""Of an angle inside a cosine or sine."""
FIXED_ANGLE = (
    "only multiples of pi/2 can be added to an angle: of other fixed angles use cosine and sine as two parameters, "
    "given as (1 - t^2)/(1 + t^2) and 2*t/(1 + t^2), t the tangent of the half, or turn the points of a body themselves"
)


_QUOTIENT = (
    "division by what is not a number: only polynomials can be evaluated; multiply an equation by its denominator, and "
    "list that, or its square, under positive; of parameters, make the quotient a parameter"
)


class RingElement(Protocol):
    """What the values of a ring can do."""

    def __add__(self, other: Any, /) -> Any: ...

    def __sub__(self, other: Any, /) -> Any: ...

    def __mul__(self, other: Any, /) -> Any: ...


E = TypeVar("E", bound=RingElement)
_E_co = TypeVar("_E_co", bound=RingElement, covariant=True)


class Ring(Protocol[_E_co]):
    """A commutative ring over the rational numbers; it refuses a name by an `ExpressionError`."""

    def constant(self, value: Fraction, /) -> _E_co: ...

    def parameter(self, name: str, /) -> _E_co:
        """A parameter, or an unknown on the line."""

    def cos(self, angle: str, /) -> _E_co: ...

    def sin(self, angle: str, /) -> _E_co: ...


class ByNames(NamedTuple, Generic[E]):
    """A ring as an arithmetic for formulas, whose variables have these names."""

    names: Sequence[str]
    ring: Ring[E]

    def constant(self, value: Fraction) -> E:
        return self.ring.constant(value)

    def variable(self, number: int) -> E:
        return self.ring.parameter(self.names[number])

    def cos(self, number: int) -> E:
        return self.ring.cos(self.names[number])

    def sin(self, number: int) -> E:
        return self.ring.sin(self.names[number])


def evaluate(tree: Tree, ring: Ring[E]) -> E:
    """The value of a tree.

    Raises
    ------
    ExpressionError
        With the position of what has no meaning: a name that the ring refuses, a division by what
        is no constant or zero, an exponent that is no whole number from 0 to `MAX_EXPONENT`, an
        argument of a function that is no sum of whole multiples of angles.
    """
    return evaluated([tree], ring)[0]


def evaluated(trees: Iterable[Tree], ring: Ring[E]) -> tuple[E, ...]:
    """The values of several trees, of which parts that they share are evaluated once; errors as of
    `evaluate`.
    """
    evaluation, known = _Evaluation(ring), dict[int, tuple[Tree, Fraction | E]]()
    return tuple(evaluation.lifted(interpret(tree, evaluation, known)) for tree in trees)


def value_at(tree: Tree, parameters: Mapping[str, Fraction]) -> Fraction:
    """The value of a tree without unknowns, such as a stiffness, at values of the parameters.

    >>> from ptmcad.text.syntax import parse
    >>> value_at(parse("2*k/3"), {"k": Fraction(1, 2)})
    Fraction(1, 3)

    Raises
    ------
    ExpressionError
        As `evaluate`; also for an angle.
    """
    return value_among(tree, parameters, Fraction)


def value_among(tree: Tree, parameters: Mapping[str, E], constant: Callable[[Fraction], E]) -> E:
    """The same where parameters have values of any kind; ``constant`` makes one of a number."""
    return evaluate(tree, Assignment(parameters, constant))


class Named(Generic[E]):
    """A ring in which further names stand for expressions, each of which is evaluated once."""

    def __init__(self, ring: Ring[E], trees: Mapping[str, Tree]):
        self.ring = ring
        self.trees = trees
        self.known: dict[str, E] = {}
        self.constant, self.cos, self.sin = ring.constant, ring.cos, ring.sin

    def parameter(self, name: str) -> E:
        if name not in self.trees:
            return self.ring.parameter(name)
        if name not in self.known:
            self.known[name] = evaluate(self.trees[name], self.ring)
        return self.known[name]


class Assignment(Generic[E]):
    """A ring of values of names, of which some are angles: what has a cosine and a sine."""

    def __init__(
        self,
        values: Mapping[str, E],
        constant: Callable[[Fraction], E],
        angles: Collection[str] = (),
    ):
        self.values, self.constant, self.angles = values, constant, angles

    def parameter(self, name: str) -> E:
        if name in self.angles:
            raise ExpressionError(f"{name} is an angle: it stands inside of cos or sin")
        if name not in self.values:
            raise ExpressionError(f"{name} has no value")
        return self.values[name]

    def cos(self, angle: str) -> E:
        return self._turned(angle).cos()  # type: ignore[no-any-return]

    def sin(self, angle: str) -> E:
        return self._turned(angle).sin()  # type: ignore[no-any-return]

    def _turned(self, angle: str) -> Any:
        if angle not in self.angles:
            raise ExpressionError(f"the cosine and sine of {angle} are no parameters")
        return self.values[angle]


class _Evaluation(Generic[E]):
    """The interpretation in a ring: fractions where no name has occurred yet."""

    def __init__(self, ring: Ring[E]):
        self.ring = ring
        self.calls: dict[tuple[str, Tree], Fraction | E] = {}

    def lifted(self, value: Fraction | E) -> E:
        return self.ring.constant(value) if isinstance(value, Fraction) else value

    def number(self, number: Number) -> Fraction | E:
        return number.value

    def name(self, name: Name) -> Fraction | E:
        try:
            return self.ring.parameter(name.name)
        except ExpressionError as error:
            raise ExpressionError(error.message, name.position) from None

    def negative(self, value: Fraction | E) -> Fraction | E:
        return -value if isinstance(value, Fraction) else self.ring.constant(Fraction(-1)) * value

    def joined(self, left: Fraction | E, step: Step, right: Fraction | E) -> Fraction | E:
        operator = step.operator
        if operator == "/":
            operator, right = "*", _inverse(right, step)
        if isinstance(left, Fraction) and isinstance(right, Fraction):
            return _bounded(OPERATORS[operator](left, right), step.position)
        value: E = OPERATORS[operator](self.lifted(left), self.lifted(right))
        return value

    def power(self, base: Fraction | E, power: Power, exponent: Fraction | E) -> Fraction | E:
        n = _whole(exponent, power.position)
        if isinstance(base, Fraction):
            return _power(base, n, power.position)
        if not 0 <= n <= MAX_EXPONENT:
            problem = _QUOTIENT if n < 0 else f"an exponent of a name is from 0 to {MAX_EXPONENT}"
            raise ExpressionError(problem, power.position)
        if n == 0:
            return Fraction(1)
        value: Any = base
        for _ in range(n - 1):
            value = value * base
        return value  # type: ignore[no-any-return]

    def call(self, call: Call) -> Fraction | E:
        known = call.function, call.argument
        if known not in self.calls:
            self.calls[known] = self._turned(call)
        return self.calls[known]

    def _turned(self, call: Call) -> Fraction | E:
        angles = _Angles()
        multiples = interpret(call.argument, angles)
        if multiples.pop("", 0):
            raise ExpressionError(FIXED_ANGLE, call.position)
        if any(m.denominator != 1 or abs(m) > MAX_MULTIPLE for m in multiples.values()):
            raise ExpressionError(
                f"the argument of {call.function} is not a sum of whole multiples of angles (at most {MAX_MULTIPLE})",
                call.position,
            )
        total: tuple[E, E] | None = None  # cosine and sine
        for angle, multiple in multiples.items():
            try:
                c, s = self.ring.cos(angle), self.ring.sin(angle)
            except ExpressionError as error:
                raise ExpressionError(error.message, angles.positions[angle]) from None
            if multiple < 0:
                s = self.ring.constant(Fraction(-1)) * s
            for _ in range(abs(int(multiple))):
                if total is None:
                    total = (c, s)
                else:
                    cosine, sine = total
                    total = (cosine * c - sine * s, sine * c + cosine * s)
        if total is None:  # the angle zero
            return Fraction(1 if call.function == "cos" else 0)
        return total[0 if call.function == "cos" else 1]


def multiples(tree: Tree) -> dict[str, Fraction]:
    """A sum of multiples of names, as the multiples; what stands alone is under the empty name.

    Raises
    ------
    ExpressionError
        When the tree is none.
    """
    return interpret(tree, _Angles())


def multiples_with_positions(tree: Tree) -> tuple[dict[str, Fraction], dict[str, int]]:
    """The same, and where each name stands first."""
    angles = _Angles()
    return interpret(tree, angles), angles.positions


class _Angles:
    """The interpretation as a sum of multiples of angles: names to multiples, the empty name to the
    constant.
    """

    def __init__(self) -> None:
        self.positions: dict[str, int] = {}

    def number(self, number: Number) -> dict[str, Fraction]:
        return {"": number.value}

    def name(self, name: Name) -> dict[str, Fraction]:
        self.positions.setdefault(name.name, name.position)
        return {name.name: Fraction(1)}

    def negative(self, value: dict[str, Fraction]) -> dict[str, Fraction]:
        return {name: -multiple for name, multiple in value.items()}

    def joined(
        self, left: dict[str, Fraction], step: Step, right: dict[str, Fraction]
    ) -> dict[str, Fraction]:
        if step.operator in "+-":
            sign = 1 if step.operator == "+" else -1
            return left | {
                name: left.get(name, Fraction(0)) + sign * m for name, m in right.items()
            }
        if step.operator == "*" and left.keys() == {""}:
            left, right = right, left
        if right.keys() != {""}:
            raise ExpressionError(
                "an angle is multiplied or divided by numbers only", step.position
            )
        factor = _inverse(right[""], step) if step.operator == "/" else right[""]
        return {name: _bounded(multiple * factor, step.position) for name, multiple in left.items()}

    def power(
        self, base: dict[str, Fraction], power: Power, exponent: dict[str, Fraction]
    ) -> dict[str, Fraction]:
        if base.keys() != {""} or exponent.keys() != {""}:
            raise ExpressionError("a power of an angle is no angle", power.position)
        return {"": _power(base[""], _whole(exponent[""], power.position), power.position)}

    def call(self, call: Call) -> dict[str, Fraction]:
        raise ExpressionError(f"{call.function} is no angle", call.position)


def _inverse(value: object, step: Step) -> Fraction:
    """One over a constant."""
    if not isinstance(value, Fraction):
        raise ExpressionError(_QUOTIENT, step.position)
    if not value:
        raise ExpressionError("division by zero", step.position)
    return 1 / value


def _whole(exponent: object, position: int) -> int:
    if not isinstance(exponent, Fraction) or exponent.denominator != 1:
        raise ExpressionError(NOT_INTEGER, position)
    return exponent.numerator


def _power(base: Fraction, n: int, position: int) -> Fraction:
    """A power of a constant."""
    if not base and n < 0:
        raise ExpressionError("division by zero", position)
    if abs(base) in (0, 1):
        return base ** (n % 2 if n <= 0 else 2 - n % 2)
    if abs(n) * _bits(base) > MAX_BITS:
        raise ExpressionError(f"the power has more than {MAX_BITS} bits", position)
    return Fraction(base**n)


def _bounded(value: Fraction, position: int) -> Fraction:
    if _bits(value) > MAX_BITS:
        raise ExpressionError(f"a number in the expression has more than {MAX_BITS} bits", position)
    return value


def _bits(value: Fraction) -> int:
    return max(value.numerator.bit_length(), value.denominator.bit_length())
