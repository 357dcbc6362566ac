"""What a cover leaves of the window: connected components with exact areas, and the clusters of
rectangles between; what a component borders on, sample points well inside of it, and its outline as
closed polygons on the lattice.

Guarantee: exact. Two points of the open window are in one component if and only if a path joins
them that meets no closed rectangle; two rectangles are in one cluster if and only if a chain of
rectangles with common points joins them. A sample is in its component, and not in any closed
rectangle. A component's polygons have it at their left hand, so that its outer ones turn left and
those around its holes turn right; where a component touches itself in a corner, the polygons touch
there and do not cross.
"""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ptmcad.cover.rectangles import Cover, Rectangle, Window
from ptmcad.cover.subdivision import (
    COVERED,
    CUT,
    FREE,
    Integers,
    Subdivision,
    touching,
)


@dataclass(frozen=True, slots=True, eq=False)
class Components:
    """The components, by descending area, then from the left, then from below; and the clusters in
    the same order.

    Attributes
    ----------
    areas : of the components, in squares of a lattice step.
    rectangles : for each component an open rectangle inside of it that cannot be made longer on any
        side: the part of the subdivision with the longest smaller side, grown.
    cluster_areas : areas of the unions of the clusters' rectangles.
    cluster_of : for each rectangle of the cover the number of its cluster.
    clusters_at : for each component the clusters that it touches along a segment or in a point,
        ascending.
    subdivision : of the window.
    owner : for each part of the subdivision the number of its component or, for a covered one, of
        its cluster.
    """

    cover: Cover
    areas: tuple[int, ...]
    rectangles: tuple[Rectangle, ...]
    cluster_areas: tuple[int, ...]
    cluster_of: tuple[int, ...]
    clusters_at: tuple[tuple[int, ...], ...]
    subdivision: Subdivision
    owner: Integers

    def locate(self, u: Fraction, v: Fraction) -> int | None:
        """The component of a point in lattice coordinates; None when the point is in a closed
        rectangle.

        Raises
        ------
        ValueError
            When the point is not in the open window.
        """
        steps = self.cover.steps
        if not (0 < u < steps and 0 < v < steps):
            raise ValueError(f"({u}, {v}) is not in the open window")
        leaves = self.subdivision.leaves_at(u, v)
        if any(self.subdivision.state[leaf] == COVERED for leaf in leaves):
            return None
        return int(self.owner[leaves[0]])

    def numbered(self, samples: Iterable[Iterable[Fraction]], window: Window) -> dict[int, int]:
        """For each component that holds a sample, in the axes' own units, the sample's number.

        Raises
        ------
        ValueError
            When a sample is not in the open window, or not in a component of its own.
        """
        found: dict[int, int] = {}
        for number, sample in enumerate(samples):
            u, v = (
                (value - low) / (high - low) * self.cover.steps
                for value, (low, high) in zip(sample, window, strict=True)
            )
            component = self.locate(u, v)
            if component is None or component in found:
                raise ValueError(
                    f"the sample of cell {number} is in the cover or in the component of another cell"
                )
            found[component] = number
        return found

    def raster(self, across: Integers, up: Integers) -> Integers:
        """The component just right of and above each lattice point, -1: none; shape (len(up),
        len(across)).
        """
        tree = self.subdivision
        leaves = tree.leaves_right_above(np.tile(across, len(up)), np.repeat(up, len(across)))
        # a covered leaf's owner is a cluster, not a component
        found = np.where(tree.state[leaves] == FREE, self.owner[leaves], -1)
        return found.reshape(len(up), len(across))

    @property
    def touching(self) -> tuple[tuple[int, int], ...]:
        """All pairs of a component and a cluster that touch."""
        return tuple(
            (n, cluster) for n, clusters in enumerate(self.clusters_at) for cluster in clusters
        )

    def area_bounds(self, number: int, known: Container[int]) -> tuple[int, int]:
        """A component's area; and with all that can be reached from it without entering another known
        component.

        In squares of a lattice step. What is reached are clusters, each of them once, and components
        that are not known. The connected set of points with the component's count is no larger, unless
        it reaches another known component.
        """
        around: dict[int, list[int]] = {}
        for component, cluster in self.touching:
            around.setdefault(cluster, []).append(component)
        reached, clusters, waiting = {number}, set[int](), [number]
        while waiting:
            for cluster in self.clusters_at[waiting.pop()]:
                if cluster not in clusters:
                    clusters.add(cluster)
                    more = {m for m in around[cluster] if m not in known} - reached
                    reached |= more
                    waiting += more
        high = sum(self.areas[m] for m in reached) + sum(
            self.cluster_areas[cluster] for cluster in clusters
        )
        return self.areas[number], high


_PLACES = (
    (Fraction(1, 2), Fraction(1, 2)),
    (Fraction(1, 3), Fraction(3, 7)),
    (Fraction(3, 5), Fraction(2, 7)),
)
"""Where the points are, as parts of the sides of the component's rectangle ..."""
_REACH = Fraction(1, 8)
"""... and how far they may be from there."""


def samples(
    components: Components, number: int, window: Window
) -> Iterator[tuple[Fraction, Fraction]]:
    """Simple points in the middle of the component's rectangle, and then off the middle, in the
    axes' own units.
    """
    left, right, bottom, top = components.rectangles[number]
    steps = components.cover.steps
    for u, v in _PLACES:
        yield _near(left, right, u, window[0], steps), _near(bottom, top, v, window[1], steps)


def _near(
    first: int, last: int, place: Fraction, interval: tuple[Fraction, Fraction], steps: int
) -> Fraction:
    step = (interval[1] - interval[0]) / steps
    middle, reach = first + (last - first) * place, (last - first) * _REACH
    return simplest_between(
        interval[0] + (middle - reach) * step, interval[0] + (middle + reach) * step
    )


def simplest_between(low: Fraction, high: Fraction) -> Fraction:
    """The fraction of least denominator, then of least absolute value, in the closed interval from
    low to high.

    >>> simplest_between(Fraction(3, 10), Fraction(7, 20)), simplest_between(Fraction(-5, 2), Fraction(-3, 2))
    (Fraction(1, 3), Fraction(-2, 1))
    """
    if low <= 0 <= high:
        return Fraction(0)
    if high < 0:
        return -simplest_between(-high, -low)
    # continued fractions of both ends, as far as they agree
    terms = []
    while True:
        whole = low.__ceil__()
        if whole <= high:
            terms.append(whole)
            break
        floor = whole - 1
        terms.append(floor)
        low, high = 1 / (high - floor), 1 / (low - floor)
    value = Fraction(terms.pop())
    while terms:
        value = terms.pop() + 1 / value
    return value


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
    first, second, along = touching(leaves)
    first, second = first[along], second[along]
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
