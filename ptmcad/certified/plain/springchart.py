"""The formulas of a problem: equations, Hessian and determinant, with the direction of one spring
as a variable or not.

Guarantee: the formulas are those of the potential wherever every spring with a free length has a
length. Where a spring has none, its direction stands for every unit vector, so that an equilibrium
that comes from nearby is not lost.

With u_s = d_s/|d_s| the equations are dV/dq_i - sum of K_s u_s . dd_s/dq_i, and the Hessian has
poles |d_s| = 0. In the chart of spring s its direction is (cos phi, sin phi) with phi an unknown,
and d_s x u = 0 an equation more. Then all is smooth at |d_s| = 0, and by Schur's complement the
Jacobian of the larger system has the determinant -+ |d_s| det H.

The i-th equation is taken over a factor g_i > 0 in the axes, so that the matrix is H with rows over
these factors: M - sum of K_s/|d_s| v_s (g v_s)^T, v_s being the sines u_s x a_i of spring s, and M
without a pole. So each spring enters the determinant to the first power
(`ptmcad.certified.plain.springchart`; Lemmas S1 to S3 of docs/soundness.md).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

from ptmcad.certified.plain.geometry import ConeFormulas, FactoredProblem, Matrix, Turn
from ptmcad.certified.plain.harmonics import TrigonometricPolynomial, Unknown
from ptmcad.certified.plain.problem import FIRST
from ptmcad.formulas.evaluation import mapped
from ptmcad.formulas.graph import Formula, Graph, determinant, expression_formula, length


class _Turned(NamedTuple):
    """The moment on bodies that turn together, and its derivative along the direction w of the
    unknowns.
    """

    weights: tuple[int, ...]
    moment: Formula
    stiffness: Formula
    factor: Formula


@dataclass(frozen=True, slots=True)
class SpringChart:
    """Formulas in the axes, the unknowns and, with a spring in its chart, phi as the last variable.

    Attributes
    ----------
    equations : one for each unknown, over its factor.
    hessian : their derivatives by the unknowns.
    lengths : |d_s| of each cone.
    dependent : formulas that vanish at every equilibrium, linear in the direction of a spring: the
        equations solved for its unit vector u_s, each coordinate.
    balances : the same, smooth where one spring has no length, unlike the equations: that u_s has
        the length 1.
    cones : with what their springs are in the equations by.
    smooth : the derivatives of the equations without springs.
    anywhere, there : what each spring takes off the matrix M, everywhere and where the equations
        vanish; the latter never to be differentiated.
    scales : the factors g_i.
    short : number of the cone whose direction is a variable.
    turned : bodies turned by one angle.
    symmetric : whether the equations are, but for their factors, derivatives of one function.
    unknowns : what stands for the problem's.
    """

    equations: tuple[Formula, ...]
    hessian: Matrix
    lengths: tuple[Formula, ...]
    dependent: tuple[Formula, ...]
    balances: tuple[Formula, ...]
    cones: tuple[ConeFormulas, ...]
    smooth: Matrix
    anywhere: tuple[_Bent, ...]
    there: tuple[_Bent, ...]
    scales: tuple[Formula, ...]
    short: int | None
    turned: tuple[_Turned, ...]
    symmetric: bool
    unknowns: tuple[Unknown, ...]

    @property
    def aligned(self) -> Formula:
        """d x u of the spring in its chart."""
        assert self.short is not None
        at = self.cones[self.short]
        return at.vector[0] * at.unit[1] - at.vector[1] * at.unit[0]

    @property
    def along(self) -> tuple[Formula, Formula]:
        """d - |d| u of the spring in its chart, with |d| as a formula without u."""
        assert self.short is not None
        at, extent = self.cones[self.short], self.lengths[self.short]
        return at.vector[0] - extent * at.unit[0], at.vector[1] - extent * at.unit[1]

    def rigid(self) -> Matrix:
        """The matrix M."""
        return _rigid(self.smooth, self.cones)

    def matrix_at_equilibrium(self) -> Matrix:
        """The Hessian where the equations vanish."""
        return _less(self.rigid(), self.there, self.scales)

    def determinant(self, *, at_equilibrium: bool = False) -> Formula:
        """Of the Hessian; in its chart, times the length of the spring."""
        bends = self.there if at_equilibrium else self.anywhere
        rigid = self.rigid()
        if self.short is None:
            return bent(rigid, bends, self.scales)
        chosen = self.cones[self.short]
        others = bends[: self.short] + bends[self.short + 1 :]
        whole = bent(rigid, others, self.scales)
        unit = bends[self.short]._replace(factor=self.equations[0].graph.constant(1))
        return chosen.extent * whole - chosen.pull * bent(rigid, others, self.scales, by=unit)

    def levelled(self) -> Formula:
        """The determinant times the lengths of all springs, where the equations vanish: finite
        everywhere.
        """
        bends = [bend._replace(factor=bend.spring.pull) for bend in self.there]
        return bent(self.rigid(), bends, self.scales, extents=[at.extent for at in self.cones])

    def determinants_by_turning(self) -> Iterator[Formula]:
        """Of two unknowns: the determinant by one of them and both turned, where the equations
        vanish.
        """
        if len(self.equations) == 2 and self.symmetric:
            there = self.matrix_at_equilibrium()
            for weights, _, stiffness, factor in self.turned:
                slip = there[0][0].graph.constant(0)
                for w, entry in zip(weights, there[0], strict=True):
                    slip = slip + w * entry
                yield there[0][0] * (factor * stiffness) - self.scales[0] * slip.squared()

    def diagonal_times_length(self, s: int) -> tuple[Formula, ...]:
        """|d_s| times the Hessian's diagonal where the equations vanish, as far as spring s is in
        it.

        What that spring is in it by is without its direction: |d_s| u_s is d_s.
        """
        bends, chosen = self.there, self.cones[s]
        others = _rigid(self.smooth, [*self.cones[:s], *self.cones[s + 1 :]])
        rest = _less(others, bends[:s] + bends[s + 1 :], self.scales)
        return tuple(
            self.lengths[s] * rest[i][i]
            - chosen.pull * (chosen.levers[i] + self.scales[i] * bends[s].products[i][i])
            for i in chosen.active
        )


def chart(
    exact: FactoredProblem, short: int | None = None, unknowns: Sequence[Unknown] = ()
) -> SpringChart:
    """The formulas of a problem, in a graph of their own or in that of what stands for the
    unknowns.

    Parameters
    ----------
    short : number of the cone whose direction is a variable.
    unknowns : what stands for the problem's; without them each is a variable.
    """
    graph = unknowns[0].graph if unknowns else Graph()
    unknowns = unknowns or [graph.variable(k) for k in exact.problem.variables]
    size = range(len(unknowns))
    smooth = [f.formula(unknowns) for f in exact.equations]
    scales = tuple(expression_formula(graph, g) for g in exact.factors)
    phi = None if short is None else graph.variable(FIRST + len(size))
    springs = tuple(
        write(unknowns, phi if k == short else None) for k, write in enumerate(exact.writers)
    )
    slopes = [[f.derivative(j).formula(unknowns) for j in size] for f in exact.equations]
    for push in exact.pushes:
        strength = push.strength(graph)
        for i, w in enumerate(push.weights):
            smooth[i] = smooth[i] - strength * w.formula(unknowns)
            slopes[i] = [
                f - strength * w.derivative(j).formula(unknowns) for j, f in enumerate(slopes[i])
            ]
    # a rest is put together without its spring: taken off again, its part would leave an interval's
    # width behind
    rests = [_without(smooth, [t for t in springs if t is not at]) for at in springs]
    bends = tuple(_Bent(at.pull * at.inverse, at.products(), at) for at in springs)
    return SpringChart(
        tuple(_without(smooth, springs)),
        _less(_rigid(slopes, springs), bends, scales),
        tuple(length(*at.vector) for at in springs),
        tuple(f for at, rest in zip(springs, rests, strict=True) for f in _directed(at, rest)),
        tuple(f for at, rest in zip(springs, rests, strict=True) for f in _balances(at, rest)),
        springs,
        tuple(map(tuple, slopes)),
        bends,
        tuple(
            bend._replace(products=bend.spring.products_at_equilibrium(rest))
            for bend, rest in zip(bends, rests, strict=True)
        ),
        scales,
        short,
        tuple(_turned(turn, springs, unknowns) for turn in exact.turns),
        exact.problem.is_gradient,
        tuple(unknowns),
    )


def _turned(turn: Turn, springs: Sequence[ConeFormulas], unknowns: Sequence[Unknown]) -> _Turned:
    graph, parts = unknowns[0].graph, (turn.slope, turn.bend, turn.levers)
    factor, arm = expression_formula(graph, turn.factor), expression_formula(graph, turn.arm)
    (moment, rest), (bend, rest_bend), levers = mapped(
        parts, lambda f: f.formula(unknowns), TrigonometricPolynomial
    )
    for at, (c, (x, y), (dx, dy)) in zip(springs, levers, strict=True):
        ux, uy = at.unit
        across = ux * y - uy * x
        bent = factor * (arm * (at.inverse * across.squared()))
        moment = moment - at.pull * (ux * x + uy * y)
        bend = bend - at.pull * (c * across + bent + (ux * dx + uy * dy))
    return _Turned(turn.weights, arm * moment + rest, arm * bend + rest_bend, factor)


def _rigid(smooth: Sequence[Sequence[Formula]], springs: Sequence[ConeFormulas]) -> Matrix:
    """The matrix M of some springs."""
    entries = [list(row) for row in smooth]
    for at in springs:
        for row, bends in zip(entries, at.bends, strict=True):
            for j, bend in enumerate(bends):
                row[j] = row[j] - at.pull * bend
    return tuple(map(tuple, entries))


def _less(
    rigid: Sequence[Sequence[Formula]], bends: Sequence[_Bent], scales: Sequence[Formula]
) -> Matrix:
    """The matrix M less the springs' parts."""
    entries = [list(row) for row in rigid]
    for bend in bends:
        for i, row in enumerate(entries):
            for j in range(len(row)):
                row[j] = row[j] - bend.factor * (scales[j] * bend.products[i][j])
    return tuple(map(tuple, entries))


