"""The arrangement of a map's regions: which there are, which are neighbours, in which order they
lie along the sides.

Guarantee: an arrangement depends on the map's regions alone, not on how the window was decomposed.
`correspondence` is None only where two arrangements differ.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable
from dataclasses import dataclass

SIDES = ("low x", "high x", "low y", "high y")
"""The window's sides: the first is where the first axis is lowest."""


@dataclass(frozen=True, slots=True)
class Arrangement:
    """Regions by their numbers, from 0.

    Attributes
    ----------
    keys : of each region the count that tells it from its neighbours.
    neighbours : pairs of regions, the smaller number first, with an arc in common.
    sides : for each of `SIDES`, the regions that touch it along an arc, in increasing order of the
        other coordinate.
    """

    keys: tuple[tuple[int, ...], ...]
    neighbours: frozenset[tuple[int, int]]
    sides: tuple[tuple[int, ...], ...]

    def around(self, region: int) -> frozenset[int]:
        """A region's neighbours."""
        return frozenset(b if a == region else a for a, b in self.neighbours if region in (a, b))

    def touched(self, region: int) -> tuple[int, ...]:
        """How often a region touches each side."""
        return tuple(side.count(region) for side in self.sides)


def correspondence(a: Arrangement, b: Arrangement) -> tuple[int, ...] | None:
    """To each region of ``a`` one of ``b``, so that all is the same; None where there is no such
    correspondence.

    Colours are refined by those of neighbours; where some regions still have one colour, one of
    them is chosen and tried with each of the same colour on the other side. Along the sides regions
    are known by their places, so that few are left, and with trees and forests of islands, however
    symmetric, the first try is never wrong.
    """
    if len(a.keys) != len(b.keys) or len(a.neighbours) != len(b.neighbours):
        return None
    graphs = [
        [sorted(arrangement.around(n)) for n in range(len(arrangement.keys))]
        for arrangement in (a, b)
    ]
    return _matched(graphs, [_first_colours(a), _first_colours(b)])


Colours = list[Hashable]


def _first_colours(a: Arrangement) -> Colours:
    """Of each region its count and its places along the sides."""
    return [
        (key, tuple((s, i) for s, side in enumerate(a.sides) for i, m in enumerate(side) if m == n))
        for n, key in enumerate(a.keys)
    ]


def _matched(graphs: list[list[list[int]]], colours: list[Colours]) -> tuple[int, ...] | None:
    first, second = _refined(graphs, colours)
    sizes = Counter(first)
    if sizes != Counter(second):
        return None
    if len(sizes) == len(first):
        # regions of one colour have neighbours of the same colours: what keeps colours keeps
        # neighbours
        places = {colour: n for n, colour in enumerate(second)}
        return tuple(places[colour] for colour in first)
    colour = min((c for c in sizes if sizes[c] > 1), key=lambda c: (sizes[c], c))
    chosen = first.index(colour)
    for other in (n for n, c in enumerate(second) if c == colour):
        tried: list[Colours] = [list(first), list(second)]
        tried[0][chosen] = tried[1][other] = -1
        found_there = _matched(graphs, tried)
        if found_there is not None:
            return found_there
    return None


def _refined(graphs: list[list[list[int]]], colours: list[Colours]) -> tuple[list[int], list[int]]:
    """The coarsest colours, numbered alike, of which each has the same colours around it wherever
    in the two graphs.
    """
    now = _numbered(colours)
    while True:
        finer: list[Colours] = [
            [(c, tuple(sorted(of[m] for m in around))) for c, around in zip(of, graph, strict=True)]
            for of, graph in zip(now, graphs, strict=True)
        ]
        following = _numbered(finer)
        if max(map(max, following)) == max(map(max, now)):
            return now[0], now[1]
        now = following


def _numbered(colours: list[Colours]) -> list[list[int]]:
    numbers = {colour: n for n, colour in enumerate(sorted({*colours[0], *colours[1]}, key=repr))}
    return [[numbers[colour] for colour in of] for of in colours]
