"""Real number fields Q(a), a being a real root of an irreducible polynomial, their elements, rational
roots of polynomials over them, and the real points of a fibre, whose unknowns are such elements.

Guarantee: exact. Whether an element is zero, or rational, is decided by its residue and never by an
enclosure; `ball` encloses its value, as narrowly as the precision allows. Each real solution of a
fibre is there once, also where it is multiple; its multiplicity is the dimension of the local
algebra.

Residues have numbers many times as long as those that they come from: with parameters of forty
digits, three thousand bits become thirty thousand. So an element is kept as the expression that it
was made by, which is evaluated in three ways. Most are found to be irrational in the residues
modulo a prime, whose numbers are short, and their enclosures are those of the expression; a residue
over Q is computed when the prime does not tell.

Reference: Rouillier, Solving zero-dimensional systems through the rational univariate
representation, AAECC 9 (1999).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, reduce
from typing import Any

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly, fmpz_poly, nmod, nmod_poly

from ptmcad.algebra.descartes import root_bound
from ptmcad.algebra.fibre_algebra import FibreAlgebra, univariate_representation
from ptmcad.algebra.membership import RationalPolynomial
from ptmcad.algebra.real_roots import RealRoot, is_root_of, isolate, refine
from ptmcad.text.flint_numbers import to_fraction

PRIME = 2**61 - 1
"""Any prime gives the same answers; a large one seldom divides what is not zero."""


class RingEvaluation:
    """Values of expressions in one ring, each computed once: parts are shared by many expressions.

    Parameters
    ----------
    embed : the value of a polynomial in the field's generator.
    reduce : a product in its shortest form.
    inverse : of what is not zero.
    """

    def __init__(
        self,
        embed: Callable[[fmpq_poly], Any],
        reduce: Callable[[Any], Any],
        inverse: Callable[[Any], Any],
    ) -> None:
        self.embed, self.reduce, self.inverse = embed, reduce, inverse
        self._known: dict[Expression, Any] = {}

    def __getitem__(self, expression: Expression) -> Any:
        if expression not in self._known:
            self._known[expression] = expression(self)
        return self._known[expression]


Expression = Callable[[RingEvaluation], Any]


class Modulus:
    """An irreducible polynomial in Z[T] of which a field's generator is a root.

    Attributes
    ----------
    residues : in Q[T], polynomials of lower degree.
    images : the same modulo `PRIME`; a ZeroDivisionError where a number has none.
    """

    def __init__(self, polynomial: fmpz_poly) -> None:
        self.polynomial, self.degree = fmpq_poly(polynomial), int(polynomial.degree())
        self.residues = RingEvaluation(
            lambda p: p % self.polynomial, lambda p: p % self.polynomial, self._inverse
        )
        self.images = RingEvaluation(
            self._image, lambda p: p % self._modulo_prime, self._inverse_image
        )

    @cached_property
    def _modulo_prime(self) -> nmod_poly:
        image = nmod_poly(self.polynomial.numer(), PRIME)
        if image.degree() < self.degree:
            raise ZeroDivisionError("the prime divides the leading coefficient")
        return image

    def _inverse(self, p: fmpq_poly) -> fmpq_poly:
        common, inverse, _ = p.xgcd(self.polynomial)
        return inverse / common[0] % self.polynomial

    def _image(self, p: fmpq_poly) -> nmod_poly:
        return nmod_poly(p.numer(), PRIME) * (1 / nmod(int(p.denom()), PRIME)) % self._modulo_prime

    def _inverse_image(self, p: nmod_poly) -> nmod_poly:
        common, inverse, _ = p.xgcd(self._modulo_prime)
        if common.degree() > 0:
            raise ZeroDivisionError("a number that is not zero has an image that is none")
        return inverse


@dataclass(frozen=True, slots=True, eq=False)
class RealField:
    """The field Q[T]/(modulus) with its embedding that sends T to ``root``, a real root of the
    irreducible modulus.
    """

    modulus: Modulus
    root: RealRoot

    def element(self, p: fmpq_poly) -> FieldElement:
        """The value of a polynomial at the root."""
        return FieldElement(self, lambda ring: ring.embed(p))

    def constant(self, value: fmpq) -> FieldElement:
        """A rational number."""
        return self.element(fmpq_poly([value]))

    def evaluation(self) -> RingEvaluation:
        """In balls, at the root, whose enclosure is about as wide as one of the context's
        precision.
        """
        generator = refine(self.root, fmpq(1, 2**ctx.prec) * (abs(self.root.middle) + 1)).ball
        return RingEvaluation(
            lambda p: arb_poly(p)(generator), lambda ball: ball, lambda ball: 1 / ball
        )


@dataclass(frozen=True, slots=True, eq=False)
class FieldElement:
    """An element of a real field: the value of the expression at the root."""

    field: RealField
    expression: Expression

    @property
    def residue(self) -> fmpq_poly:
        """The polynomial of lower degree than the modulus whose value at the root is the element."""
        residue: fmpq_poly = self.field.modulus.residues[self.expression]
        return residue

    @property
    def image(self) -> nmod_poly | None:
        """The residue modulo `PRIME`; None where there is none."""
        try:
            image: nmod_poly = self.field.modulus.images[self.expression]
        except ZeroDivisionError:
            return None
        return image

    @property
    def is_zero(self) -> bool:
        """An image that is not zero proves that the element is not."""
        image = self.image
        return (image is None or image.is_zero()) and bool(self.residue.is_zero())

    @property
    def rational(self) -> Fraction | None:
        """The number itself when it is rational: then, and seldom else, its image is a number too."""
        image = self.image
        if (image is not None and image.degree() > 0) or self.residue.degree() > 0:
            return None
        return to_fraction(fmpq(self.residue[0]))

    def conjugate(self, field: RealField) -> FieldElement:
        """The same residue at another root of the modulus."""
        return FieldElement(field, self.expression)

    def ball(self, at: RingEvaluation) -> arb:
        """An enclosure, from an evaluation of the field's."""
        ball: arb = at[self.expression]
        return ball

    def __add__(self, other: FieldElement) -> FieldElement:
        a, b = self.expression, other.expression
        return FieldElement(self.field, lambda ring: ring[a] + ring[b])

    def __sub__(self, other: FieldElement) -> FieldElement:
        a, b = self.expression, other.expression
        return FieldElement(self.field, lambda ring: ring[a] - ring[b])

    def __mul__(self, other: FieldElement) -> FieldElement:
        a, b = self.expression, other.expression
        return FieldElement(self.field, lambda ring: ring.reduce(ring[a] * ring[b]))

    def __neg__(self) -> FieldElement:
        a = self.expression
        return FieldElement(self.field, lambda ring: -ring[a])

    def inverse(self) -> FieldElement:
        """One over the element.

        Raises
        ------
        ZeroDivisionError
            When that is zero.
        """
        if self.is_zero:
            raise ZeroDivisionError("a number that is zero has no inverse")
        a = self.expression
        return FieldElement(self.field, lambda ring: ring.inverse(ring[a]))

    def times(self, factor: fmpq) -> FieldElement:
        """A rational multiple."""
        return self * self.field.constant(factor)


