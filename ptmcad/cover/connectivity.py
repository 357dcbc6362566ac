"""Components and clusters of a cover, which may have slanted pieces.

Guarantee: of rectangles alone exact. With slanted pieces, two points of the open window that are
outside of the rectangles and the tubes, and not on a frame's side within a lattice step of a tube,
are in one component only if a path joins them that meets neither; and if one does that stays more
than a lattice step away from where tubes pass the sides of their frames. Areas of components are
rounded down, those of clusters up. (Lemma 30 of docs/soundness.md.)

The window is cut as if the frames were rectangles. A frame's open parts and its tubes take the
place of its leaves: each of the parts is connected, because a tube that passes a frame's long side
ascends or descends. Parts join what is beside them along the pieces of the frame's sides that no
tube has.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ptmcad.cover import tubeframes as tubes
from ptmcad.cover.complement import (
    Components,
    Frames,
    as_rectangles,
    bounding_boxes,
    grown,
    sums_of_areas,
)
from ptmcad.cover.rectangles import Cover, Patch, Rectangle
from ptmcad.cover.subdivision import (
    COVERED,
    CUT,
    FREE,
    Subdivision,
    connected,
    rectangle_array,
    subdivide,
    touching,
)

Integers = NDArray[np.int64]
HALVINGS = 5
"""Of a tube's interval: there are so many rectangles in its place, as a power of two."""
_DRAWN = 2**13
"""Where it is drawn there are more, until they are narrower than this part of the window, so that
long tubes look smooth in a zoomed view too."""
_MAX_HALVINGS = 10
_WIDTHS = (Fraction(1, 2), Fraction(1, 8), Fraction(1, 64), Fraction(1, 1024))
"""Of rectangles that are tried within a part of a frame, as parts of the frame's length."""


@dataclass(slots=True)
class _Nodes:
    """Numbers of what is connected: leaves outside of frames first, then parts and tubes of frames.

    Attributes
    ----------
    part, tube : the first number of each frame's.
    free : of each node, whether it is open.
    """

    leaves: Integers
    frame_of: Integers
    covered: NDArray[np.bool_]
    part: list[int]
    tube: list[int]
    free: NDArray[np.bool_]


def components(cover: Cover, tree: Subdivision | None = None) -> Components:
    """The connected components of the open window without the closed rectangles and the tubes.

    Parameters
    ----------
    tree : a subdivision by the cover; without it, it is made.

    Raises
    ------
    ValueError When a rectangle or a patch is not one, a frame meets the inside of another one or of
        a rectangle, or the lattice is too fine.
    """
    for patch in cover.patches:
        wrong = tubes.flaw(patch, cover.steps)
        if wrong:
            raise ValueError(f"a patch of the cover is none: {wrong}")
    whole = Cover(cover.steps, (*cover.rectangles, *(patch.frame for patch in cover.patches)))
    array = rectangle_array(whole)
    tree = tree or subdivide(array, cover.steps)
    parts = np.flatnonzero(tree.state != CUT)
    frames = array[len(cover.rectangles) :]
    frame_of = _frames_of(tree, frames, array)[parts]
    nodes = _nodes(tree, parts, frame_of, cover.patches)
    pairs = touching(tree.bounds[parts])
    first, second = _edges(nodes, pairs.first, pairs.second, pairs.along, cover.patches)
    free = nodes.free
    joined = free[first] == free[second]
    label = connected(len(free), first[joined], second[joined])
    return _assembled(cover, tree, parts, nodes, label, (first[~joined], second[~joined]))


def _frames_of(tree: Subdivision, frames: Integers, rectangles: Integers) -> Integers:
    """For each part of the subdivision the frame that it is in, or -1.

    Raises
    ------
    ValueError
        When the interiors of a frame and of another rectangle meet.
    """
    box, leaf = tree.meeting(frames, closed=False)
    result = tree.labels(leaf, box)
    _, leaf_of_others = tree.meeting(rectangles[: len(rectangles) - len(frames)], closed=False)
    if len(np.unique(leaf)) < len(leaf) or (result[leaf_of_others] >= 0).any():
        raise ValueError("the frame of a slanted piece meets another one, or a rectangle")
    return result


