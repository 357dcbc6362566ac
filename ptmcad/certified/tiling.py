"""The subdivision of a window around a cover's rectangles, and which of its leaves touch, in compiled code.

Guarantee: the same parts, and the same pairs, as `ptmcad.cover.subdivision.subdivide` and `ptmcad.cover.graph.touching`
have, in another order; all in 64 bit integers, exact. It takes a third of the time.

`ptmcad.cover` does without compiled code because reading, drawing and searching a stored map must do without it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.compiled import compiled, inlined
from ptmcad.cover.complement import Tiling
from ptmcad.cover.graph import Touching
from ptmcad.cover.subdivision import COVERED, CUT, Subdivision

Integers = NDArray[np.int64]
_STATE, _AXIS, _CUT, _CHILD, _BOUNDS, _COLUMNS = 0, 1, 2, 3, 4, 8
"""Where a part has what, as long as there may be more of them: one array of one type compiles in a third of the time
of five."""


def subdivide(rectangles: Integers, steps: int) -> Subdivision:
    """Cut the window until every part is covered by one rectangle or meets the interior of none.

    Parameters
    ----------
    rectangles : shape (k, 4): left, right, bottom, top, within 0..steps.
    """
    nodes = _subdivide(np.ascontiguousarray(rectangles), steps)
    state, axis = nodes[:, _STATE].astype(np.int8), nodes[:, _AXIS].astype(np.int8)
    bounds = np.ascontiguousarray(nodes[:, _BOUNDS:])
    return Subdivision(steps, state, bounds, axis, nodes[:, _CUT].copy(), nodes[:, _CHILD].copy())


def touching(tree: Subdivision, parts: Integers) -> Touching:
    """The pairs of leaves whose closures meet, as positions in ``parts``, the numbers of all leaves."""
    place = np.full(len(tree.state), -1, dtype=np.int64)
    place[parts] = np.arange(len(parts))
    arrays = (tree.state, tree.bounds, tree.axis, tree.cut, tree.child)
    pairs = _touching(*arrays, place)
    return Touching(pairs[:, 0].copy(), pairs[:, 1].copy(), pairs[:, 2] != 0)


@compiled
def _with_room(array: Integers, rows: int) -> Integers:
    """The rows of an array with room for more."""
    larger = np.empty((rows, array.shape[1]), np.int64)
    for i in range(array.shape[0]):
        for k in range(array.shape[1]):
            larger[i, k] = array[i, k]
    return larger


@compiled
def _subdivide(rectangles: Integers, steps: int) -> Integers:
    """The parts, a row for each: state, axis, cut, child, then left, right, bottom, top."""
    nodes = np.empty((max(1024, 16 * len(rectangles)), _COLUMNS), np.int64)
    for k in range(_COLUMNS):
        nodes[0, k] = 0
    nodes[0, _BOUNDS + 1] = nodes[0, _BOUNDS + 3] = steps
    parts = 1
    # parts that are to be looked at, and where in ``members`` the numbers of the rectangles that meet them begin;
    # the last part's are the last ones
    waiting = np.empty((256, 2), np.int64)
    waiting[0, 0] = waiting[0, 1] = 0
    members, lower = np.empty((max(1, len(rectangles)), 1), np.int64), np.empty(256, np.int64)
    for k in range(len(rectangles)):
        members[k, 0] = k
    end, top = len(rectangles), 1
    while top > 0:
        top -= 1
        part, start = waiting[top, 0], waiting[top, 1]
        if start == end:
            continue
        covered, found, where, line = _cut_of(rectangles, members, start, end, nodes[part, _BOUNDS:])
        if covered:
            nodes[part, _STATE] = COVERED
            end = start
            continue
        assert found
        if parts + 2 > len(nodes):
            nodes = _with_room(nodes, 2 * len(nodes))
        for k in range(_BOUNDS):
            nodes[parts, k] = nodes[parts + 1, k] = 0
        for k in range(_BOUNDS, _COLUMNS):
            nodes[parts, k] = nodes[parts + 1, k] = nodes[part, k]
        nodes[part, _STATE], nodes[part, _AXIS], nodes[part, _CUT], nodes[part, _CHILD] = CUT, where, line, parts
        nodes[parts, _BOUNDS + 2 * where + 1] = line
        nodes[parts + 1, _BOUNDS + 2 * where] = line
        # those above the line go to where all were, those below it behind them
        if len(lower) < end - start:
            lower = np.empty(2 * (end - start), np.int64)
        below, above = 0, start
        for k in range(start, end):
            r = members[k, 0]
            if rectangles[r, 2 * where] < line:
                lower[below] = r
                below += 1
            if rectangles[r, 2 * where + 1] > line:
                members[above, 0] = r
                above += 1
        end = above + below
        if end > len(members):
            members = _with_room(members, 2 * end)
        for k in range(below):
            members[above + k, 0] = lower[k]
        if top + 2 > len(waiting):
            waiting = _with_room(waiting, 2 * len(waiting))
        waiting[top, 0], waiting[top, 1] = parts + 1, start
        waiting[top + 1, 0], waiting[top + 1, 1] = parts, above
        top += 2
        parts += 2
    return nodes[:parts].copy()


@inlined
def _cut_of(
    rectangles: Integers, members: Integers, start: int, end: int, box: Integers
) -> tuple[bool, bool, int, int]:
    """Whether a rectangle covers the part; else whether there is a cut, its axis and its place.

    The cut is the edge next to the middle, upright if the part is wide.
    """
    x0, x1, y0, y1 = box[0], box[1], box[2], box[3]
    below, above = np.empty(2, np.int64), np.empty(2, np.int64)
    below[0], above[0], below[1], above[1] = x0, x1, y0, y1
    for k in range(start, end):
        r = rectangles[members[k, 0]]
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
    at, found = np.empty(2, np.int64), np.empty(2, np.bool_)
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
) -> Integers:
    """For each pair its places, and 1 where it has an edge in common, not just a corner.

    The last common part of two leaves is cut by a line at which they touch; so each pair is met at one cut only.
    """
    pairs = np.empty((4 * len(state), 3), np.int64)
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
            a, b = stack[top, 0], stack[top, 1]
            low = max(bounds[a, 2 * other], bounds[b, 2 * other])
            high = min(bounds[a, 2 * other + 1], bounds[b, 2 * other + 1])
            if low > high:
                continue
            if top + 2 > len(stack):
                stack = _with_room(stack, 2 * len(stack))
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
                if found == len(pairs):
                    pairs = _with_room(pairs, 2 * len(pairs))
                pairs[found, 0], pairs[found, 1], pairs[found, 2] = place[a], place[b], 1 if high > low else 0
                found += 1
    return pairs[:found].copy()


COMPILED = Tiling(subdivide, touching)
