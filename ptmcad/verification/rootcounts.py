"""Real roots of integer polynomials: counted, isolated, and one by its number.

FLINT isolates all complex roots in disjoint balls, of which the real ones are known to be real. A
rational number is compared with these balls at as many bits as that takes.

Guarantee: counts are exact, multiple roots counted once; a ball contains the root asked for, and is
about as narrow as precision allows. (The decomposition isolates by Descartes' rule; see
`ptmcad.algebra.real_roots`, which is not used here.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

_BITS = 64
"""With which roots are isolated at first."""


def squarefree(p: fmpz_poly) -> fmpz_poly:
    """The squarefree part of a nonzero polynomial, up to a constant."""
    common = p.gcd(p.derivative())
    return p if common.degree() < 1 else p // common


def roots_between(p: fmpz_poly, low: fmpq, high: fmpq) -> int:
    """The number of different roots in the open interval (low, high)."""
    if p.degree() < 1 or low >= high:
        return 0
    coefficients = tuple(map(int, p.coeffs()))
    return roots_above(coefficients, low) - roots_above(coefficients, high) - (p(high) == 0)


def roots_above(coefficients: tuple[int, ...], at: fmpq) -> int:
    """The number of different real roots above a number, of a polynomial that is not constant."""
    bits, is_root = _BITS, None
    while True:
        ends = _ends(coefficients, bits)
        met = sum(first <= at <= last for first, last in ends)
        if met and is_root is None:
            is_root = fmpz_poly(list(coefficients))(at) == 0
        if met == bool(is_root):
            return sum(at < first for first, _ in ends)
        bits *= 2


@lru_cache(maxsize=4096)
def _ends(coefficients: tuple[int, ...], bits: int) -> list[tuple[fmpq, fmpq]]:
    return [ends_of(root) for root in real_roots(coefficients, bits)]


@lru_cache(maxsize=4096)
def real_roots(coefficients: tuple[int, ...], bits: int) -> tuple[arb, ...]:
    """Disjoint balls with one real root each, of so many bits, in increasing order."""
    # of a polynomial in a power of the variable the roots of a shorter one are enough
    p, power = squarefree(fmpz_poly(list(coefficients))).deflation()
    with ctx.workprec(bits):
        pairs: Any = p.complex_roots()  # FLINT's stub says otherwise
        found = [root.real for root, _ in pairs if root.imag == 0]
        if power > 1:  # zero is no root of such a squarefree one
            positive = [root.root(power) for root in found if root > 0]
            odd = [-((-root).root(power)) for root in found if root < 0 and power % 2]
            found = positive + (odd if power % 2 else [-root for root in positive])
    return tuple(sorted(found, key=lambda root: fmpq(root.mid().fmpq())))


def ends_of(ball: arb) -> tuple[fmpq, fmpq]:
    """The least and the greatest number in a ball, to be compared with rational numbers.

    A ball itself compares with a rational number rounded to the working precision, which may be far
    coarser than it is.
    """
    middle, radius = ball.mid().fmpq(), ball.rad().fmpq()
    return middle - radius, middle + radius


def roots_within(p: fmpz_poly, low: fmpq, high: fmpq) -> int:
    """The number of different roots in the closed interval [low, high]."""
    if low == high:
        return int(p(low) == 0)
    return roots_between(p, low, high) + (p(low) == 0) + (p(high) == 0)


def isolating_intervals(p: fmpz_poly, low: fmpq, high: fmpq) -> list[tuple[fmpq, fmpq]]:
    """Disjoint open intervals, strictly inside, with one root each; no end is a root."""
    return isolated(lambda a, b: roots_between(p, a, b), lambda v: p(v) == 0, low, high)


def isolated(
    count: Callable[[fmpq, fmpq], int], is_root: Callable[[fmpq], bool], low: fmpq, high: fmpq
) -> list[tuple[fmpq, fmpq]]:
    """Disjoint open intervals, strictly inside (low, high), with one root each of what a function
    counts.

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
    """A rational point in each open interval that is left of (low, high), given the roots'
    isolating intervals.
    """
    if not roots:
        return [(low + high) / 2]
    return [roots[0][0], *(b for _, b in roots)]


def numbered_root(p: fmpz_poly, low: fmpq, high: fmpq, number: int) -> arb | None:
    """A root in the open interval (low, high), by its number from below; None where there are not
    so many.
    """
    coefficients = tuple(map(int, p.coeffs()))
    above = roots_above(coefficients, low) - number
    if low >= high or above <= roots_above(coefficients, high) + (p(high) == 0):
        return None
    root = _refined(squarefree(p), real_roots(coefficients, _BITS)[-above])
    return real_roots(coefficients, ctx.prec)[-above] if root is None else root


def _refined(p: fmpz_poly, root: arb) -> arb | None:
    """A ball for the only root of p in a given one, narrowed by interval Newton steps as far as
    precision allows.

    None where the given one is too wide for them.
    """
    value, slope = arb_poly(p), arb_poly(p.derivative())
    while True:
        middle = root.mid()
        steepness = slope(root)
        if steepness.contains(0):
            return None
        closer = (middle - value(middle) / steepness).intersection(root)
        if not closer.rad() * 4 < root.rad():
            return closer
        root = closer
