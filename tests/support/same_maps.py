"""Two maps of one slice, whatever their decompositions: whether they say the same."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from ptmcad.answer.regionmap import Merge, RegionMap


def exchanged(record: Path, folder: Path) -> Path:
    """The record with its axes exchanged."""
    data: dict[str, Any] = yaml.safe_load(record.read_text(encoding="utf-8"))
    data["axes"] = dict(reversed(data["axes"].items()))
    model = data.get("mechanism")
    if isinstance(model, str) and (beside := record.resolve().parent / model).is_file():
        data["mechanism"] = str(beside)
    target = folder / f"exchanged-{record.name}"
    target.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
    return target


def difference(one: RegionMap, other: RegionMap) -> str:
    """What two maps of one slice disagree on, whatever their decompositions; empty when they say
    the same.

    Guarantee
    ---------
    Empty only if no sample's counts contradict each other, and if the regions of exact maps
    correspond one to one, with the same pairs of neighbours and areas whose bounds overlap.
    """
    pairs: set[tuple[int, int]] = set()
    for first, second in ((one, other), (other, one)):
        for cell in first.cells:
            at = second.locate(**dict(cell.sample))
            counts = ((cell.total, at.total), (cell.stable, at.stable), (cell.index, at.index))
            if at.region is None:  # on a curve that only one of the maps uses, or undecided
                continue
            if any(mine != yours and None not in (mine, yours) for mine, yours in counts):
                return f"other counts at {dict(cell.sample)}"
            pairs.add((cell.region, at.region) if first is one else (at.region, cell.region))
    if one.cover is not None:
        return ""
    partner = dict(pairs)
    if (
        not len(pairs)
        == len(partner)
        == len(set(partner.values()))
        == len(one.regions)
        == len(other.regions)
    ):
        return f"{len(one.regions)} regions and {len(other.regions)}, which do not correspond"
    for n, m in partner.items():
        (low, high), (least, most) = one.regions[n].area, other.regions[m].area
        if low > most or least > high:
            return f"another area of region {n}"
    pairs_of_one = {frozenset(map(partner.__getitem__, pair)) for pair in neighbours(one)}
    return "" if pairs_of_one == neighbours(other) else "other neighbours"


def neighbours(result: RegionMap) -> set[frozenset[int]]:
    """Pairs of regions that share an arc."""
    region = [cell.region for cell in result.cells]
    return {
        frozenset((region[a.first], region[a.second]))
        for a in result.adjacencies
        if a.merge is Merge.SEPARATED
    }
