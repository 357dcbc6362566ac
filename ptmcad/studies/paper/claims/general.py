"""The claims of section 4's opening and of 4.3: unequal rods, equal and unequal forces.

Guarantee: verdicts follow from the exact region maps of figs. 4 and 5 and from isolated roots of their varieties.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import sympy as sp

from ptmcad.answer.regionmap import Merge
from ptmcad.studies.paper import printed
from ptmcad.studies.paper.claim import Fact, Finding
from ptmcad.studies.paper.operation_range import widest
from ptmcad.studies.paper.slices import curves, operation_range, ranges, region_map
from ptmcad.studies.paper.symbolic import F3, F4, L1, L2, VERTICAL, gradient, k, rho


def parameters() -> Finding:
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
    return Finding(
        degree(lengths) is not None,
        facts,
        corrected=degree(with_loads) == 2 and degree(forces) == 1 and independent == 4,
        said={"independent": independent},
    )


def merging() -> Finding:
    kept = True
    for figure in ("fig2", "fig3", "fig4", "fig5-text", "fig5-caption"):
        cells = region_map(figure).cells
        for link in region_map(figure).adjacencies:
            same = cells[link.first].index == cells[link.second].index
            kept &= same or link.merge is not Merge.PROVEN
    return Finding(kept, {"constant": kept})


def one_curve() -> Finding:
    found = [(c.polynomial.degrees, len(c.polynomial.terms)) for c in curves("fig4")]
    (degrees, terms), *others = found
    in_square = all(i % 2 == 0 for i, _, _ in curves("fig4")[0].polynomial.terms)
    return Finding(
        len(found) == 3 and all(d == (12, 12) for d, _ in found),
        {"curves": len(found), "degrees": degrees, "terms": terms, "even in rho": in_square},
        corrected=not others and degrees == (24, 12) and in_square,
        said={"first": degrees[0], "second": degrees[1]},
    )


def similar() -> Finding:
    unloaded, loaded = ([r.stable for r in region_map(f).regions] for f in ("fig2", "fig4"))
    one_two = loaded.count(2) == 1 and set(loaded) == {1, 2}
    return Finding(
        one_two,
        {"regions": len(loaded), "with two": loaded.count(2), "counts": tuple(sorted({n for n in loaded if n}))},
        said={"loaded": loaded, "unloaded": unloaded},
    )


def widest_at_one() -> Finding:
    found = widest()
    at = {str(x): f"{float(low):.9f}" for x, (low, _) in found.widths.items()}
    facts: dict[str, Fact] = {
        "steps": tuple(f"{step}: {shown}" for step, shown in found.steps.items()),
        "width at 1": at["1"],
    }
    one = found.widths[Fraction(1)]
    larger = [x for x, (low, _) in found.widths.items() if low > one[1]]
    said = {
        "widths": ", ".join(f"{x}: {w}" for x, w in at.items()),
        "shown": "; ".join(step for step, shown in found.steps.items() if shown),
        "witness": f"L2 = {larger[0]} is wider" if larger else "",
    }
    return Finding(found.proved and not larger, facts, said=said)


def same_range() -> Finding:
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
    return Finding(
        bool(ratio.is_number) and close,
        {"proportional": bool(ratio.is_number), "equal ends": close},
        said={"ratio": ratio, "low": float(left.bounds()[0]), "high": float(left.bounds()[3])},
    )


def slow_and_fast() -> Finding:
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
    return Finding(
        decreasing and falls and up[0] > 0 and down[0] > 5 * up[1],
        {"decreasing above 1": decreasing and falls, "ratio above 5": down[0] > 5 * up[1]},
        said={
            "up": float(up[0]),
            "down": float(down[0]),
            "near": ", ".join(f"{float(v[0]):.6f} at {x}" for x, v in near.items()),
        },
    )


def which_fig5() -> Finding:
    text, caption = curves("fig5-text"), curves("fig5-caption")
    same = [c.polynomial for c in text] == [c.polynomial for c in caption]
    ends = [operation_range(f, "rho", -20) for f in ("fig5-text", "fig5-caption")]
    shown = tuple(
        "none" if r is None else f"{float(r.bounds()[0]):.6f} to {float(r.bounds()[3]):.6f}" for r in ends
    )  # fmt: skip
    return Finding(
        same,
        {"same curve": same, "ranges at F4 = -20": shown},
        corrected=not same,
        said={"text": shown[0], "caption": shown[1]},
    )


def degrees_fig5() -> Finding:
    found = []
    for figure in ("fig5-text", "fig5-caption"):
        for component in curves(figure):
            even = all(i % 2 == 0 for i, _, _ in component.polynomial.terms)
            found.append((component.polynomial.degrees, even, len(component.polynomial.terms)))
    return Finding(
        all(d == (24, 12) and even for d, even, _ in found),
        {
            "curves": len(found),
            "degrees": tuple(x for d, _, _ in found for x in d),
            "terms": tuple(n for _, _, n in found),
        },
        said={"found": found},
    )


def one_interval() -> Finding:
    one = ranges("fig4", "rho", Fraction(1))
    return Finding(
        [r.stable for r in one] == [1, 2, 1],
        {"counts": tuple(r.stable for r in one)},
        said={"counts list": [r.stable for r in one]},
    )
