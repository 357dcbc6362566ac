"""A parametric system: as many equations as unknowns, on circles and lines, such as the equilibria
of a potential.

Guarantee: the equations of a potential, and every Jacobian, are derived by exact differentiation;
nothing is typed in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from flint import fmpq

from ptmcad.algebra.plane_determinants import laplace
from ptmcad.algebra.polynomials import (
    PLANE,
    Coefficient,
    Monomial,
    Ratio,
    Ratios,
    UnivariatePolynomial,
    UnknownPolynomial,
    Values,
    add_ratios,
    common_factor,
    constant_like,
    evaluate,
    from_expression,
    lcm,
    ratio,
)
from ptmcad.algebra.trigonometric_ring import (
    RationalPolynomial,
    TrigonometricPolynomial,
    TrigonometricRing,
)
from ptmcad.model.criterion import Criterion
from ptmcad.text.expressions import Expression

Part = tuple[tuple[tuple[tuple[int, int], ...], fmpq], ...]
"""((parameter number, exponent) pairs, coefficient) for each term of a coefficient."""
Terms = tuple[tuple[Monomial, Part], ...]
"""(exponents of the unknowns, coefficient) for each monomial."""


class ParametricSystem(NamedTuple):
    """As many equations as unknowns, and what is asked of a solution.

    Attributes
    ----------
    ring : Q[parameters][coordinates of the unknowns].
    equations : each is zero at a solution; of a potential its gradient, in the order of the ring's
        unknowns.
    jacobian : their derivatives by the unknowns, row by row; of a potential its Hessian.
    equation_terms, jacobian_terms : the same, sorted for evaluation at many points.
    criterion : what is known of solutions.
    potential : U, in units of force times length, without the work of constant moments, which are
        in the equations alone; None where equations are given, or a moment depends on another
        unknown than its own.
    inequalities : a solution counts where all of them are positive.
    stability : where there is no potential a solution is stable where all of these are positive; of
        a potential the additional conditions of a predicate by which solutions are counted.
    positive : parameters that must be positive (rod lengths and stiffnesses).
    nonnegative : parameters that must not be negative (the base length).
    """

    ring: TrigonometricRing
    equations: tuple[TrigonometricPolynomial, ...]
    jacobian: tuple[tuple[TrigonometricPolynomial, ...], ...]
    equation_terms: tuple[Terms, ...]
    jacobian_terms: tuple[tuple[Terms, ...], ...]
    criterion: Criterion
    potential: TrigonometricPolynomial | None = None
    inequalities: tuple[TrigonometricPolynomial, ...] = ()
    stability: tuple[TrigonometricPolynomial, ...] = ()
    positive: tuple[str, ...] = ()
    nonnegative: tuple[str, ...] = ()

    @property
    def dimension(self) -> int:
        """The number of unknowns."""
        return len(self.ring.unknowns)

    @property
    def is_on_torus(self) -> bool:
        """Whether solutions are the zeros of a vector field on a torus, all of them counted:
        indices add up to zero.
        """
        return not self.ring.reals and not self.inequalities


def from_equations(
    ring: TrigonometricRing, equations: Sequence[TrigonometricPolynomial], **asked: Any
) -> ParametricSystem:
    """A system of equations, one for each of the ring's unknowns.

    Parameters
    ----------
    asked : further attributes of the system.
    """
    jacobian = tuple(
        tuple(ring.reduce(ring.derivative(e, u)) for u in ring.unknowns) for e in equations
    )
    return ParametricSystem(
        ring,
        tuple(equations),
        jacobian,
        tuple(terms_of(ring, e) for e in equations),
        tuple(tuple(terms_of(ring, d) for d in row) for row in jacobian),
        **asked,
    )


def terms_of(ring: TrigonometricRing, p: TrigonometricPolynomial) -> Terms:
    """An element of a system's ring, sorted for evaluation at many points."""
    return tuple(
        (
            monomial,
            tuple(
                (tuple((k, e) for k, e in enumerate(powers) if e), c) for powers, c in part.items()
            ),
        )
        for monomial, part in ring.split(p).items()
    )


class SystemOnAxes(NamedTuple):
    """A system whose parameters are functions of the axes of a slice, a line or a family.

    Attributes
    ----------
    parameters : each as a ratio of polynomials, all in Z[x, y] or all in Z[x, y, z].
    """

    system: ParametricSystem
    parameters: Ratios

    @property
    def equations(self) -> SliceSystem:
        """With polynomial coefficients."""
        return on_slice(self.system, self.parameters)

    @property
    def limits(self) -> list[Coefficient]:
        """What bounds the domain: lengths and stiffnesses that vary, and the parameters'
        denominators.
        """
        names = (*self.system.positive, *self.system.nonnegative)
        limits = [
            *(self.parameters[name][0] for name in names),
            *(below for _, below in self.parameters.values()),
        ]
        return [limit for limit in limits if not limit.is_constant()]

    def values(self, at: Sequence[fmpq]) -> dict[str, fmpq]:
        """The parameters at a rational point; `ZeroDivisionError` where a denominator vanishes
        there.
        """
        return {
            name: evaluate(above, *at) / evaluate(below, *at)
            for name, (above, below) in self.parameters.items()
        }


