"""The claims of section 4.2: the map of equal rods and equal forces, and the operation range in it.

Guarantee: verdicts follow from exact counts and isolated roots on fig. 3, and from identities in L1, rho, k, F4.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import sympy as sp

from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Claim, Outcome, judge
from ptmcad.studies.paper.heights import no_level_rod_is_stable, signs_of_heights
from ptmcad.studies.paper.slices import curves, equilibria_at, heights, operation_range, region_map
from ptmcad.studies.paper.symbolic import (
    F4,
    SYMMETRIC,
    Expr,
    gradient,
    rho,
    s1,
    s2,
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
    numerator, denominator = (sp.Poly(e, unknown) for e in sp.fraction(sp.cancel(expression)))
    inner = [p.count_roots(0, 1) - sum(p.eval(end) == 0 for end in (0, 1)) for p in (numerator, denominator)]
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
            f"{sorted(signs[1])} or {sorted(signs[2])}; signs cannot change inside a cell",
            "the pose with y3, y4 > 0 is the one of least energy, for reflection in the base lowers no other",
        ),
        {"patterns": tuple(str(sorted(signs[n])) for n in (1, 2)), "y3, y4 not zero": never_level},
    )


CLAIMS = (
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
)  # fmt: skip
