"""The claims of sections 3.2 and 3.3: equal rods and equal forces.

Guarantee: verdicts follow from identities in L1, rho, k, F4, from exact counts and from isolated roots on fig. 3.
"""

from __future__ import annotations

import sympy as sp

from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Finding
from ptmcad.studies.paper.claims.overall import allowed_and_seen
from ptmcad.studies.paper.slices import equilibria_at, region_map
from ptmcad.studies.paper.symbolic import (
    F4,
    L1,
    SYMMETRIC,
    Expr,
    cleared,
    determinant,
    gradient,
    half_angle_equations,
    half_angles,
    k,
    rho,
    t1,
    t2,
)

OTHER = -(F4 * t2 + 2 * k * rho) / (F4 - 2 * k * rho * t2)
"""t1 by t2 from the second factor of (10)."""


def equations() -> tuple[Expr, Expr]:
    """k times the right (5) and (6) for equal rods and forces."""
    first, second = (sp.expand(k * e.subs(SYMMETRIC)) for e in half_angle_equations())
    return first, second


def one_equation() -> Finding:
    on_diagonal = [sp.expand(e.subs(t1, t2)) for e in equations()]
    same = bool(sp.expand(on_diagonal[0] - on_diagonal[1]) == 0)
    degree = sp.Poly(on_diagonal[0], t2).degree()
    return Finding(same and degree == 4, {"same": same, "degree": degree})


def which_equations() -> Finding:
    unloaded = [e for e in (printed.EQUATION_7, printed.EQUATION_8) if e.has(F4)]
    derived = bool(sp.expand(equations()[0] - equations()[1] - 2 * printed.EQUATION_10) == 0)
    return Finding(
        bool(unloaded), {"equations with a force": len(unloaded), "(10) from (3) and (4)": derived}, corrected=derived
    )


def equation_10() -> Finding:
    first, second = equations()
    holds = bool(sp.expand(first - second - 2 * printed.EQUATION_10) == 0)
    return Finding(holds, {"holds": holds})


def equation_11() -> Finding:
    holds = bool(sp.expand(equations()[1] - printed.EQUATION_11) == 0)
    return Finding(holds, {"holds": holds})


def both_kinds() -> Finding:
    found = equilibria_at(rho="3/4", F3=-10, F4=-10)
    alike = 0
    for e in found.solutions:
        a, b, c, d = e.center
        alike += abs(a - c) <= 2 * e.radius and abs(b - d) <= 2 * e.radius
    return Finding(alike > 0 and found.total > alike, {"total": found.total, "equal angles": alike})


def eliminated_12() -> Expr:
    """The numerator that remains of (11) when the second factor of (10) gives t1, without the factor 1 + t2^2."""
    numerator = sp.numer(sp.together(printed.EQUATION_11.subs(t1, OTHER)))
    quotient, remainder = sp.div(sp.Poly(numerator, t2), sp.Poly(1 + t2**2, t2))
    if not remainder.is_zero:
        raise ArithmeticError("1 + t2^2 does not divide the eliminated polynomial")
    return sp.expand(quotient.as_expr())


def equation_12() -> Finding:
    ratio = sp.cancel(eliminated_12() / printed.EQUATION_12)
    holds = ratio.is_number and ratio != 0
    degree = sp.Poly(printed.EQUATION_12, t2).degree()
    return Finding(bool(holds) and degree == 2, {"ratio": str(ratio), "degree": degree})


def linear_and_swapped() -> Finding:
    denominator_root = F4 / (2 * k * rho)
    no_solution_there = sp.cancel(printed.FACTOR_10.subs(t2, denominator_root))
    regular = bool(sp.expand(no_solution_there * 2 * k * rho - F4**2 - 4 * k**2 * rho**2) == 0)
    swapped = sp.numer(sp.together(printed.EQUATION_12.subs(t2, OTHER)))
    invariant = sp.cancel(swapped / printed.EQUATION_12)
    symmetric = bool(invariant.is_polynomial(t2) and not sp.expand(invariant).has(t2))
    return Finding(regular and symmetric, {"nothing lost": regular, "(12) unchanged": symmetric})


def at_most_two() -> Finding:
    degree = sp.Poly(printed.EQUATION_12, t2).degree()
    leading = sp.factor(sp.Poly(printed.EQUATION_12, t2).LC())
    return Finding(degree == 2, {"degree": degree, "leading": str(leading)})


