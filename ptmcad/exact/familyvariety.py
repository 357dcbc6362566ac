"""The discriminant variety of a family of slices, over Q(x, y, z): what its members have in common,
computed once.

Guarantee: what `FamilyVariety.at` gives for a member is what `discriminant_variety.nondegenerate` computes for
it alone, up to constant factors; where the computation over Q(x, y, z) does not specialise, it
gives None.

Why. Let A = Z[x, y, z] and G the basis of the ideal I that the equations span, made by
fraction-free arithmetic: sums of multiples of generators with coefficients in A, divided now and
then by a common factor r of all coefficients. At a rational z0 at which neither a leading
coefficient of G nor such a factor vanishes identically in x and y,

* G(z0) lies in the ideal of the equations at z0, as all divisions were by elements that remain
  units over Q(x, y);
* the equations at z0 lie in the ideal of G(z0), and the S-polynomials of G(z0) reduce to zero by
  it: pseudo-division multiplies by leading coefficients only, and what it leaves is zero.

So G(z0) is a Groebner basis of the ideal at z0, with the same leading monomials (Buchberger's
criterion), and it is reduced as G is. The norm is a polynomial in the entries of the multiplication
matrices, and specialises with them.

Reference: Kalkbrener, J. Symb. Comp. 24 (1997), On the stability of Groebner bases under
specializations.
"""

from __future__ import annotations

from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.groebner import GroebnerBasis
from ptmcad.algebra.polynomials import (
    Coefficient,
    Ratio,
    UnknownPolynomial,
    at_third,
    irreducible_factors,
    ratio,
)
from ptmcad.algebra.quotient_algebra import multiples, norm, quotient_algebra
from ptmcad.exact.discriminant_variety import Nondegenerate, basis_of, nondegenerate
from ptmcad.exact.models.system import SliceSystem, SystemOnAxes


class FamilyVariety(NamedTuple):
    """Basis and norm over Q(x, y, z).

    Attributes
    ----------
    basis : of the equations, in grevlex order.
    jacobian : the Jacobian's determinant, cleared of denominators, in Z[x, y, z][unknowns].
    jacobian_norm : its norm.
    units : what must not vanish identically where the basis is to specialise.
    complex_solutions : at a generic point of a generic member.
    """

    basis: GroebnerBasis
    jacobian: UnknownPolynomial
    jacobian_norm: Ratio
    units: tuple[Coefficient, ...]
    complex_solutions: int

    @property
    def critical(self) -> tuple[Coefficient, ...]:
        """The irreducible factors of the norm of the Jacobian: the surfaces on which solutions
        meet.
        """
        return tuple(irreducible_factors(self.jacobian_norm[0]))

    def at(self, value: fmpq, equations: SliceSystem) -> Nondegenerate | None:
        """What is known of a member's equations; None where that has to be computed for the member
        alone.

        Parameters
        ----------
        value : of the third parameter.
        equations : the member's own.
        """
        if any(at_third(unit, value).is_zero() for unit in self.units):
            return None
        elements = tuple(_specialised(g, value) for g in self.basis.elements)
        algebra = quotient_algebra(GroebnerBasis(self.basis.order, elements, self.basis.leading))
        assert algebra is not None  # the leading monomials are those of a zero-dimensional ideal
        numerator, denominator = (at_third(p, value) for p in self.jacobian_norm)
        scale = _scale(equations.jacobian, _specialised(self.jacobian, value))
        if numerator.is_zero() or denominator.is_zero() or scale is None:
            return None
        if any(norm(algebra, p)[0].is_zero() for p in equations.inequalities):
            return None  # there are solutions to be left out first
        above, below = (p**algebra.dimension for p in scale)
        product = ratio(numerator * above, denominator * below)
        return Nondegenerate(equations, algebra, multiples(algebra, equations.jacobian), product)


def family_variety(on: SystemOnAxes) -> FamilyVariety | None:
    """The variety over Q(x, y, z); None where solutions have to be left out that an inequality
    excludes everywhere.

    Parameters
    ----------
    on : the system on the axes x, y and z.

    Raises
    ------
    InfiniteSolutionsError, DegenerateSliceError, NothingToCountError
        When every point of a generic member is exceptional.
    """
    given = on.equations
    found = nondegenerate(given)
    if found.equations.unknowns > given.unknowns:
        return None
    basis = basis_of(given)
    leading = (g[m] for g, m in zip(basis.elements, basis.leading, strict=True))
    units = (*leading, *basis.removed, *given.boundary)
    return FamilyVariety(
        basis,
        given.jacobian,
        found.jacobian_norm,
        tuple(unit for unit in units if not unit.is_constant()),
        found.algebra.dimension,
    )


def _specialised(p: UnknownPolynomial, value: fmpq) -> UnknownPolynomial:
    """A polynomial in the unknowns at a value of the third parameter, up to a positive constant
    factor.
    """
    degree = max((int(c.degrees()[2]) for c in p.values()), default=0)
    found = {m: at_third(c, value, degree) for m, c in p.items()}
    return {m: c for m, c in found.items() if not c.is_zero()}


def _scale(p: UnknownPolynomial, q: UnknownPolynomial) -> Ratio | None:
    """The rational function r with p = r q; None when there is none."""
    if not q or p.keys() != q.keys():
        return None
    monomial = next(iter(q))
    above, below = ratio(p[monomial], q[monomial])
    return (above, below) if all(p[m] * below == above * c for m, c in q.items()) else None
