"""The eigenvalues of a Hessian whose entries are numbers of one real field.

Guarantee: how many of them are zero is known by algebra, and rational ones are given exactly, by
the characteristic polynomial. Others are enclosed, as certified eigenvalues of a matrix of balls.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import reduce
from itertools import combinations
from math import isqrt
from operator import add
from typing import NamedTuple

from flint import acb_mat, arb, arb_mat, ctx, fmpq

from ptmcad.algebra.number_field import FieldElement, rational_roots
from ptmcad.algebra.plane_determinants import laplace
from ptmcad.text.balls import ball_of, enclosed
from ptmcad.text.enclosure import Enclosure

Matrix = tuple[tuple[FieldElement, ...], ...]


class RealNumber(NamedTuple):
    """A number as its exact value where it is rational, and a ball."""

    exact: Fraction | None
    ball: arb

    def enclosure(self, digits: int) -> Enclosure | None:
        """An enclosure that settles so many digits; None when the ball is too wide."""
        if self.exact is not None:
            return Enclosure(self.exact, self.exact)
        return enclosed(self.ball, digits)


class Stiffness(NamedTuple):
    """A Hessian, or another Jacobian, at one solution.

    Attributes
    ----------
    hessian : its rows; none of another Jacobian.
    nullity : the number of eigenvalues that are zero; of a Jacobian that is no Hessian only whether
        it is singular.
    rationals : of a Hessian the other rational eigenvalues, each with its multiplicity.
    """

    hessian: Matrix
    nullity: int
    rationals: tuple[tuple[Fraction, int], ...] = ()


def stiffness_of(jacobian: Matrix, matrix: Matrix) -> Stiffness:
    """What algebra knows of a matrix's eigenvalues.

    Parameters
    ----------
    matrix : the Jacobian where it is a Hessian, else none.
    """
    size = len(matrix)
    if not matrix:
        return Stiffness((), int(laplace(jacobian).is_zero))
    # the characteristic polynomial's coefficients from the constant one on are sums of principal
    # minors, but for signs
    sums = []
    for order in range(size, 0, -1):
        minors = (
            laplace([[matrix[i][j] for j in chosen] for i in chosen])
            for chosen in combinations(range(size), order)
        )
        total = reduce(add, minors)
        sums.append(total if order % 2 == 0 else total.times(fmpq(-1)))
    nullity = next((k for k, total in enumerate(sums) if not total.is_zero), size)
    return Stiffness(matrix, nullity, rationals=tuple(rational_roots(sums[nullity:])))


def eigenvalues(
    stiffness: Stiffness, number: Callable[[FieldElement], RealNumber]
) -> tuple[RealNumber, ...]:
    """The Hessian's eigenvalues, the smallest first; a ball that is not finite stands for one not
    yet known.

    Parameters
    ----------
    number : an element of the field at the context's precision.
    """
    size = len(stiffness.hessian)
    if size <= 1:
        return tuple(number(entry) for row in stiffness.hessian for entry in row)
    known = [Fraction(0)] * stiffness.nullity
    known += [root for root, multiplicity in stiffness.rationals for _ in range(multiplicity)]
    if len(known) == size:
        return tuple(RealNumber(value, ball_of(value)) for value in sorted(known))
    unknown = (RealNumber(None, arb.nan()),) * size
    balls = _in_order(
        arb_mat(size, size, [number(entry).ball for row in stiffness.hessian for entry in row])
    )
    near_zero = [ball for ball in balls if ball.contains(0)]
    if len(balls) < size or len(near_zero) != stiffness.nullity:
        return unknown
    values = [
        RealNumber(Fraction(0), arb(0)) if ball.contains(0) else RealNumber(None, ball)
        for ball in balls
    ]
    for root, multiplicity in stiffness.rationals:
        near = [k for k, ball in enumerate(balls) if ball.overlaps(ball_of(root))]
        if len(near) != multiplicity:
            return unknown
        for k in near:
            values[k] = RealNumber(root, ball_of(root))
    return tuple(values)


def _in_order(matrix: arb_mat) -> list[arb]:
    """The eigenvalues of a symmetric matrix, the smallest first; none where its balls are too wide.

    FLINT does not separate equal ones from others. Then a small diagonal matrix is added: it moves
    the k-th eigenvalue by its norm at most (Weyl; Horn & Johnson, Matrix Analysis, corollary
    4.3.15). What parts them must be far larger than the precision, or FLINT does not isolate them.
    """
    size = matrix.nrows()
    try:
        found = acb_mat(matrix).eig(multiple=True)
        moved = arb(0)
    except ValueError:
        steps = [arb(k * k + 1) * arb(2) ** (-ctx.prec // 3) for k in range(size)]
        shift = arb_mat(
            size, size, [steps[i] if i == j else 0 for i in range(size) for j in range(size)]
        )
        try:
            found = acb_mat(matrix + shift).eig()
        except ValueError:
            return []
        moved = arb(0, steps[-1])
    return sorted((value.real + moved for value in found), key=lambda ball: ball.mid())


def square_root(square: RealNumber) -> RealNumber:
    """Of a number that is not negative; exact where it is rational."""
    if square.exact is None:
        return RealNumber(None, square.ball.sqrt())
    numerator, denominator = isqrt(square.exact.numerator), isqrt(square.exact.denominator)
    root = Fraction(numerator, denominator)
    return RealNumber(root if root * root == square.exact else None, ball_of(square.exact).sqrt())
