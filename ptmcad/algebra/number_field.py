"""Real number fields Q(a), a being a real root of an irreducible polynomial, and their elements.

Guarantee: exact. Whether an element is zero, or rational, is decided by its residue and never by an enclosure; `ball`
encloses its value, as narrowly as the precision allows.

Residues have numbers many times as long as those that they come from: with parameters of forty digits, three thousand
bits become thirty thousand. So an element is kept as the expression that it was made by. Most are found to be
irrational in the residues modulo a prime, whose numbers are short, and their enclosures are those of the expression; a
residue over Q is computed when the prime does not tell.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import repeat

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly, fmpz_poly, nmod, nmod_poly

from ptmcad.algebra.real_roots import RealRoot, refine
from ptmcad.text.flint_numbers import to_fraction

PRIME = 2**61 - 1
"""Any prime gives the same answers; a large one seldom divides what is not zero."""


@dataclass(frozen=True, slots=True, eq=False)
class Modulus:
    """An irreducible polynomial of which a field's generator is a root, and its image modulo `PRIME`.

    Attributes
    ----------
    image : None where the prime divides the leading coefficient: then residues have no images.
    """

    polynomial: fmpq_poly
    image: nmod_poly | None

    @classmethod
    def of(cls, polynomial: fmpz_poly) -> Modulus:
        """The modulus for an irreducible polynomial in Z[T]."""
        regular = int(polynomial.leading_coefficient()) % PRIME != 0
        return cls(fmpq_poly(polynomial), nmod_poly(polynomial, PRIME) if regular else None)

    @property
    def degree(self) -> int:
        """Of the field over Q."""
        return int(self.polynomial.degree())

    def image_of(self, p: fmpq_poly) -> nmod_poly | None:
        """The residue of a polynomial modulo the prime, None where a denominator is a multiple of it."""
        denominator = int(p.denom()) % PRIME
        if self.image is None or denominator == 0:
            return None
        return nmod_poly(p.numer() * pow(denominator, -1, PRIME), PRIME) % self.image


class Residue:
    """An element of Q[T]/(modulus) as the expression that it was made by.

    Attributes
    ----------
    image : modulo `PRIME`, where all numbers in the expression have one.
    enclose : a ball around the value at a root, from those of the parts.
    """

    __slots__ = ("_compute", "_exact", "enclose", "image")

    def __init__(
        self, image: nmod_poly | None, compute: Callable[[], fmpq_poly], enclose: Callable[[Evaluation], arb]
    ) -> None:
        self.image = image
        self.enclose = enclose
        self._compute = compute
        self._exact: fmpq_poly | None = None

    @property
    def exact(self) -> fmpq_poly:
        """The residue over Q, a polynomial of lower degree than the modulus; computed once."""
        if self._exact is None:
            self._exact = self._compute()
        return self._exact


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """Enclosures of residues' values at one root, at the precision that the context has.

    Attributes
    ----------
    generator : an enclosure of the root.
    known : what has been enclosed already; parts are shared by many expressions.
    """

    generator: arb
    known: dict[Residue, arb]

    def __getitem__(self, residue: Residue) -> arb:
        ball = self.known.get(residue)
        if ball is None:
            ball = self.known[residue] = residue.enclose(self)
        return ball


@dataclass(frozen=True, slots=True, eq=False)
class RealField:
    """The field Q[T]/(modulus) with its embedding that sends T to ``root``, a real root of the irreducible modulus."""

    modulus: Modulus
    root: RealRoot

    def element(self, p: fmpq_poly) -> Element:
        """The value of a polynomial at the root."""
        modulus = self.modulus
        low = p % modulus.polynomial
        return Element(self, Residue(modulus.image_of(low), lambda: low, lambda at: arb_poly(low)(at.generator)))

    def constant(self, value: fmpq) -> Element:
        """A rational number."""
        return polynomial_at(self, (), {(): value})

    def evaluation(self) -> Evaluation:
        """At the root, whose enclosure is about as wide as a ball of the context's precision."""
        short = refine(self.root, fmpq(1, 2**ctx.prec) * (abs(self.root.middle) + 1))
        return Evaluation(arb(short.low).union(arb(short.high)), {})


