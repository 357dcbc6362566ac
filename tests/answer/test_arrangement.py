"""Arrangements of regions are compared up to the numbers of the regions."""

from __future__ import annotations

import random
from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from ptmcad.answer.arrangement import Arrangement, correspondence

NO_SIDES: tuple[tuple[int, ...], ...] = ((), (), (), ())


def renumbered(a: Arrangement, order: list[int]) -> Arrangement:
    """Region n becomes region order[n]."""
    keys = [a.keys[order.index(n)] for n in range(len(order))]
    pairs = {(min(order[i], order[j]), max(order[i], order[j])) for i, j in a.neighbours}
    return Arrangement(
        tuple(keys), frozenset(pairs), tuple(tuple(order[n] for n in side) for side in a.sides)
    )


def islands(number: int, lakes: int) -> Arrangement:
    """A sea with islands, on some of which there is a lake."""
    keys = [(0,), *[(2,)] * number, *[(4,)] * lakes]
    pairs = {(0, n) for n in range(1, number + 1)} | {(n, number + n) for n in range(1, lakes + 1)}
    return Arrangement(tuple(keys), frozenset(pairs), ((0,),) * 4)


@st.composite
def arrangements(draw: st.DrawFn) -> Arrangement:
    size = draw(st.integers(1, 7))
    keys = tuple((draw(st.integers(0, 1)),) for _ in range(size))
    pairs = frozenset(pair for pair in combinations(range(size), 2) if draw(st.booleans()))
    sides = tuple(tuple(draw(st.lists(st.integers(0, size - 1), max_size=2))) for _ in range(4))
    return Arrangement(keys, pairs, sides if draw(st.booleans()) else NO_SIDES)


@given(arrangements(), st.randoms(use_true_random=False))
def test_numbers_of_regions_do_not_matter(a: Arrangement, source: random.Random) -> None:
    order = list(range(len(a.keys)))
    source.shuffle(order)
    other = renumbered(a, order)
    found = correspondence(a, other)
    assert found is not None
    assert renumbered(a, list(found)) == other


@given(arrangements(), arrangements())
def test_a_correspondence_keeps_everything(a: Arrangement, b: Arrangement) -> None:
    found = correspondence(a, b)
    if found is not None:
        assert renumbered(a, list(found)) == b


def test_what_differs_has_no_correspondence() -> None:
    a = islands(3, 1)
    assert correspondence(a, islands(3, 2)) is None
    assert (
        correspondence(a, Arrangement(a.keys, a.neighbours, ((0,), (0,), (0,), (0, 1, 0)))) is None
    )
    assert (
        correspondence(a, Arrangement(((0,), (2,), (2,), (4,), (2,)), a.neighbours, a.sides))
        is None
    )
    hexagon = frozenset({(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (0, 5)})
    triangles = frozenset({(0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5)})
    rings = [Arrangement(((0,),) * 6, pairs, NO_SIDES) for pairs in (hexagon, triangles)]
    assert correspondence(*rings) is None  # colours alone do not tell them apart


def test_many_islands_alike_take_no_time() -> None:
    a = islands(40, 25)
    order = list(range(len(a.keys)))
    random.Random(1).shuffle(order)
    assert correspondence(a, renumbered(a, order)) is not None
