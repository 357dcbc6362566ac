"""Covers of enclosed curves: the rectangles of their boxes, or pieces of strips that are as thin as
is asked, without specks, which are small clusters that no curve enters after all.

Guarantee: each point of the window that lies on the projection of a curve lies in a rectangle.
(Lemmas 12 and 16 of docs/soundness.md.)
A cluster is taken away only if no box that may hold a part of a curve meets it; what is
left is a cover of the curves still. (A point of a curve in a cluster lies in a box of its
enclosure, which meets the cluster and so is searched again; no box that the search leaves meets it.
Where one half of the window is searched, that holds of the point or its image, and no box meets the
cluster or its image.)

Where a box is contracted to a sliver at its edge, its projection is small at once, and it is left
alone although the next bisection would discard it. Such slivers are a few hundred-thousandths of
the window, and seen in each picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import compress
from math import inf

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.boxstrips import (
    NONE,
    Strips,
    areas_of_pieces,
    numbers_of_pieces,
    pieces,
    strips,
)
from ptmcad.certified.branchandprune import Boxes, search_curve
from ptmcad.certified.refinement import BUDGET, CurveEnclosure
from ptmcad.cover.complement import Components
from ptmcad.cover.connectivity import components, union_area
from ptmcad.cover.lattice import combined, cover_of, from_boxes, gathered
from ptmcad.cover.rectangles import Cover, Window
from ptmcad.cover.subdivision import COVERED, FREE, Integers, rectangle_array
from ptmcad.formulas.tape import enclosing_floats
from ptmcad.model.involutions import Involution

START_TILES = 8
"""Tiles of the window along each axis, with which a search begins."""
MAX_TILES = 1000
"""Rectangles that the search begins with at most, when it goes on from a cover: each costs a search
of all angles.
"""
BATCH = 4096
SLACK = 0.9
"""Pieces are made so thin that their areas sum up to this part of what may be left undetermined."""
CUT_COVERAGE = 0.5
"""A strip is cut if its finest pieces cover less than this part of its rectangle."""
HALVINGS = 200
"""Of the area by which a piece may be larger than its strip, at most; below, floats are exhausted.
"""
MAX_SHARE = Fraction(1, 10_000)
"""Of the window: larger clusters are no specks."""
ROUNDS, FINER = 3, 4.0**-2
"""The number of rounds, and by what the area of boxes' projections is multiplied in each."""
MAX_GROWTH = 2
"""A cluster of which there are more than so many times the boxes after a round is no speck: along a
curve, there are four times as many."""
MAX_PAIRS = 3 * 10**7
"""Rectangles of specks times boxes: beyond, to look for them would take seconds."""


@dataclass(frozen=True, slots=True)
class Lattice:
    """Where covers lie: the window, and the number of lattice steps along each axis.

    Attributes
    ----------
    change : an involution of the window; of each tile and its image only one is searched.
    """

    window: Window
    steps: int
    change: Involution | None = None

    def cover(self, rectangles: Boxes) -> Cover:
        """The cover of rectangles (left, bottom, right, top), and of their images."""
        found = from_boxes(self.window, rectangles[:, :2], rectangles[:, 2:], self.steps)
        if self.change is None:
            return found
        array, size = rectangle_array(found), self.steps // START_TILES
        around = array[:, [0, 0, 2, 2]] // size * size + np.array([0, size, 0, size])
        # a tile that is its own image is searched whole
        alone = (around == self.images(around, self.steps)).all(axis=1) & (array <= around)[
            :, [1, 3]
        ].all(axis=1)
        return cover_of(np.concatenate([array, self.images(array[~alone], self.steps)]), self.steps)

    def images(self, rectangles: Integers, steps: int) -> Integers:
        """Of rectangles on a lattice of so many steps, row by row."""
        if self.change is None:
            return rectangles
        sides = [
            rectangles[:, [2 * j, 2 * j + 1]]
            if sign > 0
            else steps - rectangles[:, [2 * j + 1, 2 * j]]
            for j, sign in zip(self.change.axes, self.change.axis_signs, strict=True)
        ]
        return np.concatenate(sides, axis=1)

    @property
    def copies(self) -> int:
        """How many times as much a cover has as is searched: what is searched and its images. Of
        areas a bound, as a tile may be its own image.
        """
        return 1 if self.change is None else 2


