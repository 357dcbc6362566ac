"""The equilibria over one rational point, by a route of its own: geometry, Groebner basis at the point, trace forms.

Guarantee: exact. The potential is formed from the coordinates of the nodes, in rational numbers, by `derivation`, and
differentiated here; nothing is taken from `ptmcad.exact.models`, so a mistake there or here shows as a contradiction.

The order is graded reverse lexicographic with s2 > c2 > s1 > c1, FLINT's own Buchberger algorithm runs at the point
itself, and counts come from signatures of trace forms: another elimination than the one over Q(x, y) in
`ptmcad.exact.variety` and another count than the root isolation in `ptmcad.exact.counting`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise, product

from flint import Ordering, fmpq, fmpq_mat, fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly_ctx, fmpz_mpoly_vec

from ptmcad.verification.derivation import ANGLES, PARAMETERS, Configuration, potential, rational

_RATIONAL: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(("s2", "c2", "s1", "c1"), Ordering.degrevlex)
_INTEGER: fmpz_mpoly_ctx = fmpz_mpoly_ctx.get(("s2", "c2", "s1", "c1"), Ordering.degrevlex)
_S2, _C2, _S1, _C1 = _RATIONAL.gens()

Monomial = tuple[int, int, int, int]


class NotFinite(ArithmeticError):
    """The equations have infinitely many complex solutions at the point."""


def _d(p: fmpq_mpoly, angle: int) -> fmpq_mpoly:
    """The derivative with respect to the first or the second angle."""
    c, s, names = (_C1, _S1, ("c1", "s1")) if angle == 1 else (_C2, _S2, ("c2", "s2"))
    return c * p.derivative(names[1]) - s * p.derivative(names[0])


@dataclass(frozen=True)
class Fibre:
    """The algebra Q[c1, s1, c2, s2]/(equilibrium equations) at one point.

    Attributes
    ----------
    basis : the standard monomials, exponents of (s2, c2, s1, c1).
    tables : the matrix of multiplication by each of s2, c2, s1, c1; columns are images of the basis.
    """

    basis: tuple[Monomial, ...]
    tables: tuple[fmpq_mat, ...]
    hessian: tuple[fmpq_mpoly, fmpq_mpoly, fmpq_mpoly]

    @property
    def dimension(self) -> int:
        """Number of complex solutions, with multiplicity."""
        return len(self.basis)

    def matrix(self, p: fmpq_mpoly) -> fmpq_mat:
        """The matrix of multiplication by p."""
        total = fmpq_mat(self.dimension, self.dimension)
        for exponents, c in p.terms():
            term = _identity(self.dimension) * c
            for table, e in zip(self.tables, exponents, strict=True):
                for _ in range(int(e)):
                    term = term * table
            total = total + term
        return total

    @cached_property
    def jacobian(self) -> fmpq_mat:
        """The matrix of multiplication by det H."""
        h11, h12, h22 = self.hessian
        return self.matrix(h11) * self.matrix(h22) - self.matrix(h12) * self.matrix(h12)

    def norm(self) -> fmpq:
        """The product of det H over all complex solutions."""
        return fmpq(self.jacobian.det())

    def signature(self, weight: fmpq_mat) -> tuple[int, int]:
        """Numbers of positive and negative squares of the trace form (f, g) -> trace(weight f g).

        Their difference is the sum of the weight's signs over the real solutions; their sum is the number of
        different complex solutions where the weight is not zero.
        """
        powers = [self._monomial(m) for m in self.basis]
        weighted = [weight * p for p in powers]
        n = self.dimension
        form = fmpq_mat(n, n)
        for i, j in product(range(n), repeat=2):
            if i <= j:
                form[i, j] = form[j, i] = _trace_of_product(weighted[i], powers[j])
        # all eigenvalues are real, so Descartes' rule of signs is exact
        coefficients = [fmpq(c) for c in form.charpoly().coeffs()]
        zero = next(k for k, c in enumerate(coefficients) if c != 0)
        signs = [1 if c > 0 else -1 for c in coefficients if c != 0]
        positive = sum(a != b for a, b in pairwise(signs))
        return positive, n - zero - positive

    def determinant_of_traces(self, monomials: Sequence[Monomial]) -> fmpq:
        """The determinant of the matrix with entries trace(f g), for all f and g among the monomials."""
        powers = [self._monomial(m) for m in monomials]
        return fmpq(fmpq_mat([[_trace_of_product(f, g) for g in powers] for f in powers]).det())

    def _monomial(self, m: Monomial) -> fmpq_mat:
        result = _identity(self.dimension)
        for table, e in zip(self.tables, m, strict=True):
            for _ in range(e):
                result = result * table
        return result

    def morse_index(self) -> tuple[int, int, int] | None:
        """Numbers of minima, saddles and maxima; None when some solution is degenerate."""
        one = _identity(self.dimension)
        h11, _, h22 = self.hessian
        trace = self.matrix(h11) + self.matrix(h22)
        positive, negative = self.signature(self.jacobian)
        if positive + negative != self.dimension:
            return None
        total = _difference(self.signature(one))
        balance = positive - negative
        side = (_difference(self.signature(trace)) + _difference(self.signature(self.jacobian * trace))) // 2
        definite = (total + balance) // 2
        return ((definite + side) // 2, (total - balance) // 2, (definite - side) // 2)

    def form_traces(self, form: tuple[int, int, int, int]) -> list[fmpq]:
        """Traces of the powers 1, 2, ..., dimension of a linear form in the unknowns."""
        matrix = fmpq_mat(self.dimension, self.dimension)
        for c, table in zip(form, self.tables, strict=True):
            matrix = matrix + table * fmpq(c)
        power, traces = matrix, []
        for _ in range(self.dimension):
            traces.append(sum((power[i, i] for i in range(self.dimension)), fmpq(0)))
            power = power * matrix
        return traces


def fibre(values: Mapping[str, Fraction]) -> Fibre:
    """The fibre over rational values of the parameters.

    Raises
    ------
    NotFinite
        When there are infinitely many complex solutions.
    """
    energy = _potential(values)
    e1, e2 = _d(energy, 1), _d(energy, 2)
    basis, tables = _algebra(_equations(e1, e2))
    return Fibre(basis, tables, (_d(e1, 1), _d(e1, 2), _d(e2, 2)))


def _potential(values: Mapping[str, Fraction]) -> fmpq_mpoly:
    circles = dict(zip(ANGLES, ((_C1, _S1), (_C2, _S2)), strict=True))
    energy: fmpq_mpoly = potential(Configuration({name: rational(values[name]) for name in PARAMETERS}, circles))
    return energy


def _equations(e1: fmpq_mpoly, e2: fmpq_mpoly) -> list[fmpq_mpoly]:
    """The entries of the gradient that are not zero, and the circles."""
    return [*(e for e in (e1, e2) if not e.is_zero()), _C1 * _C1 + _S1 * _S1 - 1, _C2 * _C2 + _S2 * _S2 - 1]


def standard_monomials(values: Mapping[str, Fraction]) -> tuple[Monomial, ...]:
    """The monomials, exponents of (s2, c2, s1, c1), that are standard in the order with c1 > s1 > c2 > s2.

    It is graded reverse lexicographic, as the one in which `fibre` computes is, which has the unknowns the other way
    round.

    Raises
    ------
    NotFinite
        When there are infinitely many complex solutions.
    """
    energy = _potential(values)
    turned = [
        _RATIONAL.from_dict({tuple(reversed(_monomial(m))): fmpq(c) for m, c in e.terms()})
        for e in _equations(_d(energy, 1), _d(energy, 2))
    ]
    basis, _ = _algebra(turned)
    return tuple((a, b, c, d) for d, c, b, a in basis)


def _algebra(equations: list[fmpq_mpoly]) -> tuple[tuple[Monomial, ...], tuple[fmpq_mat, ...]]:
    integral = []
    for e in equations:
        scale = 1
        for c in e.coeffs():
            scale = scale * int(c.q)
        integral.append(_INTEGER.from_dict({m: int((c * scale).p) for m, c in e.to_dict().items()}))
    vector = fmpz_mpoly_vec([p.primitive()[1] for p in integral], _INTEGER)
    rules: dict[Monomial, dict[Monomial, fmpq]] = {}
    for p in vector.buchberger_naive().autoreduction():
        terms = [(_monomial(m), fmpq(c)) for m, c in p.terms()]
        (lead, c), tail = terms[0], terms[1:]
        rules[lead] = {m: -d / c for m, d in tail}
    if not all(any(sum(lead) == lead[k] for lead in rules) for k in range(4)):
        raise NotFinite
    bounds = [next(lead[k] for lead in rules if sum(lead) == lead[k]) if (0, 0, 0, 0) not in rules else 0
              for k in range(4)]  # fmt: skip
    basis = tuple(
        sorted(
            (_monomial(m) for m in product(*map(range, bounds)) if not any(_divides(lead, m) for lead in rules)),
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
            for t, c in rules[lead].items():
                for i, x in enumerate(normal(_times(t, m, lead))):
                    if x != 0:
                        row[i] += c * x
        known[m] = row
        return row

    tables = []
    for k in range(4):
        columns = [normal(_monomial(e + (i == k) for i, e in enumerate(m))) for m in basis]
        tables.append(fmpq_mat([[column[i] for column in columns] for i in range(len(basis))]))
    return basis, tuple(tables)


def _monomial(exponents: object) -> Monomial:
    a, b, c, d = (int(e) for e in exponents)  # type: ignore[attr-defined]
    return (a, b, c, d)


def _divides(a: Monomial, b: tuple[int, ...]) -> bool:
    return all(x <= y for x, y in zip(a, b, strict=True))


def _times(tail: Monomial, m: Monomial, lead: Monomial) -> Monomial:
    return _monomial(t + x - y for t, x, y in zip(tail, m, lead, strict=True))


def _identity(n: int) -> fmpq_mat:
    return fmpq_mat([[fmpq(int(i == j)) for j in range(n)] for i in range(n)])


def _trace_of_product(a: fmpq_mat, b: fmpq_mat) -> fmpq:
    n = a.nrows()
    return sum((a[i, k] * b[k, i] for i in range(n) for k in range(n)), fmpq(0))


def _difference(pair: tuple[int, int]) -> int:
    return pair[0] - pair[1]
