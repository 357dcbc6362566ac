"""A model's polynomials at one rational point, from its description.

Guarantee: exact. The equations are formed from the description, in rational numbers, by `derivation`, and are
differentiated here; nothing is taken from `ptmcad.exact.models`, so a mistake there or here shows as a contradiction.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import Ordering, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.mechanism import Model
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.derivation import Configuration, coordinates_of, formulas, has_index, parameters_of


@dataclass(frozen=True)
class PointEquations:
    """The model's polynomials at one point.

    Attributes
    ----------
    names : of the ring's variables.
    equations : of an energy its gradient less the moments, by the unknowns in their order.
    jacobian : their derivatives by the unknowns; where solutions are critical points a Hessian.
    has_index : whether they are.
    """

    names: tuple[str, ...]
    circles: tuple[fmpq_mpoly, ...]
    equations: tuple[fmpq_mpoly, ...]
    jacobian: tuple[tuple[fmpq_mpoly, ...], ...]
    inequalities: tuple[fmpq_mpoly, ...]
    stability: tuple[fmpq_mpoly, ...]
    has_index: bool

    def generators(self) -> list[fmpq_mpoly]:
        """Of the ideal of all solutions."""
        return [*(e for e in self.equations if not e.is_zero()), *self.circles]


def equations_at(model: Model, values: Mapping[str, Fraction]) -> PointEquations:
    """The model's polynomials at rational values of the parameters."""
    names = tuple(reversed(coordinates_of(model)))
    ring: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(names, Ordering.degrevlex)
    variables = {name: ring.gen(k) for k, name in enumerate(names)}
    numbers = {name: from_fraction(values[name]) for name in parameters_of(model)}
    circles = {a: (variables[f"cos_{a}"], variables[f"sin_{a}"]) for a in model.angles}
    reals = {name: variables[name] for name in model.reals}
    given = formulas(Configuration(numbers | reals, circles), model)

    def by(p: fmpq_mpoly) -> list[fmpq_mpoly]:
        """The derivatives by the unknowns."""
        turns = [c * p.derivative(f"sin_{a}") - s * p.derivative(f"cos_{a}") for a, (c, s) in circles.items()]
        return turns + [p.derivative(name) for name in reals]

    def polynomial(value: Any) -> fmpq_mpoly:
        p: fmpq_mpoly = ring.constant(0) + value
        return p

    if given.energy is not None:
        equations = tuple(e - given.moment(k) for k, e in enumerate(by(polynomial(given.energy))))
    else:
        equations = tuple(map(polynomial, given.equations))
    return PointEquations(
        names,
        tuple(c * c + s * s - 1 for c, s in circles.values()),
        equations,
        tuple(tuple(by(e)) for e in equations),
        tuple(map(polynomial, given.inequalities)),
        tuple(map(polynomial, given.stability)),
        has_index(model),
    )