def _nodes(
    tree: Subdivision, parts: Integers, frame_of: Integers, patches: tuple[Patch, ...]
) -> _Nodes:
    number = len(parts)
    free = [tree.state[parts] == FREE]
    part, tube = [], []
    for patch in patches:
        part.append(number)
        tube.append(number + len(patch.tubes) + 1)
        number += 2 * len(patch.tubes) + 1
        free += [
            np.ones(len(patch.tubes) + 1, dtype=np.bool_),
            np.zeros(len(patch.tubes), dtype=np.bool_),
        ]
    return _Nodes(
        tree.bounds[parts],
        frame_of,
        tree.state[parts] == COVERED,
        part,
        tube,
        np.concatenate(free).astype(np.bool_),
    )


def _edges(
    nodes: _Nodes,
    first: Integers,
    second: Integers,
    along: NDArray[np.bool_],
    patches: tuple[Patch, ...],
) -> tuple[Integers, Integers]:
    """Pairs of nodes that touch: open ones along an edge, others in a point at least."""
    a_frame, b_frame = nodes.frame_of[first], nodes.frame_of[second]
    plain = (a_frame < 0) & (b_frame < 0)
    open_corner = nodes.free[first] & nodes.free[second] & ~along
    ones, twos = [first[plain & ~open_corner]], [second[plain & ~open_corner]]
    sides = {}
    found: list[tuple[int, int]] = []
    for k in np.flatnonzero(~plain & ((a_frame != b_frame) | (a_frame < 0))).tolist():
        a, b = int(first[k]), int(second[k])
        for axis, low, high, lower, upper in _edges_between(nodes.leaves[a], nodes.leaves[b]):
            pieces = []
            for leaf, end in ((lower, 1), (upper, 0)):
                node = a if leaf == 0 else b
                frame = int(nodes.frame_of[node])
                if frame < 0:
                    pieces.append([(low, high, node)])
                    continue
                if patches[frame].frame[2 * axis + end] != nodes.leaves[node][2 * axis + end]:
                    pieces.append([])  # a corner on another side of the frame
                    continue
                if (frame, axis, end) not in sides:
                    sides[frame, axis, end] = tubes.side(patches[frame], axis, end)
                pieces.append(
                    [
                        (p.low, p.high, (nodes.tube if p.tube else nodes.part)[frame] + p.number)
                        for p in sides[frame, axis, end]
                    ]
                )
            found.extend(_meeting(pieces[0], pieces[1], low, high, nodes.free))
    for f, patch in enumerate(patches):
        for number in range(len(patch.tubes)):
            tube = nodes.tube[f] + number
            found += [(nodes.part[f] + number, tube), (nodes.part[f] + number + 1, tube)]
    extra = np.array(found, dtype=np.int64).reshape(-1, 2)
    return np.concatenate([*ones, extra[:, 0]]), np.concatenate([*twos, extra[:, 1]])


def _edges_between(a: Integers, b: Integers) -> Iterator[tuple[int, int, int, int, int]]:
    """The axis across each common edge of two leaves, its ends, and which of the leaves is below it
    and above.

    A corner that is all that they share counts as an edge across both axes, since what a tube has
    of it is rounded.
    """
    for axis in (0, 1):
        low = max(int(a[2 - 2 * axis]), int(b[2 - 2 * axis]))
        high = min(int(a[3 - 2 * axis]), int(b[3 - 2 * axis]))
        if a[2 * axis + 1] == b[2 * axis]:
            yield axis, low, high, 0, 1
        elif b[2 * axis + 1] == a[2 * axis]:
            yield axis, low, high, 1, 0


Part = tuple[int, int, int]


def _meeting(
    below: list[Part], above: list[Part], low: int, high: int, free: NDArray[np.bool_]
) -> Iterator[tuple[int, int]]:
    """Pairs of nodes of two lists of pieces that touch between two ends; open ones where intervals
    overlap.
    """
    for a, b, one in below:
        for c, d, two in above:
            start, end = max(a, c, low), min(b, d, high)
            if start < end or (start == end and not (free[one] and free[two])):
                yield one, two


