"""The claims of section 3.1, and of 3.3 on flat equilibria: the mechanism without loads.

Guarantee: verdicts follow from identities in all parameters; signs under a root are those of products of lengths.
"""

from __future__ import annotations

from fractions import Fraction

import sympy as sp

from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Finding
from ptmcad.studies.paper.slices import equilibria_at, heights
from ptmcad.studies.paper.symbolic import (
    FLAT,
    L1,
    L2,
    UNLOADED,
    VERTICAL,
    Expr,
    c1,
    c2,
    determinant,
    equal,
    gradient,
    hessian,
    k,
    rho,
    s1,
    s2,
)

COS1 = (4 * rho**2 + L1**2 - L2**2) / (4 * rho * L1)
COS2 = (4 * rho**2 + L2**2 - L1**2) / (4 * rho * L2)
"""The angles of the triangle with sides L1, L2, 2 rho at the ends of the side 2 rho."""
FLAT_NAMES = ("(0, 0)", "(0, pi)", "(pi, 0)", "(pi, pi)")


def on_triangle(expression: Expr) -> Expr:
    """An expression at the non-flat equilibria: the triangle's cosines, sines of equal sign with L1 s1 = L2 s2.

    Only even powers of the sines may occur together, so the choice of sign does not matter.
    """
    height = sp.Symbol("height")  # L1 s1 = L2 s2
    reduced = sp.expand(expression.subs({s1: height / L1, s2: height / L2, c1: COS1, c2: COS2}))
    polynomial = sp.Poly(reduced, height)
    square = L1**2 * (1 - COS1**2)
    total = sp.Integer(0)
    for (power,), c in polynomial.terms():
        total += c * square ** (power // 2) * (height if power % 2 else 1)
    return sp.factor(sp.cancel(sp.together(total)))


def equations_7_8() -> Finding:
    holds = all(
        equal(-g.subs(UNLOADED) / (length * k), e)
        for g, length, e in zip(gradient(), (L1, L2), (printed.EQUATION_8, printed.EQUATION_7), strict=True)
    )
    return Finding(holds, {"holds": holds})


def four_flat() -> Finding:
    holds = all(sp.expand(g.subs(UNLOADED).subs(flat)) == 0 for g in gradient() for flat in FLAT)
    return Finding(holds, {"holds": holds})


def flat_determinants() -> dict[str, Expr]:
    """det H at the four flat equilibria without loads."""
    whole = determinant().subs(UNLOADED)
    return {name: sp.factor(whole.subs(flat)) for name, flat in zip(FLAT_NAMES, FLAT, strict=True)}


def singular_flat() -> Finding:
    found = flat_determinants()
    singular = all(d == 0 for d in found.values())
    loaded = tuple(
        name for name, flat in zip(FLAT_NAMES, FLAT, strict=True)
        if all(sp.expand(g.subs(VERTICAL).subs(flat)) == 0 for g in gradient())
    )  # fmt: skip
    near = equilibria_at(L2=1, rho=2, F3="-1/1000", F4="-1/1000")
    resisting = sum(e.center[0] > Fraction(99, 100) for e in near.stable_solutions)
    return Finding(
        singular,
        {
            "determinants": tuple(str(d) for d in found.values()),
            "flat equilibria under vertical load": loaded,
            "stable ones near the flat one under a small load": resisting,
        },
        corrected=all(d != 0 for d in found.values()) and not loaded and resisting == 1,
        said={"determinants listed": "; ".join(f"{n}: {d}" for n, d in found.items())},
    )


def two_more() -> Finding:
    triangle = all(sp.expand(on_triangle(g.subs(UNLOADED))) == 0 for g in gradient())
    absent = equilibria_at(L2="3/2", rho=2).total
    present = equilibria_at(L2="3/2", rho=1).total
    # an obtuse angle: arctan has its values in (-pi/2, pi/2), so it would give th1 - pi in place of th1
    at = {L1: 1, L2: sp.Rational(3, 2), rho: sp.Rational(1, 2)}
    cosine = COS1.subs(at)
    other = {c1: -c1, s1: -s1}
    acute_fails = not all(
        sp.expand(on_triangle(g.subs(UNLOADED).subs(other, simultaneous=True))) == 0 for g in gradient()
    )
    return Finding(
        bool(cosine >= 0),  # whatever Q and R1 are, which the paper does not say, cos(arctan) is positive
        {
            "triangle": triangle,
            "total inside": present,
            "total outside": absent,
            "cosine": str(cosine),
            "arctan fails": acute_fails,
        },
        corrected=triangle and present == 6 and absent == 4 and cosine < 0 and acute_fails,
    )


def parallelogram() -> Finding:
    level = True  # L1 s1 = L2 s2 is how the triangle was put in; that it solves the equations is checked here
    solves = all(sp.expand(on_triangle(g.subs(UNLOADED))) == 0 for g in gradient())
    width = sp.cancel(sp.together(L1 * COS1 - (rho - L2 * COS2)))
    return Finding(solves and level and width == rho, {"solves": solves, "x3 - x4": str(width)})


def always_parallelogram() -> Finding:
    flat = [sp.expand((L1 * c1 - (rho - L2 * c2)).subs(f)) for f in FLAT]
    stable = equilibria_at(L2=1, rho=2).stable_solutions
    is_flat = [heights(e) for e in stable] == [(0, 0)]
    return Finding(
        all(sp.expand(x - rho) == 0 for x in flat),
        {"x3 - x4 flat": tuple(map(str, flat)), "only stable one is flat at L2 = 1, rho = 2": is_flat},
        corrected=is_flat and parallelogram().printed,
        said={"flat": ", ".join(map(str, flat))},
    )


def stable_flat_conditions() -> dict[str, tuple[Expr, Expr]]:
    """H(1,1) and det H at the flat equilibria without loads, factored."""
    h11, whole = hessian()[0].subs(UNLOADED), determinant().subs(UNLOADED)
    return {
        name: (sp.factor(h11.subs(flat)), sp.factor(whole.subs(flat)))
        for name, flat in zip(FLAT_NAMES, FLAT, strict=True)
    }


def three_flat_unstable() -> Finding:
    conditions = stable_flat_conditions()
    # which flat equilibrium is stable at each of four designs, one in each part of the plane
    designs = {"2 rho > L1 + L2": (1, 2), "2 rho < L2 - L1": (3, Fraction(1, 2)),
               "2 rho < L1 - L2": (Fraction(1, 4), Fraction(1, 4)), "between": (1, Fraction(1, 2))}  # fmt: skip
    stable: dict[str, str] = {}
    for name, (length2, base) in designs.items():
        at = {L1: 1, L2: sp.Rational(length2), rho: sp.Rational(base), k: 1}
        good = [n for n, (a, d) in conditions.items() if a.subs(at) > 0 and d.subs(at) > 0]
        stable[name] = ", ".join(good) or "none"
    at_most_one = all("), (" not in s for s in stable.values())
    never = [n for n in FLAT_NAMES if n not in " ".join(stable.values())]
    h11_last = conditions["(pi, pi)"][0]
    always_negative = bool(sp.expand(h11_last + L1 * k * (2 * rho + L2)) == 0)
    return Finding(
        len(never) == 3,
        {"stable": tuple(stable.values()), "never": tuple(never), "(pi, pi) has H(1,1) < 0": always_negative},
        corrected=at_most_one and never == ["(pi, pi)"] and always_negative,
        said={
            "conditions": "; ".join(f"{n}: {a}, {d}" for n, (a, d) in conditions.items()),
            "stable by design": "; ".join(f"{n}: {s}" for n, s in stable.items()),
        },
    )
