"""What a map's timings have beside those of its stages."""

from __future__ import annotations

from dataclasses import replace

from ptmcad.answer.regionmap import RegionMap

COMPILATION = "compilation"
"""The timing, beside the total, of what was compiled before the computation: once on a machine."""


def with_compilation(result: RegionMap, seconds: float) -> RegionMap:
    """The map with the seconds that its run has spent compiling, if any, beside its own."""
    return replace(result, timings={**result.timings, COMPILATION: seconds}) if seconds else result