def outward(window: Window, rectangles: Integers, steps: int) -> Boxes:
    """Floats around rectangles on a lattice of so many steps: left, bottom, right, top."""
    result = np.empty((len(rectangles), 4))
    for k, (low, high) in enumerate(window):
        lines, places = np.unique(rectangles[:, 2 * k : 2 * k + 2], return_inverse=True)
        around = [
            enclosing_floats(low + (high - low) * Fraction(line, steps)) for line in lines.tolist()
        ]
        result[:, [k, 2 + k]] = np.array(around).reshape(-1, 2)[places.reshape(-1, 2), [0, 1]]
    return result


def first_rectangles(lattice: Lattice, resume: Cover | None) -> Boxes:
    """The rectangles (low x, low y, high x, high y) with which the search begins, rounded outwards."""
    if resume is None:
        steps = START_TILES
        tiles = np.array([(i, i + 1, j, j + 1) for i in range(steps) for j in range(steps)])
        others = lattice.images(tiles, steps).tolist()
        rectangles = tiles[
            [tile <= other for tile, other in zip(tiles.tolist(), others, strict=True)]
        ]
    else:
        most = min(
            Fraction(MAX_TILES), START_TILES**2 / max(share_of(resume), Fraction(1, MAX_TILES))
        )
        steps, rectangles = resume.steps, rectangle_array(gathered(resume, int(most)))
    return outward(lattice.window, rectangles, steps)


def share_of(cover: Cover) -> Fraction:
    """The part of the window that a cover has."""
    return Fraction(union_area(cover), cover.steps**2)


def meeting(rectangles: Boxes, boxes: Boxes) -> NDArray[np.bool_]:
    """Which rectangles and which boxes' projections have points in common: shape (rectangles,
    boxes).
    """
    half = boxes.shape[1] // 2
    low, high = boxes[:, :2], boxes[:, half : half + 2]
    result: NDArray[np.bool_] = np.ones((len(rectangles), len(boxes)), dtype=np.bool_)
    for k in (0, 1):
        result &= rectangles[:, None, k] <= high[None, :, k]
        result &= rectangles[:, None, 2 + k] >= low[None, :, k]
    return result