def _without(smooth: Sequence[Formula], springs: Sequence[ConeFormulas]) -> list[Formula]:
    """The smooth part of each equation less the springs' parts."""
    total = list(smooth)
    for at in springs:
        total = [whole - at.pull * cosine for whole, cosine in zip(total, at.cosines, strict=True)]
    return total


def _directed(at: ConeFormulas, rest: Sequence[Formula]) -> list[Formula]:
    """With r = K (u.a_i, u.a_j): |a_i|^2 r_j - a_i.a_j r_i = K (a_i x a_j)(a_i x u)."""
    return [
        at.squares[i][i] * rest[j]
        - at.squares[i][j] * rest[i]
        + at.pull * (at.crosses[i][j] * at.sines[i])
        for pair in combinations(at.active, 2)
        for i, j in (pair, pair[::-1])
    ]


def _balances(at: ConeFormulas, rest: Sequence[Formula]) -> list[Formula]:
    """Gram's determinant: |r_i a_j - r_j a_i|^2 = (K a_i x a_j)^2."""
    return [
        rest[i].squared() * at.squares[j][j]
        + rest[j].squared() * at.squares[i][i]
        - 2 * (rest[i] * rest[j] * at.squares[i][j])
        - (at.pull * at.crosses[i][j]).squared()
        for i, j in combinations(at.active, 2)
    ]


