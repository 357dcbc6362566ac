"""Specks: small clusters of a cover that no curve enters after all.

Guarantee: a cluster is taken away only if no box that may hold a part of a curve meets it; what is
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
from dataclasses import replace
from fractions import Fraction
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.branchandprune import Boxes, search_curve
from ptmcad.certified.covering import Lattice, meeting, outward
from ptmcad.certified.refinement import CurveEnclosure
from ptmcad.cover.complement import Components
from ptmcad.cover.connectivity import components
from ptmcad.cover.subdivision import COVERED, FREE, rectangle_array

MAX_SHARE = Fraction(1, 10_000)
"""Of the window: larger clusters are no specks."""
ROUNDS, FINER = 3, 4.0**-2
"""The number of rounds, and by what the area of boxes' projections is multiplied in each."""
MAX_GROWTH = 2
"""A cluster of which there are more than so many times the boxes after a round is no speck: along a
curve, there are four times as many."""
BUDGET = 20_000
"""Boxes that are treated for each curve in a round: about a tenth of a second."""
MAX_PAIRS = 3 * 10**7
"""Rectangles of specks times boxes: beyond, to look for them would take seconds."""


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
            left = search_curve(
                curve.system.arguments(), near, finer, BUDGET, curve.importance()
            ).left()
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
