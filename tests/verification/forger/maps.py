"""True maps to alter: shipped slices, with savings switched off or not, and random ones."""

from __future__ import annotations

from pathlib import Path

from support.random_slices import REFUSED, drawn

import ptmcad
from ptmcad.answer.regionmap import RegionMap

CONFIGS = Path(__file__).resolve().parents[3] / "configs"


def named(name: str) -> RegionMap:
    """The map of a shipped slice, with savings that are switched off after plus signs, or of a random one by number."""
    if name.isdigit():
        number = int(name)
        return ptmcad.classify(ptmcad.slice_from_mapping(drawn(number, len(REFUSED.get(number, ()))).record))
    stem, *without = name.split("+")
    areas = "no-areas" not in without
    return ptmcad.classify(
        ptmcad.load(CONFIGS / f"{stem}.yaml"), without=[k for k in without if k != "no-areas"], areas=areas
    )
