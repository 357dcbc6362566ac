"""What the claims on figures 2 to 5 rest on: the exact maps of their slices, and ranges along lines in them.

Guarantee: verdicts follow from the exact answers of `ptmcad.classify`, `ptmcad.solve` and `ptmcad.intervals`, and from
the theorem that a Morse function on the torus has as many saddles as minima and maxima together. Signs of heights are
those of boxes around equilibria; that they cannot change inside a cell is shown by statements of the claims.

Figure 5 is two slices, because its text and its caption give different values.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise, product
from random import Random
from typing import Any

import sympy as sp

from ptmcad.answer.intervals import CountIntervals, OperationSpan, lower, upper
from ptmcad.answer.regionmap import Component, Merge, RegionMap, Solution, Status
from ptmcad.answer.widths import OperationWidths
from ptmcad.ask.classification import classify
from ptmcad.ask.ranges import intervals, operation_widths
from ptmcad.question.config import load
from ptmcad.question.slice import Count, Slice
from ptmcad.studies.paper import statements
from ptmcad.studies.paper.claim import Values
from ptmcad.text.enclosure import Enclosure

POINTS: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "fig2": ("fig. 2, right", {"L2": "3/2", "rho": "1"}),
    "fig3": ("fig. 3, right", {"rho": "3/4", "F": "-10"}),
    "fig4": ("fig. 4, right", {"L2": "3/2", "rho": "7/10"}),
    "fig5-text": ("a point of the two-solution region; the paper shows no poses", {"rho": "3/4", "F4": "-20"}),
    "fig5-caption": ("a point of the two-solution region; the paper shows no poses", {"rho": "1/2", "F4": "-20"}),
}
"""For each figure, which is the name of a shipped record: the point whose poses are drawn, and whose choice it is."""
FIGURES = tuple(POINTS)
SEED, RANDOM_POINTS = 2018, 40
FINE = Fraction(1, 10**9)


@cache
def slice_of(figure: str) -> Slice:
    """The slice of a figure of the paper."""
    return replace(load(figure), count=Count.STABLE)


@cache
def region_map(figure: str) -> RegionMap:
    """The region map of a figure of the paper."""
    return classify(slice_of(figure))


def curves(figure: str) -> tuple[Component, ...]:
    """The components of the discriminant variety that have a point in the figure's window."""
    return tuple(c for c in region_map(figure).components if not c.left_out)


@cache
def line(figure: str, along: str, fixed: str) -> CountIntervals:
    """The intervals of constant count along one axis of a figure, at a value of the other one."""
    (other,) = (name for name in slice_of(figure).axis_names if name != along)
    return intervals(slice_of(figure), along, {other: fixed})


def operation(figure: str, along: str, fixed: str) -> OperationSpan:
    """The only interval with two stable equilibria along a line."""
    (found,) = line(figure, along, fixed).operation
    return found


def widths_at(figure: str, values: Sequence[str]) -> list[Enclosure]:
    """Widths of the operation range along rho."""
    return [operation(figure, "rho", value).width for value in values]


# ------------------------------------------------------------------------------------------------------------- counts


def possible_counts(most: int) -> set[tuple[int, int]]:
    """(total, stable) for every Morse function on the torus with at most that many critical points."""
    return {
        (minima + saddles + maxima, minima)
        for minima, saddles, maxima in product(range(most + 1), repeat=3)
        if minima - saddles + maxima == 0 and minima >= 1 and maxima >= 1
        and minima + saddles + maxima <= most
    }  # fmt: skip


@cache
def seen_counts() -> frozenset[tuple[int, int]]:
    """(total, stable) in the cells of the maps and at random points."""
    seen = {(c.total, c.stable) for f in FIGURES for c in region_map(f).cells}
    draw = Random(SEED)
    for _ in range(RANDOM_POINTS):
        at = {n: Fraction(draw.randint(1, 300), 100) for n in ("L2", "rho")}
        at |= {n: Fraction(draw.randint(-20000, 20000), 100) for n in ("F3", "F4", "F3x", "F4x")}
        seen.add((statements.total(**at), statements.stable(**at)))
    return frozenset((total or 0, stable or 0) for total, stable in seen)


