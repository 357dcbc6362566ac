"""The cover of a certified map as a part of its JSON document.

Guarantee: reading what was written gives an equal cover. What is read keeps what `Cover` promises:
steps are a power of two, the rectangles lie in the window, and are sorted and distinct, and so are
the patches, each of which is one.
"""

from __future__ import annotations

import json
from itertools import pairwise
from typing import Any

from ptmcad.cover.rectangles import MAX_STEPS, Cover, Patch, Tube
from ptmcad.cover.tubeframes import flaw
from ptmcad.text.codec import Codec
from ptmcad.text.node import Node

MAX_RECTANGLES = 1_000_000
MAX_PATCHES = 200_000
MAX_CONTROLS = 64
MAX_CONTROL = 2**60
"""Of a half width, and of a control's absolute value: the curve passes a frame within the window.
"""
_FIRST_TUBE = 5


def _cover(node: Node) -> Cover:
    """The cover: its rectangles are one list of integers, four for each.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    entry = node.record(("steps", "rectangles", "patches"), ("steps", "rectangles"))
    steps = entry["steps"].value
    if type(steps) is not int or not 0 < steps <= MAX_STEPS or steps & (steps - 1):
        raise entry["steps"].fault(f"is not a power of two up to {MAX_STEPS}")
    # not by `Node.each`, which would make an object of each of millions of numbers
    place, numbers = entry["rectangles"], entry["rectangles"].value
    if (
        not isinstance(numbers, list)
        or len(numbers) % 4
        or not all(type(n) is int for n in numbers)
    ):
        raise place.fault("is not a list of integers, four for each rectangle")
    if len(numbers) > 4 * MAX_RECTANGLES:
        raise place.fault(f"has more than {MAX_RECTANGLES} rectangles")
    rectangles = tuple(zip(numbers[::4], numbers[1::4], numbers[2::4], numbers[3::4], strict=True))
    for k, (left, right, bottom, top) in enumerate(rectangles):
        if not (0 <= left < right <= steps and 0 <= bottom < top <= steps):
            raise place.fault(
                f"has a rectangle, number {k}, that does not lie in the window: left, right, bottom, top"
            )
    for k, (one, next_one) in enumerate(pairwise(rectangles)):
        if one >= next_one:
            raise place.fault(
                f"is not sorted, or not of distinct rectangles: see numbers {k} and {k + 1}"
            )
    return Cover(steps, rectangles, _patches(entry["patches"], steps) if "patches" in entry else ())


def _patches(node: Node, steps: int) -> tuple[Patch, ...]:
    """The slanted pieces, each in its frame; whether frames are disjoint is known when the
    components are.
    """
    if not isinstance(node.value, list) or len(node.value) > MAX_PATCHES:
        raise node.fault(f"is not a list of at most {MAX_PATCHES} patches")
    found = []
    for k, value in enumerate(node.value):
        place = Node(value, f"{node.place}[{k}]")
        if not isinstance(value, list) or len(value) < _FIRST_TUBE:
            raise place.fault("is not a frame, an axis and tubes")
        head, tubes = value[:_FIRST_TUBE], value[_FIRST_TUBE:]
        if not all(type(n) is int for n in head):
            raise place.fault("does not begin with a frame and an axis: five integers")
        for tube in tubes:
            if (
                not isinstance(tube, list)
                or not 1 < len(tube) <= MAX_CONTROLS
                or not all(map(_is_short, tube))
            ):
                raise place.fault(
                    f"has a tube that is not a half width and up to {MAX_CONTROLS} controls"
                )
        patch = Patch(
            (head[0], head[1], head[2], head[3]),
            head[4],
            tuple(Tube(t[0], tuple(t[1:])) for t in tubes),
        )
        wrong = flaw(patch, steps)
        if wrong:
            raise place.fault(f"is no slanted piece: {wrong}")
        found.append(patch)
    if any(one >= next_one for one, next_one in pairwise(found)):
        raise node.fault("is not sorted, or has a patch twice")
    return tuple(found)


def _is_short(value: object) -> bool:
    return type(value) is int and abs(value) <= MAX_CONTROL


def cover_line(cover: Cover) -> str:
    """The cover with a line for each rectangle and nothing more: there may be a million of them."""
    rectangles = ",\n".join(
        f"{left},{right},{low},{high}" for left, right, low, high in cover.rectangles
    )
    slanted = ",\n".join(
        json.dumps(_patch(patch), separators=(",", ":")) for patch in cover.patches
    )
    patches = f', "patches": [\n{slanted}\n]' if cover.patches else ""
    return f'  "cover": {{"steps": {cover.steps}, "rectangles": [\n{rectangles}\n]{patches}}}'


def _patch(patch: Patch) -> list[Any]:
    """Its frame and its axis, then for each tube the half width and the controls."""
    return [*patch.frame, patch.along, *([tube.half, *tube.controls] for tube in patch.tubes)]


_INTEGERS = {"type": "array", "items": {"type": "integer", "minimum": 0}}
COVER: Codec[Cover] = Codec(
    lambda cover: json.loads("{" + cover_line(cover) + "}")["cover"],
    _cover,
    {
        "type": "object",
        "properties": {
            "steps": {"type": "integer", "minimum": 1, "maximum": MAX_STEPS},
            "rectangles": _INTEGERS,
            "patches": {"type": "array", "items": {"type": "array", "minItems": _FIRST_TUBE + 1}},
        },
        "required": ["steps", "rectangles"],
        "additionalProperties": False,
    },
)
