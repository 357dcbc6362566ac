"""What edges connect, as arrays, against cells merged one link after the other."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ptmcad.cover.subdivision import connected
from ptmcad.exact.cad.decomposition import region_numbers


@given(
    st.integers(1, 30).flatmap(
        lambda n: st.tuples(st.just(n), st.lists(st.tuples(*[st.integers(0, n - 1)] * 2)))
    )
)
def test_arrays_and_links_connect_alike(graph: tuple[int, list[tuple[int, int]]]) -> None:
    number, edges = graph
    first, second = np.array(edges, dtype=np.int64).reshape(-1, 2).T
    label = connected(number, first, second)
    regions = region_numbers([None] * number, [(a, b, None) for a, b in edges])
    assert label.tolist() == [regions.index(region) for region in regions]


def test_a_long_path_in_an_order_that_delays_labels() -> None:
    """Odd nodes only touch even ones of a far place, so that labels have to travel through all of
    them.
    """
    order = np.concatenate([np.arange(0, 20_000, 2), np.arange(19_999, 0, -2)])
    assert not connected(20_000, order[:-1], order[1:]).any()
