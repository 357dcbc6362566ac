"""The claims of section 4.1: the map of the unloaded mechanism.

Guarantee: verdicts follow from identities in all parameters, exact counts and isolated roots on fig. 2.
"""

from __future__ import annotations

from fractions import Fraction

import sympy as sp

from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Claim, Outcome, judge
from ptmcad.studies.paper.claims.unloaded import COS1, flat_determinants, on_triangle
from ptmcad.studies.paper.slices import curves, equilibria_at, heights, ranges, region_map
from ptmcad.studies.paper.symbolic import (
    L1,
    L2,
    UNLOADED,
    determinant,
    hessian,
    k,
    rho,
)


def non_flat_stable() -> Outcome:
    h11, whole = on_triangle(hessian()[0].subs(UNLOADED)), on_triangle(determinant().subs(UNLOADED))
    square = sp.factor(sp.cancel(L1**2 * (1 - COS1**2)))  # height^2, positive for a triangle
    # sin^2 of the third angle is height^2 (2 rho)^2 / (L1 L2)^2
    matches = bool(sp.cancel(whole - k**2 * square * (2 * rho) ** 2) == 0)
    plain = bool(sp.cancel(h11 - k * L1**2) == 0)
    return judge(
        False,  # that something is not known can only be refuted, by giving it
        (f"at the non-flat equilibria H(1,1) = {h11} and det H = {whole}, positive for every triangle",),
        {"H(1,1) = k L1^2": plain, "det H = (2 k rho h)^2, h = y3 = y4": matches},
        corrected=plain and matches,
        right="both non-flat equilibria are stable wherever they exist: H(1,1) = k L1^2, H(2,2) = k L2^2, "
        "det H = (2 k rho y3)^2",
    )


def two_region_exists() -> Outcome:
    regions = [(r.stable, r.total) for r in region_map("fig2").regions]
    counts = sorted({s for s, _ in regions if s is not None})
    return judge(
        counts == [1, 2] and sum(s == 2 for s, _ in regions) == 1,
        (f"regions by (stable, total): {regions}",),
        {"stable counts": tuple(counts), "regions with two": sum(s == 2 for s, _ in regions), "regions": len(regions)},
    )


def three_lines() -> Outcome:
    names = ("L2", "rho")
    found = {sp.expand(c.polynomial.to_sympy(names)) for c in curves("fig2")}
    plain = {s: sp.Symbol(str(s)) for s in (L2, rho)}
    wanted = {sp.expand(line.subs(plain)) for line in printed.UNLOADED_LINES}
    same = {frozenset((p, sp.expand(-p))) for p in found} == {frozenset((p, sp.expand(-p))) for p in wanted}
    texts = tuple(sorted(c.polynomial.text(names) for c in curves("fig2")))
    return judge(same, (f"the discriminant variety in the window: {', '.join(texts)}",), {"curves": texts})


def lines_are_flat() -> Outcome:
    at_flat = sp.Integer(1)
    for d in flat_determinants().values():
        at_flat *= d
    rest = at_flat.subs(L1, 1)
    quotients = []
    for line in printed.UNLOADED_LINES:
        quotient, remainder = sp.div(sp.Poly(rest, rho, L2), sp.Poly(line, rho, L2))
        quotients.append(remainder.is_zero and not quotient.is_zero)
    return judge(
        all(quotients),
        ("on each of the lines det H vanishes at one of the flat equilibria, off them at none",),
        {"divides": tuple(int(q) for q in quotients)},
    )


def stable_by_region() -> Outcome:
    flat_alone = mirrored = True
    for cell in region_map("fig2").cells:
        stable = [s for s in cell.solutions if s.signs == "++"]
        signs = [heights(s) for s in stable]
        if cell.stable == 1:
            flat_alone &= signs == [(0, 0)]
        else:
            a, b = (s.center for s in stable)
            near = all(abs(x - sign * y) <= stable[0].radius + stable[1].radius
                       for x, y, sign in zip(a, b, (1, -1, 1, -1), strict=True))  # fmt: skip
            mirrored &= near and {signs[0], signs[1]} == {(1, 1), (-1, -1)}
    return judge(
        flat_alone and mirrored,
        (
            "in every cell with one stable equilibrium its sines are zero; in every cell with two, they are "
            "(c1, s1, c2, s2) and (c1, -s1, c2, -s2)",
        ),
        {"one: flat": flat_alone, "two: mirror images": mirrored},
    )


