"""A parametric system: the equilibria of a potential energy on a torus of angles.

Guarantee: equations and Hessian are derived from the potential by exact differentiation; nothing is typed in.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flint import fmpq

from ptmcad.algebra.polynomials import (
    ONE,
    ZERO,
    Coefficient,
    Ratio,
    UnknownPolynomial,
    add_ratios,
    common_factor,
    lcm,
    ratio,
)
from ptmcad.algebra.trigonometric import TrigonometricPolynomial, TrigonometricRing
from ptmcad.errors import DimensionError

RationalPolynomial = dict[tuple[int, ...], fmpq]
"""A polynomial in the unknowns with rational coefficients: exponent vector -> coefficient."""

Terms = tuple[tuple[tuple[int, ...], tuple[tuple[tuple[tuple[int, int], ...], fmpq], ...]], ...]
"""(exponents of the unknowns, ((parameter number, exponent) pairs, coefficient) for each term) for each monomial."""


@dataclass(frozen=True, slots=True)
class ParametricSystem:
    """Equilibrium equations of a potential energy U(angles; parameters).

    Attributes
    ----------
    ring : Q[parameters][cos, sin].
    potential : U, in units of force times length.
    gradient : dU/d(angle), one for each angle.
    hessian : second derivatives of U, row by row.
    gradient_terms, hessian_terms : the same, sorted for evaluation at many points.
    positive : parameters that must be positive (rod lengths and stiffnesses).
    nonnegative : parameters that must not be negative (the base length).
    """

    ring: TrigonometricRing
    potential: TrigonometricPolynomial
    gradient: tuple[TrigonometricPolynomial, ...]
    hessian: tuple[tuple[TrigonometricPolynomial, ...], ...]
    gradient_terms: tuple[Terms, ...]
    hessian_terms: tuple[tuple[Terms, ...], ...]
    positive: tuple[str, ...]
    nonnegative: tuple[str, ...]

    @property
    def dimension(self) -> int:
        """The number of angles."""
        return len(self.ring.angles)


def require_two_angles(system: ParametricSystem, what: str) -> None:
    """Refuse a system to which a formula for 2 x 2 Hessians does not apply.

    Parameters
    ----------
    what : the quantity that the formula gives, for the message.

    Raises
    ------
    DimensionError
        When the system does not have two angles.
    """
    if system.dimension != 2:
        angles = ", ".join(system.ring.angles)
        raise DimensionError(f"{what}: known for systems of two angles only, and this one has {system.dimension} "
                             f"({angles})")  # fmt: skip


def from_potential(
    ring: TrigonometricRing, potential: TrigonometricPolynomial, positive: tuple[str, ...], nonnegative: tuple[str, ...]
) -> ParametricSystem:
    """The system of equilibria of a potential, by differentiation."""
    gradient = tuple(ring.reduce(ring.derivative(potential, a)) for a in ring.angles)
    hessian = tuple(tuple(ring.reduce(ring.derivative(g, a)) for a in ring.angles) for g in gradient)
    return ParametricSystem(
        ring,
        potential,
        gradient,
        hessian,
        tuple(_terms(ring, g) for g in gradient),
        tuple(tuple(_terms(ring, h) for h in row) for row in hessian),
        positive,
        nonnegative,
    )


def _terms(ring: TrigonometricRing, p: TrigonometricPolynomial) -> Terms:
    return tuple(
        (monomial, tuple((tuple((k, e) for k, e in enumerate(powers) if e), c) for powers, c in part.items()))
        for monomial, part in ring.split(p).items()
    )


@dataclass(frozen=True, slots=True)
class SliceSystem:
    """The equations of a slice with polynomial coefficients: what elimination works on.

    Attributes
    ----------
    equations : the gradient's entries, each divided by ``contents`` and cleared of denominators, then the circles
        cos^2 + sin^2 - 1; exponent vector -> element of Z[x, y].
    jacobian : the Hessian's determinant, cleared of denominators (these vanish only on ``boundary``).
    boundary : polynomials where the slice's equations lose their meaning: denominators of the parameters, and
        factors common to all coefficients of an equation (there that equation vanishes identically).
    """

    equations: tuple[UnknownPolynomial, ...]
    jacobian: UnknownPolynomial
    boundary: tuple[Coefficient, ...]
    unknowns: int


def on_slice(system: ParametricSystem, parameters: Mapping[str, Ratio]) -> SliceSystem:
    """Substitute rational functions of the axes for the parameters.

    Parameters
    ----------
    parameters : every parameter of the ring as numerator and denominator in Z[x, y].

    Guarantee
    ---------
    Outside the zero set of ``boundary`` the equations have exactly the equilibria as their solutions.
    """
    unknowns = 2 * system.dimension
    boundary: list[Coefficient] = []
    equations: list[UnknownPolynomial] = []
    for gradient in system.gradient:
        cleared, removed = _cleared(_substitute(system, gradient, parameters))
        equations.append(cleared)
        boundary += removed
    for k in range(system.dimension):
        circle: UnknownPolynomial = {(0,) * unknowns: -ONE}
        for offset in (0, 1):
            circle[tuple(2 if i == 2 * k + offset else 0 for i in range(unknowns))] = ONE
        equations.append(circle)
    jacobian = _without_denominators(_substitute(system, determinant(system), parameters))
    return SliceSystem(tuple(equations), jacobian, tuple(boundary), unknowns)


def first_minor(system: ParametricSystem, parameters: Mapping[str, Ratio]) -> UnknownPolynomial:
    """H11 on a slice, up to a factor that vanishes only on the slice's ``boundary``.

    Raises
    ------
    DimensionError
        When the system does not have two angles: then its sign does not distinguish minima from maxima.
    """
    require_two_angles(system, "the curve on which minima and maxima could change places")
    return _without_denominators(_substitute(system, system.hessian[0][0], parameters))


def determinant(system: ParametricSystem) -> TrigonometricPolynomial:
    """The determinant of the Hessian as a trigonometric polynomial in the parameters."""
    rows = [list(row) for row in system.hessian]
    return system.ring.reduce(_leibniz(rows))


def _leibniz(rows: list[list[TrigonometricPolynomial]]) -> TrigonometricPolynomial:
    if len(rows) == 1:
        return rows[0][0]
    total = 0 * rows[0][0]
    for k, entry in enumerate(rows[0]):
        minor = _leibniz([row[:k] + row[k + 1 :] for row in rows[1:]])
        total += entry * minor if k % 2 == 0 else -entry * minor
    return total


def _substitute(
    system: ParametricSystem, p: TrigonometricPolynomial, parameters: Mapping[str, Ratio]
) -> dict[tuple[int, ...], Ratio]:
    values = [parameters[name] for name in system.ring.parameters]
    result: dict[tuple[int, ...], Ratio] = {}
    for monomial, part in system.ring.split(p).items():
        total: Ratio = (ZERO, ONE)
        for exponents, coefficient in part.items():
            numerator, denominator = ONE * int(coefficient.p), ONE * int(coefficient.q)
            for value, e in zip(values, exponents, strict=True):
                if e:
                    numerator, denominator = numerator * value[0] ** e, denominator * value[1] ** e
            total = add_ratios(total, ratio(numerator, denominator))
        if not total[0].is_zero():
            result[monomial] = total
    return result


def _cleared(p: dict[tuple[int, ...], Ratio]) -> tuple[UnknownPolynomial, list[Coefficient]]:
    """p without denominators and common factors; and the nonconstant polynomials by which it was scaled."""
    scaled = _without_denominators(p)
    common = common_factor(scaled.values())
    removed = [q for q in (lcm(d for _, d in p.values()), common) if not q.is_constant()]
    return {m: c / common for m, c in scaled.items()}, removed


def _without_denominators(p: dict[tuple[int, ...], Ratio]) -> UnknownPolynomial:
    scale = lcm(d for _, d in p.values())
    return {m: n * (scale / d) for m, (n, d) in p.items()}


def at_point(
    system: ParametricSystem, values: Mapping[str, fmpq]
) -> tuple[tuple[RationalPolynomial, ...], tuple[tuple[RationalPolynomial, ...], ...]]:
    """Gradient and Hessian with rational numbers for the parameters, exactly and with their true signs."""
    return (
        tuple(_specialised(system, g, values) for g in system.gradient_terms),
        tuple(tuple(_specialised(system, h, values) for h in row) for row in system.hessian_terms),
    )


def polynomial_at(
    system: ParametricSystem, p: TrigonometricPolynomial, values: Mapping[str, fmpq]
) -> RationalPolynomial:
    """Any element of the system's ring with rational numbers for the parameters, exactly."""
    return _specialised(system, _terms(system.ring, p), values)


def _specialised(system: ParametricSystem, terms: Terms, values: Mapping[str, fmpq]) -> RationalPolynomial:
    numbers = [values[name] for name in system.ring.parameters]
    result: RationalPolynomial = {}
    for monomial, part in terms:
        total = fmpq(0)
        for powers, coefficient in part:
            term = coefficient
            for k, e in powers:
                term = term * numbers[k] ** e
            total += term
        if total:
            result[monomial] = total
    return result