@dataclass(frozen=True, slots=True, eq=False)
class Element:
    """An element of a real field: the value of the residue at the root."""

    field: RealField
    part: Residue

    @property
    def residue(self) -> fmpq_poly:
        """The polynomial of lower degree than the modulus whose value at the root is the element."""
        return self.part.exact

    @property
    def is_zero(self) -> bool:
        """An image that is not zero proves that the element is not."""
        if self.part.image is not None and not self.part.image.is_zero():
            return False
        return bool(self.residue.is_zero())

    @property
    def rational(self) -> Fraction | None:
        """The number itself when it is rational: then, and seldom else, its image is a number too."""
        if self.part.image is not None and self.part.image.degree() > 0:
            return None
        if self.residue.degree() > 0:
            return None
        return to_fraction(fmpq(self.residue[0]))

    def conjugate(self, field: RealField) -> Element:
        """The same residue at another root of the modulus."""
        return Element(field, self.part)

    def ball(self, at: Evaluation) -> arb:
        """An enclosure, from an evaluation of the field's."""
        return at[self.part]

    def coefficients(self) -> tuple[fmpq, ...]:
        """The residue's coefficients, as many as the field's degree, constant first."""
        return tuple(fmpq(self.residue[k]) for k in range(self.field.modulus.degree))

    def image_coefficients(self) -> tuple[nmod, ...] | None:
        """Those of the residue modulo `PRIME`, where there is one."""
        if self.part.image is None:
            return None
        return tuple(self.part.image[k] for k in range(self.field.modulus.degree))

    def __add__(self, other: Element) -> Element:
        a, b = self.part, other.part
        image = None if a.image is None or b.image is None else a.image + b.image
        return Element(self.field, Residue(image, lambda: a.exact + b.exact, lambda at: at[a] + at[b]))

    def __sub__(self, other: Element) -> Element:
        a, b = self.part, other.part
        image = None if a.image is None or b.image is None else a.image - b.image
        return Element(self.field, Residue(image, lambda: a.exact - b.exact, lambda at: at[a] - at[b]))

    def __mul__(self, other: Element) -> Element:
        a, b, modulus = self.part, other.part, self.field.modulus
        image = None
        if a.image is not None and b.image is not None and modulus.image is not None:
            image = a.image * b.image % modulus.image
        return Element(
            self.field, Residue(image, lambda: a.exact * b.exact % modulus.polynomial, lambda at: at[a] * at[b])
        )

    def inverse(self) -> Element:
        """One over the element.

        Raises
        ------
        ZeroDivisionError
            When that is zero.
        """
        if self.is_zero:
            raise ZeroDivisionError("a number that is zero has no inverse")
        part, modulus = self.part, self.field.modulus
        image = None
        if part.image is not None and modulus.image is not None:
            common, inverse, _ = part.image.xgcd(modulus.image)
            image = inverse if common.degree() == 0 else None
        return Element(self.field, Residue(image, lambda: _inverse(part.exact, modulus), lambda at: 1 / at[part]))

    def times(self, factor: fmpq) -> Element:
        """A rational multiple."""
        return polynomial_at(self.field, (self,), {(1,): factor})


def polynomial_at(field: RealField, at: Sequence[Element], p: Mapping[tuple[int, ...], fmpq]) -> Element:
    """The value of a polynomial at elements of a field.

    Parameters
    ----------
    p : exponents to coefficients.
    """
    parts = [element.part for element in at]
    modulus = field.modulus

    def image() -> nmod_poly | None:
        if modulus.image is None:
            return None
        total = nmod_poly([0], PRIME)
        for monomial, c in p.items():
            number = _modulo_prime(c)
            if number is None:
                return None
            term = nmod_poly([number], PRIME)
            for part in _factors(parts, monomial):
                if part.image is None:
                    return None
                term = term * part.image % modulus.image
            total += term
        return total

    def compute() -> fmpq_poly:
        total = fmpq_poly([0])
        for monomial, c in p.items():
            term = fmpq_poly([c])
            for part in _factors(parts, monomial):
                term = term * part.exact % modulus.polynomial
            total += term
        return total

    def enclose(at: Evaluation) -> arb:
        total = arb(0)
        for monomial, c in p.items():
            term = arb(c)
            for part in _factors(parts, monomial):
                term *= at[part]
            total += term
        return total

    return Element(field, Residue(image(), compute, enclose))


def _factors(parts: Sequence[Residue], monomial: tuple[int, ...]) -> Iterator[Residue]:
    for part, exponent in zip(parts, monomial, strict=True):
        yield from repeat(part, exponent)


def _modulo_prime(value: fmpq) -> int | None:
    """A rational number modulo `PRIME`, None when its denominator is a multiple of that."""
    denominator = int(value.q) % PRIME
    if denominator == 0:
        return None
    return int(value.p) % PRIME if denominator == 1 else int(value.p) * pow(denominator, -1, PRIME) % PRIME


def _inverse(p: fmpq_poly, modulus: Modulus) -> fmpq_poly:
    """Of a residue that is not zero."""
    common, inverse, _ = p.xgcd(modulus.polynomial)
    return inverse / common[0] % modulus.polynomial