def on_axes(system: ParametricSystem, expressions: Mapping[str, Expression]) -> SystemOnAxes:
    """The system where its parameters are expressions in two axes."""
    return SystemOnAxes(
        system, {name: from_expression(expressions[name]) for name in system.ring.parameters}
    )


class SliceSystem(NamedTuple):
    """The equations of a slice with polynomial coefficients: what elimination works on.

    Attributes
    ----------
    equations : the system's, each divided by its content and cleared of denominators, then the
        circles cos^2 + sin^2 - 1; exponent vector -> element of Z[x, y].
    jacobian : the Jacobian's determinant, cleared of denominators (these vanish only on
        ``boundary``).
    inequalities, stability : the system's, as far as they are decisive, cleared of denominators in
        the same way.
    boundary : polynomials where the slice's equations lose their meaning: denominators of the
        parameters, and factors common to all coefficients of an equation (there that equation
        vanishes identically).
    vanishing : the second kind of these, one for an equation that has such factors.
    unknowns : the number of coordinates.
    unbounded : those whose poles are all there are.
    is_compact : whether the real solutions stay bounded.
    criterion : for messages.
    """

    equations: tuple[UnknownPolynomial, ...]
    jacobian: UnknownPolynomial
    inequalities: tuple[UnknownPolynomial, ...]
    stability: tuple[UnknownPolynomial, ...]
    boundary: tuple[Coefficient, ...]
    vanishing: tuple[Coefficient, ...]
    unknowns: int
    unbounded: tuple[int, ...]
    is_compact: bool
    criterion: Criterion


def on_slice(system: ParametricSystem, parameters: Ratios) -> SliceSystem:
    """Substitute rational functions of the axes for the parameters.

    Parameters
    ----------
    parameters : every parameter of the ring as numerator and denominator, all in Z[x, y] or all in
        Z[x, y, z].

    Guarantee
    ---------
    Outside the zero set of ``boundary`` the equations have exactly the system's solutions.
    """
    ring = system.ring
    one = _one(parameters)

    def on(p: TrigonometricPolynomial) -> UnknownPolynomial:
        """The element without denominators, which are noted where they may vanish."""
        substituted = _substitute(system, p, parameters)
        boundary.extend(
            q for q in (lcm(d for _, d in substituted.values()),) if not q.is_constant()
        )
        return _without_denominators(substituted)

    boundary: list[Coefficient] = []
    vanishing: list[Coefficient] = []
    equations: list[UnknownPolynomial] = []
    for equation in system.equations:
        scaled = on(equation)
        common = common_factor(scaled.values())
        equations.append({m: c / common for m, c in scaled.items()})
        if not common.is_constant():
            boundary.append(common)
            vanishing.append(common)
    equations += [{m: one * c for m, c in circle.items()} for circle in ring.circles]
    return SliceSystem(
        tuple(equations),
        element_on_slice(system, leading_minor(system, system.dimension), parameters),
        tuple(map(on, system.inequalities)),
        tuple(map(on, system.criterion.decisive(system.stability))),
        tuple(boundary),
        tuple(vanishing),
        ring.width,
        ring.unbounded,
        not ring.reals,
        system.criterion,
    )


def lifted(p: UnknownPolynomial, unknowns: int) -> UnknownPolynomial:
    """A polynomial in the first of so many coordinates as one in all of them."""
    return {(*m, *(0,) * (unknowns - len(m))): c for m, c in p.items()}


def saturated(equations: SliceSystem, condition: UnknownPolynomial) -> SliceSystem:
    """The system of those solutions at which a polynomial does not vanish: its inverse is one more
    coordinate.
    """
    width = equations.unknowns
    more = partial(lifted, unknowns=width + 1)
    some = next(
        (c for p in (condition, *equations.equations) for c in p.values()), PLANE.constant(0)
    )
    inverse = {(*m, 1): c for m, c in lifted(condition, width).items()} | {
        (0,) * (width + 1): constant_like(some, -1)
    }
    return equations._replace(
        equations=(*map(more, equations.equations), inverse),
        jacobian=more(equations.jacobian),
        inequalities=tuple(map(more, equations.inequalities)),
        stability=tuple(map(more, equations.stability)),
        unknowns=width + 1,
    )


