"""The claims of section 4.1: the map of the unloaded mechanism.

Guarantee: verdicts follow from identities in all parameters, exact counts and isolated roots on fig. 2.
"""

from __future__ import annotations

from fractions import Fraction

import sympy as sp

from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Finding
from ptmcad.studies.paper.claims.unloaded import COS1, flat_determinants, on_triangle
from ptmcad.studies.paper.slices import curves, heights, ranges, region_map
from ptmcad.studies.paper.symbolic import L1, L2, UNLOADED, determinant, hessian, k, rho


def non_flat_stable() -> Finding:
    h11, whole = on_triangle(hessian()[0].subs(UNLOADED)), on_triangle(determinant().subs(UNLOADED))
    square = sp.factor(sp.cancel(L1**2 * (1 - COS1**2)))  # height^2, positive for a triangle
    # sin^2 of the third angle is height^2 (2 rho)^2 / (L1 L2)^2
    matches = bool(sp.cancel(whole - k**2 * square * (2 * rho) ** 2) == 0)
    plain = bool(sp.cancel(h11 - k * L1**2) == 0)
    return Finding(
        False,  # that something is not known can only be refuted, by giving it
        {"H(1,1) = k L1^2": plain, "det H = (2 k rho h)^2, h = y3 = y4": matches},
        corrected=plain and matches,
        said={"h11": h11, "whole": whole},
    )


def three_lines() -> Finding:
    names = ("L2", "rho")
    found = {sp.expand(c.polynomial.to_sympy(names)) for c in curves("fig2")}
    plain = {s: sp.Symbol(str(s)) for s in (L2, rho)}
    wanted = {sp.expand(line.subs(plain)) for line in printed.UNLOADED_LINES}
    same = {frozenset((p, sp.expand(-p))) for p in found} == {frozenset((p, sp.expand(-p))) for p in wanted}
    texts = tuple(sorted(c.polynomial.text(names) for c in curves("fig2")))
    return Finding(same, {"curves": texts}, said={"listed": ", ".join(texts)})


def lines_are_flat() -> Finding:
    at_flat = sp.Integer(1)
    for d in flat_determinants().values():
        at_flat *= d
    rest = at_flat.subs(L1, 1)
    quotients = []
    for line in printed.UNLOADED_LINES:
        quotient, remainder = sp.div(sp.Poly(rest, rho, L2), sp.Poly(line, rho, L2))
        quotients.append(remainder.is_zero and not quotient.is_zero)
    return Finding(all(quotients), {"divides": tuple(int(q) for q in quotients)})


def stable_by_region() -> Finding:
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
    return Finding(flat_alone and mirrored, {"one: flat": flat_alone, "two: mirror images": mirrored})


def widths() -> Finding:
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
    return Finding(
        holds and constant == 1 and linear == L2,
        {"L2 > 1": str(constant), "L2 < 1": str(linear), "at samples": holds},
        said={"lengths": ", ".join(found)},
    )


def by_triangle() -> Finding:
    square = L1**2 * (1 - COS1**2)  # of the triangle's height over the side 2 rho
    lines = sp.Integer(1)
    for line in printed.UNLOADED_LINES:
        lines *= line
    # Heron: 16 area^2 = 4 (2 rho)^2 height^2
    heron = bool(sp.expand(sp.cancel((4 * (2 * rho) ** 2 * square).subs(L1, 1) + (2 * rho + L2 + 1) * lines)) == 0)
    return Finding(heron, {"Heron": heron})
