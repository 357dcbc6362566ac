"""Isolation of the real roots of an integer polynomial by Descartes' rule.

Guarantee: exact. Every root in the open interval is in one of the intervals that are found, which
are disjoint.

Intervals are bisected; where several bisections in a row have not parted some roots, Newton's
method is run on to where their cluster may be, Taylor coefficients show how long it may be, and
Descartes' rule whether it is. Where the roots keep to one end of the interval, but too near to
others for that, steps towards the end get longer while they are right. So the steps that a cluster
takes grow with the logarithm of its number of leading digits, not with that number.

References: Collins & Akritas, SYMSAC 1976; Rouillier & Zimmermann, J. Comput. Appl. Math. 162
(2004); Sagraloff & Mehlhorn, Computing real roots of real polynomials, J. Symb. Comp. 73 (2016).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from math import comb, lcm
from operator import add
from typing import NamedTuple

from flint import fmpq, fmpz, fmpz_poly

_SHIFT = fmpz_poly([1, 1])
_CLUSTER_CUTS = 3
"""Cuts without a change of Descartes' bound after which the roots are taken for a cluster."""
_CLUSTER_BITS = 8
"""Bits with which a cluster is looked for at first."""
_CLUSTER_MARGIN = 4
"""How much longer than the estimate an interval around a cluster is: Descartes' rule sees complex
roots in a lens.
"""
_MAX_CLUSTER_RADIUS = fmpq(1, 16)
"""Half the length up to which such an interval is better than bisection."""
_MAX_SHORT_DEGREE = 24
"""Up to this degree halves are computed in Python's integers, which costs less than a call for each
polynomial.
"""
_MIN_SPEED = 2
"""The first step towards an end is to the part 2^-4 of the interval; each further one is twice as
many bits long.
"""


def on_unit_interval(p: fmpz_poly, low: fmpq, high: fmpq) -> fmpz_poly:
    """A positive multiple of p(low + (high - low) t)."""
    width = high - low
    scale = int(low.q) * int(width.q)
    offset, step = int(low.p) * int(width.q), int(width.p) * int(low.q)
    n = p.degree()
    power, scaled = 1, []
    for c in reversed(p.coeffs()):
        scaled.append(c * power)
        power *= scale
    return fmpz_poly(scaled[::-1])(fmpz_poly([offset, step])) if n >= 0 else p


def descartes_bound(q: fmpz_poly, degree: int) -> int:
    """Sign changes of (1 + t)^n q(1/(1 + t)): a bound for the number of roots of q in (0, 1), exact
    when 0 or 1.
    """
    coefficients = q.coeffs()
    coefficients += [fmpz(0)] * (degree + 1 - len(coefficients))
    return _sign_changes(fmpz_poly(coefficients[::-1])(_SHIFT).coeffs())


def isolating_intervals(p: fmpz_poly, low: fmpq, high: fmpq) -> list[tuple[fmpq, fmpq]]:
    """Intervals with one root each of a squarefree polynomial in the open interval (low, high), in
    increasing order.

    An end of one may be a root that lies outside of it. An interval of length zero is the root.

    Raises
    ------
    ValueError
        When a multiple root in the interval is met.
    """
    if p.degree() < 1:
        return []
    beyond = root_bound(p)
    if high - low > 16 * beyond:
        # bisection of an interval much longer than needed would take a level for each bit
        low, high = max(low, -beyond), min(high, beyond)
        if low >= high:
            return []
    width = high - low
    whole = on_unit_interval(p, low, high)
    found, stack = (
        _by_halving(whole)
        if p.degree() <= _MAX_SHORT_DEGREE
        else ([], [_RootInterval(whole, fmpq(0), fmpq(1))])
    )
    found = [(low + width * left, low + width * right) for left, right in found]
    squarefree = False
    while stack:
        part = stack.pop()
        q = part.polynomial
        while q[0] == 0:
            q = q.right_shift(1)
        bound = descartes_bound(q, q.degree())
        if bound == 0:
            continue
        if bound == 1:
            found.append((low + width * part.left, low + width * (part.left + part.width)))
            continue
        if bound == part.bound:
            part = part._replace(polynomial=q, unchanged=part.unchanged + 1)
        else:
            part = _RootInterval(q, part.left, part.width, bound)
        if part.unchanged >= _CLUSTER_CUTS:
            if not squarefree and p.gcd(p.derivative()).degree() > 0:
                raise ValueError(f"a polynomial of degree {p.degree()} is not squarefree")
            squarefree = True
            part = _narrowed(part)
        halves = _halves(part)
        if halves[1].polynomial[0] == 0:
            at = low + width * halves[1].left
            found.append((at, at))
        stack += halves
    return sorted(found)


