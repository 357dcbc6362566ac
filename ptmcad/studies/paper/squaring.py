"""The equations of springs with a free length at one design, squared until no root is left, as section 5.2 does.

Guarantee: exact polynomials over Q up to a constant; a solution that is listed is one, with its signs, and of the
simple roots of the eliminated polynomial none is left out that is not counted as unsettled. Of multiple roots, which
are poses with a length of zero or, without loads, flat poses, nothing is said.

With a spring length l_i = sqrt(q_i) each equation is a + b/l + c/l3 = 0, l being that of the spring at its own rod.
The product over the signs of the two roots is a polynomial in the tangents t1, t2 of the half angles, so a simple root
t2 of the resultant belongs to one t1 and one choice of signs in each equation. It solves both, for some signs of the
lengths, where they choose the same sign of l3; with all signs positive it is an equilibrium.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import product
from typing import Any

import sympy as sp
from flint import acb, acb_poly, arb, ctx, fmpz_poly

from ptmcad.algebra.polynomials import PLANE, Coefficient, coefficients_in
from ptmcad.algebra.resultants import resultant
from ptmcad.studies.paper.symbolic import (
    CLEAR,
    F3,
    F4,
    HORIZONTAL,
    L1,
    L2,
    LENGTHS,
    gradient,
    half_angles,
    k,
    l0,
    rho,
    squares,
    t1,
    t2,
    without,
)

Design = tuple[str, str, str, str, str, str]
"""rho, L1, L2, l0, F3/k and F4/k as decimals or fractions."""
NAMES = (rho, L1, L2, l0, F3, F4)
CIRCLE = fmpz_poly([1, 0, 1])
BITS = 400
TOLERANCE = arb(10) ** -60
"""Radius of the balls; roots that are not distinguished at it are unsettled."""
SPRINGS = ((1, t1), (0, t2))
"""For each equation its own spring, of A2A3 and of A1A4, whose length depends on one angle."""


@dataclass(frozen=True)
class Squared:
    """Both equations at a design: by terms, squared, and with t1 eliminated.

    Attributes
    ----------
    terms : of each equation a, b and c times (1 + t1^2)(1 + t2^2), q of its own spring times 1 + t^2, q3 times both.
    """

    terms: tuple[tuple[Coefficient, ...], ...]
    equations: tuple[Coefficient, Coefficient]

    @cached_property
    def eliminated(self) -> fmpz_poly:
        """What eliminating t1 leaves."""
        first, second = (coefficients_in(p, 0) for p in self.equations)
        return resultant(first, second)

    @cached_property
    def circle(self) -> int:
        """The exponent of the factor 1 + t2^2."""
        return sum(e for p, e in self._factors if p == CIRCLE)

    @cached_property
    def _factors(self) -> list[tuple[fmpz_poly, int]]:
        """The irreducible factors with their multiplicities."""
        return [(p, e) for p, e in self.eliminated.factor()[1]]

    @cached_property
    def factors(self) -> tuple[tuple[fmpz_poly, int], ...]:
        """The squarefree factors but for 1 + t2^2, with their multiplicities."""
        found: dict[int, fmpz_poly] = {}
        for p, e in self._factors:
            if p != CIRCLE:
                found[e] = found.get(e, fmpz_poly([1])) * p
        return tuple((found[e], e) for e in sorted(found))

    @cached_property
    def real_roots(self) -> int:
        """The number of different real roots."""
        return sum(root.imag == 0 for p, _ in self.factors for root in complex_roots(p))


@cache
def squared(design: Design) -> Squared:
    """The equations at a design, after two squarings."""
    numbers = [sp.Rational(x) for x in design]
    # all are lengths, loads over k too: scaling them leaves the angles as they are
    unit = sp.ilcm(*(x.q for x in numbers))
    at = dict(zip(NAMES, (x * unit for x in numbers), strict=True)) | {k: 1}
    d, e = (sp.Poly(1 + t**2, t1, t2, domain="QQ") for t in (t1, t2))
    top = _cleared(squares()[2].subs(at), CLEAR)
    terms, equations = [], []
    for slope, length, (spring, t), own in zip(gradient(), (L1, L2), SPRINGS, (d, e), strict=True):
        g = sp.expand(without(slope, *HORIZONTAL).subs(at) / length.subs(at))
        by_length = [g.coeff(LENGTHS[n], -1) for n in (spring, 2)]
        rest = sp.expand(g - sum(c / LENGTHS[n] for c, n in zip(by_length, (spring, 2), strict=True)))
        a, b, c = (_cleared(part, CLEAR) for part in (rest, *by_length))
        diagonal = _cleared(squares()[spring].subs(at), 1 + t**2)
        inner = a**2 * diagonal * top - b**2 * own * top - c**2 * d * e * diagonal
        terms.append(tuple(map(_in_plane, (a, b, c, diagonal, top))))
        equations.append(_in_plane(inner**2 - 4 * b**2 * c**2 * own * d * e * diagonal * top))
    return Squared(tuple(terms), (equations[0], equations[1]))


def _cleared(expression: Any, factor: Any) -> Any:
    return sp.Poly(sp.cancel(half_angles(expression) * factor), t1, t2, domain="QQ")


def _in_plane(p: Any) -> Coefficient:
    return PLANE.from_dict({powers: int(c) for powers, c in p.terms()})


# ---------------------------------------------------------------------------------------------- which roots solve both


@dataclass(frozen=True, slots=True)
class SignedSolutions:
    """What the simple roots are.

    Attributes
    ----------
    solutions : t1 and t2, real or complex, with the signs of l1, l2 and l3.
    opposed : at so many the two equations need opposite signs of l3.
    unsettled : of so many, none of them real, it was not decided.
    """

    solutions: tuple[tuple[acb, acb, tuple[int, int, int]], ...]
    opposed: int
    unsettled: int

    @property
    def real(self) -> int:
        return sum(t2.imag == 0 for _, t2, _ in self.solutions)

    @property
    def equilibria(self) -> int:
        """How many are real with positive lengths."""
        return sum(t2.imag == 0 and signs == (1, 1, 1) for _, t2, signs in self.solutions)


@cache
def signed_solutions(design: Design) -> SignedSolutions:
    """Which of the simple roots at a design solve both equations, with lengths of some signs.

    Raises
    ------
    ArithmeticError
        When a real root is not settled.
    """
    system = squared(design)
    found, opposed, unsettled = [], 0, 0
    with ctx.workprec(BITS):
        rows = [coefficients_in(p, 0) for p in system.equations]
        for t2 in complex_roots(next((p for p, e in system.factors if e == 1), fmpz_poly([1]))):
            t1 = _common_root(*([acb_poly(c)(t2) for c in row] for row in rows))
            own, other = (_signs(parts, n, t1, t2) for n, parts in enumerate(system.terms))
            if t1 is None or own is None or other is None:
                unsettled += 1
                if t2.imag == 0:
                    raise ArithmeticError("a real root is not settled")
            elif own[1] != other[1]:
                opposed += 1
            else:  # t1 is a rational function of t2, so it is real where t2 is
                found.append((t1, t2, (other[0], own[0], own[1])))
    return SignedSolutions(tuple(found), opposed, unsettled)


def complex_roots(p: fmpz_poly) -> list[acb]:
    """Disjoint balls around the roots, without multiplicities; the imaginary part of a real one is exactly 0."""
    pairs: Any = p.complex_roots()  # pairs; FLINT's stub says otherwise
    return [root for root, _ in pairs]


def _common_root(first: Sequence[acb], second: Sequence[acb]) -> acb | None:
    """The only root that two polynomials can have in common; None when it is not clear which."""
    if first[-1].contains(0):  # one of its roots may be infinite
        return None
    try:
        roots = acb_poly(first).roots(TOLERANCE)
    except ValueError:  # not distinguished
        return None
    common = [t for t in roots if acb_poly(second)(t).contains(0)]
    return common[0] if len(common) == 1 else None


def _signs(parts: Sequence[Coefficient], number: int, t1: acb | None, t2: acb) -> tuple[int, int] | None:
    """The only signs of the two lengths at which an equation can hold; None when it is not clear."""
    if t1 is None:
        return None
    a, b, c, diagonal, top = (_value(p, t1, t2) for p in parts)
    d, e = 1 + t1 * t1, 1 + t2 * t2
    own, third = diagonal / (e if number else d), top / (d * e)
    if any(not q.is_finite() or q.contains(0) for q in (own, third)):
        return None
    b, c = b / own.sqrt(), c / third.sqrt()  # any continuous choice of the roots serves: both signs are tried
    zero = [(i, j) for i, j in product((1, -1), repeat=2) if (a + i * b + j * c).contains(0)]
    return zero[0] if len(zero) == 1 else None


def _value(p: Coefficient, t1: acb, t2: acb) -> acb:
    by_t1: list[acb] = [acb_poly(row)(t2) for row in coefficients_in(p, 0)]
    return acb_poly(by_t1)(t1)
