"""The claims of section 5: horizontal forces, and springs with a free length.

Guarantee: 5.1 by identities in all parameters; 5.2 by exact elimination at one design, and by boxes of ball arithmetic
that contain one equilibrium each. What needs the fold curve of the free-length problem is not claimed.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

import sympy as sp

from ptmcad.algebra.squared import Elimination, eliminate, squared_equations
from ptmcad.paper import printed
from ptmcad.paper.claim import Claim, Outcome, judge, unchecked
from ptmcad.paper.free_lengths import FreeLengthDesign, ProvedEquilibrium, proved_equilibria
from ptmcad.paper.slices import equilibria_at
from ptmcad.paper.symbolic import F3, F4, F3x, F4x, half_angle_equations, k, quadratic_elimination, rho, t1, t2

TWELVE = ("0.96859", "1", "1.00609", "0.2", "-0.1", "-0.1")
"""(rho, L1, L2, l0, F3/k, F4/k) of the witness against six solutions."""
TWENTY_SIX = ("1.20609", "1", "1", "1.01487", "-0.1", "-0.1")
ELIMINATED = (Fraction(7, 10), (Fraction(1), Fraction(3, 2)), Fraction(1, 5), (Fraction(-1, 10), Fraction(-1, 10)))
"""rho, rods, l0 and loads over k at which the squared equations are eliminated; the paper does not give its values."""


def horizontal_terms() -> Outcome:
    ours = [k * e for e in half_angle_equations()]

    def agrees(sign3: int, sign4: int) -> bool:
        wanted = printed.with_horizontal_forces(sign3, sign4)
        return all(bool(sp.expand(a - b) == 0) for a, b in zip(ours, wanted, strict=True))

    facts = {"+F3x, +F4x": agrees(1, 1), "+F3x, -F4x": agrees(1, -1), "-F3x, +F4x": agrees(-1, 1)}
    return judge(
        agrees(1, 1),
        (
            "the terms are where the paper says, t2^2 t1 and t1 in (5), t1^2 t2 and t2 in (6)",
            "the sign of F4x follows from x4 = rho - L2 cos th2 while x3 = L1 cos th1; in (5) and (6), which have "
            "F3' = F3/k, the horizontal forces too are divided by k",
        ),
        facts,
        corrected=agrees(1, -1),
        right="+ 2 F3x' in (5) and - 2 F4x' in (6), with F3x' = F3x/k, F4x' = F4x/k and x pointing from A1 to A2",
    )


def same_nature() -> Outcome:
    first, second = (e.subs(k, 1) for e in half_angle_equations())
    resultant, _, _ = quadratic_elimination(first, second, t1)
    quotient, remainder = sp.div(sp.Poly(resultant, t2), sp.Poly(1 + t2**2, t2))
    degree = quotient.degree() if remainder.is_zero else -1
    points: dict[str, dict[str, str | int]] = {
        "rho = 7/10, L2 = 3/2, F3x = 5, F4x = -7": {"rho": "7/10", "L2": "3/2", "F3x": 5, "F4x": -7},
        "rho = 3/4, L2 = 1, F3x = F4x = 20": {"rho": "3/4", "L2": 1, "F3x": 20, "F4x": 20},
        "rho = 2, L2 = 1, F3x = -30, F4x = 10": {"rho": 2, "L2": 1, "F3x": -30, "F4x": 10},
    }
    found = {name: equilibria_at(F3=-10, F4=-10, **at) for name, at in points.items()}
    allowed = all((f.total, f.stable) in {(4, 1), (6, 1), (6, 2)} for f in found.values())
    # these forces cancel what the springs at the base do: 2 rho + F3x/k = 2 rho - F4x/k = 0
    cancelled = sp.expand(resultant.subs({F3: 0, F4: 0, F3x: -2 * rho, F4x: 2 * rho}))
    return judge(
        degree == 6 and allowed and cancelled != 0,
        (
            f"with horizontal forces the eliminated polynomial still has degree {degree}, so where there are finitely "
            "many, theorem 1 of docs/method.md holds: 4 equilibria with 1 stable, or 6 with 1 or 2",
            "(total, stable) at " + "; ".join(f"{n}: ({f.total}, {f.stable})" for n, f in found.items()),
            "for F3 = F4 = 0, F3x = -2 k rho, F4x = 2 k rho the polynomial vanishes identically: the horizontal forces "
            "cancel the springs, and every pose with th1 + th2 = 0 or pi is an equilibrium",
        ),
        {
            "degree": degree,
            "counts": tuple(f"{f.total},{f.stable}" for f in found.values()),
            "cancelled": bool(cancelled == 0),
        },
        corrected=degree == 6 and allowed,
        right="at most six, one or two of them stable, where there are finitely many equilibria (there are infinitely "
        "many where F3 = F4 = 0, F3x = -2 k rho, F4x = 2 k rho)",
        witness="L1 = 1, L2 = 3/2, rho = 1, k = 100, F3 = F4 = 0, F3x = -200, F4x = 200",
    )


@lru_cache(maxsize=1)
def elimination() -> Elimination:
    """The elimination of t1 from the squared equations at `ELIMINATED`, exact."""
    return eliminate(*squared_equations(*ELIMINATED))


@lru_cache(maxsize=4)
def equilibria_with(design: tuple[str, ...]) -> tuple[ProvedEquilibrium, ...]:
    """The equilibria that were proved at a design given by decimals."""
    rho, length1, length2, free, f3, f4 = (Fraction(x) for x in design)
    return proved_equilibria(FreeLengthDesign(rho, length1, length2, free, f3, f4))


_WHERE = "rho = 7/10, L1 = 1, L2 = 3/2, l0 = 1/5, F3/k = F4/k = -1/10"


def squared_degree() -> Outcome:
    found = elimination()
    return judge(
        found.total_degrees == (28, 28),
        (
            f"each derivative contains two of the three roots; at {_WHERE} the two squared equations have total "
            "degrees "
            f"{found.total_degrees} in (t1, t2), and degrees {found.bidegrees} in t1 and t2",
        ),
        {"total degrees": found.total_degrees, "in t1, t2": (*found.bidegrees[0], *found.bidegrees[1])},
    )


def eliminated_degree() -> Outcome:
    found = elimination()
    left = found.degree - 2 * found.circle
    simple = dict((e, d) for d, e in found.factors)
    whole = sum(d * e for d, e in found.factors)
    agrees = (found.degree, found.circle, left) == (328, 56, 272)
    return judge(
        agrees,
        (
            f"at {_WHERE}, exactly: degree {found.degree} = (1 + t2^2)^{found.circle} times degree {left}, which has "
            "squarefree factors (degree, multiplicity) " + ", ".join(map(str, found.factors)),
            f"the printed numbers do not fit each other: (1 + t2^2)^56 has degree 112, and 328 - 112 = "
            f"{328 - 112}, not 272",
        ),
        {"degree": found.degree, "exponent": found.circle, "left": left, "factors": tuple(map(str, found.factors))},
        corrected=(found.degree, found.circle, left) == (400, 48, 304) and simple.get(1) == 256 and whole == left,
        right="degree 400, divided by (1 + t2^2)^48: 304, of which 256 are simple (at the design named)",
        witness=_WHERE,
    )


def twelve_to_thirty() -> Outcome:
    found = elimination()
    return unchecked(
        "the paper does not give the values of its parameters",
        f"at {_WHERE} the eliminated polynomial has {found.real_roots} different real roots",
    )()


def at_most_six() -> Outcome:
    twelve, many = equilibria_with(TWELVE), equilibria_with(TWENTY_SIX)
    few = equilibria_with(("0.7", "1", "1.5", "0.2", "-0.1", "-0.1"))

    def text(design: tuple[str, ...]) -> str:
        return "(rho, L1, L2, l0, F3/k, F4/k) = (" + ", ".join(design) + ")"

    return judge(
        False,  # a lower bound can refute the claim but never confirm it
        (
            f"at least {len(twelve)} equilibria, {sum(e.stable for e in twelve)} of them stable, at "
            f"{text(TWELVE)}: each in "
            "a box of width 2e-9 that Krawczyk's test shows to contain exactly one",
            f"at least {len(many)}, {sum(e.stable for e in many)} stable, at {text(TWENTY_SIX)}; {len(few)} at "
            f"{_WHERE}",
        ),
        {
            "at least": len(twelve),
            "stable": sum(e.stable for e in twelve),
            "at least, second witness": len(many),
            "stable, second witness": sum(e.stable for e in many),
            "at the eliminated design": len(few),
        },
        witness=f"{text(TWELVE)} has at least {len(twelve)} equilibria" if len(twelve) > 6 else "",
    )


CLAIMS = (
    Claim("5.1-terms", "5.1", "the only changes are the additional term 2F3x",
          "Horizontal forces add 2 F3x and 2 F4x to (5) and (6).", horizontal_terms),
    Claim("5.1-nature", "5.1", "a system yielding 6 solutions, of which 1 or 2 are stable",
          "With horizontal forces there are still at most six equilibria, one or two stable.", same_nature),
    Claim("5.2-eq17", "5.2", "Eq. (1) becomes", "Equation (17), the potential with free lengths.",
          unchecked("a definition; what follows from it is checked below")),
    Claim("5.2-specialise", "5.2", "parameters must be specified before proceeding",
          "Elimination with free lengths needs numbers for the parameters.", unchecked("a report of what was tried")),
    Claim("5.2-crane", "5.2", "an amazing increase in complexity", "Another mechanism became complicated too.",
          unchecked("a statement about a reference")),
    Claim("5.2-degree-28", "5.2", "their degree is now 28", "After two squarings the equations have degree 28.",
          squared_degree),
    Claim("5.2-degree-328", "5.2", "of degree 328 in t2", "Elimination gives degree 328, or 272 after (1 + t2^2)^56.",
          eliminated_degree),
    Claim("5.2-real", "5.2", "12 to 30 real solutions", "The eliminated polynomial has 12 to 30 real roots.",
          twelve_to_thirty),
    Claim("5.2-six", "5.2", "no more than 6 solutions remained", "With free lengths there are at most six equilibria.",
          at_most_six),
    Claim("5.2-acceptable", "5.2", "verified to be greater than l0", "In an acceptable solution all springs are tense.",
          unchecked("a requirement, not a statement")),
    Claim("5.2-difficult", "5.2", "a classification study as in the case l0 = 0 will be difficult",
          "A classification with free lengths takes long.", unchecked("a forecast of effort")),
    Claim("c-six-free", "conclusions", "no more than 6 solutions were found",
          "With free lengths at most six equilibria.", at_most_six),
)  # fmt: skip
