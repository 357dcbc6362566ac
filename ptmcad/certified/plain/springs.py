"""Springs with a free length in the formulas of a problem, and what an equilibrium says of their directions.

Guarantee: every formula is read off the differences of the springs' ends. Products of their slopes are in Fourier's
normal form, so that what is constant for rigid bodies is a constant.

With u = d/|d| the slope of |d| by q_i is u.a_i, a_i = dd/dq_i, and its second derivative u.d^2d/dq_i dq_j +
(u x a_i)(u x a_j)/|d|. An equilibrium balances each spring: K u.a_i is the rest of the i-th equation, whatever the
direction u is. So the squared sines are known there, too, by (u x a_i)(u x a_j) = a_i.a_j - (u.a_i)(u.a_j), also where
the spring is short and its direction is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ptmcad.certified.formula import Formula, Graph, direction, inverse_length, length, meet
from ptmcad.certified.parameters import expression_formula
from ptmcad.certified.plain.angle import Unknown
from ptmcad.certified.plain.problem import Cone
from ptmcad.certified.plain.scaling import over
from ptmcad.certified.plain.trigonometric import TrigonometricPolynomial
from ptmcad.text.expressions import Expression

Vector = tuple[Formula, Formula]
Matrix = tuple[tuple[Formula, ...], ...]
Pair = tuple[TrigonometricPolynomial, TrigonometricPolynomial]


class Spring(NamedTuple):
    """A spring in one configuration; the slopes a_i of d by the unknowns are over the equations' factors.

    Attributes
    ----------
    pull : stiffness times free length.
    vector, unit, extent : d, its direction u and |d|, which is d.u where the direction is a variable.
    inverse : 1/|d|.
    active : the unknowns that d depends on.
    cosines, sines : u.a_i and u x a_i.
    bends : u.d^2d/dq_i dq_j, over the factor of i alone.
    squares, crosses : a_i.a_j and a_i x a_j.
    """

    pull: Formula
    vector: Vector
    unit: Vector
    extent: Formula
    inverse: Formula
    active: tuple[int, ...]
    cosines: tuple[Formula, ...]
    sines: tuple[Formula, ...]
    bends: Matrix
    squares: Matrix
    crosses: Matrix

    def products(self) -> Matrix:
        """(u x a_i)(u x a_j)."""
        return tuple(tuple(p * q for q in self.sines) for p in self.sines)

    def products_at_equilibrium(self, rest: Sequence[Formula]) -> Matrix:
        """The same where K u.a_i is ``rest``; never to be differentiated.

        A rest that is the constant zero says nothing where K may be zero, too: 0/0 is no interval.
        """
        known = [
            meet(c, r / self.pull) if i in self.active and (r.value is None or self.pull.value is not None) else c
            for i, (c, r) in enumerate(zip(self.cosines, rest, strict=True))
        ]
        size = range(len(known))
        return tuple(
            tuple(
                meet(product, self.squares[i][j] - known[i] * known[j])
                if i in self.active and j in self.active
                else product
                for j, product in zip(size, row, strict=True)
            )
            for i, row in zip(size, self.products(), strict=True)
        )


@dataclass(frozen=True, slots=True)
class Shape:
    """What formulas of a spring are written of, exactly; by each unknown, over the factor of its equation.

    Attributes
    ----------
    pull : stiffness times free length.
    difference : d.
    slopes, bends : of d by each unknown, and of these by each.
    squares, crosses : scalar products of the slopes, and their cross products.
    """

    pull: Expression
    difference: Pair
    slopes: tuple[Pair, ...]
    bends: tuple[tuple[Pair, ...], ...]
    squares: tuple[tuple[TrigonometricPolynomial, ...], ...]
    crosses: tuple[tuple[TrigonometricPolynomial, ...], ...]

    def spring(self, graph: Graph, unknowns: Sequence[Unknown], phi: Formula | None) -> Spring:
        """The formulas in a graph.

        Parameters
        ----------
        phi : the angle of the spring's direction, where that is a variable of its own.
        """

        def written(f: TrigonometricPolynomial) -> Formula:
            return f.formula(graph, unknowns)

        dx, dy = (written(f) for f in self.difference)
        ux, uy = (direction(dx, dy), direction(dy, dx)) if phi is None else (phi.cos(), phi.sin())
        vectors = tuple((written(a), written(b)) for a, b in self.slopes)
        return Spring(
            expression_formula(graph, self.pull),
            (dx, dy),
            (ux, uy),
            length(dx, dy) if phi is None else dx * ux + dy * uy,
            inverse_length(dx, dy),
            tuple(i for i, (a, b) in enumerate(self.slopes) if a.terms or b.terms),
            tuple(ux * a + uy * b for a, b in vectors),
            tuple(ux * b - uy * a for a, b in vectors),
            tuple(tuple(ux * written(a) + uy * written(b) for a, b in row) for row in self.bends),
            tuple(tuple(map(written, row)) for row in self.squares),
            tuple(tuple(map(written, row)) for row in self.crosses),
        )


def shape(cone: Cone, factors: Sequence[Expression]) -> Shape:
    """Of a spring, with the positive factors of the equations."""
    x, y = cone.difference
    slopes = tuple((over(x.derivative(i), g), over(y.derivative(i), g)) for i, g in enumerate(factors))
    return Shape(
        cone.pull,
        cone.difference,
        slopes,
        tuple(tuple((a.derivative(j), b.derivative(j)) for j in range(len(factors))) for a, b in slopes),
        tuple(tuple(a * c + b * d for c, d in slopes) for a, b in slopes),
        tuple(tuple(a * d - b * c for c, d in slopes) for a, b in slopes),
    )