def principal_minors(hessian: Matrix, *, whole: bool = False) -> list[Formula]:
    """All, with or without the determinant itself; none is negative where the Hessian is positive
    semidefinite.
    """
    size = len(hessian)
    return [
        determinant(tuple(tuple(hessian[i][j] for j in chosen) for i in chosen))
        for order in range(1, size + whole)
        for chosen in combinations(range(size), order)
    ]


class _Bent(NamedTuple):
    """What is taken off a matrix M: factor v (g v)^T, with the products v_i v_j and v, the sines of
    a spring.

    Of closed loops v stands in one row only, and another vector in the place of the second v.
    """

    factor: Formula
    products: Matrix
    spring: ConeFormulas


def bent(
    matrix: Matrix,
    bends: Sequence[_Bent],
    scales: Sequence[Formula],
    by: _Bent | None = None,
    extents: Sequence[Formula] | None = None,
) -> Formula:
    """det(M - sum of factor_s v_s (g v_s)^T), g being the scales.

    Springs that are in one equation are in M's row. For the others it is the sum over sets S of
    springs of (-1)^|S| times their factors times the sum over sets I, K of as many rows and columns
    of det(v_S in I) times det(g v_S in K) times the complementary minor of M with its sign (Cauchy
    and Binet; Lemma S2 of docs/soundness.md).

    Parameters
    ----------
    by : only the terms with this spring in S, which is none of ``bends``, less their sign.
    """
    size = len(matrix)
    entries = [list(row) for row in matrix]
    for bend in bends if extents is None else ():
        if len(bend.spring.active) == 1:
            (i,) = bend.spring.active
            row = zip(entries[i], scales, bend.products[i], strict=True)
            entries[i] = [m - bend.factor * (g * p) for m, g, p in row]
    rigid = tuple(map(tuple, entries))
    shared = [bend for bend in bends if len(bend.spring.active) > 1 or extents is not None]
    total = matrix[0][0].graph.constant(0)
    orders = range(size + 1) if by is None else range(size)
    for order in orders:
        for chosen in combinations(shared, order):
            among = chosen if by is None else (by, *chosen)
            factor = matrix[0][0].graph.constant(1)
            for bend in among:
                factor = factor * bend.factor
            if extents is not None:
                for bend, extent in zip(bends, extents, strict=True):
                    if bend not in chosen:
                        factor = factor * extent
            part = factor * _complement(rigid, among, scales)
            total = total + part if order % 2 == 0 else total - part
    return total