def stable_counts(general: bool = False) -> Values:
    """How many equilibria there are, and how many stable ones, by theorem 1 where they are nondegenerate."""
    most = statements.expression("degree(sextic, t2)")
    allowed, seen = possible_counts(int(most)), seen_counts()
    # half of the equilibria are saddles; that there is no general result can only be refuted, by giving one
    listed = "; ".join(
        f"of {t} equilibria {s} stable, {t // 2} saddles, {t - t // 2 - s} of maximal energy"
        for t, s in sorted(allowed)
    )
    return {
        "printed": not general and {s for _, s in allowed} == {1, 2} and seen <= allowed,
        "corrected": general and allowed == {(4, 1), (6, 1), (6, 2)} and seen <= allowed,
        "allowed": tuple(f"{t},{s}" for t, s in sorted(allowed)),
        "pairs": f"{sorted(allowed)}",
        "seen pairs": f"{sorted(seen)}",
        "listed": listed,
        "points": RANDOM_POINTS,
        "attained": max(t for t, _ in seen),
    }


def most_equilibria() -> Values:
    attained = max(t for t, _ in seen_counts())
    return {"printed": attained == 6, "attained": attained}


def both_kinds() -> Values:
    found = [(c.total or 0, c.stable or 0) for f in ("fig2", "fig3", "fig4") for c in region_map(f).cells]
    return {"printed": all(0 < stable < total for total, stable in found), "cells": len(found)}


def three_flat(designs: Mapping[str, Mapping[str, str]]) -> Values:
    """Which flat equilibrium is stable at designs without loads, one in each part of the plane."""
    found = {}
    for name, at in designs.items():
        poses = statements.equilibria(**at).equilibria
        good = [tuple(0 if c.center > 0 else 1 for c in p.cosines_sines[::2]) for p in poses if p.flat and p.stable]
        found[name] = ", ".join(f"({', '.join('0' if a == 0 else 'pi' for a in pair)})" for pair in good) or "none"
    never = [n for n in ("(0, 0)", "(0, pi)", "(pi, 0)", "(pi, pi)") if n not in " ".join(found.values())]
    return {
        "printed": len(never) == 3,
        "corrected": all("), (" not in s for s in found.values()) and never == ["(pi, pi)"],
        "stable": tuple(found.values()),
        "never": tuple(never),
        "stable by design": "; ".join(f"{n}: {s}" for n, s in found.items()),
    }


def regions(figure: str) -> Values:
    """That one region has two stable equilibria, and the others one."""
    found = [(r.stable, r.total) for r in region_map(figure).regions]
    counts = sorted({stable for stable, _ in found if stable is not None})
    twos = sum(stable == 2 for stable, _ in found)
    return {
        "printed": counts == [1, 2] and twos == 1,
        "stable": tuple(counts),
        "regions with two": twos,
        "regions": f"{found}",
        "by index": f"{sorted({c.index for c in region_map(figure).cells if c.index is not None})}",
    }


def merging() -> Values:
    """Whether cells that only the decomposition parts have the same numbers of minima, saddles and maxima."""
    kept = all(
        m.cells[link.first].index == m.cells[link.second].index or link.merge is not Merge.PROVEN
        for m in map(region_map, FIGURES) for link in m.adjacencies
    )  # fmt: skip
    return {"printed": kept}


def computer_algebra() -> Values:
    maps = {figure: region_map(figure) for figure in FIGURES}
    exact = sum(m.status is Status.EXACT and m.undetermined == 0 for m in maps.values())
    counted = all(c.total is not None and c.stable is not None for m in maps.values() for c in m.cells)
    return {
        "printed": exact == len(FIGURES) and counted,
        "exact maps": exact,
        "figures": len(FIGURES),
        "cells": ", ".join(f"{len(m.cells)} of {figure}" for figure, m in maps.items()),
    }


def unsymmetric() -> Values:
    """Totals over the cells of fig. 3."""
    totals = sorted({c.total for c in region_map("fig3").cells if c.total is not None})
    return {"printed": totals == [6], "corrected": totals == [4, 6], "totals": tuple(totals)}


# ------------------------------------------------------------------------------------------------------------- curves


