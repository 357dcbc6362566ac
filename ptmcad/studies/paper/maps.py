"""What the claims on figures 2 to 5 rest on: the exact maps of their slices, and ranges along lines
in them.

Guarantee: facts follow from the exact answers of `ptmcad.classify`, `ptmcad.solve` and
`ptmcad.intervals`, and from the theorem that a Morse function on the torus has as many saddles as
minima and maxima together. Signs of heights are those of boxes around equilibria; that they cannot
change inside a cell is shown by statements of the claims.

Figure 5 is two slices, because its text and its caption give different values.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import groupby, pairwise
from random import Random
from typing import Any

import sympy as sp

from ptmcad.answer.intervals import CountIntervals, OperationSpan, lower, upper
from ptmcad.answer.regionmap import Component, Merge, RegionMap, Solution, Status
from ptmcad.answer.widths import OperationWidths
from ptmcad.ask.classification import classify
from ptmcad.ask.lines.along import operation_widths
from ptmcad.exact.ranges.exactline import intervals
from ptmcad.question.config import load
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.studies.paper import statements
from ptmcad.studies.paper.claim import Facts
from ptmcad.text.enclosure import Enclosure

POINTS: Mapping[str, tuple[str, Mapping[str, str]]] = statements.TEXTS["figures"]
"""For each figure the point whose poses are drawn, and whose choice it is."""
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


def fall(widths: Sequence[Enclosure]) -> bool:
    """Whether each is smaller than the one before it."""
    return all(a.low > b.high for a, b in pairwise(widths))


# ------------------------------------------------------------------------------------------------------------- counts


@cache
def seen_counts() -> frozenset[tuple[int, int]]:
    """(total, stable) in the cells of the maps and at random points."""
    seen = {(c.total or 0, c.stable or 0) for f in FIGURES for c in region_map(f).cells}
    draw = Random(SEED)
    for _ in range(RANDOM_POINTS):
        at = {n: Fraction(draw.randint(1, 300), 100) for n in ("L2", "rho")}
        at |= {n: Fraction(draw.randint(-20000, 20000), 100) for n in ("F3", "F4", "F3x", "F4x")}
        poses = statements.equilibria(**at)
        seen.add((len(poses.equilibria), poses.stable))
    return frozenset(seen)


def counts() -> Facts:
    """How many equilibria, and stable ones, there may be by theorem 1 where they are nondegenerate,
    and are.
    """
    half = int(statements.expression("degree(sextic, t2)")) // 2
    # as many saddles as minima and maxima, of which there is one each at least
    allowed = [(2 * n, minima) for n in range(2, half + 1) for minima in range(1, n)]
    seen = sorted(seen_counts())
    return {
        "pairs": allowed,
        "stable": sorted({minima for _, minima in allowed}),
        "seen pairs": seen,
        "all seen allowed": {*seen} <= {*allowed},
        "attained": seen[-1][0],
        "points": RANDOM_POINTS,
        "listed": "; ".join(
            f"of {t} equilibria {s} stable, {t // 2} saddles, {t // 2 - s} of maximal energy"
            for t, s in allowed
        ),
    }


def regions(figure: str) -> Facts:
    """The stable counts of a figure's regions, and by cells the total ones and those by minima,
    saddles and maxima.
    """
    found = [(r.stable, r.total) for r in region_map(figure).regions]
    cells = region_map(figure).cells
    return {
        "stable": sorted({stable for stable, _ in found if stable is not None}),
        "regions with two": sum(stable == 2 for stable, _ in found),
        "regions": found,
        "totals": tuple(sorted({c.total for c in cells if c.total is not None})),
        "by index": sorted({c.index for c in cells if c.index is not None}),
    }


def cells() -> Facts:
    """How the maps' cells were counted, and whether those parted by no change have the same
    indices.
    """
    maps = {figure: region_map(figure) for figure in FIGURES}
    first = [c for figure in FIGURES[:3] for c in maps[figure].cells]
    return {
        "exact maps": sum(m.status is Status.EXACT and m.undetermined == 0 for m in maps.values()),
        "figures": len(FIGURES),
        "all counted": all(c.total is not None and c.stable is not None for m in maps.values() for c in m.cells),
        "cells": ", ".join(f"{len(m.cells)} of {figure}" for figure, m in maps.items()),
        "cells of figures 2 to 4": len(first),
        "both kinds": all(0 < (c.stable or 0) < (c.total or 0) for c in first),
        "indices kept": all(
            m.cells[link.first].index == m.cells[link.second].index or link.merge is not Merge.PROVEN
            for m in maps.values() for link in m.adjacencies
        ),
    }  # fmt: skip


# ------------------------------------------------------------------------------------------------------------- curves


def curves_of(figures: Sequence[str], texts: Sequence[str] = ()) -> Facts:
    """The curves of figures, and how many of them each of the polynomials that are given is, up to
    a factor.
    """
    found = [
        (c.polynomial, slice_of(figure).axis_names) for figure in figures for c in curves(figure)
    ]
    wanted = [
        sp.sympify(text, locals={n: sp.Symbol(n) for n in slice_of(figures[0]).axis_names})
        for text in texts
    ]
    even = [[all(powers[n] % 2 == 0 for powers in p.terms) for n in (0, 1)] for p, _ in found]
    return {
        "curves": len(found),
        "degrees": [p.degrees for p, _ in found],
        "even": even,
        "terms": [len(p.terms) for p, _ in found],
        "found": [
            (p.degrees, rho, len(p.terms)) for (p, _), (rho, _) in zip(found, even, strict=True)
        ],
        "matched": [
            sum(bool(sp.cancel(p.to_sympy(n) / w).is_number) for p, n in found) for w in wanted
        ],
        "listed": ", ".join(sorted(p.text(names) for p, names in found)),
    }


def same_at(figure: str, axis: str, value: int, text: str) -> Facts:
    """Whether a figure's curve at a value of an axis is a product, and its range along rho that of
    fig. 3.
    """
    names = slice_of(figure).axis_names
    cut = curves(figure)[0].polynomial.to_sympy(names).subs(sp.Symbol(axis), value)
    ratio = sp.cancel(cut / sp.sympify(text, locals={"rho": sp.Symbol("rho")}))
    mine, other = operation(figure, "rho", str(value)), operation("fig3", "rho", "-10")
    ends = ((mine.low, other.low), (mine.high, other.high))
    return {
        "factor": bool(ratio.is_number),
        "same ends": all(lower(a) <= upper(b) and lower(b) <= upper(a) for a, b in ends),
        "ratio": str(ratio),
        "low": float(mine.low),
        "high": float(mine.high),
    }


def two_slices() -> Facts:
    """Whether text and caption of fig. 5 have the same curve."""
    text, caption = FIGURES[3:]
    spans = [operation(figure, "rho", "-20") for figure in (text, caption)]
    shown = [f"{float(s.low):.6f} to {float(s.high):.6f}" for s in spans]
    same = [c.polynomial for c in curves(text)] == [c.polynomial for c in curves(caption)]
    return {"same": same, "text": shown[0], "caption": shown[1]}


# ------------------------------------------------------------------------------------------------------------ heights


def heights(solution: Solution) -> tuple[int, int]:
    """The signs of y3 and y4 of an equilibrium, which are those of its sines; 0 where its box meets
    zero.
    """
    first, second = (
        (s > solution.radius) - (s < -solution.radius)
        for s in (solution.center[1], solution.center[3])
    )
    return first, second


def patterns(figure: str) -> Facts:
    """For each stable count, the signs of (y3, y4) of the stable equilibria over a figure's cells."""
    found: dict[int | None, set[tuple[tuple[int, int], ...]]] = {}
    for cell in region_map(figure).cells:
        signs = tuple(sorted(heights(s) for s in cell.solutions if s.signs == "++"))
        found.setdefault(cell.stable, set()).add(signs)
    return {"counts": sorted(found, key=str), "one": sorted(found[1]), "two": sorted(found[2])}


