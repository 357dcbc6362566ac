"""The energy of a mechanism and its first and second derivatives at a configuration where all of them are rational.

Guarantee: exact: numbers with two derivatives are carried through the description's expressions (forward mode).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt

from ptmcad.mechanism import Mechanism
from ptmcad.mechanism.evaluate import evaluate
from ptmcad.mechanism.work import split_moments

Row = tuple[Fraction, ...]


@dataclass(frozen=True, slots=True)
class Jet:
    """A number that depends on the unknowns, with its gradient and its Hessian."""

    value: Fraction
    gradient: Row
    hessian: tuple[Row, ...]

    def __add__(self, other: Jet) -> Jet:
        return self._plus(other, Fraction(1))

    def __sub__(self, other: Jet) -> Jet:
        return self._plus(other, Fraction(-1))

    def _plus(self, other: Jet, sign: Fraction) -> Jet:
        gradient = tuple(a + sign * b for a, b in zip(self.gradient, other.gradient, strict=True))
        rows = zip(self.hessian, other.hessian, strict=True)
        hessian = tuple(tuple(a + sign * b for a, b in zip(*pair, strict=True)) for pair in rows)
        return Jet(self.value + sign * other.value, gradient, hessian)

    def __mul__(self, other: Jet) -> Jet:
        size = range(len(self.gradient))
        a, b = self, other
        gradient = tuple(a.value * b.gradient[i] + b.value * a.gradient[i] for i in size)
        hessian = tuple(
            tuple(
                a.value * b.hessian[i][j] + b.value * a.hessian[i][j]
                + a.gradient[i] * b.gradient[j] + a.gradient[j] * b.gradient[i]
                for j in size
            )
            for i in size
        )  # fmt: skip
        return Jet(a.value * b.value, gradient, hessian)

    def root(self) -> Jet | None:
        """The square root; None where it is zero or not rational."""
        root = rational_root(self.value)
        if not root:
            return None
        size = range(len(self.gradient))
        first = tuple(g / (2 * root) for g in self.gradient)
        second = tuple(tuple((self.hessian[i][j] / 2 - first[i] * first[j]) / root for j in size) for i in size)
        return Jet(root, first, second)


class _Jets:
    """The ring of such numbers at a configuration."""

    def __init__(self, mechanism: Mechanism, parameters: Mapping[str, Fraction], at: Mapping[str, Fraction]):
        self.unknowns, self.parameters, self.at = tuple(mechanism.unknowns), parameters, at

    def constant(self, value: Fraction) -> Jet:
        return self._along("", value, Fraction(0), Fraction(0))

    def parameter(self, name: str) -> Jet:
        if name in self.parameters:
            return self.constant(self.parameters[name])
        return self._along(name, self.at[name], Fraction(1), Fraction(0))

    def cos(self, angle: str) -> Jet:
        c, s = self.at[f"cos {angle}"], self.at[f"sin {angle}"]
        return self._along(angle, c, -s, -c)

    def sin(self, angle: str) -> Jet:
        c, s = self.at[f"cos {angle}"], self.at[f"sin {angle}"]
        return self._along(angle, s, c, -s)

    def _along(self, unknown: str, value: Fraction, slope: Fraction, curvature: Fraction) -> Jet:
        first = tuple(slope * (name == unknown) for name in self.unknowns)
        second = tuple(tuple(curvature * (a == unknown == b) for b in self.unknowns) for a in self.unknowns)
        return Jet(value, first, second)


def rational_energy(mechanism: Mechanism, parameters: Mapping[str, Fraction], at: Mapping[str, Fraction]) -> Jet | None:
    """The energy with its derivatives; None where a spring has a length that is zero or not rational.

    Parameters
    ----------
    at : reals by name, and cosines and sines of angles as ``cos NAME`` and ``sin NAME``.
    """
    ring = _Jets(mechanism, parameters, at)
    points = {name: (evaluate(x, ring), evaluate(y, ring)) for name, (x, y) in mechanism.points.items()}
    energy = ring.constant(Fraction(0))
    for spring in mechanism.springs:
        dx, dy = (b - a for a, b in zip(points[spring.start], points[spring.end], strict=True))
        squared, free = dx * dx + dy * dy, evaluate(spring.free, ring)
        if free.value:
            length = squared.root()
            if length is None:
                return None
            squared = (length - free) * (length - free)
        energy += ring.constant(Fraction(1, 2)) * evaluate(spring.stiffness, ring) * squared
    for tree in (*(torsion.energy for torsion in mechanism.torsion), *split_moments(mechanism).energies):
        energy += evaluate(tree, ring)
    for load in mechanism.loads:
        for force, coordinate in zip((load.x, load.y), points[load.point], strict=True):
            energy -= evaluate(force, ring) * coordinate
    return energy


def rational_root(value: Fraction) -> Fraction | None:
    """The square root of a number that is not negative, where it is rational."""
    root = Fraction(isqrt(value.numerator), isqrt(value.denominator))
    return root if root * root == value else None
