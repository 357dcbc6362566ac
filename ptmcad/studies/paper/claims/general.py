"""The claims of section 4's opening and of 4.3: unequal rods, equal and unequal forces.

Guarantee: verdicts follow from the exact region maps of figs. 4 and 5 and from isolated roots of their varieties.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import sympy as sp

from ptmcad.answer.regionmap import Merge
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Claim, Fact, Outcome, judge, unchecked, undecided
from ptmcad.studies.paper.heights import no_level_rod_is_stable, signs_of_heights
from ptmcad.studies.paper.operation_range import widest
from ptmcad.studies.paper.slices import curves, equilibria_at, operation_range, ranges, region_map
from ptmcad.studies.paper.symbolic import F3, F4, L1, L2, VERTICAL, gradient, k, rho


def parameters() -> Outcome:
    names = {F3, F4, L1, L2, rho, k}
    used = set().union(*(g.subs(VERTICAL).free_symbols for g in gradient())) & names
    scale = sp.Symbol("scale", positive=True)

    def degree(change: dict[sp.Symbol, sp.Expr]) -> int | None:
        for power in (1, 2):
            if all(sp.expand(g.subs(VERTICAL).subs(change, simultaneous=True) - scale**power * g.subs(VERTICAL)) == 0
                   for g in gradient()):  # fmt: skip
                return power
        return None

    lengths = {s: scale * s for s in (L1, L2, rho)}
    forces = {s: scale * s for s in (F3, F4, k)}
    with_loads = {**lengths, F3: scale * F3, F4: scale * F4}
    facts: dict[str, Fact] = {
        "parameters": len(used),
        "lengths alone": degree(lengths) is not None,
        "lengths and F/k": degree(with_loads) is not None,
        "F and k": degree(forces) is not None,
    }
    independent = len(used) - 2
    return judge(
        degree(lengths) is not None,
        (
            f"the equations contain {len(used)} parameters: three lengths, k, and two forces; so there are "
            "three physical "
            "ones, not two",
            "scaling the lengths alone changes the equations; scaling the lengths and F3/k, F4/k, which are "
            "lengths too, "
            f"does not; nor does scaling F3, F4 and k: {independent} independent parameters",
        ),
        facts,
        corrected=degree(with_loads) == 2 and degree(forces) == 1 and independent == 4,
        right="4 independent parameters: rho/L1, L2/L1, F3/(k L1), F4/(k L1)",
    )


def merging() -> Outcome:
    kept = True
    for figure in ("fig2", "fig3", "fig4", "fig5-text", "fig5-caption"):
        cells = region_map(figure).cells
        for link in region_map(figure).adjacencies:
            same = cells[link.first].index == cells[link.second].index
            kept &= same or link.merge is not Merge.PROVEN
    return judge(
        kept,
        (
            "in the five maps, cells that only the decomposition parts have the same numbers of minima, saddles "
            "and maxima",
        ),
        {"constant": kept},
    )


def one_curve() -> Outcome:
    found = [(c.polynomial.degrees, len(c.polynomial.terms)) for c in curves("fig4")]
    (degrees, terms), *others = found
    in_square = all(i % 2 == 0 for i, _, _ in curves("fig4")[0].polynomial.terms)
    return judge(
        len(found) == 3 and all(d == (12, 12) for d, _ in found),
        (
            f"the variety in the window: {len(found)} irreducible curve of degree {degrees[0]} in rho and "
            f"{degrees[1]} in "
            f"L2, with {terms} terms; only even powers of rho occur: {in_square}",
        ),
        {"curves": len(found), "degrees": degrees, "terms": terms, "even in rho": in_square},
        corrected=not others and degrees == (24, 12) and in_square,
        right=f"one irreducible curve of degree 12 in rho^2 and in L2, with {terms} terms",
    )


def similar() -> Outcome:
    unloaded, loaded = ([r.stable for r in region_map(f).regions] for f in ("fig2", "fig4"))
    one_two = loaded.count(2) == 1 and set(loaded) == {1, 2}
    return judge(
        one_two,
        (f"stable equilibria by region: {loaded} (unloaded: {unloaded})",),
        {"regions": len(loaded), "with two": loaded.count(2), "counts": tuple(sorted({n for n in loaded if n}))},
    )


def fig4_right() -> Outcome:
    found = equilibria_at(L2="3/2", rho="7/10", F3=-10, F4=-10)
    return judge(
        found.stable == 2,
        (f"at rho = 7/10, L2 = 3/2: {found.total} equilibria, {found.stable} stable",),
        {"total": found.total, "stable": found.stable},
    )


def range_is_two_region() -> Outcome:
    patterns = signs_of_heights("fig4")
    never_level = no_level_rod_is_stable()
    return judge(
        never_level and patterns == {1: {((-1, -1),)}, 2: {((-1, -1), (1, 1))}},
        (
            "y3 and y4 of a stable equilibrium are never zero under two downward forces, so their signs are "
            "constant in a "
            f"cell: {sorted(patterns[1])} in those with one stable equilibrium, {sorted(patterns[2])} in those "
            "with two",
        ),
        {"y3, y4 not zero": never_level, "patterns": tuple(str(sorted(patterns[n])) for n in (1, 2))},
    )


def widest_at_one() -> Outcome:
    found = widest()
    at = {str(x): f"{float(low):.9f}" for x, (low, _) in found.widths.items()}
    evidence = (
        "width at L2 = " + ", ".join(f"{x}: {w}" for x, w in at.items()),
        "proved for 0 < L2 <= 2: " + "; ".join(step for step, shown in found.steps.items() if shown),
    )
    facts: dict[str, Fact] = {
        "steps": tuple(f"{step}: {shown}" for step, shown in found.steps.items()),
        "width at 1": at["1"],
    }
    one = found.widths[Fraction(1)]
    larger = [x for x, (low, _) in found.widths.items() if low > one[1]]
    if not found.proved and not larger:
        return undecided("a step of the proof was not shown", evidence, facts)
    return judge(
        found.proved and not larger, evidence, facts, witness="" if not larger else f"L2 = {larger[0]} is wider"
    )


def same_range() -> Outcome:
    fig4 = curves("fig4")[0].polynomial.to_sympy(("rho", "L2")).subs(sp.Symbol("L2"), 1)
    base = sp.Symbol("rho")
    rose, astroid = (
        e.subs({rho: base, F4: -10}) for e in (printed.BOUNDARY_15, printed.BOUNDARY_16)
    )  # fmt: skip
    ratio = sp.cancel(fig4 / (rose**3 * astroid))
    left, right = operation_range("fig4", "rho", 1), operation_range("fig3", "rho", -10)
    if left is None or right is None:
        raise ArithmeticError("a range is missing")
    close = all(abs(a - b) < Fraction(1, 10**12) for a, b in zip(left.bounds(), right.bounds(), strict=True))
    return judge(
        bool(ratio.is_number) and close,
        (
            f"fig. 4's polynomial at L2 = 1 is {ratio} times (15)^3 (16) at F4 = -10, so the ends are roots of "
            "the same "
            f"factors; the range is {float(left.bounds()[0]):.12f} to {float(left.bounds()[3]):.12f}",
        ),
        {"proportional": bool(ratio.is_number), "equal ends": close},
    )


def slow_and_fast() -> Outcome:
    found = widest()
    one = found.widths[Fraction(1)]

    def fall(at: str) -> tuple[Fraction, Fraction]:
        low, high = found.widths[Fraction(at)]
        return one[0] - high, one[1] - low

    up, down = fall("3/2"), fall("1/2")
    decreasing = bool(found.steps["(4) no fold and no slope 1/2"]) and bool(
        found.steps["(4) two branches, low steeper than 1/2, high not"]
    )
    near = {x: fall(x) for x in ("99/100", "101/100")}
    later = [x for x in sorted(found.widths) if x >= Fraction(3, 2)]
    falls = all(found.widths[a][0] > found.widths[b][1] for a, b in pairwise(later))
    return judge(
        decreasing and falls and up[0] > 0 and down[0] > 5 * up[1],
        (
            f"from L2 = 1 the width falls by {float(up[0]):.6f} up to 3/2 and by {float(down[0]):.6f} down to 1/2",
            "but close to 1 the fall is steep on both sides: "
            + ", ".join(f"{float(v[0]):.6f} at {x}" for x, v in near.items()),
        ),
        {"decreasing above 1": decreasing and falls, "ratio above 5": down[0] > 5 * up[1]},
    )


def two_regions_fig5(figure: str) -> Outcome:
    found = sorted({r.stable for r in region_map(figure).regions if r.stable is not None})
    twos = sum(r.stable == 2 for r in region_map(figure).regions)
    return judge(
        found == [1, 2] and twos == 1,
        (f"stable counts {found}; regions with two: {twos}",),
        {"stable": tuple(found), "regions with two": twos},
    )


def fig5_text() -> Outcome:
    return two_regions_fig5("fig5-text")


def fig5_caption() -> Outcome:
    return two_regions_fig5("fig5-caption")


def which_fig5() -> Outcome:
    text, caption = curves("fig5-text"), curves("fig5-caption")
    same = [c.polynomial for c in text] == [c.polynomial for c in caption]
    ends = [operation_range(f, "rho", -20) for f in ("fig5-text", "fig5-caption")]
    shown = tuple(
        "none" if r is None else f"{float(r.bounds()[0]):.6f} to {float(r.bounds()[3]):.6f}" for r in ends
    )  # fmt: skip
    return judge(
        same,
        (f"at F4 = -20 the two-solution range is {shown[0]} with the text's values, {shown[1]} with the caption's",),
        {"same curve": same, "ranges at F4 = -20": shown},
        corrected=not same,
        right="two different slices: the text has F3 = -10, L2 = 3/2, the caption F3 = -30, L2 = 1; both are "
        "computed here",
    )


def degrees_fig5() -> Outcome:
    found = []
    for figure in ("fig5-text", "fig5-caption"):
        for component in curves(figure):
            even = all(i % 2 == 0 for i, _, _ in component.polynomial.terms)
            found.append((component.polynomial.degrees, even, len(component.polynomial.terms)))
    return judge(
        all(d == (24, 12) and even for d, even, _ in found),
        (f"one irreducible curve in each of the two slices; (degrees in rho and F4, even in rho, terms): {found}",),
        {
            "curves": len(found),
            "degrees": tuple(x for d, _, _ in found for x in d),
            "terms": tuple(n for _, _, n in found),
        },
    )


def one_interval() -> Outcome:
    one = ranges("fig4", "rho", Fraction(1))
    return judge(
        [r.stable for r in one] == [1, 2, 1],
        (f"along L2 = 1 the stable counts are {[r.stable for r in one]}",),
        {"counts": tuple(r.stable for r in one)},
    )


CLAIMS = (
    Claim("4-parameters", "4", "our system depends on 4 independent parameters only",
          "Three lengths and two physical parameters; with lengths over L1 and forces over k four remain.", parameters),
    Claim("4-constant", "4", "the number of solutions in each resulting connected components",
          "Off the discriminant variety the number of solutions is locally constant.", merging),
    Claim("4-tools", "4", "applied successfully in similar classes of problems",
          "The tools have been used for similar problems.", unchecked("a statement about references")),
    Claim("4.3-similar", "4.3", "It looks similar to the unloaded case",
          "One region with two stable equilibria, one stable equilibrium elsewhere.", similar),
    Claim("4.3-curves", "4.3", "three curves of degree 12 in rho and in L2",
          "The boundaries of fig. 4 are three curves of degree 12 with hundreds of terms.", one_curve),
    Claim("4.3-fig4", "4.3", "two stable solutions for L2 = 3/2 and rho = 7/10", "Two stable poses at fig. 4's point.",
          fig4_right),
    Claim("4.3-range", "4.3", "Like in the preceding case, the operation range",
          "Poses with y3, y4 > 0 last exactly over the two-solution region.", range_is_two_region),
    Claim("4.3-widest", "4.3", "reaches its maximal width for L2 = 1",
          "Over L2 the operation range for F3 = F4 = -10 is widest at L2 = 1.", widest_at_one),
    Claim("4.3-same", "4.3", "this range is exactly the same",
          "At L2 = 1 the range equals the one of the symmetric case at F4 = -10.", same_range),
    Claim("4.3-slow", "4.3", "decreases slowly when L2 increases from 1",
          "The width falls slowly for L2 > 1 and much faster for L2 < 1.", slow_and_fast),
    Claim("4.3-one-interval", "4.3", "the operation range is determined",
          "Along rho there is one interval with two stable equilibria.", one_interval),
    Claim("4.3-fig5-text", "4.3", "the red region contains 2 stable solutions",
          "Fig. 5 with the text's values: one region with two, one stable equilibrium elsewhere.", fig5_text),
    Claim("4.3-fig5-caption", "4.3", "with F3 = -30 and L2 = 1",
          "Fig. 5 with the caption's values: one region with two, one stable equilibrium elsewhere.", fig5_caption),
    Claim("4.3-fig5-values", "4.3", "with F3 = -10 and L2 = 3/2", "Text and caption of fig. 5 describe one slice.",
          which_fig5),
    Claim("4.3-fig5-degrees", "4.3", "curves of degree 12 in rho^2 and in F4",
          "The boundaries of fig. 5 have degree 12 in rho^2 and in F4.", degrees_fig5),
)  # fmt: skip
