"""Whether two maps of one slice say the same: regions, counts, neighbours and areas, whatever their decompositions.

Guarantee: `difference` is empty only if the regions of both exact maps correspond one to one, with equal counts, the
same pairs of neighbours and areas whose bounds overlap. Of certified maps it says only that no sample's counts
contradict each other.
"""

from __future__ import annotations

from collections.abc import Iterator

from ptmcad.answer.regionmap import Merge, RegionMap


def difference(one: RegionMap, other: RegionMap) -> str:
    """What the maps disagree on; empty when they say the same."""
    found = _certified(one, other) if one.cover is not None else _exact(one, other)
    return next(found, "")


def _exact(one: RegionMap, other: RegionMap) -> Iterator[str]:
    if len(one.regions) != len(other.regions):
        yield f"{len(one.regions)} regions and {len(other.regions)}"
        return
    pairs: set[tuple[int, int]] = set()
    for first, second, forward in ((one, other, True), (other, one, False)):
        for cell in first.cells:
            at = second.locate(**dict(cell.sample))
            if at.region is None:  # on a curve that only one of the maps uses
                continue
            if (at.total, at.stable, at.index) != (cell.total, cell.stable, cell.index):
                yield f"other counts at {dict(cell.sample)}"
            pairs.add((cell.region, at.region) if forward else (at.region, cell.region))
    partner = dict(pairs)
    if not len(pairs) == len(partner) == len(set(partner.values())) == len(one.regions):
        yield "the regions do not correspond"
        return
    for n, m in partner.items():
        a, b = one.regions[n], other.regions[m]
        if (a.stable, a.total, a.index) != (b.stable, b.total, b.index):
            yield f"other counts of region {n}"
        if a.area[0] > b.area[1] or b.area[0] > a.area[1]:
            yield f"another area of region {n}"
    mapped = {frozenset(partner[n] for n in pair) for pair in neighbours(one)}
    if mapped != neighbours(other):
        yield "other neighbours"


def neighbours(result: RegionMap) -> set[frozenset[int]]:
    """Pairs of regions that share an arc."""
    region = [cell.region for cell in result.cells]
    return {frozenset((region[a.first], region[a.second])) for a in result.adjacencies if a.merge is Merge.SEPARATED}


def _certified(one: RegionMap, other: RegionMap) -> Iterator[str]:
    for first, second in ((one, other), (other, one)):
        for cell in first.cells:
            at = second.locate(**dict(cell.sample))
            for name in ("total", "stable", "index", "admissible"):
                mine, yours = getattr(cell, name), getattr(at, name)
                if mine is not None and yours is not None and mine != yours and name == first.slice.count.value:
                    yield f"another {name} at {dict(cell.sample)}"
