"""Solutions of a system at a rational point of a slice, counted by two independent methods.

Guarantee: `count_by_isolation` and `count_by_signature` are exact for any number of unknowns; both raise
`DegeneratePoint` when a solution there has a singular Jacobian, so no count is ever given on the discriminant variety.

By isolation: the real roots of a univariate representation, then the Hessian's inertia there by ball arithmetic, with
precision doubled until every sign is certain (the Hessian is nonsingular, so this ends). By signature: Hermite forms
weighted with the Hessian's compound matrices (Tarski queries). The two share the fibre's multiplication matrices.

A condition that is zero at a solution is not positive there; it is found to be zero by a greatest common divisor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from math import comb

from flint import arb, ctx, fmpq, fmpq_mat

from ptmcad.algebra.fibre import (
    Fibre,
    UnivariateRepresentation,
    block_hermite_matrix,
    coordinates_at,
    evaluate,
    fibre,
    hermite_matrix,
    signature,
    univariate_representation,
)
from ptmcad.algebra.inertia import negative_eigenvalues
from ptmcad.algebra.isolation import root_bound
from ptmcad.algebra.real_roots import RealRoot, is_root_of, isolate, refine
from ptmcad.algebra.vanishing import Divisor, vanishing_divisor
from ptmcad.answer.counts import Counts
from ptmcad.errors import HypothesisError
from ptmcad.exact.models.system import ParametricSystem, RationalPolynomial, at_point, polynomial_at
from ptmcad.exact.models.turns import in_old_angles


class DegeneratePoint(HypothesisError):
    """Some solution at the point has a singular Jacobian, or there are infinitely many."""


@dataclass(frozen=True, slots=True)
class PointSystem:
    """The system and its quotient algebra at one rational point.

    Attributes
    ----------
    algebra : of all solutions, or of those at which no inequality's polynomial vanishes (`saturated`); then it has one
        coordinate more, and where equations are simpler in other angles it has those of these angles too.
    """

    jacobian: tuple[tuple[RationalPolynomial, ...], ...]
    inequalities: tuple[RationalPolynomial, ...]
    stability: tuple[RationalPolynomial, ...]
    algebra: Fibre
    is_bounded: bool

    @property
    def conditions(self) -> tuple[RationalPolynomial, ...]:
        return (*self.inequalities, *self.stability)


def point_system(system: ParametricSystem, values: Mapping[str, fmpq], saturated: bool = False) -> PointSystem:
    """The system at rational values of all parameters.

    Parameters
    ----------
    saturated : whether solutions at which an inequality's polynomial vanishes are left out.

    Raises
    ------
    DegeneratePoint
        When there are infinitely many solutions.
    """
    equations, jacobian = at_point(system, values)
    inequalities, stability = (
        tuple(polynomial_at(system, p, values) for p in conditions)
        for conditions in (system.inequalities, system.stability)
    )
    ring = system.ring
    turns = None if saturated else system.turns
    if turns is not None:
        equations, _ = at_point(turns.system, values)
    generators = [e for e in equations if e] + [{m: fmpq(c) for m, c in circle.items()} for circle in ring.circles]
    width = ring.width
    if saturated:
        generators = [{(*m, 0): c for m, c in g.items()} for g in generators]
        inverse = {(*m, 1): c for m, c in _product(inequalities).items()}
        generators.append({**inverse, (0,) * (width + 1): fmpq(-1)})
        width += 1
    algebra = fibre(generators, width)
    if algebra is None:
        raise DegeneratePoint(f"infinitely many solutions at {_text(values)}")
    if turns is not None:
        algebra = in_old_angles(system, algebra, turns)
    return PointSystem(jacobian, inequalities, stability, algebra, not (ring.reals or saturated))


def _product(factors: Sequence[RationalPolynomial]) -> RationalPolynomial:
    first, *others = factors
    for other in others:
        total: RationalPolynomial = {}
        for m, a in first.items():
            for n, b in other.items():
                key = tuple(i + j for i, j in zip(m, n, strict=True))
                total[key] = total.get(key, fmpq(0)) + a * b
        first = {m: c for m, c in total.items() if c}
    return first


def _text(values: Mapping[str, fmpq]) -> str:
    return ", ".join(f"{name}={value}" for name, value in values.items())


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """A real solution: the only one within ``radius`` of ``center`` in every coordinate, and what is stable about it.

    Attributes
    ----------
    center, radius : decimals.
    signs : of the Hessian's eigenvalues, positive ones first; without a potential, of the stability conditions in their
        order, 0 where one is zero.
    """

    center: tuple[fmpq, ...]
    radius: fmpq
    signs: str


@dataclass(frozen=True, slots=True)
class Equilibria:
    """All real solutions that count at a rational point, in disjoint boxes.

    Attributes
    ----------
    bits : the precision at which every sign was certain and the boxes were disjoint.
    """

    counts: Counts
    solutions: tuple[Equilibrium, ...]
    bits: int


def count_by_isolation(system: ParametricSystem, values: Mapping[str, fmpq]) -> Counts:
    """Counts at rational values of all parameters, by real-root isolation.

    Raises
    ------
    DegeneratePoint
        When some solution, real or not, is singular, or there are infinitely many.
    """
    return equilibria(system, values).counts


def equilibria(system: ParametricSystem, values: Mapping[str, fmpq]) -> Equilibria:
    """All real solutions that count at rational values of all parameters, by real-root isolation.

    Raises
    ------
    DegeneratePoint
        When some solution, real or not, is singular, or there are infinitely many.
    """
    point, representation = _simple(system, values)
    bits = 40
    if representation is None:
        return Equilibria(_counts(system, ()), (), bits)
    # where coordinates are at most 1, real values of the form come from real solutions only, and so they do elsewhere
    bound = fmpq(sum(representation.form) + 1) if point.is_bounded else root_bound(representation.minimal)
    roots = isolate(representation.minimal, -bound, bound)
    zeros = [vanishing_divisor(point.algebra, representation, p) for p in point.conditions]
    while (found := _enclosed(system, point, representation, roots, zeros, bits)) is None:
        bits *= 2
    counts = _counts(system, found)
    if counts.index is not None and system.is_on_torus and sum(counts.index[::2]) != sum(counts.index[1::2]):
        raise ArithmeticError(f"the Euler sum of {counts} at {_text(values)} is not zero")
    return Equilibria(counts, found, bits)


def _counts(system: ParametricSystem, found: Sequence[Equilibrium]) -> Counts:
    stable = sum(not e.signs.strip("+") for e in found) if system.tells_stability else None
    index = None
    if system.has_index:
        numbers = [0] * (system.dimension + 1)
        for solution in found:
            numbers[solution.signs.count("-")] += 1
        index = tuple(numbers)
    return Counts(len(found), stable, index)


def _simple(
    system: ParametricSystem, values: Mapping[str, fmpq]
) -> tuple[PointSystem, UnivariateRepresentation | None]:
    """The point's system when its solutions are simple, and their representation; None when there are none.

    Solutions at which an inequality's polynomial vanishes, which do not count, are left out where they are not simple.

    Raises
    ------
    DegeneratePoint
        When some solution is singular, or there are infinitely many.
    """
    for saturated in (False, True) if system.inequalities else (False,):
        try:
            point = point_system(system, values, saturated)
        except DegeneratePoint:
            if saturated or not system.inequalities:
                raise
            continue
        if not point.algebra.dimension:
            return point, None
        representation = univariate_representation(point.algebra)
        if representation is not None:
            return point, representation
    what = "an equilibrium has a singular Hessian" if system.has_index else "a solution has a singular Jacobian"
    raise DegeneratePoint(f"{what} at {_text(values)}")


def _lifted(p: RationalPolynomial, width: int) -> RationalPolynomial:
    """The polynomial in more coordinates."""
    return {(*m, *(0,) * (width - len(m))): c for m, c in p.items()}


def _enclosed(
    system: ParametricSystem,
    point: PointSystem,
    representation: UnivariateRepresentation,
    roots: Sequence[RealRoot],
    zeros: Sequence[Divisor | None],
    bits: int,
) -> tuple[Equilibrium, ...] | None:
    """The solutions at these roots that count, in disjoint boxes; None when the precision does not decide all signs."""
    found: list[Equilibrium] = []
    with ctx.workprec(bits):
        for root in roots:
            short = refine(root, fmpq(1, 2 ** (bits - 8)) * (abs(root.middle) + 1))
            at = coordinates_at(representation, arb(short.low).union(arb(short.high)))
            if at is None:
                return None
            unknowns = at[: system.ring.width]
            conditions = _condition_signs(point, root, unknowns, zeros)
            if conditions is None:
                return None
            if conditions[: len(point.inequalities)].strip("+"):
                continue
            signs = conditions[len(point.inequalities) :]
            if system.has_index:
                negative = _negative_eigenvalues(point, unknowns)
                if negative is None:
                    return None
                signs = "+" * (system.dimension - negative) + "-" * negative
            box = _decimal_box(unknowns)
            if box is None:
                return None
            found.append(Equilibrium(*box, signs))
    disjoint = all(
        any(abs(x - y) > a.radius + b.radius for x, y in zip(a.center, b.center, strict=True))
        for a, b in combinations(found, 2)
    )
    return tuple(found) if disjoint else None


def _condition_signs(
    point: PointSystem, root: RealRoot, unknowns: list[arb], zeros: Sequence[Divisor | None]
) -> str | None:
    """The signs of inequalities and stability conditions at a solution; None when one is not certain."""
    signs = ""
    for p, divisor in zip(point.conditions, zeros, strict=True):
        if divisor is not None and is_root_of(divisor, root):
            signs += "0"
            continue
        value = _value(p, unknowns)
        if value.contains(0):
            return None
        signs += "+" if value > 0 else "-"
    return signs


def _negative_eigenvalues(point: PointSystem, unknowns: list[arb]) -> int | None:
    """The number of negative eigenvalues of the Hessian in a box; None when its signs are not certain."""
    size = len(point.jacobian)
    upper = {(i, j): _value(point.jacobian[i][j], unknowns) for i in range(size) for j in range(i, size)}
    return negative_eigenvalues([[upper[min(i, j), max(i, j)] for j in range(size)] for i in range(size)])


def _decimal_box(unknowns: Sequence[arb]) -> tuple[tuple[fmpq, ...], fmpq] | None:
    """Center and radius, in decimals, of a box around the balls; None when these are wider than the coarsest box.

    The finest box has 12 digits after the point, and more as the precision grows, so that all boxes come apart.
    """
    for digits in range(max(12, ctx.prec // 5), 5, -1):
        unit = fmpq(1, 10**digits)
        center = tuple(fmpq(_nearest(x, 10**digits), 10**digits) for x in unknowns)
        if all(abs(x - c) < arb(unit) for x, c in zip(unknowns, center, strict=True)):
            return center, unit
    return None


def _nearest(ball: arb, scale: int) -> int:
    """The integer nearest to scale times the ball's middle."""
    mantissa, exponent = (int(n) for n in ball.mid().man_exp())
    scaled = mantissa * scale
    return scaled << exponent if exponent >= 0 else (scaled + (1 << (-exponent - 1))) >> -exponent


