"""The subdivision of a window around a cover's rectangles, and which of its leaves touch, in compiled code.

Guarantee: the same parts, and the same pairs, as `ptmcad.cover.subdivision.subdivide` and `ptmcad.cover.graph.touching`
have, in another order; all in 64 bit integers, exact. It takes a third of the time.

`ptmcad.cover` does without compiled code because reading, drawing and searching a stored map must do without it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.compiled import compiled
from ptmcad.cover.complement import Tiling
from ptmcad.cover.graph import Touching
from ptmcad.cover.subdivision import COVERED, CUT, Subdivision

Integers = NDArray[np.int64]


def subdivide(rectangles: Integers, steps: int) -> Subdivision:
    """Cut the window until every part is covered by one rectangle or meets the interior of none.

    Parameters
    ----------
    rectangles : shape (k, 4): left, right, bottom, top, within 0..steps.
    """
    state, bounds, axis, cut, child = _subdivide(np.ascontiguousarray(rectangles), steps)
    return Subdivision(steps, state, bounds, axis, cut, child)


def touching(tree: Subdivision, parts: Integers) -> Touching:
    """The pairs of leaves whose closures meet, as positions in ``parts``, the numbers of all leaves."""
    place = np.full(len(tree.state), -1, dtype=np.int64)
    place[parts] = np.arange(len(parts))
    arrays = (tree.state, tree.bounds, tree.axis, tree.cut, tree.child)
    first, second, along = _touching(*arrays, place)
    return Touching(first, second, along)


@compiled
def connected(number: int, first: Integers, second: Integers) -> Integers:
    """For each of so many nodes the smallest node that edges join it to."""
    label = np.arange(number)
    for k in range(len(first)):
        a, b = first[k], second[k]
        while label[a] != a:
            label[a] = label[label[a]]
            a = label[a]
        while label[b] != b:
            label[b] = label[label[b]]
            b = label[b]
        # the smaller root stays one: labels point downwards
        if a < b:
            label[b] = a
        else:
            label[a] = b
    for a in range(number):
        label[a] = label[label[a]]
    return label


@compiled
def _longer(array: NDArray[Any], length: int) -> NDArray[Any]:
    larger = np.zeros(length, array.dtype)
    larger[: len(array)] = array
    return larger


@compiled
def _subdivide(
    rectangles: Integers, steps: int
) -> tuple[NDArray[np.int8], Integers, NDArray[np.int8], Integers, Integers]:
    room = max(1024, 16 * len(rectangles))
    state, axis = np.zeros(room, np.int8), np.zeros(room, np.int8)
    cut, child = np.zeros(room, np.int64), np.zeros(room, np.int64)
    bounds = np.zeros((room, 4), np.int64)
    bounds[0] = np.array([0, steps, 0, steps])
    parts = 1
    # parts that are to be looked at, and where in ``members`` the numbers of the rectangles that meet them begin;
    # the last part's are the last ones
    waiting, starts = np.zeros(256, np.int64), np.zeros(256, np.int64)
    members = np.arange(max(1, len(rectangles)))
    end, top = len(rectangles), 1
    lower = np.zeros(256, np.int64)
    while top > 0:
        top -= 1
        part, start = waiting[top], starts[top]
        if start == end:
            continue
        box = bounds[part]
        covered, found, where, line = _cut_of(rectangles, members, start, end, box)
        if covered:
            state[part] = COVERED
            end = start
            continue
        assert found
        if parts + 2 > room:
            room *= 2
            state, axis = _longer(state, room), _longer(axis, room)
            cut, child = _longer(cut, room), _longer(child, room)
            wider = np.zeros((room, 4), np.int64)
            wider[:parts] = bounds[:parts]
            bounds = wider
            box = bounds[part]
        state[part], axis[part], cut[part], child[part] = CUT, where, line, parts
        bounds[parts] = box
        bounds[parts + 1] = box
        bounds[parts, 2 * where + 1] = line
        bounds[parts + 1, 2 * where] = line
        # those above the line go to where all were, those below it behind them
        if len(lower) < end - start:
            lower = np.zeros(2 * (end - start), np.int64)
        below, above = 0, start
        for k in range(start, end):
            r = members[k]
            if rectangles[r, 2 * where] < line:
                lower[below] = r
                below += 1
            if rectangles[r, 2 * where + 1] > line:
                members[above] = r
                above += 1
        end = above + below
        if end > len(members):
            members = _longer(members, 2 * end)
        members[above:end] = lower[:below]
        if top + 2 > len(waiting):
            waiting, starts = _longer(waiting, 2 * len(waiting)), _longer(starts, 2 * len(starts))
        waiting[top], starts[top] = parts + 1, start
        waiting[top + 1], starts[top + 1] = parts, above
        top += 2
        parts += 2
    return state[:parts].copy(), bounds[:parts].copy(), axis[:parts].copy(), cut[:parts].copy(), child[:parts].copy()


@compiled
def _cut_of(
    rectangles: Integers, members: Integers, start: int, end: int, box: Integers
) -> tuple[bool, bool, int, int]:
    """Whether a rectangle covers the part; else whether there is a cut, its axis and its place.

    The cut is the edge next to the middle, upright if the part is wide.
    """
    x0, x1, y0, y1 = box
    below = np.empty(2, np.int64)
    above = np.empty(2, np.int64)
    below[0], above[0], below[1], above[1] = x0, x1, y0, y1
    for k in range(start, end):
        r = rectangles[members[k]]
        if r[0] <= x0 and r[1] >= x1 and r[2] <= y0 and r[3] >= y1:
            return True, False, 0, 0
        for a in range(2):
            first, last = box[2 * a], box[2 * a + 1]
            for edge in (r[2 * a], r[2 * a + 1]):
                if first < edge < last:
                    if 2 * edge <= first + last:
                        below[a] = max(below[a], edge)
                    else:
                        above[a] = min(above[a], edge)
    at = np.zeros(2, np.int64)
    found = np.zeros(2, np.bool_)
    for a in range(2):
        first, last = box[2 * a], box[2 * a + 1]
        found[a] = below[a] > first or above[a] < last
        double = first + last
        from_above = above[a] < last and (below[a] == first or 2 * above[a] - double < double - 2 * below[a])
        at[a] = above[a] if from_above else below[a]
    upright = found[0] and (x1 - x0 >= y1 - y0 or not found[1])
    return False, found[0] or found[1], 0 if upright else 1, at[0] if upright else at[1]


@compiled
def _touching(
    state: NDArray[np.int8],
    bounds: Integers,
    axis: NDArray[np.int8],
    cut: Integers,
    child: Integers,
    place: Integers,
) -> tuple[Integers, Integers, NDArray[np.bool_]]:
    """The last common part of two leaves is cut by a line at which they touch; so each pair is met at one cut only."""
    room = 4 * len(state)
    first, second = np.empty(room, np.int64), np.empty(room, np.int64)
    along = np.empty(room, np.bool_)
    found = 0
    stack = np.empty((4096, 2), np.int64)
    for part in range(len(state)):
        if state[part] != CUT:
            continue
        across, other = axis[part], 1 - axis[part]
        stack[0, 0], stack[0, 1] = child[part], child[part] + 1
        top = 1
        while top > 0:
            top -= 1
            a, b = stack[top]
            low = max(bounds[a, 2 * other], bounds[b, 2 * other])
            high = min(bounds[a, 2 * other + 1], bounds[b, 2 * other + 1])
            if low > high:
                continue
            if top + 2 > len(stack):
                higher = np.empty((2 * len(stack), 2), np.int64)
                higher[: len(stack)] = stack
                stack = higher
            # a is below the line and b above it: of what the line does not cut take what is next to it
            if state[a] == CUT:
                if axis[a] == across:
                    stack[top, 0], stack[top, 1] = child[a] + 1, b
                    top += 1
                else:
                    for side in range(2):
                        stack[top, 0], stack[top, 1] = child[a] + side, b
                        top += 1
            elif state[b] == CUT:
                if axis[b] == across:
                    stack[top, 0], stack[top, 1] = a, child[b]
                    top += 1
                else:
                    for side in range(2):
                        stack[top, 0], stack[top, 1] = a, child[b] + side
                        top += 1
            else:
                if found == room:
                    room *= 2
                    first, second = _longer(first, room), _longer(second, room)
                    wider = np.empty(room, np.bool_)
                    wider[:found] = along[:found]
                    along = wider
                first[found], second[found], along[found] = place[a], place[b], high > low
                found += 1
    return first[:found].copy(), second[:found].copy(), along[:found].copy()


COMPILED = Tiling(subdivide, touching, connected)
