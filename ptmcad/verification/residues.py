"""Long discriminants and resultants with respect to v in Z[u], from residues modulo primes.

Guarantee: exact. Points and primes at which a leading coefficient or a known factor vanishes are not used; at all
others residues of values are values of residues. Their numbers come from bounds that are proved:

- *Degree, and known factors.* Let h be the lower convex hull of the orders of the coefficients c_j of v^j at a place of
  Q(u). Newton's polygon gives the orders r of the n roots, in increasing order those of its edges from right to left,
  and that of the difference of two roots is at least the smaller one. So disc = c_n^(2n-2) prod (r_i - r_j)^2 has at
  least the order 2 (h(1) + ... + h(n-1)): by summation by parts h(n) drops out. At infinity this bounds the degree, at
  an irreducible polynomial its multiplicity. A shift of v changes coefficients and not the discriminant.
- *Height.* Each coefficient is at most the largest absolute value on the unit circle, which Hadamard's inequality for
  Sylvester's matrix bounds from the coefficients' sums of absolute values, for each unit t of v.

What was found is compared at a further point, modulo a further prime. References: von zur Gathen & Gerhard, Modern
Computer Algebra, sections 5.4 and 10.2 (interpolation and Chinese remainders by a tree), 6.8 (bounds).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import accumulate, count, pairwise
from typing import NamedTuple

from flint import fmpz, fmpz_poly, nmod_poly

Rows = Sequence[fmpz_poly]
"""The coefficients in Z[u] of v^0, v^1, ..., the last one not zero."""


class Bounds(NamedTuple):
    """Of a polynomial: degree, binary logarithm of its coefficients, and powers that divide it."""

    degree: int
    bits: int
    factors: tuple[tuple[fmpz_poly, int], ...] = ()


class NotReproduced(ArithmeticError):
    """A polynomial that was put together from residues has not the value at another point: a fault of the machine."""


def discriminant(p: Rows) -> fmpz_poly:
    """The discriminant, for degree at least 2, up to sign."""
    n = len(p) - 1
    norms = [sum(abs(int(a)) for a in c.coeffs()) for c in p]
    # the two partial derivatives of the form of degree n have a resultant n^(n - 2) times the discriminant
    left, right = [(n - j) * a for j, a in enumerate(norms[:-1])], [j * a for j, a in enumerate(norms)][1:]
    bits = hadamard(left, right) - math.floor((n - 2) * math.log2(n))
    bounds = Bounds(discriminant_degree(p), bits, known_factors(p))
    return _lifted(lambda f: int(f[0].resultant(f[0].derivative()) / f[0].leading_coefficient()), [p], bounds)


def resultant(p: Rows, q: Rows, degree: int) -> fmpz_poly:
    """The resultant, of at most this degree."""
    norms = [[sum(abs(int(a)) for a in c.coeffs()) for c in rows] for rows in (p, q)]
    return _lifted(lambda f: int(f[0].resultant(f[1])), [p, q], Bounds(degree, hadamard(*norms)))


def discriminant_degree(p: Rows) -> int:
    """A bound for the discriminant's degree."""
    return -_order({j: -int(c.degree()) for j, c in enumerate(p) if c}, len(p) - 1)


def known_factors(p: Rows) -> tuple[tuple[fmpz_poly, int], ...]:
    """Powers of irreducible polynomials that divide the discriminant, at places over which many roots run together."""
    best: dict[tuple[int, ...], int] = {}
    for shift in (0, 1, -1):
        rows = _moved(p, shift)
        for end in (rows[0], rows[-1]):
            for f, multiplicity in end.factor()[1] if _has_multiple_factor(end) else []:
                if multiplicity > 1:
                    key = tuple(int(c) for c in f.coeffs())
                    orders = {j: _multiplicity(c, f) for j, c in enumerate(rows) if c}
                    best[key] = max(best.get(key, 0), _order(orders, len(p) - 1))
    return tuple((fmpz_poly(list(key)), e) for key, e in best.items() if e)


def _has_multiple_factor(p: fmpz_poly) -> bool:
    return bool(p.degree() > 1 and p.gcd(p.derivative()).degree() > 0)


def _multiplicity(p: fmpz_poly, f: fmpz_poly) -> int:
    for e in count():
        quotient, rest = divmod(p, f)
        if rest:
            return e
        p = quotient
    raise AssertionError


def _order(orders: Mapping[int, int], n: int) -> int:
    """2 (h(1) + ... + h(n - 1)) for the lower convex hull h of these points, rounded up."""
    corners: list[tuple[int, int]] = []
    for j in sorted(orders):
        while len(corners) > 1:
            (a, x), (b, y) = corners[-2:]
            if (y - x) * (j - a) < (orders[j] - x) * (b - a):
                break
            corners.pop()
        corners.append((j, orders[j]))
    total = Fraction(0)
    for (a, x), (b, y) in pairwise(corners):
        total += sum((x + Fraction(y - x, b - a) * (j - a) for j in range(max(a, 1), min(b, n))), Fraction(0))
    return math.ceil(2 * total)


def _moved(p: Rows, shift: int) -> list[fmpz_poly]:
    """p(u, v + shift), by binomial coefficients."""
    if not shift:
        return list(p)
    zero = fmpz_poly([])
    return [
        sum((c * (math.comb(j, k) * shift ** (j - k)) for j, c in enumerate(p) if j >= k), zero) for k in range(len(p))
    ]


