"""What the paper claims of several figures: two stable poses at a point, one region with two, the range's extent.

Guarantee: verdicts follow from exact counts at named points and in every cell of the figures' maps.
"""

from __future__ import annotations

from ptmcad.studies.paper.claim import Fact, Finding
from ptmcad.studies.paper.heights import no_level_rod_is_stable, signs_of_heights
from ptmcad.studies.paper.slices import equilibria_at, region_map
from ptmcad.studies.slices import Exact


def two_stable(**at: Exact) -> Finding:
    found = equilibria_at(**at)
    return Finding(found.stable == 2, {"total": found.total, "stable": found.stable})


def two_regions(figure: str) -> Finding:
    found = sorted({r.stable for r in region_map(figure).regions if r.stable is not None})
    twos = sum(r.stable == 2 for r in region_map(figure).regions)
    facts: dict[str, Fact] = {"stable": tuple(found), "regions with two": twos}
    return Finding(found == [1, 2] and twos == 1, facts, said={"found": found})


def range_is_two_region(figure: str) -> Finding:
    patterns = signs_of_heights(figure)
    never_level = no_level_rod_is_stable()
    return Finding(
        never_level and patterns == {1: {((-1, -1),)}, 2: {((-1, -1), (1, 1))}},
        {"y3, y4 not zero": never_level, "patterns": tuple(str(sorted(patterns[n])) for n in (1, 2))},
        said={"one": sorted(patterns[1]), "two": sorted(patterns[2])},
    )
