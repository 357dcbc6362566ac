"""What a component borders on: clusters, rectangles, and the area that a region may have at most.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ptmcad.cover.complement import Components
from ptmcad.cover.subdivision import FREE, rectangle_array


def area_bounds(components: Components, numbers: Iterable[int]) -> tuple[int, int]:
    """Area of some components together; and with all clusters that touch them, each of them once.

    In squares of a lattice step. What a continuous count does between the components is not decided here: a region that
    crosses a cluster to a component that is not among the numbers is larger.
    """
    chosen = set(numbers)
    low = sum(components.areas[n] for n in chosen)
    clusters = {cluster for n in chosen for cluster in components.clusters_at[n]}
    return low, low + sum(components.cluster_areas[c] for c in clusters)


def borders(components: Components) -> tuple[tuple[int, ...], ...]:
    """For each component the numbers of the rectangles that it touches along a segment or in a point, ascending."""
    tree = components.subdivision
    rectangle, leaf = tree.meeting(rectangle_array(components.cover), closed=True)
    free = tree.state[leaf] == FREE
    number = len(components.cover.rectangles)
    found: list[list[int]] = [[] for _ in components.areas]
    for code in np.unique(components.owner[leaf[free]] * number + rectangle[free]).tolist():
        n, k = divmod(code, number)
        found[n].append(k)
    return tuple(map(tuple, found))
