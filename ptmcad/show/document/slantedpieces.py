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
from typing import Any

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


def rectangles_around(pieces: Node, steps: int) -> Iterator[Rectangle]:
    """Rectangles that hold all pieces, tube after tube.

    Raises
    ------
    ValueError
        With the place of the first fault.
    """
    for place in pieces.items(most=MAX_PIECES):
        match place.value:
            case [left, right, bottom, top, 0 | 1 as along, *tubes] if (
                tubes
                and all(type(n) is int for n in (left, right, bottom, top))
                and 0 <= left < right <= steps
                and 0 <= bottom < top <= steps
            ):
                for tube in tubes:
                    half, *controls = _integers(tube, place)
                    yield from _around((left, right, bottom, top), along, half, controls, steps)
            case _:
                raise place.fault("is not a frame in the window, an axis and tubes")


def _integers(tube: Any, place: Node) -> list[int]:
    if not (
        isinstance(tube, list)
        and 3 <= len(tube) <= MAX_CONTROLS + 1
        and all(type(n) is int and abs(n) <= MAX_CONTROL for n in tube)
        and tube[0] > 0
    ):
        raise place.fault(f"has a tube that is not a half width and up to {MAX_CONTROLS} controls")
    return tube


def _around(
    frame: Rectangle, along: int, half: int, controls: list[int], steps: int
) -> Iterator[Rectangle]:
    """Rectangles that hold one tube in its frame, in the order in which they go along it."""
    low, high, least, most = frame if along == 0 else frame[2:] + frame[:2]
    degree, fineness = len(controls) - 1, (high - low) * FINENESS // steps
    columns = max(MIN_COLUMNS, min(MAX_COLUMNS, fineness))
    rise = degree * max(abs(b - a) for a, b in pairwise(controls))
    reach = half + rise // (2 * columns) + 1
    for k in range(columns):
        a, b = 2 * k + 1, 2 * (columns - k) - 1
        sums = (comb(degree, i) * a**i * b ** (degree - i) * c for i, c in enumerate(controls))
        middle = sum(sums) // (2 * columns) ** degree
        start = low + (high - low) * k // columns
        end = min(low + (high - low) * (k + 1) // columns + 1, high)
        first, last = max(least, middle - reach), min(most, middle + 1 + reach)
        if first < last:
            yield (start, end, first, last) if along == 0 else (first, last, start, end)


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
