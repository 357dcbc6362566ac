"""The discriminant variety of a slice: the curves off which the number of solutions of each kind is
locally constant.

Guarantee: on every connected component of the window minus these curves, and minus a nowhere dense
set that no count feels, the solutions are nondegenerate, and their number, indices and the signs of
all conditions are constant.

Why. Over Q(x, y) the equations have finitely many solutions; let N be the norm of the Jacobian's
determinant J, that is the product of J over them, and let P collect the poles of the characteristic
polynomials of the unknowns. At a point with P != 0 the solutions at nearby generic points stay
bounded, and with N != 0 none of them has J -> 0, so they are smooth functions there: real ones stay
real and apart, and a condition changes its sign only where its norm vanishes. The components are
tagged CRITICAL (factors of N), INFINITY (factors of P, where a complex solution leaves every
bounded set; those of them that divide N too are critical on a torus, and at infinity where there
are real unknowns) and BOUNDARY (there the slice's equations lose their meaning, or a condition's
norm vanishes).

Solutions at which an inequality's polynomial vanishes all over the slice never count. They are left
out, by one more unknown, that polynomial's inverse; where the inverse has a pole the norm vanishes.

Reference: Lazard & Rouillier, J. Symb. Comp. 42 (2007). N is used in place of the Hermite matrix's
determinant because the latter also vanishes where the monomial basis degenerates.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

from ptmcad.algebra.bernstein import nowhere_zero
from ptmcad.algebra.groebner import GroebnerBasis, groebner_basis
from ptmcad.algebra.plane_determinants import determinant
from ptmcad.algebra.polynomials import (
    Coefficient,
    Ratio,
    irreducible_factors,
    to_plane,
)
from ptmcad.algebra.quotient_algebra import (
    QuotientAlgebra,
    Vector,
    bounded_away_from_zero,
    matrix_of,
    multiples,
    multiplication_denominator,
    norm,
    poles,
    quotient_algebra,
    trace_form,
)
from ptmcad.algebra.real_roots import Window
from ptmcad.answer.regionmap import HARMLESS, NO_POINT, Component, Kind
from ptmcad.errors import DegenerateSliceError, InfiniteSolutionsError, NothingToCountError
from ptmcad.exact.continua import continuum
from ptmcad.exact.models.system import (
    SliceSystem,
    SystemOnAxes,
    element_on_slice,
    leading_minor,
    lifted,
    saturated,
)
from ptmcad.text.plane import PlanePolynomial


def discriminant_variety(
    on: SystemOnAxes,
    window: Window,
    without: frozenset[str] = frozenset(),
    known: Known | None = None,
) -> tuple[tuple[Component, ...], int, bool]:
    """The discriminant variety of a slice over a window.

    Parameters
    ----------
    on : the system on the axes x and y.
    window : their ranges.
    without : names of savings to switch off, of `ptmcad.question.savings`.
    known : gives for the equations what is known of them from a family that the slice is of, or
        None.

    Returns
    -------
    The components, by kind, number of terms and terms, those left out last; the number of complex
    solutions at a generic point; and whether solutions at which an inequality's polynomial is zero
    were left out, as they are in the way.

    Raises
    ------
    InfiniteSolutionsError, DegenerateSliceError
        When every point of the slice is exceptional.
    """
    given = on.equations
    family = None if known is None else known(given)
    found = nondegenerate(given) if family is None else family
    equations, algebra = found.equations, found.algebra
    outside = partial(_is_outside, window, "no-real-points" not in without)
    limits = irreducible_factors(*equations.boundary, *on.limits)
    singular = irreducible_factors(found.jacobian_norm[0])
    escaping = [] if equations.is_compact else poles(algebra, singular, equations.unbounded)
    critical = [f for f in singular if f not in escaping]
    conditions = irreducible_factors(*sign_changes(equations, algebra))
    superfluous = irreducible_factors(*_superfluous(on, equations, algebra, without))
    parts = (
        (limits, Kind.BOUNDARY, ""),
        (critical, Kind.CRITICAL, ""),
        (escaping, Kind.INFINITY, ""),
        (conditions, Kind.BOUNDARY, ""),
        *_at_infinity(found, [*limits, *singular, *conditions], outside, without),
        (superfluous, Kind.AUXILIARY, ""),
    )
    component_of: dict[PlanePolynomial, Component] = {}
    for factors, kind, why in parts:
        for f in factors:
            polynomial = to_plane(f)
            if polynomial not in component_of:  # the first kind of a curve stands
                left_out = why or (NO_POINT if outside(f) else "")
                where = None if left_out else continuum(f, on, given, found.jacobian_norm[0])
                component_of[polynomial] = Component(polynomial, kind, left_out, continuum=where)
    components = tuple(sorted(component_of.values(), key=_place))
    return components, algebra.dimension, equations.unknowns > given.unknowns


def _is_outside(window: Window, is_tried: bool, factor: Coefficient) -> bool:
    """Whether a curve is seen to have no point in the window."""
    return is_tried and nowhere_zero(factor, window)


def _at_infinity(
    found: Nondegenerate,
    others: Sequence[Coefficient],
    outside: Callable[[Coefficient], bool],
    without: frozenset[str],
) -> Iterator[tuple[list[Coefficient], Kind, str]]:
    """The curves, none of the others, on which complex solutions alone leave every bounded set, by
    why they are left out, if they are.
    """
    equations, algebra = found.equations, found.algebra
    denominator = irreducible_factors(multiplication_denominator(algebra))
    suspects = [f for f in denominator if f not in others]
    hidden = [f for f in suspects if outside(f)]
    visible = [f for f in suspects if f not in hidden]
    # near proved ones the Jacobian's determinant stays away from zero; doubtful are the rest
    tried = visible if settles(equations) and "infinity" not in without else []
    proved = harmless(equations, found.rows, found.jacobian_norm, tried)
    doubtful = [f for f in visible if f not in proved]
    unbounded = poles(algebra, doubtful, equations.unbounded, [*hidden, *proved])
    for factors, why in ((hidden, NO_POINT), (proved, HARMLESS), (doubtful, "")):
        yield [f for f in factors if f in unbounded], Kind.INFINITY, why


def _place(c: Component) -> tuple[Any, ...]:
    return bool(c.left_out), _ORDER[c.kind], len(c.polynomial.terms), c.polynomial.terms


_ORDER = {Kind.CRITICAL: 0, Kind.INFINITY: 1, Kind.BOUNDARY: 2, Kind.AUXILIARY: 3}


def _superfluous(
    on: SystemOnAxes, equations: SliceSystem, algebra: QuotientAlgebra, without: frozenset[str]
) -> Iterator[Coefficient]:
    """What two savings leave out."""
    if "sign-curve" in without:
        for order in range(1, on.system.criterion.order):
            minor = element_on_slice(on.system, leading_minor(on.system, order), on.parameters)
            yield norm(algebra, lifted(minor, equations.unknowns))[0]
    if "hermite-matrix" in without:
        yield from determinant(trace_form(algebra))


def check_hypotheses(on: SystemOnAxes) -> None:
    """Refuse what `discriminant_variety` would refuse, without the curves."""
    equations, algebra, *_ = nondegenerate(on.equations)
    for _ in sign_changes(equations._replace(inequalities=()), algebra):
        pass  # which refuses conditions


class Nondegenerate(NamedTuple):
    """Equations whose solutions over Q(x, y) are simple, with their algebra.

    Attributes
    ----------
    rows : the matrix of multiplication by the Jacobian's determinant.
    jacobian_norm : its determinant.
    """

    equations: SliceSystem
    algebra: QuotientAlgebra
    rows: tuple[Vector, ...]
    jacobian_norm: Ratio


Known = Callable[[SliceSystem], Nondegenerate | None]
"""From a slice's equations to what is known of them without a new basis."""


