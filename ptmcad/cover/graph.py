"""Which leaves of a subdivision touch, and what is connected by touching.

Guarantee: exact; coordinates are compared by their ranks, which are exact integers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Integers = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Touching:
    """Pairs of leaves, as positions in the array of leaves; each pair once.

    Attributes
    ----------
    first, second : shape (k,).
    along : whether the two share a segment; else they share one point.
    """

    first: Integers
    second: Integers
    along: NDArray[np.bool_]


def touching(leaves: Integers) -> Touching:
    """The pairs of leaves whose closures meet.

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
    return Touching(
        np.concatenate([a, c]),
        np.concatenate([b, d]),
        np.concatenate([along, np.ones(len(c), dtype=np.bool_)]),
    )


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
