"""The claims of section 5: horizontal forces, and springs with a free length.

Guarantee: 5.1 by identities in all parameters; 5.2 by exact elimination at single designs, and by boxes of ball
arithmetic that contain one equilibrium each. What needs more than single designs is in `free_springs`.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache

import sympy as sp

from ptmcad.algebra.elimination import Elimination, eliminate
from ptmcad.algebra.signed import SignedSolutions, signed_solutions
from ptmcad.algebra.squared import squared_equations
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Claim, Fact, Outcome, judge, unchecked
from ptmcad.studies.paper.free_lengths import FreeLengthDesign, ProvedEquilibrium, proved_equilibria
from ptmcad.studies.paper.slices import equilibria_at
from ptmcad.studies.paper.symbolic import F3, F4, F3x, F4x, half_angle_equations, k, quadratic_elimination, rho, t1, t2

TWELVE = ("0.96859", "1", "1.00609", "0.2", "-0.1", "-0.1")
"""(rho, L1, L2, l0, F3/k, F4/k) of the witness against six solutions."""
TWENTY_SIX = ("1.20609", "1", "1", "1.01487", "-0.1", "-0.1")
THIRTY = ("0.75609", "1", "1", "1.43487", "0", "0")
ELIMINATED = (Fraction(7, 10), (Fraction(1), Fraction(3, 2)), Fraction(1, 5), (Fraction(-1, 10), Fraction(-1, 10)))
"""rho, rods, l0 and loads over k at which the squared equations are eliminated; the paper does not give its values."""
AT_ELIMINATED = ("0.7", "1", "1.5", "0.2", "-0.1", "-0.1")
WITNESSES = (TWELVE, TWENTY_SIX, THIRTY)


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
def signed_solutions_with(design: tuple[str, ...]) -> SignedSolutions:
    """All solutions with 1/l_i of either sign at a design given by decimals, exact."""
    rho, length1, length2, free, f3, f4 = (Fraction(x) for x in design)
    return signed_solutions((rho, (length1, length2), free, (f3, f4)))


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


def _distance(other: Fraction) -> tuple[int, int, int]:
    """Coefficients of (1 + t2^2)(l1^2 - other^2) at `ELIMINATED`, without common divisor."""
    rho, (_, rod), _, _ = ELIMINATED
    ends = (rho - rod) ** 2 - other**2, (rho + rod) ** 2 - other**2
    scale = math.lcm(*(e.denominator for e in ends))
    low, high = (int(e * scale) for e in ends)
    common = math.gcd(low, high)
    return low // common, 0, high // common


def eliminated_degree() -> Outcome:
    found, solutions = elimination(), signed_solutions_with(AT_ELIMINATED)
    left = found.degree - 2 * found.circle
    simple = dict((e, d) for d, e in found.factors)
    multiple = dict(found.quadratics)
    spring1, spring3 = (multiple.get(_distance(other), 0) for other in (Fraction(0), ELIMINATED[1][0]))
    whole = sum(d * e for d, e in found.factors)
    agrees = (found.degree, found.circle, left) == (328, 56, 272)
    return judge(
        agrees,
        (
            f"at {_WHERE}, exactly: degree {found.degree} = (1 + t2^2)^{found.circle} times degree {left}, which has "
            "squarefree factors (degree, multiplicity) " + ", ".join(map(str, found.factors)),
            f"the multiple factors have no equilibrium: 121 t2^2 + 16, {spring1} times, is l1 = 0, and 32 t2^2 - 3, "
            f"{spring3} times, is l1 = L1 and belongs to the two poses with l3 = 0",
            f"the printed numbers do not fit each other: (1 + t2^2)^56 has degree 112, and 328 - 112 = "
            f"{328 - 112}, not 272. They do if 56 is the degree of the power divided out; and 272 = "
            f"{simple.get(1, 0)} + 2 * {spring1} is what is left without the poses with l3 = 0",
            f"{len(solutions.solutions)} of the {simple.get(1, 0)} simple roots solve the two equations with lengths "
            f"of either sign, the other {solutions.opposed} need opposite signs of l3 in the two: with 1/l_i as "
            f"unknowns there are {solutions.total} complex solutions, {solutions.real} of them real",
        ),
        {
            "degree": found.degree, "exponent": found.circle, "left": left, "factors": tuple(map(str, found.factors)),
            "multiplicity of l1 = 0": spring1, "multiplicity of l3 = 0": spring3,
            "complex solutions": solutions.total, "real solutions": solutions.real, "opposed": solutions.opposed,
            "unsettled": solutions.unsettled,
        },
        corrected=(found.degree, found.circle, left) == (400, 48, 304) and simple.get(1) == 256 and whole == left,
        right="degree 400, divided by (1 + t2^2)^48: 304, of which 256 are simple (at the design named)",
        witness=_WHERE,
    )  # fmt: skip


def spurious() -> Outcome:
    found, solutions, proved = elimination(), signed_solutions_with(AT_ELIMINATED), equilibria_with(AT_ELIMINATED)
    stable = sum(e.stable for e in proved)
    return judge(
        solutions.equilibria < found.real_roots,
        (
            f"at {_WHERE} {solutions.equilibria} of the {found.real_roots} real roots are equilibria: {solutions.real} "
            "solve the equations with lengths of some signs, the others belong to two different signs of l3 or to "
            "l3 = 0",
            f"{len(proved)} equilibria were proved one by one, so these are all; {stable} are stable",
        ),
        {
            "real roots": found.real_roots, "real, any signs": solutions.real, "equilibria": solutions.equilibria,
            "proved": len(proved), "stable": stable,
        },
    )  # fmt: skip


def at_most_six() -> Outcome:
    evidence, facts = [], dict[str, Fact]()
    most = 0
    for design in WITNESSES:
        proved, exact = equilibria_with(design), signed_solutions_with(design)
        stable = [e for e in proved if e.stable]
        tense = sum(e.tense is True for e in stable)
        evidence.append(
            f"at {_text(design)} {exact.equilibria} equilibria by elimination; {len(proved)} are each in a box of "
            "width 2e-9 that Krawczyk's test shows to contain exactly one, "
            f"{len(stable)} of them stable, {tense} of these with every spring longer than l0"
        )
        facts[f"l0 = {design[3]}"] = (exact.equilibria, len(proved), len(stable), tense)
        most = max(most, len(proved))
    few = equilibria_with(AT_ELIMINATED)
    evidence.append(f"{len(few)} at {_WHERE}")
    facts["at the eliminated design"] = len(few)
    numbers = ", ".join(f"{len(equilibria_with(design))} at {_text(design)}" for design in WITNESSES)
    return judge(
        False,  # no number of designs can confirm the claim
        tuple(evidence),
        facts,
        witness=f"equilibria proved: {numbers}" if most > 6 else "",
    )


def _text(design: tuple[str, ...]) -> str:
    return "(rho, L1, L2, l0, F3/k, F4/k) = (" + ", ".join(design) + ")"


CLAIMS = (
    Claim("5.1-terms", "5.1", "the only changes are the additional term 2F3x",
          "Horizontal forces add 2 F3x and 2 F4x to (5) and (6).", horizontal_terms),
    Claim("5.1-nature", "5.1", "a system yielding 6 solutions, of which 1 or 2 are stable",
          "With horizontal forces there are still at most six equilibria, one or two stable.", same_nature),
    Claim("5.2-specialise", "5.2", "parameters must be specified before proceeding",
          "Elimination with free lengths needs numbers for the parameters.",
          unchecked("how far elimination with symbols gets depends on the machine and on patience; here, too, it is "
                    "done at numbers")),
    Claim("5.2-crane", "5.2", "an amazing increase in complexity", "Another mechanism became complicated too.",
          unchecked("a statement about a reference")),
    Claim("5.2-degree-28", "5.2", "their degree is now 28", "After two squarings the equations have degree 28.",
          squared_degree),
    Claim("5.2-degree-328", "5.2", "of degree 328 in t2", "Elimination gives degree 328, or 272 after (1 + t2^2)^56.",
          eliminated_degree),
    Claim("5.2-spurious", "5.2", "to eliminate all spurious solutions",
          "Most real roots of the eliminated polynomial are no equilibria.", spurious),
    Claim("5.2-six", "5.2", "no more than 6 solutions remained", "With free lengths there are at most six equilibria.",
          at_most_six),
    Claim("c-six-free", "conclusions", "no more than 6 solutions were found",
          "With free lengths at most six equilibria.", at_most_six),
)  # fmt: skip
