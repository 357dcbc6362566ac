"""Groebner bases over Q(x, y), computed with fraction-free arithmetic in Z[x, y].

Guarantee: the result is the reduced Groebner basis (up to scaling each element) of the ideal over
the field Q(x, y): every S-polynomial was reduced to zero or dropped by one of Buchberger's two
criteria.

Not guaranteed: that it specialises to a Groebner basis at a given point; `discriminant_variety` does not need
that. Where the coefficients are in Z[x, y, z] it does so at any z for which `specialised` finds a
basis.

Source: Buchberger's algorithm with his criteria (Cox, Little, O'Shea, Ideals, Varieties, and
Algorithms, 2.9-2.10). The bases of this package have about seven elements; the whole computation
takes some ten milliseconds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import add
from typing import Any, NamedTuple

from ptmcad.algebra.polynomials import (
    Coefficient,
    Monomial,
    UnknownPolynomial,
    common_factor,
    ratio,
)

Order = tuple[int, ...]
"""The graded reverse lexicographic order for the unknowns taken in the order of this permutation."""


def grevlex_key(m: Monomial) -> tuple[int, ...]:
    """Greater for the greater monomial in the graded reverse lexicographic order."""
    return (sum(m), *(-e for e in reversed(m)))


def order_key(order: Order) -> Callable[[Monomial], tuple[int, ...]]:
    """Greater for the greater monomial in an order."""
    backwards = order[::-1]
    return lambda m: (sum(m), *(-m[k] for k in backwards))


class GroebnerBasis(NamedTuple):
    """A reduced Groebner basis over Q(x, y).

    Attributes
    ----------
    leading : each element's leading monomial.
    removed : the factors that are not constant by which polynomials were divided on the way, each
        once.
    """

    order: Order
    elements: tuple[UnknownPolynomial, ...]
    leading: tuple[Monomial, ...]
    removed: tuple[Coefficient, ...] = ()


def groebner_basis(generators: Sequence[UnknownPolynomial], order: Order) -> GroebnerBasis:
    """The reduced Groebner basis over Q(x, y) of the ideal that the generators span.

    Parameters
    ----------
    generators : polynomials in the unknowns with coefficients in Z[x, y]; empty ones are zero and
        ignored.
    """
    key = order_key(order)
    basis: list[tuple[UnknownPolynomial, Monomial]] = []
    pairs: set[tuple[int, int]] = set()
    removed: list[Coefficient] = []

    def adjoin(p: UnknownPolynomial) -> None:
        pairs.update((i, len(basis)) for i in range(len(basis)))
        basis.append((p, max(p, key=key)))

    for generator in generators:
        if generator:
            adjoin(generator)
    while pairs:
        i, j = min(pairs, key=lambda pair: (key(_join(basis[pair[0]][1], basis[pair[1]][1])), pair))
        pairs.discard((i, j))
        (p, lead_p), (q, lead_q) = basis[i], basis[j]
        join = _join(lead_p, lead_q)
        if sum(join) == sum(lead_p) + sum(lead_q):
            continue  # coprime leading monomials
        if any(
            k not in (i, j)
            and divides(basis[k][1], join)
            and (min(i, k), max(i, k)) not in pairs
            and (min(j, k), max(j, k)) not in pairs
            for k in range(len(basis))
        ):
            continue  # chain criterion: both pairs with k have been dealt with
        remainder = _reduce(_s_polynomial(p, lead_p, q, lead_q, join), basis, key, removed)
        if remainder:
            adjoin(remainder)
    return _reduced(basis, order, removed)


def raised(monomial: Monomial, k: int, by: int = 1) -> Monomial:
    """The monomial times the unknown number k to the power ``by``."""
    return (*monomial[:k], monomial[k] + by, *monomial[k + 1 :])


def powers_of(factors: Sequence[Any], one: Any) -> Callable[[Monomial], Any]:
    """The products of powers of factors that commute, by their exponents; each is computed once,
    from a divisor.

    Parameters
    ----------
    one : the empty product; or a vector that matrices, the factors, are applied to.
    """
    known: dict[Monomial, Any] = {}

    def power(monomial: Monomial) -> Any:
        if monomial not in known:
            k = next((k for k, e in enumerate(monomial) if e), None)
            known[monomial] = one if k is None else factors[k] * power(raised(monomial, k, -1))
        return known[monomial]

    return power


def _join(a: Monomial, b: Monomial) -> Monomial:
    return tuple(map(max, a, b))


def divides(a: Monomial, b: Monomial) -> bool:
    """Whether b is a multiple of a."""
    return all(i <= j for i, j in zip(a, b, strict=True))


def _quotient(a: Monomial, b: Monomial) -> Monomial:
    return tuple(i - j for i, j in zip(a, b, strict=True))


def _combination(
    a: Coefficient,
    p: UnknownPolynomial,
    shift_p: Monomial,
    b: Coefficient,
    q: UnknownPolynomial,
    shift_q: Monomial,
) -> UnknownPolynomial:
    """a x^shift_p p - b x^shift_q q."""
    result = {tuple(map(add, m, shift_p)): a * c for m, c in p.items()}
    for m, c in q.items():
        monomial = tuple(map(add, m, shift_q))
        value = result[monomial] - b * c if monomial in result else -(b * c)
        if value.is_zero():
            del result[monomial]
        else:
            result[monomial] = value
    return result


def _s_polynomial(
    p: UnknownPolynomial, lead_p: Monomial, q: UnknownPolynomial, lead_q: Monomial, join: Monomial
) -> UnknownPolynomial:
    a, b = ratio(p[lead_p], q[lead_q])
    return _combination(b, p, _quotient(join, lead_p), a, q, _quotient(join, lead_q))


def _primitive(
    rest: UnknownPolynomial, done: UnknownPolynomial, removed: list[Coefficient]
) -> tuple[UnknownPolynomial, UnknownPolynomial]:
    """Both parts of one polynomial, divided by the factor common to all its coefficients, which is
    noted.
    """
    common = common_factor([*done.values(), *rest.values()])
    if common.is_one() or common.is_zero():
        return dict(rest), done
    if not common.is_constant() and common not in removed:
        removed.append(common)
    return {m: c / common for m, c in rest.items()}, {m: c / common for m, c in done.items()}


def _reduce(
    p: UnknownPolynomial,
    basis: Sequence[tuple[UnknownPolynomial, Monomial]],
    key: Callable[[Monomial], tuple[int, ...]],
    removed: list[Coefficient],
) -> UnknownPolynomial:
    """The full remainder of p, primitive; p is scaled by leading coefficients on the way."""
    rest, done = _primitive(p, {}, removed)
    while rest:
        top = max(rest, key=key)
        divisor = next(((q, m) for q, m in basis if divides(m, top)), None)
        if divisor is None:
            done[top] = rest.pop(top)
            continue
        q, lead = divisor
        a, b = ratio(q[lead], rest[top])
        rest = _combination(a, rest, (0,) * len(top), b, q, _quotient(top, lead))
        if not a.is_one():
            done = {m: c * a for m, c in done.items()}
        rest, done = _primitive(rest, done, removed)
    return done


def _reduced(
    basis: Sequence[tuple[UnknownPolynomial, Monomial]],
    order: Order,
    removed: list[Coefficient],
) -> GroebnerBasis:
    minimal = [
        (p, m)
        for index, (p, m) in enumerate(basis)
        if not any(
            k != index and divides(n, m) and (n != m or k < index) for k, (_, n) in enumerate(basis)
        )
    ]
    elements, leading = [], []
    for index, (p, m) in enumerate(minimal):
        elements.append(
            _reduce(p, minimal[:index] + minimal[index + 1 :], order_key(order), removed)
        )
        leading.append(m)
    return GroebnerBasis(order, tuple(elements), tuple(leading), tuple(removed))
