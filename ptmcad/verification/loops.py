"""What equilibria of a mechanism with closed loops satisfy, derived from its description by automatic differentiation.

Guarantee: nothing is taken from `ptmcad.model.loops`, which writes the same formulas as trees. With g the squared
distances that closing bars keep, less the squares of these, and U the energy, both with their derivatives up to the
second order, an equilibrium is a zero of g and of E, the determinant of the gradients of g and U; it is stable where
the determinant of the gradients of g and E is positive.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from flint import fmpq

from ptmcad.model import Mechanism
from ptmcad.verification.inertia import determinant


class Lifting:
    """What a ring with `_lifted`, sums and products of its elements and of numbers has besides."""

    __slots__ = ()

    def _lifted(self, other: Any) -> Any:
        raise NotImplementedError

    def __add__(self, other: Any) -> Any:
        raise NotImplementedError

    def __mul__(self, other: Any) -> Any:
        raise NotImplementedError

    def __radd__(self, other: Any) -> Any:
        return self + other

    def __rmul__(self, other: Any) -> Any:
        return self * other

    def __neg__(self) -> Any:
        return self * fmpq(-1)

    def __sub__(self, other: Any) -> Any:
        return self + -self._lifted(other)

    def __rsub__(self, other: Any) -> Any:
        return self._lifted(other) + -self


class Second(Lifting):
    """A function of the unknowns at a place: value, gradient and Hessian, in any numbers."""

    __slots__ = ("bends", "slopes", "value")

    def __init__(self, value: Any, slopes: Sequence[Any], bends: Mapping[tuple[int, int], Any]):
        self.value, self.slopes, self.bends = value, tuple(slopes), dict(bends)

    def _lifted(self, other: Any) -> Second:
        return other if isinstance(other, Second) else constant(other, len(self.slopes))

    def __add__(self, other: Any) -> Second:
        b = self._lifted(other)
        return Second(
            self.value + b.value,
            [x + y for x, y in zip(self.slopes, b.slopes, strict=True)],
            {ij: x + b.bends[ij] for ij, x in self.bends.items()},
        )

    def __mul__(self, other: Any) -> Second:
        b = self._lifted(other)
        return Second(
            self.value * b.value,
            [x * b.value + self.value * y for x, y in zip(self.slopes, b.slopes, strict=True)],
            {
                (i, j): x * b.value
                + self.slopes[i] * b.slopes[j]
                + self.slopes[j] * b.slopes[i]
                + self.value * b.bends[i, j]
                for (i, j), x in self.bends.items()
            },
        )


def constant(value: Any, unknowns: int) -> Second:
    """What no unknown is in."""
    places = range(unknowns)
    return Second(value, [fmpq(0)] * unknowns, {(i, j): fmpq(0) for i in places for j in places})


def circle(number: int, cosine: Any, sine: Any, unknowns: int) -> tuple[Second, Second]:
    """Cosine and sine of the angle of this number."""
    c, s = constant(cosine, unknowns), constant(sine, unknowns)
    by = [[fmpq(0)] * unknowns for _ in range(2)]
    by[0][number], by[1][number] = -sine, cosine
    there = (number, number)
    return Second(cosine, by[0], c.bends | {there: -cosine}), Second(sine, by[1], s.bends | {there: -sine})


def line(number: int, value: Any, unknowns: int) -> Second:
    """The unknown on the line of this number."""
    flat = constant(value, unknowns)
    return Second(value, [fmpq(int(k == number)) for k in range(unknowns)], flat.bends)


def conditions(
    mechanism: Mechanism,
    energy: Second,
    points: Mapping[str, tuple[Second, Second]],
    length: Callable[[Any], Any],
    moments: Sequence[Second],
) -> tuple[tuple[Any, ...], Any]:
    """Equations, each zero at an equilibrium, and what is positive at a stable one, at a place.

    Parameters
    ----------
    length : the value of a tree.
    moments : generalised forces on the unknowns; none where the description has none.
    """
    kept = distances(mechanism, points, length)
    count = range(len(energy.slopes))
    rows = [[g.slopes[k] for k in count] for g in kept]
    last = [energy.slopes[k] - (moments[k].value if moments else fmpq(0)) for k in count]
    slopes = []
    for j in count:
        bent = [energy.bends[k, j] - (moments[k].slopes[j] if moments else fmpq(0)) for k in count]
        total = determinant([*rows, bent])
        for n, g in enumerate(kept):
            total = total + determinant([*rows[:n], [g.bends[k, j] for k in count], *rows[n + 1 :], last])
        slopes.append(total)
    return (*(g.value for g in kept), determinant([*rows, last])), determinant([*rows, slopes])


def distances(mechanism: Mechanism, points: Mapping[str, tuple[Any, Any]], length: Callable[[Any], Any]) -> list[Any]:
    """What each closing bar keeps zero: the squared distance of its ends less the square of its length."""
    kept = []
    for closing in mechanism.closing:
        across, up = (points[closing.end][i] - points[closing.start][i] for i in (0, 1))
        far = length(closing.length)
        kept.append(across * across + up * up - far * far)
    return kept


def turned(kept: Sequence[Second], values: Sequence[Second]) -> list[Any]:
    """The derivatives of some functions along the loops, of which E is the energy's: with it they are linear."""
    rows = [list(g.slopes) for g in kept]
    return [determinant([*rows, list(value.slopes)]) for value in values]


