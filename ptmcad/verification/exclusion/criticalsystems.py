"""The critical points of a map's question as solutions of systems of equations, from the
description's normal form.

Guarantee: let p be a point of the window near which the counts of the map are not constant. Then p
is the projection of a solution of one of the systems, in the box of its start (docs/soundness.md,
"Where counts change").
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations
from math import inf, pi

import numpy as np

from ptmcad.errors import ExpressionError
from ptmcad.verification.coordinates import evaluated
from ptmcad.verification.exclusion.systemtapes import CriticalSystem
from ptmcad.verification.kinds import kind_of
from ptmcad.verification.normalform.boxes import Floats
from ptmcad.verification.normalform.lattice import Range, SliceLattice
from ptmcad.verification.normalform.modelequations import Equations, Pair
from ptmcad.verification.normalform.operations import Formulas
from ptmcad.verification.normalform.unknownbounds import half_widths
from ptmcad.verification.normalform.waves import Waves, form_of, sides
from ptmcad.verification.planecurves import PLANE, polynomial

SHORT_SHARE = 16
"""A spring is short, for total counts, if its length is less than this part of the sum of its
vector's factors.
"""


_ANGLE = (-pi - 1e-6, pi + 1e-6)


def systems_of(lattice: SliceLattice) -> list[CriticalSystem]:
    """All systems of a map.

    Raises
    ------
    Unproved
        When real unknowns have no bound over the window that can be proved.
    """
    return list(_Systems(lattice, halves_over(lattice, lattice.window, lattice.window)).all())


def solutions_of(lattice: SliceLattice, halves: Floats | None) -> list[CriticalSystem]:
    """What is zero at the solutions that a map counts: a system for each choice of sides, in the
    order of these.

    Guarantee: over each point of the window all that are counted are solutions of it, in the box of
    its start; it may have others, and configurations without solution.

    Parameters
    ----------
    halves : as `halves_over` has them; None where there are none, and unknowns may be anything.
    """
    return list(_Systems(lattice, halves or (inf,) * form_of(lattice.slice).size).solutions())


def halves_over(lattice: SliceLattice, u: Range, v: Range) -> Floats:
    """Half the widths of ranges around zero that have the unknowns of all solutions, over a part of
    the window.

    Raises
    ------
    Unproved
        When real unknowns have no bound over it that can be proved.
    """
    form = form_of(lattice.slice)
    if all(form.is_circle):
        return (_ANGLE[1],) * form.size
    return half_widths(form, lattice.values(u, v))


def window_equations(lattice: SliceLattice) -> Equations:
    """The formulas of a map's equations, over the window in lattice steps and its unknowns."""
    f, slice = Formulas(), lattice.slice
    axes = {
        name: f.add(f.number(axis.low), f.multiply(f.variable(k), f.number(side)))
        for k, (name, axis, side) in enumerate(
            zip(PLANE.names(), slice.axes, lattice.square, strict=True)
        )
    }
    parameters = {n: f.number(0) for n in slice.model.free_lengths}
    for n, e in slice.parameters.items():
        parts = (f.polynomial(polynomial(terms), axes) for terms in (e.numerator, e.denominator))
        parameters[n] = f.divide(*parts)
    return Equations(form_of(slice), f, parameters, slice.model.positive)


