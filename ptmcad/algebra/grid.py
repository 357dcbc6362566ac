"""Polynomials in Z[x, y] from their values modulo primes at points of a grid.

Guarantee: exact, under bounds that are proved by who asks: of the exponents that may occur, of the coefficients'
length, of factors that are known. As many points and primes are used as these ask for: nothing is left to chance, and
no prime is a bad one but those that divide a known factor's value at a point, which are passed over.

The exponents (i, j) form a *lower set*: with each it has all smaller ones. The points (x_i, y_j) of the same numbers
determine the polynomial, in Newton's form first along one axis, then along the other (Sauer, Adv. Comput. Math. 2004).
Both are products of matrices modulo the prime: garbage outside of the lower set never comes into it.

As a guard against a fault of the machine or of this program the result is compared, at a point and modulo a prime of
which nothing was used, with one further value.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate, count
from typing import NamedTuple

from flint import fmpz_mat, fmpz_poly, nmod_mat, nmod_poly

from ptmcad.algebra.polynomials import PLANE, Coefficient
from ptmcad.algebra.residues import PRIME_BITS, FaultyValue, combined, primes, quotients

Check = Callable[[], None]
Values = Callable[[int], Callable[[int], Callable[[int], Sequence[int]]]]
"""``at(x)(y)(prime)``: the residues of the polynomials' values at a point."""
Limit = tuple[int, int, int]
"""(a, b, most): all exponents satisfy a i + b j <= most; a and b are not negative."""
Support = tuple[int, ...]
"""For each i how many j occur: a lower set of exponents (i, j)."""
Factors = tuple[tuple[Coefficient, int], ...]


class Asked(NamedTuple):
    """What is proved of polynomials in Z[x, y] beforehand.

    Attributes
    ----------
    number : how many they are.
    support : of the cofactors, when the known factors are divided out.
    bits : the cofactors' coefficients are smaller than 2^bits.
    factors : irreducible polynomials with exponents, whose product divides each of the polynomials.
    nonzero : polynomials that must not vanish where values are asked for, nor modulo a prime there.
    """

    number: int
    support: Support
    bits: int
    factors: Factors
    nonzero: tuple[Coefficient, ...] = ()

    @property
    def primes(self) -> int:
        """The number of primes."""
        return (self.bits + 1) // (PRIME_BITS - 1) + 1

    @property
    def points(self) -> int:
        """The number of points of the grid."""
        return sum(self.support)


