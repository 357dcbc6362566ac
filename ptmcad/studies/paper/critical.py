"""Springs with a free length at one design, by algebra: the equations squared until no root is left,
as section 5.2 does; and the free lengths at which equilibria are degenerate, where folds are.

*Squared equations.* Guarantee: exact polynomials over Q up to a constant; a solution that is listed
is one, with its signs, and of the simple roots of the eliminated polynomial none is left out that is
not counted as unsettled. Of multiple roots, which are poses with a length of zero or, without loads,
flat poses, nothing is said.

With a spring length l_i = sqrt(q_i) each equation is a + b/l + c/l3 = 0, l being that of the spring
at its own rod. The product over the signs of the two roots is a polynomial in the tangents t1, t2
of the half angles, so a simple root t2 of the resultant belongs to one t1 and one choice of signs
in each equation. It solves both, for some signs of the lengths, where they choose the same sign of
l3; with all signs positive it is an equilibrium.

*Critical free lengths.* Guarantee, as far as msolve's answer is right: every real l0 != 0 at which some solution with
lengths of some signs is degenerate is enclosed, with the signs; poses with a length of zero are not
among them, they are no folds.

With v_i = 1/l_i of either sign, gradient and Hessian of the potential are polynomials. Solutions
come in pairs: l0 with signs s, and -l0 with signs -s. The number of equilibria also changes where
one is swallowed by the cone l3 = 0, which is no fold.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial
from itertools import product
from typing import Any

import sympy as sp
from flint import acb, acb_poly, arb, ctx, fmpz_poly

from ptmcad.algebra.msolve import MsolveError, real_solutions
from ptmcad.algebra.polynomials import PLANE, Coefficient, coefficients_in
from ptmcad.algebra.resultants import resultant
from ptmcad.studies.byhand import derivatives, on_circle
from ptmcad.studies.paper import statements
from ptmcad.studies.paper.statements import (
    CIRCLES,
    CLEAR,
    HORIZONTAL,
    LENGTHS,
    gradient,
    hessian,
    k,
    l0,
    squares,
    t1,
    t2,
)
from ptmcad.text.balls import ball_of
from ptmcad.text.enclosure import Enclosure

Design = tuple[str, str, str, str, str, str]
"""rho, L1, L2, l0, F3/k and F4/k as decimals or fractions."""
Signs = tuple[int, ...]
"""Of l1, l2 and l3."""
NAMES = (statements.rho, statements.L1, statements.L2, l0, statements.F3, statements.F4)
CIRCLE = fmpz_poly([1, 0, 1])
BITS = 400
TOLERANCE = arb(10) ** -60
"""Radius of the balls; roots that are not distinguished at it are unsettled."""


@dataclass(frozen=True)
class _Elimination:
    """Both equations at a design, squared, and what eliminating t1 leaves.

    Attributes
    ----------
    degree : of the eliminated polynomial.
    circle : the exponent of its factor 1 + t2^2.
    factors : its other squarefree factors by their multiplicities.
    """

    equations: Sequence[Coefficient]
    degree: int
    circle: int
    factors: Mapping[int, fmpz_poly]

    @property
    def real_roots(self) -> int:
        """The number of different real roots."""
        return sum(root.imag == 0 for p in self.factors.values() for root in _complex_roots(p))


@cache
def squared(design: Design) -> _Elimination:
    """The equations at a design, after two squarings and elimination."""
    numbers = [sp.Rational(x) for x in design]
    # all are lengths, loads over k too: scaling them leaves the angles as they are
    at = dict(zip(NAMES, (x * sp.ilcm(*(x.q for x in numbers)) for x in numbers), strict=True)) | {
        k: 1
    }
    squares, whole = statements.squares(), _cleared(CLEAR, 1)
    equations = []
    for slope, own, other in zip(statements.gradient(), (1, 0), (t2, t1), strict=True):
        g = slope.subs(dict.fromkeys(HORIZONTAL, 0))
        parts = (
            g.subs(l0, 0),
            g.coeff(LENGTHS[own], -1),
            g.coeff(LENGTHS[2], -1),
            squares[own],
            squares[2],
        )
        a, b, c, q, q3 = (_cleared(part.subs(at), CLEAR) for part in parts)
        inner = a**2 * q * q3 - whole * (b**2 * q3 + c**2 * q)
        # the angle that a and the own spring's length have not in common was cleared once too often
        norm = (inner**2 - 4 * whole**2 * b**2 * c**2 * q * q3).exquo(
            _cleared((1 + other**2) ** 2, 1)
        )
        equations.append(PLANE.from_dict({powers: int(x) for powers, x in norm.terms()}))
    first, second = (coefficients_in(p, 0) for p in equations)
    polynomial = resultant(first, second)
    circle, factors = 0, dict[int, fmpz_poly]()
    for p, exponent in polynomial.factor()[1]:
        if p == CIRCLE:
            circle = exponent
        else:
            factors[exponent] = factors.get(exponent, fmpz_poly([1])) * p
    return _Elimination(equations, int(polynomial.degree()), circle, dict(sorted(factors.items())))


def _cleared(expression: Any, factor: Any) -> Any:
    return sp.Poly(sp.cancel(statements.half_angles(expression) * factor), t1, t2, domain="QQ")


# ---------------------------------------------------------------------------------------------- which roots solve both


@dataclass(frozen=True, slots=True)
class _SignedSolutions:
    """What the simple roots are.

    Attributes
    ----------
    solutions : t1 and t2, real or complex, with the signs of l1, l2 and l3.
    opposed : at so many the two equations need opposite signs of l3.
    unsettled : of so many, none of them real, it was not decided.
    """

    solutions: tuple[tuple[acb, acb, Signs], ...]
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
def signed_solutions(design: Design) -> _SignedSolutions:
    """Which of the simple roots at a design solve both equations, with lengths of some signs.

    Raises
    ------
    ArithmeticError
        When a real root is not settled.
    """
    system = squared(design)
    found, opposed, unsettled = [], 0, 0
    with ctx.workprec(BITS):
        values = dict(zip(map(str, NAMES), (ball_of(Fraction(x)) for x in design), strict=True))
        values |= {
            f"{name}{n}": x for name, x in (("k", arb(1)), ("l0_", values["l0"])) for n in (1, 2, 3)
        }
        rows = [coefficients_in(p, 0) for p in system.equations]
        for t2 in _complex_roots(system.factors.get(1, fmpz_poly([1]))):
            t1 = _common_root(*([acb_poly(c)(t2) for c in row] for row in rows))
            zeros = [] if t1 is None else _vanishing(values, (t1, t2))
            if t1 is None or any(
                len(signs) != 2 for signs in zeros
            ):  # the other own length has either sign
                unsettled += 1
                if t2.imag == 0:
                    raise ArithmeticError("a real root is not settled")
            elif common := set.intersection(*zeros):
                found.append(
                    (t1, t2, common.pop())
                )  # t1 is a rational function of t2, so it is real where t2 is
            else:
                opposed += 1
    return _SignedSolutions(tuple(found), opposed, unsettled)


def _complex_roots(p: fmpz_poly) -> list[acb]:
    """Disjoint balls around the roots, without multiplicities; the imaginary part of a real one is
    exactly 0.
    """
    pairs: Any = p.complex_roots()  # FLINT's stub says otherwise
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


def _vanishing(values: Mapping[str, Any], tangents: Sequence[acb]) -> list[set[Signs]]:
    """For each equation the signs of l1, l2 and l3 at which it may hold."""
    circles = list(map(on_circle, tangents))
    zeros: list[set[Signs]] = [set(), set()]
    for signs in product((1, -1), repeat=3):
        # any continuous choice of the roots serves: both signs are tried
        slopes, _ = derivatives(values, circles, partial(_root, iter(signs)))
        for found, slope in zip(zeros, slopes, strict=True):
            if slope.contains(0):
                found.add(signs)
    return zeros


def _root(signs: Iterator[int], square: acb) -> acb:
    return next(signs) * square.sqrt()


INVERSES = sp.symbols("v1 v2 v3")
UNKNOWNS = (*INVERSES, *CIRCLES[0], *CIRCLES[1], l0)


def critical_system(design: Design) -> tuple[str, ...]:
    """Polynomials in `UNKNOWNS` as text that vanish at the degenerate solutions; l0 of the design
    is left out.
    """
    at = {name: sp.Rational(x) for name, x in zip(NAMES, design, strict=True) if name != l0} | {
        k: 1
    }
    at |= dict.fromkeys(HORIZONTAL, 0)
    at |= {length: 1 / v for length, v in zip(LENGTHS, INVERSES, strict=True)}
    g1, g2, h11, h12, h22 = (e.subs(at) for e in (*gradient(), *hessian()))
    equations = [c**2 + s**2 - 1 for c, s in CIRCLES]
    equations += [v**2 * q.subs(at) - 1 for v, q in zip(INVERSES, squares(), strict=True)]
    equations += [g1, g2, h11 * h22 - h12**2]
    polynomials = (sp.Poly(e, *UNKNOWNS).clear_denoms()[1].primitive()[1] for e in equations)
    return tuple(str(p.as_expr()).replace("**", "^").replace(" ", "") for p in polynomials)


def critical_free_lengths(
    design: Design, timeout: float | None = None
) -> tuple[tuple[Enclosure, tuple[int, ...]], ...]:
    """All critical free lengths with the signs of l1, l2 and l3, ascending; those with positive
    signs are folds.

    Raises
    ------
    MsolveError
        When msolve is not there, takes longer than ``timeout`` seconds, or finds infinitely many
        solutions, as it does without loads where two poses are degenerate along a whole interval.
    """
    found = []
    for box in real_solutions([str(u) for u in UNKNOWNS], critical_system(design), timeout):
        if any(
            low <= 0 <= high for low, high in (*box[:3], box[-1])
        ):  # at l0 = 0 the signs have no meaning
            raise MsolveError("msolve's boxes do not settle a sign")
        found.append((Enclosure(*box[-1]), tuple(1 if low > 0 else -1 for low, _ in box[:3])))
    return tuple(sorted(found, key=lambda c: c[0].center))
