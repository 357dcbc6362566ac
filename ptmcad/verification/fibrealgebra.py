"""The solutions over one rational point: counts, signs and norms by the algebra of the equations.

Guarantee: exact. The Groebner basis is that at the point itself, by FLINT's own Buchberger algorithm
in graded reverse lexicographic order with the last variable first. Counts come from signatures of
trace forms: another elimination than the one over Q(x, y) in `ptmcad.exact.discriminant_variety`,
and another count than the root isolation in `ptmcad.exact.counting`.

The number of negative eigenvalues of a Hessian is that of the changes of sign in the sequence of
its leading principal minors (Jacobi), in a basis in which none of them vanishes. The sums of the
signs of their products over the real solutions determine how many solutions have which signs
(Tarski queries).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import chain, pairwise, product
from math import lcm, prod

from flint import Ordering, fmpq, fmpq_mat, fmpq_mpoly, fmpz_mpoly_ctx, fmpz_mpoly_vec

from ptmcad.answer.counts import Counts
from ptmcad.model import Model
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.coordinates import CoordinateRing
from ptmcad.verification.derivation import Derivation, derivation_at
from ptmcad.verification.principalminors import (
    bases,
    determinant,
    leading_minors,
    negative_eigenvalues,
)

Matrices = Sequence[fmpq_mat]
Monomial = tuple[int, ...]
"""Exponents of the variables, last to first."""


@dataclass(frozen=True)
class SolutionAlgebra:
    """The algebra Q[coordinates of the unknowns]/(equations) at one point.

    Attributes
    ----------
    basis : the standard monomials.
    tables : the matrix of multiplication by each variable, last to first; columns are images of the
        basis.
    saturated : whether solutions at which an inequality's polynomial vanishes, which do not count,
        are left out; then the last variable is the inverse of the inequalities' product.
    """

    basis: tuple[Monomial, ...]
    tables: tuple[fmpq_mat, ...]
    point: Derivation
    saturated: bool = False

    @property
    def dimension(self) -> int:
        """Number of complex solutions, with multiplicity."""
        return len(self.basis)

    @property
    def conditions(self) -> tuple[fmpq_mpoly, ...]:
        """The inequalities' polynomials, then those of the conditions for stability."""
        return (*self.point.inequalities, *self.point.stability)

    def matrix(self, p: fmpq_mpoly) -> fmpq_mat:
        """The matrix of multiplication by p, a polynomial in the coordinates."""
        total = fmpq_mat(self.dimension, self.dimension)
        for exponents, c in p.terms():
            total = total + _product(_identity(self.dimension) * c, self._own, exponents)
        return total

    @cached_property
    def _required(self) -> list[fmpq_mat]:
        """The matrices of multiplication by what is positive at solutions that count."""
        return [self.matrix(p) for p in self.point.inequalities]

    @property
    def _own(self) -> tuple[fmpq_mat, ...]:
        """The matrices of multiplication by the model's coordinates."""
        return self.tables[::-1][: self.point.coordinates]

    @cached_property
    def jacobian_entries(self) -> list[list[fmpq_mat]]:
        """The Jacobian, whose entries act on the algebra; a Hessian is symmetric."""
        n = range(len(self.point.jacobian))
        places = [[self.point.meaning.place(i, j) for j in n] for i in n]
        entries = {(i, j): self.matrix(self.point.jacobian[i][j]) for i, j in {*chain(*places)}}
        return [[entries[place] for place in row] for row in places]

    @cached_property
    def jacobian(self) -> fmpq_mat:
        """The matrix of multiplication by the Jacobian's determinant."""
        found: fmpq_mat = determinant(self.jacobian_entries)
        return found

    def norm(self) -> fmpq:
        """The product of the Jacobian's determinant over all complex solutions."""
        return fmpq(self.jacobian.det())

    def norm_where_nonzero(self, p: fmpq_mpoly) -> fmpq:
        """The product of a polynomial over the complex solutions at which it is not zero."""
        coefficients = [fmpq(c) for c in self.matrix(p).charpoly().coeffs()]
        k = next(k for k, c in enumerate(coefficients) if c != 0)
        return coefficients[k] * (-1 if (self.dimension - k) % 2 else 1)

    def coefficients(self) -> list[fmpq]:
        """Of the characteristic polynomials of the Jacobian's determinant and of all conditions."""
        matrices = [self.jacobian, *map(self.matrix, self.conditions)]
        return [fmpq(c) for matrix in matrices for c in matrix.charpoly().coeffs()]

    def _signature(self, weight: fmpq_mat) -> int:
        """The number of positive squares of the trace form (f, g) -> trace(weight f g), less that of
        negative ones: the sum of the weight's signs over the real solutions.
        """
        n, traces = self.dimension, self._traces * weight
        form = fmpq_mat(n, n, [c for p in self._powers for c in (traces * p).entries()])
        # all eigenvalues are real, so Descartes' rule of signs is exact
        coefficients = [fmpq(c) for c in form.charpoly().coeffs()]
        zero = next(k for k, c in enumerate(coefficients) if c != 0)
        signs = [1 if c > 0 else -1 for c in coefficients if c != 0]
        positive = sum(a != b for a, b in pairwise(signs))
        return 2 * positive + zero - n

    @cached_property
    def _powers(self) -> list[fmpq_mat]:
        """The matrices of multiplication by the basis."""
        return [_product(_identity(self.dimension), self.tables, m) for m in self.basis]

    @cached_property
    def _traces(self) -> fmpq_mat:
        """A row: the trace, as a linear function of the coordinates in the basis."""
        n = range(self.dimension)
        traces = [sum((p[k, k] for k in n), fmpq(0)) for p in self._powers]
        return fmpq_mat(1, self.dimension, traces)

    def counts(self) -> Counts | None:
        """Numbers of the real solutions that count, by index and stability; None when some solution
        is degenerate.
        """
        if self.norm() == 0:
            return None
        if index := self._index(self._required):
            return Counts(sum(index), index[0], index)
        total = self.number_of_real_solutions()
        if not self.point.stability:
            return Counts(total, None, None)
        wanted = [*self._required, *map(self.matrix, self.point.stability)]
        return Counts(total, self._number(wanted), None)

    def number_held(self) -> int:
        """The number of the minima that count at which all conditions for stability are positive: a
        count's margins.
        """
        return self._index([self.matrix(p) for p in self.conditions])[0]

    def within(
        self, center: Sequence[Fraction], radius: Fraction, *, counted: bool
    ) -> tuple[int, list[fmpq_mat]]:
        """The number of the real solutions in an open box, and functions that are all positive at
        these and no others.

        Parameters
        ----------
        center : in the order of the model's coordinates.
        counted : whether only solutions that count are asked for.
        """
        positive = self._required if counted else []
        number = self._number(positive)
        for table, x in zip(self._own, map(from_fraction, center), strict=True):
            off = table - _identity(self.dimension) * x
            inside = _identity(self.dimension) * from_fraction(radius) ** 2 - off * off
            # where no solution is lost, all that are left are on this side
            if (left := self._number([*positive, inside])) < number:
                number, positive = left, [*positive, inside]
        return number, positive

    def signs(self, positive: Matrices) -> str:
        """Of the only real solution at which functions are positive: those of the Hessian's
        eigenvalues, positive ones first, or of the conditions for stability.
        """
        if index := self._index(positive):
            negative = index.index(1)
            return "+" * (len(index) - 1 - negative) + "-" * negative
        return "".join(
            "0+-"[self._sum_of_signs(positive, self.matrix(p))] for p in self.point.stability
        )

    def is_degenerate(self, positive: Matrices) -> bool:
        """Whether the only real solution at which functions are positive is a degenerate one."""
        return self.norm() == 0 and not self._sum_of_signs(positive, self.jacobian * self.jacobian)

    def number_of_real_solutions(self) -> int:
        """Of different ones that count, degenerate ones among them."""
        return self._number(self._required)

    def number_of_zeros(self, p: fmpq_mpoly) -> int:
        """Of the real solutions that count, the number of those at which a polynomial is zero."""
        square = self.matrix(p) * self.matrix(p)
        return self.number_of_real_solutions() - self._sum_of_signs(self._required, square)

    def balance(self) -> int:
        """The sum of the signs of the Jacobian's determinant over all real solutions."""
        return self._sum_of_signs((), self.jacobian)

    def _number(self, positive: Matrices) -> int:
        """The number of real solutions at which all of some functions are positive."""
        return self._sum_of_signs(positive, _identity(self.dimension))

    def _sum_of_signs(self, positive: Matrices, weight: fmpq_mat) -> int:
        """The sum of the weight's signs over the real solutions at which all of some functions are
        positive.

        For the number 1 where a function is positive, and 0 elsewhere, stands half the sum of the
        signs of the function and of its square.
        """
        total = 0
        for exponents in product((1, 2), repeat=len(positive)):
            total += self._signature(_product(weight, positive, exponents))
        return total >> len(positive)

    def _index(self, required: Matrices) -> tuple[int, ...]:
        """Numbers of the critical points that count by the number of negative eigenvalues, where
        none is zero; nothing of other solutions."""
        if not self.point.hessian:
            return ()
        minors = self._minors()
        n = len(minors)
        sums: dict[tuple[int, ...], int] = {}
        for chosen in product((0, 1), repeat=n):
            weight = _product(_identity(self.dimension), minors, chosen)
            sums[chosen] = self._sum_of_signs(required, weight)
        index = [0] * (n + 1)
        for signs in product((1, -1), repeat=n):
            number = sum(
                value * prod(s for s, c in zip(signs, chosen, strict=True) if c)
                for chosen, value in sums.items()
            )
            index[negative_eigenvalues(signs)] += number >> n
        return tuple(index)

    def _minors(self) -> list[fmpq_mat]:
        """The Hessian's leading principal minors in a basis in which they vanish at no solution."""
        entries = self.jacobian_entries
        for basis in bases(len(entries)):
            minors = leading_minors(entries, basis, len(entries) - 1)
            if all(m.det() != 0 for m in minors):
                return [*minors, self.jacobian]
        raise AssertionError("a regular form has minors that are not zero in almost every basis")

    def form_traces(self, form: Sequence[int]) -> list[fmpq]:
        """Traces of the powers 1, 2, ..., dimension of a linear form in the coordinates."""
        matrix = fmpq_mat(self.dimension, self.dimension)
        for c, table in zip(reversed(form), self._own, strict=True):
            matrix = matrix + table * fmpq(c)
        # Newton's identities: powers of the matrix would have entries of many more digits than
        # their traces
        coefficients = [fmpq(c) for c in reversed(matrix.charpoly().coeffs())]
        traces: list[fmpq] = []
        for k in range(1, self.dimension + 1):
            total = coefficients[k] * k
            for i in range(1, k):
                total += coefficients[i] * traces[k - i - 1]
            traces.append(-total)
        return traces


