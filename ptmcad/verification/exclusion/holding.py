"""Whether pieces of the window hold a strip: compiled code.

A strip is what of a rectangle lies near a line: over u in [a, b], v is within [low, high] of
middle + slope (u - from). It is cut along all sides of pieces that pass through it. Then each piece
has all of a part or nothing of it. Pieces' sides are whole numbers, so cutting is exact.
"""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np

from ptmcad.verification.exclusion.arithmetic import compiled
from ptmcad.verification.exclusion.pieces import SLACK

MAX_PIECES = 96
"""Of the pieces that a strip may meet: with more nothing is decided."""
MAX_PARTS = 96
_BINS_AT_ONCE = 64
_MIN_SHARE = 0.02
"""Of a strip's length: a part that is shorter is not halved."""


@compiled
def holds(pieces: Any, along: int, strip: Any) -> bool:
    """Whether the pieces surely hold a strip.

    Parameters
    ----------
    along : the axis u.
    strip : a, b, from, middle, slope, low, high, and the least and the most v of it.
    """
    near = np.empty(MAX_PIECES, dtype=np.int64)
    number = _near(pieces, along, strip, near)
    if number <= 0:
        return False
    parts = np.empty((MAX_PARTS + 2, 4))
    parts[0, :2], parts[0, 2:] = strip[:2], strip[7:]
    waiting, done = 1, 0
    slack = SLACK * pieces.steps
    while waiting > 0:
        waiting -= 1
        done += 1
        if done > 4 * MAX_PARTS or waiting >= MAX_PARTS:
            return False
        a, b, c, d = parts[waiting, 0], parts[waiting, 1], parts[waiting, 2], parts[waiting, 3]
        least, most = _across(strip, a, b)
        if least - slack > d or most + slack < c:
            continue
        upright, at = 0, _edge(pieces, 2 * along, near, number, a, b)
        if not a < at < b:
            upright, at = 1, _edge(pieces, 2 - 2 * along, near, number, max(c, least), min(d, most))
            if not (c < at < d and least < at < most):
                if _part(pieces, along, near, number, strip, parts[waiting]):
                    continue
                upright, at = 0, 0.5 * (a + b)
                if not a < at < b or b - a < _MIN_SHARE * (strip[1] - strip[0]):
                    return False
        parts[waiting + 1] = parts[waiting]
        parts[waiting, 2 * upright + 1] = at
        parts[waiting + 1, 2 * upright] = at
        waiting += 2
    return True


@compiled
def _across(strip: Any, a: float, b: float) -> Any:
    """The least and the largest v of a strip between a and b, but for rounding."""
    p, q = strip[3] + strip[4] * (a - strip[2]), strip[3] + strip[4] * (b - strip[2])
    return max(min(p, q) + strip[5], strip[7]), min(max(p, q) + strip[6], strip[8])


@compiled
def _near(pieces: Any, along: int, strip: Any, near: Any) -> int:
    """The pieces that meet the rectangle around a strip; -1 where they are too many."""
    low, high = strip[7], strip[8]
    scale = pieces.bins / pieces.steps
    i0, i1 = int(max(0.0, strip[0] * scale)), int(min(pieces.bins - 1.0, strip[1] * scale))
    j0, j1 = int(max(0.0, low * scale)), int(min(pieces.bins - 1.0, high * scale))
    if (i1 - i0 + 1) * (j1 - j0 + 1) > _BINS_AT_ONCE:
        return -1
    number = 0
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            place = i * pieces.bins + j if along == 0 else j * pieces.bins + i
            for k in range(pieces.starts[place], pieces.starts[place + 1]):
                n = pieces.members[k]
                f = pieces.frames[n]
                if f[2 * along] > strip[1] or f[2 * along + 1] < strip[0]:
                    continue
                if f[2 - 2 * along] > high or f[3 - 2 * along] < low:
                    continue
                if (near[:number] == n).any():
                    continue
                if number == len(near):
                    return -1
                near[number] = n
                number += 1
    return number


@compiled
def _edge(pieces: Any, side: int, near: Any, number: int, a: float, b: float) -> float:
    """The side of a frame nearest to the middle of an interval; infinite where no side is inside of
    it.
    """
    at, away = inf, inf
    for m in range(number):
        for end in (0, 1):
            x = pieces.frames[near[m], side + end]
            if a < x < b and abs(x - 0.5 * (a + b)) < away:
                at, away = x, abs(x - 0.5 * (a + b))
    return at


@compiled
def _part(pieces: Any, along: int, near: Any, number: int, strip: Any, part: Any) -> bool:
    """Whether a piece holds a part of a strip, which no side of a rectangle passes through."""
    a, b = part[0], part[1]
    slack = SLACK * pieces.steps
    least, most = _across(strip, a, b)
    least, most = max(least - slack, part[2]), min(most + slack, part[3])
    for m in range(number):
        f = pieces.frames[near[m]]
        if (
            f[2 * along] <= a
            and f[2 * along + 1] >= b
            and f[2 - 2 * along] <= least
            and f[3 - 2 * along] >= most
        ):
            return True
    return False