def _by_halving(whole: fmpz_poly) -> tuple[list[tuple[fmpq, fmpq]], list[_RootInterval]]:
    """The roots in (0, 1) that halving parts, and the parts that hold what may be a cluster.

    Descartes' bound is the number of sign changes of the Bernstein coefficients, and those of the
    halves come by de Casteljau's additions: where there are few coefficients that is much less work
    than a shift of each half. The halves and the bounds are those of the general way.
    """
    n = whole.degree()
    found: list[tuple[fmpq, fmpq]] = []
    clusters: list[_RootInterval] = []
    stack = [(0, 0, _bernstein_coefficients(whole), -1, 0, 0)]
    while stack:
        start, level, b, before, unchanged, run = stack.pop()
        bound = _sign_changes(b)
        if bound < 2:
            if bound:
                found.append((fmpq(start, 1 << level), fmpq(start + 1, 1 << level)))
            continue
        unchanged, run = (unchanged + 1, run) if bound == before else (0, 0)
        if unchanged >= _CLUSTER_CUTS:
            left, width = fmpq(start, 1 << level), fmpq(1, 1 << level)
            on_part = on_unit_interval(whole, left, left + width)
            clusters.append(_RootInterval(on_part, left, width, bound, unchanged - 1, run))
            continue
        low, high = [], []
        for shift in range(n, -1, -1):
            low.append(b[0] << shift)
            high.append(b[-1] << shift)
            b = list(map(add, b, b[1:]))
        if not low[-1]:
            middle = fmpq(2 * start + 1, 2 << level)
            found.append((middle, middle))
        stack.append((2 * start, level + 1, low, bound, unchanged, min(run, 0) - 1))
        stack.append((2 * start + 1, level + 1, high[::-1], bound, unchanged, max(run, 0) + 1))
    return found, clusters


