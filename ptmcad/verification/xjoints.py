"""What equilibria of a mechanism with X-joints satisfy, derived from its description by complex numbers.

Guarantee: nothing is taken from `ptmcad.model.crossed`, which replaces cosines and sines by quotients. Here the
energy is a Laurent polynomial in the units w = exp(i psi) of the second bars, whose coefficients have values, gradients
and Hessians. The crossed branch of a joint is w (L - b z) = L z - b with z = exp(i th): so w is e/D with
e = (L z - b)(L - b/z) and D = (L - b z)(L - b/z), and 1/w is the conjugate of that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import fmpq

from ptmcad.verification.inertia import determinant
from ptmcad.verification.loops import Lifting, Second

_Complex = tuple[Any, Any]
"""Real and imaginary part."""


class Units(Lifting):
    """A Laurent polynomial in the second bars' units: exponents to complex coefficients."""

    __slots__ = ("count", "terms")

    def __init__(self, terms: Mapping[tuple[int, ...], _Complex], count: int):
        self.terms, self.count = dict(terms), count

    def _lifted(self, other: Any) -> Units:
        return other if isinstance(other, Units) else Units({(0,) * self.count: (other, fmpq(0))}, self.count)

    def __add__(self, other: Any) -> Units:
        terms = dict(self.terms)
        for key, (x, y) in self._lifted(other).terms.items():
            a, b = terms.get(key, (fmpq(0), fmpq(0)))
            terms[key] = a + x, b + y
        return Units(terms, self.count)

    def __mul__(self, other: Any) -> Units:
        found = Units({}, self.count)
        for m, one in self.terms.items():
            for n, two in self._lifted(other).terms.items():
                key = tuple(i + j for i, j in zip(m, n, strict=True))
                found = found + Units({key: _product(one, two)}, self.count)
        return found


def unit_circle(number: int, count: int) -> tuple[Units, Units]:
    """Cosine and sine of the angle of the second bar of this number: (w + 1/w)/2 and (w - 1/w)/2i."""
    half, zero = fmpq(1, 2), fmpq(0)
    ahead, back = (tuple(sign * int(k == number) for k in range(count)) for sign in (1, -1))
    return (
        Units({ahead: (half, zero), back: (half, zero)}, count),
        Units({ahead: (zero, -half), back: (zero, half)}, count),
    )


def powers_in(energy: Units) -> tuple[int, ...]:
    """The highest power of each unit, or of its inverse, in an energy whose coefficients are polynomials."""
    met = [m for m, parts in energy.terms.items() if any(part != 0 for part in parts)]
    return tuple(max((abs(m[k]) for m in met), default=0) for k in range(energy.count))


def _product(one: _Complex, two: _Complex) -> _Complex:
    (a, b), (c, d) = one, two
    return a * c + -(b * d), a * d + b * c


def conditions(
    numbers: Sequence[int],
    energy: Units,
    powers: Sequence[int],
    lengths: Sequence[tuple[Second, Second]],
    turns: Sequence[tuple[Second, Second]],
    moments: Sequence[Second],
) -> tuple[tuple[Any, ...], tuple[Any, ...], tuple[Any, ...]]:
    """Equations, each zero at an equilibrium, what is not zero there, and what is positive at a stable one.

    Parameters
    ----------
    numbers : of the joints' unknowns.
    powers : the highest of each second bar's unit in the energy (`powers_in`).
    lengths, turns : the lengths of each joint's base and bars; cosine and sine of its unknown.
    moments : generalised forces on the unknowns; none where the description has none.
    """
    ways = [_second_bar(*length, *turn) for length, turn in zip(lengths, turns, strict=True)]
    total: Any = fmpq(0)
    for exponents, coefficient in energy.terms.items():
        if any(abs(m) > power for m, power in zip(exponents, powers, strict=True)):
            continue  # zero
        term = coefficient
        for k, m in enumerate(exponents):
            (real, imaginary), far = ways[k]
            for _ in range(abs(m)):
                term = _product(term, (real, imaginary if m > 0 else -imaginary))
            for _ in range(powers[k] - abs(m)):
                term = _product(term, (far, fmpq(0)))
        total = total + term[0]
    below: Any = fmpq(1)
    for k, power in enumerate(powers):
        for _ in range(power):
            below = ways[k][1] * below
    count = len(total.slopes)
    at = {number: k for k, number in enumerate(numbers) if powers[k]}
    equations, rows = [], []
    for i in range(count):
        # value and slopes of the energy's derivative times the denominators
        value = total.slopes[i]
        slopes = [total.bends[i, j] for j in range(count)]
        if moments:
            moved = moments[i] * below
            value, slopes = value - moved.value, [s - m for s, m in zip(slopes, moved.slopes, strict=True)]
        if i in at:
            far, power = ways[at[i]][1], powers[at[i]]
            slopes = [
                far.slopes[j] * value
                + far.value * slopes[j]
                - (total.slopes[j] * far.slopes[i] + total.value * far.bends[i, j]) * fmpq(power)
                for j in range(count)
            ]
            value = far.value * value - total.value * far.slopes[i] * fmpq(power)
        equations.append(value)
        rows.append(slopes)
    minors = tuple(determinant([row[:k] for row in rows[:k]]) for k in range(1, count + 1))
    distances = tuple(far.value for _, far in ways) if len(ways) > 1 else ()
    return tuple(equations), distances, minors


def _second_bar(base: Second, bars: Second, cosine: Second, sine: Second) -> tuple[_Complex, Second]:
    """e and D."""
    ahead = bars * cosine - base, bars * sine
    back = bars - base * cosine, base * sine
    return _product(ahead, back), back[0] * back[0] + back[1] * back[1]
