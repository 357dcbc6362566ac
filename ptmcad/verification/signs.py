"""The sign of a rational function over the open window, proved once more: Sturm counts between critical abscissae.

Guarantee: `Sign.PROVED` and `Sign.WRONG` are theorems. `Sign.UNCHECKED` is answered where a function of both axes has
a degree over `MAX_DEGREE`, or may be zero at an isolated point.

It shares nothing with what the engines ask (`ptmcad.question.positivity`): no Bernstein coefficients, no halving of
boxes, no isolation by Descartes' rule, another elimination. A polynomial changes sign in the open window where one of
its irreducible factors of odd multiplicity does; and between the roots of such a factor's discriminant and of its
values on two edges, the number of its roots in a fibre, all of them simple, is that over one sample.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum
from fractions import Fraction
from math import lcm

from flint import Ordering, arb, ctx, fmpq, fmpq_mpoly_ctx, fmpz_mpoly, fmpz_poly

from ptmcad.text.expressions import Expression
from ptmcad.verification.claims import PLANE, PlaneCurve
from ptmcad.verification.elimination import discriminant
from ptmcad.verification.sturm import roots_between, separated_points, squarefree

MAX_DEGREE = 30
"""The sum of the degrees in the two axes up to which a function of both is looked at."""
_BITS = 200
_BOXES = 2000

_RATIONAL: fmpq_mpoly_ctx = fmpq_mpoly_ctx.get(("u", "v"), Ordering.lex)

Interval = tuple[fmpq, fmpq]
Window = tuple[Interval, Interval]


class Sign(Enum):
    """What is known of a function in the window."""

    PROVED = "proved"
    WRONG = "wrong"
    UNCHECKED = "not checked"


def has_no_pole(e: Expression, window: Window) -> Sign:
    """Whether the denominator, as it is stored, has no zero in the open window."""
    denominator = _polynomial(e.denominator)
    return _sign(denominator * _side(denominator, window), window, strict=True)


def is_in_domain(e: Expression, window: Window, strict: bool) -> Sign:
    """Whether a function without a pole is positive, or not negative, in the open window."""
    if not e.numerator:
        return Sign.WRONG if strict else Sign.PROVED
    denominator = _polynomial(e.denominator)
    return _sign(_polynomial(e.numerator) * _side(denominator, window), window, strict)


def _polynomial(terms: Iterable[tuple[int, int, Fraction]]) -> fmpz_mpoly:
    """A positive multiple."""
    terms = tuple(terms)
    scale = lcm(*(c.denominator for _, _, c in terms))
    return PLANE.from_dict({(i, j): int(c * scale) for i, j, c in terms})


def _value(p: fmpz_mpoly, u: fmpq, v: fmpq) -> fmpq:
    return sum((fmpq(c) * u ** int(i) * v ** int(j) for (i, j), c in p.terms()), fmpq(0))


def _side(p: fmpz_mpoly, window: Window) -> int:
    """The sign at the window's middle, where it has one."""
    (u0, u1), (v0, v1) = window
    return -1 if _value(p, (u0 + u1) / 2, (v0 + v1) / 2) < 0 else 1


def _sign(p: fmpz_mpoly, window: Window, strict: bool) -> Sign:
    """Whether a polynomial that is not zero is positive, or not negative, in the open window."""
    parts = list(_factors(p))
    relevant = [f for f, multiplicity in parts if strict or multiplicity % 2]
    if any(min(f.degrees) > 0 and sum(f.degrees) > MAX_DEGREE for f in relevant):
        (u0, u1), (v0, v1) = window
        grid = [fmpq(k, 32) for k in range(1, 32)]
        values = (_value(p, u0 + (u1 - u0) * s, v0 + (v1 - v0) * t) for s in grid for t in grid)
        return Sign.WRONG if any(value < 0 for value in values) else Sign.UNCHECKED
    if any(_has_curve(f, window) for f in relevant) or _generic_value(p, window) < 0:
        return Sign.WRONG
    if strict and not all(_has_no_isolated_zero(f, window) for f in relevant):
        return Sign.UNCHECKED
    return Sign.PROVED


