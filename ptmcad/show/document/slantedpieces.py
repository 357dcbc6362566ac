"""Slanted pieces in covers of earlier versions, read as rectangles around them.

Guarantee: each piece is held by its rectangles, and the map that is made of them claims no more than
the one that was stored.

A piece is a frame, which is a rectangle of the lattice, with tubes along one of the axes: all points
of the frame within a half width of a polynomial's graph, in the direction across. The polynomial's
coefficients are in Bernstein's basis of the frame's side.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import comb
from typing import Any, NamedTuple

from ptmcad.answer.regionmap import Cell, Region, RegionMap
from ptmcad.cover import components
from ptmcad.cover.rectangles import Cover, Rectangle
from ptmcad.text.node import Node

MAX_PIECES = 200_000
MAX_CONTROLS = 64
MAX_CONTROL = 2**60
"""Of a half width, and of a coefficient's absolute value."""
MIN_COLUMNS, MAX_COLUMNS = 32, 1024
FINENESS = 2**13
"""Rectangles are narrower than this part of the window where they can be."""


class Tube(NamedTuple):
    """One tube in its frame, along axis 0 or 1."""

    frame: Rectangle
    along: int
    half: int
    controls: tuple[int, ...]

    def rectangles(self, steps: int) -> Iterator[Rectangle]:
        """Rectangles that hold the tube, in the order in which they go along it."""
        left, right, bottom, top = self.frame
        low, high, least, most = self.frame if self.along == 0 else (bottom, top, left, right)
        degree, fineness = len(self.controls) - 1, (high - low) * FINENESS // steps
        columns = max(MIN_COLUMNS, min(MAX_COLUMNS, fineness))
        rise = degree * max(abs(b - a) for a, b in pairwise(self.controls))
        reach = self.half + rise // (2 * columns) + 1
        for k in range(columns):
            a, b = 2 * k + 1, 2 * (columns - k) - 1
            sums = (
                comb(degree, i) * a**i * b ** (degree - i) * c for i, c in enumerate(self.controls)
            )
            middle = sum(sums) // (2 * columns) ** degree
            start = low + (high - low) * k // columns
            end = min(low + (high - low) * (k + 1) // columns + 1, high)
            first, last = max(least, middle - reach), min(most, middle + 1 + reach)
            if first < last:
                yield (start, end, first, last) if self.along == 0 else (first, last, start, end)


def read_tubes(node: Node, steps: int) -> Iterator[Tube]:
    """The tubes of all pieces.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    if not isinstance(node.value, list) or len(node.value) > MAX_PIECES:
        raise node.fault(f"is not a list of at most {MAX_PIECES} slanted pieces")
    for k, value in enumerate(node.value):
        place = Node(value, f"{node.place}[{k}]")
        if not (isinstance(value, list) and all(type(n) is int for n in value[:5])):
            raise place.fault("does not begin with a frame and an axis: five integers")
        match value:
            case [left, right, bottom, top, 0 | 1 as along, *tubes] if (
                0 <= left < right <= steps and 0 <= bottom < top <= steps and tubes
            ):
                for tube in tubes:
                    yield Tube((left, right, bottom, top), along, *_polynomial(tube, place))
            case _:
                raise place.fault("is not a frame in the window, an axis and tubes")


def _polynomial(tube: Any, place: Node) -> tuple[int, tuple[int, ...]]:
    match tube:
        case [half, _, _, *_] if (
            len(tube) <= MAX_CONTROLS + 1
            and all(type(n) is int and abs(n) <= MAX_CONTROL for n in tube)
            and half > 0
        ):
            return half, tuple(tube[1:])
    raise place.fault(f"has a tube that is not a half width and up to {MAX_CONTROLS} controls")


def with_cover(result: RegionMap, cover: Cover) -> RegionMap:
    """The map over a cover that holds its own: cells whose samples are outside, and their areas.

    Parameters
    ----------
    cover : of rectangles around all that the map's cover had.

    Raises
    ------
    ValueError
        When a sample is not in the window.
    """
    complement = components(cover)
    places = [
        complement.locate(*(
            axis.share(value) * cover.steps
            for axis, value in zip(result.slice.axes, cell.sample, strict=True)
        ))
        for cell in result.cells
    ]  # fmt: skip
    known = dict(
        sorted((n, cell) for n, cell in zip(places, result.cells, strict=True) if n is not None)
    )
    square = result.slice.area / cover.steps**2
    cells, regions = list[Cell](), list[Region]()
    for number, (component, cell) in enumerate(known.items()):
        low, high = complement.area_bounds(component, known)
        cells.append(replace(cell, level=component, region=number))
        area = low * square, high * square
        regions.append(
            Region(cell.stable, cell.total, cell.index, area, (number,), cell.sample, cell.further)
        )
    return replace(
        result,
        cells=tuple(cells),
        regions=tuple(regions),
        undetermined=1 - Fraction(sum(complement.areas[n] for n in known), cover.steps**2),
        cover=cover,
    )