def _value(p: RationalPolynomial, unknowns: list[arb]) -> arb:
    total = arb(0)
    for monomial, c in p.items():
        term = arb(c)
        for value, e in zip(unknowns, monomial, strict=True):
            for _ in range(e):  # python-flint's ball ** int is not a number when the ball's middle is zero
                term = term * value
        total = total + term
    return total


def solutions_at(system: ParametricSystem, values: Mapping[str, fmpq]) -> tuple[int | None, int]:
    """Number of different complex solutions, and their number with multiplicity; (None, 0) for infinitely many."""
    try:
        algebra = point_system(system, values).algebra
    except DegeneratePoint:
        return None, 0
    one = evaluate(algebra, {(0,) * len(algebra.multiplication): fmpq(1)})
    return sum(signature(hermite_matrix(algebra, one))), algebra.dimension


def count_by_signature(system: ParametricSystem, values: Mapping[str, fmpq]) -> Counts:
    """Counts at rational values of all parameters, by signatures of Hermite matrices.

    The signature of the form (u, v) -> trace(u^T W v) on vectors of elements of the quotient algebra, W a symmetric
    matrix of such elements, is the sum of the signatures of W over the real solutions. Of a regular symmetric matrix
    of size n with i negative eigenvalues the k-th compound matrix has the signature K_k(i; n), a Krawtchouk
    polynomial, the sum of the products of k of its n eigenvalues' signs; k = 0 ... n tell how many solutions have
    which i. Where a condition g must be positive, W is multiplied by (g + g^2)/2 in the place of its sign.

    Raises
    ------
    DegeneratePoint
        When some solution has a singular Jacobian, or there are infinitely many.
    """
    point, _ = _simple(system, values)
    width = len(point.algebra.multiplication)

    def matrix(p: RationalPolynomial) -> fmpq_mat:
        return evaluate(point.algebra, _lifted(p, width))

    def query(conditions: Sequence[fmpq_mat], weights: Sequence[Sequence[fmpq_mat]]) -> int:
        """The sum of the weights' signatures over the real solutions at which all conditions are positive."""
        total = 0
        for exponents in product((1, 2), repeat=len(conditions)):
            factor = one
            for condition, e in zip(conditions, exponents, strict=True):
                for _ in range(e):
                    factor = factor * condition
            weighted = [[factor * w for w in row] for row in weights]
            positive, negative = signature(block_hermite_matrix(point.algebra, weighted))
            total += positive - negative
        return total >> len(conditions)

    size = point.algebra.dimension
    if not size:
        return _counts(system, ())
    one = matrix({(0,) * width: fmpq(1)})
    inequalities, stability = (tuple(map(matrix, conditions)) for conditions in (point.inequalities, point.stability))
    total = query(inequalities, [[one]])
    if not system.has_index:
        return Counts(total, query((*inequalities, *stability), [[one]]) if stability else None, None)
    hessian = [[matrix(h) for h in row] for row in point.jacobian]
    n = len(hessian)
    if _minor(hessian, range(n), range(n)).det() == 0:
        raise DegeneratePoint(f"an equilibrium has a singular Hessian at {_text(values)}")
    sums = [total]
    for k in range(1, n + 1):
        chosen = list(combinations(range(n), k))
        sums.append(query(inequalities, [[_minor(hessian, a, b) for b in chosen] for a in chosen]))
    krawtchouk = fmpq_mat(n + 1, n + 1, [_krawtchouk(k, i, n) for k in range(n + 1) for i in range(n + 1)])
    numbers = krawtchouk.solve(fmpq_mat(n + 1, 1, sums))
    index = tuple(int(numbers[i, 0].p) for i in range(n + 1))
    return Counts(total, index[0], index)


def _krawtchouk(k: int, i: int, n: int) -> int:
    """The sum of the products of k of n signs, of which i are negative."""
    return sum((-1 if j % 2 else 1) * comb(i, j) * comb(n - i, k - j) for j in range(k + 1))


def _minor(matrix: Sequence[Sequence[fmpq_mat]], rows: Sequence[int], columns: Sequence[int]) -> fmpq_mat:
    """The determinant of some rows and columns of a matrix of commuting matrices."""
    if len(rows) == 1:
        return matrix[rows[0]][columns[0]]
    total = None
    for k, column in enumerate(columns):
        rest = [c for c in columns if c != column]
        term = matrix[rows[0]][column] * _minor(matrix, rows[1:], rest) * fmpq((-1) ** k)
        total = term if total is None else total + term
    assert total is not None
    return total
