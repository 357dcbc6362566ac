"""Whether a Groebner basis over Q that somebody else has computed lies in the ideal of the
equations, with proof.

Guarantee: True is a proof, which needs that the equations vanish in the quotient that the basis
describes (`fibre_algebra` checks it). It does not rest on how the basis was found. False means that the
search was given up.

The proof is in docs/method.md, "Bases by msolve". In short: S is a space of polynomials that are
known to be in the ideal I, reduced by elements of the basis that are already proved, and J is the
ideal of the basis, I in J. Of the monomials up to a degree that no proved leading monomial divides,
those outside of the staircase are as many as the dimension of J there. Where S has so many
dimensions it is all of J there, with the basis elements of that degree. The rank of S modulo a
prime is a lower bound of its dimension. Where degrees fall, S is brought to echelon form over Q.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from flint import fmpq, fmpq_mat, nmod, nmod_mat

from ptmcad.algebra.groebner import grevlex_key, raised
from ptmcad.algebra.polynomials import Monomial
from ptmcad.algebra.resultants import Check, primes

RationalPolynomial = Mapping[Monomial, fmpq]
Rules = Mapping[Monomial, RationalPolynomial]
"""A leading monomial to what it is equal to."""
_Sparse = dict[Monomial, Any]
_Source = tuple[int, Monomial]
"""Which polynomial, and the monomial that it is multiplied by."""
BEYOND = 4
"""Degrees above those of the basis that are tried."""


class _Level(NamedTuple):
    """The monomials up to a degree, reduced by the proved elements: those that are left stand for
    themselves.

    Attributes
    ----------
    columns : the reduced monomials outside of the staircase, those of high degree first.
    """

    degree: int
    proved: Rules
    monomials: tuple[Monomial, ...]
    columns: tuple[Monomial, ...]


def lies_in_ideal(
    equations: Sequence[RationalPolynomial], rules: Rules, basis: Sequence[Monomial], pause: Check
) -> bool:
    """Whether all elements of a basis are proved to be in the ideal that the equations generate.

    Parameters
    ----------
    equations : with the value zero in the quotient by the basis, in which the monomials of
        ``basis`` are independent.
    rules : the reduced Groebner basis in the graded reverse lexicographic order.
    basis : the monomials that no leading monomial divides.
    pause : called now and then; it may raise to end the search.
    """
    width = len(next(iter(rules)))
    proved: dict[Monomial, RationalPolynomial] = {}
    falls: list[RationalPolynomial] = []
    degree = 1
    last = max(max(map(sum, p), default=0) for p in (*equations, rules)) + BEYOND
    while degree <= last:
        level = _level(width, degree, proved, frozenset(basis))
        settled, found = _settled(level, [*equations, *falls], basis, pause)
        fresh = {m: rule for m, rule in rules.items() if sum(m) <= settled and m not in proved}
        proved.update(fresh)
        if len(proved) == len(rules):
            return True
        if settled == degree:
            degree, falls = degree + 1, []
        elif fresh or len(found) > len(falls):
            falls = found
        else:
            degree += 1
    return False


def _monomials(width: int, degree: int) -> Iterator[Monomial]:
    """All monomials of a degree."""
    if width == 1:
        yield (degree,)
        return
    for first in range(degree + 1):
        for rest in _monomials(width - 1, degree - first):
            yield (first, *rest)


def _level(width: int, degree: int, proved: Rules, staircase: frozenset[Monomial]) -> _Level:
    every = sorted((m for d in range(degree + 1) for m in _monomials(width, d)), key=grevlex_key)
    divisible: set[Monomial] = set()
    for m in every:
        if m in proved or any(m[k] and raised(m, k, -1) in divisible for k in range(width)):
            divisible.add(m)
    columns = [m for m in reversed(every) if m not in divisible and m not in staircase]
    return _Level(degree, proved, tuple(every), tuple(columns))


def _settled(
    level: _Level, known: Sequence[RationalPolynomial], basis: Sequence[Monomial], pause: Check
) -> tuple[int, list[RationalPolynomial]]:
    """Up to which degree the basis is proved by multiples of known polynomials, and what falls
    below the level's.

    Returns
    -------
    The degree, and the combinations over Q whose degree is smaller than the level's.
    """
    polynomials = [*known, *({m: fmpq(-1), **rule} for m, rule in level.proved.items())]
    chosen = _independent(level, polynomials, pause)
    if len(chosen) == len(level.columns):
        return level.degree, []
    if all(sum(m) == level.degree for m in level.columns):
        return level.degree - 1, []
    exact = _Reduction(level, fmpq, pause)
    order = [*level.columns, *basis]
    position = {m: j for j, m in enumerate(order)}
    matrix = fmpq_mat(len(chosen), len(order))
    for i, source in enumerate(chosen):
        pause()
        for m, c in exact.multiple(polynomials, source).items():
            matrix[i, position[m]] = c
    echelon, rank = matrix.rref()
    low = next(
        (j for j, m in enumerate(level.columns) if sum(m) < level.degree), len(level.columns)
    )
    falls: list[RationalPolynomial] = []
    for i in range(rank):
        row = [echelon[i, j] for j in range(len(order))]
        if not any(row[:low]):
            falls.append({m: c for m, c in zip(order, row, strict=True) if c})
    degrees = [max(map(sum, p)) for p in falls]
    settled = level.degree
    while sum(d <= settled for d in degrees) < sum(sum(m) <= settled for m in level.columns):
        settled -= 1
    return settled, falls


def _independent(
    level: _Level, polynomials: Sequence[RationalPolynomial], pause: Check
) -> list[_Source]:
    """Reduced multiples that are independent modulo a prime by their entries in the columns, as
    many as there are.
    """
    for prime in primes():
        try:
            rows = list(_Reduction(level, partial(_residue, prime), pause).rows(polynomials))
        except ZeroDivisionError:  # the prime divides a denominator
            continue
        break
    if not rows or not level.columns:
        return []
    position = {m: j for j, m in enumerate(level.columns)}
    matrix = nmod_mat(len(position), len(rows), prime)
    for i, (_, row) in enumerate(rows):
        for m, c in row.items():
            if m in position:
                matrix[position[m], i] = c
    pause()
    echelon, rank = matrix.rref()
    found, j = [], 0
    for i in range(rank):
        while not echelon[i, j]:
            j += 1
        found.append(rows[j][0])
    return found


def _residue(prime: int, c: fmpq) -> nmod:
    return nmod(int(c.p), prime) / int(c.q)


class _Reduction:
    """Polynomials up to a level's degree, reduced by what is proved there, over Q or modulo a
    prime.

    Parameters
    ----------
    number : a rational number in the field.
    """

    def __init__(self, level: _Level, number: Callable[[fmpq], Any], pause: Check) -> None:
        self._level, self._number, self._pause = level, number, pause
        self._zero = number(fmpq(0))
        self._table: dict[Monomial, _Sparse] = {}
        for m in level.monomials:  # smaller ones first
            self._table[m] = self._reduced(m)

    def rows(self, polynomials: Sequence[RationalPolynomial]) -> Iterator[tuple[_Source, _Sparse]]:
        """The reduced multiples that are not zero, up to the degree."""
        width = len(self._level.monomials[0])
        for number, p in enumerate(polynomials):
            if not p:
                continue
            self._pause()
            room = self._level.degree - max(map(sum, p))
            for shift in (m for d in range(room + 1) for m in _monomials(width, d)):
                row = self.multiple(polynomials, (number, shift))
                if row:
                    yield (number, shift), row

    def multiple(self, polynomials: Sequence[RationalPolynomial], source: _Source) -> _Sparse:
        """One reduced multiple."""
        number, shift = source
        total: _Sparse = {}
        for m, c in polynomials[number].items():
            self._add(
                total, self._table[tuple(map(sum, zip(m, shift, strict=True)))], self._number(c)
            )
        return {m: c for m, c in total.items() if c}

    def _reduced(self, m: Monomial) -> _Sparse:
        level = self._level
        if m in level.proved:
            return {n: self._number(c) for n, c in level.proved[m].items()}
        for k, e in enumerate(m):
            if e:
                below = self._table[raised(m, k, -1)]
                if (
                    len(below) != 1 or raised(m, k, -1) not in below
                ):  # it is reducible, and so is its multiple
                    total: _Sparse = {}
                    for n, c in below.items():
                        self._add(total, self._table[raised(n, k)], c)
                    return {n: c for n, c in total.items() if c}
        return {m: self._number(fmpq(1))}

    def _add(self, total: _Sparse, row: _Sparse, factor: Any) -> None:
        for n, x in row.items():
            total[n] = total.get(n, self._zero) + factor * x
