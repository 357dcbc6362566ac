"""Functions of n unknowns with first and second derivatives, at many points at once.

Guarantee: derivatives follow from the chain rule, up to rounding of doubles. Arrays end with the points' shape S.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Jet:
    """A value of shape S, the gradient of shape (n, *S), the Hessian of shape (n, n, *S)."""

    value: Floats
    gradient: Floats
    hessian: Floats

    __array_ufunc__ = None  # an array at the left leaves products and sums to this class

    def __add__(self, other: Any) -> Jet:
        if isinstance(other, Jet):
            return Jet(self.value + other.value, self.gradient + other.gradient, self.hessian + other.hessian)
        return Jet(self.value + other, self.gradient, self.hessian)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.value, -self.gradient, -self.hessian)

    def __sub__(self, other: Any) -> Jet:
        if isinstance(other, Jet):
            return Jet(self.value - other.value, self.gradient - other.gradient, self.hessian - other.hessian)
        return Jet(self.value - other, self.gradient, self.hessian)

    def __rsub__(self, other: Any) -> Jet:
        negative: Jet = self.__neg__()
        return negative.__add__(other)

    def __mul__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.value * other, self.gradient * other, self.hessian * other)
        cross: Floats = np.multiply(self.gradient[:, None], other.gradient[None, :])
        gradient = self.value * other.gradient + other.value * self.gradient
        hessian = self.value * other.hessian + other.value * self.hessian + cross + np.swapaxes(cross, 0, 1)
        return Jet(self.value * other.value, gradient, hessian)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        # only numbers and parameters divide: coordinates are polynomials
        return Jet(self.value / other, self.gradient / other, self.hessian / other)

    def through(self, value: Floats, slope: Floats, second: Floats) -> Jet:
        """A function of this one, by its value and derivatives."""
        cross = self.gradient[:, None] * self.gradient[None, :]
        return Jet(value, slope * self.gradient, slope * self.hessian + second * cross)

    def root(self) -> Jet:
        """The square root."""
        at = np.sqrt(self.value)
        return self.through(at, 0.5 / at, -0.25 / (at * self.value))


def cos_sin(angles: tuple[Jet, ...]) -> tuple[tuple[Jet, Jet], ...]:
    """Cosine and sine of each."""
    found = []
    for angle in angles:
        c, s = np.cos(angle.value), np.sin(angle.value)
        found.append((angle.through(c, -s, -c), angle.through(s, c, -s)))
    return tuple(found)


def unknowns(at: Floats) -> tuple[Jet, ...]:
    """The unknowns themselves at points of shape (n, *S)."""
    n = len(at)
    found = []
    for k in range(n):
        gradient, hessian = np.zeros((n, *at.shape[1:])), np.zeros((n, n, *at.shape[1:]))
        gradient[k] = 1
        found.append(Jet(at[k], gradient, hessian))
    return tuple(found)