def fibre(model: Model, values: Mapping[str, Fraction]) -> SolutionAlgebra:
    """The fibre over rational values of the parameters, as `fibre_over` has it."""
    return fibre_over(derivation_at(model, values))


def fibre_over(point: Derivation) -> SolutionAlgebra:
    """The algebra of the solutions at rational values of the parameters.

    Where some solution is degenerate, or an inequality's polynomial vanishes at one, it is that of
    the solutions at which no inequality's polynomial does.

    Raises
    ------
    NotFinite
        When there are infinitely many complex solutions.
    """
    try:
        found = SolutionAlgebra(*algebra(point.generators(), point.coordinates), point)
        if not point.inequalities or (
            found.norm() != 0 and all(p.det() != 0 for p in found._required)
        ):
            return found
    except NotFinite:
        if not point.inequalities:
            raise
    return SolutionAlgebra(
        *algebra(_saturated(point), point.coordinates + 1), point, saturated=True
    )


def _saturated(point: Derivation) -> list[fmpq_mpoly]:
    """Generators of the ideal of the solutions at which no inequality's polynomial vanishes.

    The inverse of their product is one more variable, the last one.
    """
    ring = CoordinateRing((*point.ring.names, ""), point.ring.angles)
    product = prod((ring.taken(p, point.ring) for p in point.inequalities), start=ring.elements[""])
    return [*(ring.taken(p, point.ring) for p in point.generators()), product - 1]


