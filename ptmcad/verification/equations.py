"""A model's polynomials, from its description: at one rational point, or in all parameters.

Guarantee: exact. The equations are formed from the description by `derivation`, and are differentiated here; nothing is
taken from `ptmcad.exact.models`, so a mistake there or here shows as a contradiction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

from flint import Ordering, arb, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.model import Model
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.derivation import Configuration, coordinates_of, formulas, has_index, parameters_of


@dataclass(frozen=True, slots=True)
class Ring:
    """Polynomials over Q in the coordinates of a model's unknowns, and perhaps in its parameters."""

    model: Model
    names: tuple[str, ...]
    ordering: Ordering

    @property
    def context(self) -> fmpq_mpoly_ctx:
        return fmpq_mpoly_ctx.get(self.names, self.ordering)

    def variable(self, name: str) -> fmpq_mpoly:
        return self.context.gen(self.names.index(name))

    def circles(self) -> dict[str, tuple[fmpq_mpoly, fmpq_mpoly]]:
        """Cosine and sine of each angle."""
        return {a: (self.variable(f"cos_{a}"), self.variable(f"sin_{a}")) for a in self.model.angles}

    def relations(self) -> tuple[fmpq_mpoly, ...]:
        return tuple(c * c + s * s - 1 for c, s in self.circles().values())

    def normal(self, p: fmpq_mpoly) -> fmpq_mpoly:
        """The normal form modulo the circles: at most the first power of each cosine."""
        for relation in self.relations():
            p = divmod(p, relation)[1]
        return p

    def by(self, p: fmpq_mpoly, unknown: str) -> fmpq_mpoly:
        """The derivative by an unknown."""
        if unknown in self.model.reals:
            return p.derivative(unknown)
        c, s = self.circles()[unknown]
        return c * p.derivative(f"sin_{unknown}") - s * p.derivative(f"cos_{unknown}")

    def configuration(self, numbers: Mapping[str, Any]) -> Configuration:
        """With numbers for some parameters; the others are variables."""
        names = (*parameters_of(self.model), *self.model.reals)
        return Configuration({n: numbers[n] if n in numbers else self.variable(n) for n in names}, self.circles())


@dataclass(frozen=True, slots=True)
class Polynomials:
    """What solutions of a model satisfy.

    Attributes
    ----------
    energy : of springs and loads; None where there are equations.
    moments : by the unknowns, the angles first.
    equations : of an energy its gradient less the moments, by the unknowns.
    jacobian : their derivatives by the unknowns; where solutions are critical points a Hessian.
    """

    ring: Ring
    energy: fmpq_mpoly | None
    moments: tuple[fmpq_mpoly, ...]
    equations: tuple[fmpq_mpoly, ...]
    jacobian: tuple[tuple[fmpq_mpoly, ...], ...]
    inequalities: tuple[fmpq_mpoly, ...]
    stability: tuple[fmpq_mpoly, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the ring's variables."""
        return self.ring.names

    @property
    def has_index(self) -> bool:
        """Whether solutions are critical points."""
        return has_index(self.ring.model)

    def generators(self) -> list[fmpq_mpoly]:
        """Of the ideal of all solutions."""
        return [*(e for e in self.equations if not e.is_zero()), *self.ring.relations()]


def equations_at(model: Model, values: Mapping[str, Fraction]) -> Polynomials:
    """The model's polynomials at rational values of the parameters."""
    numbers = {name: from_fraction(values[name]) for name in parameters_of(model)}
    return _polynomials(Ring(model, tuple(reversed(coordinates_of(model))), Ordering.degrevlex), numbers)


@lru_cache(maxsize=8)
def equations_of(model: Model) -> Polynomials:
    """The model's polynomials in the coordinates of the unknowns and in the parameters."""
    return _polynomials(Ring(model, (*coordinates_of(model), *parameters_of(model)), Ordering.lex), {})


def _polynomials(ring: Ring, numbers: Mapping[str, Any]) -> Polynomials:
    given = formulas(ring.configuration(numbers), ring.model)
    unknowns = ring.model.angles + ring.model.reals
    zero = ring.context.constant(0)

    def elements(values: Sequence[Any]) -> tuple[fmpq_mpoly, ...]:
        return tuple(zero + value for value in values)

    energy = None if given.energy is None else zero + given.energy
    moments = elements([given.moment(k) for k in range(len(unknowns))])
    equations = elements(given.equations)
    if energy is not None:
        equations = tuple(ring.by(energy, u) - m for u, m in zip(unknowns, moments, strict=True))
    jacobian = tuple(tuple(ring.by(e, u) for u in unknowns) for e in equations)
    return Polynomials(
        ring, energy, moments, equations, jacobian, elements(given.inequalities), elements(given.stability)
    )


def values_at(polynomials: Sequence[fmpq_mpoly], at: Sequence[arb]) -> list[arb]:
    """Values in balls, given those of the ring's variables."""
    powers = [[arb(1)] for _ in at]
    found = []
    for p in polynomials:
        total = arb(0)
        for exponents, c in p.terms():
            term = arb(c)
            for known, x, e in zip(powers, at, exponents, strict=True):
                while len(known) <= e:
                    known.append(known[-1] * x)
                if e:
                    term = term * known[int(e)]
            total = total + term
        found.append(total)
    return found
