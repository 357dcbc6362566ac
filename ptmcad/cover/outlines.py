"""The outlines of components as closed polygons on the lattice.

Guarantee: exact. A component's polygons have it at their left hand, so that its outer ones turn
left and those around its holes turn right; where a component touches itself in a corner, the
polygons touch there and do not cross.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ptmcad.cover.complement import Components
from ptmcad.cover.subdivision import CUT, FREE, Integers, touching

_EAST, _NORTH, _WEST, _SOUTH = range(4)


def outlines(components: Components, numbers: Collection[int]) -> tuple[tuple[Integers, ...], ...]:
    """For each of some components its polygons as arrays of corners, shape (k, 2); the last corner
    is not the first.
    """
    tree = components.subdivision
    parts = np.flatnonzero(tree.state != CUT)
    leaves = tree.bounds[parts]
    wanted = np.full(len(components.areas) + 1, -1, dtype=np.int64)
    wanted[list(numbers)] = np.arange(len(numbers))
    inside = tree.state[parts] == FREE
    owner = np.where(inside, wanted[np.where(inside, components.owner[parts], -1)], -1)
    starts, ends, direction, own = _sides(leaves, owner, components.cover.steps)
    polygons: list[list[Integers]] = [[] for _ in numbers]
    following = _following(starts, ends, direction, components.cover.steps).tolist()
    turns = direction[following] != direction
    seen = bytearray(len(following))
    for first in range(len(following)):
        if seen[first]:
            continue
        corners = []
        k = first
        while not seen[k]:
            seen[k] = 1
            if turns[k]:
                corners.append(k)
            k = following[k]
        polygons[int(own[first])].append(ends[corners])
    return tuple(map(tuple, polygons))


def _sides(
    leaves: Integers, owner: Integers, steps: int
) -> tuple[Integers, Integers, Integers, Integers]:
    """All pieces of the leaves' sides between an owner (not -1) and something else, with the owner
    at the left.
    """
    pairs = touching(leaves)
    first, second = pairs.first[pairs.along], pairs.second[pairs.along]
    found: list[tuple[Integers, Integers, Integers, Integers, Integers, Integers]] = []
    for one, other in ((first, second), (second, first)):
        edge = (owner[one] >= 0) & (owner[one] != owner[other])
        inner, outer = one[edge], other[edge]
        a, b = leaves[inner], leaves[outer]
        low = np.maximum(a[:, (0, 2)], b[:, (0, 2)])
        high = np.minimum(a[:, (1, 3)], b[:, (1, 3)])
        upright = low[:, 0] == high[:, 0]
        # right of the owner the piece goes up, above it to the left
        after = np.where(upright, a[:, 1] == b[:, 0], a[:, 3] == b[:, 2])
        direction = np.where(
            upright, np.where(after, _NORTH, _SOUTH), np.where(after, _WEST, _EAST)
        )
        found.append((low[:, 0], low[:, 1], high[:, 0], high[:, 1], direction, owner[inner]))
    held = np.flatnonzero(owner >= 0)
    for column, rim, direction_there in (
        (0, 0, _SOUTH),
        (1, steps, _NORTH),
        (2, 0, _EAST),
        (3, steps, _WEST),
    ):
        at = held[leaves[held, column] == rim]
        box = leaves[at].copy()
        box[:, column ^ 1] = rim
        found.append(
            (
                box[:, 0],
                box[:, 2],
                box[:, 1],
                box[:, 3],
                np.full(len(at), direction_there),
                owner[at],
            )
        )
    x0, y0, x1, y1, direction, own = (np.concatenate(column) for column in zip(*found, strict=True))
    forward = (direction == _EAST) | (direction == _NORTH)
    low, high = np.stack([x0, y0], axis=1), np.stack([x1, y1], axis=1)
    return (
        np.where(forward[:, None], low, high),
        np.where(forward[:, None], high, low),
        direction,
        own,
    )


def _following(starts: Integers, ends: Integers, direction: Integers, steps: int) -> Integers:
    """For each piece the one that goes on from its end: to the left if there is one, else on, else
    to the right.
    """
    rows, ranks = np.unique(np.concatenate([starts[:, 1], ends[:, 1]]), return_inverse=True)
    _, places = np.unique(np.concatenate([starts[:, 0], ends[:, 0]]), return_inverse=True)
    point = places * len(rows) + ranks
    begin, end = point[: len(starts)], point[len(starts) :]
    order = np.argsort(begin * 4 + direction)
    keys = (begin * 4 + direction)[order]
    following = np.full(len(starts), -1, dtype=np.int64)
    for turn in (3, 0, 1):  # the last one that is found stays
        wanted = end * 4 + (direction + turn) % 4
        at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        found = keys[at] == wanted
        following[found] = order[at[found]]
    return following
