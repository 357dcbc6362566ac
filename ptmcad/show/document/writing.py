"""Writing a region map as JSON.

Guarantee: numbers are written exactly, areas of an exact map as decimals of 18 digits rounded outwards; the same map
gives the same text, timings apart.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.show.document.parts import SLICE, SYSTEM, sequences
from ptmcad.text.numerals import text_of

if TYPE_CHECKING:  # a map of the exact engine has no cover
    from ptmcad.cover.rectangles import Cover, Patch

FORMAT = "ptmcad-region-map/2"


def write(result: RegionMap, timings: bool = True) -> str:
    """The map as JSON text, one record a line, so that differences between two files stay small."""
    data = _encode(result)
    if timings:
        data["timings"] = {name: round(seconds, 6) for name, seconds in result.timings.items()}
    lines = []
    for key, value in data.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            items = ",\n".join("    " + json.dumps(item, ensure_ascii=False) for item in value)
            lines.append(f"  {json.dumps(key)}: [\n{items}\n  ]")
        else:
            lines.append(f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}")
    if result.cover is not None:
        lines.append(_cover(result.cover))
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _encode(result: RegionMap) -> dict[str, Any]:
    names = result.slice.axis_names
    several = sequences(names, result.cover is not None)
    return {
        "format": FORMAT,
        "status": result.status.value,
        "slice": SLICE.write(result.slice),
        "system": SYSTEM.write(result.system),
        "base": names[result.base],
        "complex_solutions": result.complex_solutions,
        "undetermined": text_of(result.undetermined),
        **{name: [codec.write(v) for v in getattr(result, name)] for name, codec in several.items()},
        "versions": dict(result.versions),
        "precision": dict(result.precision),
    }


def _cover(cover: Cover) -> str:
    """The cover with a line for each rectangle and nothing more: there may be a million of them."""
    rectangles = ",\n".join(f"{left},{right},{low},{high}" for left, right, low, high in cover.rectangles)
    slanted = ",\n".join(json.dumps(_patch(patch), separators=(",", ":")) for patch in cover.patches)
    patches = f', "patches": [\n{slanted}\n]' if cover.patches else ""
    return f'  "cover": {{"steps": {cover.steps}, "rectangles": [\n{rectangles}\n]{patches}}}'


def _patch(patch: Patch) -> list[Any]:
    """Its frame and its axis, then for each tube the half width and the controls."""
    return [*patch.frame, patch.along, *([tube.half, *tube.controls] for tube in patch.tubes)]