def support_of(limits: Sequence[Limit]) -> Support:
    """All exponents within the limits, among which are bounds for i and for j alone."""
    across = min(most // a for a, b, most in limits if a and not b)
    heights = (min((most - a * i) // b for a, b, most in limits if b) for i in range(across + 1))
    return tuple(h + 1 for h in heights if h >= 0)


def cofactors(at: Values, asked: Asked, check: Check) -> list[Coefficient]:
    """The polynomials of which ``at(x)(y)(prime)`` are values, without the known factors.

    Raises
    ------
    FaultyValue
        When one further value is not that of the result.
    """
    if not asked.support:
        return [PLANE.constant(0)] * asked.number
    grid = _grid(asked)
    values: list[list[list[int]]] = [[] for _ in grid.primes]  # by prime: for each point those of the polynomials
    for x, height in zip(count(grid.x), asked.support, strict=False):
        check()
        on_line = at(x)
        for y in range(grid.y, grid.y + height):
            at_point = on_line(y)
            for prime, found in zip(grid.primes, values, strict=True):
                found.append(list(at_point(prime)))
    images: list[list[nmod_poly]] = [[] for _ in range(asked.number)]
    for prime, found in zip(grid.primes, values, strict=True):
        check()
        inverses = quotients([1] * len(found), [int(d) % prime for d in grid.divisors], prime)
        rows = [[v * w % prime for v in point] for point, w in zip(found, inverses, strict=True)]
        for known, image in zip(images, _images(rows, asked, (grid.x, grid.y), prime), strict=True):
            known.append(image)
    results = [_from_images(image, grid.primes, asked.support) for image in images]
    _compare(at, asked, grid, results)
    return results


class _Grid(NamedTuple):
    """Where the values are taken.

    Attributes
    ----------
    x, y : the least coordinates of the points.
    divisors : of the product of the known factors, the values at the points.
    primes : which divide none of these, nor a value of what must not be zero.
    fresh : a further prime.
    """

    x: int
    y: int
    divisors: list[int]
    primes: list[int]
    fresh: int


def _grid(asked: Asked) -> _Grid:
    across, up = len(asked.support), asked.support[0]
    for x, y in _origins(across, up):
        points = [(x + i, y + j) for i, height in enumerate(asked.support) for j in range(height)]
        further = (x + across, y + up)
        curves = (*asked.nonzero, *(f for f, _ in asked.factors))
        avoided = [[int(f(*point)) for point in [*points, further]] for f in curves]
        if any(0 in values for values in avoided):
            continue
        known = avoided[len(asked.nonzero) :]
        powers = [[v**e for v in values] for values, (_, e) in zip(known, asked.factors, strict=True)]
        divisors = [math.prod(values) for values in zip(*powers, strict=True)] if powers else [1] * (len(points) + 1)
        fitting = (p for p in primes() if all(v % p for values in avoided for v in values))
        chosen = [next(fitting) for _ in range(asked.primes + 1)]
        return _Grid(x, y, divisors[:-1], chosen[:-1], chosen[-1])
    raise AssertionError("origins have no end")


def _origins(across: int, up: int) -> Iterator[tuple[int, int]]:
    """Integer points without end, small ones first, the same in every run."""
    yield -(across // 2), -(up // 2)
    yield 1, 1
    source = random.Random("origins")
    for bits in count(8):
        yield source.getrandbits(bits), source.getrandbits(bits)


def _images(values: Sequence[Sequence[int]], asked: Asked, origin: tuple[int, int], prime: int) -> list[nmod_poly]:
    """The coefficients modulo a prime, those of x^i y^j at place i (height of 0) + j."""
    across, up = len(asked.support), asked.support[0]
    starts = list(accumulate(asked.support, initial=0))
    divided, expanded = _differences(across, prime), _expansion(origin[0], across, prime).transpose()
    to_newton, to_powers = _differences(up, prime).transpose(), _expansion(origin[1], up, prime)
    found = []
    for k in range(asked.number):
        rows = []
        for i, height in enumerate(asked.support):
            rows += [values[n][k] for n in range(starts[i], starts[i] + height)] + [0] * (up - height)
        newton = (divided * nmod_mat(across, up, rows, prime) * to_newton).entries()
        kept: list[int] = []
        for i, height in enumerate(asked.support):
            kept += [int(c) for c in newton[i * up : i * up + height]] + [0] * (up - height)
        found.append(nmod_poly((expanded * nmod_mat(across, up, kept, prime) * to_powers).entries(), prime))
    return found


def _differences(size: int, prime: int) -> nmod_mat:
    """From values at consecutive integers to coefficients in Newton's form: the k-th is sum_l v_l (-1)^(k-l) / (l!
    (k-l)!)."""
    factorials = list(accumulate(range(1, size), lambda a, b: a * b % prime, initial=1))
    inverse = quotients([1] * size, factorials, prime)
    entries = [
        inverse[m] * inverse[k - m] * (-1) ** (k - m) % prime if m <= k else 0 for k in range(size) for m in range(size)
    ]
    return nmod_mat(size, size, entries, prime)


def _expansion(first: int, size: int, prime: int) -> nmod_mat:
    """Row k: the coefficients of the product of (u - first - l) over l < k."""
    row, rows = fmpz_poly([1]), []
    for k in range(size):
        rows += [row[j] for j in range(size)]
        row *= fmpz_poly([-(first + k), 1])
    return nmod_mat(fmpz_mat(size, size, rows), prime)


def _from_images(images: Sequence[nmod_poly], moduli: Sequence[int], support: Support) -> Coefficient:
    coefficients = combined(list(zip(images, moduli, strict=True)))
    up = support[0]
    return PLANE.from_dict({divmod(n, up): int(c) for n, c in enumerate(coefficients.coeffs()) if c})


def _compare(at: Values, asked: Asked, grid: _Grid, results: Sequence[Coefficient]) -> None:
    """Compare the result with a value at a point, and modulo a prime, of which it was not made."""
    x, y, prime = grid.x + len(asked.support), grid.y + asked.support[0], grid.fresh
    known = math.prod(int(f(x, y)) ** e for f, e in asked.factors)
    if [int(p(x, y)) * known % prime for p in results] != list(at(x)(y)(prime)):
        raise FaultyValue(
            f"a polynomial interpolated at {asked.points} points modulo {asked.primes} primes is wrong at ({x}, {y})"
        )
