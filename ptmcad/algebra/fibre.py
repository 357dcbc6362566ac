"""The solutions over one rational point: the quotient algebra over Q, and a univariate representation of its points.

Guarantee: exact over Q; nothing here is rounded.

Reference: Rouillier, Solving zero-dimensional systems through the rational univariate representation, AAECC 9 (1999).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from flint import Ordering, arb, arb_poly, fmpq, fmpq_mat, fmpq_poly, fmpz_mpoly_ctx, fmpz_mpoly_vec, fmpz_poly

from ptmcad.algebra.groebner import Monomial, shifted
from ptmcad.algebra.quotient import standard_monomials
from ptmcad.algebra.real_roots import sign

RationalPolynomial = Mapping[Monomial, fmpq]


@dataclass(frozen=True, slots=True)
class Fibre:
    """The quotient algebra at a rational point.

    Attributes
    ----------
    basis : the monomial basis, 1 first.
    multiplication : one matrix for each unknown; column j holds the normal form of unknown times basis[j].
    """

    basis: tuple[Monomial, ...]
    multiplication: tuple[fmpq_mat, ...]

    @property
    def dimension(self) -> int:
        """The number of complex solutions counted with multiplicity."""
        return len(self.basis)


def fibre(equations: Sequence[RationalPolynomial], unknowns: int) -> Fibre | None:
    """The quotient by the given equations; None when there are infinitely many complex solutions."""
    context = fmpz_mpoly_ctx.get(tuple(f"u{k}" for k in range(unknowns)), Ordering.degrevlex)
    integral = []
    for equation in equations:
        scale = math.lcm(*(int(c.q) for c in equation.values()))
        integral.append(context.from_dict({m: int(c.p) * (scale // int(c.q)) for m, c in equation.items()}))
    reduced = fmpz_mpoly_vec(integral, context).buchberger_naive().autoreduction()
    rules: dict[Monomial, tuple[fmpq, dict[Monomial, fmpq]]] = {}
    for p in reduced:
        terms = [(tuple(int(e) for e in m), fmpq(c)) for m, c in p.terms()]
        lead, c0 = terms[0]
        rules[lead] = (c0, {m: -c / c0 for m, c in terms[1:]})
    basis = standard_monomials(tuple(rules), unknowns)
    if basis is None:
        return None
    position = {m: i for i, m in enumerate(basis)}
    size = len(basis)
    table: dict[Monomial, list[fmpq]] = {m: [fmpq(int(i == k)) for i in range(size)] for m, k in position.items()}
    border = {shifted(m, k) for m in basis for k in range(unknowns)} - position.keys()
    for m in sorted(border, key=lambda m: (sum(m), *(-e for e in reversed(m)))):
        row = [fmpq(0)] * size
        if m in rules:
            for n, c in rules[m][1].items():
                row[position[n]] = c
        else:
            k, below = next(
                (k, below)
                for k in range(unknowns)
                if m[k] and (below := shifted(m, k, -1)) in table and below not in position
            )
            for n, c in zip(basis, table[below], strict=True):
                if c:
                    image = table[shifted(n, k)]
                    row = [a + c * b for a, b in zip(row, image, strict=True)]
        table[m] = row
    matrices = []
    for k in range(unknowns):
        columns = [table[shifted(m, k)] for m in basis]
        matrices.append(fmpq_mat(size, size, [columns[j][i] for i in range(size) for j in range(size)]))
    return Fibre(basis, tuple(matrices))


def evaluate(algebra: Fibre, p: RationalPolynomial) -> fmpq_mat:
    """The matrix of multiplication by a polynomial in the unknowns."""
    size = algebra.dimension
    total = fmpq_mat(size, size)
    for monomial, c in p.items():
        term = fmpq_mat(size, size, [c if i == j else fmpq(0) for i in range(size) for j in range(size)])
        for matrix, e in zip(algebra.multiplication, monomial, strict=True):
            for _ in range(e):
                term = matrix * term
        total = total + term
    return total


@dataclass(frozen=True, slots=True)
class UnivariateRepresentation:
    """The points of a fibre as values of polynomials at the roots of one.

    Attributes
    ----------
    minimal : squarefree, in Z[T]; its roots are the values of a linear form that separates the solutions.
    coordinates : one polynomial in Q[T] for each unknown: its value at a root is the unknown's value there.
    form : the coefficients of the linear form, one for each unknown.
    """

    minimal: fmpz_poly
    coordinates: tuple[fmpq_poly, ...]
    form: tuple[int, ...]


def univariate_representation(algebra: Fibre) -> UnivariateRepresentation | None:
    """The representation by the first separating form of a fixed list; None when the solutions are not all simple.

    A form separates simple solutions exactly when its characteristic polynomial is squarefree; if the solutions are
    all simple, one of more than d^2/2 forms of this list does (Rouillier 1999, lemma 2.1).
    """
    size, count = algebra.dimension, len(algebra.multiplication)
    for trial in range(1, size * (size - 1) // 2 * (count - 1) + 2):
        form = fmpq_mat(size, size)
        for k, matrix in enumerate(algebra.multiplication):
            form = form + matrix * fmpq(trial**k)  # points on a moment curve
        characteristic = form.charpoly()
        if characteristic.gcd(characteristic.derivative()).degree() > 0:
            continue
        powers = [fmpq_mat(size, 1, [fmpq(int(i == 0)) for i in range(size)])]
        for _ in range(size - 1):
            powers.append(form * powers[-1])
        change = fmpq_mat(size, size, [powers[j][i, 0] for i in range(size) for j in range(size)])
        targets = fmpq_mat(size, count, [m[i, 0] for i in range(size) for m in algebra.multiplication])
        solved = change.solve(targets)
        coordinates = tuple(fmpq_poly([solved[i, k] for i in range(size)]) for k in range(count))
        return UnivariateRepresentation(characteristic.numer(), coordinates, tuple(trial**k for k in range(count)))
    return None


def coordinates_at(representation: UnivariateRepresentation, value: arb) -> list[arb]:
    """Enclosures of the unknowns at the roots of ``minimal`` that a ball contains."""
    return [arb_poly(p)(value) for p in representation.coordinates]


def hermite_matrix(algebra: Fibre, weight: fmpq_mat) -> fmpq_mat:
    """The matrix trace(weight b_i b_j), weight being a multiplication matrix.

    Its rank is the number of different solutions where the weight is not zero, its signature the number of real
    solutions with positive weight minus those with negative weight (Hermite; Basu, Pollack, Roy, theorem 4.101).
    """
    size = algebra.dimension
    multiplications = []
    for monomial in algebra.basis:
        m = fmpq_mat(size, size, [fmpq(int(i == j)) for i in range(size) for j in range(size)])
        for matrix, e in zip(algebra.multiplication, monomial, strict=True):
            for _ in range(e):
                m = matrix * m
        multiplications.append(m)
    traces = [sum(((weight * m)[i, i] for i in range(size)), fmpq(0)) for m in multiplications]
    entries = []
    for a in multiplications:
        for j in range(size):
            # column j of a is the normal form of b_i b_j
            entries.append(sum((a[i, j] * traces[i] for i in range(size)), fmpq(0)))
    return fmpq_mat(size, size, entries)


def signature(symmetric: fmpq_mat) -> tuple[int, int]:
    """(number of positive eigenvalues, number of negative ones), by Descartes' rule, exact as all roots are real."""
    coefficients = symmetric.charpoly().coeffs()
    positive = _sign_changes(coefficients)
    negative = _sign_changes([c if i % 2 == 0 else -c for i, c in enumerate(coefficients)])
    return positive, negative


def _sign_changes(coefficients: Sequence[fmpq]) -> int:
    signs = [s for s in map(sign, coefficients) if s]
    return sum(a != b for a, b in pairwise(signs))