def widths() -> Outcome:
    found = {}
    for length2 in ("1/4", "1/2", "3/4", "1", "3/2", "2", "3"):
        (two,) = (r for r in ranges("fig2", "rho", length2) if r.stable == 2)
        low, high = two.width()
        found[length2] = (low, high)
    expected = {x: min(Fraction(x), Fraction(1)) for x in found}
    fine = Fraction(1, 10**12)
    holds = all(low - fine <= expected[x] <= high + fine for x, (low, high) in found.items())
    # the interval's ends are (|L2 - 1|/2, (L2 + 1)/2), exactly: the lines of the variety
    upper, lower = (L2 + 1) / 2, (L2 - 1) / 2
    constant, linear = sp.simplify(upper - lower), sp.simplify(upper + lower)
    return judge(
        holds and constant == 1 and linear == L2,
        (
            f"from the lines of the variety: width {constant} for L2 > 1, {linear} for L2 < 1, that is min(L1, L2)",
            "by isolation of roots at L2 = " + ", ".join(found),
        ),
        {"L2 > 1": str(constant), "L2 < 1": str(linear), "at samples": holds},
    )


def fig2_right() -> Outcome:
    counts = equilibria_at(L2="3/2", rho=1)
    return judge(
        counts.stable == 2,
        (f"at rho = 1, L2 = 3/2: {counts.total} equilibria, {counts.stable} stable",),
        {"total": counts.total, "stable": counts.stable},
    )


def by_triangle() -> Outcome:
    square = L1**2 * (1 - COS1**2)  # of the triangle's height over the side 2 rho
    lines = sp.Integer(1)
    for line in printed.UNLOADED_LINES:
        lines *= line
    # Heron: 16 area^2 = 4 (2 rho)^2 height^2
    heron = bool(sp.expand(sp.cancel((4 * (2 * rho) ** 2 * square).subs(L1, 1) + (2 * rho + L2 + 1) * lines)) == 0)
    return judge(
        heron,
        (
            "the non-flat equilibria are the triangle with sides L1, L2 and 2 rho; by Heron's formula 16 times the "
            "square of its area is -(2 rho + L2 + 1) times the product of the three lines, for L1 = 1",
            "so on the lines, and nowhere else, the triangle is flat",
        ),
        {"Heron": heron},
    )


CLAIMS = (
    Claim("4.1-non-flat", "4.1", "no general information regarding the two non-flat solutions",
          "The stability of the non-flat equilibria has no general answer.", non_flat_stable),
    Claim("4.1-regions", "4.1", "a region in the parameter plane where the PTM has two stable solutions",
          "One region with two stable equilibria; one stable equilibrium outside.", two_region_exists),
    Claim("4.1-lines", "4.1", "The DV that bound the regions", "Three lines bound the regions.", three_lines),
    Claim("4.1-boundaries-flat", "4.1", "these boundaries correspond to the fully flat",
          "On the boundaries a flat equilibrium is singular.", lines_are_flat),
    Claim("4.1-mirror", "4.1", "one being the mirrored image of the other",
          "One stable equilibrium is flat; two are mirror images of each other.", stable_by_region),
    Claim("4.1-width", "4.1", "of constant width equal to 1",
          "The two-solution range has width L1 for L2 > 1 and shrinks linearly for L2 < 1.", widths),
    Claim("4.1-fig2", "4.1", "stable solutions for rho = 1, L2 = 3/2", "Two stable poses at the point of fig. 2.",
          fig2_right),
    Claim("4.1-geometric", "4.1", "easily verified with geometric arguments", "The lines follow from geometry.",
          by_triangle),
)  # fmt: skip
