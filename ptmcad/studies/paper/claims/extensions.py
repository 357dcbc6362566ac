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
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Fact, Finding
from ptmcad.studies.paper.free_lengths import FreeLengthDesign, ProvedEquilibrium, proved_equilibria
from ptmcad.studies.paper.slices import equilibria_at
from ptmcad.studies.paper.squaring.equations import squared_equations
from ptmcad.studies.paper.squaring.solutions import SignedSolutions, signed_solutions
from ptmcad.studies.paper.symbolic import F3, F4, F3x, F4x, half_angle_equations, k, quadratic_elimination, rho, t1, t2

TWELVE = ("0.96859", "1", "1.00609", "0.2", "-0.1", "-0.1")
"""(rho, L1, L2, l0, F3/k, F4/k) of the witness against six solutions."""
TWENTY_SIX = ("1.20609", "1", "1", "1.01487", "-0.1", "-0.1")
THIRTY = ("0.75609", "1", "1", "1.43487", "0", "0")
ELIMINATED = (Fraction(7, 10), (Fraction(1), Fraction(3, 2)), Fraction(1, 5), (Fraction(-1, 10), Fraction(-1, 10)))
"""rho, rods, l0 and loads over k at which the squared equations are eliminated; the paper does not give its values."""
AT_ELIMINATED = ("0.7", "1", "1.5", "0.2", "-0.1", "-0.1")
WITNESSES = (TWELVE, TWENTY_SIX, THIRTY)


def horizontal_terms() -> Finding:
    ours = [k * e for e in half_angle_equations()]

    def agrees(sign3: int, sign4: int) -> bool:
        wanted = printed.with_horizontal_forces(sign3, sign4)
        return all(bool(sp.expand(a - b) == 0) for a, b in zip(ours, wanted, strict=True))

    facts = {"+F3x, +F4x": agrees(1, 1), "+F3x, -F4x": agrees(1, -1), "-F3x, +F4x": agrees(-1, 1)}
    return Finding(agrees(1, 1), facts, corrected=agrees(1, -1))


def same_nature() -> Finding:
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
    return Finding(
        degree == 6 and allowed and (cancelled != 0),
        {
            "degree": degree,
            "counts": tuple(f"{f.total},{f.stable}" for f in found.values()),
            "cancelled": bool(cancelled == 0),
        },
        corrected=degree == 6 and allowed,
        said={"counts listed": "; ".join(f"{n}: ({f.total}, {f.stable})" for n, f in found.items())},
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
    return proved_equilibria(FreeLengthDesign(*map(Fraction, design)))


def squared_degree() -> Finding:
    found = elimination()
    return Finding(
        found.total_degrees == (28, 28),
        {"total degrees": found.total_degrees, "in t1, t2": (*found.bidegrees[0], *found.bidegrees[1])},
        said={"bidegrees": found.bidegrees},
    )


def _distance(other: Fraction) -> tuple[int, int, int]:
    """Coefficients of (1 + t2^2)(l1^2 - other^2) at `ELIMINATED`, without common divisor."""
    rho, (_, rod), _, _ = ELIMINATED
    ends = (rho - rod) ** 2 - other**2, (rho + rod) ** 2 - other**2
    scale = math.lcm(*(e.denominator for e in ends))
    low, high = (int(e * scale) for e in ends)
    common = math.gcd(low, high)
    return low // common, 0, high // common


def eliminated_degree() -> Finding:
    found, solutions = elimination(), signed_solutions_with(AT_ELIMINATED)
    left = found.degree - 2 * found.circle
    simple = dict((e, d) for d, e in found.factors)
    multiple = dict(found.quadratics)
    spring1, spring3 = (multiple.get(_distance(other), 0) for other in (Fraction(0), ELIMINATED[1][0]))
    whole = sum(d * e for d, e in found.factors)
    agrees = (found.degree, found.circle, left) == (328, 56, 272)
    return Finding(
        agrees,
        {
            "degree": found.degree,
            "exponent": found.circle,
            "left": left,
            "factors": tuple(map(str, found.factors)),
            "multiplicity of l1 = 0": spring1,
            "multiplicity of l3 = 0": spring3,
            "complex solutions": solutions.total,
            "real solutions": solutions.real,
            "opposed": solutions.opposed,
            "unsettled": solutions.unsettled,
        },
        corrected=(found.degree, found.circle, left) == (400, 48, 304) and simple.get(1) == 256 and whole == left,
        said={
            "factors listed": ", ".join(map(str, found.factors)),
            "rest": 328 - 112,
            "simple": simple.get(1, 0),
            "solved": len(solutions.solutions),
        },
    )


def spurious() -> Finding:
    found, solutions, proved = elimination(), signed_solutions_with(AT_ELIMINATED), equilibria_with(AT_ELIMINATED)
    stable = sum(e.stable for e in proved)
    return Finding(
        solutions.equilibria < found.real_roots,
        {
            "real roots": found.real_roots,
            "real, any signs": solutions.real,
            "equilibria": solutions.equilibria,
            "proved": len(proved),
            "stable": stable,
        },
    )


def at_most_six() -> Finding:
    sentences, facts = [], dict[str, Fact]()
    for design in WITNESSES:
        proved, exact = equilibria_with(design), signed_solutions_with(design)
        stable = [e for e in proved if e.stable]
        tense = sum(e.tense is True for e in stable)
        sentences.append(
            f"at {design_text(design)} {exact.equilibria} equilibria by elimination; {len(proved)} are each in a box "
            "of width 2e-9 that Krawczyk's test shows to contain exactly one, "
            f"{len(stable)} of them stable, {tense} of these with every spring longer than l0"
        )
        facts[f"l0 = {design[3]}"] = (exact.equilibria, len(proved), len(stable), tense)
    facts["at the eliminated design"] = len(equilibria_with(AT_ELIMINATED))
    numbers = {design: len(equilibria_with(design)) for design in WITNESSES}
    listed = ", ".join(f"{number} at {design_text(design)}" for design, number in numbers.items())
    witness = f"equilibria proved: {listed}" if max(numbers.values()) > 6 else ""
    # no number of designs can confirm the claim
    return Finding(False, facts, said={"designs": tuple(sentences), "witness": witness})


def design_text(design: tuple[str, ...]) -> str:
    """A design with the names of its numbers."""
    return "(rho, L1, L2, l0, F3/k, F4/k) = (" + ", ".join(design) + ")"
