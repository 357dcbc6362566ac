"""Components and clusters of a cover.

Guarantee: exact.

As rectangles have interiors, an edge between two parts of the window that meet the interior of no
rectangle is in no rectangle, while a corner at which only two such parts meet, diagonally, is in
one. So components are joined across edges, and clusters across edges and corners.
"""

from __future__ import annotations

import numpy as np

from ptmcad.cover.complement import Components
from ptmcad.cover.rectangles import MAX_STEPS, Cover, Rectangle
from ptmcad.cover.subdivision import (
    COVERED,
    CUT,
    FREE,
    Integers,
    Subdivision,
    connected,
    rectangle_array,
    subdivide,
    touching,
)

_LIMB = 20
"""Bits of a half coordinate: products of halves are summed without overflow, and put together as
Python's integers.
"""


def components(cover: Cover, tree: Subdivision | None = None) -> Components:
    """The connected components of the open window without the closed rectangles.

    Parameters
    ----------
    tree : a subdivision by the cover; without it, it is made.

    Raises
    ------
    ValueError
        When a rectangle is not one, or the lattice is too fine.
    """
    array = rectangle_array(cover)
    tree = tree or subdivide(array, cover.steps)
    parts = np.flatnonzero(tree.state != CUT)
    leaves, free = tree.bounds[parts], tree.state[parts] == FREE
    first, second, along = touching(leaves)
    meeting = along | ~(free[first] & free[second])
    first, second = first[meeting], second[meeting]
    joined = free[first] == free[second]
    label = connected(len(parts), first[joined], second[joined])
    is_root = label == np.arange(len(label))  # a label is the smallest leaf of what is connected
    roots, group = np.flatnonzero(is_root), (np.cumsum(is_root) - 1)[label]
    areas = sums_of_areas(leaves, group, len(roots))
    shown, own = _numbered(leaves, group, areas, free[roots])
    owner = tree.labels(parts, own)
    first, second = first[~joined], second[~joined]
    inner, outer = np.where(free[first], (first, second), (second, first))
    clusters_at: list[list[int]] = [[] for _ in shown[True]]
    for pair in np.unique(own[inner] * len(roots) + own[outer]).tolist():
        component, cluster = divmod(pair, len(roots))
        clusters_at[component].append(cluster)
    cluster_of = (
        owner[tree.leaves_right_above(array[:, 0], array[:, 2])] if len(array) else array[:, 0]
    )
    return Components(
        cover,
        tuple(areas[k] for k in shown[True]),
        _rectangles(tree, leaves[free], own[free], len(shown[True])),
        tuple(areas[k] for k in shown[False]),
        tuple(cluster_of.tolist()),
        tuple(map(tuple, clusters_at)),
        tree,
        owner,
    )


def _numbered(
    leaves: Integers, group: Integers, areas: list[int], is_free: Integers
) -> tuple[dict[bool, list[int]], Integers]:
    """Components by descending area, then from the left, then from below, and clusters as well;
    and each leaf's number.
    """
    # the first leaf from the left and below is the last one that is written
    corners = np.empty((len(areas), 2), dtype=np.int64)
    order = np.lexsort((leaves[:, 2], leaves[:, 0]))[::-1]
    corners[group[order]] = leaves[order][:, (0, 2)]
    places = corners.tolist()
    rank = np.empty(len(areas), dtype=np.int64)
    shown = {}
    for kind in (True, False):
        shown[kind] = sorted(
            np.flatnonzero(is_free == kind).tolist(), key=lambda k: (-areas[k], places[k])
        )
        rank[shown[kind]] = np.arange(len(shown[kind]))
    return shown, rank[group]


def _rectangles(
    tree: Subdivision, leaves: Integers, component: Integers, number: int
) -> tuple[Rectangle, ...]:
    """For each component an open rectangle inside of it, grown from one of its free leaves."""
    best = np.empty((number, 4), dtype=np.int64)
    size = np.minimum(leaves[:, 1] - leaves[:, 0], leaves[:, 3] - leaves[:, 2])
    order = np.lexsort((-leaves[:, 2], -leaves[:, 0], size))
    best[component[order]] = leaves[order]
    around = np.empty((number, 4), dtype=np.int64)
    for k, (extreme, start) in enumerate(((np.minimum, MAX_STEPS), (np.maximum, 0)) * 2):
        around[:, k] = start
        extreme.at(around[:, k], component, leaves[:, k])
    return tuple(zip(*_grown(tree, best, around).T.tolist(), strict=True))


def _grown(tree: Subdivision, boxes: Integers, around: Integers) -> Integers:
    """Free rectangles made as long as they can be, first along their shorter sides; each stays in
    what is around it.
    """
    boxes = boxes.copy()
    upright = boxes[:, 1] - boxes[:, 0] > boxes[:, 3] - boxes[:, 2]
    for flipped in (False, True):
        for lower in (True, False):
            # column of the side that moves, and of the opposite one
            side = np.where(upright != flipped, 2, 0) + (0 if lower else 1)
            rows = np.arange(len(boxes))
            strip = boxes.copy()
            strip[rows, side], strip[rows, side ^ 1] = around[rows, side], boxes[rows, side]
            box, leaf = tree.meeting(strip)
            hit = tree.state[leaf] == COVERED
            ends = tree.bounds[leaf[hit], side[box[hit]] ^ 1]
            limit = strip[rows, side]
            (np.maximum if lower else np.minimum).at(limit, box[hit], ends)
            boxes[rows, side] = limit
    return boxes


def sums_of_areas(boxes: Integers, group: Integers, groups: int) -> list[int]:
    """The exact sum of the areas in each group."""
    width, tall = boxes[:, 1] - boxes[:, 0], boxes[:, 3] - boxes[:, 2]
    mask = (1 << _LIMB) - 1
    sums = [0] * groups
    for i in (0, 1):
        for j in (0, 1):
            part = np.zeros(groups, dtype=np.int64)
            # at most 2^40 each: room for 2^22 leaves
            np.add.at(
                part,
                group,
                ((width >> _LIMB) if i else width & mask) * ((tall >> _LIMB) if j else tall & mask),
            )
            shift = _LIMB * (i + j)
            sums = [s + (p << shift) for s, p in zip(sums, part.tolist(), strict=True)]
    return sums


def union_area(cover: Cover) -> int:
    """The area of the rectangles' union, in squares of a lattice step."""
    tree = subdivide(rectangle_array(cover), cover.steps)
    covered = tree.bounds[tree.state == COVERED]
    return sums_of_areas(covered, np.zeros(len(covered), dtype=np.int64), 1)[0]