def box_rectangles(enclosures: Sequence[CurveEnclosure]) -> Boxes:
    """The projections of all boxes, shape (k, 4)."""
    boxes = [enclosure.boxes() for enclosure in enclosures]
    return np.concatenate(
        [np.concatenate([b[:, :2], b[:, b.shape[1] // 2 :][:, :2]], axis=1) for b in boxes]
    )


@dataclass(frozen=True, slots=True, eq=False)
class Thinning:
    """Strips of all boxes, and how much of the window they leave undetermined.

    Attributes
    ----------
    thin : strips that are worth cutting into pieces.
    whole : the other ones, and boxes without; around a cusp or a crossing they overlap many times.
    whole_area : of the union of ``whole`` in the window.
    """

    thin: Strips
    whole: Strips
    whole_area: float
    lattice: Lattice

    def least(self) -> float:
        """About the area that the finest pieces leave."""
        return self.whole_area + self.lattice.copies * float(areas_of_pieces(self.thin, 0.0).sum())

    def cover(self, area: float, most: int | None = None) -> Cover:
        """A cover whose area is about the given one, or the least; the more it may be the fewer the
        pieces are.

        Parameters
        ----------
        most : number of pieces that is not exceeded by more than a factor.
        """
        step = self._step(area, most)
        return self.lattice.cover(
            np.concatenate([pieces(self.whole, inf), pieces(self.thin, step)])
        )

    def number(self, area: float) -> int:
        """About how many rectangles `cover` has."""
        pieces_of_thin = int(numbers_of_pieces(self.thin, self._step(area, None)).sum())
        return self.lattice.copies * (len(self.whole) + pieces_of_thin)

    def _step(self, area: float, most: int | None) -> float:
        wanted = (max(SLACK * area, 1.1 * self.least()) - self.whole_area) / self.lattice.copies
        (left, right), (bottom, top) = self.lattice.window
        step = float((right - left) * (top - bottom))
        for _ in range(HALVINGS):
            enough = areas_of_pieces(self.thin, step).sum() <= wanted
            if enough or (
                most is not None
                and numbers_of_pieces(self.thin, step).sum() > most / self.lattice.copies
            ):
                break
            step /= 2
        return step


def thinning(enclosures: Sequence[CurveEnclosure], lattice: Lattice, jobs: int) -> Thinning:
    """The strips of all boxes of the curves."""
    with ThreadPoolExecutor(jobs) as pool:
        found = [
            pool.submit(strips, enclosure.curve.system.arguments, boxes[start : start + BATCH])
            for enclosure in enclosures
            for boxes in [enclosure.boxes()]
            for start in range(0, len(boxes), BATCH)
        ]
        together = np.concatenate([NONE, *(future.result() for future in found)])
    worthwhile = areas_of_pieces(together, 0.0) < CUT_COVERAGE * areas_of_pieces(together, inf)
    whole = together[~worthwhile]
    (left, right), (bottom, top) = lattice.window
    squares = union_area(combined(lattice.cover(pieces(whole, inf))))
    area = float((right - left) * (top - bottom) * squares / lattice.steps**2)
    return Thinning(together[worthwhile], whole, area, lattice)


def without_specks(
    complement: Components, enclosures: Sequence[CurveEnclosure], lattice: Lattice, area: float
) -> Components:
    """The components of a cover's complement, and its clusters, without its specks.

    Parameters
    ----------
    complement : of a cover of all that the enclosures hold.
    area : of a box's projection, below which the search has left it alone.
    """
    cover = complement.cover
    most = MAX_SHARE * cover.steps**2
    small = np.array([share <= most for share in complement.cluster_areas], dtype=np.bool_)
    cluster_of = np.array(complement.cluster_of, dtype=np.int64)
    chosen = np.flatnonzero(small[cluster_of]) if len(cluster_of) else cluster_of
    boxes = [enclosure.boxes() for enclosure in enclosures]
    places, owners = rectangle_array(cover)[chosen], np.tile(cluster_of[chosen], lattice.copies)
    if lattice.change is not None:  # where no box is there may be one over the image
        places = np.concatenate([places, lattice.images(places, cover.steps)])
    if not len(chosen) or len(places) * sum(map(len, boxes)) > MAX_PAIRS:
        return complement
    rectangles, clusters = outward(lattice.window, places, cover.steps), np.flatnonzero(small)
    specks = [rectangles[owners == n] for n in clusters]
    held = np.zeros(len(specks), dtype=np.bool_)
    for enclosure, own in zip(enclosures, boxes, strict=True):
        curve, left, searched, met = enclosure.curve, own, ~held, _entered(specks, own)
        for number in range(1, ROUNDS + 1):
            near, finer = left[met[searched].any(axis=0)], area * FINER**number
            left = search_curve(curve.system.arguments, near, finer, BUDGET, curve.weights).left()
            before, met = met.sum(axis=1), _entered(specks, left)
            searched &= met.sum(axis=1) <= MAX_GROWTH * before
        held = ~searched | met.any(axis=1)
    if held.all():
        return complement
    tree, lost = complement.subdivision, clusters[~held]
    kept = tuple(compress(cover.rectangles, ~np.isin(cluster_of, lost)))
    # what they cover is free now, and no part has to be cut again
    state = np.where((tree.state == COVERED) & np.isin(complement.owner, lost), FREE, tree.state)
    return components(cover._replace(rectangles=kept), replace(tree, state=state))


def _entered(specks: Sequence[Boxes], boxes: Boxes) -> NDArray[np.bool_]:
    """Which of several sets of rectangles, and which boxes' projections, have points in common."""
    return np.array([meeting(rectangles, boxes).any(axis=0) for rectangles in specks])
