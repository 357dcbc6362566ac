"""Refinement of enclosures: what it does when there is nothing to enclose."""

from __future__ import annotations

import pytest

pytest.importorskip("numba")

import ptmcad


def test_a_window_that_no_curve_enters_is_one_region() -> None:
    """A quiet place of free02: every box is discarded, and nothing is undetermined."""
    slice = ptmcad.slice_from_options(
        slice="rho,L2",
        ranges=["rho=3/2:8/5", "L2=6/5:13/10"],
        sets=["l0=1/5", "F3=-10", "F4=-10"],
    )
    result = ptmcad.classify(slice, jobs=1)
    assert [region.stable for region in result.regions] == [1]
    assert result.undetermined == 0
    assert result.cover is not None and result.cover.rectangles == ()
