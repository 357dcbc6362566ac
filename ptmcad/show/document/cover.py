"""Reading the cover of a certified map from its JSON document.

Guarantee: what is returned keeps what `Cover` promises: steps are a power of two, the rectangles lie in the window, and
are sorted and distinct.
"""

from __future__ import annotations

from itertools import pairwise

from ptmcad.cover.rectangles import MAX_STEPS, Cover
from ptmcad.show.document.node import Node

MAX_RECTANGLES = 1_000_000


def read_cover(node: Node) -> Cover:
    """The cover: its rectangles are one list of integers, four for each.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    entry = node.record("steps", "rectangles")
    steps = entry["steps"].value
    if type(steps) is not int or not 0 < steps <= MAX_STEPS or steps & (steps - 1):
        raise entry["steps"].fault(f"is not a power of two up to {MAX_STEPS}")
    # not by `Node.each`, which would make an object of each of millions of numbers
    place, numbers = entry["rectangles"], entry["rectangles"].value
    if not isinstance(numbers, list) or len(numbers) % 4 or not all(type(n) is int for n in numbers):
        raise place.fault("is not a list of integers, four for each rectangle")
    if len(numbers) > 4 * MAX_RECTANGLES:
        raise place.fault(f"has more than {MAX_RECTANGLES} rectangles")
    rectangles = tuple(zip(numbers[::4], numbers[1::4], numbers[2::4], numbers[3::4], strict=True))
    for k, (left, right, bottom, top) in enumerate(rectangles):
        if not (0 <= left < right <= steps and 0 <= bottom < top <= steps):
            raise place.fault(f"has a rectangle, number {k}, that does not lie in the window: left, right, bottom, top")
    for k, (one, next_one) in enumerate(pairwise(rectangles)):
        if one >= next_one:
            raise place.fault(f"is not sorted, or not of distinct rectangles: see numbers {k} and {k + 1}")
    return Cover(steps, rectangles)
