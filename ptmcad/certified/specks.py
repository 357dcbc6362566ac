"""Specks: small clusters of a cover that no curve enters after all.

Guarantee: a cluster is taken away only if no box that may hold a part of a curve meets it; what is left is a cover of
the curves still. (A point of a curve in a cluster lies in a box of its enclosure, which meets the cluster and so is
searched again; no box that the search leaves meets it. Where one half of the window is searched, that holds of the
point or its image, and no box meets the cluster or its image.)

Where a box is contracted to a sliver at its edge, its projection is small at once, and it is left alone although the
next bisection would discard it. Such slivers are a few hundred-thousandths of the window, and seen in each picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.covering import Lattice
from ptmcad.certified.refinement import Enclosure
from ptmcad.certified.search import Boxes, search_curve
from ptmcad.certified.tape import enclosing_floats
from ptmcad.cover import components
from ptmcad.cover.complement import Components
from ptmcad.cover.rectangles import Cover, Rectangle
from ptmcad.cover.subdivision import rectangle_array

MAX_SHARE = Fraction(1, 10_000)
"""Of the window: larger clusters are no specks."""
FINER = 4.0**-6
"""Boxes are bisected until their projections are so many times smaller."""
BUDGET = 20_000
"""Boxes that are treated for each curve: about a tenth of a second."""
MAX_PAIRS = 3 * 10**7
"""Rectangles of specks times boxes: beyond, to look for them would take seconds."""


def without_specks(
    complement: Components, enclosures: Sequence[Enclosure], lattice: Lattice, area: float
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
    rectangles = np.array([_outward(lattice, cover, place) for place in places.tolist()])
    held = np.zeros(len(small), dtype=np.bool_)
    for enclosure, own in zip(enclosures, boxes, strict=True):
        near = own[_meeting(rectangles, own).any(axis=0)]
        curve = enclosure.curve
        found = search_curve(curve.system.arguments(), near, FINER * area, BUDGET, curve.importance())
        held[owners[_meeting(rectangles, found.left()).any(axis=1)]] = True
    kept = ~small[cluster_of] | held[cluster_of]
    if kept.all():
        return complement
    left = tuple(r for r, keep in zip(cover.rectangles, kept.tolist(), strict=True) if keep)
    return components(replace(cover, rectangles=left))


def _outward(lattice: Lattice, cover: Cover, rectangle: Rectangle) -> tuple[float, float, float, float]:
    """Floats around a rectangle: left, bottom, right, top."""
    ends = []
    for k, (low, high) in enumerate(lattice.window):
        step = (high - low) / cover.steps
        ends.append((enclosing_floats(low + step * rectangle[2 * k])[0],
                     enclosing_floats(low + step * rectangle[2 * k + 1])[1]))  # fmt: skip
    return ends[0][0], ends[1][0], ends[0][1], ends[1][1]


def _meeting(rectangles: Boxes, boxes: Boxes) -> NDArray[np.bool_]:
    """Which rectangles and which boxes' projections have points in common: shape (rectangles, boxes)."""
    half = boxes.shape[1] // 2
    low, high = boxes[:, :2], boxes[:, half : half + 2]
    result: NDArray[np.bool_] = np.ones((len(rectangles), len(boxes)), dtype=np.bool_)
    for k in (0, 1):
        result &= rectangles[:, None, k] <= high[None, :, k]
        result &= rectangles[:, None, 2 + k] >= low[None, :, k]
    return result
