"""Reading a region map from JSON.

Guarantee: what is returned has the types and sizes that `RegionMap` asks for; every fault is a ValueError that names
its place.
"""

from __future__ import annotations

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.cover.rectangles import Cover
from ptmcad.question.slice import Count, Slice
from ptmcad.show.document.codec import NATURAL, TEXT, named
from ptmcad.show.document.cover import read_cover
from ptmcad.show.document.node import Node, opened
from ptmcad.show.document.parts import SLICE, SYSTEM, sequences
from ptmcad.show.document.writing import FORMAT

# Limits far beyond any slice's result, like those of `ptmcad.show.document.node`.
MAX_TEXT = 60_000_000
MAX_COMPONENTS = 1_000
_EXACT_ONLY = ("components", "critical_values", "stacks", "adjacencies", "non_adjacencies")
"""What a certified map does not have."""


def read(text: str) -> RegionMap:
    """The map in a JSON document.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    return _decode(opened(text, FORMAT, MAX_TEXT, "ptmcad classify"))


def _decode(document: Node) -> RegionMap:
    data = document.record(
        "format", "status", "slice", "system", "base", "complex_solutions", "undetermined", "regions", "components",
        "critical_values", "stacks", "cells", "adjacencies", "non_adjacencies", "plan", "versions", "precision",
        "timings?", "cover?",
    )  # fmt: skip
    slice = SLICE.read(data["slice"])
    status = data["status"].choice(Status)
    cover = read_cover(data["cover"]) if "cover" in data else None
    _check_kind(document, data, slice, status, cover)
    names = slice.axis_names
    if (base := data["base"].text()) not in names:
        raise data["base"].fault(f"is {base[:40]!r}, which is not an axis")
    if len(tuple(data["components"].items())) > MAX_COMPONENTS:
        raise data["components"].fault(f"has more than {MAX_COMPONENTS} entries")
    if (undetermined := data["undetermined"].size()) > 1:
        raise data["undetermined"].fault("is more than the whole window")
    several = sequences(names, cover is not None)
    return RegionMap(
        slice=slice,
        status=status,
        system=SYSTEM.read(data["system"]),
        base=names.index(base),
        complex_solutions=data["complex_solutions"].natural(),
        **{name: data[name].each(codec.read) for name, codec in several.items()},
        undetermined=undetermined,
        versions=named(TEXT).read(data["versions"]),
        precision=named(NATURAL).read(data["precision"]),
        timings={n: s.number() for n, s in data["timings"].mapping().items()} if "timings" in data else {},
        cover=cover,
    )


def _check_kind(document: Node, data: dict[str, Node], slice: Slice, status: Status, cover: Cover | None) -> None:
    """Refuse a map that is half exact and half certified."""
    if cover is None:
        if status is Status.CERTIFIED or slice.count is Count.ADMISSIBLE:
            raise document.fault("lacks the key 'cover', which a certified map has")
        return
    if status not in (Status.CERTIFIED, Status.PARTIAL):
        raise data["status"].fault("is not that of a map with a cover")
    for key in _EXACT_ONLY:
        if data[key].value != []:
            raise data[key].fault("is not empty, as it is in a map with a cover")