class _Systems:
    """The systems of one map, and what they have in common."""

    def __init__(self, lattice: SliceLattice, halves: Floats):
        self.lattice, self.model, self._halves = lattice, window_equations(lattice), halves
        self.count, self.form = lattice.slice.count, self.model.form
        self.minima = self.form.is_gradient and kind_of(self.count).is_of_stable
        stable = self.form.stability if kind_of(self.count).is_of_stable else ()
        self.conditions: list[Waves] = [*self.form.inequalities, *stable]
        self.asked = [self.model.waves(c) for c in self.conditions]
        self.positive, self.turning, self.where = self.asked, list[int](), ""
        self.margins = self._margins()

    def all(self) -> Iterator[CriticalSystem]:
        """All of them, for springs on one line each on all sides of length zero."""
        for _ in self._sides():
            yield from self._on_side()

    def solutions(self) -> Iterator[CriticalSystem]:
        """The solutions that are counted, or minima where no others are; by few formulas, as
        windows are points.
        """
        m = self.model
        for _ in self._sides():
            equations, rows = m.equations(m.directions()), m.hessian(m.directions())
            others = [e for k in self.turning for e in (*m.balances(k), *m.directed(k))]
            minors = [*self._minors(rows), m.list.determinant(rows)] if self.minima else []
            yield self._system("solutions", equations, others, [*self.positive, *minors])

    def _sides(self) -> Iterator[None]:
        """Springs on one line each on all sides of length zero, one choice after the other."""
        m = self.model
        for side in sides(self.form):
            m.sides = side
            straight = [k for k, s in enumerate(m.cones) if s.name in side]
            self.turning = [k for k in range(len(m.cones)) if k not in straight]
            self.positive = [*self.asked, *map(m.ahead, straight)]
            self.where = "".join(
                f", {name} {'ahead' if sign > 0 else 'behind'}" for name, sign in side.items()
            )
            yield

    def _on_side(self) -> Iterator[CriticalSystem]:
        m, f, springs = self.model, self.model.list, self.turning
        charted = not self.minima and self.form.size > 1
        signs = [*self.positive]
        equations, rows = m.equations(m.directions()), m.hessian(m.directions())
        balanced = [] if self.form.closing else [m.balanced(k) for k in springs]
        determinant = f.determinant(rows)
        others = [e for k in springs for e in (*m.balances(k), *m.directed(k))]
        if self.minima:
            signs += [
                *self._minors(rows),
                *(entry for _, diagonal in balanced for entry in diagonal),
            ]
        long = (
            [f.subtract(f.length(*m.cones[k].vector), self._short(k)) for k in springs]
            if charted
            else []
        )
        yield self._system(
            "folds", equations, [determinant, *others, *(d for d, _ in balanced)], [*signs, *long]
        )
        for k in springs if charted else ():
            yield self._short_folds(k)
            yield self._cone(k)
        signs += [determinant] * self.minima
        # where margins are asked for, all minima are counted, too, so that folds ask for none
        for k, c in enumerate(self.positive):
            if k < len(self.conditions) and not any(
                any(key[0]) or any(key[1]) for key in self.conditions[k]
            ):
                yield self._system(f"boundary {k}", [c], [], [], unknowns=0)
            else:
                yield self._system(
                    f"boundary {k}", [*equations, c], others, [n for n in signs if n != c]
                )
        for k, (_, as_long) in enumerate(self.margins):
            taut = [value for j, (value, _) in enumerate(self.margins) if j != k]
            name = f"{kind_of(self.count).boundary} {k}"
            yield self._system(name, [*equations, *as_long], others, [*signs, *taut])

    def _minors(self, rows: Sequence[Sequence[int]]) -> list[int]:
        """The principal minors but the determinant; none is negative where the Hessian is positive
        semidefinite.
        """
        n, f = len(rows), self.model.list
        chosen = [c for size in range(1, n) for c in combinations(range(n), size)]
        return [f.determinant([[rows[i][j] for j in c] for i in c]) for c in chosen]

    def _short(self, k: int) -> int:
        return self.model.list.number(Fraction(float(self._reach(k) / SHORT_SHARE)))

    def _reach(self, k: int) -> Fraction:
        """About the largest length of a spring: the sum of the factors of its vector in the middle
        of the window.
        """
        at = [(a.low + a.high) / 2 for a in self.lattice.slice.axes]
        values = {name: Fraction(0) for name in self.lattice.slice.model.free_lengths}
        try:
            values |= {n: e.evaluate(*at) for n, e in self.lattice.slice.parameters.items()}
        except ExpressionError:
            return Fraction(1)
        factors = (
            evaluated(p, values) for row in self.model.cones[k].cone.vector for p in row.values()
        )
        return sum(map(abs, factors), Fraction(0)) or Fraction(1)

    def _short_folds(self, k: int) -> CriticalSystem:
        """Folds at which one spring is short, with its direction as one more unknown: |d| det H is
        a polynomial.

        |d| det (M - K/|d| w v^T) = |d| det M + K det of M with w as one more column and v as one more row; w is v but
        with closed loops.
        """
        m, f, n = self.model, self.model.list, self.form.size
        s, angle = m.cones[k], self.model.list.variable(n + 2)
        u: Pair = f.cosine(angle), f.sine(angle)
        directions = m.directions() | {k: u}
        rows = m.hessian(directions, without=k)
        length, turning, pushed = (
            f.dot(s.vector, u),
            *([f.cross(u, g) for g in some] for some in (s.slopes, s.weights)),
        )
        whole = [f.multiply(c, v) for c, v in zip(m.factors, turning, strict=True)]
        bordered = [[*row, v] for row, v in zip(rows, pushed, strict=True)] + [
            [*whole, f.number(0)]
        ]
        determinant = f.add(
            f.multiply(length, f.determinant(rows)), f.multiply(s.pull, f.determinant(bordered))
        )
        equations = [*m.equations(directions), f.cross(s.vector, u)]
        short = f.subtract(self._short(k), f.length(*s.vector))
        return self._system(
            f"folds with {s.name} short",
            equations,
            [determinant, *m.balances(k)],
            [*self.positive, length, short],
            unknowns=n + 1,
        )

    def _cone(self, k: int) -> CriticalSystem:
        """Configurations in which one spring has no length, and some direction of it balances the
        other forces.
        """
        m, f, n = self.model, self.model.list, self.form.size
        s, name = m.cones[k], f"cones of {m.cones[k].name}"
        if n > 2:
            angle = f.variable(n + 2)
            equations = m.equations(m.directions() | {k: (f.cosine(angle), f.sine(angle))})
            return self._system(
                name, [*s.vector, *equations], m.balances(k), self.positive, unknowns=n + 1
            )
        fixed = [i for i, g in enumerate(s.weights) if f.constant(g[0]) == 0 == f.constant(g[1])]
        if fixed:
            i = fixed[0]
            signs = [*self.positive, m.outweighs(k, 1 - i)]
            return self._system(name, s.vector, [m.without(k)[i]], signs)
        return self._system(name, s.vector, m.balances(k), self.positive)

    def _margins(self) -> list[tuple[int, tuple[int, ...]]]:
        """What is asked of stable solutions besides, and what is zero where one begins or ceases to
        be counted.
        """
        m, f = self.model, self.model.list
        found: list[tuple[int, tuple[int, ...]]] = []
        for margin in self.form.margins:
            if margin.vector is None:
                value = m.waves(margin.value)
                found.append((value, (value,)))
                continue
            free, vector = (
                m.polynomial(margin.free),
                (m.waves(margin.vector[0]), m.waves(margin.vector[1])),
            )
            value = f.subtract(f.length(*vector), free)
            found.append((value, vector if f.constant(free) == 0 else (value,)))
        return found

    def _system(
        self,
        name: str,
        first: Sequence[int],
        zero: Sequence[int],
        not_negative: Sequence[int],
        unknowns: int | None = None,
    ) -> CriticalSystem:
        """A system, of whose formulas that are zero the first ones are evaluated before all others."""
        ranges = [(0.0, float(self.lattice.steps))] * 2
        number = self.form.size if unknowns is None else unknowns
        if number:
            ranges += [(-half, half) for half in self._halves] + [_ANGLE] * (
                number - self.form.size
            )
        zeros, signs = (*first, *dict.fromkeys(zero)), (*dict.fromkeys(not_negative),)
        return CriticalSystem(
            name + self.where, self.model.list, zeros, signs, len(first), np.array(ranges)
        )
