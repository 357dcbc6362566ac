"""The claims of sections 3.2 and 3.3: equal rods and equal forces.

Guarantee: verdicts follow from identities in L1, rho, k, F4, from exact counts and from isolated roots on fig. 3.
"""

from __future__ import annotations

import sympy as sp

from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Claim, Outcome, judge
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


def one_equation() -> Outcome:
    on_diagonal = [sp.expand(e.subs(t1, t2)) for e in equations()]
    same = bool(sp.expand(on_diagonal[0] - on_diagonal[1]) == 0)
    degree = sp.Poly(on_diagonal[0], t2).degree()
    return judge(
        same and degree == 4,
        (f"with th1 = th2 both equations are the same one, of degree {degree} in t",),
        {"same": same, "degree": degree},
    )


def which_equations() -> Outcome:
    unloaded = [e for e in (printed.EQUATION_7, printed.EQUATION_8) if e.has(F4)]
    derived = bool(sp.expand(equations()[0] - equations()[1] - 2 * printed.EQUATION_10) == 0)
    return judge(
        bool(unloaded),
        ("(7) and (8) have no force in them, but (10) and (11) have; these follow from (3) and (4)",),
        {"equations with a force": len(unloaded), "(10) from (3) and (4)": derived},
        corrected=derived,
        right="the two equations (3) and (4) are used",
    )


def equation_10() -> Outcome:
    first, second = equations()
    holds = bool(sp.expand(first - second - 2 * printed.EQUATION_10) == 0)
    return judge(holds, ("(3) minus (4), in half angles, is 2/k times (10)",), {"holds": holds})


def equation_11() -> Outcome:
    holds = bool(sp.expand(equations()[1] - printed.EQUATION_11) == 0)
    return judge(holds, ("(11) is (3) in half angles, times -k",), {"holds": holds})


def both_kinds() -> Outcome:
    found = equilibria_at(rho="3/4", F3=-10, F4=-10)
    alike = 0
    for e in found.solutions:
        a, b, c, d = e.center
        alike += abs(a - c) <= 2 * e.radius and abs(b - d) <= 2 * e.radius
    return judge(
        alike > 0 and found.total > alike,
        (f"at rho = 3/4, F4 = -10: {found.total} equilibria, {alike} with th1 = th2",),
        {"total": found.total, "equal angles": alike},
    )


def eliminated_12() -> Expr:
    """The numerator that remains of (11) when the second factor of (10) gives t1, without the factor 1 + t2^2."""
    numerator = sp.numer(sp.together(printed.EQUATION_11.subs(t1, OTHER)))
    quotient, remainder = sp.div(sp.Poly(numerator, t2), sp.Poly(1 + t2**2, t2))
    if not remainder.is_zero:
        raise ArithmeticError("1 + t2^2 does not divide the eliminated polynomial")
    return sp.expand(quotient.as_expr())


def equation_12() -> Outcome:
    ratio = sp.cancel(eliminated_12() / printed.EQUATION_12)
    holds = ratio.is_number and ratio != 0
    degree = sp.Poly(printed.EQUATION_12, t2).degree()
    return judge(
        bool(holds) and degree == 2,
        (f"what remains after 1 + t2^2 is cleared is {ratio} times (12), of degree {degree} in t2; L stands for L1",),
        {"ratio": str(ratio), "degree": degree},
    )


def linear_and_swapped() -> Outcome:
    denominator_root = F4 / (2 * k * rho)
    no_solution_there = sp.cancel(printed.FACTOR_10.subs(t2, denominator_root))
    regular = bool(sp.expand(no_solution_there * 2 * k * rho - F4**2 - 4 * k**2 * rho**2) == 0)
    swapped = sp.numer(sp.together(printed.EQUATION_12.subs(t2, OTHER)))
    invariant = sp.cancel(swapped / printed.EQUATION_12)
    symmetric = bool(invariant.is_polynomial(t2) and not sp.expand(invariant).has(t2))
    return judge(
        regular and symmetric,
        (
            "t1 = -(F4 t2 + 2 k rho)/(F4 - 2 k rho t2); where the denominator vanishes the factor is "
            "(F4^2 + 4 k^2 rho^2)/(2 k rho), not zero, so nothing is lost",
            "this t1 is a root of (12) again, the other one, because (12) is unchanged by the substitution",
        ),
        {"nothing lost": regular, "(12) unchanged": symmetric},
    )


