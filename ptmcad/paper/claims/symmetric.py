"""The claims of sections 3.2, 3.3 and 4.2: equal rods and equal forces.

Guarantee: verdicts follow from identities in L1, rho, k, F4, from exact counts and from isolated roots on fig. 3.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import sympy as sp

from ptmcad.paper import printed
from ptmcad.paper.claim import Claim, Outcome, judge, unchecked
from ptmcad.paper.slices import curves, equilibria_at, heights, operation_range, region_map
from ptmcad.paper.symbolic import (
    F3,
    F4,
    L1,
    L2,
    SYMMETRIC,
    VERTICAL,
    Expr,
    c1,
    c2,
    cleared,
    determinant,
    gradient,
    half_angle_equations,
    half_angles,
    hessian,
    k,
    rho,
    s1,
    s2,
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


def rose_and_astroid() -> Outcome:
    names = ("rho", "F")
    found = [c.polynomial.to_sympy(names) for c in curves("fig3")]
    plain = {rho: sp.Symbol("rho"), F4: sp.Symbol("F")}
    wanted = [e.subs(plain) for e in (printed.BOUNDARY_15, printed.BOUNDARY_16)]
    matched = tuple(
        sum(bool((ratio := sp.cancel(f / w)).is_number and ratio != 0) for f in found) for w in wanted
    )  # fmt: skip
    degrees = tuple(sp.Poly(w).total_degree() for w in wanted)
    # the same in x = 2 rho, y = F/k: rose and astroid
    x, y = 2 * plain[rho], plain[F4] / 100
    shapes = ((x**2 + y**2) ** 3 - 4 * x**2 * y**2, (x**2 + y**2 - 4) ** 3 + 108 * x**2 * y**2)
    same = all(bool(sp.cancel(s / w).is_number) for s, w in zip(shapes, wanted, strict=True))
    return judge(
        matched == (1, 1) and len(found) == 2 and degrees == (6, 6) and same,
        (
            "the discriminant variety of fig. 3 consists of (15) and (16), of degree 6",
            "with x = 2 rho, y = F4/k, L1 = 1: (15) is the rose (x^2 + y^2)^3 = 4 x^2 y^2, (16) the astroid "
            "(x^2 + y^2 - 4)^3 + 108 x^2 y^2 = 0",
        ),
        {"matched": matched, "curves": len(found), "degrees": degrees, "rose and astroid": same},
    )


def regions_fig3() -> Outcome:
    counts = sorted({r.stable for r in region_map("fig3").regions if r.stable is not None})
    twos = sum(r.stable == 2 for r in region_map("fig3").regions)
    by_index = sorted({c.index for c in region_map("fig3").cells if c.index is not None})
    return judge(
        counts == [1, 2] and twos == 1,
        (
            f"regions with two stable equilibria: {twos}; by (minima, saddles, maxima) the cells are {by_index}",
            "not in the paper: (1, 3, 2), a sliver at rho < 0.0025 with six equilibria of which one is stable",
        ),
        {"stable": tuple(counts), "regions with two": twos, "sliver": (1, 3, 2) in by_index},
    )


def fig3_right() -> Outcome:
    found = equilibria_at(rho="3/4", F3=-10, F4=-10)
    return judge(
        found.stable == 2,
        (f"at rho = 3/4, F4 = -10: {found.total} equilibria, {found.stable} stable",),
        {"total": found.total, "stable": found.stable},
    )


def symmetric_pattern() -> Outcome:
    even = all(j % 2 == 0 for c in curves("fig3") for _, j, _ in c.polynomial.terms)
    # theorem: (F, th) -> (-F, -th) leaves U as it is
    mirrored = {s1: -s1, s2: -s2, F4: -F4}
    whole = [g.subs(SYMMETRIC) for g in gradient()]
    invariant = all(
        sp.expand(g.subs(mirrored, simultaneous=True) + g) == 0 for g in whole
    )  # fmt: skip
    return judge(
        even and invariant,
        ("both curves are even in F4; reversing F4 and both angles maps equilibria to equilibria",),
        {"even": even, "invariant": invariant},
    )


def signs_of_heights(figure: str) -> dict[int, set[tuple[tuple[int, int], ...]]]:
    """For each stable count, the patterns of the signs of (y3, y4) of the stable equilibria over a figure's cells."""
    found: dict[int, set[tuple[tuple[int, int], ...]]] = {}
    for cell in region_map(figure).cells:
        if cell.stable is None:
            raise ArithmeticError(f"a cell of {figure} has no stable count")
        pattern = tuple(sorted(heights(s) for s in cell.solutions if s.signs == "++"))
        found.setdefault(cell.stable, set()).add(pattern)
    return found


