"""Mechanisms with X-joints, as the equations of their equilibria in the first bars' angles alone.

Guarantee: the real solutions are the equilibria, and the stable ones the strict minima of the energy; complex solutions
at which some D is zero, where the energy has no value, are excluded by inequalities that every real one satisfies.

With the second bars' cosines and sines, rational functions of the first ones', the energy is N/D_1^m_1 ... D_n^m_n, N a
polynomial and each D_i positive. Its derivative by the angle of joint i, times these powers and D_i, is the polynomial

    e_i = D_i dN/dth_i - m_i N dD_i/dth_i,

and where all e_i vanish the rows of their Jacobian are those of the Hessian times positive numbers. So the Hessian is
positive definite where the leading principal minors of the Jacobian are positive (Sylvester); the last one is its
determinant.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import prod

from ptmcad.errors import ConfigError, ExpressionError
from ptmcad.model.description import ClosedMechanism, Mechanism
from ptmcad.model.elements import second_bar
from ptmcad.model.proofs import Points, Polynomial, Ring
from ptmcad.model.sizes import MAX_TERMS, TOO_LARGE
from ptmcad.model.trees import determinant
from ptmcad.model.work import split_moments, tree_of

MAX_PRODUCTS = 2_000_000
"""Products of terms while the energy is made: some seconds. Two joints with symbolic lengths take a tenth of that."""
MAX_MINOR = 20 * MAX_TERMS
"""Of a condition for stability, multiplied out by the engine."""


def without_xjoints(mechanism: Mechanism) -> ClosedMechanism:
    """The equations of the equilibria of a mechanism with X-joints.

    Raises
    ------
    ConfigError
        When these may have too many terms.
    """
    try:
        equations, positive = _equations(mechanism)
    except ExpressionError as error:
        raise ConfigError(f"with x-joints {error.message}", key="x-joint") from None
    unknowns = mechanism.sorted_unknowns
    rows = [[e.derivative(u) for u in unknowns] for e in equations]
    most = prod(max(len(entry.terms) for entry in row) for row in rows)
    if sum(len(e.terms) for e in equations) > MAX_TERMS or most > MAX_MINOR:
        raise ConfigError(f"with x-joints {TOO_LARGE}; numbers for lengths make it smaller", key="x-joint")
    trees = [[tree_of(entry, mechanism.angles) for entry in row] for row in rows]
    return ClosedMechanism.of(
        mechanism,
        {},
        equations=tuple(tree_of(e, mechanism.angles) for e in equations),
        inequalities=tuple(tree_of(d, mechanism.angles) for d in positive) if len(positive) > 1 else (),
        stability=tuple(determinant([row[:k] for row in trees[:k]]) for k in range(1, len(rows) + 1)),
        tangent=(),
    )


def _equations(mechanism: Mechanism) -> tuple[list[Polynomial], list[Polynomial]]:
    """The polynomials e_i by the unknowns, and each joint's D."""
    ring = Ring(MAX_PRODUCTS)
    points, energy, below = Points(mechanism, ring), ring.constant(Fraction(0)), ring.constant(Fraction(1))
    moments = split_moments(mechanism)
    energies = (tree for trees in mechanism.polynomials.values() for tree in trees)
    for tree in (*energies, *moments.energies):  # with the second bars' angles as angles of their own
        energy += points.value(tree)
    far: dict[str, Polynomial] = {}
    powers = {joint.angle: _degree(energy, joint.other) for joint in mechanism.xjoints}
    for joint in mechanism.xjoints:
        length, bars = points.value(joint.length), points.value(joint.bars)
        second = second_bar(bars, length, ring.cos(joint.angle), ring.sin(joint.angle))
        energy = _substituted(energy, joint.other, second, powers[joint.angle])
        far[joint.angle] = second[2]
        below = _times(below, second[2], powers[joint.angle])
    steady = {m.unknown: points.value(m.value) for m in moments.beside}
    equations = []
    for unknown in mechanism.sorted_unknowns:
        slope = energy.derivative(unknown)
        if unknown in steady:
            slope -= steady[unknown] * below
        if power := powers.get(unknown):
            own = far[unknown]
            slope = own * slope - ring.constant(Fraction(power)) * energy * own.derivative(unknown)
        equations.append(slope)
    return equations, list(far.values())


def _degree(p: Polynomial, angle: str) -> int:
    """In cosine and sine of an angle together."""
    return max((sum(e for v, e in m if v in (f"cos {angle}", f"sin {angle}")) for m in p.terms), default=0)


def _substituted(p: Polynomial, angle: str, bar: Sequence[Polynomial], power: int) -> Polynomial:
    """p with cosine and sine of an angle as quotients with one denominator, times a power of this."""
    parts: dict[tuple[int, int], Polynomial] = {}
    for monomial, c in p.terms.items():
        exponents: Mapping[str, int] = dict(monomial)
        key = exponents.get(f"cos {angle}", 0), exponents.get(f"sin {angle}", 0)
        rest = tuple((v, e) for v, e in monomial if v not in (f"cos {angle}", f"sin {angle}"))
        parts.setdefault(key, Polynomial(p.ring, {})).terms[rest] = c
    found = Polynomial(p.ring, {})
    for (cosine, sine), part in parts.items():
        factor = _times(_times(part, bar[0], cosine), bar[1], sine)
        found = found + _times(factor, bar[2], power - cosine - sine)
    return found


def _times(p: Polynomial, factor: Polynomial, power: int) -> Polynomial:
    for _ in range(power):
        p = p * factor
    return p
