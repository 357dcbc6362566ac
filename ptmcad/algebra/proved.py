"""The quotient at a point by a Groebner basis that msolve has found, with a proof that it is the
equations' own.

Guarantee: exact, whatever msolve answers. The equations are zero in the quotient that its basis
describes and the matrices of multiplication commute, so no solution was added; the basis lies in
the ideal (`ptmcad.algebra.membership`), so none was lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from time import monotonic

from flint import fmpq, fmpq_mat

from ptmcad.algebra.fibre_algebra import (
    FibreAlgebra,
    bezout_bound,
    fibre_of_rules,
)
from ptmcad.algebra.groebner import divides, grevlex_key, powers_of
from ptmcad.algebra.membership import RationalPolynomial, Rules, lies_in_ideal
from ptmcad.algebra.msolve import MsolveError, Terms, groebner_basis
from ptmcad.algebra.polynomials import Monomial, integral
from ptmcad.algebra.quotient_algebra import standard_monomials
from ptmcad.algebra.resultants import Check
from ptmcad.errors import LimitReached


def quotient_by_msolve(
    equations: Sequence[RationalPolynomial],
    unknowns: int,
    seconds: float,
    largest: int | None = None,
) -> FibreAlgebra:
    """The quotient by a basis that msolve has found, with proof that it is the quotient by the
    equations.

    Parameters
    ----------
    seconds : for msolve, and for the proof.
    largest : number of solutions with multiplicity that is wanted; None for any.

    Raises
    ------
    MsolveError
        When msolve gives no basis in time, or it is not proved to be one: then it may be right or
        wrong. Also where the quotient by it is not finite: nothing that is claimed then is proved
        here.
    LimitReached
        When there are more solutions than wanted, as far as msolve is right.
    """
    elements = groebner_basis([_text(e) for e in equations], unknowns, seconds)
    rules = _rules(elements)
    try:
        basis = standard_monomials(tuple(rules), unknowns, bezout_bound(equations))
    except LimitReached:
        raise MsolveError(
            "msolve's basis has more solutions than Bezout's theorem allows"
        ) from None
    if basis is None:
        raise MsolveError("msolve's basis is of infinitely many solutions, which is not proved")
    staircase = frozenset(basis)
    if any(m not in staircase for tail in rules.values() for m in tail):
        raise MsolveError("msolve's basis is not reduced")
    if largest is not None and len(basis) > largest:
        raise LimitReached(
            f"there are {len(basis)} solutions with multiplicity, more than are counted at once"
        )
    algebra = fibre_of_rules(rules, basis, unknowns)
    pause = _clock(seconds)
    _check_quotient(equations, algebra, pause)
    if not lies_in_ideal(equations, rules, basis, pause):
        raise MsolveError(
            "msolve's basis is not proved to lie in the ideal of the equations: it may miss solutions"
        )
    return algebra._replace(by_msolve=True)


def _clock(seconds: float) -> Check:
    end = monotonic() + seconds

    def pause() -> None:
        if monotonic() > end:
            raise MsolveError(f"msolve's basis was not proved within {seconds:g} s")

    return pause


def _text(p: RationalPolynomial) -> str:
    """An equation for msolve, with integer coefficients."""
    powers = ("".join(f"*u{k}^{e}" for k, e in enumerate(m) if e) for m in p)
    terms = [f"{c}{power}" for c, power in zip(integral(p.values())[0], powers, strict=True)]
    return "+".join(terms).replace("+-", "-")


def _rules(elements: Sequence[Terms]) -> Rules:
    """Each element's leading monomial to what it is equal to.

    Raises
    ------
    MsolveError
        When these are no elements of a reduced basis.
    """
    rules: dict[Monomial, dict[Monomial, fmpq]] = {}
    for p in elements:
        if not p:
            raise MsolveError("msolve's basis has the element 0")
        lead = max(p, key=grevlex_key)
        rules[lead] = {m: c / -p[lead] for m, c in p.items() if m != lead}
    reducible = any(a != b and divides(a, b) for a in rules for b in rules)
    if reducible or len(rules) < len(elements):
        raise MsolveError("msolve's basis is not reduced")
    return rules


def _check_quotient(
    equations: Sequence[RationalPolynomial], algebra: FibreAlgebra, pause: Check
) -> None:
    """Refuse matrices that do not commute, or in which an equation is not zero.

    Raises
    ------
    MsolveError
        With which it is.
    """
    for a, b in combinations(algebra.multiplication, 2):
        pause()
        if a * b != b * a:
            raise MsolveError(
                "msolve's basis is no Groebner basis: multiplications by two unknowns do not commute"
            )
    if not algebra.dimension:
        return
    one = fmpq_mat(algebra.dimension, 1, [fmpq(int(i == 0)) for i in range(algebra.dimension)])
    value = powers_of(algebra.multiplication, one)
    for equation in equations:
        pause()
        total = one * fmpq(0)
        for m, c in equation.items():
            total = total + value(m) * c
        if any(total.entries()):
            raise MsolveError("msolve's basis is wrong: an equation is not zero at its solutions")
