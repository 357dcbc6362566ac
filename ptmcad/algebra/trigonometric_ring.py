"""Polynomials in real unknowns and in cosines and sines of angles, with parameters, over Q; and
their derivatives.

Guarantee: exact; the derivation by an angle sends cos to -sin and sin to cos, so the derivative of
an energy is its true gradient.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.algebra.polynomials import Monomial

TrigonometricPolynomial = fmpq_mpoly
"""An element of a `TrigonometricRing`."""
RationalPolynomial = dict[Monomial, fmpq]
"""A polynomial with rational coefficients: exponent vector -> coefficient."""


class TrigonometricRing(NamedTuple):
    """The ring Q[parameters][cos a, sin a for each angle a; x for each real unknown x].

    The coordinates of the unknowns come after the parameters, those of the angles first.
    """

    parameters: tuple[str, ...]
    angles: tuple[str, ...]
    reals: tuple[str, ...] = ()

    @property
    def unknowns(self) -> tuple[str, ...]:
        """The angles, then the real unknowns."""
        return self.angles + self.reals

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of the polynomials' variables that are no parameters."""
        return (
            tuple(f"{function}_{angle}" for angle in self.angles for function in ("cos", "sin"))
            + self.reals
        )

    @property
    def width(self) -> int:
        """The number of coordinates."""
        return 2 * len(self.angles) + len(self.reals)

    @property
    def unbounded(self) -> tuple[int, ...]:
        """Coordinates whose poles are all there are: a sine has one where its cosine has."""
        return (*range(0, 2 * len(self.angles), 2), *range(2 * len(self.angles), self.width))

    @property
    def circles(self) -> tuple[dict[tuple[int, ...], int], ...]:
        """cos^2 + sin^2 - 1 for each angle: exponents of the coordinates -> coefficient."""
        found = []
        for k in range(len(self.angles)):
            circle = {(0,) * self.width: -1}
            for offset in (0, 1):
                circle[tuple(2 if i == 2 * k + offset else 0 for i in range(self.width))] = 1
            found.append(circle)
        return tuple(found)

    @property
    def context(self) -> fmpq_mpoly_ctx:
        return fmpq_mpoly_ctx.get(self.parameters + self.coordinates, Ordering.degrevlex)

    def constant(self, value: Fraction) -> TrigonometricPolynomial:
        return self.context.constant(fmpq(value.numerator, value.denominator))

    def parameter(self, name: str) -> TrigonometricPolynomial:
        """A parameter or a real unknown."""
        if name in self.reals:
            return self.context.gen(
                len(self.parameters) + 2 * len(self.angles) + self.reals.index(name)
            )
        return self.context.gen(self.parameters.index(name))

    def cos(self, angle: str) -> TrigonometricPolynomial:
        return self.context.gen(len(self.parameters) + 2 * self.angles.index(angle))

    def sin(self, angle: str) -> TrigonometricPolynomial:
        return self.context.gen(len(self.parameters) + 2 * self.angles.index(angle) + 1)

    def derivative(self, p: TrigonometricPolynomial, unknown: str) -> TrigonometricPolynomial:
        """The derivative of p by an unknown."""
        if unknown in self.reals:
            return p.derivative(
                len(self.parameters) + 2 * len(self.angles) + self.reals.index(unknown)
            )
        k = len(self.parameters) + 2 * self.angles.index(unknown)
        c, s = self.context.gen(k), self.context.gen(k + 1)
        return p.derivative(k + 1) * c - p.derivative(k) * s

    def reduce(self, p: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """p with every even power of a cosine replaced by means of cos^2 + sin^2 = 1: a normal form
        on the torus.
        """
        for angle in self.angles:
            p = p % (self.cos(angle) ** 2 + self.sin(angle) ** 2 - 1)
        return p

    def split(self, p: TrigonometricPolynomial) -> dict[Monomial, RationalPolynomial]:
        """p as: exponents of the unknowns -> exponents of the parameters -> coefficient."""
        n = len(self.parameters)
        parts: dict[Monomial, RationalPolynomial] = {}
        for exponents, coefficient in p.terms():
            powers = tuple(int(e) for e in exponents)
            parts.setdefault(powers[n:], {})[powers[:n]] = coefficient
        return parts