def no_level_rod_is_stable() -> bool:
    """Whether, with F3 F4 > 0, no stable equilibrium has y3 = 0; computed as a polynomial identity for all lengths.

    With s1 = 0 and c1 = e, e^2 = 1, dU/dth1 = 0 says k L2 s2 = -F3, and dU/dth2 = 0 gives H(2,2) s2 = L2 F4. So
    H(2,2) = -k L2^2 F4/F3 is negative. By reflection the same holds for y4.
    """
    e = sp.Symbol("e")
    level = {s1: 0, c1: e}
    first, second = (sp.expand(g.subs(VERTICAL).subs(level)) for g in gradient())
    h22 = sp.expand(hessian()[2].subs(VERTICAL).subs(level))
    # H(2,2) s2 = L2 F4 on the equilibrium: a combination of dU/dth2 and the circle
    lifted = sp.expand(h22 * s2 - L2 * F4 - c2 * second)
    on_circle = bool(sp.expand(lifted.subs(s2**2, 1 - c2**2)) == 0)
    sine = bool(sp.expand(first + e * L1 * (F3 + k * L2 * s2)) == 0)
    return on_circle and sine


def reverse_configuration() -> Outcome:
    patterns = signs_of_heights("fig3")
    never_level = no_level_rod_is_stable()
    return judge(
        never_level and patterns[1] == {((-1, -1),)},
        (
            "at a stable equilibrium under two forces of one sign y3 and y4 are never zero: y3 = 0 forces "
            "k L2 sin th2 = -F3, hence H(2,2) = -k L2^2 F4/F3 < 0; so their signs are constant in each cell",
            f"in the cells with one stable equilibrium the signs of (y3, y4) are {sorted(patterns[1])}, in "
            "those with two "
            f"{sorted(patterns[2])}",
            "at F4 = 0, on the window's edge, the stable pose is flat and y3 = y4 = 0",
        ),
        {
            "y3, y4 not zero": never_level,
            "one stable": tuple(map(str, sorted(patterns[1]))),
            "two stable": tuple(map(str, sorted(patterns[2]))),
        },
    )


def range_is_two_region() -> Outcome:
    patterns = signs_of_heights("fig3")
    never_level = no_level_rod_is_stable()
    return judge(
        never_level and patterns == {1: {((-1, -1),)}, 2: {((-1, -1), (1, 1))}},
        ("a stable pose with y3, y4 > 0 exists in the two-solution region, exactly one, and nowhere else",),
        {"patterns": tuple(str(sorted(patterns[n])) for n in (1, 2))},
    )


def decreasing_range() -> Outcome:
    forces = ("-1", "-2", "-5", "-10", "-20", "-30", "-40", "-50", "-60", "-70")
    found = []
    for force in forces:
        interval = operation_range("fig3", "rho", force)
        if interval is None:
            raise ArithmeticError(f"no operation range at F = {force}")
        found.append(interval.width())
    falls = all(a[0] > b[1] for a, b in pairwise(found))
    # between the samples: the low end lies on the rose x = 2 sin p cos^2 p, y = 2 sin^2 p cos p, the high end on the
    # astroid x = 2 cos^3 q, y = 2 sin^3 q, x being 2 rho and y being |F|/k
    a, b = sp.symbols("a b")  # sine and cosine of the parameter
    x, y = 2 * a * b**2, 2 * a**2 * b
    on_rose = bool(sp.expand(((x**2 + y**2) ** 3 - 4 * x**2 * y**2).subs(a**2, 1 - b**2)
                             .subs(a, sp.sqrt(1 - b**2))) == 0)  # fmt: skip
    u, v = 2 * b**3, 2 * a**3
    on_astroid = bool(
        sp.expand(((u**2 + v**2 - 4) ** 3 + 108 * u**2 * v**2).subs(a, sp.sqrt(1 - b**2))) == 0
    )  # fmt: skip

    def slope(p: Expr, q: Expr) -> Expr:  # dp/dq along the curve; a' = b and b' = -a
        return sp.factor((sp.diff(p, a) * b - sp.diff(p, b) * a) / (sp.diff(q, a) * b - sp.diff(q, b) * a))

    rose, astroid = slope(x, y), slope(u, v)
    tangent = sp.Symbol("T", positive=True)  # tan of the parameter, 0 < T < 1
    rose_t = sp.factor(sp.simplify(rose.subs(a, tangent * b)))
    astroid_t = sp.factor(sp.simplify(astroid.subs(a, tangent * b)))
    # the rose's slope minus (-1) is positive for 0 < T < 1, the astroid's is -1/T < -1
    above = sp.factor(rose_t + 1)
    positive = _positive_on_unit(above, tangent)
    steep = bool(sp.simplify(astroid_t + 1 / tangent) == 0)
    return judge(
        falls and on_rose and on_astroid and positive and steep,
        (
            "widths at F4 = " + ", ".join(f"{f}: {float(w[0]):.9f}" for f, w in zip(forces, found, strict=True)),
            f"in between: along the rose d(2 rho)/d(|F4|/k) = {rose_t} > -1 for 0 < T < 1, along the astroid "
            f"{astroid_t} < -1, T being the tangent of each curve's parameter; so the width falls until both "
            "ends meet at "
            "2 rho = |F4|/k = 1/sqrt 2",
        ),
        {
            "falls at samples": falls,
            "on the rose": on_rose,
            "on the astroid": on_astroid,
            "slope of the low end > -1": positive,
            "slope of the high end < -1": steep,
        },
    )


