"""Writing a region map as JSON.

Guarantee: numbers are written exactly, areas of an exact map as decimals of 18 digits rounded outwards; the same map
gives the same text, timings apart.
"""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

from ptmcad.answer.regionmap import RegionMap, Segment
from ptmcad.cover.rectangles import Cover
from ptmcad.question.slice import Point
from ptmcad.text.numerals import decimal, integer_text, shortest_text, text_of

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
    certified = result.cover is not None
    return {
        "format": FORMAT,
        "status": result.status.value,
        "slice": {
            "name": result.slice.name,
            "title": result.slice.title,
            "mechanism": result.slice.mechanism,
            "axes": {a.name: [text_of(a.low), text_of(a.high)] for a in result.slice.axes},
            "parameters": {n: e.to_text(names) for n, e in result.slice.parameters.items()},
            "text": dict(result.slice.text),
            "count": result.slice.count.value,
            "reference": dict(result.slice.reference),
        },
        "system": {
            "unknowns": result.system.unknowns,
            "relations": result.system.relations,
            "potential": result.system.potential,
            "gradient": result.system.gradient,
            "hessian": result.system.hessian,
        },
        "base": names[result.base],
        "complex_solutions": result.complex_solutions,
        "undetermined": text_of(result.undetermined),
        "regions": [
            {
                "stable": r.stable,
                "total": r.total,
                "index": r.index,
                **({"admissible": r.admissible} if certified else {}),
                "area": _exact(r.area) if certified else _decimals(r.area),
                "sample": _point(r.sample),
                "cells": r.cells,
            }
            for r in result.regions
        ],
        "components": [
            {
                "kind": c.kind.value,
                "separates": c.separates,
                "left_out": c.left_out,
                "polynomial": c.polynomial.text(names),
            }
            for c in result.components
        ],
        "critical_values": [
            {
                "polynomial": [integer_text(c) for c in v.polynomial],
                "low": text_of(v.low),
                "high": text_of(v.high),
                "origin": v.origin,
            }
            for v in result.critical_values
        ],
        "stacks": [
            {
                "left": s.left,
                "right": s.right,
                "sample": text_of(s.sample),
                "walls": [[w.component, w.root] for w in s.walls],
                "cells": s.cells,
            }
            for s in result.stacks
        ],
        "cells": [
            {
                "stack": c.stack,
                "level": c.level,
                "sample": _point(c.sample),
                "region": c.region,
                "total": c.total,
                "stable": c.stable,
                "index": c.index,
                **({"admissible": c.admissible} if certified else {}),
                "solutions": [
                    {
                        "center": [shortest_text(x) for x in s.center],
                        "radius": shortest_text(s.radius),
                        "signs": s.signs,
                    }
                    for s in c.solutions
                ],
            }
            for c in result.cells
        ],
        "adjacencies": [
            {
                "cells": [a.first, a.second],
                "merge": a.merge.value,
                "component": a.component,
                "segment": _segment(a.segment),
            }
            for a in result.adjacencies
        ],
        "non_adjacencies": [
            {
                "critical_value": a.critical_value,
                "left": a.left,
                "right": a.right,
                "below": _segment(a.below),
                "above": _segment(a.above),
                "reason": a.reason.value,
            }
            for a in result.non_adjacencies
        ],
        "plan": [
            {"what": p.what, "done": p.done, "reason": p.reason} | ({"saving": p.saving} if p.saving else {})
            for p in result.plan
        ],
        "versions": dict(result.versions),
        "precision": dict(result.precision),
    }


def _cover(cover: Cover) -> str:
    """The cover with a line for each rectangle and nothing more: there may be a million of them."""
    rectangles = ",\n".join(f"{left},{right},{low},{high}" for left, right, low, high in cover.rectangles)
    return f'  "cover": {{"steps": {cover.steps}, "rectangles": [\n{rectangles}\n]}}'


def _exact(area: tuple[Fraction, Fraction]) -> list[str]:
    return [text_of(area[0]), text_of(area[1])]


def _decimals(area: tuple[Fraction, Fraction]) -> list[str]:
    return [decimal(area[0], up=False), decimal(area[1], up=True)]


def _point(point: Point) -> dict[str, str]:
    return {name: text_of(point[name]) for name in point.names}


def _segment(segment: Segment | None) -> list[str] | None:
    return None if segment is None else [text_of(q) for q in segment]
