"""Whether a polynomial is negative, or zero, somewhere in an open rectangle: decided, not sampled.

Guarantee: `PROVED` and a `SignPoint` point are theorems. `OPEN` is returned only where the work
would be more than was allowed, `Near` only where a polynomial that changes sign nowhere may touch
zero over an irrational abscissa.

Why this decides. Write p as a constant times powers of different irreducible factors over Q. An
irreducible f that changes sign does so across a curve; two factors meet in finitely many points; so
p changes sign in the rectangle if and only if a factor of odd multiplicity does, and p has one sign
everywhere else, that of one sample. An irreducible f in both variables has simple roots over every
abscissa that is not a root of its discriminant, and their number in the fibre is constant between
abscissae that are roots of it or of f on the two long edges. So f changes sign in the open
rectangle if and only if it has a root over the sample of one of these intervals. When it has none,
its only zeros are isolated ones, where its gradient vanishes; over these the discriminant has a
multiple root, because its derivative by the coefficients of f is there a multiple of (1, v, v^2,
...), v being the double root.

References: McCallum, J. Symb. Comp. 5 (1988), on projections; Gelfand, Kapranov and Zelevinsky,
Discriminants, Resultants and Multidimensional Determinants, chapter 1, on the derivative of the
discriminant.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

from flint import arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.algebra.branches import avoids_zero
from ptmcad.algebra.polynomials import (
    Coefficient,
    UnivariatePolynomial,
    coefficients_in,
    evaluate,
    factors_with_multiplicity,
    univariate,
)
from ptmcad.algebra.real_roots import (
    Interval,
    RealRoot,
    disjoint,
    gaps,
    inside,
    isolate,
    refine,
    sign_at,
    squarefree_part,
)
from ptmcad.algebra.resultants import discriminant
from ptmcad.text.flint_numbers import simplest_between

MAX_WORK = 2 * 10**10
"""Of a discriminant: values, times the cube of the degree, times the bits of a coefficient; some
twenty seconds.
"""
BITS = 400
"""Of the balls in which a polynomial is looked at over a singular abscissa."""
_HALVINGS = 60
"""Parts of 2^-60 of a fibre are not halved any more."""

Point = tuple[fmpq, fmpq]


class SignAnswer(Enum):
    """What is known when no point was found."""

    PROVED = "there is none"
    OPEN = "not decided"


@dataclass(frozen=True, slots=True)
class SignPoint:
    """A point of the open rectangle.

    Attributes
    ----------
    exact : whether the polynomial has the sign at the point itself; else it is zero somewhere
        within ``distance`` of it in each coordinate.
    """

    point: Point
    exact: bool
    distance: fmpq


@dataclass(frozen=True, slots=True)
class Near:
    """Not decided: the polynomial is zero, or nearly so, at a place near this point."""

    point: Point


def negative_or_zero(
    p: Coefficient, x: Interval, y: Interval, zero: bool, max_work: int = MAX_WORK
) -> SignPoint | Near | SignAnswer:
    """A point of the open rectangle where p is negative or, if asked for, zero; or that there is
    none.

    Parameters
    ----------
    p : not the zero polynomial.
    x, y : intervals; one may be a single number if p does not depend on that axis.
    zero : whether a zero counts.
    max_work : for each discriminant, in the unit of `MAX_WORK`.
    """
    factors = factors_with_multiplicity(p)
    undecided: Near | SignAnswer | None = None
    for f, multiplicity in factors:
        odd = multiplicity % 2 == 1
        if not odd and not zero:
            continue
        crossing = _crossing(f, x, y, max_work)
        if crossing is SignAnswer.OPEN:
            undecided = crossing
        elif isinstance(crossing, _Crossing):
            return _negative_beside(p, crossing, x, y) if odd else crossing.zero(x, y)
    if undecided is not None:
        return undecided
    # now p has one sign wherever it is not zero
    sample = _nonzero_point(p, x, y)
    if evaluate(p, *sample) < 0:
        return SignPoint(sample, True, fmpq(0))
    if zero:
        for f, _ in factors:
            touching = _isolated_zero(f, x, y)
            if touching is not None:
                return touching
    return SignAnswer.PROVED


@dataclass(frozen=True, slots=True)
class _Crossing:
    """A place where a factor has a simple zero: on the line on which axis ``across`` varies and the
    other one is in an open interval over whose values the line meets the same zeros."""

    across: int
    held: Interval
    root: RealRoot

    def zero(self, x: Interval, y: Interval) -> SignPoint:
        """The zero itself."""
        root = _narrow(self.root, (x, y)[self.across])
        held, there = _simple(self.held), root.middle
        point = (there, held) if self.across == 0 else (held, there)
        return SignPoint(point, root.is_rational, root.high - root.low)


def _simple(interval: Interval) -> fmpq:
    """A number in an open interval; or the only one in a closed one, on a line across which nothing
    varies.
    """
    return interval[0] if interval[0] == interval[1] else simplest_between(*interval)


def _narrow(root: RealRoot, window: Interval) -> RealRoot:
    """The root inside of the window, enclosed to 2^-40 of it; exactly where it is a rational number
    of few digits.
    """
    (near,) = inside([refine(root, (window[1] - window[0]) / 2**40)], window)
    if not near.is_rational:
        simple = simplest_between(near.low, near.high)
        if sign_at(near.polynomial, simple) == 0:
            return RealRoot(near.polynomial, simple, simple)
    return near


def _crossing(f: Coefficient, x: Interval, y: Interval, max_work: int) -> _Crossing | SignAnswer:
    """Where an irreducible polynomial changes sign in the open rectangle, if it does."""
    degrees = [int(d) for d in f.degrees()]
    if min(degrees) == 0:
        across = 0 if degrees[1] == 0 else 1
        roots = isolate(coefficients_in(f, 1 - across)[0], *((x, y)[across]))
        return _Crossing(across, (y, x)[across], roots[0]) if roots else SignAnswer.PROVED
    base = _base(f)
    if _work(f, base) > max_work:
        return SignAnswer.OPEN
    window, fibre = ((x, y), (y, x))[base]
    rows = coefficients_in(f, 1 - base)
    for held in _open_intervals(f, base, window, fibre):
        roots = isolate(univariate(rows, simplest_between(*held)), *fibre)
        if roots:
            return _Crossing(1 - base, held, roots[0])
    return SignAnswer.PROVED


def _base(f: Coefficient) -> int:
    """The axis along which the discriminant is: the one for which it takes less work."""
    return 0 if _work(f, 0) <= _work(f, 1) else 1


def _work(f: Coefficient, base: int) -> int:
    degree, other = (int(f.degrees()[k]) for k in (1 - base, base))
    bits = max(int(c).bit_length() for c in f.coeffs()) + 8 * other
    return 2 * degree * max(other, 1) * degree**3 * bits


def _open_intervals(f: Coefficient, base: int, window: Interval, fibre: Interval) -> list[Interval]:
    """Open intervals of the base between all places at which the number of roots of f in the fibre
    can change.
    """
    along = coefficients_in(f, base)
    critical = [
        discriminant(coefficients_in(f, 1 - base)),
        *(univariate(along, edge) for edge in fibre),
    ]
    roots: list[RealRoot] = []
    known = fmpz_poly([1])
    for q in map(squarefree_part, critical):
        if q.degree() > 0:
            new = q // q.gcd(known)
            known *= new
            roots += isolate(new, *window)
    return gaps(inside(disjoint(roots), window), window)


def _negative_beside(p: Coefficient, crossing: _Crossing, x: Interval, y: Interval) -> SignPoint:
    """A point at which p is negative, on a line across a curve on which it changes sign."""
    across, window = crossing.across, (x, y)[crossing.across]
    rows = coefficients_in(p, across)
    low, high = crossing.held
    while True:  # the curve is met by other factors' curves over finitely many values
        held = _simple((low, high))
        on_line = univariate(rows, held)
        for there in _between_roots(on_line, window):
            if sign_at(on_line, there) < 0:
                return SignPoint((there, held) if across == 0 else (held, there), True, fmpq(0))
        low = held


def _between_roots(q: UnivariatePolynomial, window: Interval) -> Iterator[fmpq]:
    """A point of each open interval into which the roots of q cut the window."""
    if not q:
        return
    separate = inside(disjoint(isolate(squarefree_part(q), *window)), window)
    for gap in gaps(separate, window):
        yield simplest_between(*gap)


def _nonzero_point(p: Coefficient, x: Interval, y: Interval) -> Point:
    """A point of the rectangle at which p is not zero."""
    u, v = _middle(x), _middle(y)
    by_v = coefficients_in(p, 0)
    while not any(c(v) for c in by_v):  # p is zero on finitely many lines
        v = (v + y[1]) / 2
    while evaluate(p, u, v) == 0:
        u = (u + x[1]) / 2
    return u, v


def _isolated_zero(f: Coefficient, x: Interval, y: Interval) -> SignPoint | Near | None:
    """A zero of an irreducible polynomial that changes sign nowhere in the open rectangle, if there
    is one.

    Over a rational value of one of the axes it is found. Over another one, where coefficients are
    not rational, nothing is said but that there may be one, unless it is excluded in balls, or over
    the other axis.
    """
    if min(int(d) for d in f.degrees()) == 0:
        return None  # its roots are simple
    base = _base(f)
    found = _touching(f, base, x, y)
    other = _touching(f, 1 - base, x, y) if isinstance(found, Near) else found
    return found if isinstance(other, Near) else other


def _touching(f: Coefficient, base: int, x: Interval, y: Interval) -> SignPoint | Near | None:
    """The same, as it is seen over one axis."""
    window, fibre = ((x, y), (y, x))[base]
    rows = coefficients_in(f, 1 - base)
    d = discriminant(rows)
    for m, _ in d.gcd(d.derivative()).factor()[1]:
        for root in isolate(m, *window):
            there = _narrow(root, window)
            if m.degree() == 1:
                roots = isolate(squarefree_part(univariate(tuple(rows), _only_root(m))), *fibre)
                height = _narrow(roots[0], fibre) if roots else None
            else:
                height = _undecided(rows, refine(root, fmpq(1, 2**BITS)), fibre)
            if height is not None:
                point = (
                    (there.middle, height.middle) if base == 0 else (height.middle, there.middle)
                )
                if m.degree() > 1:
                    return Near(point)
                return SignPoint(point, height.is_rational, height.high - height.low)
    return None


def _only_root(m: UnivariatePolynomial) -> fmpq:
    return fmpq(-m[0], m[1])


def _undecided(
    rows: Sequence[UnivariatePolynomial], there: RealRoot, fibre: Interval
) -> RealRoot | None:
    """A part of the fibre where a polynomial may be zero over an abscissa that is known in a short
    interval, as if it were a root; None when it is proved to be zero nowhere."""
    with ctx.workprec(BITS):
        p = arb_poly([arb_poly(row)(there.ball) for row in rows])
        parts = [fibre]
        while parts:
            low, high = parts.pop()
            if avoids_zero(p, low, high):
                continue
            if high - low < (fibre[1] - fibre[0]) / 2**_HALVINGS:
                return RealRoot(there.polynomial, low, high)
            middle = (low + high) / 2
            parts += [(middle, high), (low, middle)]
    return None


def _middle(interval: Interval) -> fmpq:
    return (interval[0] + interval[1]) / 2
