"""The eigenvalues of a Hessian whose entries are numbers of one real field.

Guarantee: how many of them are zero is known by algebra, and rational ones are given exactly: of two unknowns by the
trace and the determinant, of more by the characteristic polynomial. Others are enclosed, with more than two unknowns by
certified eigenvalues of a matrix of balls.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations
from math import isqrt
from typing import NamedTuple, TypeVar

from flint import acb_mat, arb, fmpq, nmod

from ptmcad.algebra.determinants import laplace
from ptmcad.algebra.number_field import Element
from ptmcad.algebra.rational_roots import rational_roots
from ptmcad.text.balls import ball_of, enclosed
from ptmcad.text.enclosure import Enclosure
from ptmcad.text.flint_numbers import to_fraction

_Ring = TypeVar("_Ring", fmpq, nmod)
Matrix = tuple[tuple[Element, ...], ...]


class Number(NamedTuple):
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
    trace, spread : of a 2 x 2 Hessian; the latter is the squared difference of its eigenvalues.
    eigenvalue : a rational one of a 2 x 2 Hessian, when there is one and the other is irrational, or both are equal.
    nullity : the number of eigenvalues that are zero; of a Jacobian that is no Hessian only whether it is singular.
    rationals : of a larger Hessian the other rational eigenvalues, each with its multiplicity.
    """

    matrix: Matrix
    nullity: int
    trace: Element | None = None
    spread: Element | None = None
    eigenvalue: Fraction | None = None
    rationals: tuple[tuple[Fraction, int], ...] = ()


def stiffness_of(matrix: Matrix, symmetric: bool) -> Stiffness:
    """What algebra knows of a matrix's eigenvalues."""
    size = len(matrix)
    if not symmetric:
        return Stiffness(matrix, int(laplace(matrix).is_zero))
    if size == 2:
        (h11, h12), (_, h22) = matrix
        trace, determinant = h11 + h22, h11 * h22 - h12 * h12
        difference = h11 - h22
        spread = difference * difference + (h12 * h12).times(fmpq(4))
        nullity = int(determinant.is_zero) + int(determinant.is_zero and trace.is_zero)
        return Stiffness(matrix, nullity, trace, spread, _rational_eigenvalue(trace, determinant))
    if size == 1:
        return Stiffness(matrix, int(matrix[0][0].is_zero))
    # the characteristic polynomial's coefficients from the constant one on are sums of principal minors, but for signs
    sums = []
    for order in range(size, 0, -1):
        minors = (
            laplace([[matrix[i][j] for j in chosen] for i in chosen]) for chosen in combinations(range(size), order)
        )
        total = next(minors)
        for minor in minors:
            total = total + minor
        sums.append(total if order % 2 == 0 else total.times(fmpq(-1)))
    nullity = next((k for k, total in enumerate(sums) if not total.is_zero), size)
    return Stiffness(matrix, nullity, rationals=tuple(rational_roots(sums[nullity:])))


def eigenvalues(stiffness: Stiffness, number: Callable[[Element], Number]) -> tuple[Number, ...]:
    """The Hessian's eigenvalues, the smallest first; a ball that is not finite stands for one not yet known.

    Parameters
    ----------
    number : an element of the field at the context's precision.
    """
    size = len(stiffness.matrix)
    if size == 1:
        return (number(stiffness.matrix[0][0]),)
    if stiffness.trace is not None and stiffness.spread is not None:
        return _two(number(stiffness.trace), number(stiffness.spread), stiffness.eigenvalue)
    entries = [[number(entry).ball for entry in row] for row in stiffness.matrix]
    try:
        found = acb_mat(size, size, [x for row in entries for x in row]).eig(multiple=True)
    except ValueError:  # the balls are too wide for the eigenvalues to be told from each other's clusters
        return (Number(None, arb.nan()),) * size
    balls = sorted((value.real for value in found), key=lambda ball: float(ball.mid()))
    near_zero = [ball for ball in balls if ball.contains(0)]
    if len(near_zero) != stiffness.nullity:
        return (Number(None, arb.nan()),) * size
    values = [Number(Fraction(0), arb(0)) if ball.contains(0) else Number(None, ball) for ball in balls]
    for root, multiplicity in stiffness.rationals:
        near = [k for k, ball in enumerate(balls) if ball.overlaps(ball_of(root))]
        if len(near) != multiplicity:
            return (Number(None, arb.nan()),) * size
        for k in near:
            values[k] = Number(root, ball_of(root))
    return tuple(values)


def square_root(square: Number) -> Number:
    """Of a number that is not negative; exact where it is rational."""
    if square.exact is None:
        return Number(None, square.ball.sqrt())
    numerator, denominator = isqrt(square.exact.numerator), isqrt(square.exact.denominator)
    root = Fraction(numerator, denominator)
    return Number(root if root * root == square.exact else None, ball_of(square.exact).sqrt())


def _rational_eigenvalue(trace_element: Element, determinant_element: Element) -> Fraction | None:
    """A rational eigenvalue of the Hessian when there is one and the other is irrational, or both are equal.

    With coefficients t_i of the trace and d_i of the determinant in powers of the field's generator, q^2 - q trace +
    determinant = 0 says q t_i = d_i for each i > 0, which leaves one candidate unless the trace is rational. In that
    case a rational eigenvalue makes the other one rational too. The equation holds modulo a prime too, q being integral
    over the numbers without that prime in their denominators; so most often residues modulo the prime exclude it.
    """
    t, d = trace_element.image_coefficients(), determinant_element.image_coefficients()
    if t is not None and d is not None and any(t[1:]) and _eigenvalue(t, d) is None:
        return None
    q = _eigenvalue(trace_element.coefficients(), determinant_element.coefficients())
    return None if q is None else to_fraction(q)


def _eigenvalue(trace: Sequence[_Ring], determinant: Sequence[_Ring]) -> _Ring | None:
    """The q of the field's ground ring, when the trace's coefficients behind the first are not all zero."""
    for t, d in zip(trace[1:], determinant[1:], strict=True):
        if t != 0:
            q = d / t
            holds = q * q - q * trace[0] + determinant[0] == 0 and all(
                q * a == b for a, b in zip(trace[1:], determinant[1:], strict=True)
            )
            return q if holds else None
    return None


def _two(trace: Number, spread: Number, rational: Fraction | None) -> tuple[Number, Number]:
    """The Hessian's eigenvalues, the smaller first; a ball that is not finite stands for one not yet known."""
    root = square_root(spread)
    balls = ((trace.ball - root.ball) / 2, (trace.ball + root.ball) / 2)
    if trace.exact is not None and root.exact is not None:
        return Number((trace.exact - root.exact) / 2, balls[0]), Number((trace.exact + root.exact) / 2, balls[1])
    if rational is not None:
        if (excess := 2 * ball_of(rational) - trace.ball) > 0:
            return Number(None, balls[0]), Number(rational, balls[1])
        if excess < 0:
            return Number(rational, balls[0]), Number(None, balls[1])
        return Number(None, arb.nan()), Number(None, arb.nan())
    return Number(None, balls[0]), Number(None, balls[1])