def at_most_two() -> Outcome:
    degree = sp.Poly(printed.EQUATION_12, t2).degree()
    leading = sp.factor(sp.Poly(printed.EQUATION_12, t2).LC())
    return judge(
        degree == 2,
        (
            f"(12) has degree {degree}; its leading coefficient {leading} is zero for F4 = 0 only, where the two "
            "solutions are the flat ones (0, pi) and (pi, 0)",
        ),
        {"degree": degree, "leading": str(leading)},
    )


def four_equal() -> Outcome:
    quartic = sp.Poly(printed.EQUATION_11.subs(t1, t2), t2)
    attained = quartic.as_expr().subs({F4: -10, k: 100, L1: 1, rho: sp.Rational(3, 4)})
    real = sp.Poly(attained, t2).count_roots()
    return judge(
        quartic.degree() == 4 and real == 4,
        (f"(11) with t1 = t2 has degree {quartic.degree()}; at rho = 3/4, F4 = -10 it has {real} real roots",),
        {"degree": quartic.degree(), "real roots": int(real)},
    )


def on_unequal(expression: Expr) -> Expr:
    """An expression of the angles at th1 != th2, by t2: the second factor of (10) gives t1."""
    return sp.factor(sp.cancel(sp.together(half_angles(expression.subs(SYMMETRIC)).subs(t1, OTHER))))


def equation_13() -> Outcome:
    true = on_unequal(determinant())
    as_printed = bool(sp.cancel(true - printed.DETERMINANT_13) == 0)
    simple = -4 * L1**2 * (k * rho * t2**2 - F4 * t2 - k * rho) ** 2 / (1 + t2**2) ** 2
    right = bool(sp.cancel(true - simple) == 0)
    factor = ((1 + t1**2) * (1 + t2**2)).subs(t1, OTHER) ** 2 / L1**2
    related = bool(sp.cancel(true * factor - printed.DETERMINANT_13) == 0)
    return judge(
        as_printed,
        (
            f"det H at th1 != th2 is {true}, for every L1",
            "the printed expression is that times ((1 + t1^2)(1 + t2^2))^2 / L1^2, which is positive: "
            f"{'checked' if related else 'not so'}; the equation is solved for t1, not for t2",
        ),
        {"printed": as_printed, "right": right, "printed is a positive multiple": related},
        corrected=right and related,
        right="det H = -4 L1^2 (k rho t2^2 - F4 t2 - k rho)^2 / (1 + t2^2)^2",
    )


def always_negative() -> Outcome:
    true = on_unequal(determinant())
    square = sp.cancel(-true * (1 + t2**2) ** 2 / (4 * L1**2))
    root = k * rho * t2**2 - F4 * t2 - k * rho
    is_square = bool(sp.expand(square - root**2) == 0)
    # the square vanishes exactly where the two angles are equal
    difference = sp.numer(sp.together(OTHER - t2))
    ratio = sp.cancel(difference / root)
    only_equal = bool(ratio.is_number and ratio != 0)
    return judge(
        is_square and only_equal,
        (
            "det H is minus a square, and the square is zero only where t1 = t2, where the pair meets the "
            "solutions with "
            "equal angles; so for th1 != th2 it is negative: saddles",
        ),
        {"minus a square": is_square, "zero only for t1 = t2": only_equal},
    )


def conclusions_four_unsymmetric() -> Outcome:
    found = equilibria_at(rho="3/4", F3=-10, F4=-10)
    unlike = unstable = 0
    for e in found.solutions:
        a, b, c, d = e.center
        different = abs(a - c) > 2 * e.radius or abs(b - d) > 2 * e.radius
        unlike += different
        unstable += e.signs != "++"
    bound = sp.Poly(printed.EQUATION_12, t2).degree()
    totals = sorted({c.total for c in region_map("fig3").cells if c.total is not None})
    return judge(
        unlike == 4 and totals == [6],
        (
            f"solutions with th1 != th2 are the roots of (12), at most {bound}",
            f"at rho = 3/4, F4 = -10: {found.total} equilibria, {unstable} unstable, {unlike} of them not symmetric",
            f"totals over the cells of fig. 3: {totals}",
        ),
        {"bound": bound, "not symmetric": unlike, "unstable": unstable, "totals": tuple(totals)},
        corrected=bound == 2 and unlike == 2 and unstable == 4,
        right="4 or 6 solutions; of 6, where two are stable, 4 are unstable and 2 of these are not symmetric",
        witness="rho = 3/4, L1 = L2 = 1, F3 = F4 = -10, k = 100",
    )