def _bernstein_coefficients(p: fmpz_poly) -> list[int]:
    """The coefficients of p in the Bernstein basis of (0, 1), times a positive integer that makes
    them integers.
    """
    n = p.degree()
    binomials = [comb(n, i) for i in range(n + 1)]
    scale = lcm(*binomials)
    differences = [
        int(c) * (scale // binomial) for c, binomial in zip(p.coeffs(), binomials, strict=True)
    ]
    found = [differences[n]]
    for difference in reversed(
        differences[:n]
    ):  # from a sequence's differences at its start to the sequence
        found = list(accumulate(found, initial=difference))
    return found


def _sign_changes(numbers: Sequence[int | fmpz]) -> int:
    count, last = 0, 0
    for c in numbers:
        if c:
            s = 1 if c > 0 else -1
            count += s == -last
            last = s
    return count


class _RootInterval(NamedTuple):
    """A part of the interval in which roots are isolated.

    Attributes
    ----------
    polynomial : a multiple of p on the part, which is mapped to (0, 1).
    left, width : of the part, the whole interval being (0, 1).
    bound : Descartes' bound for the part that it was cut from.
    unchanged : for how many cuts the bound has been the same.
    run : for how many cuts the part has been the right half (positive) or the left one (negative).
    speed : roots are looked for in the share 2^-(2^speed) beside an end of the part.
    """

    polynomial: fmpz_poly
    left: fmpq
    width: fmpq
    bound: int = -1
    unchanged: int = 0
    run: int = 0
    speed: int = _MIN_SPEED


def _halves(part: _RootInterval) -> tuple[_RootInterval, _RootInterval]:
    """The left and the right half."""
    n = part.polynomial.degree()
    half = fmpz_poly([c << (n - i) for i, c in enumerate(part.polynomial.coeffs())])
    width = part.width / 2
    _, left, _, bound, unchanged, run, speed = part
    return (
        _RootInterval(half, left, width, bound, unchanged, min(run, 0) - 1, speed),
        _RootInterval(half(_SHIFT), left + width, width, bound, unchanged, max(run, 0) + 1, speed),
    )


def _narrowed(part: _RootInterval) -> _RootInterval:
    """The part, or a shorter one that is proved to hold all its roots."""
    q, left, width, bound, unchanged, run, speed = part
    narrow = _cluster(q, bound)
    if narrow is not None:
        unchanged, run = 0, 0
    elif abs(run) >= _CLUSTER_CUTS:
        narrow = _edge(q, bound, run > 0, 2**speed)
        if narrow is not None:
            speed += 1
        elif speed > _MIN_SPEED:
            speed -= 1
        else:
            run = 0
    if narrow is not None:
        q, left, width = narrow[0], left + narrow[1] * width, narrow[2] * width
    return _RootInterval(q, left, width, bound, unchanged, run, speed)


def _cluster(q: fmpz_poly, bound: int) -> tuple[fmpz_poly, fmpq, fmpq] | None:
    """A much shorter interval in (0, 1) which holds all roots of q there: q on it, its start and
    its width.

    None when that is not proved. It is when Descartes' bound for the interval is that for (0, 1),
    as the sum of the bounds for disjoint parts never exceeds the bound for the whole. Where the
    interval may be is found by Newton's method, to which roots that lie together look like a
    multiple one, from the left end as from the right; how long, by the Taylor coefficients there,
    whose first ones are those of a polynomial with about these roots only.
    """
    slope = q.derivative()
    # in whole numbers: reducing fractions of thousands of bits would take most of the time
    values = [(q(end), slope(end)) for end in (0, 1)]
    if any(value == 0 or derivative == 0 for value, derivative in values):
        return None
    steps = [int((bound * value << _CLUSTER_BITS) // derivative) for value, derivative in values]
    targets = -steps[0], 2**_CLUSTER_BITS - steps[1]
    if (
        abs(targets[0] - targets[1]) > 2**_CLUSTER_BITS // 4
        or not -1 < targets[0] >> (_CLUSTER_BITS - 2) < 5
    ):
        return None
    last, centre = min((abs(step), target) for step, target in zip(steps, targets, strict=True))
    bits, contracted = _CLUSTER_BITS, False
    while True:
        at = fmpq(centre, 2**bits)
        value, derivative = fmpq(q(at)), fmpq(slope(at))
        if value == 0 or derivative == 0:
            break
        more = 2 * (bits - last.bit_length()) + _CLUSTER_BITS
        step = int((bound * value.p * derivative.q << more) // (value.q * derivative.p))
        if 2 * abs(step) > last << (more - bits):
            break
        centre, last, bits, contracted = (centre << (more - bits)) - step, abs(step), more, True
    if not contracted:
        return None
    centre, unit = at, fmpq(2) ** (last.bit_length() - bits)
    around = on_unit_interval(q, centre, centre + unit)
    radius = _CLUSTER_MARGIN * unit * root_bound(fmpz_poly(around.coeffs()[: bound + 1]))
    if radius > _MAX_CLUSTER_RADIUS:
        return None
    left, right = max(centre - radius, fmpq(0)), min(centre + radius, fmpq(1))
    return _holding(q, bound, left, right) if left < right else None


def _edge(q: fmpz_poly, bound: int, right: bool, bits: int) -> tuple[fmpz_poly, fmpq, fmpq] | None:
    """q on the part 2^-bits of (0, 1) at its right or left end, with the part's start and width;
    None if it is not proved to hold all roots.
    """
    share = fmpq(1, 2**bits)
    return _holding(q, bound, 1 - share if right else fmpq(0), fmpq(1) if right else share)


def _holding(
    q: fmpz_poly, bound: int, left: fmpq, right: fmpq
) -> tuple[fmpz_poly, fmpq, fmpq] | None:
    """q on (left, right), its start and its width, if that is proved to hold all roots of q in (0,
    1).
    """
    narrow = on_unit_interval(q, left, right)
    held = narrow[0] != 0 and descartes_bound(narrow, q.degree()) == bound
    return (narrow, left, right - left) if held else None


def root_bound(p: fmpz_poly) -> fmpq:
    """A power of two above the moduli of all complex roots: 2 max |a_{n-i} / a_n|^(1/i), rounded up
    (Fujiwara).
    """
    leading, *lower = (int(c).bit_length() for c in reversed(p.coeffs()))
    bits = max((-((leading - 1 - b) // i) for i, b in enumerate(lower, 1) if b), default=0)
    return fmpq(2) ** (1 + bits)