def hadamard(p: Sequence[int], q: Sequence[int]) -> int:
    """A number b with 2^b above t^(-n m) |p(t v)|^m |q(t v)|^n, in Euclid's norm of coefficients, for the best of
    some t.

    Sums of doubles are off by less than the bit that is added.
    """
    n, m = len(p) - 1, len(q) - 1
    logs = [[(j, math.log2(c)) for j, c in enumerate(row) if c] for row in (p, q)]
    if not all(logs):
        return 0

    def norm(row: Sequence[tuple[int, float]], s: float) -> float:
        top = max(c + s * j for j, c in row)
        return top + math.log2(math.fsum(2 ** (2 * (c + s * j - top)) for j, c in row)) / 2

    return math.ceil(
        1 + min(m * norm(logs[0], k / 4) + n * norm(logs[1], k / 4) - n * m * k / 4 for k in range(-96, 97))
    )


Value = Callable[[Sequence[nmod_poly]], int]
"""What is asked for, of polynomials in v modulo a prime."""


def _lifted(value: Value, polynomials: Sequence[Rows], bounds: Bounds) -> fmpz_poly:
    """The polynomial with these bounds that has this value at every integer u."""
    known = math.prod((f**e for f, e in bounds.factors), start=fmpz_poly([1]))
    number = bounds.degree - known.degree() + 1
    if number < 1:
        return fmpz_poly([])
    avoided = [known, *(rows[-1] for rows in polynomials)]
    points = _points(avoided, number)
    over = [[fmpz_poly([c(u) for c in rows]) for rows in polynomials] for u in points]
    divisors = [known(u) for u in points]
    leading = [math.prod((rows[-1](u) for rows in polynomials), start=fmpz(1)) for u in points]
    primes = (q for q in count(2**62 - 1, -2) if fmpz(q).is_prime())
    images: list[tuple[fmpz_poly, int]] = []
    while not images or 61 * len(images) < bounds.bits + 1:
        q = next(primes)
        if all(d % q and c % q for d, c in zip(divisors, leading, strict=True)):
            found = [value([nmod_poly(f, q) for f in fibre]) for fibre in over]
            cofactor = _through(found, [int(d % q) for d in divisors], points[0], q)
            images.append((fmpz_poly([int(c) for c in (cofactor * nmod_poly(known, q)).coeffs()]), q))
    result = _of_residues(images)
    _confirm(result, value, polynomials, points[-1] + 1, primes)
    return result


def _points(avoided: Sequence[fmpz_poly], number: int) -> range:
    """So many consecutive integers at which none of these is zero, from 0 on or a little later."""
    start = 0
    for f in avoided:
        for g, _ in f.factor()[1] if f.degree() > 0 else []:
            if g.degree() == 1 and int(g[0]) % int(g[1]) == 0:
                zero = -int(g[0]) // int(g[1])
                start = max(start, zero + 1) if zero <= 10**6 else start
    while any(f(u) == 0 for f in avoided for u in (start, start + number)):
        start += 1
    return range(start, start + number)


def _through(numerators: Sequence[int], denominators: Sequence[int], start: int, q: int) -> nmod_poly:
    """The polynomial modulo q with these quotients as values at consecutive integers: Lagrange's sum, two by two."""
    last = len(numerators) - 1
    factorials = list(accumulate(range(1, last + 1), lambda a, k: a * k % q, initial=1))
    # the product of the differences to all other points is (-1)^(last - k) k! (last - k)!
    weights = [
        y * pow(d * factorials[k] * factorials[last - k], -1, q) % q
        for k, (y, d) in enumerate(zip(numerators, denominators, strict=True))
    ]
    parts = [
        (nmod_poly([-w if (last - k) % 2 else w], q), nmod_poly([-(start + k), 1], q)) for k, w in enumerate(weights)
    ]
    while len(parts) > 1:
        merged = [(a * n + b * m, m * n) for (a, m), (b, n) in zip(parts[::2], parts[1::2], strict=False)]
        parts = merged + parts[2 * len(merged) :]
    return parts[0][0]


def _of_residues(images: Sequence[tuple[fmpz_poly, int]]) -> fmpz_poly:
    """The polynomial of least coefficients in absolute value with these residues."""
    parts = list(images)
    while len(parts) > 1:
        merged = [_of_two(*pair) for pair in zip(parts[::2], parts[1::2], strict=False)]
        parts = merged + parts[2 * len(merged) :]
    ((p, modulus),) = parts
    return fmpz_poly([int(c) - modulus if 2 * int(c) > modulus else int(c) for c in p.coeffs()])


def _of_two(left: tuple[fmpz_poly, int], right: tuple[fmpz_poly, int]) -> tuple[fmpz_poly, int]:
    (a, m), (b, n) = left, right
    inverse = pow(m, -1, n)
    return a + m * fmpz_poly([int(c) * inverse % n for c in (b - a).coeffs()]), m * n


def _confirm(result: fmpz_poly, value: Value, polynomials: Sequence[Rows], start: int, primes: Iterator[int]) -> None:
    u = next(u for u in count(start) if all(rows[-1](u) != 0 for rows in polynomials))
    q = next(q for q in primes if all(rows[-1](u) % q for rows in polynomials))
    if value([nmod_poly([int(c(u)) for c in rows], q) for rows in polynomials]) != int(result(u)) % q:
        raise NotReproduced(f"a polynomial of degree {result.degree()} from residues is wrong at {u}")
