"""The equations of a map's model as formulas in parameters and unknowns, from the description's
normal form.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from math import prod
from typing import NamedTuple

from flint import fmpq_mpoly

from ptmcad.verification.coordinates import monomials
from ptmcad.verification.normalform.operations import Formulas
from ptmcad.verification.normalform.springlines import SpringLine
from ptmcad.verification.normalform.waves import Form, Sides, SpringCone, Waves, by

Pair = tuple[int, int]


class ConeFormulas(NamedTuple):
    """A spring with a free length: its pull, its vector, and the vector's derivatives.

    Attributes
    ----------
    slopes : its derivatives by the unknowns, divided by the factors of these.
    weights : for each equation what the spring's direction is multiplied by in it, divided by the
        equation's factor: the slopes, but with closed loops the derivative along them in the last
        equation, and nothing in the others.
    bends : the weights' derivatives, divided by the factors of the equations.
    """

    pull: int
    vector: Pair
    slopes: tuple[Pair, ...]
    weights: tuple[Pair, ...]
    bends: tuple[Pair, ...]
    cone: SpringCone

    @property
    def name(self) -> str:
        """That of the spring."""
        return self.cone.name

    @property
    def line(self) -> SpringLine:
        """That along which the vector stays."""
        assert self.cone.line is not None
        return self.cone.line


class Equations:
    """A form's formulas in its unknowns, which are the variables after the two axes.

    Parameters
    ----------
    parameters : what stands for each parameter.
    positive : those that are; what all terms of an equation have of them is divided out.
    """

    def __init__(
        self,
        form: Form,
        formulas: Formulas,
        parameters: Mapping[str, int],
        positive: Collection[str] = (),
    ):
        self.form, self.list, self.parameters, self._positive = (
            form,
            formulas,
            parameters,
            {*positive},
        )
        self.sides: Sides = {}
        self.unknowns = [formulas.variable(k + 2) for k in range(form.size)]
        f = formulas
        # a bar that is short makes its own equation small, and all that is next to it: nothing is
        # lost by dividing
        self._common = [self._in_all(i) for i in range(form.size)]
        self.factors = [f.product(parameters[name] for name in names) for names in self._common]
        self.cones = [s for s in map(self._spring, form.cones) if f.constant(s.pull) != 0]
        rows = self._divided(form.equations)
        self.smooth = list(map(self.waves, rows))
        self.jacobian = [list(map(self.waves, self._slopes(row))) for row in rows]

    def _in_all(self, i: int) -> tuple[str, ...]:
        """The positive parameters that are in every term of an equation and of the springs' parts
        in it.
        """
        rows = [self.form.equations[i]]
        for cone in self.form.cones:
            rows += [by(coordinate, i) for coordinate in cone.vector] + [*cone.weights[i]]
        found = [
            {name for name, _ in names}
            for row in rows
            for p in row.values()
            for _, names in monomials(p)
        ]
        common = set.intersection(*found) if found else set()
        return tuple(sorted(common & self._positive))

    def _slopes(self, row: Waves) -> list[Waves]:
        """The derivatives by the unknowns."""
        return [by(row, k) for k in range(self.form.size)]

    def _divided(self, rows: Sequence[Waves]) -> list[Waves]:
        """Those of all equations, without the equations' factors."""
        return [_without(row, names) for row, names in zip(rows, self._common, strict=True)]

    def polynomial(self, p: fmpq_mpoly) -> int:
        """A polynomial in the parameters."""
        return self.list.polynomial(p, self.parameters)

    def waves(self, row: Waves) -> int:
        """A sum of waves."""
        f, total = self.list, self.list.number(0)
        for (turned, raised, sine), p in row.items():
            part = self.polynomial(p)
            for x, exponent in zip(self.unknowns, raised, strict=True):
                part = f.multiply(part, f.power(x, exponent))
            if any(turned):
                angle = f.sum(
                    f.multiply(f.number(t), x) for t, x in zip(turned, self.unknowns, strict=True)
                )
                part = f.multiply(part, f.sine(angle) if sine else f.cosine(angle))
            total = f.add(total, part)
        return total

    def _spring(self, cone: SpringCone) -> ConeFormulas:
        slopes = [self._divided(self._slopes(coordinate)) for coordinate in cone.vector]
        weights = [self._divided([weight[k] for weight in cone.weights]) for k in (0, 1)]
        bends = [[bend for row in rows for bend in self._slopes(row)] for rows in weights]

        def pairs(of: Sequence[Sequence[Waves]]) -> tuple[Pair, ...]:
            across, up = (map(self.waves, some) for some in of)
            return tuple(zip(across, up, strict=True))

        vector = self.waves(cone.vector[0]), self.waves(cone.vector[1])
        return ConeFormulas(
            self.polynomial(cone.pull), vector, pairs(slopes), pairs(weights), pairs(bends), cone
        )

    def equations(self, directions: Mapping[int, Pair], without: int | None = None) -> list[int]:
        """The equations, with the directions of the springs; without the part of one, what balances
        it.
        """
        f = self.list
        some = [(k, s) for k, s in enumerate(self.cones) if k != without]
        return [
            f.subtract(
                smooth,
                f.sum(f.multiply(s.pull, f.dot(directions[k], s.weights[i])) for k, s in some),
            )
            for i, smooth in enumerate(self.smooth)
        ]

    def hessian(
        self, directions: Mapping[int, Pair], without: int | None = None
    ) -> list[list[int]]:
        """The equations' Jacobian, rows divided by the factors; of one spring only what has not its
        inverse length.
        """
        f, n = self.list, self.form.size
        rows = [list(row) for row in self.jacobian]
        for k, s in enumerate(self.cones):
            u = directions[k]
            turning, pushed = ([f.cross(u, g) for g in some] for some in (s.slopes, s.weights))
            for i in range(n):
                for j in range(n):
                    part = f.dot(u, s.bends[i * n + j])
                    if s.name in self.sides:
                        part = f.add(part, f.multiply(f.number(self._spin(s, j)), pushed[i]))
                    elif k != without:
                        inverse = f.inverse_length(*s.vector)
                        whole = f.multiply(turning[j], self.factors[j])
                        part = f.add(part, f.multiply(f.multiply(pushed[i], whole), inverse))
                    rows[i][j] = f.subtract(rows[i][j], f.multiply(s.pull, part))
        return rows

    def directions(self) -> dict[int, Pair]:
        """Those of all springs, from their vectors; of those on one line each, on the side that is
        looked at.
        """
        return {
            k: self._pointed(s) if s.name in self.sides else self.list.direction(*s.vector)
            for k, s in enumerate(self.cones)
        }

    def _ahead(self, s: ConeFormulas) -> Pair:
        """The vector along which such a spring points, on its side, before its line turns."""
        x, y = (
            self.list.multiply(self.list.number(self.sides[s.name]), self.polynomial(t))
            for t in s.line.vector
        )
        return x, y

    def _spin(self, s: ConeFormulas, j: int) -> Fraction:
        """How fast such a line turns with an unknown."""
        return Fraction(s.line.twice[j], 2)

    def _with_line(self, s: ConeFormulas, vector: Pair) -> Pair:
        """A vector turned as such a line is."""
        f, (x, y), twice = self.list, vector, s.line.twice
        if not any(twice):
            return vector
        angle = f.sum(
            f.multiply(f.number(Fraction(n, 2)), q)
            for n, q in zip(twice, self.unknowns, strict=True)
        )
        across, up = f.cosine(angle), f.sine(angle)
        return f.subtract(f.multiply(x, across), f.multiply(y, up)), f.dot((x, y), (up, across))

    def _pointed(self, s: ConeFormulas) -> Pair:
        f, (x, y) = self.list, self._ahead(s)
        p, q = f.constant(x), f.constant(y)
        if p is not None and q is not None and (p == 0 or q == 0):
            return self._with_line(s, (f.number((p > 0) - (p < 0)), f.number((q > 0) - (q < 0))))
        return self._with_line(s, f.direction(x, y))

    def ahead(self, k: int) -> int:
        """What is positive where a spring on one line is on its side."""
        s = self.cones[k]
        return self.list.dot(self._with_line(s, self._ahead(s)), s.vector)

    def without(self, k: int) -> list[int]:
        """The equations without the part of one spring, which is what balances it."""
        return self.equations(self.directions(), without=k)

    def _adjugates(self, k: int) -> Iterator[tuple[Pair, int]]:
        """For each two unknowns adj(A) r and K det(A), with the weights of a spring as rows of A."""
        f, s, rest = self.list, self.cones[k], self.without(k)
        for i, j in combinations(range(self.form.size), 2):
            (ai, bi), (aj, bj) = s.weights[i], s.weights[j]
            x, y = f.cross((bj, bi), (rest[j], rest[i])), f.cross((ai, aj), (rest[i], rest[j]))
            yield (x, y), f.multiply(s.pull, f.cross((ai, bi), (aj, bj)))

    def directed(self, k: int) -> list[int]:
        """What is zero at equilibria and has the direction of a spring only next to det A: adj(A)
        r - K det(A) u.
        """
        f, u = self.list, self.directions()[k]
        return [
            f.subtract(x, f.multiply(z, v))
            for both, z in self._adjugates(k)
            for x, v in zip(both, u, strict=True)
        ]

    def balances(self, k: int) -> list[int]:
        """What is zero at equilibria whatever the direction of a spring: |adj(A) r|^2 - (K det
        A)^2.
        """
        f = self.list
        return [f.subtract(f.dot(both, both), f.power(z, 2)) for both, z in self._adjugates(k)]

    def outweighs(self, k: int, i: int) -> int:
        """(K |g|)^2 - r^2 for the i-th unknown: not negative where a spring without length balances
        the rest.
        """
        f, s = self.list, self.cones[k]
        return f.subtract(
            f.multiply(f.power(s.pull, 2), f.dot(s.weights[i], s.weights[i])),
            f.power(self.without(k)[i], 2),
        )

    def balanced(self, k: int) -> tuple[int, list[int]]:
        """The determinant, and |d| times the diagonal, of the Hessian as they are at equilibria.

        There K u.g_i = r_i, so that (u x g_i)(u x g_j) = g_i.g_j - r_i r_j/K^2, with nothing of the
        direction; the slopes g_i are the weights w_i here, as they are without closed loops.
        """
        f, s, n = self.list, self.cones[k], self.form.size
        cosines = [f.divide(r, s.pull) for r in self.without(k)]
        rows = self.hessian(self.directions(), without=k)
        length = f.length(*s.vector)

        def turning(i: int, j: int) -> int:
            product = f.subtract(
                f.dot(s.slopes[i], s.slopes[j]), f.multiply(cosines[i], cosines[j])
            )
            return f.multiply(f.multiply(s.pull, self.factors[j]), product)

        diagonal = [f.subtract(f.multiply(length, rows[i][i]), turning(i, i)) for i in range(n)]
        total = f.multiply(length, f.determinant(rows)) if n > 1 else f.multiply(length, rows[0][0])
        for i in range(n):
            for j in range(n):
                minor = [
                    [x for c, x in enumerate(row) if c != j] for r, row in enumerate(rows) if r != i
                ]
                part = f.multiply(turning(i, j), f.determinant(minor) if minor else f.number(1))
                total = f.add(total, part) if (i + j) % 2 else f.subtract(total, part)
        return f.multiply(total, f.inverse_length(*s.vector)), diagonal


def _without(row: Waves, names: Sequence[str]) -> Waves:
    """A row of which all terms have these parameters, divided by them."""

    def divided(p: fmpq_mpoly) -> fmpq_mpoly:
        gens = dict(zip(p.context().names(), p.context().gens(), strict=True))
        return p / prod((gens[name] for name in names), start=p.context().constant(1))

    return {key: divided(p) for key, p in row.items()} if names else row