def curves_are(figure: str, texts: Sequence[str]) -> Values:
    """Whether the curves of a figure's variety are those given by polynomials, up to factors."""
    names = slice_of(figure).axis_names
    plain = {name: sp.Symbol(name) for name in names}
    wanted = [sp.sympify(text, locals=plain) for text in texts]
    found = [c.polynomial.to_sympy(names) for c in curves(figure)]
    matched = tuple(sum(bool(sp.cancel(f / w).is_number) for f in found) for w in wanted)
    return {
        "printed": matched == (1,) * len(found),
        "matched": matched,
        "curves": len(found),
        "listed": ", ".join(sorted(c.polynomial.text(names) for c in curves(figure))),
    }


def one_curve(figures: Sequence[str], printed: int) -> Values:
    """Whether there are that many curves of degree 12 in each axis, or one of degree 12 in rho^2 and in the other."""
    found = [
        (c.polynomial.degrees, all(i % 2 == 0 for i, _, _ in c.polynomial.terms), len(c.polynomial.terms))
        for figure in figures for c in curves(figure)
    ]  # fmt: skip
    squared = len(found) == len(figures) and all(d == (24, 12) and even for d, even, _ in found)
    as_printed = len(found) == printed and all(d == (12, 12) for d, _, _ in found)
    return {
        "printed": as_printed if printed else squared,
        "corrected": squared,
        "curves": len(found),
        "degrees": found[0][0],
        "terms": tuple(n for _, _, n in found),
        "found": f"{found}",
    }


def even(figure: str, axis: int) -> Values:
    """Whether all curves have only even powers of an axis."""
    return {"printed": all(powers[axis] % 2 == 0 for c in curves(figure) for powers in c.polynomial.terms)}


def same_at(figure: str, axis: str, value: int, text: str) -> Values:
    """Whether a figure's curve at a value of an axis is a product, and its range along rho that of fig. 3."""
    names = slice_of(figure).axis_names
    cut = curves(figure)[0].polynomial.to_sympy(names).subs(sp.Symbol(axis), value)
    ratio = sp.cancel(cut / sp.sympify(text, locals={"rho": sp.Symbol("rho")}))
    left, right = line(figure, "rho", str(value)).operation, line("fig3", "rho", "-10").operation
    (mine,), (other,) = left, right
    ends = ((mine.low, other.low), (mine.high, other.high))
    close = all(lower(a) <= upper(b) and lower(b) <= upper(a) for a, b in ends)
    return {
        "printed": bool(ratio.is_number) and close,
        "ratio": str(ratio),
        "low": float(mine.low),
        "high": float(mine.high),
    }


def two_slices() -> Values:
    """Whether text and caption of fig. 5 have the same curve."""
    text, caption = ([c.polynomial for c in curves(f)] for f in ("fig5-text", "fig5-caption"))
    spans = [operation(f, "rho", "-20") for f in ("fig5-text", "fig5-caption")]
    shown = tuple(f"{float(s.low):.6f} to {float(s.high):.6f}" for s in spans)
    return {"printed": text == caption, "corrected": text != caption, "text": shown[0], "caption": shown[1]}


# ------------------------------------------------------------------------------------------------------------ heights


def heights(solution: Solution) -> tuple[int, int]:
    """The signs of y3 and y4 of an equilibrium, which are those of its sines; 0 where its box meets zero."""
    first, second = ((s > solution.radius) - (s < -solution.radius) for s in (solution.center[1], solution.center[3]))
    return first, second


def patterns(figure: str) -> dict[int, set[tuple[tuple[int, int], ...]]]:
    """For each stable count, the signs of (y3, y4) of the stable equilibria over a figure's cells."""
    found: dict[int, set[tuple[tuple[int, int], ...]]] = {}
    for cell in region_map(figure).cells:
        signs = tuple(sorted(heights(s) for s in cell.solutions if s.signs == "++"))
        found.setdefault(cell.stable or 0, set()).add(signs)
    return found


def range_is_region(figure: str) -> Values:
    """Whether poses with y3, y4 > 0 last exactly over the two-solution region, and the others are reversed."""
    found = patterns(figure)
    return {
        "printed": found == {1: {((-1, -1),)}, 2: {((-1, -1), (1, 1))}},
        "one": f"{sorted(found[1])}",
        "two": f"{sorted(found[2])}",
    }


