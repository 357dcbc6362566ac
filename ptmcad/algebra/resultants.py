"""Discriminants and resultants in Z[u] of polynomials in Z[u][v], by evaluation at integers and
interpolation.

Guarantee: exact. The number of evaluation points comes from a proved bound for the degree: nothing
is left to chance. Long values are taken modulo primes, as many as a proved bound for the
coefficients asks for; no prime is a bad one, as the formal discriminant commutes with every map of
rings. Of a long polynomial that a reflection v to 2 m(u) - v maps to itself, the
discriminant in (v - m)^2 is computed, of half the degree; where m = 0 that is left to the caller.

The degree is the negative of the order o at infinity. That extends to the roots of
p = sum_i c_i v^i over an algebraic closure, and the slopes of the lower convex hull of the points
(i, o(c_i)) are the orders of the roots, with a change of sign (Newton's polygon). Now
disc p = c_n^(2n-2) prod_{i<j} (r_i - r_j)^2 and res(p, q) = c_n^m d_m^n prod (r_i - s_j), and
o(r - s) is at least the smaller one of o(r) and o(s). The bound is sharp where roots of the same
order have different leading terms.

The bound for coefficients: a coefficient of a polynomial in Z[u] is at most the polynomial's largest
value on the circle |u| = 1, where |c(u)| is at most the sum |c|_1 of c's absolute coefficients.
There Hadamard's inequality for Sylvester's matrix, with t v in place of v, says

    |res_v(p, q)| <= t^(-n m) (sum_i |p_i|_1^2 t^(2i))^(m/2) (sum_j |q_j|_1^2 t^(2j))^(n/2)    for every t > 0,

and n^(n-2) disc_v(p) is up to sign the resultant of n p - v p' and p', both of degree n - 1.

References: Collins, The calculation of multivariate polynomial resultants, J. ACM 18 (1971);
Goldstein & Graham, SIAM Review 16 (1974); von zur Gathen & Gerhard, Modern Computer Algebra,
sections 5.5 and 6.8.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import count, islice, pairwise
from typing import Any

from flint import fmpq_poly, fmpz, fmpz_poly, nmod_poly

from ptmcad.algebra.reflections import axis_of, squared

PRIME_BITS = 63
"""FLINT's arithmetic is fastest where two residues add up without overflow."""


def primes() -> Iterator[int]:
    """Primes, from the largest of `PRIME_BITS` bits downwards."""
    candidate = fmpz(2**PRIME_BITS - 1)
    while True:
        if candidate.is_prime():
            yield int(candidate)
        candidate -= 2


Coefficients = Sequence[fmpz_poly]
Check = Callable[[], None]
LONG = 100_000
"""Points times the product of the degrees in v; less takes milliseconds."""
CALL = 150
"""The cost of one value modulo a prime in addition to Euclid's algorithm, in its steps (products of
residues).
"""


def nothing() -> None:
    """The check that never stops a computation."""


def discriminant(p: Coefficients, check: Check = nothing) -> fmpz_poly:
    """The discriminant with respect to v of sum_i p_i(u) v^i, for degree at least 1 in v.

    ``check`` is called between evaluations; it may raise to stop.
    """
    n = len(p) - 1
    if n < 2:
        return fmpz_poly([1])
    bound = discriminant_degree(p)
    if (bound + 1) * n * (n - 1) >= LONG:
        if axis := axis_of(p):
            return _by_reflection(p, axis, check)
        return _long_discriminant(tuple(tuple(int(a) for a in c.coeffs()) for c in p), bound, check)
    return _discriminant(p, bound, check)


@lru_cache(maxsize=4)
def _long_discriminant(p: tuple[tuple[int, ...], ...], bound: int, check: Check) -> fmpz_poly:
    """Kept, as a decomposition asks for it once more when it looks for points over the abscissae."""
    return _discriminant([fmpz_poly(list(c)) for c in p], bound, check)


