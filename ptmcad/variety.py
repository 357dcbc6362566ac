"""The discriminant variety of a slice: the curves off which the number of equilibria of each kind is locally constant.

Guarantee: on every connected component of the window minus these curves, and minus a nowhere dense set that no count
feels, the equilibria are nondegenerate and their number and indices are constant.

Why. Over Q(x, y) the equations have finitely many solutions; let N be the norm of the Hessian's determinant J, that is
the product of J over them, and let P collect the poles of the characteristic polynomials of the unknowns. At a point
with P != 0 the solutions at nearby generic points stay bounded, and with N != 0 none of them has J -> 0, so they are
smooth functions there: real ones stay real and apart. The components are tagged CRITICAL (factors of N), INFINITY
(factors of P, where a complex solution leaves every bounded set) and BOUNDARY (there the slice's equations lose their
meaning).

Reference: Lazard & Rouillier, J. Symb. Comp. 42 (2007). N is used in place of the Hermite matrix's determinant because
the latter also vanishes where the monomial basis degenerates; `hermite_determinant` computes it for comparison.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from ptmcad.algebra.groebner import MonomialOrder, groebner_basis
from ptmcad.algebra.polynomials import PLANE, Coefficient, Ratio, irreducible_factors, to_plane
from ptmcad.algebra.quotient import (
    QuotientAlgebra,
    determinant,
    multiplication_denominator,
    norm,
    on_line,
    power_trace_denominators,
    quotient_algebra,
    trace_form,
)
from ptmcad.algebra.window import Interval, nowhere_zero
from ptmcad.errors import DegenerateSliceError, InfiniteSolutionsError
from ptmcad.models.system import ParametricSystem, SliceSystem, on_slice
from ptmcad.plane import PlanePolynomial
from ptmcad.regionmap import Component, Kind


@dataclass(frozen=True, slots=True)
class DiscriminantVariety:
    """The variety's components and the number of complex solutions at a generic point."""

    components: tuple[Component, ...]
    complex_solutions: int


def discriminant_variety(
    system: ParametricSystem,
    parameters: Mapping[str, Ratio],
    window: tuple[Interval, Interval],
    limits: Sequence[Coefficient] = (),
    keep: frozenset[str] = frozenset(),
) -> DiscriminantVariety:
    """The discriminant variety of a slice over a window.

    Parameters
    ----------
    parameters : each parameter as a ratio of polynomials in Z[x, y].
    window : the ranges of x and y.
    limits : further polynomials whose zeros bound the slice's domain (lengths and stiffnesses that vanish).
    keep : names of savings to switch off: ``"no-real-points"`` keeps components that have no point in the window.

    Raises
    ------
    InfiniteSolutionsError, DegenerateSliceError
        When every point of the slice is exceptional.
    """
    equations = on_slice(system, parameters)
    algebra = _algebra(equations)
    jacobian_norm, _ = norm(algebra, equations.jacobian)
    if jacobian_norm.is_zero():
        raise DegenerateSliceError(
            "the slice lies inside the discriminant variety: at every point of it some equilibrium has a singular "
            "Hessian, so no count is stable under a small change; fix or free another parameter"
        )
    found: dict[PlanePolynomial, Component] = {}

    def adopt(factor: Coefficient, kind: Kind, left_out: str = "") -> None:
        polynomial = to_plane(factor)
        if polynomial in found:
            return
        if not left_out and "no-real-points" not in keep and nowhere_zero(factor, *window):
            left_out = "no point in the window"
        found[polynomial] = Component(polynomial, kind, left_out)

    for polynomial in (*equations.boundary, *limits):
        for factor in irreducible_factors(polynomial):
            adopt(factor, Kind.BOUNDARY)
    for factor in irreducible_factors(jacobian_norm):
        adopt(factor, Kind.CRITICAL)
    suspects = [f for f in irreducible_factors(multiplication_denominator(algebra)) if to_plane(f) not in found]
    visible = [f for f in suspects if not nowhere_zero(f, *window)]
    hidden = [f for f in suspects if f not in visible]
    # the costly test is made only for factors that may have a point in the window
    poles = [power_trace_denominators(algebra, k) for k in range(0, equations.unknowns, 2)] if visible else []
    for factor in visible:
        if any(pole.gcd(factor).total_degree() > 0 for pole in poles):
            adopt(factor, Kind.INFINITY)
    for factor in _with_poles_on_a_line(algebra, hidden, equations.unknowns):
        adopt(factor, Kind.INFINITY, "no point in the window")
    order = {Kind.CRITICAL: 0, Kind.INFINITY: 1, Kind.BOUNDARY: 2}
    components = sorted(
        found.values(), key=lambda c: (bool(c.left_out), order[c.kind], len(c.polynomial.terms), c.polynomial.terms)
    )
    return DiscriminantVariety(tuple(components), algebra.dimension)


def _with_poles_on_a_line(algebra: QuotientAlgebra, asked: Sequence[Coefficient], unknowns: int) -> list[Coefficient]:
    """Those of the polynomials asked for on which solutions are seen to have poles, along one line y = a x + b.

    Guarantee: a polynomial that is returned divides the denominator of a power trace. For on the line these
    denominators consist of the factors of the multiplication matrices' denominators, which are pairwise coprime there;
    so a common root with one of them is a pole on that one. Not guaranteed is that none is missed; as they have no
    point in the window, nothing depends on it.
    """
    if not asked:
        return []
    x = PLANE.gens()[0]
    every = irreducible_factors(multiplication_denominator(algebra))
    for slope in range(1, 20):
        line = slope * x + 1000 + slope
        traces = [f.compose(x, line) for f in every]
        coprime = all(p.gcd(q).total_degree() == 0 for p, q in combinations(traces, 2))
        restricted = on_line(algebra, line)
        if coprime and restricted is not None:
            poles = [power_trace_denominators(restricted, k) for k in range(0, unknowns, 2)]
            return [f for f in asked if any(p.gcd(f.compose(x, line)).total_degree() > 0 for p in poles)]
    return []


def _algebra(equations: SliceSystem) -> QuotientAlgebra:
    infinitely_many = InfiniteSolutionsError(
        "at every point of the slice the equations have infinitely many solutions (complex ones included): the loads "
        "and springs leave a motion free; fix or free another parameter"
    )
    if any(not equation for equation in equations.equations):
        raise infinitely_many
    order = MonomialOrder(tuple(range(equations.unknowns)))
    algebra = quotient_algebra(groebner_basis(equations.equations, order))
    if algebra is None:
        raise infinitely_many
    return algebra


def hermite_determinant(system: ParametricSystem, parameters: Mapping[str, Ratio]) -> Ratio:
    """The determinant of the Hermite (trace-form) matrix on the grevlex monomial basis.

    Its numerator has every CRITICAL component as a factor; further factors are places where the monomial basis, not
    the set of solutions, degenerates.
    """
    return determinant(trace_form(_algebra(on_slice(system, parameters))))
