"""The compiled subdivision against numpy's: the same parts and pairs, so the same components."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

pytest.importorskip("numba")

from ptmcad.certified.tiling import COMPILED
from ptmcad.cover import components, union_area
from ptmcad.cover.complement import PLAIN, Tiling
from ptmcad.cover.graph import Touching
from ptmcad.cover.rectangles import MAX_STEPS, Cover
from ptmcad.cover.subdivision import CUT, Subdivision, rectangle_array


@st.composite
def covers(draw: st.DrawFn) -> Cover:
    steps = 2 ** draw(st.sampled_from((0, 1, 3, 5, 24, 40)))
    ends = st.integers(0, steps) | st.sampled_from((0, 1, steps // 2, steps - 1, steps))
    found = set()
    for _ in range(draw(st.integers(0, 20))):
        left, right, bottom, top = (draw(ends) for _ in range(4))
        if left != right and bottom != top:
            found.add((min(left, right), max(left, right), min(bottom, top), max(bottom, top)))
    return Cover(steps, tuple(sorted(found)))


def parts(tree: Subdivision) -> list[tuple[int, ...]]:
    cut = np.where(tree.state == CUT, tree.cut, 0)
    axis = np.where(tree.state == CUT, tree.axis, 0)
    return sorted(map(tuple, np.column_stack([tree.bounds, tree.state, axis, cut]).tolist()))


def pairs(found: Touching) -> list[tuple[int, int, bool]]:
    ends = np.sort(np.column_stack([found.first, found.second]), axis=1)
    return sorted((int(a), int(b), bool(c)) for (a, b), c in zip(ends, found.along, strict=True))


@settings(deadline=None, max_examples=examples(150))
@given(covers())
def test_compiled_and_plain_tilings_agree(cover: Cover) -> None:
    rectangles = rectangle_array(cover)
    one, two = (tiling.subdivide(rectangles, cover.steps) for tiling in (PLAIN, COMPILED))
    assert parts(one) == parts(two)
    leaves = np.flatnonzero(two.state != CUT)
    plain, compiled = (tiling.touching(two, leaves) for tiling in (PLAIN, COMPILED))
    assert pairs(plain) == pairs(compiled)


@settings(deadline=None, max_examples=examples(100))
@given(covers())
def test_components_do_not_depend_on_the_tiling(cover: Cover) -> None:
    def told(tiling: Tiling) -> object:
        found = components(cover, tiling)
        return (
            found.areas,
            found.rectangles,
            found.cluster_areas,
            found.cluster_of,
            found.clusters_at,
            union_area(cover, tiling),
        )

    assert told(PLAIN) == told(COMPILED)


def test_many_rectangles_need_longer_arrays() -> None:
    """A diagonal of 5000 squares on the finest lattice: deep, and more parts than the arrays begin with."""
    side = MAX_STEPS // 8192
    cover = Cover(MAX_STEPS, tuple((k * side, (k + 1) * side, k * side, (k + 1) * side) for k in range(5000)))
    found = components(cover, COMPILED)
    assert found.areas == components(cover, PLAIN).areas
    assert found.cluster_areas == (5000 * side**2,)
