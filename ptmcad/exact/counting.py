"""Solutions of a system at a rational point of a slice, isolated and counted.

Guarantee: exact for any number of unknowns; `DegeneratePoint` is raised when a solution there has a
singular Jacobian, so no count is ever given on the discriminant variety.

The real roots of a univariate representation are isolated, then the Hessian's inertia there is
found by ball arithmetic, with precision doubled until every sign is certain (the Hessian is
nonsingular, so this ends).

A condition that is zero at a solution is not positive there; it is found to be zero by a greatest
common divisor.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, pairwise
from typing import NamedTuple

from flint import arb, arb_mat, ctx, fmpq

from ptmcad.algebra.descartes import root_bound
from ptmcad.algebra.fibre_algebra import (
    Divisor,
    UnivariateRepresentation,
    WorkLimit,
    unknowns_in_balls,
    vanishing_divisor,
)
from ptmcad.algebra.polynomials import Values
from ptmcad.algebra.real_roots import RealRoot, is_root_of, isolate
from ptmcad.algebra.trigonometric_ring import RationalPolynomial
from ptmcad.answer.counts import Counts, counts_of_signs, euler_sum
from ptmcad.answer.regionmap import Solution
from ptmcad.exact.models.system import ParametricSystem
from ptmcad.exact.point_system import PointSystem, simple_solutions, text_of_point
from ptmcad.text.flint_numbers import to_fraction

_FIRST_BITS = 128
"""Two machine words: nearly always enough, and in balls hardly more work than one."""
_ROOM = 2**10
"""A solution is alone in so many times its box, so that Newton's method finds it from the box's
middle.
"""


class Equilibria(NamedTuple):
    """All real solutions that count at a rational point, in disjoint boxes.

    Attributes
    ----------
    solutions : in a potential's case with the signs of the Hessian's eigenvalues, else of the
        stability conditions in their order, 0 where one is zero.
    bits : the precision at which every sign was certain and the boxes were disjoint.
    held : the number of stable ones at which all conditions for stability are positive.
    """

    counts: Counts
    solutions: tuple[Solution, ...]
    bits: int
    held: int = 0


def equilibria(
    system: ParametricSystem, values: Values, most: WorkLimit | None = None
) -> Equilibria:
    """All real solutions that count at rational values of all parameters, by real-root isolation.

    Raises
    ------
    DegeneratePoint
        When some solution, real or not, is singular, or there are infinitely many.
    LimitReached
        When the quotient algebra is more work than `most`.
    """
    point, representation = simple_solutions(system, values, most)
    bits = _FIRST_BITS
    if representation is None:
        return Equilibria(_counts(system, ()), (), bits)
    # where coordinates are at most 1, real values of the form come from real solutions only, and so
    # they do elsewhere
    bound = (
        fmpq(sum(representation.form) + 1)
        if point.is_bounded
        else root_bound(representation.minimal)
    )
    roots = isolate(representation.minimal, -bound, bound)
    zeros = [vanishing_divisor(point.algebra, representation, p) for p in point.conditions]
    while (enclosed := _enclosed(system, point, representation, roots, zeros, bits)) is None:
        bits *= 2
    found, held = enclosed
    counts = _counts(system, found)
    if counts.index is not None and system.is_on_torus and euler_sum(counts.index):
        raise ArithmeticError(f"the Euler sum of {counts} at {text_of_point(values)} is not zero")
    return Equilibria(counts, found, bits, held)


def _counts(system: ParametricSystem, found: Sequence[Solution]) -> Counts:
    return counts_of_signs([e.signs for e in found], system.criterion)


def _enclosed(
    system: ParametricSystem,
    point: PointSystem,
    representation: UnivariateRepresentation,
    roots: Sequence[RealRoot],
    zeros: Sequence[Divisor | None],
    bits: int,
) -> tuple[tuple[Solution, ...], int] | None:
    """The solutions at these roots that count, in disjoint boxes, and the number of stable ones at
    which all conditions for stability are positive; None when the precision does not decide all
    signs.
    """
    found, held = list[tuple[tuple[fmpq, ...], fmpq, str]](), 0
    with ctx.workprec(bits):
        unknowns_at = unknowns_in_balls(representation)
        conditions = tuple(map(_in_balls, point.conditions))
        size = system.criterion.order
        hessian = [
            (i, j, _in_balls(point.jacobian[i][j])) for i in range(size) for j in range(i, size)
        ]
        for root in roots:
            at = unknowns_at(root)
            if at is None:
                return None
            unknowns = at[: system.ring.width]
            signs = _condition_signs(conditions, root, unknowns, zeros)
            if signs is None:
                return None
            inequality_count = len(point.inequalities)
            if signs[:inequality_count].strip("+"):
                continue
            signs = signs[inequality_count:]
            is_held = not signs.strip("+")
            if hessian:
                negative = _negative_eigenvalues(hessian, size, unknowns)
                if negative is None:
                    return None
                signs = "+" * (size - negative) + "-" * negative
            box = _decimal_box(unknowns)
            if box is None:
                return None
            center, radius = box
            around = [arb(x, arb(_ROOM * radius)) for x in center]
            # where all inequalities hold there is no solution that does not count
            if not all(_value(p, around) > 0 for p in conditions[:inequality_count]):
                return None
            found.append((center, radius, signs))
            held += is_held and not signs.strip("+")
    disjoint = all(
        any(abs(x - y) > _ROOM * (a[1] + b[1]) for x, y in zip(a[0], b[0], strict=True))
        for a, b in combinations(found, 2)
    )
    if not disjoint:
        return None
    solutions = (
        Solution(tuple(map(to_fraction, center)), to_fraction(radius), signs)
        for center, radius, signs in found
    )
    return tuple(solutions), held


_Balls = list[tuple[arb, tuple[int, ...]]]
"""A polynomial in the unknowns: coefficients, each with the numbers of the unknowns that it is
multiplied by.
"""


def _in_balls(p: RationalPolynomial) -> _Balls:
    # repeated factors: python-flint's ball ** int is not a number when the ball's middle is zero
    return [
        (arb(c), tuple(k for k, e in enumerate(monomial) for _ in range(e)))
        for monomial, c in p.items()
    ]


def _value(p: _Balls, unknowns: Sequence[arb]) -> arb:
    total = arb(0)
    for c, factors in p:
        term = c
        for k in factors:
            term = term * unknowns[k]
        total = total + term
    return total


def _condition_signs(
    conditions: Sequence[_Balls],
    root: RealRoot,
    unknowns: Sequence[arb],
    zeros: Sequence[Divisor | None],
) -> str | None:
    """The signs of inequalities and stability conditions at a solution; None when one is not
    certain.
    """
    signs = ""
    for p, divisor in zip(conditions, zeros, strict=True):
        if divisor is not None and is_root_of(divisor, root):
            signs += "0"
            continue
        value = _value(p, unknowns)
        if value.contains(0):
            return None
        signs += "+" if value > 0 else "-"
    return signs


def _negative_eigenvalues(
    upper: Sequence[tuple[int, int, _Balls]], size: int, unknowns: Sequence[arb]
) -> int | None:
    """The number of negative eigenvalues of the Hessian in a box; None when its signs are not
    certain.

    Parameters
    ----------
    upper : the Hessian's entries on and above the diagonal, with their places.
    size : its number of rows.
    """
    matrix = arb_mat(size, size)
    for i, j, entry in upper:
        matrix[i, j] = matrix[j, i] = _value(entry, unknowns)
    return negative_eigenvalues(matrix)


def negative_eigenvalues(matrix: arb_mat) -> int | None:
    """The number of negative eigenvalues of a symmetric matrix of balls, the same for all regular
    matrices in it; None when the balls are too wide to tell.

    The characteristic polynomial has real roots only, so that Descartes' rule is exact. A
    coefficient whose sign is open changes nothing between two of opposite signs. For narrow balls
    these are all: of a coefficient that is zero the two neighbours have opposite signs.

    Raises
    ------
    ArithmeticError
        When an entry is not finite.
    """
    if not all(entry.is_finite() for entry in matrix.entries()):
        raise ArithmeticError(f"a matrix has an entry that is not finite at {ctx.prec} bits")
    coefficients = matrix.charpoly().coeffs()
    certain = [k for k, c in enumerate(coefficients) if not c.contains(0)]
    if certain[0]:
        return None
    changes = 0
    for low, high in pairwise(certain):
        is_change = bool(coefficients[low] * coefficients[high] < 0)
        if high - low > 2 - (not is_change):
            return None
        changes += is_change
    return matrix.nrows() - changes


def _decimal_box(unknowns: Sequence[arb]) -> tuple[tuple[fmpq, ...], fmpq] | None:
    """Center and radius, in decimals, of a box around the balls; None when these are wider than the
    coarsest box.

    The finest box has 12 digits after the point, and more as the precision grows, so that all boxes
    come apart.
    """
    widest = max((x.rad() for x in unknowns), default=arb(0))
    for digits in range(max(12, ctx.prec // 10), 5, -1):
        scale = 10**digits
        if (
            widest * (2 * scale) < 1
        ):  # and the nearest decimal is at most half a unit from the middle
            return tuple(fmpq(_nearest(x, scale), scale) for x in unknowns), fmpq(1, scale)
    return None


def _nearest(ball: arb, scale: int) -> int:
    """The integer nearest to scale times the ball's middle."""
    mantissa, exponent = (int(n) for n in ball.mid().man_exp())
    scaled = mantissa * scale
    return scaled << exponent if exponent >= 0 else (scaled + (1 << (-exponent - 1))) >> -exponent