def leading_minor(system: ParametricSystem, order: int) -> TrigonometricPolynomial:
    """A leading principal minor of the Jacobian, or its determinant.

    Of a Hessian the minors' signs tell the index where none of them is zero (Jacobi).
    """
    return system.ring.reduce(laplace([row[:order] for row in system.jacobian[:order]]))


ALONG, OVER = "<along>", "<over>"
"""The parameter and the further unknown of `with_root`; no unknown has such a name."""


def with_root(
    system: ParametricSystem, parameters: Ratios, along: int, minimal: UnivariatePolynomial
) -> ParametricSystem:
    """The system on the lines of a slice at the roots of a polynomial, which are one more unknown,
    the last one.

    Nothing is divided out: an equation that vanishes all over such a line stays zero there.
    Stability is a matter of conditions, those of the potential's Hessian by its leading minors.

    Parameters
    ----------
    parameters : each as a ratio of polynomials in Z[x, y], the slice's axes.
    along : the number of the axis that varies on the lines, the system's one parameter.
    """
    ring = TrigonometricRing((ALONG,), system.ring.angles, (*system.ring.reals, OVER))
    one = _one(parameters)

    def moved(p: TrigonometricPolynomial, is_condition: bool = False) -> TrigonometricPolynomial:
        terms = _substitute(system, p, parameters)
        scale = lcm(d for _, d in terms.values())
        found: RationalPolynomial = {}
        for monomial, (numerator, denominator) in terms.items():
            # times the denominator's square where the sign matters
            cleared = numerator * (scale / denominator) * (scale if is_condition else one)
            for powers, c in cleared.terms():
                found[(int(powers[along]), *monomial, int(powers[1 - along]))] = fmpq(c)
        return ring.context.from_dict(found)

    minors = tuple(leading_minor(system, order + 1) for order in range(system.criterion.order))
    root = {(*(0,) * ring.width, k): fmpq(c) for k, c in enumerate(minimal.coeffs())}
    return from_equations(
        ring,
        [*map(moved, system.equations), ring.context.from_dict(root)],
        inequalities=tuple(moved(p, True) for p in system.inequalities),
        stability=tuple(moved(p, True) for p in minors + system.stability),
        criterion=system.criterion.on_lines,
    )


def _one(parameters: Ratios) -> Coefficient:
    """The one of the parameters' ring."""
    return next(
        (constant_like(numerator, 1) for numerator, _ in parameters.values()), PLANE.constant(1)
    )


def element_on_slice(
    system: ParametricSystem, p: TrigonometricPolynomial, parameters: Ratios
) -> UnknownPolynomial:
    """An element of the system's ring on a slice, up to a factor that vanishes only on its
    ``boundary``.
    """
    return _without_denominators(_substitute(system, p, parameters))


def _substitute(
    system: ParametricSystem, p: TrigonometricPolynomial, parameters: Ratios
) -> dict[Monomial, Ratio]:
    one = _one(parameters)
    values = [parameters[name] for name in system.ring.parameters]
    result: dict[Monomial, Ratio] = {}
    for monomial, part in system.ring.split(p).items():
        total: Ratio = (0 * one, one)
        for exponents, coefficient in part.items():
            numerator, denominator = one * int(coefficient.p), one * int(coefficient.q)
            for value, e in zip(values, exponents, strict=True):
                if e:
                    numerator, denominator = numerator * value[0] ** e, denominator * value[1] ** e
            total = add_ratios(total, ratio(numerator, denominator))
        if not total[0].is_zero():
            result[monomial] = total
    return result


def _without_denominators(p: dict[Monomial, Ratio]) -> UnknownPolynomial:
    scale = lcm(d for _, d in p.values())
    return {m: n * (scale / d) for m, (n, d) in p.items()}


def at_point(
    system: ParametricSystem, values: Values
) -> tuple[tuple[RationalPolynomial, ...], tuple[tuple[RationalPolynomial, ...], ...]]:
    """Equations and Jacobian with rational numbers for the parameters, exactly and with their true
    signs.
    """
    return (
        tuple(_specialised(system, e, values) for e in system.equation_terms),
        tuple(tuple(_specialised(system, d, values) for d in row) for row in system.jacobian_terms),
    )


def polynomial_at(
    system: ParametricSystem, p: TrigonometricPolynomial, values: Values
) -> RationalPolynomial:
    """Any element of the system's ring with rational numbers for the parameters, exactly."""
    return _specialised(system, terms_of(system.ring, p), values)


def _specialised(system: ParametricSystem, terms: Terms, values: Values) -> RationalPolynomial:
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
