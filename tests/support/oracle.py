"""A second way to count equilibria, which shares no code with ptmcad: rational arithmetic of Python
and one unknown.

With general springs, -dU/dth1 / L1 = c1 (k3 L2 s2 + F3) + s1 (k3 L2 c2 - a1) is linear and
homogeneous in (c1, s1), so (c1, s1) = e (A, B) / r with A = a1 - k3 L2 c2, B = k3 L2 s2 + F3,
r^2 = A^2 + B^2, e = 1 or -1; here a1 = (k2 + k3) rho + F3x and a2 = (k1 + k3) rho - F4x. The other
equation becomes e k3 L1 P = r Q with P = a1 s2 + F3 c2 and Q = a2 s2 - F4 c2. Its square is a
sextic in t = tan(th2/2), and th2 = pi is its root at infinity. Where Q is not 0, e r = k3 L1 P / Q,
so there is one solution over th2, H11 has the sign of P Q, and det H that of

    N = k3 L1 P^3 Q W - k3 L1 D P^2 Q^2 - (L2/L1) Q^4 D^2,   W = a2 c2 + F4 s2,   D = a1 c2 - F3
    s2 - k3 L2.

Roots are counted by Sturm sequences, signs at them by Tarski queries: everything is exact but the
signs over P = Q = 0 (loads that let a rod stand by itself), which are taken with 400 digits and a
margin.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from math import gcd

import mpmath

Polynomial = list[int]
"""Coefficients, constant first."""
DIGITS, MARGIN = 400, 60
"""Working digits of the signs that are not exact, and how many of them rounding may take."""


class Degenerate(Exception):
    """Some real equilibrium is singular, or there are infinitely many."""


class Untreated(Exception):
    """r, P and Q vanish together, and so they do with the rods exchanged."""


def primitive(p: Sequence[int | Fraction]) -> Polynomial:
    """A positive multiple with integer coefficients without common factor, and without leading
    zeros.
    """
    scale = 1
    for c in p:
        if isinstance(c, int):
            continue
        scale = scale * c.denominator // gcd(scale, c.denominator)
    numbers = [int(c * scale) for c in p]
    while numbers and numbers[-1] == 0:
        numbers.pop()
    content = gcd(*numbers) if numbers else 1
    return [c // content for c in numbers]


def times(*factors: Sequence[int | Fraction]) -> list[int | Fraction]:
    result: list[int | Fraction] = [1]
    for factor in factors:
        product: list[int | Fraction] = [0] * (len(result) + len(factor) - 1)
        for i, a in enumerate(result):
            for j, b in enumerate(factor):
                product[i + j] += a * b
        result = product
    return result


def plus(*terms: Sequence[int | Fraction]) -> list[int | Fraction]:
    result: list[int | Fraction] = [0] * max(map(len, terms))
    for term in terms:
        for i, c in enumerate(term):
            result[i] += c
    return result


def remainder(a: Polynomial, b: Polynomial) -> Polynomial:
    """A positive multiple of the remainder of a by b."""
    rest, lead = list(a), abs(b[-1])
    sign = 1 if b[-1] > 0 else -1
    while len(rest) >= len(b):
        top = rest[-1] * sign
        rest = [lead * c for c in rest]
        for i, c in enumerate(b, len(rest) - len(b)):
            rest[i] -= top * c
        assert rest[-1] == 0
        while rest and rest[-1] == 0:
            rest.pop()
    return primitive(rest)


def sturm(p: Polynomial, q: Polynomial) -> list[Polynomial]:
    sequence = [p, remainder(q, p) if len(q) >= len(p) else primitive(q)]
    while sequence[-1]:
        sequence.append([-c for c in remainder(sequence[-2], sequence[-1])])
    return sequence[:-1]


def common_divisor(p: Polynomial, q: Polynomial) -> Polynomial:
    return sturm(p, q)[-1] if q else p


def exact_quotient(p: Polynomial, q: Polynomial) -> Polynomial:
    rest, result = [Fraction(c) for c in p], []
    while len(rest) >= len(q):
        top = rest[-1] / q[-1]
        result.append(top)
        for i, c in enumerate(q, len(rest) - len(q)):
            rest[i] -= top * c
        rest.pop()
    assert not any(rest), "not a divisor"
    return primitive(result[::-1])


def derivative(p: Polynomial) -> Polynomial:
    return primitive([i * c for i, c in enumerate(p)][1:])


def changes(signs: Sequence[int]) -> int:
    kept = [s > 0 for s in signs if s]
    return sum(a != b for a, b in pairwise(kept))


def query(p: Polynomial, weight: Polynomial) -> int:
    """Tarski query: the sum over the real roots of the squarefree p of the sign of the weight."""
    if len(p) < 2 or not weight:
        return 0
    small = remainder(weight, p)  # has the weight's signs at the roots
    if not small:
        return 0
    sequence = sturm(p, primitive(times(derivative(p), small)))
    low = [c[-1] * (-1) ** (len(c) - 1) for c in sequence]
    return changes(low) - changes([c[-1] for c in sequence])


def real_roots(p: Polynomial) -> int:
    """The number of different real roots."""
    return query(squarefree(p), [1])


def squarefree(p: Polynomial) -> Polynomial:
    common = common_divisor(p, derivative(p))
    return exact_quotient(p, common) if len(common) > 1 else p


def linear(constant: Fraction, cosine: Fraction, sine: Fraction) -> list[Fraction]:
    """(1 + t^2) (constant + cosine c2 + sine s2)."""
    return [constant + cosine, 2 * sine, constant - cosine]


def count(parameters: Mapping[str, Fraction]) -> tuple[int, int, int]:
    """Numbers of minima, saddles and maxima; parameters by ptmcad's names.

    Raises
    ------
    Degenerate
        When a real equilibrium has a singular Hessian, or there are infinitely many.
    Untreated
        In a very special case (found by no random point with loads).
    """
    try:
        return _count(parameters)
    except Untreated:
        return _count(exchanged(parameters))


def exchanged(parameters: Mapping[str, Fraction]) -> dict[str, Fraction]:
    """The mirror image in a vertical line: the other rod comes first."""
    pairs = {"L1": "L2", "k1": "k2", "F3": "F4", "F3x": "F4x"}
    names = {**pairs, **{b: a for a, b in pairs.items()}}
    return {
        n: -parameters[names.get(n, n)] if n in ("F3x", "F4x") else parameters[names.get(n, n)]
        for n in parameters
    }


def _count(parameters: Mapping[str, Fraction]) -> tuple[int, int, int]:
    names = ("L1", "L2", "rho", "k1", "k2", "k3", "F3", "F4", "F3x", "F4x")
    length1, length2, rho, k1, k2, k3, f3, f4, f3x, f4x = (Fraction(parameters[n]) for n in names)
    a1, a2 = (k2 + k3) * rho + f3x, (k1 + k3) * rho - f4x
    zero = Fraction(0)
    one = [Fraction(1), zero, Fraction(1)]
    squared_r = linear(
        a1**2 + f3**2 + (k3 * length2) ** 2, -2 * a1 * k3 * length2, 2 * f3 * k3 * length2
    )
    w, d = linear(zero, a2, f4), linear(-k3 * length2, a1, -f3)
    minima, saddles, maxima = 0, 0, 0
    free = (
        a1**2 + f3**2 == (k3 * length2) ** 2
    )  # r = 0 for one th2, where th1 is free: sin(th1 + th2) = Q / (k3 L1)
    if free and a1 * f4 + a2 * f3 == 0:
        raise Untreated
    if a1 * f4 + a2 * f3 == 0:  # P and Q vanish together
        along = (a2, f4) if a2 or f4 else (a1, -f3)
        if not any(along):
            raise Degenerate("every th2 is a solution")
        for side in (1, -1):
            for e in (1, -1):
                index = _standing(along, side, e, (a1, a2, f3, f4, k3, length1, length2))
                minima, saddles, maxima = (
                    minima + (index == 0),
                    saddles + (index == 1),
                    maxima + (index == 2),
                )
        # P = p l, Q = q l with l = along[0] s2 - along[1] c2
        q = Fraction(1 if a2 or f4 else 0)
        p = a1 / along[0] if along[0] else -f3 / along[1]
        top, bottom = [p], [q]
    else:
        top, bottom = linear(zero, f3, a1), linear(zero, -f4, a2)
    sextic = plus(
        [(k3 * length1) ** 2 * c for c in times(top, top, one)],
        [-c for c in times(squared_r, bottom, bottom)],
    )
    n = plus(
        [k3 * length1 * c for c in times(top, top, top, bottom, w, one)],
        [-k3 * length1 * c for c in times(d, top, top, bottom, bottom, one)],
        [-length2 / length1 * c for c in times(bottom, bottom, bottom, bottom, d, d)],
    )
    slope = times(top, bottom)
    if free:
        c2, s2 = a1 / (k3 * length2), -f3 / (k3 * length2)
        sine = (a2 * s2 - f4 * c2) / (k3 * length1)
        if abs(sine) == 1:
            raise Degenerate("two equilibria coincide where r = 0")
        saddles += 2 * (abs(sine) < 1)  # H11 = L1 e r = 0 there
        if c2 == -1:  # the double root at infinity
            assert sextic[-1] == sextic[-2] == 0
            sextic = sextic[:-2]
        else:
            at = s2 / (1 + c2)
            sextic = quotient_at_infinity_too(sextic, primitive(times([-at, 1], [-at, 1])))  # type: ignore[assignment]
    if not any(sextic):
        raise Degenerate("every th2 is a solution")
    if sextic[-1] == 0:  # th2 = pi
        if sextic[-2] == 0:
            raise Degenerate("a multiple root at th2 = pi")
        if n[-1] == 0 or slope[-1] == 0:
            raise Degenerate("singular at th2 = pi")
        minima += n[-1] > 0 and slope[-1] > 0
        maxima += n[-1] > 0 and slope[-1] < 0
        saddles += n[-1] < 0
    whole = primitive(sextic)
    repeated = common_divisor(whole, derivative(whole)) if len(whole) > 1 else [1]
    if len(repeated) > 1 and real_roots(repeated):
        raise Degenerate("a multiple real root")
    p = squarefree(whole) if len(whole) > 1 else whole  # type: ignore[assignment]
    determinant, sign = primitive(n), primitive(slope)
    if len(p) > 1:
        for factor in (determinant, sign):
            shared = common_divisor(p, factor)
            if len(shared) > 1 and real_roots(shared):
                raise Degenerate("a singular Hessian")
    total, definite = query(p, [1]), query(p, determinant)
    oriented = query(p, sign) + query(p, primitive(times(determinant, sign)))
    positive = (total + definite) // 2
    minima += (positive + oriented // 2) // 2
    maxima += (positive - oriented // 2) // 2
    saddles += total - positive
    return minima, saddles, maxima


def quotient_at_infinity_too(p: Sequence[int | Fraction], q: Polynomial) -> list[int]:
    """p divided by q, with the leading zeros of p kept (they are roots at infinity)."""
    zeros = 0
    while p[len(p) - 1 - zeros] == 0:
        zeros += 1
    return exact_quotient(primitive(p), q) + [0] * zeros


def _standing(
    along: tuple[Fraction, Fraction], side: int, e: int, values: Sequence[Fraction]
) -> int:
    """Morse index of the solution with P = Q = 0, (c2, s2) along side * along, (c1, s1) = e (A,
    B) / r.
    """
    with mpmath.workdps(DIGITS):
        a1, a2, f3, f4, k3, length1, length2 = (
            mpmath.mpf(v.numerator) / v.denominator for v in values
        )
        x, y = (mpmath.mpf(v.numerator) / v.denominator for v in along)
        norm = mpmath.sqrt(x * x + y * y)
        c2, s2 = side * x / norm, side * y / norm
        r = mpmath.sqrt((a1 - k3 * length2 * c2) ** 2 + (k3 * length2 * s2 + f3) ** 2)
        w, d = a2 * c2 + f4 * s2, a1 * c2 - f3 * s2 - k3 * length2
        terms = [e * r**3 * w, -k3 * length1 * d * r**2, -(k3**2) * length1 * length2 * d**2]
        value = mpmath.fsum(terms)
        if abs(value) <= max(map(abs, terms)) * mpmath.mpf(10) ** (MARGIN - DIGITS) or r == 0:
            raise Degenerate("a singular Hessian where P = Q = 0")
        return 1 if value < 0 else 0 if e > 0 else 2