def four_equal() -> Finding:
    quartic = sp.Poly(printed.EQUATION_11.subs(t1, t2), t2)
    attained = quartic.as_expr().subs({F4: -10, k: 100, L1: 1, rho: sp.Rational(3, 4)})
    real = sp.Poly(attained, t2).count_roots()
    return Finding(
        quartic.degree() == 4 and real == 4, {"degree": quartic.degree(), "real roots": int(real)}, said={"real": real}
    )


def on_unequal(expression: Expr) -> Expr:
    """An expression of the angles at th1 != th2, by t2: the second factor of (10) gives t1."""
    return sp.factor(sp.cancel(sp.together(half_angles(expression.subs(SYMMETRIC)).subs(t1, OTHER))))


def equation_13() -> Finding:
    true = on_unequal(determinant())
    as_printed = bool(sp.cancel(true - printed.DETERMINANT_13) == 0)
    simple = -4 * L1**2 * (k * rho * t2**2 - F4 * t2 - k * rho) ** 2 / (1 + t2**2) ** 2
    right = bool(sp.cancel(true - simple) == 0)
    factor = ((1 + t1**2) * (1 + t2**2)).subs(t1, OTHER) ** 2 / L1**2
    related = bool(sp.cancel(true * factor - printed.DETERMINANT_13) == 0)
    return Finding(
        as_printed,
        {"printed": as_printed, "right": right, "printed is a positive multiple": related},
        corrected=right and related,
        said={"true": true, "checked": "checked" if related else "not so"},
    )


def always_negative() -> Finding:
    true = on_unequal(determinant())
    square = sp.cancel(-true * (1 + t2**2) ** 2 / (4 * L1**2))
    root = k * rho * t2**2 - F4 * t2 - k * rho
    is_square = bool(sp.expand(square - root**2) == 0)
    # the square vanishes exactly where the two angles are equal
    difference = sp.numer(sp.together(OTHER - t2))
    ratio = sp.cancel(difference / root)
    only_equal = bool(ratio.is_number and ratio != 0)
    return Finding(is_square and only_equal, {"minus a square": is_square, "zero only for t1 = t2": only_equal})


def conclusions_four_unsymmetric() -> Finding:
    found = equilibria_at(rho="3/4", F3=-10, F4=-10)
    unlike = unstable = 0
    for e in found.solutions:
        a, b, c, d = e.center
        different = abs(a - c) > 2 * e.radius or abs(b - d) > 2 * e.radius
        unlike += different
        unstable += e.signs != "++"
    bound = sp.Poly(printed.EQUATION_12, t2).degree()
    totals = sorted({c.total for c in region_map("fig3").cells if c.total is not None})
    return Finding(
        unlike == 4 and totals == [6],
        {"bound": bound, "not symmetric": unlike, "unstable": unstable, "totals": tuple(totals)},
        corrected=bound == 2 and unlike == 2 and unstable == 4,
        said={"all": found.total, "totals": totals},
    )


def half_angle_form() -> Finding:
    first, second = (sp.expand(cleared(g.subs(SYMMETRIC)) / L1) for g in gradient())
    both = bool(sp.expand(second - printed.EQUATION_11) == 0)
    lost = bool(sp.expand(first.subs({t1: t2, t2: t1}, simultaneous=True) - second) == 0)
    return Finding(both and lost, {"(11)": both, "exchange": lost})


def general_result() -> Finding:
    allowed, seen = allowed_and_seen()
    # minima - saddles + maxima = 0: half of the equilibria are saddles
    saddles = {(total, stable): total // 2 for total, stable in allowed}
    maxima = {(total, stable): total - total // 2 - stable for total, stable in allowed}
    listed = "; ".join(
        f"of {t} equilibria {s} stable, {saddles[t, s]} saddles, {maxima[t, s]} of maximal energy"
        for t, s in sorted(allowed)
    )
    general = allowed == {(4, 1), (6, 1), (6, 2)}
    return Finding(
        False,  # that there is no general result can only be refuted, by giving one
        {
            "(total, stable, saddles)": tuple(f"{t},{s},{saddles[t, s]}" for t, s in sorted(allowed)),
            "seen are allowed": seen <= allowed,
        },
        corrected=general and seen <= allowed,
        said={"listed": listed, "seen pairs": sorted(seen)},
    )
