"""Places for the labels of arrows: near their tips, within the picture, apart from each other.

Guarantee: the same for the same map, whatever the format. Labels overlap only where `TRIED` places
for each do not suffice to keep them apart; which of them are clear of all others is known. A label
stands on a region of another count only where none of these places on one of its own is as clear.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from math import cos, dist, pi, sin

import numpy as np

from ptmcad.show.render.clearance import Box, Position, around, holds, overlap, touch
from ptmcad.show.render.textwidth import text_width
from ptmcad.show.render.view import Shapes
from ptmcad.show.style import Size

FONT_SIZE = 8.0
_DIRECTIONS = 32
_DISTANCES = (10, 20, 34, 50, 70, 95, 125, 160, 200)
_SHORT, _EDGE = 30, 2
"""Points: a shorter arrow is as bad as one that passes another region; from the picture's edge to a
label.
"""
_MET = 1e3
"""What a place costs at the least where something is in its way; distances are less."""
_OTHER_REGION, _FOREIGN = 75, 300
"""What a place costs for every other region than one that its label or its arrow lies on, and where
its label lies on one of another count: more than all distances."""
TRIED = _DIRECTIONS * len(_DISTANCES)

Image = np.ndarray[tuple[int, int], np.dtype[np.int64]]


@dataclass(frozen=True, slots=True)
class Placement:
    """The tip of an arrow and the centre of its label, as fractions of the picture's sides; the
    font's size.

    ``clear`` says whether label and arrow are within the picture and clear of all those before
    them.
    """

    tip: Position
    label: Position
    size: float
    clear: bool = True


def place(
    tips: Sequence[Position], texts: Sequence[str], seen: Shapes, sides: Size,
    size: float = FONT_SIZE, skip: bool = False, homes: Sequence[Collection[int]] = (),
) -> list[Placement]:  # fmt: skip
    """Places for the texts, one after the other.

    Parameters
    ----------
    homes : for each text the regions of which it is true; if not given, of all.
    skip : whether those that are not clear are not to be drawn, so that nothing has to be clear of
        them.
    sides : width and height of the picture, in points.
    size : of the texts, in points.
    """
    image = seen.raster(96, 96) if tips else np.zeros((1, 1), dtype=np.int64)
    points = [(x * sides[0], y * sides[1]) for x, y in tips]
    scale = min(*sides, 331.2) / 331.2
    taken: list[Box] = []
    arrows: list[tuple[Position, Position]] = []
    result = []
    for number, (tip, text) in enumerate(zip(points, texts, strict=True)):
        half = (36 * text_width(text, size) + 0.25 * size + 1, 0.85 * size + 1)
        best, label, clear = float("inf"), tip, False
        for distance in (scale * each for each in _DISTANCES):
            for k in range(_DIRECTIONS):
                angle = 2 * pi * (k + 0.5) / _DIRECTIONS
                x, y = (
                    tip[0] + (half[0] + distance) * cos(angle),
                    tip[1] + (half[1] + distance) * sin(angle),
                )
                # a tip at the frame has room beside itself, along the frame
                x, y = (_within(v, h, side) for v, h, side in zip((x, y), half, sides, strict=True))
                box = around((x, y), half)
                cost = distance + (_OTHER_REGION if distance < scale * _SHORT else 0.0)
                cost += 1e6 * sum(
                    max(0.0, e)
                    for e in (
                        _EDGE - box[0],
                        _EDGE - box[1],
                        box[2] - sides[0] + _EDGE,
                        box[3] - sides[1] + _EDGE,
                    )
                )
                cost += 1e4 * sum(overlap(_wider(box, 2), other) for other in taken)
                cost += 1e3 * sum(holds(_wider(box, 6), p) for p in points)
                cost += 1e3 * sum(touch(a, b, tip, (x, y)) for a, b in arrows)
                cost += 1e3 * sum(_meets(box, a, b) for a, b in arrows)
                cost += 1e3 * sum(_meets(other, tip, (x, y)) for other in taken) if skip else 0.0
                met = cost >= _MET
                if cost >= best:
                    continue
                if homes and not set(_covered(image, box, sides)) <= {-1, *homes[number]}:
                    cost += _FOREIGN
                cost += _OTHER_REGION * (
                    len(_covered(image, box, sides)) - 1 + _passed(image, tip, (x, y), sides)
                )
                if cost < best:
                    best, label, clear = cost, (x, y), not met
        result.append(
            Placement(tips[number], (label[0] / sides[0], label[1] / sides[1]), size, clear)
        )
        if skip and not clear:
            continue
        taken.append(around(label, half))
        arrows.append((tip, label))
    return result


def _within(middle: float, half: float, side: float) -> float:
    """The middle of a label, moved so that it is within the picture, if it is not longer than that."""
    return (
        min(max(middle, half + _EDGE), side - half - _EDGE)
        if 2 * (half + _EDGE) <= side
        else middle
    )


def _wider(box: Box, by: float) -> Box:
    return box[0] - by, box[1] - by, box[2] + by, box[3] + by


def _meets(box: Box, a: Position, b: Position) -> bool:
    """Whether an arrow passes through a box, seen at points a few points apart."""
    n, near = max(2, int(dist(a, b) / 4)), _wider(box, 6)
    return any(
        holds(near, (a[0] + (b[0] - a[0]) * k / n, a[1] + (b[1] - a[1]) * k / n))
        for k in range(n + 1)
    )


def _passed(image: Image, a: Position, b: Position, sides: Size) -> int:
    """How many other regions than one an arrow passes, from its tip to its label's centre."""
    steps = np.linspace(0.0, 1.0, 24)
    row, column = (
        np.clip(
            (a[k] + (b[k] - a[k]) * steps) / sides[k] * image.shape[1 - k],
            0,
            image.shape[1 - k] - 1,
        ).astype(int)
        for k in (1, 0)
    )
    return len(np.unique(image[row, column])) - 1


def _covered(image: Image, box: Box, sides: Size) -> list[int]:
    """The regions that the box covers."""
    rows, columns = image.shape
    left, right = (int(min(max(v / sides[0], 0.0), 0.999) * columns) for v in (box[0], box[2]))
    bottom, top = (int(min(max(v / sides[1], 0.0), 0.999) * rows) for v in (box[1], box[3]))
    found: list[int] = np.unique(image[bottom : top + 1, left : right + 1]).tolist()
    return found