def mirrored() -> Facts:
    """Whether without loads one stable equilibrium is flat, and two are mirror images."""
    images = []
    for cell in region_map("fig2").cells:
        if cell.stable == 2:
            a, b = (s for s in cell.solutions if s.signs == "++")
            turned = zip(a.center, b.center, (1, -1, 1, -1), strict=True)
            images.append(all(abs(x - sign * y) <= a.radius + b.radius for x, y, sign in turned))
    return {**patterns("fig2"), "mirror images": all(images)}


# ------------------------------------------------------------------------------------------------------------- ranges


def unloaded_widths(lengths: Sequence[str]) -> Facts:
    """Whether the range without loads has the width min(L1, L2), or the same one at all lengths, at
    some L2.
    """
    found = widths_at("fig2", lengths)
    return {
        "min(L1, L2)": all(
            abs(w.center - min(Fraction(x), Fraction(1))) < FINE for x, w in zip(lengths, found, strict=True)
        ),
        "equal": all(abs(w.center - found[0].center) < FINE for w in found),
        "mirror images": mirrored()["mirror images"],
        "lengths": ", ".join(lengths),
        "widths": ", ".join(f"{float(w.center):.9g} at L2 = {x}" for x, w in zip(lengths, found, strict=True)),
    }  # fmt: skip


