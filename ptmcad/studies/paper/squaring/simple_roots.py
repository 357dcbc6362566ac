"""The simple roots of the resultant of the squared equations, with a proof that no solution is at the others.

Guarantee: at every other root t2 no pose satisfies the equations with l1, l2 and l3 not zero, except for the flat poses
of a design without loads, which are counted apart; a design of which this is not shown is refused.
"""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product

from flint import fmpz_poly

from ptmcad.algebra.elimination import squarefree_factors
from ptmcad.algebra.polynomials import Coefficient, coefficients_in
from ptmcad.algebra.real_roots import squarefree_part
from ptmcad.algebra.resultants import resultant
from ptmcad.studies.paper.squaring.signed import SignedEquations, complex_roots, value_at, vanishes
from ptmcad.text.balls import ball_of

_CIRCLE = fmpz_poly([1, 0, 1])


class SpecialDesignError(ArithmeticError):
    """The resultant of a design has other multiple factors than those that are understood."""


def simple_part(
    eliminated: fmpz_poly,
    first: Coefficient,
    second: Coefficient,
    base: Fraction,
    rods: tuple[Fraction, Fraction],
    unloaded: bool,
) -> fmpz_poly:
    """The simple roots; that no solution belongs to the others, flat poses excepted, is proved."""
    rest = eliminated
    while not (division := divmod(rest, _CIRCLE))[1]:  # no angle has t2^2 = -1
        rest = division[0]
    simple = fmpz_poly([1])
    for factor, multiplicity in squarefree_factors(rest):
        if multiplicity == 1:
            if unloaded and factor[0] == 0:
                raise SpecialDesignError("the flat poses are no multiple root")
            simple = factor
            continue
        # v1 does not exist where l1 = 0
        left = factor // factor.gcd(_distance(base, rods[1], Fraction(0)))
        cone = left.gcd(_distance(base, rods[1], rods[0]))
        if cone.degree() > 0 and not _spring_three_vanishes(cone, first, second, base, rods):
            raise SpecialDesignError("a solution shares t2 with a pose at which l3 = 0")
        left //= cone
        if unloaded:
            left //= left.gcd(fmpz_poly([0, 1]))
        if left.degree() > 0:
            raise SpecialDesignError(f"a factor of degree {left.degree()} and multiplicity {multiplicity}")
    return simple


def _distance(base: Fraction, rod: Fraction, other: Fraction) -> fmpz_poly:
    """(1 + t^2) (l^2 - other^2) in t = tan(th/2), l reaching from the end of a rod to the other rod's joint."""
    ends = (base - rod) ** 2 - other**2, (base + rod) ** 2 - other**2
    scale = math.lcm(*(e.denominator for e in ends))
    return fmpz_poly([int(ends[0] * scale), 0, int(ends[1] * scale)])


def _spring_three_vanishes(
    cone: fmpz_poly, first: Coefficient, second: Coefficient, base: Fraction, rods: tuple[Fraction, Fraction]
) -> bool:
    """Whether l3 = 0 at all common zeros of the squared equations at the roots t2 of ``cone``; False when unclear.

    At such t2 A4 is as far from A1 as A3 is, so l3^2 has a double root t1 there. Both equations vanish at it. It is the
    only common root where l3^2 can vanish; elsewhere one of the equations has to be nonzero.
    """
    over = [fmpz_poly([c]) for c in cone.coeffs()]
    norms = (resultant(over, coefficients_in(p, 1)) for p in (first, second))
    candidates = squarefree_part(next(norms).gcd(next(norms)))
    rows = coefficients_in(first, 0), coefficients_in(second, 0)
    equations = SignedEquations(*(ball_of(x) for x in (base, *rods, *(Fraction(0),) * 3)))
    for t2 in complex_roots(cone):
        if all(value_at(row[-1], t2).contains(0) for row in rows):
            return False  # a common root may be infinite
        vanishing = 0
        for t1 in complex_roots(candidates):
            if equations.squares(t1, t2)[2].contains(0):
                vanishing += 1
            elif all(vanishes([value_at(c, t2) for c in row], t1) for row in rows):
                return False
        if vanishing != 1:
            return False
    return True


def flat_poses(base: Fraction, rods: tuple[Fraction, Fraction], free: Fraction) -> int:
    """The poses with both sines zero at which no length is; unloaded, no other solution has sin th2 = 0.

    With s2 = 0 and no loads E2 says m3 s1 = 0. Where s1 is not zero m3 and then m2 vanish: l2^2 = l3^2 = l0^2.
    """
    length1, length2 = rods
    for end in (base - length2, base + length2):  # A4 is on the axis
        cosines = {
            (x * x + length1 * length1 - free * free) / (2 * x * length1) if x else None for x in (base, end)
        }  # fmt: skip
        if len(cosines) == 1 or None in cosines:
            raise SpecialDesignError(
                "two springs are as long as l_0 in a pose with a sine of zero, or a rod is as long as the base"
            )
    poses = [(length1 * c1, base - length2 * c2) for c1, c2 in product((1, -1), repeat=2)]
    return sum(x4 != 0 and x3 not in (base, x4) for x3, x4 in poses)