def _discriminant(p: Coefficients, bound: int, check: Check) -> fmpz_poly:
    n = len(p) - 1

    def bits() -> int:  # of n^(n-2) times the discriminant
        norms = _norms(p)
        return _bits(
            [(n - i) * c for i, c in enumerate(norms[:-1])],
            [i * c for i, c in enumerate(norms)][1:],
        )

    def formal(value: Any) -> Any:
        if value.degree() == n:
            return value.discriminant()
        if value.degree() < n - 1:
            return 0
        # formal discriminant when the leading coefficient vanishes once: c_(n-1)^2 disc of the rest
        return value.leading_coefficient() ** 2 * (value.discriminant() if n > 2 else 1)

    return _interpolated([p], formal, (bound, n * (n - 1)), bits, check)


def _by_reflection(p: Coefficients, axis: fmpq_poly, check: Check) -> fmpz_poly:
    """The discriminant of a polynomial of degree n = 2 k, which a reflection of v maps to itself,
    from that of q.

    With p(v) d^n = q(W), W = w^2, w = d (v - m), the leading coefficients are the same, and the
    squares of the roots' differences are d^2 times as large: disc_w q(w^2) = d^(n (n - 1)) disc p.
    And disc_w q(w^2) is (-4)^k q_0 q_k disc(q)^2, as the roots come in pairs +-w with w^2 = W,
    whose product is (-1)^k q_0 / q_k.
    """
    n, q = len(p) - 1, squared(p, axis)
    full: fmpz_poly = (-4) ** (n // 2) * q[0] * q[-1] * discriminant(q, check) ** 2
    return full // axis.denom() ** (n * (n - 1))


def resultant(p: Coefficients, q: Coefficients, check: Check = nothing) -> fmpz_poly:
    """The resultant with respect to v, up to sign; ``check`` as for `discriminant`."""
    n, m = len(p) - 1, len(q) - 1
    if n == 0 or m == 0:
        return (p[0] ** m) if n == 0 else (q[0] ** n)

    def formal(left: Any, right: Any) -> Any:
        if left.degree() < n and right.degree() < m:
            return 0
        value = left.resultant(right)
        # the formal resultant of degrees n, m when one leading coefficient vanishes there
        if left.degree() < n:
            value *= right.leading_coefficient() ** (n - left.degree()) * (-1) ** (
                m * (n - left.degree())
            )
        elif right.degree() < m:
            value *= left.leading_coefficient() ** (m - right.degree())
        return value

    effort = resultant_degree(p, q), n * m
    return _interpolated([p, q], formal, effort, lambda: _bits(_norms(p), _norms(q)), check)


def _norms(p: Coefficients) -> list[int]:
    return [sum(abs(int(a)) for a in c.coeffs()) for c in p]


def _bits(p: Sequence[int], q: Sequence[int]) -> int:
    """A number b with 2^b larger than Hadamard's bound, from the coefficients' norms.

    Of p and q with their coefficients reversed the resultant is the same up to sign; they stand for
    t < 1.
    """
    return min(_least_bits(p, q), _least_bits(p[::-1], q[::-1]))


def _least_bits(p: Sequence[int], q: Sequence[int]) -> int:
    """For the best t among powers of 2: as long as the next one is better, for the logarithm is
    convex in log t.

    One is the best, unless p and q have no terms of degree n and m, and the resultant is zero.
    """
    n, m = len(p) - 1, len(q) - 1

    def bits(k: int) -> int:
        left, right = (
            sum(c * c << 2 * k * i for i, c in enumerate(r)).bit_length() for r in (p, q)
        )
        return (m * left + n * right + 1) // 2 - k * n * m

    return next(least for k in count() if (least := bits(k)) <= bits(k + 1))


def _interpolated(
    polynomials: Sequence[Coefficients],
    formal: Callable[..., Any],
    effort: tuple[int, int],
    bits: Callable[[], int],
    check: Check,
) -> fmpz_poly:
    """The polynomial in u whose values are ``formal`` of these polynomials' values in Z[v].

    Parameters
    ----------
    formal : of values that are `fmpz_poly` or, modulo a prime, `nmod_poly`: an integer or a
        residue.
    effort : a bound for its degree, and the steps that a value takes modulo a prime.
    bits : gives a number b with 2^b larger than its coefficients.
    """

    def images(u: int) -> list[fmpz_poly]:
        return [fmpz_poly([c(u) for c in p]) for p in polynomials]

    degree, steps = effort
    if degree < 0:
        return fmpz_poly([])
    needed = _primes_needed(degree, steps, bits()) if (degree + 1) * steps >= LONG else 0
    if not needed:
        return interpolate(lambda u: formal(*images(u)), degree, check)
    used = list(islice(primes(), needed))
    modulus = math.prod(map(fmpz, used), start=fmpz(1))
    idempotents = [
        modulus // prime * pow(int(modulus // prime % prime), -1, prime) for prime in used
    ]

    def at(u: int) -> fmpz:
        values = images(u)
        residues = [int(formal(*(nmod_poly(value, prime) for value in values))) for prime in used]
        return sum(map(operator.mul, idempotents, residues), fmpz(0)) % modulus

    return interpolate(at, degree, check, modulus)


def _primes_needed(degree: int, steps: int, bits: int) -> int:
    """How many determine coefficients below 2^bits in absolute value; 0 where integers are
    estimated to be faster.
    """
    # a value at u is longer than the coefficients by the length of u^degree, and FLINT takes it
    # modulo primes, too
    in_integers = (bits + degree * math.log2(degree / 2 + 2)) * steps
    return (bits + 1) // (PRIME_BITS - 1) + 1 if bits * (steps + CALL) < in_integers else 0


def balanced(polynomials: Sequence[Coefficients]) -> tuple[list[tuple[fmpz_poly, ...]], int]:
    """The polynomials with u and v in other units, in which their coefficients are short, and the
    unit of u.

    Numbers of many decimals put high powers of ten into the coefficients: where m^j divides every
    coefficient of u^j, the substitution of u / m for u is one in integers. Discriminants and
    resultants with respect to v then have the roots m times those before.
    """
    powers_of_v = range(max(map(len, polynomials)))
    unit = _unit(
        [
            math.gcd(*(int(c.content()) for p in polynomials for c in p[i : i + 1]))
            for i in powers_of_v
        ]
    )
    rows = [[c // unit**i for i, c in enumerate(p)] for p in polynomials]
    length = max(len(c) for p in rows for c in p)
    unit = _unit([math.gcd(*(int(c[j]) for p in rows for c in p)) for j in range(length)])
    if unit == 1:
        return [tuple(p) for p in rows], 1
    powers = [unit**j for j in range(length)]
    return [
        tuple(fmpz_poly([c[j] // powers[j] for j in range(len(c))]) for c in p) for p in rows
    ], unit


def _unit(common: Sequence[int]) -> int:
    """A number whose j-th power divides the j-th of these (0 is divided by all), as large as is
    easily found.
    """
    unit = 0
    for j, g in enumerate(common):
        if j == 0 or g == 0:
            continue
        unit = unit or g
        while unit > 1 and g % unit**j:
            unit = math.gcd(unit, g // math.gcd(g, unit ** (j - 1)))
    return max(
        unit, 1
    )  # made smaller for a later one, it is a divisor of what did for the earlier ones


def interpolate(
    at: Callable[[int], fmpz], degree: int, check: Check = nothing, modulus: fmpz | None = None
) -> fmpz_poly:
    """The integer polynomial of degree at most ``degree`` with the given values at integers
    (Newton's form).

    Divided differences of an integer polynomial at integers are integers, so every division is
    exact. Where values are known up to multiples of a modulus, prime to the factorial of the
    degree, the coefficients are the ones of least absolute value.
    """
    if degree < 0:
        return fmpz_poly([])
    first = -(degree // 2)
    differences = []
    for k in range(degree + 1):
        check()
        differences.append(at(first + k))
    newton, factorial = [], fmpz(1)
    for k in range(degree + 1):
        factorial *= max(k, 1)
        first_one = differences[0]
        newton.append(
            first_one * pow(factorial, -1, modulus) % modulus if modulus else first_one // factorial
        )
        differences = [b - a for a, b in pairwise(differences)]
    result = fmpz_poly([newton[-1]])
    for k in range(degree - 1, -1, -1):
        result = result * fmpz_poly([-(first + k), 1]) + newton[k]
    return (
        result
        if modulus is None
        else fmpz_poly([(c + modulus // 2) % modulus - modulus // 2 for c in result.coeffs()])
    )


def interpolate_rows(
    at: Callable[[int], fmpz_poly], degree: int, check: Check = nothing
) -> dict[tuple[int, ...], fmpz]:
    """The coefficients of u^i w^j of a polynomial in Z[u, w], of at most this degree in u, from its
    values at integers u."""
    first = -(max(degree, 0) // 2)
    values = [at(first + k) for k in range(degree + 1)]
    found: dict[tuple[int, ...], fmpz] = {}
    for j in range(max((len(value) for value in values), default=0)):
        column = [value[j] for value in values]
        row = interpolate(lambda k, column=column: column[k - first], degree, check)  # type: ignore[misc]
        found.update({(i, j): c for i, c in enumerate(row.coeffs()) if c})
    return found


def discriminant_degree(p: Coefficients) -> int:
    """A bound for the degree of the formal discriminant with respect to v; negative where that is
    zero.
    """
    order = _of_discriminant(_degrees(p), len(p) - 1)
    return -1 if order is None else -order


def resultant_degree(p: Coefficients, q: Coefficients) -> int:
    """A bound for the degree of the formal resultant with respect to v; negative where that is
    zero.
    """
    left, right = _degrees(p), _degrees(q)
    if not left or not right:
        return -1
    n, m = max(left), max(right)
    first, second = _roots(left), _roots(right)
    far, further = len(p) - 1 - n, len(q) - 1 - m
    if (far and further) or (len(first) < n and len(second) < m):
        return -1  # both have the root infinity, or both 0
    # the n - len(first) roots 0 are of infinite order, and the smaller order is the other root's
    total = (m + further) * left[n] + (n + far) * right[m] + sum(second) * (n - len(first))
    total += sum(first) * (m - len(second)) + sum(
        (min(r, s) for r in first for s in second), Fraction(0)
    )
    return -math.ceil(total)


def _degrees(p: Coefficients) -> dict[int, int]:
    """The orders at infinity of the coefficients that are not zero."""
    return {i: -int(c.degree()) for i, c in enumerate(p) if c}


def _of_discriminant(orders: Mapping[int, int], degree: int) -> int | None:
    """A bound from below for the formal discriminant's order; None where 0 or infinity is a
    multiple root.
    """
    n = max(orders, default=0)
    if not orders or min(orders) > 1 or degree - n > 1:
        return None
    # of formal degree n + 1 it is c_n^2 times that of degree n
    total = Fraction((2 * n - 2 + 2 * (degree - n)) * orders[n])
    return math.ceil(total + 2 * sum(r * (n - 1 - i) for i, r in enumerate(sorted(_roots(orders)))))


def _roots(orders: Mapping[int, int]) -> list[Fraction]:
    """The orders of the roots that are not 0."""
    hull: list[tuple[int, int]] = []
    for point in sorted(orders.items()):
        while len(hull) > 1 and _slope(hull[-1], point) <= _slope(hull[-2], hull[-1]):
            hull.pop()
        hull.append(point)
    return [-_slope(a, b) for a, b in pairwise(hull) for _ in range(b[0] - a[0])]


def _slope(left: tuple[int, int], right: tuple[int, int]) -> Fraction:
    return Fraction(right[1] - left[1], right[0] - left[0])