def stationary(
    mechanism: Mechanism,
    energy: Second,
    points: Mapping[str, tuple[Second, Second]],
    length: Callable[[Any], Any],
    tensions: Sequence[Second],
    moments: Sequence[Second],
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Equations and conditions for stability where several degrees of freedom are left.

    The equations are the derivatives of the energy plus half of each tension times what its bar keeps. With s added to
    the unknowns' own second derivatives the determinant of the bordered matrix is a polynomial in s; its coefficients,
    with one sign, are all positive at a minimum. They are interpolated from values.

    Parameters
    ----------
    tensions : of the bars, the last unknowns.
    moments : generalised forces on the other unknowns; none where the description has none.
    """
    whole = energy
    for closing, tension in zip(mechanism.closing, tensions, strict=True):
        across, up = (points[closing.end][i] - points[closing.start][i] for i in (0, 1))
        far = length(closing.length)
        whole = whole + tension * (across * across + up * up - far * far) * fmpq(1, 2)
    count, bars = len(whole.slopes), len(tensions)
    loads = [*moments, *[constant(fmpq(0), count)] * (count - len(moments))]
    equations = tuple(whole.slopes[k] - loads[k].value for k in range(count))
    rows = [[whole.bends[i, j] - loads[i].slopes[j] for j in range(count)] for i in range(count)]
    inner, free = count - bars, count - 2 * bars
    values = []
    for s in range(free + 1):
        shifted = [[x + fmpq(s) if i == j and i < inner else x for j, x in enumerate(r)] for i, r in enumerate(rows)]
        values.append(determinant(shifted) * fmpq(-1 if bars % 2 else 1))
    coefficients = _interpolated(values)
    return equations, tuple(coefficients[free - k] for k in range(1, free + 1))


def _interpolated(values: Sequence[Any]) -> list[Any]:
    """The coefficients of the polynomial with these values at 0, 1, 2, ..., from the constant one on."""
    size = len(values)
    found: list[Any] = [fmpq(0)] * size
    for k, value in enumerate(values):
        basis, scale = [fmpq(1)], fmpq(1)
        for j in range(size):
            if j != k:  # times (s - j)
                basis = [a - fmpq(j) * b for a, b in zip([fmpq(0), *basis], [*basis, fmpq(0)], strict=True)]
                scale = scale * fmpq(k - j)
        found = [value * (b / scale) + old for old, b in zip(found, basis, strict=True)]
    return found
