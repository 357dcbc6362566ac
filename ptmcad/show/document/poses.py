"""The equilibria at a point as a JSON document, and back.

Guarantee: reading what was written gives equal `Poses`. A number is written as text with all digits right, and as the
middle and radius of its enclosure, both exact; a document whose texts and enclosures disagree is refused, like one
with a key or a value that does not belong there, with the place of the first fault.

The schema is published as docs/poses.schema.json; its version is part of `FORMAT`.
"""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

from ptmcad.answer.poses import MAX_DIGITS, Pose, Poses, Spring, Vector
from ptmcad.answer.regionmap import Status
from ptmcad.show.document.node import Node, opened
from ptmcad.text.enclosure import Enclosure, exact_text

FORMAT = "ptmcad-poses/1"
MAX_TEXT = 2_000_000
MAX_NAME = 40
MAX_REMARK = 300


def write_poses(poses: Poses) -> str:
    """The poses as JSON text; the same text for equal poses."""
    return json.dumps(_encode(poses), indent=2, ensure_ascii=False) + "\n"


def _encode(poses: Poses) -> dict[str, Any]:
    def number(x: Enclosure) -> dict[str, str]:
        return {"text": x.text(poses.digits), "center": exact_text(x.center), "radius": exact_text(x.radius)}

    return {
        "format": FORMAT,
        "status": poses.status.value,
        "remark": poses.remark,
        "mechanism": poses.mechanism,
        "parameters": {name: exact_text(value) for name, value in poses.parameters.items()},
        "digits": poses.digits,
        "bits": poses.bits,
        "equilibria": [
            {
                "stable": p.stable,
                **({} if p.admissible is None else {"admissible": p.admissible}),
                "index": p.index,
                "multiplicity": p.multiplicity,
                "flat": p.flat,
                "angles": [number(x) for x in p.angles],
                "degrees": [number(x) for x in p.degrees],
                "cosines_sines": [number(x) for x in p.cosines_sines],
                "nodes": {name: [number(x) for x in at] for name, at in p.nodes.items()},
                "springs": [
                    {
                        "name": s.name,
                        "start": s.start,
                        "end": s.end,
                        "stiffness": exact_text(s.stiffness),
                        "length": number(s.length),
                        "force": number(s.force),
                        **({} if p.admissible is None else {"free_length": exact_text(s.free_length)}),
                    }
                    for s in p.springs
                ],
                "energy": number(p.energy),
                "eigenvalues": [number(x) for x in p.eigenvalues],
            }
            for p in poses.equilibria
        ],
    }


def read_poses(text: str) -> Poses:
    """The poses in a JSON document.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    document = opened(text, FORMAT, MAX_TEXT, "ptmcad solve").record(
        "format", "status", "remark", "mechanism", "parameters", "digits", "bits", "equilibria"
    )
    digits = document["digits"].natural()
    if not 1 <= digits <= MAX_DIGITS:
        raise document["digits"].fault(f"is not between 1 and {MAX_DIGITS}")
    return Poses(
        mechanism=document["mechanism"].line(MAX_NAME),
        parameters={_name(node, key): node.fraction() for key, node in document["parameters"].mapping().items()},
        equilibria=document["equilibria"].each(lambda node: _pose(node, digits)),
        status=document["status"].choice(Status),
        digits=digits,
        bits=document["bits"].natural(),
        remark=document["remark"].line(MAX_REMARK),
    )


def _name(node: Node, key: str) -> str:
    if not key.isidentifier() or len(key) > MAX_NAME:
        raise node.fault("is not a name")
    return key


def _pose(node: Node, digits: int) -> Pose:
    p = node.record(
        "stable", "index", "multiplicity", "flat", "angles", "degrees", "cosines_sines", "nodes", "springs", "energy",
        "eigenvalues", "admissible?",
    )  # fmt: skip
    admissible = p["admissible"].truth() if "admissible" in p else None

    def number(place: Node) -> Enclosure:
        return _number(place, digits)

    def pair(place: Node) -> Vector:
        x, y = place.each(number, 2)
        return x, y

    c1, s1, c2, s2 = p["cosines_sines"].each(number, 4)
    return Pose(
        angles=pair(p["angles"]),
        degrees=pair(p["degrees"]),
        cosines_sines=(c1, s1, c2, s2),
        nodes={_name(place, name): pair(place) for name, place in p["nodes"].mapping().items()},
        springs=p["springs"].each(lambda place: _spring(place, digits, admissible is not None)),
        energy=number(p["energy"]),
        eigenvalues=pair(p["eigenvalues"]),
        multiplicity=p["multiplicity"].natural(),
        index=p["index"].optional(Node.natural),
        stable=p["stable"].optional(Node.truth),
        flat=p["flat"].truth(),
        admissible=admissible,
    )


def _spring(node: Node, digits: int, free: bool) -> Spring:
    s = node.record("name", "start", "end", "stiffness", "length", "force", *(["free_length"] if free else []))
    name, start, end = (s[key].line(MAX_NAME) for key in ("name", "start", "end"))
    return Spring(
        name,
        start,
        end,
        s["stiffness"].fraction(),
        _number(s["length"], digits),
        _number(s["force"], digits),
        s["free_length"].fraction() if free else Fraction(0),
    )


def _number(node: Node, digits: int) -> Enclosure:
    entry = node.record("text", "center", "radius")
    center, radius = entry["center"].fraction(), entry["radius"].size()
    enclosure = Enclosure(center - radius, center + radius)
    if not enclosure.settles(digits) or enclosure.text(digits) != entry["text"].text():
        raise node.fault(f"is not its enclosure rounded to {digits} digits")
    return enclosure
