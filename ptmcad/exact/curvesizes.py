"""The size of a slice's critical curve before it is computed: its degrees, from solutions at points
of three lines; and of its decomposition, from the engine's first stages.

Not guaranteed: the degrees are those of the norm of the Jacobian's determinant on the lines x = c,
y = c and y = 3 x + c modulo one prime, without multiplicities and without what bounds the slice's
domain; an unlucky line or prime makes them smaller, and other factors of the norm are counted
along. This is for forecasts.

On a line the norm is a rational function of one variable; it is known once the fraction of least
degree through the first values (by Euclid's algorithm) has a degree that leaves some values over.
So is a sum of all entries of the multiplication tables with random weights, whose degrees are those
of the tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import islice
from time import process_time
from typing import NamedTuple

from flint import fmpq, nmod_mat

from ptmcad.algebra.fibre_algebra import FibreAlgebra, WorkLimit
from ptmcad.algebra.groebner import powers_of
from ptmcad.algebra.plane_determinants import laplace
from ptmcad.algebra.polynomials import Monomial
from ptmcad.algebra.ratios import LinePolynomial, Numerator, degree, numerator, restricted, weighted
from ptmcad.algebra.resultants import Check, nothing, primes
from ptmcad.algebra.trigonometric_ring import RationalPolynomial
from ptmcad.errors import LimitReached
from ptmcad.exact.cad.decomposition import Sample
from ptmcad.exact.models.system import SystemOnAxes
from ptmcad.exact.point_system import DegeneratePoint, PointSystem, point_system
from ptmcad.exact.stages import SliceProblem, decomposition_of

MAX_POINTS = 256
"""On a line; they determine degrees of 60 and more, and show that larger ones are larger."""
_FIRST_POINTS = 24
_GENERIC = fmpq(10_007), fmpq(20_011)
"""Where the monomial basis is the usual one."""
_LINES = (1, 1), (1, 0), (0, 1)
_ACROSS, _UP, _SLOPE, _APART = 29, 37, 3, 43
"""The lines are y = _UP, x = _ACROSS and y = _SLOPE x + _APART: parallel to the last one no
asymptote is likely, as to y = x, along which degrees are lost where equations have a difference of
the axes."""


class CurveSizes(NamedTuple):
    """Of the critical curve, its components taken together but for the lines on which an axis'
    value is zero.

    Attributes
    ----------
    degrees, total : in the axes, and in both together.
    steps : the powers of each axis that occur are multiples of these numbers.
    tables : of the multiplication tables of the unknowns, the degrees in the axes and in both
        together.
    lines : for each axis, whether the line on which its value is zero is a component. It takes
        hardly any time, and powers of the axis' value are known without it.
    """

    degrees: tuple[int, int]
    total: int
    steps: tuple[int, int]
    tables: tuple[int, int, int] = (0, 0, 0)
    lines: tuple[bool, bool] = (False, False)

    @property
    def terms(self) -> int:
        """How many exponents these degrees leave."""
        return _terms(self.degrees, self.total, self.steps)

    @property
    def table_terms(self) -> int:
        """How many exponents the degrees leave to an entry of the tables."""
        x, y, total = self.tables
        return _terms((x, y), total, self.steps)


def _terms(degrees: tuple[int, int], total: int, steps: tuple[int, int]) -> int:
    (dx, dy), (sx, sy) = degrees, steps
    return sum(
        len(range(0, n, sy))
        for n in (min(dy, total - i) + 1 for i in range(0, min(dx, total) + 1, sx))
    )


def sizes(
    problem: SliceProblem, solutions: int, seconds: float, most: WorkLimit | None = None
) -> CurveSizes | None:
    """The curve's sizes; None where they are larger than `MAX_POINTS` tell, or take longer.

    Parameters
    ----------
    solutions : the number of complex ones at a generic point.
    seconds : of processor time, after which the search ends.
    most : work at a point.
    """
    end = process_time() + seconds
    limits = problem.on.limits
    system_at = partial(_system_at, problem.on, solutions, most)
    usual = system_at(_GENERIC)
    if usual is None:
        return None
    found, tables = [], []
    for line in _LINES:
        known = [restricted(p, (_place(0, line), _place(1, line)), next(primes())) for p in limits]
        values = _values(system_at, line, usual.algebra.basis)
        seen = _sizes_on(values, [g for g in known if g.degree() > 0], end)
        if seen is None:
            return None
        found.append(seen[0])
        tables.append(seen[1])
    both, x, y = found
    total = both.degree + both.has_zero - x.has_zero - y.has_zero
    degrees = x.degree, y.degree
    # where solutions are lost on such a line they go to infinity there: no critical component
    lines = [
        n.has_zero and system_at(at) is not None
        for n, at in ((x, (fmpq(0), _GENERIC[1])), (y, (_GENERIC[0], fmpq(0))))
    ]
    of_tables = tables[1], tables[2], max(tables)
    return CurveSizes(
        degrees, max(total, *degrees), (x.step, y.step), of_tables, (lines[0], lines[1])
    )


def _place(s: int, line: tuple[int, int]) -> tuple[int, int]:
    """The point of a line with a parameter."""
    return s if line[0] else _ACROSS, (_SLOPE * s + _APART if line[0] else s) if line[1] else _UP


_Value = tuple[int, int, int | None]
"""At a point of a line: the parameter, its norm, and the sum of the tables' entries where the basis
is the usual.
"""


_SystemAt = Callable[[Sample], PointSystem | None]
"""The system at a point; None where solutions are lost."""


def _system_at(
    on: SystemOnAxes, solutions: int, most: WorkLimit | None, at: Sample
) -> PointSystem | None:
    try:
        point = point_system(on.system, on.values(at), most=most)
    except (ZeroDivisionError, DegeneratePoint, LimitReached):
        return None
    return point if point.algebra.dimension == solutions else None


def _values(
    system_at: _SystemAt, line: tuple[int, int], basis: Sequence[Monomial]
) -> Iterator[_Value]:
    """Values modulo a prime; points over which solutions are lost are left out."""
    prime = next(primes())
    for t in range(MAX_POINTS):
        s = (t + 1) // 2 * (-1) ** t
        x, y = _place(s, line)
        point = system_at((fmpq(x), fmpq(y)))
        tables = None if point is None else _residues(point.algebra, prime)
        if point is None or tables is None:
            continue
        entries = [int(c) for table in tables for c in table.entries()]
        usual_here = point.algebra.basis == basis
        yield (
            s,
            _norm(tables, point.jacobian, prime),
            weighted(entries, prime) if usual_here else None,
        )


def _residues(algebra: FibreAlgebra, prime: int) -> list[nmod_mat] | None:
    """The multiplication tables modulo a prime; None where that divides a denominator."""
    found = []
    for matrix in algebra.multiplication:
        numerators, denominator = matrix.numer_denom()
        if int(denominator) % prime == 0:
            return None
        found.append(nmod_mat(numerators, prime) * pow(int(denominator), -1, prime))
    return found


def _norm(
    unknowns: Sequence[nmod_mat], jacobian: Sequence[Sequence[RationalPolynomial]], prime: int
) -> int:
    """The norm of a determinant modulo a prime."""
    size = unknowns[0].nrows()
    one = nmod_mat(size, size, [int(i == j) for i in range(size) for j in range(size)], prime)
    power = powers_of(unknowns, one)

    def matrix_of(p: RationalPolynomial) -> nmod_mat:
        total = one * 0
        for m, c in p.items():
            total = total + power(m) * (int(c.p) * pow(int(c.q), -1, prime) % prime)
        return total

    return int(laplace([[matrix_of(p) for p in row] for row in jacobian]).det())


def _sizes_on(
    values: Iterator[_Value], known: Sequence[LinePolynomial], end: float
) -> tuple[Numerator, int] | None:
    """On a line the norm's numerator and the tables' degree, of which values that do not suffice
    tell a lower bound.

    Parameters
    ----------
    known : what is left out of the numerator.
    """
    prime = next(primes())
    seen: list[_Value] = []
    asked = _FIRST_POINTS
    while True:
        for value in islice(values, asked - len(seen)):
            seen.append(value)
            if process_time() > end:
                return None
        found = numerator([(s, norm) for s, norm, _ in seen], prime, known)
        entries = [(s, sums) for s, _, sums in seen if sums is not None]
        tables = degree(entries, prime)
        if found is not None and (
            tables is not None or len(seen) < asked or 2 * len(entries) < len(seen)
        ):
            return found, len(entries) // 2 if tables is None else tables
        if len(seen) < asked:
            return None
        asked = min(asked * 3 // 2, MAX_POINTS) if asked < MAX_POINTS else asked + 1


class Survey(NamedTuple):
    """The decomposition of the window, as far as the cost of what comes after depends on it.

    Attributes
    ----------
    walls : between a cell and the next one above it, of all stacks.
    degree : the largest of a curve along the fibres.
    """

    cells: int
    walls: int
    degree: int


def survey(problem: SliceProblem, check: Check = nothing) -> Survey:
    """The decomposition's sizes.

    Parameters
    ----------
    check : called during the projection; may raise to stop.

    Raises
    ------
    DegenerateSliceError, InfiniteSolutionsError
        When every point of the slice is exceptional.
    """
    cut = decomposition_of(problem, check=check)
    cells = len(cut.points)
    return Survey(
        cells,
        cells - len(cut.stacks),
        max((len(c.in_v) - 1 for c in cut.variety.curves), default=0),
    )
