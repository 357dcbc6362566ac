"""Solutions of a system at a rational point, counted by signatures of Hermite forms.

Guarantee: `count_by_signature` is exact for any number of unknowns, and shares nothing with
`ptmcad.exact.counting` but the multiplication matrices of `ptmcad.exact.point_system`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations, pairwise, product
from math import comb

from flint import fmpq, fmpq_mat

from ptmcad.algebra.fibre_algebra import FibreAlgebra, evaluate
from ptmcad.algebra.real_roots import sign
from ptmcad.algebra.trigonometric_ring import RationalPolynomial
from ptmcad.answer.counts import Counts, counts_of_signs
from ptmcad.exact.counting import equilibria
from ptmcad.exact.models.system import ParametricSystem
from ptmcad.exact.point_system import DegeneratePoint, simple_solutions, text_of_point


def count_by_isolation(system: ParametricSystem, values: Mapping[str, fmpq]) -> Counts:
    """Counts at rational values of all parameters, by real-root isolation."""
    return equilibria(system, values).counts


def count_by_signature(system: ParametricSystem, values: Mapping[str, fmpq]) -> Counts:
    """Counts at rational values of all parameters, by signatures of Hermite matrices.

    The signature of the form (u, v) -> trace(u^T W v) on vectors of elements of the quotient
    algebra, W a symmetric matrix of such elements, is the sum of the signatures of W over the real
    solutions. Of a regular symmetric matrix of size n with i negative eigenvalues the k-th compound
    matrix has the signature K_k(i; n), a Krawtchouk polynomial, the sum of the products of k of its
    n eigenvalues' signs; k = 0 ... n tell how many solutions have which i. Where a condition g must
    be positive, W is multiplied by (g + g^2)/2 in the place of its sign.

    Raises
    ------
    DegeneratePoint
        When some solution has a singular Jacobian, or there are infinitely many.
    """
    point, _ = simple_solutions(system, values)
    width = len(point.algebra.multiplication)

    def matrix(p: RationalPolynomial) -> fmpq_mat:
        return evaluate(point.algebra, _lifted(p, width))

    def query(conditions: Sequence[fmpq_mat], weights: Sequence[Sequence[fmpq_mat]]) -> int:
        """The sum of the weights' signatures over the real solutions at which all conditions are
        positive.
        """
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

    if not point.algebra.dimension:
        return counts_of_signs((), system.criterion)
    one = matrix({(0,) * width: fmpq(1)})
    inequalities, stability = (
        tuple(map(matrix, conditions)) for conditions in (point.inequalities, point.stability)
    )
    total = query(inequalities, [[one]])
    if not system.criterion.order:
        return Counts(
            total, query((*inequalities, *stability), [[one]]) if stability else None, None
        )
    hessian = [[matrix(h) for h in row] for row in point.jacobian]
    n = len(hessian)
    if _minor(hessian, range(n), range(n)).det() == 0:
        raise DegeneratePoint(f"an equilibrium has a singular Hessian at {text_of_point(values)}")
    sums = [total]
    for k in range(1, n + 1):
        chosen = list(combinations(range(n), k))
        sums.append(query(inequalities, [[_minor(hessian, a, b) for b in chosen] for a in chosen]))
    krawtchouk = fmpq_mat(
        n + 1, n + 1, [_krawtchouk(k, i, n) for k in range(n + 1) for i in range(n + 1)]
    )
    numbers = krawtchouk.solve(fmpq_mat(n + 1, 1, sums))
    index = tuple(int(numbers[i, 0].p) for i in range(n + 1))
    return Counts(total, index[0], index)


def _krawtchouk(k: int, i: int, n: int) -> int:
    """The sum of the products of k of n signs, of which i are negative."""
    return sum((-1 if j % 2 else 1) * comb(i, j) * comb(n - i, k - j) for j in range(k + 1))


def _minor(
    matrix: Sequence[Sequence[fmpq_mat]], rows: Sequence[int], columns: Sequence[int]
) -> fmpq_mat:
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


def _lifted(p: RationalPolynomial, width: int) -> RationalPolynomial:
    """The polynomial in more coordinates."""
    return {(*m, *(0,) * (width - len(m))): c for m, c in p.items()}


def block_hermite_matrix(algebra: FibreAlgebra, weights: Sequence[Sequence[fmpq_mat]]) -> fmpq_mat:
    """The matrix of blocks trace(weights[k][l] b_i b_j), for a symmetric matrix of multiplication
    matrices.

    Its signature is the sum over the real solutions of the signatures of the weights' values there:
    the form is the sum over all solutions of that of the value, evaluated at the values of the
    elements, and the parts of two conjugate solutions together have signature zero.
    """
    size = algebra.dimension
    multiplications = []
    for monomial in algebra.basis:
        m = fmpq_mat(size, size, [fmpq(int(i == j)) for i in range(size) for j in range(size)])
        for matrix, e in zip(algebra.multiplication, monomial, strict=True):
            for _ in range(e):
                m = matrix * m
        multiplications.append(m)
    # the traces of all w b_i, for w = sum of w_j b_j, are this matrix times the w_j
    traces = fmpq_mat(
        size, 1, [sum((m[i, i] for i in range(size)), fmpq(0)) for m in multiplications]
    )
    # column j of a multiplication is the normal form of its element times b_j
    transposed = [m.transpose() for m in multiplications]
    traces_of_products = fmpq_mat(
        size, size, [t for m in transposed for t in (m * traces).entries()]
    )
    number = len(weights)
    entries = fmpq_mat(number * size, number * size)
    for k, row in enumerate(weights):
        for n, weight in enumerate(row):
            # the first basis monomial is 1, so the first column is the weight's own normal form
            weighted = traces_of_products * fmpq_mat(size, 1, [weight[i, 0] for i in range(size)])
            for b, m in enumerate(transposed):
                for j, value in enumerate((m * weighted).entries()):
                    entries[k * size + b, n * size + j] = value
    return entries


def signature(symmetric: fmpq_mat) -> tuple[int, int]:
    """(number of positive eigenvalues, number of negative ones), by Descartes' rule, exact as all
    roots are real.
    """
    coefficients = symmetric.charpoly().coeffs()
    positive = _sign_changes(coefficients)
    negative = _sign_changes([c if i % 2 == 0 else -c for i, c in enumerate(coefficients)])
    return positive, negative


def _sign_changes(coefficients: Sequence[fmpq]) -> int:
    signs = [s for s in map(sign, coefficients) if s]
    return sum(a != b for a, b in pairwise(signs))
