"""All equilibria at one design with free lengths, as solutions of a system without roots: v_i = 1/l_i of either sign.

Guarantee: every solution that is listed is one, with its signs, and no real one is missing. Complex ones that are not
settled are counted apart; where there are none, no complex solution is missing either.

With v_i^2 l_i^2 = 1 and m_i = 1 - l0 v_i the equations are linear in each v_i,

    E1 = m2 rho s1 + m3 (rho s1 - L2 s12) - f3 c1,    E2 = m1 rho s2 + m3 (rho s2 - L1 s12) - f4 c2,

and an equilibrium is a real solution with all v_i > 0. The squared equations (`squared_equations`) are the products of
E1 over the signs of v2 and v3, and of E2 over those of v1 and v3. So a simple root t2 of their resultant belongs to one
t1 and one choice of signs in each; it is a solution where both choose the same sign of v3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import acb, acb_poly, arb, ctx, fmpq, fmpz_poly

from ptmcad.algebra.polynomials import coefficients_in
from ptmcad.algebra.resultants import resultant
from ptmcad.studies.paper.squaring.equations import squared_equations
from ptmcad.studies.paper.squaring.signed import SignedEquations, complex_roots, value_at, vanishes
from ptmcad.studies.paper.squaring.simple_roots import SpecialDesignError, flat_poses, simple_part
from ptmcad.text.balls import ball_of

BITS = 400
TOLERANCE = fmpq(1, 10**60)
"""Radius of the balls; roots that are not distinguished at it are unsettled."""

Signs = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class SignedSolution:
    """Half-angle tangents and the signs of v1, v2, v3; balls that contain one solution each."""

    t1: acb
    t2: acb
    signs: Signs
    real: bool

    @property
    def equilibrium(self) -> bool:
        """Whether it is a pose of the mechanism: real, with positive lengths."""
        return self.real and self.signs == (1, 1, 1)


@dataclass(frozen=True, slots=True)
class SignedSolutions:
    """All solutions at one design.

    Attributes
    ----------
    solutions : those at simple roots of the resultant.
    opposed : number of simple roots at which the two equations need opposite signs of v3: no solutions.
    unsettled : number of simple roots, none of them real, of which it was not decided.
    flat : number of poses with sin th1 = sin th2 = 0; without loads each is a solution for all eight signs.
    """

    solutions: tuple[SignedSolution, ...]
    opposed: int
    unsettled: int
    flat: int

    @property
    def total(self) -> int:
        """How many complex solutions there are, those that are unsettled left out."""
        return len(self.solutions) + 8 * self.flat

    @property
    def real(self) -> int:
        """How many real solutions there are, over all signs."""
        return sum(s.real for s in self.solutions) + 8 * self.flat

    @property
    def equilibria(self) -> int:
        """How many of the real solutions are poses of the mechanism."""
        return sum(s.equilibrium for s in self.solutions) + self.flat


Design = tuple[Fraction, tuple[Fraction, Fraction], Fraction, tuple[Fraction, Fraction]]
"""base, the rods, l0 and the loads over k, all in one unit; the loads both zero or not both."""


def signed_solutions(design: Design) -> SignedSolutions:
    """All solutions at one design, real and complex.

    Raises
    ------
    SpecialDesignError
        When a multiple root of the resultant is not at l1 = 0, at l3 = 0 or, without loads, at sin th2 = 0; or a real
        root could not be settled.
    """
    with ctx.workprec(BITS):
        problem = _problem(design)
        return _settled(problem, complex_roots(problem.simple))


@dataclass(frozen=True, slots=True)
class _Problem:
    """The simple roots of the resultant, both squared equations by powers of t1, E1 and E2, and the flat poses."""

    simple: fmpz_poly
    rows: tuple[tuple[fmpz_poly, ...], tuple[fmpz_poly, ...]]
    equations: SignedEquations
    flat: int


def _problem(design: Design) -> _Problem:
    base, rods, free, loads = design
    unloaded = not any(loads)
    first, second = squared_equations(base, rods, free, loads)
    rows = tuple(coefficients_in(first, 0)), tuple(coefficients_in(second, 0))
    eliminated = resultant(*rows)
    (a, b), (c, d) = first.degrees(), second.degrees()
    if (a, b, c, d) != (16, 12, 12, 16):
        raise SpecialDesignError("an angle of 180 degrees solves one of the squared equations")
    if not unloaded and eliminated.degree() != a * d + b * c:
        raise SpecialDesignError("t2 is infinite at a solution")
    return _Problem(
        simple_part(eliminated, first, second, base, rods, unloaded),
        rows,
        SignedEquations(*(ball_of(x) for x in (base, *rods, free, *loads))),
        flat_poses(base, rods, free) if unloaded else 0,
    )


def _settled(problem: _Problem, roots: Sequence[acb]) -> SignedSolutions:
    """The solutions at simple roots; of two conjugate ones only one needs to be given, and both are counted."""
    found: list[SignedSolution] = []
    opposed = unsettled = 0
    for t2 in roots:
        real = bool(t2.imag == 0)
        if t2.imag < 0:
            continue
        copies = 1 if real else 2
        t1 = _common_root(*([value_at(c, t2) for c in row] for row in problem.rows))
        signs = problem.equations.signs(t1, t2) if t1 is not None else None
        if t1 is None or signs is None:
            if real:
                raise SpecialDesignError("a real root is not settled")
            unsettled += copies
        elif signs[0][1] != signs[1][1]:
            opposed += copies
        else:
            chosen = (signs[1][0], signs[0][0], signs[0][1])
            # t1 is a rational function of t2, so it is real where t2 is
            found.append(SignedSolution(t1, t2, chosen, real))
            if not real:
                # lengths are the roots with positive real part, so those of conjugates are conjugate
                found.append(SignedSolution(t1.conjugate(), t2.conjugate(), chosen, real))
    return SignedSolutions(tuple(found), opposed, unsettled, problem.flat)


def _common_root(first: Sequence[acb], second: Sequence[acb]) -> acb | None:
    """The only root that two polynomials can have in common; None when it is not clear which."""
    if first[-1].contains(0):  # one of its roots may be infinite
        return None
    try:
        roots = acb_poly(first).roots(arb(TOLERANCE))
    except ValueError:  # not distinguished
        return None
    common = [t for t in roots if vanishes(second, t)]
    return common[0] if len(common) == 1 else None