def mirrored() -> Values:
    """Without loads: one stable equilibrium is flat; two are mirror images."""
    flat = images = True
    for cell in region_map("fig2").cells:
        stable = [s for s in cell.solutions if s.signs == "++"]
        signs = [heights(s) for s in stable]
        if cell.stable == 1:
            flat &= signs == [(0, 0)]
        else:
            (a, b), near = stable, sum(s.radius for s in stable)
            images &= {*signs} == {(1, 1), (-1, -1)} and all(
                abs(x - sign * y) <= near for x, y, sign in zip(a.center, b.center, (1, -1, 1, -1), strict=True)
            )
    return {"printed": flat and images, "one: flat": flat, "two: mirror images": images}


# ------------------------------------------------------------------------------------------------------------- ranges


def unloaded_widths(lengths: Sequence[str], constant: bool) -> Values:
    """Whether the range without loads has the width min(L1, L2), or the same one at all lengths, at some L2."""
    found = widths_at("fig2", lengths)
    right = all(abs(w.center - min(Fraction(x), Fraction(1))) < FINE for x, w in zip(lengths, found, strict=True))
    equal = all(abs(w.center - found[0].center) < FINE for w in found)
    return {
        "printed": equal if constant else right,
        "corrected": right and mirrored()["two: mirror images"],
        "lengths": ", ".join(lengths),
        "widths": ", ".join(f"{float(w.center):.9g} at L2 = {x}" for x, w in zip(lengths, found, strict=True)),
    }


def falling(figure: str, values: Sequence[str], limit: Mapping[str, Any] | None = None) -> Values:
    """Whether the range along rho gets narrower from each value of the other axis to the next."""
    found = widths_at(figure, values)
    falls = all(a.low > b.high for a, b in pairwise(found))
    if limit is not None:  # before the first value the range is that of another slice
        whole = operation(**limit).width
        falls = falls and found[0].high < whole.low + FINE and found[0].low > Fraction(99, 100) and whole.center == 1
    listed = ", ".join(f"{x}: {float(w.center):.9f}" for x, w in zip(values, found, strict=True))
    return {"printed": falls, "widths": listed}


@cache
def over_length() -> OperationWidths:
    """The operation range of fig. 4 over L2: `ptmcad range --over`, which proves where it is widest."""
    return operation_widths(slice_of("fig4"), "rho", rows=39)


def row_widths() -> dict[Fraction, Enclosure]:
    """The range's width in every row that has one."""
    return {row.value: row.operation[0].width for row in over_length().rows if row.operation}


def widest_at_one() -> Values:
    found, maxima = row_widths(), over_length().maxima
    larger = [x for x, w in found.items() if w.low > found[Fraction(1)].high]
    return {
        "printed": len(maxima) == 1 and maxima[0].at.low == maxima[0].at.high == 1 and not larger,
        "maxima": "; ".join(m.words("L2") for m in maxima),
        "widths": ", ".join(
            f"{float(x):g}: {float(w.center):.9f}" for x, w in found.items() if x % Fraction(1, 4) == 0
        ),
        "witness": f"L2 = {larger[0]} is wider" if larger else "",
    }


def slow_and_fast() -> Values:
    """Whether the width falls from L2 = 1 on, and much less to 3/2 than to 1/2."""
    found = row_widths()
    later = [found[x] for x in sorted(found) if x >= 1]
    falls = all(a.low > b.high for a, b in pairwise(later))
    best = found[Fraction(1)].center
    up, down = (float(best - found[Fraction(x)].center) for x in ("3/2", "1/2"))
    near = {x: float(best - widths_at("fig4", [x])[0].center) for x in ("99/100", "101/100")}
    return {
        "printed": falls and up > 0 and down > 5 * up,
        "decreasing above 1": falls,
        "up": up,
        "down": down,
        "near": ", ".join(f"{v:.6f} at {x}" for x, v in near.items()),
    }


def one_interval() -> Values:
    counts = [i.stable for i in line("fig4", "rho", "1").intervals]
    joined = [n for n, before in zip(counts, [None, *counts], strict=False) if n != before]
    return {"printed": joined == [1, 2, 1], "counts": tuple(joined), "counts list": f"{joined}"}
