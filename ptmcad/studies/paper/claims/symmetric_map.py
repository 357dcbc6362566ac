"""The claims of section 4.2: the map of equal rods and equal forces, and the operation range in it.

Guarantee: verdicts follow from exact counts and isolated roots on fig. 3, and from identities in L1, rho, k, F4.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import sympy as sp

from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Finding
from ptmcad.studies.paper.claims.figures import no_level_rod_is_stable, signs_of_heights
from ptmcad.studies.paper.slices import curves, equilibria_at, heights, operation_range, region_map
from ptmcad.studies.paper.symbolic import F4, SYMMETRIC, Expr, gradient, rho, s1, s2


def rose_and_astroid() -> Finding:
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
    return Finding(
        matched == (1, 1) and len(found) == 2 and degrees == (6, 6) and same,
        {"matched": matched, "curves": len(found), "degrees": degrees, "rose and astroid": same},
    )


def regions_fig3() -> Finding:
    counts = sorted({r.stable for r in region_map("fig3").regions if r.stable is not None})
    twos = sum(r.stable == 2 for r in region_map("fig3").regions)
    by_index = sorted({c.index for c in region_map("fig3").cells if c.index is not None})
    return Finding(
        counts == [1, 2] and twos == 1,
        {"stable": tuple(counts), "regions with two": twos, "sliver": (1, 3, 2) in by_index},
        said={"by_index": by_index},
    )


def symmetric_pattern() -> Finding:
    even = all(j % 2 == 0 for c in curves("fig3") for _, j, _ in c.polynomial.terms)
    # theorem: (F, th) -> (-F, -th) leaves U as it is
    mirrored = {s1: -s1, s2: -s2, F4: -F4}
    whole = [g.subs(SYMMETRIC) for g in gradient()]
    invariant = all(
        sp.expand(g.subs(mirrored, simultaneous=True) + g) == 0 for g in whole
    )  # fmt: skip
    return Finding(even and invariant, {"even": even, "invariant": invariant})


def reverse_configuration() -> Finding:
    patterns = signs_of_heights("fig3")
    never_level = no_level_rod_is_stable()
    return Finding(
        never_level and patterns[1] == {((-1, -1),)},
        {
            "y3, y4 not zero": never_level,
            "one stable": tuple(map(str, sorted(patterns[1]))),
            "two stable": tuple(map(str, sorted(patterns[2]))),
        },
        said={"one": sorted(patterns[1]), "two": sorted(patterns[2])},
    )


def decreasing_range() -> Finding:
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
    return Finding(
        falls and on_rose and on_astroid and positive and steep,
        {
            "falls at samples": falls,
            "on the rose": on_rose,
            "on the astroid": on_astroid,
            "slope of the low end > -1": positive,
            "slope of the high end < -1": steep,
        },
        said={
            "widths": ", ".join(f"{f}: {float(w[0]):.9f}" for f, w in zip(forces, found, strict=True)),
            "rose_t": rose_t,
            "astroid_t": astroid_t,
        },
    )


def _positive_on_unit(expression: Expr, unknown: Expr) -> bool:
    """Whether a rational function is positive on the open interval (0, 1): by Sturm's count of its roots and poles."""
    numerator, denominator = (sp.Poly(e, unknown) for e in sp.fraction(sp.cancel(expression)))
    inner = [p.count_roots(0, 1) - sum(p.eval(end) == 0 for end in (0, 1)) for p in (numerator, denominator)]
    return inner == [0, 0] and bool(expression.subs(unknown, sp.Rational(1, 2)) > 0)


def maximal_at_zero() -> Finding:
    limits = []
    for force in ("-1/10", "-1/1000", "-1/100000"):
        interval = operation_range("fig3", "rho", force)
        if interval is None:
            raise ArithmeticError(f"no operation range at F = {force}")
        limits.append(interval.width())
    at_zero = operation_range("fig2", "rho", 1)
    exact = at_zero is not None and at_zero.width()[0] <= 1 <= at_zero.width()[1]
    below = all(high < 1 for _, high in limits) and all(a[1] < b[0] for a, b in pairwise(limits))
    return Finding(
        below and exact and limits[-1][0] > Fraction(99, 100),
        {"rising to 1": below, "width 1 at F4 = 0": exact},
        said={"widths": ", ".join(f"{float(w):.6f}" for w, _ in limits)},
    )


def pulling_forces() -> Finding:
    signs: dict[int, set[tuple[tuple[int, int], ...]]] = {}
    for cell in region_map("fig3").cells:
        force = -cell.sample["F"]
        found = equilibria_at(rho=cell.sample["rho"], F3=force, F4=force)
        signs.setdefault(found.stable, set()).add(tuple(sorted(heights(s) for s in found.stable_solutions)))
    never_level = no_level_rod_is_stable()
    holds = signs == {1: {((1, 1),)}, 2: {((-1, -1), (1, 1))}}
    return Finding(
        never_level and holds,
        {"patterns": tuple(str(sorted(signs[n])) for n in (1, 2)), "y3, y4 not zero": never_level},
        said={"one": sorted(signs[1]), "two": sorted(signs[2])},
    )
