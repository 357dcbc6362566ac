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
from ptmcad.model.elements import XJoint, second_bar
from ptmcad.model.evaluate import evaluate
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
    unknowns = (*mechanism.angles, *mechanism.reals)
    rows = [[e.derivative(u) for u in unknowns] for e in equations]
    most = prod(max(len(entry.terms) for entry in row) for row in rows)
    if sum(len(e.terms) for e in equations) > MAX_TERMS or most > MAX_MINOR:
        raise ConfigError(f"with x-joints {TOO_LARGE}; numbers for lengths make it smaller", key="x-joint")
    trees = [[tree_of(entry, mechanism.angles) for entry in row] for row in rows]
    return ClosedMechanism(
        mechanism.name,
        mechanism.parameters,
        mechanism.unknowns,
        tuple(tree_of(e, mechanism.angles) for e in equations),
        inequalities=tuple(tree_of(d, mechanism.angles) for d in positive) if len(positive) > 1 else (),
        stability=tuple(determinant([row[:k] for row in trees[:k]]) for k in range(1, len(rows) + 1)),
        mechanism=mechanism,
        tangent=(),
        source=mechanism.source,
        title=mechanism.title,
    )


def _equations(mechanism: Mechanism) -> tuple[list[Polynomial], list[Polynomial]]:
    """The polynomials e_i by the unknowns, and each joint's D."""
    ring = Ring(MAX_PRODUCTS)
    joints = mechanism.xjoints
    bars = {joint.name: _second_bar(joint, ring) for joint in joints}
    points, energy = Points(mechanism, ring), ring.constant(Fraction(0))
    energies = (tree for trees in mechanism.polynomials.values() for tree in trees)
    for tree in (*energies, *split_moments(mechanism).energies):  # with the second bars' angles as angles of their own
        energy += points.value(tree)
    powers = {joint.name: _degree(energy, joint.other) for joint in joints}
    for joint in joints:
        energy = _substituted(energy, joint.other, bars[joint.name], powers[joint.name])
    below = ring.constant(Fraction(1))
    for joint in joints:
        below = _times(below, bars[joint.name][2], powers[joint.name])
    steady = {m.unknown: evaluate(m.value, ring) for m in split_moments(mechanism).steady}
    of_angle = {joint.angle: joint for joint in joints}
    equations = []
    for unknown in (*mechanism.angles, *mechanism.reals):
        slope = energy.derivative(unknown)
        if unknown in steady:
            slope = slope - steady[unknown] * below
        if unknown in of_angle and (power := powers[of_angle[unknown].name]):
            far = bars[of_angle[unknown].name][2]
            slope = far * slope - ring.constant(Fraction(power)) * energy * far.derivative(unknown)
        equations.append(slope)
    return equations, [bars[joint.name][2] for joint in joints]


def _second_bar(joint: XJoint, ring: Ring) -> tuple[Polynomial, Polynomial, Polynomial]:
    length, bars = evaluate(joint.length, ring), evaluate(joint.bars, ring)
    return second_bar(bars, length, ring.cos(joint.angle), ring.sin(joint.angle))


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