def rational_roots(lower: Sequence[FieldElement]) -> Iterator[tuple[Fraction, int]]:
    """The rational roots of a polynomial with leading coefficient 1, with multiplicities.

    With coefficients in powers of the field's generator, a rational root is one of each power's
    polynomial, so of their greatest common divisor. Where that is constant modulo a prime it is so
    over Q; most often this settles the matter.

    Parameters
    ----------
    lower : the other coefficients, from the constant one on.
    """
    if not lower:
        return
    degree, images = lower[0].field.modulus.degree, [total.image for total in lower]
    if (
        None not in images
        and _common(images, degree, lambda row: nmod_poly([int(c) for c in row], PRIME)).degree()
        < 1
    ):
        return
    exact = _common([total.residue for total in lower], degree, fmpq_poly)
    for factor, multiplicity in exact.numer().factor()[1]:
        if factor.degree() == 1:
            yield Fraction(-int(factor[0]), int(factor[1])), multiplicity


def _common(lower: Sequence[Any], degree: int, polynomial: Callable[[list[Any]], Any]) -> Any:
    """The greatest common divisor of the polynomials that belong to the powers of the generator.

    Parameters
    ----------
    lower : residues; those of the leading coefficient, 1, are added.
    degree : of the field.
    """
    columns = (polynomial([*(p[j] for p in lower), int(j == 0)]) for j in range(degree))
    return reduce(lambda a, b: a.gcd(b), columns)


@dataclass(frozen=True, slots=True)
class RealPoint:
    """A real solution: the unknowns as elements of a real field, and the multiplicity."""

    field: RealField
    unknowns: tuple[FieldElement, ...]
    multiplicity: int


def points(algebra: FibreAlgebra, bound: int | None = 1) -> tuple[list[RealPoint], int]:
    """The real points of a fibre, and the number of different complex ones.

    The real ones stand in the order of a form that separates all of them.

    Parameters
    ----------
    bound : of the unknowns at all real points, where one is known; it bounds the search.
    """
    separated = univariate_representation(algebra, multiple=True)
    if separated is None:
        raise ArithmeticError("no form of the list separates the points of a fibre")
    radical, form = separated.minimal, separated.form
    factors = [
        (factor, int(multiplicity)) for factor, multiplicity in separated.characteristic.factor()[1]
    ]
    numerators = [separated.slope, *separated.coordinates]
    limit = root_bound(radical) if bound is None else fmpq(bound * sum(form) + 1)
    coordinates: dict[int, tuple[Modulus, list[Expression]]] = {}
    found = []
    for root in isolate(radical, -limit, limit):
        number = next(n for n, (factor, _) in enumerate(factors) if is_root_of(factor, root))
        factor, multiplicity = factors[number]
        interval = RealRoot(factor, root.low, root.high)
        if number not in coordinates:
            modulus = Modulus(factor)
            coordinates[number] = modulus, _coordinates(RealField(modulus, interval), numerators)
        modulus, residues = coordinates[number]
        field = RealField(modulus, interval)
        found.append(
            RealPoint(field, tuple(FieldElement(field, r) for r in residues), multiplicity)
        )
    return found, int(radical.degree())


def value_at(point: RealPoint, p: RationalPolynomial) -> FieldElement:
    """The value of a polynomial in the unknowns, or in the first of them."""
    parts = [element.expression for element in point.unknowns]

    def value(ring: RingEvaluation) -> Any:
        total = ring.embed(fmpq_poly([0]))
        for monomial, c in p.items():
            term = ring.embed(fmpq_poly([c]))
            for part, exponent in zip(parts, monomial, strict=False):
                for _ in range(exponent):
                    term = ring.reduce(term * ring[part])
            total += term
        return total

    return FieldElement(point.field, value)


def _coordinates(field: RealField, numerators: Sequence[fmpq_poly]) -> list[Expression]:
    """The unknowns at the points of one factor: quotients of the trace polynomials by the first of
    them.
    """
    first, *others = map(field.element, numerators)
    inverse = first.inverse()  # it vanishes at no point of the fibre
    return [(other * inverse).expression for other in others]
