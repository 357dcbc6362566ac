"""What the paper claims of several figures: two stable poses at a point, one region with two, the range's extent.

Guarantee: verdicts follow from exact counts at named points and in every cell of the figures' maps, signs of heights
from boxes around equilibria, and that they cannot change inside a cell from an identity for all lengths and forces.
"""

from __future__ import annotations

import sympy as sp

from ptmcad.studies.paper.claim import Fact, Finding
from ptmcad.studies.paper.slices import equilibria_at, heights, region_map
from ptmcad.studies.paper.symbolic import F3, F4, L1, L2, VERTICAL, c1, c2, gradient, hessian, k, s1, s2
from ptmcad.studies.slices import Exact


def two_stable(**at: Exact) -> Finding:
    found = equilibria_at(**at)
    return Finding(found.stable == 2, {"total": found.total, "stable": found.stable})


def two_regions(figure: str) -> Finding:
    regions = [(r.stable, r.total) for r in region_map(figure).regions]
    found = sorted({stable for stable, _ in regions if stable is not None})
    twos = sum(stable == 2 for stable, _ in regions)
    facts: dict[str, Fact] = {"stable": tuple(found), "regions with two": twos, "regions": len(regions)}
    return Finding(found == [1, 2] and twos == 1, facts, said={"found": found, "regions": regions})


def range_is_two_region(figure: str) -> Finding:
    patterns = signs_of_heights(figure)
    never_level = no_level_rod_is_stable()
    return Finding(
        never_level and patterns == {1: {((-1, -1),)}, 2: {((-1, -1), (1, 1))}},
        {"y3, y4 not zero": never_level, "patterns": tuple(str(sorted(patterns[n])) for n in (1, 2))},
        said={"one": sorted(patterns[1]), "two": sorted(patterns[2])},
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