def _assembled(
    cover: Cover,
    tree: Subdivision,
    parts: Integers,
    nodes: _Nodes,
    label: Integers,
    border: tuple[Integers, Integers],
) -> Components:
    """Number what is connected: components by descending area, clusters as well."""
    free, patches = nodes.free, cover.patches
    count = len(parts)
    outside = nodes.frame_of < 0
    is_root = label == np.arange(len(label))  # a label is the smallest node of what is connected
    roots, inverse = np.flatnonzero(is_root), (np.cumsum(is_root) - 1)[label]
    leaves, group = nodes.leaves[outside], inverse[:count][outside]
    sums, present = _areas(nodes, patches, inverse, leaves, group, len(roots))
    kind = np.zeros(len(roots), dtype=np.bool_)
    kind[inverse] = free
    # the first from the left and below is the last one that is written; what is in frames alone
    # comes after all others
    first = np.tile([cover.steps, cover.steps], (len(roots), 1))
    corner = np.lexsort((leaves[:, 2], leaves[:, 0]))[::-1]
    first[group[corner]] = leaves[corner][:, (0, 2)]
    places = first.tolist()
    shown = {
        kept: sorted(
            np.flatnonzero((kind == kept) & present).tolist(), key=lambda k: (-sums[k], places[k])
        )
        for kept in (True, False)
    }
    rank = np.full(len(roots), -1, dtype=np.int64)
    for order in shown.values():
        rank[order] = np.arange(len(order))
    own = rank[inverse]
    swapped = ~free[border[0]]
    inner, outer = (own[np.where(swapped, border[1 - k], border[k])] for k in (0, 1))
    at: list[list[int]] = [[] for _ in shown[True]]
    for pair in np.unique((inner * len(roots) + outer)[inner >= 0]).tolist():
        n, cluster = divmod(pair, len(roots))
        at[n].append(cluster)
    owner = tree.labels(parts[outside], own[:count][outside])
    array = rectangle_array(cover)
    cluster_of = (
        owner[tree.leaves_right_above(array[:, 0], array[:, 2])] if len(array) else array[:, 0]
    )
    owners = tuple(
        tuple(own[nodes.part[f] : nodes.part[f] + len(patch.tubes) + 1].tolist())
        for f, patch in enumerate(patches)
    )
    return Components(
        cover,
        tuple(sums[k] for k in shown[True]),
        _rectangles(tree, nodes, own, len(shown[True]), patches, owners),
        tuple(sums[k] for k in shown[False]),
        tuple(cluster_of.tolist()),
        tuple(map(tuple, at)),
        tree,
        owner,
        Frames(tree.labels(parts, nodes.frame_of), owners) if patches else None,
    )


def _areas(
    nodes: _Nodes,
    patches: tuple[Patch, ...],
    inverse: Integers,
    leaves: Integers,
    group: Integers,
    groups: int,
) -> tuple[list[int], NDArray[np.bool_]]:
    """The area of each group, and whether there is anything of it in the window."""
    sums = sums_of_areas(leaves, group, groups)
    present = np.zeros(groups, dtype=np.bool_)
    present[group] = True
    for f, patch in enumerate(patches):
        left, right, bottom, top = patch.frame
        areas = tubes.part_areas(patch)
        for k, area in enumerate(areas, nodes.part[f]):
            sums[inverse[k]] += area
            present[inverse[k]] |= area > 0
        rest = (right - left) * (top - bottom) - sum(areas)
        clusters = {int(inverse[nodes.tube[f] + k]) for k in range(len(patch.tubes))}
        for cluster in clusters:  # each may have all of what is not in the parts
            sums[cluster] += rest
            present[cluster] = True
    return sums, present


def _rectangles(
    tree: Subdivision,
    nodes: _Nodes,
    own: Integers,
    number: int,
    patches: tuple[Patch, ...],
    owners: tuple[tuple[int, ...], ...],
) -> tuple[Rectangle, ...]:
    """For each component an open rectangle inside of it, without area where none was found."""
    count = len(nodes.leaves)
    open_leaf = nodes.free[:count] & (nodes.frame_of < 0)
    leaves, component = nodes.leaves[open_leaf], own[:count][open_leaf]
    best = np.zeros((number, 4), dtype=np.int64)
    size = np.minimum(leaves[:, 1] - leaves[:, 0], leaves[:, 3] - leaves[:, 2])
    order = np.lexsort((-leaves[:, 2], -leaves[:, 0], size))
    best[component[order]] = leaves[order]
    has = np.zeros(number, dtype=np.bool_)
    has[component] = True
    result = best.copy()
    if has.any():
        around = bounding_boxes(leaves, np.cumsum(has)[component] - 1, int(has.sum()))
        result[has] = grown(tree, best[has], around)
    rectangles = list(as_rectangles(result))
    for f, patch in enumerate(patches):
        for k, component_of in enumerate(owners[f]):
            if component_of >= 0 and not has[component_of]:
                found = _within(patch, k)
                if _size(found) > _size(rectangles[component_of]):
                    rectangles[component_of] = found
    return tuple(rectangles)


