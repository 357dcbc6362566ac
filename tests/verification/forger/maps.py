"""True maps to alter: shipped slices, with areas or without, and random ones."""

from __future__ import annotations

from pathlib import Path

from support.random_slices import REFUSED, drawn

import ptmcad
from ptmcad.answer.regionmap import RegionMap

CONFIGS = Path(__file__).resolve().parents[3] / "configs"


def named(name: str) -> RegionMap:
    """The map of a shipped slice, without areas where its name ends with ``+no-areas``, or of a
    random one.
    """
    if name.isdigit():
        number = int(name)
        return ptmcad.classify(
            ptmcad.slice_from_mapping(drawn(number, len(REFUSED.get(number, ()))).record)
        )
    stem, _, without = name.partition("+")
    return ptmcad.classify(ptmcad.load(CONFIGS / f"{stem}.yaml"), areas=not without)
