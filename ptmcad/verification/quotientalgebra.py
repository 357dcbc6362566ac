"""The algebra Q[x]/(equations) of finitely many solutions: standard monomials and tables of
multiplication.

Guarantee: exact. FLINT's own Buchberger algorithm gives the Groebner basis, in graded reverse
lexicographic order with the last variable first.
"""

from __future__ import annotations

from itertools import product
from math import lcm

from flint import Ordering, fmpq, fmpq_mat, fmpq_mpoly, fmpz_mpoly_ctx, fmpz_mpoly_vec

Monomial = tuple[int, ...]
"""Exponents of the variables, last to first."""


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
            for t, c in rules[lead].items():
                for i, x in enumerate(normal(_times(t, m, lead))):
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


def _times(tail: Monomial, m: Monomial, lead: Monomial) -> Monomial:
    return tuple(t + x - y for t, x, y in zip(tail, m, lead, strict=True))
