"""What a component borders on: clusters, and the area that a region may have at most.

Guarantee: exact.
"""

from __future__ import annotations

from collections.abc import Container

from ptmcad.cover.complement import Components


def area_bounds(components: Components, number: int, known: Container[int]) -> tuple[int, int]:
    """A component's area; and with all that can be reached from it without entering another known
    component.

    In squares of a lattice step. What is reached are clusters, each of them once, and components
    that are not known. The connected set of points with the component's count is no larger, unless
    it reaches another known component.
    """
    around: dict[int, list[int]] = {}
    for component, cluster in components.touching:
        around.setdefault(cluster, []).append(component)
    reached, clusters, waiting = {number}, set[int](), [number]
    while waiting:
        for cluster in components.clusters_at[waiting.pop()]:
            if cluster not in clusters:
                clusters.add(cluster)
                more = {m for m in around[cluster] if m not in known} - reached
                reached |= more
                waiting += more
    high = sum(components.areas[m] for m in reached) + sum(
        components.cluster_areas[cluster] for cluster in clusters
    )
    return components.areas[number], high
