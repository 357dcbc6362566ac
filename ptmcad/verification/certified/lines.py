"""The line along which the vector of a spring stays, which may turn with angles.

Guarantee: exact, on the slice: what is asked of polynomials in the parameters holds of them as functions of the axes,
so that a cosine and a sine that are parameters of their own may be told by their values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import NamedTuple

from ptmcad.verification.certified.terms import Terms

Polynomial = dict[tuple[str, ...], Fraction]
"""In the parameters: factors by the names of each product, in order."""
Vanishes = Callable[[Polynomial], bool]
"""Whether a polynomial is zero all over the slice."""
Multi = tuple[int, ...]
Coordinate = Mapping[tuple[Multi, Multi, int], Terms]
"""One of a vector, as waves."""


class Line(NamedTuple):
    """A vector e for d = s e, turned by a sum of angles.

    Attributes
    ----------
    twice : the multiples of the unknowns in twice that sum.
    """

    vector: tuple[Terms, Terms]
    twice: Multi


def line_of(vector: tuple[Coordinate, Coordinate], vanishes: Vanishes) -> Line | None:
    """The line along which a vector stays at all points of a slice, if there is one."""
    parts = {key: part for key, part in _exponentials(vector).items() if not _is_zero(part, vanishes)}
    if not parts:
        return None
    first, last = min(turned for turned, _ in parts), max(turned for turned, _ in parts)
    twice = tuple(a + b for a, b in zip(first, last, strict=True))
    paired = []
    for (turned, raised), part in parts.items():
        other = parts.get((tuple(n - m for n, m in zip(twice, turned, strict=True)), raised))
        if other is None:
            return None
        paired.append((part, other))
    # with d = s e^(i n.q) e a pair is z e and z* e: their sum is along e, or zero, and then i times one of them is
    part, other = paired[0]
    e = _plus(part, other)
    if _is_zero(e, vanishes):
        e = _Complex(_scaled(part.imag, Fraction(-1)), part.real)
    minus = Fraction(-1)
    for part, other in paired:
        one, two = _times(other, _conjugate(e)), _times(_conjugate(part), e)
        if not _is_zero(_plus(one, _Complex(_scaled(two.real, minus), _scaled(two.imag, minus))), vanishes):
            return None
    return Line(_simplest(_Complex(*({} if vanishes(f) else f for f in e))), twice)


class _Complex(NamedTuple):
    """A polynomial in the parameters, by its real and its imaginary part."""

    real: Polynomial
    imag: Polynomial


def _is_zero(z: _Complex, vanishes: Vanishes) -> bool:
    return vanishes(z.real) and vanishes(z.imag)


def _exponentials(vector: tuple[Coordinate, Coordinate]) -> dict[tuple[Multi, Multi], _Complex]:
    """Twice the coefficients of e^(i m.q) h^r in d_x + i d_y, by m and r; none is zero."""
    across, up = vector
    found: dict[tuple[Multi, Multi], _Complex] = {}
    for turned, raised in {(turned, raised) for turned, raised, _ in (*across, *up)}:
        ax, bx, ay, by = (_polynomial(f.get((turned, raised, sine), ())) for f in (across, up) for sine in (0, 1))
        for sign in (1, -1):
            part = _Complex(_sum(ax, _scaled(by, Fraction(sign))), _sum(ay, _scaled(bx, Fraction(-sign))))
            key = tuple(sign * m for m in turned), raised
            part = _plus(part, found[key]) if key in found else part  # what does not turn is there twice
            if part.real or part.imag:
                found[key] = part
    return found


def _simplest(vector: _Complex) -> tuple[Terms, Terms]:
    """A vector in the same direction, or against it, without what both coordinates have in common, if that is all."""
    p, q = vector
    one: Terms = ((1, 1, ()),)
    if not p or not q:
        return (one, ()) if p else ((), one)
    name = next(iter(p))
    if p.keys() == q.keys() and all(p[n] * q[name] == q[n] * p[name] for n in p):
        ratio = q[name] / p[name]
        return ((ratio.denominator, 1, ()),), ((ratio.numerator, 1, ()),)
    return _terms(p), _terms(q)


def _terms(p: Polynomial) -> Terms:
    return tuple((c.numerator, c.denominator, names) for names, c in p.items())


def _conjugate(z: _Complex) -> _Complex:
    return _Complex(z.real, _scaled(z.imag, Fraction(-1)))


def _plus(z: _Complex, w: _Complex) -> _Complex:
    return _Complex(_sum(z.real, w.real), _sum(z.imag, w.imag))


def _times(z: _Complex, w: _Complex) -> _Complex:
    return _Complex(
        _sum(_product(z.real, w.real), _scaled(_product(z.imag, w.imag), Fraction(-1))),
        _sum(_product(z.real, w.imag), _product(z.imag, w.real)),
    )


def _polynomial(terms: Terms) -> Polynomial:
    found: Polynomial = {}
    for p, q, names in terms:
        key = tuple(sorted(names))
        found[key] = found.get(key, Fraction(0)) + Fraction(p, q)
    return _kept(found)


def _scaled(f: Polynomial, factor: Fraction) -> Polynomial:
    return {key: c * factor for key, c in f.items()}


def _sum(f: Polynomial, g: Polynomial) -> Polynomial:
    return _kept({key: f.get(key, Fraction(0)) + g.get(key, Fraction(0)) for key in f.keys() | g.keys()})


def _product(f: Polynomial, g: Polynomial) -> Polynomial:
    found: Polynomial = {}
    for a, factor in f.items():
        for b, other in g.items():
            key = tuple(sorted(a + b))
            found[key] = found.get(key, Fraction(0)) + factor * other
    return _kept(found)


def _kept(f: Polynomial) -> Polynomial:
    """Without terms that are zero."""
    return {key: c for key, c in f.items() if c}
