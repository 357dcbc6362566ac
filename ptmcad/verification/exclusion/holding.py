"""Whether pieces of the window hold a strip: compiled code.

A strip is what of a rectangle lies near a line: over u in [a, b], v is within [low, high] of
middle + slope (u - from). The rectangle is cut along all sides of frames that pass through it. Then
each frame has all of a part or nothing of it, and within a part a piece has all points whose v less
the line lies between two numbers; these intervals together have to hold that of the strip. Frames'
sides are whole numbers, so cutting is exact.
"""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np

from ptmcad.verification.exclusion.arithmetic import compiled
from ptmcad.verification.exclusion.pieces import MAX_CONTROLS, SLACK

MAX_PIECES = 96
"""Of the pieces that a strip may meet: with more nothing is decided."""
MAX_PARTS = 96
_BINS_AT_ONCE = 64
_OUTSIDE = 0.01
"""By how much of its interval a polynomial may be continued."""
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
    """Whether the pieces hold a part of a strip, which no side of a frame passes through."""
    a, b = part[0], part[1]
    slack = SLACK * pieces.steps
    least, most = _across(strip, a, b)
    least, most = max(least - slack, part[2]), min(most + slack, part[3])
    low, high = np.empty(MAX_PIECES), np.empty(MAX_PIECES)
    line_a, line_b = strip[3] + strip[4] * (a - strip[2]), strip[3] + strip[4] * (b - strip[2])
    for m in range(number):
        n = near[m]
        low[m], high[m] = inf, -inf
        f = pieces.frames[n]
        if (
            f[2 * along] > a
            or f[2 * along + 1] < b
            or f[2 - 2 * along] > least
            or f[3 - 2 * along] < most
        ):
            continue
        straight = pieces.lower[n, 1] == 0 and pieces.upper[n, 1] == 0
        if straight or (pieces.along[n] != along and _between(pieces, n, least, most, a, b)):
            return True
        if pieces.along[n] == along:
            p, q = _shares(pieces.spans[n], a, b)
            low[m], high[m] = -inf, inf
            if pieces.lower[n, 1]:
                low[m] = _off(pieces.controls, pieces.lower[n], p, q, line_a, line_b, 1) + slack
            if pieces.upper[n, 1]:
                high[m] = _off(pieces.controls, pieces.upper[n], p, q, line_a, line_b, -1) - slack
    # from below: each interval that begins in what is held already takes it further
    at = max(strip[5], part[2] - max(line_a, line_b)) - slack
    end = min(strip[6], part[3] - min(line_a, line_b)) + slack
    moved = True
    while moved and at < end:
        moved = False
        for m in range(number):
            if low[m] <= at < high[m]:
                at, moved = high[m], True
    return bool(at >= end)


@compiled
def _between(pieces: Any, n: int, a: float, b: float, least: float, most: float) -> bool:
    """Whether a piece has all of a rectangle, [a, b] along its own axis, between its polynomials."""
    slack = SLACK * pieces.steps
    p, q = _shares(pieces.spans[n], a, b)
    if (
        pieces.lower[n, 1]
        and _off(pieces.controls, pieces.lower[n], p, q, least, least, 1) > -slack
    ):
        return False
    return not (
        pieces.upper[n, 1] and _off(pieces.controls, pieces.upper[n], p, q, most, most, -1) < slack
    )


@compiled
def _shares(span: Any, a: float, b: float) -> Any:
    """Where a and b are, as shares of an interval; a little outside of it where the frame was made
    wider.
    """
    return (a - span[0]) / (span[1] - span[0]), (b - span[0]) / (span[1] - span[0])


@compiled
def _off(
    controls: Any, bound: Any, p: float, q: float, line_a: float, line_b: float, sign: int
) -> float:
    """The most (sign 1) or the least (-1) that a polynomial is above a line, between p and q of its
    frame.

    By de Casteljau's rule it has controls for this part; the line's own are evenly spaced between
    its ends.
    """
    start, number = bound[0], bound[1]
    if not (-_OUTSIDE <= p < 1 and q <= 1 + _OUTSIDE):
        return sign * inf
    c = np.empty(MAX_CONTROLS)
    for k in range(number):
        c[k] = controls[start + k]
    for level in range(1, number):
        for k in range(number - level):
            c[k] = (1 - p) * c[k] + p * c[k + 1]
    share = (q - p) / (1 - p) if p < 1 else 0.0
    for level in range(1, number):
        for k in range(number - 1, level - 1, -1):
            c[k] = (1 - share) * c[k - 1] + share * c[k]
    found = -inf
    for k in range(number):
        t = k / (number - 1)
        found = max(found, sign * (c[k] - ((1 - t) * line_a + t * line_b)))
    return sign * found
