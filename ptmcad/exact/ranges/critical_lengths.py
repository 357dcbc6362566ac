"""The system whose solutions are the degenerate equilibria along the axis of the free length, all else fixed.

Guarantee: integer polynomials in v1, v2, v3 (v_i = 1/l_i of either sign), the cosines and sines, and l0. They vanish
at degenerate equilibria with l1, l2 and l3 not zero, and at real values with all v_i > 0 only there.

With m_i = 1 - l0 v_i and n_i = l0 v_i^3, and with squared lengths q_i, the Hessian of U/k is the sum over the springs
of m_i q_i''/2 + n_i q_i' q_i'/4, and of the loads' part. The last polynomial is its determinant.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.algebra.trigonometric import TrigonometricPolynomial, TrigonometricRing
from ptmcad.mechanism import ptm
from ptmcad.mechanism.evaluate import evaluate
from ptmcad.text.flint_numbers import from_fraction

_MECHANISM = ptm()
_INVERSES = tuple(f"v{n}" for n in range(1, len(_MECHANISM.springs) + 1))
_FREE = "free"
_RING = TrigonometricRing((*_INVERSES, _FREE), _MECHANISM.angles)
NAMES = (*_INVERSES, *_RING.context.names()[len(_RING.parameters) :], _FREE)


@dataclass(frozen=True, slots=True)
class _Design:
    """The ring with numbers for the parameters."""

    values: Mapping[str, Fraction]

    def constant(self, value: Fraction) -> TrigonometricPolynomial:
        return _RING.context.constant(from_fraction(value))

    def parameter(self, name: str) -> TrigonometricPolynomial:
        return self.constant(self.values[name])

    cos, sin = staticmethod(_RING.cos), staticmethod(_RING.sin)


def critical_system(design: Mapping[str, Fraction]) -> tuple[str, ...]:
    """Polynomials in `NAMES` as text, for lengths, and loads over k, in one unit; stiffnesses and l0 are equal.

    ``design`` has all parameters of the mechanism but for stiffnesses and free lengths.
    """
    within = _Design(design)
    places = {name: (evaluate(x, within), evaluate(y, within)) for name, (x, y) in _MECHANISM.points.items()}
    ways = [tuple(b - a for a, b in zip(places[s.start], places[s.end], strict=True)) for s in _MECHANISM.springs]
    squares = [_RING.reduce(x * x + y * y) for x, y in ways]
    work = within.constant(Fraction(0))
    for load in _MECHANISM.loads:
        for force, coordinate in zip((load.x, load.y), places[load.point], strict=True):
            work += evaluate(force, within) * coordinate
    first, second = _gradient(work)
    gradient = [-2 * first, -2 * second]  # twice that of U/k
    # 4 times the Hessian of U/k
    h11, h12, h22 = (-4 * p for p in (*_gradient(first), _gradient(second)[1]))
    free = _RING.parameter(_FREE)
    circles = [_RING.cos(angle) ** 2 + _RING.sin(angle) ** 2 - 1 for angle in _RING.angles]
    roots = []
    for v, q in zip(map(_RING.parameter, _INVERSES), squares, strict=True):
        m, n = 1 - free * v, free * v**3
        q1, q2 = _gradient(q)
        gradient = [gradient[0] + m * q1, gradient[1] + m * q2]
        q11, q12 = _gradient(q1)
        h11 += 2 * m * q11 + n * q1 * q1
        h12 += 2 * m * q12 + n * q1 * q2
        h22 += 2 * m * _gradient(q2)[1] + n * q2 * q2
        roots.append(v**2 * q - 1)
    return tuple(map(_primitive_text, (*circles, *roots, *gradient, h11 * h22 - h12 * h12)))


def _gradient(p: TrigonometricPolynomial) -> list[TrigonometricPolynomial]:
    return [_RING.derivative(p, angle) for angle in _RING.angles]


def _primitive_text(p: TrigonometricPolynomial) -> str:
    """A positive multiple with whole coefficients that have no common divisor."""
    scale = math.lcm(*(int(c.q) for c in p.coeffs()))
    divisor = math.gcd(*(int(c.p) * (scale // int(c.q)) for c in p.coeffs()))
    return str(p * from_fraction(Fraction(scale, divisor))).replace(" ", "")
