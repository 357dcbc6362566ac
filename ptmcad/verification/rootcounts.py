"""Real roots of integer polynomials: counted, isolated, and one by its number.

In balls a Sturm sequence takes the time of as many short divisions, where exact ones have
coefficients as long as the polynomial's discriminant. It is one of the polynomial wherever each
leading coefficient is proved not to be zero, so that each degree is one less than that before. Where
that fails at every precision tried (the sequence has a gap), FLINT isolates all complex roots, in
disjoint balls of which the real ones are known to be real.

Guarantee: counts are exact, multiple roots counted once; a ball contains the root asked for, and is
about as narrow as precision allows. (The decomposition itself isolates by Descartes' rule; see
`ptmcad.algebra.real_roots`, which is not used here.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, lru_cache, partial
from itertools import pairwise
from typing import Any

from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.flint_numbers import from_fraction

Interval = tuple[fmpq, fmpq]
Coefficients = tuple[int, ...]
"""Of a polynomial, the constant one first."""


def squarefree(p: fmpz_poly) -> fmpz_poly:
    """The squarefree part of a nonzero polynomial, up to a constant."""
    common = p.gcd(p.derivative())
    return p if common.degree() < 1 else p // common


def roots_between(p: fmpz_poly, low: fmpq, high: fmpq) -> int:
    """The number of different roots in the open interval (low, high)."""
    if p.degree() < 1 or low >= high:
        return 0
    if low >= 0:
        deflated, power = p.deflation()
        if power > 1:
            return roots_between(deflated, low**power, high**power)
    coefficients = tuple(int(c) for c in p.coeffs())
    return roots_above(coefficients, low) - roots_above(coefficients, high) - (p(high) == 0)


def roots_above(coefficients: Coefficients, at: fmpq) -> int:
    """The number of different real roots above a number, of a polynomial that is not constant."""
    p = _simple(coefficients)
    bits, most = 96, 8 * p.height_bits() + 64 * len(coefficients)
    while bits < 2 * most:
        if (chain := _ball_chain(coefficients, bits)) is not None:
            with ctx.workprec(bits):
                signs = _signs(p(at), chain, at)
            if signs is not None:
                return _changes(signs) - _changes_at_infinity(coefficients, bits)
        bits *= 2
    return _balls_above(p, coefficients, at)


@lru_cache(maxsize=4096)
def _simple(coefficients: Coefficients) -> fmpz_poly:
    return squarefree(fmpz_poly(list(coefficients)))


@lru_cache(maxsize=4096)
def _ball_chain(coefficients: Coefficients, bits: int) -> list[arb_poly] | None:
    p = _simple(coefficients)
    with ctx.workprec(bits):
        return ball_chain(arb_poly(p), int(p.degree()), 0)


def ball_chain(p: arb_poly, degree: int, last: int) -> list[arb_poly] | None:
    """A Sturm sequence in balls, each of the degree before less one, down to the last; None where
    one may be less.

    Parameters
    ----------
    p : of that degree, if its leading coefficient is not zero.
    """
    chain = [p, p.derivative()]
    if any(q[degree - k].contains(0) for k, q in enumerate(chain)):
        return None
    for d in range(degree - 1, last, -1):
        # the quotient is linear, the remainder has one coefficient less than the divisor
        first, second = chain[-2:]
        leading = first[d + 1] / second[d]
        quotient = arb_poly([(first[d] - leading * second[d - 1]) / second[d], leading])
        chain.append((quotient * second - first).truncate(d))
        if chain[-1][d - 1].contains(0):
            return None
    return chain


def _signs(first: fmpq, chain: Sequence[arb_poly], at: fmpq) -> list[bool] | None:
    """Whether a sequence's values at a point are positive, without zeros; None where one is not
    known.
    """
    signs = [first > 0] if first != 0 else []
    ball = arb(at)
    for q in chain[1:]:
        value = q(ball)
        if value > 0 or value < 0:
            signs.append(value > 0)
        elif not value.is_zero():
            return None
    return signs


@lru_cache(maxsize=4096)
def _changes_at_infinity(coefficients: Coefficients, bits: int) -> int:
    chain = _ball_chain(coefficients, bits) or ()
    return _changes([q[len(chain) - 1 - k] > 0 for k, q in enumerate(chain)])


def _changes(signs: Sequence[bool]) -> int:
    return sum(a != b for a, b in pairwise(signs))


def _balls_above(p: fmpz_poly, coefficients: Coefficients, at: fmpq) -> int:
    """The same by FLINT's isolation of all roots, where a Sturm sequence has a gap."""
    is_root, bits = p(at) == 0, 64
    while True:
        ends = [ends_of(root) for root in real_roots(coefficients, bits)]
        if sum(first <= at <= last for first, last in ends) == is_root:
            return sum(at < first for first, _ in ends)
        bits *= 2


