"""Equilibria with angles that follow from unknown ones, as those of X-joints' second bars do, in
the unknowns alone.

Guarantee: the real solutions are the equilibria, and the stable ones the strict minima of the
energy; complex solutions at which some D is zero, where the energy has no value, are excluded by
inequalities that every real one satisfies.

With the followers' cosines and sines, rational functions of the angles th_i that they follow, the
energy is N/D_1^m_1 ... D_n^m_n, N a polynomial and each D_i positive. Its derivative by th_i, times
these powers and D_i, is the polynomial

    e_i = D_i dN/dth_i - m_i N dD_i/dth_i,

and where all e_i vanish the rows of their Jacobian are those of the Hessian times positive numbers.
So the Hessian is positive definite where the leading principal minors of the Jacobian are positive
(Sylvester); the last one is its determinant.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any, Generic, NamedTuple, TypeVar

from ptmcad.errors import ExpressionError
from ptmcad.formulas.graph import Formula, determinant
from ptmcad.model.antiparallelogram import XJoint
from ptmcad.model.closedloops import Conditions
from ptmcad.model.description import Mechanism
from ptmcad.model.evaluate import Named, Ring, evaluate, evaluated
from ptmcad.model.identities import Polynomial, PolynomialRing
from ptmcad.model.termbounds import MAX_TERMS, TOO_LARGE
from ptmcad.model.work import split_moments

V = TypeVar("V")
P = TypeVar("P")
MAX_PRODUCTS = 2_000_000
"""Products of terms while the energy is made: some seconds. Two joints with symbolic lengths take a
tenth of that.
"""
MAX_MINOR = 20 * MAX_TERMS
"""Of a condition for stability, multiplied out by the engine."""


class Follower(NamedTuple, Generic[V, P]):
    """An angle that follows from an unknown one: that of an X-joint's second bar, in formulas or
    multiplied out.

    Attributes
    ----------
    leader, variable : the unknown angle, and its own, by numbers or names.
    cosine, sine, below : numerators and the common denominator, positive, in parameters and the
        unknown angle.
    """

    leader: V
    variable: V
    cosine: P
    sine: P
    below: P


ExpandedFollower = Follower[str, Polynomial]


def second_bar(bars: Any, length: Any, cosine: Any, sine: Any) -> tuple[Any, Any, Any]:
    """D cos psi, D sin psi and D, of L, b, cos th and sin th (`ptmcad.model.antiparallelogram`), in
    any numbers that can be added and multiplied.
    """
    far, near = bars * bars, length * length
    twice = bars * length + bars * length
    return (far + near) * cosine - twice, (far - near) * sine, far + near - twice * cosine


def follower(joint: XJoint, ring: Ring[Any], leader: V, variable: V) -> Follower[V, Any]:
    """The second bar's angle in a ring."""
    bars, length = evaluated((joint.bars, joint.length), ring)
    turned = second_bar(bars, length, ring.cos(joint.angle), ring.sin(joint.angle))
    return Follower(leader, variable, *turned)


def conditions(mechanism: Mechanism, variables: Mapping[str, Formula]) -> Conditions:
    """What holds at equilibria in the unknowns alone, multiplied out: the equations are the e_i.

    Parameters
    ----------
    mechanism : with X-joints, and without free lengths.
    variables : all by their names.

    Raises
    ------
    ExpressionError
        When the equations may have too many terms.
    """
    ring, unknowns = PolynomialRing(MAX_PRODUCTS), mechanism.sorted_unknowns
    placed = Named(ring, mechanism.coordinates)
    constant_moments, energies = split_moments(mechanism)
    parts = [tree for element in mechanism.elements.values() for tree in element.energies]
    energy = sum(evaluated((*parts, *energies), placed), start=Polynomial(ring, {}))
    moments = dict.fromkeys(unknowns, Polynomial(ring, {}))
    moments |= {unknown: evaluate(moment, ring) for unknown, moment in constant_moments}
    bars = [follower(joint, ring, joint.angle, joint.other) for joint in mechanism.xjoints]
    equations = _equations(energy, bars, moments)
    rows = [[e.derivative(name) for name in unknowns] for e in equations]
    most = prod(max(len(entry.terms) for entry in row) for row in rows)
    if sum(len(e.terms) for e in equations) > MAX_TERMS or most > MAX_MINOR:
        raise ExpressionError(f"{TOO_LARGE}; numbers for lengths make it smaller")
    hessian = [tuple(_formula(entry, variables) for entry in row) for row in rows]
    return (
        tuple(_formula(e, variables) for e in equations),
        tuple(determinant([row[:k] for row in hessian[:k]]) for k in range(1, len(hessian) + 1)),
        (),
        tuple(_formula(b.below, variables) for b in bars if len(bars) > 1),
    )


def _equations(
    energy: Polynomial, bars: Sequence[ExpandedFollower], moments: Mapping[str, Polynomial]
) -> list[Polynomial]:
    """The e_i."""
    below, powers = energy.ring.constant(Fraction(1)), [_degree(energy, b.variable) for b in bars]
    for bar, power in zip(bars, powers, strict=True):
        energy = _substituted(energy, bar, power)
        below = _times(below, bar.below, power)
    slopes = {
        unknown: energy.derivative(unknown) - moment * below for unknown, moment in moments.items()
    }
    for bar, power in zip(bars, powers, strict=True):
        if power:
            turned = (
                energy.ring.constant(Fraction(power)) * energy * bar.below.derivative(bar.leader)
            )
            slopes[bar.leader] = bar.below * slopes[bar.leader] - turned
    return list(slopes.values())


def _formula(p: Polynomial, variables: Mapping[str, Formula]) -> Formula:
    """A polynomial as a sum of products."""
    total = next(iter(variables.values())).graph.constant(0)
    for monomial, c in sorted(p.terms.items()):
        term = total.graph.constant(c)
        for name, e in monomial:
            function, _, own = name.rpartition(" ")
            variable = variables[own]
            factor = (
                variable.cos() if function == "cos" else variable.sin() if function else variable
            )
            for _ in range(e):
                term = term * factor
        total = total + term
    return total


def _degree(p: Polynomial, angle: str) -> int:
    """In cosine and sine of an angle together."""
    return max(
        (sum(e for v, e in m if v in (f"cos {angle}", f"sin {angle}")) for m in p.terms), default=0
    )


def _substituted(p: Polynomial, bar: ExpandedFollower, power: int) -> Polynomial:
    """p with cosine and sine of the bar's angle as quotients, times a power of their denominator."""
    parts: dict[tuple[int, int], Polynomial] = {}
    for monomial, c in p.terms.items():
        exponents = dict(monomial)
        key = (
            exponents.pop(f"cos {bar.variable}", 0),
            exponents.pop(f"sin {bar.variable}", 0),
        )
        parts.setdefault(key, Polynomial(p.ring, {})).terms[tuple(exponents.items())] = c
    found = Polynomial(p.ring, {})
    for (cosine, sine), part in parts.items():
        factor = _times(_times(part, bar.cosine, cosine), bar.sine, sine)
        found += _times(factor, bar.below, power - cosine - sine)
    return found


def _times(p: Polynomial, factor: Polynomial, power: int) -> Polynomial:
    for _ in range(power):
        p = p * factor
    return p
