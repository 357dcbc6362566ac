"""What a map says at the centres of a grid's pixels.

Guarantee: exact. A column of pixels is answered at once: every wall's place among the centres comes
from signs of its polynomial at centres; a certified map's pixels from its cover, in integers.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from fractions import Fraction

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from ptmcad.algebra.real_roots import RealRoot, order, sign_at
from ptmcad.answer.boundaries import NONE, Grid
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.location import component_cells, locate, stack_over
from ptmcad.errors import ConfigError
from ptmcad.exact.cad.projection import by_component, curves_of, lines_of
from ptmcad.question.slice import within_doubles
from ptmcad.text.flint_numbers import from_fraction, interval_of

MAX_PIXELS = 10**8

Labels = NDArray[np.int64]


def grid(result: RegionMap, columns: int = 200, rows: int | None = None) -> Grid:
    """Region and counts at the centres of columns x rows pixels, exactly; as many rows as columns
    if not given.

    Raises
    ------
    ConfigError
        When the numbers are not positive or there are more than `MAX_PIXELS` pixels, or the map has
        no cells yet.

    >>> import ptmcad
    >>> ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho")).grid(4, 2).stable
    array([[1, 2, 2, 1],
           [1, 1, 1, 1]])
    """
    down = columns if rows is None else rows
    for name, number in (("columns", columns), ("rows", down)):
        if isinstance(number, bool) or not isinstance(number, (int, np.integer)) or number < 1:
            raise ConfigError(f"{name}={number!r} is not a positive whole number")
    if columns * down > MAX_PIXELS:
        raise ConfigError(f"{columns} x {down} pixels are more than {MAX_PIXELS}")
    if not result.cells:
        raise ConfigError(
            f"the map {result.slice.name} was stopped before it had cells: there is nothing to show"
        )
    centres = [
        [a.middle(k, int(n)) for k in range(int(n))]
        for a, n in zip(result.slice.axes, (columns, down), strict=True)
    ]
    cells = (_exact if result.cover is None else _certified)(result, centres)
    with within_doubles(result.slice):
        x, y = (np.array([float(v) for v in values]) for values in centres)
    return Grid(
        x,
        y,
        result.slice.axis_names,
        cells,
        *(
            at_pixels([getattr(cell, name) for cell in result.cells], cells)
            for name in ("region", "stable", "total")
        ),
    )


def at_pixels(known: Iterable[int | None], cells: Labels) -> Labels:
    """What is known of each cell, at pixels by the numbers of their cells; `NONE` for nothing."""
    table = np.array([*(NONE if v is None else v for v in known), NONE], dtype=np.int64)
    return table[cells]  # the label `NONE` is the last entry


def _exact(result: RegionMap, centres: list[list[Fraction]]) -> Labels:
    base = result.base
    curves = by_component(curves_of(result.components, base))
    lines = list(lines_of(result.components, base).values())
    heights = [from_fraction(v) for v in centres[1 - base]]
    fibre = interval_of(result.slice.axes[1 - base])
    image = np.full((len(centres[base]), len(heights)), NONE, dtype=np.int64)
    for k, at in enumerate(centres[base]):
        u = from_fraction(at)
        if any(sign_at(p, u) == 0 for p in lines):
            continue  # the whole column is on a curve
        number, on_critical = stack_over(result, u)
        if on_critical:
            names = result.slice.axis_names
            for row, v in enumerate(centres[1 - base]):
                cell = locate(result, {names[base]: at, names[1 - base]: v}).cell
                image[k, row] = NONE if cell is None else cell
            continue
        stack = result.stacks[number]
        roots = {n: curves[n].roots_over(u, fibre) for n in {w.component for w in stack.walls}}
        first = 0
        for cell, wall in zip(stack.cells, stack.walls, strict=False):
            below, on_wall = _below(roots[wall.component][wall.root], heights)
            image[k, first:below] = cell
            first = below + on_wall
        image[k, first:] = stack.cells[-1]
    return image if base else image.T


def _below(root: RealRoot, heights: list[fmpq]) -> tuple[int, bool]:
    """How many of the increasing heights lie below a root, and whether the next one is the root."""
    below = bisect_left(heights, 0, key=lambda height: order(height, root))
    return below, below < len(heights) and order(heights[below], root) == 0


def _certified(result: RegionMap, centres: list[list[Fraction]]) -> Labels:
    complement, cells = component_cells(result)
    number_of = np.full(len(complement.areas) + 1, NONE, dtype=np.int64)
    number_of[list(cells)] = list(cells.values())
    places = [
        [axis.share(v) * complement.cover.steps for v in values]
        for axis, values in zip(result.slice.axes, centres, strict=True)
    ]
    columns, rows = (len(values) for values in places)
    whole = (np.array([int(p) for p in values], dtype=np.int64) for values in places)
    image: Labels = number_of[complement.raster(*whole)]
    # a centre on a line of the lattice may touch a closed rectangle at its left or below
    on_line = [{k for k, p in enumerate(values) if p.denominator == 1} for values in places]
    unsure = {
        (row, column)
        for row in range(rows)
        for column in (range(columns) if row in on_line[1] else on_line[0])
    }
    for row, column in unsure:
        component = complement.locate(places[0][column], places[1][row])
        image[row, column] = NONE if component is None else number_of[component]
    return image
