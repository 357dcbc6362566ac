"""Where the solutions over a point or a box of the window may be, by exclusion: where Krawczyk's test
begins to look.

Guarantee: all solutions that the map counts are in the boxes. Nothing else is claimed: which of the
boxes have one is proved elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ptmcad.verification.exclusion.boxsearch import isolate
from ptmcad.verification.exclusion.criticalsystems import halves_over, solutions_of
from ptmcad.verification.exclusion.forms import enclosing
from ptmcad.verification.exclusion.pieces import Pieces, no_pieces
from ptmcad.verification.exclusion.systemtapes import CriticalSystem
from ptmcad.verification.normalform.boxes import Box, Floats, Unproved
from ptmcad.verification.normalform.lattice import Range, SliceLattice

BUDGET = 16_000
"""Boxes that are looked at for one place and one choice of sides ..."""
MAX_LEFT = 512
"""... and that may be left."""
MIN_WIDTH = 2.0**-24
"""Share of all configurations' width: boxes that are narrower are not halved."""
PER_SHARE = 2.0
"""The same for each share of the window's width that the rectangle has: solutions are in boxes of
such a width.
"""
_ROOM = 2.0**-16
"""Of the same, at least half the width of a box that is left: balls prove nothing in one that is
nearly a point.
"""
_ROUNDED_UP = 1 + 2.0**-50


class SolutionPlaces:
    """The boxes of the solutions of a slice's model.

    Real unknowns may have bounds that are proved over the window; where they have not, each place
    has its own.
    """

    def __init__(self, lattice: SliceLattice):
        self._lattice = lattice
        self._halves: Floats | None = None
        with suppress(Unproved):
            self._halves = halves_over(lattice, lattice.window, lattice.window)
        self._systems = solutions_of(lattice, self._halves)

    def __call__(self, u: Range, v: Range) -> list[Isolation]:
        """Over a rectangle of the window, for each choice of sides of springs on one line each, in
        the order of `normalform.waves.sides`.

        Raises
        ------
        Unproved
            When no bound of a real unknown is proved.
        """
        halves = self._halves or halves_over(self._lattice, u, v)
        share = max(high - low for low, high in (u, v)) / self._lattice.steps
        smallest = max(MIN_WIDTH, PER_SHARE * float(share))
        rectangle = [(enclosing(low)[0], enclosing(high)[1]) for low, high in (u, v)]
        pieces = no_pieces(self._lattice.steps)
        return [Isolation(system, halves, rectangle, smallest, pieces) for system in self._systems]


@dataclass(frozen=True)
class Isolation:
    """The boxes of one system's solutions over a rectangle, which are looked for when they are
    asked for.

    Attributes
    ----------
    whole : half the width of all configurations, in each unknown.
    """

    system: CriticalSystem
    whole: Floats
    rectangle: Sequence[tuple[float, float]]
    smallest: float
    pieces: Pieces

    def __iter__(self) -> Iterator[Box]:
        return iter(self._boxes)

    @cached_property
    def _boxes(self) -> list[Box]:
        boxes = np.empty((MAX_LEFT, *self.system.start.shape))
        boxes[0] = [*self.rectangle, *((-half, half) for half in self.whole)]
        compiled = self.system.compiled(self.smallest, self.whole)
        left = isolate(compiled, self.pieces, boxes, BUDGET)
        return [_box(rows, self.whole) for rows in boxes[:left, 2:].tolist()]


def _box(rows: list[list[float]], whole: Floats) -> Box:
    """A box by its middle and half widths, which are made larger than some share of all
    configurations.
    """
    middle = tuple(0.5 * (low + high) for low, high in rows)
    halves = (
        max((high - m) * _ROUNDED_UP, (m - low) * _ROUNDED_UP, w * _ROOM)
        for m, (low, high), w in zip(middle, rows, whole, strict=True)
    )
    return middle, tuple(halves)
