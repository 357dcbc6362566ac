"""The claims of the abstract, the introduction and the conclusions that sum up the paper.

Guarantee: verdicts follow from polynomial identities, exact counts, and the theorem that a Morse function on the torus
has as many saddles as minima and maxima together.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from itertools import product
from random import Random

import sympy as sp

from ptmcad.answer.regionmap import Status
from ptmcad.studies.paper.claim import Finding
from ptmcad.studies.paper.claims.unloaded_map import stable_by_region
from ptmcad.studies.paper.printed import SIN_SUM
from ptmcad.studies.paper.slices import FIGURES, equilibria_at, ranges, region_map
from ptmcad.studies.paper.symbolic import F3, F4, L1, L2, UNLOADED, gradient, k, rho, sextic

SEED, POINTS = 2018, 40


def possible_counts(most: int) -> set[tuple[int, int]]:
    """(total, stable) for every Morse function on the torus with at most that many critical points."""
    return {
        (minima + saddles + maxima, minima)
        for minima, saddles, maxima in product(range(most + 1), repeat=3)
        if minima - saddles + maxima == 0 and minima >= 1 and maxima >= 1
        and minima + saddles + maxima <= most
    }  # fmt: skip


def when_infinite() -> tuple[bool, bool]:
    """Whether the eliminated polynomial vanishes identically without loads at rho = 0, and nowhere else.

    Its coefficients are q0, ..., q6, for k = 1. The second follows step by step: q6 - q0 is a positive multiple of
    L2 rho F4^2, so rho = 0 or F4 = 0. If F4 = 0, then q3 is a multiple of F3 rho^2, so F3 = 0 or rho = 0, and without
    loads q2 and q4 are multiples of rho^2 times L1^2 - (L2 +- 2 rho)^2, which are both zero for rho = 0 only. If
    rho = 0, then q5 gives F3 F4 = 0, and q0 then F3 = F4 = 0.
    """
    q = sextic()[::-1]
    at_base = all(sp.expand(c.subs({rho: 0, F3: 0, F4: 0})) == 0 for c in q)
    first = sp.factor(q[6] - q[0])
    steps = [sp.expand(first - 32 * L2 * rho * F4**2) == 0]
    steps.append(sp.expand(q[3].subs(F4, 0) - 256 * L2 * F3 * rho**2) == 0)
    unloaded = {F3: 0, F4: 0}
    plus, minus = (L1**2 - (L2 + 2 * rho) ** 2, L1**2 - (L2 - 2 * rho) ** 2)
    steps.append(sp.expand(q[4].subs(unloaded) + 64 * rho**2 * plus) == 0)
    steps.append(sp.expand(q[2].subs(unloaded) + 64 * rho**2 * minus) == 0)
    steps.append(sp.expand(minus - plus - 8 * L2 * rho) == 0)
    steps.append(sp.expand(q[5].subs(rho, 0) - 16 * L2 * F3 * F4**2) == 0)
    steps.append(sp.expand(q[0].subs({rho: 0, F3: 0}) - 4 * L2**2 * F4**2) == 0)
    steps.append(sp.expand(q[0].subs({rho: 0, F4: 0}) + 4 * L1**2 * F3**2) == 0)
    return at_base, all(steps)


def up_to_six() -> Finding:
    bound = len(sextic()) - 1
    attained = max(c.total or 0 for f in FIGURES for c in region_map(f).cells)
    return Finding(bound == 6 and attained == 6, {"bound": bound, "attained": attained})


def always_up_to_six() -> Finding:
    at_base, only_there = when_infinite()
    circle = all(sp.expand(g.subs(UNLOADED).subs(rho, 0) + k * L1 * L2 * SIN_SUM) == 0 for g in gradient())
    generic = up_to_six()
    return Finding(
        generic.printed and only_there and not at_base,
        {**generic.facts, "infinite at rho = 0 unloaded": at_base and circle, "only there": only_there},
        corrected=generic.printed and at_base and only_there and circle,
    )


@lru_cache(maxsize=1)
def allowed_and_seen() -> tuple[frozenset[tuple[int, int]], frozenset[tuple[int, int]]]:
    """(total, stable) by theorem 1 where the equilibria are nondegenerate, and in the maps and at random points."""
    allowed = possible_counts(len(sextic()) - 1)
    seen = {(c.total, c.stable) for f in FIGURES for c in region_map(f).cells}
    draw = Random(SEED)
    for _ in range(POINTS):
        at = {n: Fraction(draw.randint(1, 300), 100) for n in ("L2", "rho")}
        loads = {n: Fraction(draw.randint(-20000, 20000), 100) for n in ("F3", "F4", "F3x", "F4x")}
        found = equilibria_at(**at, **loads)
        seen.add((found.total, found.stable))
    return frozenset(allowed), frozenset((t or 0, s or 0) for t, s in seen)


def one_or_two_stable() -> Finding:
    allowed, seen = allowed_and_seen()
    stable = {s for _, s in allowed}
    return Finding(
        stable == {1, 2} and seen <= allowed,
        {
            "allowed": tuple(f"{a},{b}" for a, b in sorted(allowed)),
            "seen": tuple(f"{a},{b}" for a, b in sorted(seen)),
        },
        said={"pairs": sorted(allowed), "POINTS": POINTS, "seen pairs": sorted(seen)},
    )


def constant_width() -> Finding:
    widths = {}
    for length2 in ("1/2", "1", "2"):
        (two,) = (r for r in ranges("fig2", "rho", length2) if r.stable == 2)
        widths[length2] = two.width()
    values = [w[0] for w in widths.values()]
    close = all(
        abs(v - w) < Fraction(1, 10**9) for v, w in zip(values, (Fraction(1, 2), Fraction(1), Fraction(1)), strict=True)
    )
    mirrored = bool(stable_by_region().facts["two: mirror images"])
    return Finding(
        all(abs(v - values[0]) < Fraction(1, 10**9) for v in values),
        {"widths": tuple(f"{float(v):.9g}" for v in values), "mirror images": mirrored},
        corrected=close and mirrored,
        said={"widths listed": ", ".join(f"{float(v):.9g} at L2 = {x}" for x, v in zip(widths, values, strict=True))},
    )


def computer_algebra() -> Finding:
    maps = {figure: region_map(figure) for figure in FIGURES}
    exact = sum(m.status is Status.EXACT and m.undetermined == 0 for m in maps.values())
    counted = all(c.total is not None and c.stable is not None for m in maps.values() for c in m.cells)
    cells = ", ".join(f"{len(m.cells)} of {figure}" for figure, m in maps.items())
    return Finding(
        exact == len(FIGURES) and counted,
        {"exact maps": exact, "all counted": counted},
        said={"figures": len(FIGURES), "cells": cells},
    )
