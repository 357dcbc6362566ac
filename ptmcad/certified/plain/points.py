"""The solutions of a problem at one rational point of a slice, counted with proof.

Guarantee: when a `PointCount` is decided, each solution that the count needs has its own box, proved to hold exactly
one, and it is proved that there are no others; signs of eigenvalues are those of intervals. What is not proved is
undecided. Springs without length are no solutions: total counts do not have them.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb, arb_mat, ctx

from ptmcad.certified.arb_evaluation import ball, run_arb
from ptmcad.certified.arb_isolation import Box, refined
from ptmcad.certified.distinct import FULL_TURN, distinct
from ptmcad.certified.plain.bounds import Range, ranges
from ptmcad.certified.plain.chart import chart, principal_minors
from ptmcad.certified.plain.problem import FIRST, Problem, problem_of
from ptmcad.certified.points import BUDGET, MAX_OPEN_BOXES, MIN_BOX_WIDTHS, PRECISIONS, QUICK_BUDGET, PointCount, boxed
from ptmcad.certified.search import Boxes, isolate
from ptmcad.certified.system import System, system
from ptmcad.certified.tape import Tape, enclosing_floats, record
from ptmcad.question.slice import Count, Slice


@dataclass(frozen=True, slots=True, eq=False)
class PlainCounter:
    """Counts at points of one slice, with the formulas written out once.

    Attributes
    ----------
    all, minima : the systems that a search prunes with.
    equations : the equations alone.
    hessian : a tape of one stage with the Hessian's entries row by row.
    """

    slice: Slice
    problem: Problem
    ranges: tuple[Range, ...]
    all: System
    minima: System
    equations: System
    hessian: Tape

    def at(self, x: Fraction, y: Fraction, count: Count, *, thorough: bool = True) -> PointCount:
        """What ``count`` needs at the point (x, y) of the two axes.

        ``thorough`` is False where it is better not to decide a hard point than to take long for it.

        Raises
        ------
        ArithmeticError
            When the counts contradict Euler's sum on the torus, which would be a fault of this program.
        """
        only_minima = self.problem.is_gradient and count is Count.STABLE
        found = self._zeros(x, y, only_minima, thorough)
        if found is None:
            return PointCount()
        unique, narrow = found
        if not self.problem.is_gradient:
            solutions = tuple(boxed(u, n, "", self.problem.variables) for u, n in zip(unique, narrow, strict=True))
            return PointCount(total=len(solutions), solutions=solutions, decided=True)
        size = len(self.problem.unknowns)
        solutions, index = (), [0] * (size + 1)
        for wide, box in zip(unique, narrow, strict=True):
            negative = self._index(x, y, wide, box)
            if negative is None:
                return PointCount()
            index[negative] += 1
            if negative == 0 or not only_minima:
                signs = "+" * (size - negative) + "-" * negative
                solutions = (*solutions, boxed(wide, box, signs, self.problem.variables))
        if only_minima:
            return PointCount(stable=index[0], solutions=solutions, decided=True)
        smooth = not self.problem.cones and not self.problem.reals
        if smooth and sum((-1) ** k * number for k, number in enumerate(index)):
            raise ArithmeticError(f"critical points of a function on the torus by index {index} at ({x}, {y})")
        cones = 0 if smooth else None
        return PointCount(len(solutions), index[0], None, tuple(index), cones, solutions, True)

    def _zeros(self, x: Fraction, y: Fraction, only_minima: bool, thorough: bool) -> tuple[Boxes, Boxes] | None:
        """Boxes with exactly one solution each, and narrower ones, each solution once; None when undecided."""
        (x_low, x_high), (y_low, y_high) = enclosing_floats(x), enclosing_floats(y)
        low, high = zip(*self.ranges, strict=True)
        start = np.array([[x_low, y_low, *low, x_high, y_high, *high]])
        variables = 2 + len(low)
        arguments = (self.minima if only_minima else self.all).arguments()
        budget = BUDGET if thorough else QUICK_BUDGET
        for finest in MIN_BOX_WIDTHS if thorough else MIN_BOX_WIDTHS[:1]:
            limits = finest, budget, MAX_OPEN_BOXES
            found = isolate(arguments, self.equations.arguments(), start, limits, np.ones(variables))
            if not len(found.left()):
                periods = np.zeros(variables)
                for k, name in enumerate(self.problem.unknowns, FIRST):
                    periods[k] = 0.0 if name in self.problem.reals else FULL_TURN
                kept = distinct(found.unique, found.narrow, FIRST, periods)
                return None if kept is None else (found.unique[kept], found.narrow[kept])
        return None

    def _index(self, x: Fraction, y: Fraction, unique: Boxes, narrow: Boxes) -> int | None:
        """The number of negative eigenvalues at a proved zero."""
        size = len(self.problem.unknowns)
        for precision in PRECISIONS:
            with ctx.workprec(precision):
                box: Box = (ball(x, x), ball(y, y), *(
                    ball(Fraction(float(unique[k])), Fraction(float(unique[k + 2 + size])))
                    for k in self.problem.variables
                ))  # fmt: skip
                values = run_arb(self.hessian, refined(self.equations, box, precision), precision)
                entries = [values[int(place)] for place in self.hessian.outputs[0]]
                found = inertia(arb_mat(size, size, entries))
            if found is not None:
                return found
        return None


def plain_counter(slice: Slice) -> PlainCounter:
    """Write the solutions of a slice out, to count them at its points.

    Raises
    ------
    ConfigError, GeometryError
        As `problem_of` and `ranges` do.
    """
    problem = problem_of(slice)
    at = chart(problem)
    vanishing = ((), at.balances)
    return PlainCounter(
        slice,
        problem,
        ranges(problem, slice.axes),
        system(at.equations, problem.variables, vanishing, (), at.hessian),
        system(at.equations, problem.variables, vanishing, principal_minors(at.hessian), at.hessian),
        system(at.equations, problem.variables, jacobian=at.hessian),
        record([[entry for row in at.hessian for entry in row]]),
    )


def inertia(matrix: arb_mat) -> int | None:
    """The number of negative eigenvalues of every symmetric matrix in a matrix of balls; None when undecided.

    By Sylvester's law: with the columns of V near eigenvectors, V' H V is strictly diagonally dominant, so that neither
    it nor V is singular, and the signs of its diagonal are those of its eigenvalues (Gershgorin).
    """
    size = matrix.nrows()
    middle = np.array([[float(matrix[i, j].mid()) for j in range(size)] for i in range(size)])
    if not np.isfinite(middle).all():
        return None
    vectors = np.linalg.eigh((middle + middle.T) / 2)[1]
    v = arb_mat(size, size, [float(entry) for entry in vectors.flat])
    form = v.transpose() * matrix * v
    negative = 0
    for i in range(size):
        off = sum((abs(form[i, j]) for j in range(size) if j != i), arb(0))
        if not abs(form[i, i]) > off:
            return None
        negative += bool(form[i, i] < 0)
    return negative
