"""Real roots of integer polynomials, counted by Sturm sequences; of long polynomials, whose sequences are longer, by
FLINT's isolation of all complex roots, in disjoint balls of which the real ones are known to be real, or in a short
interval by bisection.

Guarantee: exact, multiple roots counted once. (The decomposition itself isolates by Descartes' rule; see
`ptmcad.algebra.real_roots`, which is not used here.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any

from flint import arb, ctx, fmpq, fmpq_poly, fmpz_poly


def squarefree(p: fmpz_poly) -> fmpz_poly:
    """The squarefree part of a nonzero polynomial, up to a constant."""
    common = p.gcd(p.derivative())
    return p if common.degree() < 1 else p // common


def _primitive(p: fmpz_poly) -> fmpz_poly:
    return p / int(p.content()) if int(p.content()) > 1 else p


@lru_cache(maxsize=4096)
def _chain(coefficients: tuple[int, ...]) -> tuple[fmpz_poly, ...]:
    first = squarefree(_primitive(fmpz_poly(list(coefficients))))
    chain = [first, _primitive(first.derivative())]
    while chain[-1].degree() > 0:
        remainder = -(fmpq_poly(chain[-2]) % fmpq_poly(chain[-1]))
        chain.append(_primitive(remainder.numer()))
    return tuple(chain)


def _variations(chain: tuple[fmpz_poly, ...], at: fmpq) -> int:
    signs = [1 if value > 0 else -1 for q in chain if (value := q(at)) != 0]
    return sum(a != b for a, b in pairwise(signs))


LONG_DEGREE = 64
"""From which on Sturm sequences take longer than complex roots do."""


def roots_between(p: fmpz_poly, low: fmpq, high: fmpq) -> int:
    """The number of different roots in the open interval (low, high)."""
    if p.degree() < 1 or low >= high:
        return 0
    if low >= 0:
        deflated, power = p.deflation()
        if power > 1:
            return roots_between(deflated, low**power, high**power)
    coefficients = tuple(int(c) for c in p.coeffs())
    if p.degree() >= LONG_DEGREE:
        return _balls_between(coefficients, low, high, [end for end in (low, high) if p(end) == 0])
    chain = _chain(coefficients)
    return _variations(chain, low) - _variations(chain, high) - (1 if p(high) == 0 else 0)


_MAX_PIECES = 64
"""Into how many pieces an interval is cut: near a multiple root there is no end."""


def _by_bisection(p: fmpz_poly, low: fmpq, high: fmpq) -> int | None:
    """The number of roots in (low, high); None where an end is one, or where it is not found in so many pieces.

    With p(m + r h) = sum q_i h^i over |h| <= 1 there is no root where |q_0| outweighs the other coefficients, and at
    most one, at which the sign changes, where q_1 outweighs the rest of the derivative.
    """
    signs: dict[fmpq, bool] = {}

    def is_positive(at: fmpq) -> bool:
        if at not in signs:
            signs[at] = p(at) > 0
        return signs[at]

    if p(low) == 0 or p(high) == 0:
        return None
    number, waiting, rational = 0, [(low, high)], fmpq_poly(p)
    for _ in range(_MAX_PIECES):
        if not waiting:
            return number
        a, b = waiting.pop()
        middle = (a + b) / 2
        sizes = [abs(c) for c in rational(fmpq_poly([middle, (b - a) / 2])).coeffs()]
        if 2 * sizes[0] > sum(sizes, fmpq(0)):
            continue
        if 2 * sizes[1] > sum((i * c for i, c in enumerate(sizes)), fmpq(0)):
            number += is_positive(a) != is_positive(b)
            continue
        while p(middle) == 0:
            middle = (a + middle) / 2
        waiting += [(a, middle), (middle, b)]
    return None


def _balls_between(coefficients: tuple[int, ...], low: fmpq, high: fmpq, ends: Sequence[fmpq]) -> int:
    """The number of roots in (low, high), of whose ends some are roots."""
    bits = 64
    while True:
        inside = 0
        for first, last in map(ends_of, real_roots(coefficients, bits)):
            if any(first <= end <= last for end in ends):
                continue  # there is one root in the ball, so it is this end
            if low < first and last < high:
                inside += 1
            elif not (last < low or high < first):
                break
        else:
            return inside
        bits *= 2


@lru_cache(maxsize=256)
def real_roots(coefficients: tuple[int, ...], bits: int) -> tuple[arb, ...]:
    """Disjoint balls with one real root each, of so many bits."""
    with ctx.workprec(bits):
        pairs: Any = squarefree(fmpz_poly(list(coefficients))).complex_roots()  # FLINT's stub says otherwise
        return tuple(root.real for root, _ in pairs if root.imag == 0)


def ends_of(ball: arb) -> tuple[fmpq, fmpq]:
    """The least and the greatest number in a ball, to be compared with rational numbers.

    A ball itself compares with a rational number rounded to the working precision, which may be far coarser than it is.
    """
    middle, radius = ball.mid().fmpq(), ball.rad().fmpq()
    return middle - radius, middle + radius


def roots_within(p: fmpz_poly, low: fmpq, high: fmpq) -> int:
    """The number of different roots in the closed interval [low, high], which of a long polynomial is best short."""
    if low == high:
        return int(p(low) == 0)
    if p.degree() >= LONG_DEGREE and (number := _by_bisection(p, low, high)) is not None:
        return number
    return roots_between(p, low, high) + (p(low) == 0) + (p(high) == 0)


def isolating_intervals(p: fmpz_poly, low: fmpq, high: fmpq) -> list[tuple[fmpq, fmpq]]:
    """Disjoint open intervals, strictly inside, with one root each; no end is a root."""
    return isolated(lambda a, b: roots_between(p, a, b), lambda v: p(v) == 0, low, high)


def isolated(
    count: Callable[[fmpq, fmpq], int], is_root: Callable[[fmpq], bool], low: fmpq, high: fmpq
) -> list[tuple[fmpq, fmpq]]:
    """Disjoint open intervals, strictly inside (low, high), with one root each of what a function counts.

    Parameters
    ----------
    count : the number of roots in an open interval.
    is_root : whether a number is one of them; no end of an interval is.
    """
    waiting, found = [(low, high)], []
    while waiting:
        a, b = waiting.pop()
        n = count(a, b)
        if n == 0:
            continue
        if n == 1 and a > low and b < high:
            found.append((a, b))
            continue
        k = 2
        while is_root(middle := a + (b - a) * fmpq(k // 2, k)):
            k += 1
        waiting += [(a, middle), (middle, b)]
    return sorted(found, key=lambda interval: fmpq(interval[0]))


def separated_points(p: fmpz_poly, low: fmpq, high: fmpq) -> list[fmpq]:
    """A rational point in each open interval that the roots of p leave of (low, high)."""
    return parting(isolating_intervals(p, low, high), low, high)


def parting(roots: Sequence[tuple[fmpq, fmpq]], low: fmpq, high: fmpq) -> list[fmpq]:
    """A rational point in each open interval that is left of (low, high), given the roots' isolating intervals."""
    if not roots:
        return [(low + high) / 2]
    return [roots[0][0], *(b for _, b in roots)]