def _positive_on_unit(expression: Expr, unknown: Expr) -> bool:
    """Whether a rational function is positive on the open interval (0, 1): by Sturm's count of its roots and poles."""
    above, below = (sp.Poly(e, unknown) for e in sp.fraction(sp.cancel(expression)))
    inner = [p.count_roots(0, 1) - sum(p.eval(end) == 0 for end in (0, 1)) for p in (above, below)]
    return inner == [0, 0] and bool(expression.subs(unknown, sp.Rational(1, 2)) > 0)


def maximal_at_zero() -> Outcome:
    limits = []
    for force in ("-1/10", "-1/1000", "-1/100000"):
        interval = operation_range("fig3", "rho", force)
        if interval is None:
            raise ArithmeticError(f"no operation range at F = {force}")
        limits.append(interval.width())
    at_zero = operation_range("fig2", "rho", 1)
    exact = at_zero is not None and at_zero.width()[0] <= 1 <= at_zero.width()[1]
    below = all(high < 1 for _, high in limits) and all(a[1] < b[0] for a, b in pairwise(limits))
    return judge(
        below and exact and limits[-1][0] > Fraction(99, 100),
        (
            "widths at F4 = -0.1, -0.001, -0.00001: " + ", ".join(f"{float(w):.6f}" for w, _ in limits),
            "at F4 = 0 the range is 0 < rho < 1, between the lines of the unloaded slice at L2 = L1 = 1",
        ),
        {"rising to 1": below, "width 1 at F4 = 0": exact},
    )


def pulling_forces() -> Outcome:
    signs: dict[int, set[tuple[tuple[int, int], ...]]] = {}
    for cell in region_map("fig3").cells:
        force = -cell.sample["F"]
        found = equilibria_at(rho=cell.sample["rho"], F3=force, F4=force)
        signs.setdefault(found.stable, set()).add(tuple(sorted(heights(s) for s in found.stable_solutions)))
    never_level = no_level_rod_is_stable()
    holds = signs == {1: {((1, 1),)}, 2: {((-1, -1), (1, 1))}}
    return judge(
        never_level and holds,
        (
            f"with F4 > 0, at the mirrored sample of every cell of fig. 3 the stable equilibria have (y3, y4) of signs "
            f"{sorted(signs[1])} or {sorted(signs[2])}; signs can not change inside a cell",
            "the pose with y3, y4 > 0 is the one of least energy, for reflection in the base lowers no other",
        ),
        {"patterns": tuple(str(sorted(signs[n])) for n in (1, 2)), "y3, y4 not zero": never_level},
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
          unchecked("a report of what was tried; theorem 1 of docs/method.md is a general result")),
    Claim("4.2-unequal", "4.2", "the two solutions th1 != th2 are always unstable",
          "Solutions with distinct angles are unstable.", always_negative),
    Claim("4.2-symmetric", "4.2", "a symmetric pattern is obtained for 0 <= F4 <= 10",
          "The map for F4 > 0 is the mirror image.", symmetric_pattern),
    Claim("4.2-region", "4.2", "there exists a region with two stable solutions",
          "One region with two stable equilibria in fig. 3.", regions_fig3),
    Claim("4.2-fig3", "4.2", "two stable solutions for rho = 3/4 and F4 = -10", "Two stable poses at fig. 3's point.",
          fig3_right),
    Claim("4.2-eq15-16", "4.2", "The boundaries here are two curves of degree 6", "Equations (15) and (16).",
          rose_and_astroid),
    Claim("4.2-reverse", "4.2", "always in a reverse configuration",
          "In the one-solution region y3 < 0 and y4 < 0.", reverse_configuration),
    Claim("4.2-range", "4.2", "determined by the 2-solution region",
          "Poses with y3, y4 > 0 last exactly over the two-solution region.", range_is_two_region),
    Claim("4.2-decreases", "4.2", "The operation range decreases when the external force increases",
          "The range's width falls as |F4| grows.", decreasing_range),
    Claim("4.2-maximal", "4.2", "reaches its maximal value, which is equal to 1", "The width is 1 = L1 at F4 = 0.",
          maximal_at_zero),
    Claim("4.2-pulling", "4.2", "the operation range of the PTM would be full",
          "With F4 > 0 a stable pose with y3, y4 > 0 exists everywhere.", pulling_forces),
    Claim("c-four-unsymmetric", "conclusions", "4 unstable, non-symmetric solutions",
          "In the symmetric case there are six solutions, four of them not symmetric.", conclusions_four_unsymmetric),
)  # fmt: skip
