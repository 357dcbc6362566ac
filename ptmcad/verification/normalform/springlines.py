"""The line along which the vector of a spring stays, which may turn with angles.

Guarantee: exact, on the slice: what is asked of polynomials in the parameters holds of them as
functions of the axes, so that a cosine and a sine that are parameters of their own make a line,
too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from flint import fmpq_mpoly

Vanishes = Callable[[fmpq_mpoly], bool]
"""Whether a polynomial in the parameters is zero all over the slice."""
Multi = tuple[int, ...]
Wave = tuple[Multi, Multi, int]
Coordinate = Mapping[Wave, fmpq_mpoly]
"""One of a vector, as waves."""


class SpringLine(NamedTuple):
    """A vector e for d = s e, turned by a sum of angles.

    Attributes
    ----------
    twice : the multiples of the unknowns in twice that sum.
    """

    vector: tuple[fmpq_mpoly, fmpq_mpoly]
    twice: Multi


class _Complex(NamedTuple):
    """A polynomial in the parameters, by its real and its imaginary part."""

    real: fmpq_mpoly
    imag: fmpq_mpoly

    def plus(self, other: _Complex) -> _Complex:
        return _Complex(self.real + other.real, self.imag + other.imag)

    def times(self, other: _Complex) -> _Complex:
        return _Complex(
            self.real * other.real - self.imag * other.imag,
            self.real * other.imag + self.imag * other.real,
        )

    @property
    def conjugate(self) -> _Complex:
        return _Complex(self.real, -self.imag)

    def vanishes(self, vanishes: Vanishes) -> bool:
        return vanishes(self.real) and vanishes(self.imag)


def line_of(vector: tuple[Coordinate, Coordinate], vanishes: Vanishes) -> SpringLine | None:
    """The line along which a vector stays at all points of a slice, if there is one."""
    parts = {
        key: part for key, part in _exponentials(vector).items() if not part.vanishes(vanishes)
    }
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
    # with d = s e^(i n.q) e a pair is z e and z* e: their sum is along e, or zero, and then i times
    # one of them is
    part, other = paired[0]
    e = part.plus(other)
    if e.vanishes(vanishes):
        e = _Complex(-part.imag, part.real)
    for part, other in paired:
        one, two = other.times(e.conjugate), part.conjugate.times(e)
        if not (vanishes(one.real - two.real) and vanishes(one.imag - two.imag)):
            return None
    return SpringLine(_simplest(*(0 * f if vanishes(f) else f for f in e)), twice)


def _exponentials(vector: tuple[Coordinate, Coordinate]) -> dict[tuple[Multi, Multi], _Complex]:
    """Twice the coefficients of e^(i m.q) h^r in d_x + i d_y, by m and r; none is zero."""
    found: dict[tuple[Multi, Multi], _Complex] = {}
    for k, coordinate in enumerate(vector):
        for (turned, raised, sine), c in coordinate.items():
            for sign in (1, -1):
                # a cosine has both of its halves with one sign, a sine has -i and i
                turn = (k - sine) % 4 if sign > 0 else (k + sine) % 4
                part = _turned(c, turn)
                key = tuple(sign * m for m in turned), raised
                found[key] = found[key].plus(part) if key in found else part
    return {
        key: part
        for key, part in found.items()
        if not (part.real.is_zero() and part.imag.is_zero())
    }


def _turned(c: fmpq_mpoly, quarters: int) -> _Complex:
    """A polynomial times a power of i."""
    zero = 0 * c
    return (_Complex(c, zero), _Complex(zero, c), _Complex(-c, zero), _Complex(zero, -c))[quarters]


def _simplest(p: fmpq_mpoly, q: fmpq_mpoly) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    """A vector in the same direction, or against it, without what both coordinates have in common,
    if that is all.
    """
    one = p.context().constant(1)
    if p.is_zero() or q.is_zero():
        return (p, one) if p.is_zero() else (one, q)
    ratio = q.leading_coefficient() / p.leading_coefficient()
    return (one * ratio.q, one * ratio.p) if q == p * ratio else (p, q)