def _factors(p: fmpz_mpoly) -> Iterator[tuple[PlaneCurve, int]]:
    """Irreducible factors over Q with their multiplicities.

    Not over Z: python-flint sorts those factors by coefficients as machine integers.
    """
    rational = _RATIONAL.from_dict({(int(i), int(j)): c for (i, j), c in p.terms()})
    for factor, multiplicity in rational.factor()[1]:
        terms = [(int(i), int(j), c) for (i, j), c in factor.terms()]
        scale = lcm(*(int(c.q) for _, _, c in terms))
        yield PlaneCurve(0, tuple((i, j, int(c.p) * (scale // int(c.q))) for i, j, c in terms)), int(multiplicity)


def _has_curve(f: PlaneCurve, window: Window) -> bool:
    """Whether an irreducible polynomial is zero along a curve in the open window, so that it changes sign there."""
    base, fibre = window
    if f.degrees[1] == 0:
        return roots_between(f.in_v[0], *base) > 0
    if f.degrees[0] == 0:
        return roots_between(f.in_u[0], *fibre) > 0
    critical = fmpz_poly([1])
    for q in (discriminant(f.terms), *(f.along(edge) for edge in fibre)):
        if q.degree() > 0:
            new = squarefree(q)
            critical *= new // new.gcd(critical)
    return any(roots_between(f.over(u), *fibre) > 0 for u in separated_points(critical, *base))


def _generic_value(p: fmpz_mpoly, window: Window) -> fmpq:
    """The value at a point where it is not zero."""
    (u0, u1), (v0, v1) = window
    for k in range(2, 200):
        for m in range(2, 200):
            value = _value(p, u0 + (u1 - u0) / k, v0 + (v1 - v0) / m)
            if value != 0:
                return value
    raise ArithmeticError("a polynomial of low degree is zero at 39204 points of a grid")


def _has_no_isolated_zero(f: PlaneCurve, window: Window) -> bool:
    """Whether it is proved that f, which is zero along no curve in the open window, is not zero at a point either.

    At such a point the gradient vanishes, and the discriminant has a multiple root below it.
    """
    if min(f.degrees) == 0:
        return True
    base, fibre = window
    d = discriminant(f.terms)
    multiple = squarefree(d.gcd(d.derivative())) if d.degree() > 1 else fmpz_poly([1])
    return all(_is_separated(f, narrow, fibre) for narrow in _narrow_roots(multiple, base))


def _narrow_roots(q: fmpz_poly, base: Interval) -> Iterator[Interval]:
    """Closed intervals, narrow, that hold the roots in the open base."""
    waiting = [base]
    while waiting:
        low, high = waiting.pop()
        middle = (low + high) / 2
        if roots_between(q, low, high) == 0:
            continue
        if (high - low) * 2**60 < base[1] - base[0]:
            yield low, high
            continue
        if q(middle) == 0:
            yield middle, middle
        waiting += [(low, middle), (middle, high)]


def _is_separated(f: PlaneCurve, narrow: Interval, fibre: Interval) -> bool:
    """Whether f is proved not to vanish over an interval, by balls over parts of the fibre."""
    with ctx.workprec(_BITS):
        u = arb(narrow[0]).union(arb(narrow[1]))
        waiting, looked = [fibre], 0
        while waiting:
            low, high = waiting.pop()
            v = arb(low).union(arb(high))
            total = arb(0)
            for row in reversed(f.in_v):
                total = total * v + _horner(row, u)
            looked += 1
            if total.contains(0):
                if looked > _BOXES:
                    return False
                middle = (low + high) / 2
                waiting += [(low, middle), (middle, high)]
    return True


def _horner(row: fmpz_poly, u: arb) -> arb:
    total = arb(0)
    for c in reversed(row.coeffs()):
        total = total * u + arb(c)
    return total