def falling(figure: str, values: Sequence[str], limit: Mapping[str, Any] | None = None) -> Facts:
    """Whether the range along rho gets narrower from each value of the other axis to the next."""
    found, near = widths_at(figure, values), True
    if limit is not None:  # before the first value the range is that of another slice
        first, whole = found[0], operation(**limit).width
        near = first.high < whole.low + FINE and first.low > Fraction(99, 100) and whole.center == 1
    listed = ", ".join(f"{x}: {float(w.center):.9f}" for x, w in zip(values, found, strict=True))
    return {"falls": fall(found), "near the limit": near, "widths": listed}


@cache
def over_length() -> OperationWidths:
    """The operation range of fig. 4 over L2: `ptmcad range --over`, which proves where it is
    widest.
    """
    return operation_widths(slice_of("fig4"), "rho", rows=39)


def row_widths() -> dict[Fraction, Enclosure]:
    """The range's width in every row that has one."""
    return {row.value: row.operation[0].width for row in over_length().rows if row.operation}


def widths_over_length() -> Facts:
    """Where the range of fig. 4 is widest, and how it falls from there: from L2 = 1 on, and to 3/2
    and to 1/2.
    """
    found, maxima = row_widths(), over_length().maxima
    best = found[Fraction(1)]
    larger = [x for x, w in found.items() if w.low > best.high]
    up, down, *near = (
        float(best.center - w.center)
        for w in widths_at("fig4", ["3/2", "1/2", "99/100", "101/100"])
    )
    return {
        "places": [str(m.at.low) for m in maxima if m.at.low == m.at.high],
        "number": len(maxima),
        "maxima": "; ".join(m.words("L2") for m in maxima),
        "wider": larger,
        "witness": f"L2 = {larger[0]} is wider" if larger else "",
        "widths": ", ".join(f"{float(x):g}: {float(w.center):.9f}" for x, w in found.items() if 4 * x % 1 == 0),
        "falls above 1": fall([w for x, w in sorted(found.items()) if x >= 1]),
        "down over 5 up": down > 5 * up > 0,
        "up": up,
        "down": down,
        "near": ", ".join(f"{v:.6f} at {x}" for x, v in zip(("99/100", "101/100"), near, strict=True)),
    }  # fmt: skip


def along_one() -> Facts:
    """The stable counts along L2 = 1 in fig. 4."""
    return {
        "counts": [
            count for count, _ in groupby(i.stable for i in line("fig4", "rho", "1").intervals)
        ]
    }
