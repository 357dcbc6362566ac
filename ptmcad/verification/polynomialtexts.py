"""Texts of polynomials in a result, compared with what follows from the description: at a random
point modulo a random prime.

At a point each parameter and each real unknown is a random residue, and the cosine and the sine of
each angle are a point of the circle. Each spring's length is a root of its squared length d.d:
points are drawn until there are such roots, and all choices of their signs are tried. So each
coefficient of a product of lengths is compared by itself. It is a rational function over Q; where
its numerator has degree d, and is not zero modulo a prime p, it is zero at a random point with a
probability under d/p.

Residues are modulo p^2: a function's slope by an unknown is what changes if p is added to the
unknown, divided by p. So the work of moments is known by its slopes, and no moment is integrated.

Guarantee: no true text is refused. A false one passes with a probability under 2^-60: p is over
2^60 times the degree, the bits of coefficients, and what the choice of points costs. A root is read
only where it is a spring's length, and an angle stands outside of cosines and sines only where a
moment works on it.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product

from flint import fmpq, fmpq_mpoly, fmpz, fmpz_mod, fmpz_mod_ctx

from ptmcad.errors import ExpressionError
from ptmcad.text.syntax import parse
from ptmcad.text.tree import FUNCTIONS, Call, Chain, Name, Negative, Number, Power, Tree, to_text
from ptmcad.verification.coordinates import TreeValues, circle_names, multiples
from ptmcad.verification.derivation import Derivation, SpringVector
from ptmcad.verification.report import Violation

MAX_TEXT = 1_000_000
"""Letters beyond which a text is not compared."""
MAX_SIZE = 2**32
"""Of the degree and of the bits of numbers, beyond which a text is not compared."""
MAX_LENGTHS = 10
"""Different lengths of springs beyond which not all choices of signs are tried."""
_MAX_ANGLE = 10_000
"""Bits of the argument of a cosine or a sine, and its multiples of angles."""


_PRIMES = 64
"""Primes that are tried: modulo one in two, and never modulo others, does 2 x^2 have roots."""
_DRAWS = 32
"""Points that are drawn modulo one prime, for each choice of signs."""
_UNUSUAL = re.compile(r"(?:^|[-+*/^(]) *\+|\*\*")
"""Signs that records may have."""


def _size(tree: Tree) -> int:
    """A bound of the degree and of the bits of all coefficients, numerators and denominators.

    Raises
    ------
    OverflowError, NotImplementedError
    """
    match tree:
        case Number(value):
            return value.numerator.bit_length() + value.denominator.bit_length()
        case Name():
            return 1
        case Negative(operand) | Call("sqrt", operand):
            return _size(operand)
        case Call(_, argument):
            if _size(argument) > _MAX_ANGLE or _times(argument) > _MAX_ANGLE:
                raise OverflowError("has too large a multiple of an angle")
            return _MAX_ANGLE
        case Chain(first, steps):
            for step in steps:
                if step.operator == "/" and multiples(step.operand).keys() != {""}:
                    raise NotImplementedError("it divides by what is no number")
            return _size(first) + sum(_size(step.operand) for step in steps)
        case Power(base, Number(value)) if value.denominator == 1 and value >= 0:
            return _size(base) * int(value)
    raise NotImplementedError("it has an exponent that is no whole number")


def _times(argument: Tree) -> Fraction:
    return sum(map(abs, multiples(argument).values()), Fraction(0))


@dataclass(frozen=True)
class _ResiduePoint(TreeValues[fmpz_mod]):
    """Residues at a point.

    Attributes
    ----------
    values : of the ring's variables and of its angles, by name.
    names : for the names in texts those of values, outside of cosines and sines.
    roots : of the springs' squared lengths, by the residues of these.
    """

    residues: fmpz_mod_ctx
    values: Mapping[str, fmpz_mod]
    names: Mapping[str, str]
    roots: Mapping[int, fmpz_mod] = field(default_factory=dict)

    def constant(self, value: Fraction) -> fmpz_mod:
        return self.residues(value.numerator) / self.residues(value.denominator)

    def named(self, name: str) -> fmpz_mod:
        if name not in self.names:
            raise Violation(f"names {name!r}, which is nothing there")
        return self.values[self.names[name]]

    def circle_of(self, angle: str) -> tuple[fmpz_mod, fmpz_mod]:
        names = circle_names(angle)
        if not self.values.keys() >= {*names}:
            raise Violation(f"names {names[0]!r}, which is nothing there")
        cosine, sine = (self.values[name] for name in names)
        return cosine, sine

    def root(self, square: fmpz_mod, tree: Tree) -> fmpz_mod:
        if int(square) not in self.roots:
            shown = to_text(tree)[:60]
            raise Violation(f"has a root of what is no spring's length: {shown!r}")
        return self.roots[int(square)]

    def of(self, p: fmpq_mpoly, ring: Sequence[str]) -> fmpz_mod:
        """The value of a polynomial in variables of these names."""
        found = fmpq(p(*(fmpq(int(self.values[name])) for name in ring)))
        return self.residues(found.p) / self.residues(found.q)


class PolynomialTexts:
    """The texts of one result, and the points at which they are compared with polynomials.

    Parameters
    ----------
    true : the polynomials of the model, in all parameters.
    names : for the names in texts those of the ring's variables, and of angles that may stand
        outside of cosines and sines.
    springs : those whose lengths are in the energy.
    """

    def __init__(
        self,
        true: Derivation,
        names: Mapping[str, str],
        seed: str,
        springs: Collection[SpringVector] = (),
    ) -> None:
        self.true, self.ring, self.names = true, true.ring, names
        self.lines = tuple(springs)
        self.squares: list[fmpq_mpoly] = []
        for square in (self.ring.normal(s.squared) for s in springs):
            if square not in self.squares:
                self.squares.append(square)
        self.source = random.Random(f"texts {seed}")
        self._point: _ResiduePoint | None = None
        self._choose_prime()

    def _choose_prime(self) -> None:
        bits = 2 * MAX_SIZE.bit_length() + 2 * len(self.squares) + 32
        self.prime = self.source.getrandbits(bits) | 1 << bits | 3
        while not fmpz(self.prime).is_prime():
            self.prime += 4  # 3 modulo 4, so that roots are powers, and -1 is no square
        self.residues = fmpz_mod_ctx(self.prime**2)
        self._point = None

    def compare(self, what: str, text: str, true: fmpq_mpoly) -> str:
        """Why a text was not compared with a polynomial; empty when they are equal.

        Raises
        ------
        Violation
            When they differ.
        """
        return self._judged(
            what,
            text,
            lambda tree: (
                any(p.value(tree) != p.of(true, self.ring.names) for p in self._signed())
                and f"differs from the mechanism's, {self.ring.text(true)}"
            ),
        )

    def compare_potential(
        self, text: str, moments: Mapping[str, fmpq_mpoly], *, varying: bool = False
    ) -> str:
        """The same of the potential: the energy, less the work of moments.

        Parameters
        ----------
        varying : whether the work of moments' constant parts is not in it: of a force along a line
            that is its value where the unknown is zero.
        """

        def fault(tree: Tree) -> str | bool:
            for unknown, moment in moments.items():
                if not self._is_work(tree, unknown, moment, varying):
                    return f"differs from the mechanism's in its slope by {unknown}"
            at_zero = int(self._work(tree, self._drawn(at_zero=True)))
            return at_zero != 0 and "differs from the mechanism's where all unknowns are zero"

        return self._judged("potential", text, fault)

    def _judged(self, what: str, text: str, fault: Callable[[Tree], str | bool]) -> str:
        """Why a text was not compared.

        Raises
        ------
        Violation
            When it is no formula, or one with a fault.
        """
        if len(text) > MAX_TEXT:
            return f"the stored {what} is longer than {MAX_TEXT} letters"
        try:
            if _UNUSUAL.search(text):
                raise Violation("cannot be read: there is a sign + or ** that no result has")
            tree = parse(text, (*FUNCTIONS, "sqrt"), MAX_TEXT)
            if _size(tree) > MAX_SIZE:
                raise OverflowError("has too high a degree or too long numbers")
            found = fault(tree)
        except OverflowError as reason:
            return f"the stored {what} {reason}"
        except ExpressionError as error:
            raise Violation(f"the stored {what} cannot be read: {error}") from None
        except (NotImplementedError, ZeroDivisionError) as reason:
            raise Violation(f"the stored {what} has a part that is no formula: {reason}") from None
        except Violation as violation:
            raise Violation(f"the stored {what} {violation}") from None
        if found:
            raise Violation(f"the stored {what} {found}")
        return ""

    def _is_work(self, tree: Tree, unknown: str, moment: fmpq_mpoly, varying: bool) -> bool:
        """Whether the work has the slope that is the moment on an unknown."""

        def missing(point: _ResiduePoint) -> int:
            of_moment = int(point.of(moment, self.ring.names))
            return (of_moment - self._slope(tree, point, unknown)) % self.prime

        points = list(self._signed())
        if not varying:
            return not any(map(missing, points))
        other = replace(points[0], values={**points[0].values, **self._unknowns()})
        rest = replace(other, values={**other.values, unknown: self.residues(0)})
        is_steady = unknown in self.ring.angles or not self._slope(tree, rest, unknown)
        return is_steady and len({missing(point) for point in (*points, other)}) == 1

    def _slope(self, tree: Tree, point: _ResiduePoint, unknown: str) -> int:
        """Of the work by an unknown, modulo the prime."""
        step = {unknown: point.values[unknown] + self.prime}
        if unknown in self.ring.angles:
            names, (c, s) = circle_names(unknown), point.circle_of(unknown)
            circle = c - s * self.prime, s + c * self.prime
            step |= dict(zip(names, circle, strict=True))
        lengths = [point.roots[int(point.of(p, self.ring.names))] for p in self.squares]
        moved = self._rooted(replace(point, values={**point.values, **step}), lengths)
        return int(self._work(tree, moved) - self._work(tree, point)) // self.prime

    def _work(self, tree: Tree, point: _ResiduePoint) -> fmpz_mod:
        """The energy less the potential."""
        assert self.true.energy is not None
        names = self.ring.names
        energy = point.of(self.true.energy, names)
        for line in self.lines:
            pull, collapsed, square = (
                point.of(p, names) for p in (line.pull, line.collapsed, line.squared)
            )
            energy += collapsed - pull * point.roots[int(square)]
        return energy - point.value(tree)

    def _signed(self) -> Iterator[_ResiduePoint]:
        """The point of all texts, with each choice of the lengths' signs."""
        point = self._point = self._point or self._drawn()
        for signs in product((1, -1), repeat=len(point.roots)):
            signed = zip(signs, point.roots.items(), strict=True)
            yield replace(point, roots={square: root * sign for sign, (square, root) in signed})

    def _drawn(self, *, at_zero: bool = False) -> _ResiduePoint:
        """A random point at which springs have lengths; or one where all unknowns are zero.

        Raises
        ------
        OverflowError
        """
        if len(self.squares) > MAX_LENGTHS:
            raise OverflowError(f"has more than {MAX_LENGTHS} different lengths of springs")
        for tried in range(1, _PRIMES * (_DRAWS << len(self.squares))):
            if tried % (_DRAWS << len(self.squares)) == 0:
                self._choose_prime()  # modulo which 2 x^2 may have a root
            values = {name: self._random() for name in self.ring.names[self.true.coordinates :]}
            values |= self._unknowns(at_zero)
            point = _ResiduePoint(self.residues, values, self.names)
            roots = []
            for p in self.squares:
                square = int(point.of(p, self.ring.names))
                root = self.residues(pow(square, (self.prime + 1) // 4, self.prime))
                if (int(root) ** 2 - square) % self.prime:
                    break
                roots.append(root)
            else:
                return self._rooted(point, roots)
        raise OverflowError("has lengths without roots modulo all primes that were tried")

    def _rooted(self, point: _ResiduePoint, near: Sequence[fmpz_mod]) -> _ResiduePoint:
        """With the roots that are those near by modulo the prime, by one step of Newton's."""
        roots = {}
        for p, root in zip(self.squares, near, strict=True):
            square = point.of(p, self.ring.names)
            roots[int(square)] = root - (root * root - square) / (2 * root) if int(root) else root
        return replace(point, roots=roots)

    def _unknowns(self, at_zero: bool = False) -> dict[str, fmpz_mod]:
        found = {}
        for unknown in self.true.unknowns:
            found[unknown] = t = self.residues(0) if at_zero else self._random()
            if unknown in self.ring.angles:
                below = 1 + t * t
                circle = (1 - t * t) / below, 2 * t / below
                found |= dict(zip(circle_names(unknown), circle, strict=True))
                found[unknown] = t if at_zero else self._random()
        return found

    def _random(self) -> fmpz_mod:
        return self.residues(self.source.randrange(self.prime))
