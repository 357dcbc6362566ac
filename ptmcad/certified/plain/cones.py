"""Springs with a free length in the formulas of a problem, and what an equilibrium says of their
directions.

Guarantee: every formula is read off the differences of the springs' ends. Products of their slopes
are in Fourier's normal form, so that what is constant for rigid bodies is a constant.

With u = d/|d| the slope of |d| by q_i is u.a_i, a_i = dd/dq_i, and its second derivative
u.d^2d/dq_i dq_j + (u x a_i)(u x a_j)/|d|. An equilibrium balances each spring: K u.a_i is the rest
of the i-th equation, whatever the direction u is. So the squared sines are known there, too, by
(u x a_i)(u x a_j) = a_i.a_j - (u.a_i)(u.a_j), also where the spring is short and its direction is
not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from ptmcad.certified.plain.divisors import over
from ptmcad.certified.plain.harmonics import TrigonometricPolynomial, Unknown, mapped
from ptmcad.certified.plain.problem import SpringCone
from ptmcad.formulas.graph import (
    Formula,
    direction,
    expression_formula,
    inverse_length,
    length,
    meet,
)
from ptmcad.text.expressions import Expression

Vector = tuple[Formula, Formula]
Matrix = tuple[tuple[Formula, ...], ...]
Pair = tuple[TrigonometricPolynomial, TrigonometricPolynomial]


class ConeFormulas(NamedTuple):
    """A spring in one configuration, with the vectors w_i by which it is in the equations, each over
    the factor of its equation.

    Of open chains w_i is the slope a_i of d by the i-th unknown over the factor of that one's
    equation.

    Attributes
    ----------
    pull : stiffness times free length.
    vector, unit, extent : d, its direction u and |d|, which is d.u where the direction is a
        variable.
    inverse : 1/|d|.
    active : the equations that the spring is in.
    cosines, sines : u.w_i and u x w_i.
    turns : u x a_j, over the same factors.
    bends : u.dw_i/dq_j.
    levers : d.dw_i/dq_i.
    squares, crosses : w_i.w_j and w_i x w_j.
    """

    pull: Formula
    vector: Vector
    unit: Vector
    extent: Formula
    inverse: Formula
    active: tuple[int, ...]
    cosines: tuple[Formula, ...]
    sines: tuple[Formula, ...]
    turns: tuple[Formula, ...]
    bends: Matrix
    levers: tuple[Formula, ...]
    squares: Matrix
    crosses: Matrix

    def products(self) -> Matrix:
        """(u x w_i)(u x a_j)."""
        return tuple(tuple(p * q for q in self.turns) for p in self.sines)

    def products_at_equilibrium(self, rest: Sequence[Formula]) -> Matrix:
        """The same where K u.w_i is ``rest``; never to be differentiated. Of closed loops no more
        is known.

        A rest that is the constant zero says nothing where K may be zero, too: 0/0 is no interval.
        """
        if self.turns != self.sines:
            return self.products()
        known = [
            meet(c, r / self.pull)
            if i in self.active and (r.value is None or self.pull.value is not None)
            else c
            for i, (c, r) in enumerate(zip(self.cosines, rest, strict=True))
        ]
        return tuple(
            tuple(
                meet(product, self.squares[i][j] - known[i] * known[j])
                if i in self.active and j in self.active
                else product
                for j, product in enumerate(row)
            )
            for i, row in enumerate(self.products())
        )


Writer = Callable[[Sequence[Unknown], Formula | None], ConeFormulas]
"""The formulas of a spring in what stands for the unknowns, with the angle of its direction where
that is a variable of its own."""


def writer(cone: SpringCone, factors: Sequence[Expression]) -> Writer:
    """What writes a spring; it is multiplied out once, over the positive factors of the equations."""
    (x, y), size = cone.difference, range(len(factors))
    weights = tuple(
        (over(a, g), over(b, g)) for (a, b), g in zip(cone.weights, factors, strict=True)
    )
    slopes = tuple(
        (over(x.derivative(i), g), over(y.derivative(i), g)) for i, g in enumerate(factors)
    )
    bends = tuple(tuple((a.derivative(j), b.derivative(j)) for j in size) for a, b in weights)
    products = (
        tuple(x * a.derivative(i) + y * b.derivative(i) for i, (a, b) in enumerate(weights)),
        tuple(tuple(a * c + b * d for c, d in weights) for a, b in weights),
        tuple(tuple(a * d - b * c for c, d in weights) for a, b in weights),
    )
    active = tuple(i for i, (a, b) in enumerate(weights) if a.terms or b.terms)

    def written(unknowns: Sequence[Unknown], phi: Formula | None) -> ConeFormulas:
        (dx, dy), by_weights, by_slopes, by_bends, numbers = mapped(
            (cone.difference, weights, slopes, bends, products), lambda f: f.formula(unknowns)
        )
        ux, uy = (direction(dx, dy), direction(dy, dx)) if phi is None else (phi.cos(), phi.sin())
        return ConeFormulas(
            expression_formula(unknowns[0].graph, cone.pull),
            (dx, dy),
            (ux, uy),
            length(dx, dy) if phi is None else dx * ux + dy * uy,
            inverse_length(dx, dy),
            active,
            tuple(ux * a + uy * b for a, b in by_weights),
            tuple(ux * b - uy * a for a, b in by_weights),
            tuple(ux * b - uy * a for a, b in by_slopes),
            tuple(tuple(ux * a + uy * b for a, b in row) for row in by_bends),
            *numbers,
        )

    return written
