"""The line along which the vector of a spring stays, which may turn with angles, and springs that are
parallel: where, and how long they are together.

Guarantee: exact, on the slice: what is asked of polynomials in the parameters holds of them as
functions of the axes, so that a cosine and a sine that are parameters of their own make a line,
too. Factors are polynomials over Q in the parameters that are proved to be positive in the open
window.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

from flint import fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from ptmcad.question.slice import Axis
from ptmcad.text.expressions import Expression, constant
from ptmcad.text.flint_numbers import from_fraction, interval_of
from ptmcad.verification.coordinates import evaluated
from ptmcad.verification.windowsigns import Sign, Window, is_in_domain

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
        along = (other.real - part.real) * e.real + (other.imag - part.imag) * e.imag
        across = (other.imag + part.imag) * e.real - (other.real + part.real) * e.imag
        if not (vanishes(along) and vanishes(across)):
            return None
    return SpringLine(_simplest(*(0 * f if vanishes(f) else f for f in e)), twice)


def _exponentials(vector: tuple[Coordinate, Coordinate]) -> dict[tuple[Multi, Multi], _Complex]:
    """Twice the coefficients of e^(i m.q) h^r in d_x + i d_y, by m and r."""
    found: dict[tuple[Multi, Multi], _Complex] = {}
    for k, coordinate in enumerate(vector):
        for (turned, raised, sine), c in coordinate.items():
            for sign in (1, -1):
                # a cosine has both of its halves with one sign, a sine has -i and i
                turn = (k - sine) % 4 if sign > 0 else (k + sine) % 4
                part = _turned(c, turn)
                key = tuple(sign * m for m in turned), raised
                found[key] = found[key].plus(part) if key in found else part
    return found


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


class Parameters:
    """A slice's parameters as variables of polynomials: which are numbers, or the same as others,
    and their signs.

    Parameters
    ----------
    values : by name; a variable without one is zero.
    context : the ring, whose variables are the parameters.
    """

    def __init__(
        self,
        values: Iterable[tuple[str, Expression]],
        axes: tuple[Axis, Axis],
        context: fmpq_mpoly_ctx,
    ):
        self.context, known = context, dict(values)
        self.values = [known.get(name, constant(0)) for name in context.names()]
        self.window: Window = (interval_of(axes[0]), interval_of(axes[1]))

    def valued(self, f: Coordinate) -> dict[Wave, fmpq_mpoly]:
        """The same at every point of the slice, with numbers in place of parameters, and one name
        for equal ones.
        """
        found = {key: self._valued(p) for key, p in f.items()}
        return {key: p for key, p in found.items() if not p.is_zero()}

    def _valued(self, p: fmpq_mpoly) -> fmpq_mpoly:
        found: dict[tuple[int, ...], fmpq] = {}
        for powers, c in p.terms():
            kept, number = [0] * len(powers), c
            for k, power in enumerate(map(int, powers)):
                if power and self.values[k].is_constant:
                    number *= from_fraction(self.values[k].constant()) ** power
                elif power:
                    kept[self.values.index(self.values[k])] += power
            found[tuple(kept)] = found.get(tuple(kept), fmpq(0)) + number
        return self.context.from_dict(found)

    def size(self, p: fmpq_mpoly) -> fmpq_mpoly | None:
        """The absolute value of a polynomial that is proved to be zero nowhere in the window."""
        value = self._expression(p)
        signs = (
            sign for sign in (1, -1) if is_in_domain(sign * value, self.window, True) is Sign.PROVED
        )
        sign = next(signs, None)
        return None if sign is None else p * sign

    def is_positive_number(self, p: fmpq_mpoly) -> bool:
        """Whether a polynomial in the parameters is the same positive number all over the slice."""
        value = self._expression(p)
        return value.is_constant and value.constant() > 0

    def vanishes(self, p: fmpq_mpoly) -> bool:
        """Whether a polynomial in the parameters is zero all over the slice."""
        return not self._expression(p).numerator

    def _expression(self, p: fmpq_mpoly) -> Expression:
        known = dict(zip(self.context.names(), self.values, strict=True))
        total: Expression = constant(0) + evaluated(p, known)
        return total

    def shares(
        self, d: Sequence[Coordinate], other: Sequence[Coordinate]
    ) -> tuple[fmpq_mpoly, fmpq_mpoly] | None:
        """Positive f and g for which d/f and other/g, or its negative, are the same polynomials;
        None without a proof.

        Parameters
        ----------
        d, other : neither is zero.
        """
        lead = next((k, key) for k in (0, 1) for key in d[k])
        one, two = d[lead[0]][lead[1]], other[lead[0]].get(lead[1])
        if two is None:
            return None
        divisor = one.gcd(two)
        f, g = one / divisor, two / divisor
        if any(p * g != other[k].get(key, 0) * f for k in (0, 1) for key, p in d[k].items()):
            return None
        if any(key not in d[k] for k in (0, 1) for key in other[k]):
            return None
        unit = f.leading_coefficient()  # so that f is 1 where the ratio is a number
        sizes = self.size(f / unit), self.size(g / unit)
        return None if sizes[0] is None or sizes[1] is None else (sizes[0], sizes[1])
