"""Polynomials in the cosines and sines of angles, with parameters, over Q; and their derivatives by the angles.

Guarantee: exact; the derivation sends cos to -sin and sin to cos, so the derivative of an energy is its true gradient.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

TrigonometricPolynomial = fmpq_mpoly
"""An element of a `TrigonometricRing`."""


@dataclass(frozen=True, slots=True)
class TrigonometricRing:
    """The ring Q[parameters][cos a, sin a for each angle a]; the unknowns come after the parameters."""

    parameters: tuple[str, ...]
    angles: tuple[str, ...]

    @property
    def context(self) -> fmpq_mpoly_ctx:
        names = self.parameters + tuple(f"{f}_{a}" for a in self.angles for f in ("cos", "sin"))
        return fmpq_mpoly_ctx.get(names, Ordering.degrevlex)

    def parameter(self, name: str) -> TrigonometricPolynomial:
        return self.context.gen(self.parameters.index(name))

    def cos(self, angle: str) -> TrigonometricPolynomial:
        return self.context.gen(len(self.parameters) + 2 * self.angles.index(angle))

    def sin(self, angle: str) -> TrigonometricPolynomial:
        return self.context.gen(len(self.parameters) + 2 * self.angles.index(angle) + 1)

    def derivative(self, p: TrigonometricPolynomial, angle: str) -> TrigonometricPolynomial:
        """The derivative of p by an angle."""
        k = len(self.parameters) + 2 * self.angles.index(angle)
        c, s = self.context.gen(k), self.context.gen(k + 1)
        return p.derivative(k + 1) * c - p.derivative(k) * s

    def reduce(self, p: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """p with every even power of a cosine replaced by means of cos^2 + sin^2 = 1: a normal form on the torus."""
        n = len(self.parameters)
        for index in range(len(self.angles)):
            k = n + 2 * index
            one_minus = self.context.constant(1) - self.context.gen(k + 1) ** 2
            total = self.context.constant(0)
            for exponents, coefficient in p.terms():
                rest = list(exponents)
                rest[k] %= 2
                term = self.context.from_dict({tuple(rest): coefficient})
                total += term * one_minus ** (exponents[k] // 2)
            p = total
        return p

    def split(self, p: TrigonometricPolynomial) -> dict[tuple[int, ...], dict[tuple[int, ...], fmpq]]:
        """p as: exponents of the unknowns -> exponents of the parameters -> coefficient."""
        n = len(self.parameters)
        parts: dict[tuple[int, ...], dict[tuple[int, ...], fmpq]] = {}
        for exponents, coefficient in p.terms():
            powers = tuple(int(e) for e in exponents)
            parts.setdefault(powers[n:], {})[powers[:n]] = coefficient
        return parts
