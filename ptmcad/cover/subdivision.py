"""A subdivision of the window into cells that are each covered by one rectangle or meet the interior
of none; which of its leaves touch, and what is connected by touching.

Guarantee: the leaves tile the window, and every leaf is of one of the two kinds, exactly. All
coordinates are 64 bit integers of at most `ptmcad.cover.rectangles.MAX_STEPS`, whose sums and
doubles do not overflow; for touching they are compared by their ranks, which are exact too.

The window is cut in two at an edge of a rectangle, and so are the parts, as long as a rectangle
meets a part without covering it. The edge next to the middle is taken, so that the depth is near
the logarithm of the number of rectangles. All parts of one depth are cut at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ptmcad.cover.rectangles import MAX_STEPS, Cover

Integers = NDArray[np.int64]
FREE, COVERED, CUT = 0, 1, 2


@dataclass(frozen=True, slots=True, eq=False)
class Subdivision:
    """The tree of parts; part 0 is the window. All arrays have one entry for each part.

    Attributes
    ----------
    state : FREE, COVERED or CUT.
    bounds : shape (parts, 4): left, right, bottom, top.
    axis, cut : where a part is cut: at this coordinate of axis 0 or 1.
    child : number of the lower of its two parts; the other one follows it.
    """

    steps: int
    state: NDArray[np.int8]
    bounds: Integers
    axis: NDArray[np.int8]
    cut: Integers
    child: Integers

    def labels(self, parts: Integers, labels: Integers) -> Integers:
        """For each part its label, or -1 where it has none."""
        found = np.full(len(self.state), -1, dtype=np.int64)
        found[parts] = labels
        return found

    def leaves_at(self, u: Fraction, v: Fraction) -> list[int]:
        """All leaves whose closure holds a point of the window."""
        # a leaf has integer bounds: its closure holds a point where it meets the squares around it
        low = [place.__ceil__() - 1 for place in (u, v)]
        high = [place.__floor__() + 1 for place in (u, v)]
        found, waiting = [], [0]
        while waiting:
            part = waiting.pop()
            if self.state[part] != CUT:
                found.append(part)
                continue
            axis, cut, child = int(self.axis[part]), int(self.cut[part]), int(self.child[part])
            if low[axis] < cut:
                waiting.append(child)
            if high[axis] > cut:
                waiting.append(child + 1)
        return found

    def leaves_right_above(self, x: Integers, y: Integers) -> Integers:
        """For lattice points, the leaf that holds what is just right of and above each; x,
        y < steps.
        """
        part = np.zeros(len(x), dtype=np.int64)
        active = np.flatnonzero(self.state[part] == CUT)
        while len(active):
            here = part[active]
            along = np.where(self.axis[here] == 0, x[active], y[active])
            part[active] = self.child[here] + (along >= self.cut[here])
            active = active[self.state[part[active]] == CUT]
        return part

    def meeting(self, boxes: Integers) -> tuple[Integers, Integers]:
        """All pairs of a box (its position) and a leaf that have inner points in common.

        Parameters
        ----------
        boxes : shape (k, 4): left, right, bottom, top.
        """
        box, part = np.arange(len(boxes)), np.zeros(len(boxes), dtype=np.int64)
        found = [(box[:0], part[:0])]
        while len(part):
            leaf = self.state[part] != CUT
            found.append((box[leaf], part[leaf]))
            box, part = box[~leaf], part[~leaf]
            axis, cut, child = self.axis[part], self.cut[part], self.child[part]
            low, high = boxes[box, 2 * axis], boxes[box, 2 * axis + 1]
            below, above = low < cut, high > cut
            box = np.concatenate([box[below], box[above]])
            part = np.concatenate([child[below], child[above] + 1])
        return np.concatenate([b for b, _ in found]), np.concatenate([p for _, p in found])


def rectangle_array(cover: Cover) -> Integers:
    """The rectangles as an array of shape (k, 4).

    Raises
    ------
    ValueError
        When a rectangle is not one, or the lattice is too fine.
    """
    steps = cover.steps
    if not 0 < steps <= MAX_STEPS:
        raise ValueError(f"a cover's lattice has 1 to {MAX_STEPS} steps, not {steps}")
    try:
        array = np.array(cover.rectangles, dtype=np.int64).reshape(-1, 4)
    except (OverflowError, ValueError) as error:
        raise ValueError(
            "a rectangle of the cover is not four integers within the window"
        ) from error
    left, right, bottom, top = array.T
    bad = (
        (left < 0)
        | (left >= right)
        | (right > steps)
        | (bottom < 0)
        | (bottom >= top)
        | (top > steps)
    )
    if bad.any():
        raise ValueError(
            f"not a rectangle of the cover's window: {cover.rectangles[int(np.argmax(bad))]}"
        )
    return array


def subdivide(rectangles: Integers, steps: int) -> Subdivision:
    """Cut the window until every part is covered by one rectangle or meets the interior of none.

    Parameters
    ----------
    rectangles : shape (k, 4), from `rectangle_array`.
    """
    bounds = np.array([[0, steps, 0, steps]], dtype=np.int64)
    """of all parts of this depth"""
    met = np.zeros(1 if len(rectangles) else 0, dtype=np.int64)
    """those of them that some rectangle meets"""
    counts = np.full(len(met), len(rectangles))
    members = np.arange(len(rectangles))
    """numbers of the rectangles that meet each of these, part after part"""
    depths, number = [], 0
    while True:
        state, axis = np.zeros((2, len(bounds)), dtype=np.int8)
        cut, child = np.zeros((2, len(bounds)), dtype=np.int64)
        depths.append((state, bounds, axis, cut, child))
        number += len(bounds)
        owner = np.repeat(np.arange(len(met)), counts)
        box = bounds[met]
        x0, x1, y0, y1 = box[owner].T
        left, right, bottom, top = rectangles[members].T
        left, right = np.maximum(left, x0), np.minimum(right, x1)
        bottom, top = np.maximum(bottom, y0), np.minimum(top, y1)
        covers = (left == x0) & (right == x1) & (bottom == y0) & (top == y1)
        covered = np.bincount(owner[covers], minlength=len(met)) > 0
        state[met[covered]] = COVERED
        if covered.all():
            break
        kept = ~covered[owner]
        renumbered = np.cumsum(~covered) - 1
        met, box, counts = met[~covered], box[~covered], counts[~covered]
        owner, members = renumbered[owner[kept]], members[kept]
        left, right, bottom, top = left[kept], right[kept], bottom[kept], top[kept]
        starts = np.cumsum(counts) - counts
        cut_x, found_x = _next_to_the_middle(left, right, box[:, 0], box[:, 1], owner, starts)
        cut_y, found_y = _next_to_the_middle(bottom, top, box[:, 2], box[:, 3], owner, starts)
        wide = box[:, 1] - box[:, 0] >= box[:, 3] - box[:, 2]
        upright = found_x & (wide | ~found_y)
        line, across, order = (
            np.where(upright, cut_x, cut_y),
            np.where(upright, 0, 1),
            np.arange(len(met)),
        )
        state[met], axis[met], cut[met], child[met] = CUT, across, line, number + 2 * order
        bounds = np.repeat(box, 2, axis=0)
        for side in (0, 1):
            bounds[2 * order + side, 2 * across + 1 - side] = line

        low, high = np.where(upright[owner], left, bottom), np.where(upright[owner], right, top)
        halves = (low < line[owner], high > line[owner])
        counts, members = _in_halves(members, owner, halves, len(met))
        met = np.flatnonzero(counts)
        counts = counts[met]
    return Subdivision(steps, *(np.concatenate(column) for column in zip(*depths, strict=True)))


def _in_halves(
    members: Integers, owner: Integers, halves: Sequence[NDArray[np.bool_]], parts: int
) -> tuple[Integers, Integers]:
    """How many members each half of each part has, the lower one first, and these, half after half."""
    numbers = [np.bincount(owner[half], minlength=parts) for half in halves]
    counts = np.stack(numbers, axis=1).ravel()
    starts = np.cumsum(counts) - counts
    following = np.empty(int(counts.sum()), dtype=np.int64)
    for side, half in enumerate(halves):
        of, rank = repeated(numbers[side])
        following[starts[2 * of + side] + rank] = members[half]
    return counts, following


def _next_to_the_middle(
    low: Integers,
    high: Integers,
    first: Integers,
    last: Integers,
    owner: Integers,
    starts: Integers,
) -> tuple[Integers, NDArray[np.bool_]]:
    """For each part, the edge of a rectangle strictly inside of it that is nearest to its middle,
    if there is one.
    """
    double = first + last
    a, b, d = first[owner], last[owner], double[owner]
    low_below, high_below = 2 * low <= d, 2 * high <= d
    below = np.maximum(np.where(low_below, low, a), np.where(high_below, high, a))
    above = np.minimum(np.where(low_below, b, low), np.where(high_below, b, high))
    below, above = np.maximum.reduceat(below, starts), np.minimum.reduceat(above, starts)
    from_above = (above < last) & ((below == first) | (2 * above - double < double - 2 * below))
    return np.where(from_above, above, below), (above < last) | (below > first)


def touching(leaves: Integers) -> tuple[Integers, Integers, NDArray[np.bool_]]:
    """The pairs of leaves whose closures meet, each once, as positions of the first and of the
    second ones; and whether the two share a segment, else one point.

    Parameters
    ----------
    leaves : shape (n, 4): left, right, bottom, top of rectangles that tile the window.
    """
    across, up = (
        np.unique(leaves[:, k : k + 2], return_inverse=True)[1].reshape(-1, 2) for k in (0, 2)
    )
    a, b, along = _across(across, up, corners=True)
    # a corner that two leaves share is the end of an upright line between them: the pass above has
    # it
    c, d, _ = _across(up, across, corners=False)
    segments = np.ones(len(c), dtype=np.bool_)
    return np.concatenate([a, c]), np.concatenate([b, d]), np.concatenate([along, segments])


def _across(
    across: Integers, up: Integers, *, corners: bool
) -> tuple[Integers, Integers, NDArray[np.bool_]]:
    """Pairs of leaves at the two sides of an upright line, with an edge or, if asked, a corner in
    common.

    Parameters
    ----------
    across, up : ranks of left and right, and of bottom and top, in shape (n, 2); those of the
        window's left are 0.
    """
    (left, right), (low, high) = across.T, up.T
    span = int(high.max()) + 2
    inner = np.flatnonzero(left > 0)
    # the leaves at the right of one line do not overlap, so that bottoms and tops have the same
    # order
    order = inner[np.argsort(left[inner] * span + low[inner])]
    bottoms, tops = left[order] * span + low[order], left[order] * span + high[order]
    line = right * span
    begin = np.searchsorted(tops, line + low, side="left" if corners else "right")
    end = np.searchsorted(bottoms, line + high, side="right" if corners else "left")
    number = np.maximum(end - begin, 0)
    first, within = repeated(number)
    second = order[np.repeat(begin, number) + within]
    return (
        first,
        second,
        np.minimum(high[first], high[second]) > np.maximum(low[first], low[second]),
    )


def repeated(number: Integers) -> tuple[Integers, Integers]:
    """For items that are repeated so many times: each repetition's item, and its number within it."""
    item = np.repeat(np.arange(len(number)), number)
    return item, np.arange(len(item)) - np.repeat(np.cumsum(number) - number, number)


def connected(number: int, first: Integers, second: Integers) -> Integers:
    """For each of so many nodes the smallest node that edges join it to."""
    label = np.arange(number)
    while len(first):
        a, b = label[first], label[second]
        separate = a != b
        first, second, a, b = first[separate], second[separate], a[separate], b[separate]
        # labels are roots here: every root takes the smallest of its neighbours' roots, if that is
        # smaller
        np.minimum.at(label, np.maximum(a, b), np.minimum(a, b))
        while True:
            shorter = label[label]
            if np.array_equal(shorter, label):
                break
            label = shorter
    return label
