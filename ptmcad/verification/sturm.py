"""Real roots of integer polynomials, counted by Sturm sequences: of short polynomials exact ones,
of others in balls.

In balls a sequence takes the time of as many short divisions, where exact ones have coefficients as
long as the polynomial's discriminant. It is one of the polynomial wherever each leading coefficient
is proved not to be zero, so that each degree is one less than that before. Where that fails at
every precision tried (the sequence has a gap, or ends before a constant), long polynomials are left
to FLINT's isolation of all complex roots, in disjoint balls of which the real ones are known to be
real.

Guarantee: exact, multiple roots counted once. (The decomposition itself isolates by Descartes'
rule; see `ptmcad.algebra.real_roots`, which is not used here.)

One real root of a polynomial, by its number among those between two heights.

Guarantee: the ball that is returned contains that root and, if precision allows, is about as narrow
as it allows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, lru_cache
from itertools import pairwise
from typing import Any

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly, fmpz_poly


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


BALL_DEGREE = 6
"""From which on Sturm sequences in balls take less time than exact ones."""
LONG_DEGREE = 64
"""From which on exact Sturm sequences take longer than complex roots do."""


def roots_between(p: fmpz_poly, low: fmpq, high: fmpq) -> int:
    """The number of different roots in the open interval (low, high)."""
    if p.degree() < 1 or low >= high:
        return 0
    if low >= 0:
        deflated, power = p.deflation()
        if power > 1:
            return roots_between(deflated, low**power, high**power)
    coefficients = tuple(int(c) for c in p.coeffs())
    if p.degree() >= BALL_DEGREE:
        found = _by_ball_chain(coefficients, low, high)
        if found is not None:
            return found
    if p.degree() >= LONG_DEGREE:
        return _balls_between(coefficients, low, high, [end for end in (low, high) if p(end) == 0])
    chain = _chain(coefficients)
    return _variations(chain, low) - _variations(chain, high) - (1 if p(high) == 0 else 0)


def _by_ball_chain(coefficients: tuple[int, ...], low: fmpq, high: fmpq) -> int | None:
    """The number of different roots in (low, high), from a Sturm sequence in balls; None where none
    is found.
    """
    p = fmpz_poly(list(coefficients))
    counts = [_changes(p, coefficients, end) for end in (low, high)]
    if counts[0] is None or counts[1] is None:
        return None
    return counts[0] - counts[1] - (1 if p(high) == 0 else 0)


def changes_of(p: fmpz_poly) -> Callable[[fmpq], int]:
    """A function f for which f(a) - f(b) is the number of different roots in (a, b], of a
    polynomial not constant.
    """
    coefficients = tuple(int(c) for c in p.coeffs())

    def changes(at: fmpq) -> int:
        found = _changes(p, coefficients, at)
        # both are signs of the same sequence, up to positive factors
        return _variations(_chain(coefficients), at) if found is None else found

    return changes


def _changes(p: fmpz_poly, coefficients: tuple[int, ...], at: fmpq) -> int | None:
    """Changes of sign in the Sturm sequence, at the least precision that tells them; None where
    none does.
    """
    bits, most = 256, 8 * p.height_bits() + 64 * len(coefficients)
    while bits < 2 * most:
        chain = _ball_chain(coefficients, bits)
        if chain is None:
            return None
        if chain:
            with ctx.workprec(bits):
                found = _ball_variations(p, chain, at)
            if found is not None:
                return found
        bits *= 2
    return None


@lru_cache(maxsize=1024)
def _ball_chain(coefficients: tuple[int, ...], bits: int) -> tuple[arb_poly, ...] | None:
    """The sequence after the polynomial itself; empty where the precision is too low, None for
    multiple roots.
    """
    p = fmpz_poly(list(coefficients))
    if p.gcd(p.derivative()).degree() > 0:
        return None
    with ctx.workprec(bits):
        chain = ball_chain(arb_poly(p), int(p.degree()), 0)
    return () if chain is None else tuple(chain[1:])


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


def _ball_variations(p: fmpz_poly, chain: Sequence[arb_poly], at: fmpq) -> int | None:
    """Changes of sign at a point, of the polynomial and its sequence; None where a sign is not
    known.
    """
    values = [q(arb(at)) for q in chain]
    if any(value.contains(0) and not value.is_zero() for value in values):
        return None
    signs = [1 if value > 0 else -1 for value in values if not value.is_zero()]
    if (first := p(at)) != 0:
        signs.insert(0, 1 if first > 0 else -1)
    return sum(a != b for a, b in pairwise(signs))


def _balls_between(
    coefficients: tuple[int, ...], low: fmpq, high: fmpq, ends: Sequence[fmpq]
) -> int:
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
        pairs: Any = squarefree(
            fmpz_poly(list(coefficients))
        ).complex_roots()  # FLINT's stub says otherwise
        return tuple(root.real for root, _ in pairs if root.imag == 0)


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
    # halving a window would take one step for each doubling of it
    bound = _bound(p)
    low, high = max(low, -bound), min(high, bound)
    if low >= high:
        return None
    changes = _changes_of(tuple(int(c) for c in p.coeffs()))
    first, last = changes(low), changes(high) + (p(high) == 0)
    wanted = first - number  # changes below the root, one less above it
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
        beyond = changes(middle)
        if beyond >= wanted:
            low, first = middle, beyond
        elif beyond == wanted - 1 and p(middle) == 0:
            return arb(middle)
        else:
            high, last = middle, beyond + (p(middle) == 0)


@lru_cache(maxsize=64)
def _changes_of(coefficients: tuple[int, ...]) -> Callable[[fmpq], int]:
    """`changes_of`, for walls over the same abscissa, whose roots are told apart at the same
    heights.
    """
    return cache(changes_of(fmpz_poly(list(coefficients))))


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