def _size(rectangle: Rectangle) -> int:
    left, right, bottom, top = rectangle
    return min(right - left, top - bottom)


def _within(patch: Patch, number: int) -> Rectangle:
    """A rectangle inside of a part of a frame."""
    low, high = patch.ends
    best: Rectangle = (0, 0, 0, 0)
    for width in _WIDTHS:
        start, end = (1 - width) / 2, (1 + width) / 2
        bottom, top = (Fraction(y) for y in patch.heights)
        if number > 0:
            tube = patch.tubes[number - 1]
            bottom = max(bottom, tubes.bounds_between(tube.controls, start, end)[1] + tube.half)
        if number < len(patch.tubes):
            tube = patch.tubes[number]
            top = min(top, tubes.bounds_between(tube.controls, start, end)[0] - tube.half)
        across = (bottom.__ceil__(), top.__floor__())
        between = ((low + start * (high - low)).__ceil__(), (low + end * (high - low)).__floor__())
        if across[0] < across[1] and between[0] < between[1]:
            found = (*between, *across) if patch.along == 0 else (*across, *between)
            if _size(found) > _size(best):
                best = found
    return best


def staircase(patch: Patch, halvings: int) -> Iterator[Rectangle]:
    """Rectangles that cover a frame's tubes: 2^halvings for each."""
    low, high = patch.ends
    bottom, top = patch.heights
    columns = 2**halvings
    for tube in patch.tubes:
        for k, (least, most) in enumerate(tubes.bounds_by_halving(tube.controls, halvings)):
            start, end = low + (high - low) * k // columns, low - (low - high) * (k + 1) // columns
            end = min(high, end + 1)
            first, last = max(bottom, least - tube.half), min(top, most + tube.half)
            if first < last:
                yield (start, end, first, last) if patch.along == 0 else (first, last, start, end)


def stepped(cover: Cover, narrower: int = 1) -> Cover:
    """A cover of more, of rectangles alone: a staircase in place of each tube.

    Parameters
    ----------
    narrower : there are more until the steps are narrower than this part of the window, up to a
        limit.
    """

    def enough(patch: Patch) -> int:
        low, high = patch.ends
        wanted = -(-(high - low) * narrower // cover.steps)
        return max(HALVINGS, min(_MAX_HALVINGS, (wanted - 1).bit_length()))

    steps = (piece for patch in cover.patches for piece in staircase(patch, enough(patch)))
    return Cover(cover.steps, tuple(sorted({*cover.rectangles, *steps})))


def shown(complement: Components, narrower: int = _DRAWN) -> Components:
    """The same components with a subdivision in which rectangles cover the tubes, to draw them by.

    What these rectangles have of a component is in none of its leaves; a leaf's owner is still its
    component.

    Parameters
    ----------
    narrower : rectangles are narrower than this part of the window.
    """
    if complement.frames is None:
        return complement
    cover = complement.cover
    tree = subdivide(rectangle_array(stepped(cover, narrower=narrower)), cover.steps)
    free = np.flatnonzero(tree.state == FREE)
    bounds = tree.bounds[free]
    there = complement.subdivision.leaves_right_above(bounds[:, 0], bounds[:, 2])
    found = complement.owner[there]
    frame_of = complement.frames.frame_of[there]
    for k in np.flatnonzero(frame_of >= 0).tolist():
        patch = cover.patches[int(frame_of[k])]
        inside = [
            Fraction(max(int(bounds[k, 2 * a]), patch.frame[2 * a]) + min(int(bounds[k, 2 * a + 1]),
                     patch.frame[2 * a + 1]), 2)
            for a in (0, 1)
        ]  # fmt: skip
        number = tubes.place(patch, inside[patch.along], inside[1 - patch.along])
        found[k] = -1 if number is None else complement.frames.owners[int(frame_of[k])][number]
    return replace(complement, subdivision=tree, owner=tree.labels(free, found))