def nondegenerate(equations: SliceSystem) -> Nondegenerate:
    """The equations, without the solutions that an inequality excludes everywhere if those are in
    the way.

    Raises
    ------
    InfiniteSolutionsError, DegenerateSliceError
        When there are infinitely many solutions everywhere, or some is singular.
    """
    try:
        found = _with_jacobian(equations)
        if not any(norm(found.algebra, p)[0].is_zero() for p in equations.inequalities):
            return found
    except (InfiniteSolutionsError, DegenerateSliceError):
        if not equations.inequalities:
            raise
    for condition in equations.inequalities:
        equations = saturated(equations, condition)
        if not algebra_of(equations).dimension:
            raise NothingToCountError(
                "at every point of the slice each solution, real or complex, makes the left side of an inequality "
                "zero: there is nothing to count"
            )
    return _with_jacobian(equations)


def _with_jacobian(equations: SliceSystem) -> Nondegenerate:
    algebra = algebra_of(equations)
    if not algebra.dimension:
        raise NothingToCountError(
            "off a curve of the slice the equations have no solution, real or complex: there is nothing to count"
        )
    rows = multiples(algebra, equations.jacobian)
    jacobian_norm = determinant(matrix_of(rows))
    if jacobian_norm[0].is_zero():
        raise DegenerateSliceError(
            "the slice lies inside the discriminant variety: at every point of it some "
            f"{equations.criterion.singular}, so no count is stable under a small change; fix or free another parameter"
        )
    return Nondegenerate(equations, algebra, rows, jacobian_norm)