def half_angle_form() -> Outcome:
    first, second = (sp.expand(cleared(g.subs(SYMMETRIC)) / L1) for g in gradient())
    both = bool(sp.expand(second - printed.EQUATION_11) == 0)
    lost = bool(sp.expand(first.subs({t1: t2, t2: t1}, simultaneous=True) - second) == 0)
    return judge(
        both and lost,
        ("exchanging t1 and t2 exchanges the two equations, so solutions come in pairs (t1, t2), (t2, t1)",),
        {"(11)": both, "exchange": lost},
    )


def general_result() -> Outcome:
    allowed, seen = allowed_and_seen()
    # minima - saddles + maxima = 0: half of the equilibria are saddles
    saddles = {(total, stable): total // 2 for total, stable in allowed}
    maxima = {(total, stable): total - total // 2 - stable for total, stable in allowed}
    listed = "; ".join(
        f"of {t} equilibria {s} stable, {saddles[t, s]} saddles, {maxima[t, s]} of maximal energy"
        for t, s in sorted(allowed)
    )
    general = allowed == {(4, 1), (6, 1), (6, 2)}
    return judge(
        False,  # that there is no general result can only be refuted, by giving one
        (
            "from the degree of the eliminated polynomial and the Euler characteristic of the torus, for all lengths, "
            f"inputs, stiffnesses and forces at which no equilibrium is degenerate: {listed}",
            f"seen in the cells of the five maps and at random points: {sorted(seen)}",
            "without loads the non-flat equilibria are stable wherever they exist (4.1-non-flat)",
        ),
        {
            "(total, stable, saddles)": tuple(f"{t},{s},{saddles[t, s]}" for t, s in sorted(allowed)),
            "seen are allowed": seen <= allowed,
        },
        corrected=general and seen <= allowed,
        right="where no equilibrium is degenerate, exactly half of the equilibria are saddles, one or two are stable, "
        "and there are 4, of which 1 is stable, or 6, of which 1 or 2 are",
    )  # fmt: skip


CLAIMS = (
    Claim("3.2-arsenault", "3.2", "resulting in a 4th degree polynomial equation",
          "With th1 = th2 there is one equation of degree 4.", one_equation),
    Claim("3.2-eqs-used", "3.2", "we use the two equations (7) and (8)", "(10), (11) follow from (7) and (8).",
          which_equations),
    Claim("3.2-eq10", "3.2", "the second equation is subtracted to the first one", "Equation (10).", equation_10),
    Claim("3.2-eq11", "3.2", "the following new system is obtained", "Equation (11).", equation_11),
    Claim("3.2-distinct", "3.2", "solutions with distinct angles may also appear",
          "Equal and distinct angles both occur.", both_kinds),
    Claim("3.2-eq12", "3.2", "leads to a polynomial of degree 2 in t2", "Equation (12).", equation_12),
    Claim("3.2-linear", "3.2", "t1 can then been solved linearly",
          "t1 follows linearly, and gives the other root of (12).", linear_and_swapped),
    Claim("3.2-two", "3.2", "up to two solutions of th1 != th2", "At most two solutions with distinct angles.",
          at_most_two),
    Claim("3.2-pairs", "3.2", "of the form (t1, t2) and (t2, t1)", "The two are exchanged by t1 <-> t2.",
          half_angle_form),
    Claim("3.2-four", "3.2", "yields up to 4 distinct solutions", "At most four solutions with equal angles.",
          four_equal),
    Claim("3.3-eq13", "3.3", "leads to the following expression", "Equation (13), det H at distinct angles.",
          equation_13),
    Claim("3.3-negative", "3.3", "which is always negative", "det H < 0 there, so those two are unstable.",
          always_negative),
    Claim("3.3-others", "3.3", "symbolic calculations did not succeed",
          "No general result on stability in the other cases.",
          general_result),
    Claim("4.2-unequal", "4.2", "the two solutions th1 != th2 are always unstable",
          "Solutions with distinct angles are unstable.", always_negative),
    Claim("c-four-unsymmetric", "conclusions", "4 unstable, non-symmetric solutions",
          "In the symmetric case there are six solutions, four of them not symmetric.", conclusions_four_unsymmetric),
)  # fmt: skip
