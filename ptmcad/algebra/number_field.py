"""Real number fields Q(a), a being a real root of an irreducible polynomial, and their elements.

Guarantee: exact. Whether an element is zero, or rational, is read off its residue and never off an enclosure; `ball`
encloses its value, as narrowly as the precision allows.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from ptmcad.algebra.real_roots import RealRoot, refine


@dataclass(frozen=True, slots=True, eq=False)
class RealField:
    """The field Q[T]/(modulus) with its embedding that sends T to ``root``, a real root of the irreducible modulus."""

    modulus: fmpq_poly
    root: RealRoot

    def element(self, residue: fmpq_poly) -> Element:
        """The value of a polynomial at the root."""
        return Element(self, residue % self.modulus)

    def constant(self, value: fmpq) -> Element:
        """A rational number."""
        return Element(self, fmpq_poly([value]))

    def generator(self) -> arb:
        """An enclosure of the root, about as wide as a ball of the context's precision."""
        short = refine(self.root, fmpq(1, 2**ctx.prec) * (abs(self.root.middle) + 1))
        return arb(short.low).union(arb(short.high))


@dataclass(frozen=True, slots=True, eq=False)
class Element:
    """An element of a real field: the value of ``residue``, of lower degree than the modulus, at the root."""

    field: RealField
    residue: fmpq_poly

    @property
    def is_zero(self) -> bool:
        return bool(self.residue.is_zero())

    @property
    def rational(self) -> Fraction | None:
        """The number itself when it is rational."""
        if self.residue.degree() > 0:
            return None
        value = fmpq(self.residue[0])
        return Fraction(int(value.p), int(value.q))

    def conjugate(self, field: RealField) -> Element:
        """The same residue at another root of the modulus."""
        return Element(field, self.residue)

    def ball(self, generator: arb) -> arb:
        """An enclosure, from one of the field's root."""
        return arb_poly(self.residue)(generator)

    def coefficients(self) -> tuple[fmpq, ...]:
        """The residue's coefficients, as many as the field's degree, constant first."""
        return tuple(fmpq(self.residue[k]) for k in range(self.field.modulus.degree()))

    def __add__(self, other: Element) -> Element:
        return Element(self.field, self.residue + other.residue)

    def __sub__(self, other: Element) -> Element:
        return Element(self.field, self.residue - other.residue)

    def __mul__(self, other: Element) -> Element:
        return Element(self.field, self.residue * other.residue % self.field.modulus)

    def times(self, factor: fmpq) -> Element:
        """A rational multiple."""
        return Element(self.field, self.residue * factor)