def sign_changes(equations: SliceSystem, algebra: QuotientAlgebra) -> Iterator[Coefficient]:
    """The norms of the conditions, over those solutions at which they are not zero all over the
    slice.

    Raises
    ------
    NothingToCountError
        When a condition for stability is zero at all of them.
    """
    for p in equations.inequalities:
        yield norm(algebra, p)[0]
    for n, p in enumerate(equations.stability, 1):
        product = norm(algebra, p)[0]
        if product.is_zero():  # there solutions with p = 0 are not stable, whatever the others are
            others = algebra_of(saturated(equations, p))
            if not others.dimension:
                raise NothingToCountError(
                    "at every point of the slice this condition's left side is zero at each solution, real or complex: "
                    "none is stable; leave the condition out, or mend it",
                    part=f"stable.{n}",
                )
            product = norm(others, lifted(p, equations.unknowns + 1))[0]
        yield product


def settles(equations: SliceSystem) -> bool:
    """Whether real solutions that stay regular settle everything: they stay bounded, and nothing
    else is asked of them.

    The sign of a condition can change across a curve where its norm does not vanish, at a solution
    that is real there while a complex one leaves every bounded set.
    """
    return equations.is_compact and not equations.inequalities and not equations.stability


def harmless(
    equations: SliceSystem,
    rows: Sequence[Vector],
    jacobian_norm: Ratio,
    suspects: Sequence[Coefficient],
) -> list[Coefficient]:
    """Those of the curves across which no real count can change: near them det H stays away from 0
    at all solutions.

    Real solutions stay bounded, as cosines and sines do; being regular as well, they continue
    across the curve one by one. A second monomial order is tried where the first one's basis
    degenerates.
    """
    proved = [f for f in suspects if bounded_away_from_zero(rows, jacobian_norm, f)]
    for permutation in _OTHER_ORDERS:
        if len(proved) < len(suspects) and len(permutation) == equations.unknowns:
            other = quotient_algebra(groebner_basis(equations.equations, permutation))
            assert other is not None  # the ideal is zero-dimensional in any order
            rows = multiples(other, equations.jacobian)
            proved += [
                f
                for f in suspects
                if f not in proved and bounded_away_from_zero(rows, jacobian_norm, f)
            ]
    return proved


_OTHER_ORDERS = ((2, 0, 3, 1),)
"""Orders of (cos th1, sin th1, cos th2, sin th2); there are none for other numbers of angles, where
less is proved.

Where the first order's basis degenerates, these have not, so far."""


def algebra_of(equations: SliceSystem) -> QuotientAlgebra:
    """The quotient over Q(x, y).

    Raises
    ------
    InfiniteSolutionsError
        When there are infinitely many solutions everywhere.
    """
    infinitely_many = InfiniteSolutionsError(
        "at every point of the slice the equations have infinitely many solutions (complex ones included): "
        f"{equations.criterion.loose}fix or free another parameter"
    )
    if any(not equation for equation in equations.equations):
        raise infinitely_many
    algebra = quotient_algebra(basis_of(equations))
    if algebra is None:
        raise infinitely_many
    return algebra


def basis_of(equations: SliceSystem) -> GroebnerBasis:
    """The reduced basis, in grevlex order of the coordinates as they come."""
    return groebner_basis(equations.equations, tuple(range(equations.unknowns)))
