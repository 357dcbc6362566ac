"""Springs whose vectors stay on one line, which may turn with angles: which they are, and on which side of length zero
a configuration has them.

Guarantee: exact. Where d = s e with a fixed e, or one that is turned by a sum of angles, a spring's direction is e/|e|
or -e/|e| wherever it has a length, so that solutions are those of the equations with either one, at which s is positive
or negative. Springs without length are no solutions. Where half an angle is in that sum, a full turn of the angle
changes sides: each side has its own part of any box of the angles, and one configuration is on both sides at the box's
two ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import product
from typing import NamedTuple

from ptmcad.verification.certified.vectors import Terms
from ptmcad.verification.certified.waves import Cone, Form

_Polynomial = dict[tuple[str, ...], Fraction]
Sides = Mapping[str, int]
"""1 or -1 by the name of each spring on a line: the sign of s."""


class Line(NamedTuple):
    """A vector e for d = s e, turned by a sum of angles.

    Attributes
    ----------
    twice : the multiples of the unknowns in twice that sum.
    """

    vector: tuple[Terms, Terms]
    twice: tuple[int, ...]


def sides(form: Form) -> Iterator[Sides]:
    """All choices; a single empty one where no spring is on a line."""
    names = [cone.name for cone in form.cones if line_of(cone) is not None]
    for chosen in product((1, -1), repeat=len(names)):
        yield dict(zip(names, chosen, strict=True))


def line_of(cone: Cone) -> Line | None:
    """The line along which d stays for all values of the parameters, if there is one."""
    parts = _exponentials(cone)
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
    if not (e.real or e.imag):
        e = _Complex(_scaled(part.imag, Fraction(-1)), part.real)
    if any(_times(other, _conjugate(e)) != _times(_conjugate(part), e) for part, other in paired):
        return None
    return Line(_simplest(e), twice)


class _Complex(NamedTuple):
    """A polynomial in the parameters, by its real and its imaginary part."""

    real: _Polynomial
    imag: _Polynomial


def _exponentials(cone: Cone) -> dict[tuple[tuple[int, ...], tuple[int, ...]], _Complex]:
    """Twice the coefficients of e^(i m.q) h^r in d_x + i d_y, by m and r; none is zero."""
    across, up = cone.vector
    found: dict[tuple[tuple[int, ...], tuple[int, ...]], _Complex] = {}
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


def _terms(p: _Polynomial) -> Terms:
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


def _polynomial(terms: Terms) -> _Polynomial:
    found: _Polynomial = {}
    for p, q, names in terms:
        key = tuple(sorted(names))
        found[key] = found.get(key, Fraction(0)) + Fraction(p, q)
    return _kept(found)


def _scaled(f: _Polynomial, factor: Fraction) -> _Polynomial:
    return {key: c * factor for key, c in f.items()}


def _sum(f: _Polynomial, g: _Polynomial) -> _Polynomial:
    return _kept({key: f.get(key, Fraction(0)) + g.get(key, Fraction(0)) for key in f.keys() | g.keys()})


def _product(f: _Polynomial, g: _Polynomial) -> _Polynomial:
    found: _Polynomial = {}
    for a, factor in f.items():
        for b, other in g.items():
            key = tuple(sorted(a + b))
            found[key] = found.get(key, Fraction(0)) + factor * other
    return _kept(found)


def _kept(f: _Polynomial) -> _Polynomial:
    """Without terms that are zero."""
    return {key: c for key, c in f.items() if c}
