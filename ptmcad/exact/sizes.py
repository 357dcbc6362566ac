"""The size of a slice's critical curve before it is computed: its degrees, from solutions at points of three lines.

Not guaranteed: the degrees are those of the norm of the Jacobian's determinant on the lines x = c, y = c and y = x + c
modulo one prime, without multiplicities; an unlucky line or prime makes them smaller, and other factors of the norm are
counted along. This is for forecasts.

On a line the norm is a rational function of one variable; it is known once the fraction of least degree through the
first values (by Euclid's algorithm) has a degree that leaves some values over.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from time import process_time
from typing import NamedTuple

from flint import fmpq, nmod_mat

from ptmcad.algebra.fibre import Fibre, Work
from ptmcad.algebra.grid import support_of
from ptmcad.algebra.ratios import Numerator, numerator
from ptmcad.algebra.residues import primes
from ptmcad.errors import LimitReached
from ptmcad.exact.models.system import RationalPolynomial
from ptmcad.exact.point_system import DegeneratePoint, point_system
from ptmcad.exact.stages import SliceProblem, point_values

MOST_POINTS = 256
"""On a line; they tell degrees of 60 and more, and tell of more that they are more."""
_FIRST_POINTS = 24


class Sizes(NamedTuple):
    """Of the critical curve, its components taken together.

    Attributes
    ----------
    degrees, total : in the axes, and in both together.
    steps : the powers of each axis that occur are multiples of these numbers.
    """

    degrees: tuple[int, int]
    total: int
    steps: tuple[int, int]

    @property
    def terms(self) -> int:
        """How many exponents these degrees leave."""
        (dx, dy), (sx, sy) = self.degrees, self.steps
        return sum(len(range(0, n, sy)) for n in support_of([(1, 0, dx), (0, 1, dy), (1, 1, self.total)])[::sx])


def sizes(problem: SliceProblem, solutions: int, seconds: float, most: Work | None = None) -> Sizes | None:
    """The curve's sizes; None where they are larger than `MOST_POINTS` tell, or take longer.

    Parameters
    ----------
    solutions : the number of complex ones at a generic point.
    seconds : of processor time, after which the search ends.
    most : work at a point.
    """
    end = process_time() + seconds
    found = []
    for direction in ((1, 1), (1, 0), (0, 1)):
        seen = _numerator(_values(problem, solutions, direction, most), end)
        if seen is None:
            return None
        found.append(seen)
    both, x, y = found
    # an axis is where a length or a stiffness vanishes, and no part of the critical curve
    total = both.degree + both.has_zero - x.has_zero - y.has_zero
    return Sizes((x.degree, y.degree), max(total, x.degree, y.degree), (x.step, y.step))


def _values(
    problem: SliceProblem, solutions: int, direction: tuple[int, int], most: Work | None
) -> Iterator[tuple[int, int]]:
    """The line's parameter, and the norm there modulo a prime; points over which solutions are lost are left out."""
    prime = next(primes())
    for t in range(MOST_POINTS):
        s = (t + 1) // 2 * (-1) ** t
        at = (fmpq(3 if not direction[0] else s), fmpq(5 if not direction[1] else s + 7 * direction[0]))
        try:
            point = point_system(problem.system, point_values(problem.parameters, at), most=most)
        except (ZeroDivisionError, DegeneratePoint, LimitReached):
            continue
        if point.algebra.dimension != solutions:
            continue
        value = _norm(point.algebra, point.jacobian, prime)
        if value is not None:
            yield s, value


def _norm(algebra: Fibre, jacobian: Sequence[Sequence[RationalPolynomial]], prime: int) -> int | None:
    """The norm of a determinant modulo a prime; None where that divides a denominator."""
    size = algebra.dimension
    unknowns = []
    for matrix in algebra.multiplication:
        numerators, denominator = matrix.numer_denom()
        if int(denominator) % prime == 0:
            return None
        unknowns.append(nmod_mat(numerators, prime) * pow(int(denominator), -1, prime))
    one = nmod_mat(size, size, [int(i == j) for i in range(size) for j in range(size)], prime)
    powers: dict[tuple[int, ...], nmod_mat] = {}

    def power(m: tuple[int, ...]) -> nmod_mat:
        if m not in powers:
            k = next((k for k, e in enumerate(m) if e), None)
            powers[m] = one if k is None else unknowns[k] * power((*m[:k], m[k] - 1, *m[k + 1 :]))
        return powers[m]

    def matrix_of(p: Mapping[tuple[int, ...], fmpq]) -> nmod_mat:
        total = one * 0
        for m, c in p.items():
            total = total + power(m) * (int(c.p) * pow(int(c.q), -1, prime) % prime)
        return total

    return int(_determinant([[matrix_of(p) for p in row] for row in jacobian]).det())


def _determinant(rows: list[list[nmod_mat]]) -> nmod_mat:
    """Of a matrix of commuting matrices, by the first row."""
    if len(rows) == 1:
        return rows[0][0]
    total = rows[0][0] * 0
    for k, entry in enumerate(rows[0]):
        product = entry * _determinant([row[:k] + row[k + 1 :] for row in rows[1:]])
        total = total + product if k % 2 == 0 else total - product
    return total


def _numerator(values: Iterator[tuple[int, int]], end: float) -> Numerator | None:
    """The numerator of the fraction with these values."""
    prime = next(primes())
    points: list[tuple[int, int]] = []
    asked = _FIRST_POINTS
    while True:
        for pair in islice(values, asked - len(points)):
            points.append(pair)
            if process_time() > end:
                return None
        if len(points) < asked:
            return None
        found = numerator(points, prime)
        if found is not None:
            return found
        asked = min(asked * 3 // 2, MOST_POINTS) if asked < MOST_POINTS else asked + 1