@lru_cache(maxsize=256)
def real_roots(coefficients: Coefficients, bits: int) -> tuple[arb, ...]:
    """Disjoint balls with one real root each, of so many bits."""
    with ctx.workprec(bits):
        pairs: Any = squarefree(
            fmpz_poly(list(coefficients))
        ).complex_roots()  # FLINT's stub says otherwise
        return tuple(root.real for root, _ in pairs if root.imag == 0)


def ends_of(ball: arb) -> Interval:
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


def is_alone(number: AlgebraicNumber) -> bool:
    """Whether a number is the only root of its polynomial between its bounds."""
    ends = (from_fraction(end) for end in (number.low, number.high))
    return roots_within(fmpz_poly(list(number.polynomial)), *ends) == 1


def isolating_intervals(p: fmpz_poly, low: fmpq, high: fmpq) -> list[Interval]:
    """Disjoint open intervals, strictly inside, with one root each; no end is a root."""
    return isolated(lambda a, b: roots_between(p, a, b), lambda v: p(v) == 0, low, high)


def isolated(
    count: Callable[[fmpq, fmpq], int], is_root: Callable[[fmpq], bool], low: fmpq, high: fmpq
) -> list[Interval]:
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


def parting(roots: Sequence[Interval], low: fmpq, high: fmpq) -> list[fmpq]:
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
    # halving a window would take one step for each doubling of it
    bound = _bound(p)
    low, high = max(low, -bound), min(high, bound)
    if low >= high:
        return None
    above = _counted_above(tuple(int(c) for c in p.coeffs()))
    first, last = above(low), above(high) + (p(high) == 0)
    wanted = first - number  # roots above a number below the root, one less above it
    if wanted <= last:
        return None
    while True:
        if first == wanted == last + 1:
            # where an end is a root, too, signs do not tell on which side of a number the wanted
            # one is
            found = (
                _alone(p, low, high)
                if p(low) * p(high) < 0
                else _refined(p, arb(low).union(arb(high)))
            )
            if found is not None:
                return found
        middle = (low + high) / 2
        beyond = above(middle)
        if beyond >= wanted:
            low, first = middle, beyond
        elif beyond == wanted - 1 and p(middle) == 0:
            return arb(middle)
        else:
            high, last = middle, beyond + (p(middle) == 0)


@lru_cache(maxsize=64)
def _counted_above(coefficients: Coefficients) -> Callable[[fmpq], int]:
    """`roots_above`, for walls over the same abscissa, whose roots are separated at the same
    heights.
    """
    return cache(partial(roots_above, coefficients))


def _bound(p: fmpz_poly) -> fmpq:
    """A power of two beyond all roots: twice the greatest |c_(n-k) / c_n|^(1/k) or more (Fujiwara)."""
    *rest, leading = (int(c).bit_length() for c in p.coeffs())
    # of bit lengths, each the logarithm rounded up or one more than it
    exponents = [-(-(bits - leading + 1) // k) for k, bits in enumerate(reversed(rest), 1) if bits]
    return fmpq(2) ** (max(exponents) + 2) if exponents else fmpq(1)


def _alone(p: fmpz_poly, low: fmpq, high: fmpq) -> arb:
    """The only root in the open interval (low, high), at whose ends the signs differ."""
    sign = p(high)
    while (height := _refined(p, arb(low).union(arb(high)))) is None:
        middle = (low + high) / 2
        value = p(middle)
        if value == 0:
            return arb(middle)
        if (value > 0) == (sign > 0):
            high = middle
        else:
            low = middle
    return height


def _refined(p: fmpz_poly, root: arb) -> arb | None:
    """A ball for the only root of p in a given one, narrowed by interval Newton steps as far as
    precision allows.

    None where the given one is so wide that the first step does not narrow it much.
    """
    value, slope = arb_poly(p), arb_poly(p.derivative())
    first = True
    while True:
        middle = root.mid()
        steepness = slope(root)
        if steepness.contains(0):
            return None if first and root.rel_accuracy_bits() < ctx.prec // 2 else root
        closer = (middle - value(middle) / steepness).intersection(root)
        if not closer.rad() * 4 < root.rad():
            return None if first and root.rel_accuracy_bits() < ctx.prec // 2 else closer
        root, first = closer, False