def _complement(matrix: Matrix, among: Sequence[_Bent], scales: Sequence[Formula]) -> Formula:
    """The sum over rows I and columns K of the springs' minors times the complementary minor of the
    matrix.
    """
    size, graph = range(len(matrix)), matrix[0][0].graph
    total = graph.constant(0)
    for rows in combinations(size, len(among)):
        for columns in combinations(size, len(among)):
            rest = tuple(
                tuple(matrix[i][k] for k in size if k not in columns) for i in size if i not in rows
            )
            minor = _springs_minor(among, rows, columns, graph.constant(1))
            for k in columns:
                minor = minor * scales[k]
            part = minor * (determinant(rest) if rest else 1)
            total = total + part if (sum(rows) + sum(columns)) % 2 == 0 else total - part
    return total


def _springs_minor(
    among: Sequence[_Bent], rows: Sequence[int], columns: Sequence[int], one: Formula
) -> Formula:
    """det(v_S in I) det(v_S in K)."""
    if not among:
        return one
    if len(among) == 1:
        return among[0].products[rows[0]][columns[0]]
    if len(among) == 2 and rows == columns:
        (a, b), (i, j) = (bend.products for bend in among), rows
        return a[i][i] * b[j][j] + a[j][j] * b[i][i] - 2 * (a[i][j] * b[i][j])
    first, second = (
        determinant(tuple(tuple(bend.spring.sines[i] for bend in among) for i in some))
        for some in (rows, columns)
    )
    return first * second