def _product(start: fmpq_mat, factors: Matrices, exponents: Sequence[int]) -> fmpq_mat:
    """A matrix times powers of others."""
    for factor, e in zip(factors, exponents, strict=True):
        for _ in range(int(e)):
            start = start * factor
    return start


def _identity(n: int) -> fmpq_mat:
    return fmpq_mat(n, n, [fmpq(int(i == j)) for i in range(n) for j in range(n)])


class NotFinite(ArithmeticError):
    """The equations have infinitely many complex solutions at the point."""


def algebra(
    equations: list[fmpq_mpoly], variables: int
) -> tuple[tuple[Monomial, ...], tuple[fmpq_mat, ...]]:
    """The standard monomials, and the matrix of multiplication by each variable, last to first."""
    rules = _reduced_basis(equations, variables)
    # for each variable the power of it that is a leading monomial, 0 where 1 is one
    powers = [[lead[k] for lead in rules if sum(lead) == lead[k]] for k in range(variables)]
    if not all(powers):
        raise NotFinite
    bounds = map(min, powers)
    basis = tuple(
        sorted(
            (
                m
                for m in product(*map(range, bounds))
                if not any(_divides(lead, m) for lead in rules)
            ),
            key=lambda m: (sum(m), m),
        )
    )
    place = {m: i for i, m in enumerate(basis)}
    known: dict[Monomial, list[fmpq]] = {}

    def normal(m: Monomial) -> list[fmpq]:
        """Coordinates of a monomial, by the rules, recursively."""
        if m in known:
            return known[m]
        row = [fmpq(0)] * len(basis)
        if m in place:
            row[place[m]] = fmpq(1)
        else:
            lead = next(r for r in rules if _divides(r, m))
            for tail, c in rules[lead].items():
                times = tuple(t + x - y for t, x, y in zip(tail, m, lead, strict=True))
                for i, x in enumerate(normal(times)):
                    if x != 0:
                        row[i] += c * x
        known[m] = row
        return row

    tables, size = [], len(basis)
    for k in range(variables):
        columns = [c for m in basis for c in normal(tuple(e + (i == k) for i, e in enumerate(m)))]
        tables.append(fmpq_mat(size, size, columns).transpose())
    return basis, tuple(tables)


def _reduced_basis(
    equations: list[fmpq_mpoly], variables: int
) -> dict[Monomial, dict[Monomial, fmpq]]:
    """A Groebner basis as rules: leading monomial -> what it is modulo the ideal."""
    ring: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(
        tuple(f"x{k}" for k in range(variables)), Ordering.degrevlex
    )
    integral = []
    for e in equations:
        scale = lcm(*(int(c.q) for c in e.coeffs()))
        terms = {m[::-1]: int((c * scale).p) for m, c in e.to_dict().items()}
        integral.append(ring.from_dict(terms).primitive()[1])
    vector = fmpz_mpoly_vec(integral, ring)
    rules: dict[Monomial, dict[Monomial, fmpq]] = {}
    for p in vector.buchberger_naive().autoreduction():
        (lead, c), *tail = [(tuple(int(e) for e in m), fmpq(c)) for m, c in p.terms()]
        rules[lead] = {m: -d / c for m, d in tail}
    return rules


def _divides(a: Monomial, b: Monomial) -> bool:
    return all(x <= y for x, y in zip(a, b, strict=True))
