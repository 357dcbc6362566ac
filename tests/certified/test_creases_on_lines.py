"""Lines through values at which springs lose their lengths, two at once or in a pose that is its
own image.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from support.dense_search import dense_search

pytest.importorskip("numba")

from ptmcad.answer.intervals import CountIntervals
from ptmcad.ask.lines.along import certified_intervals
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.question.config import slice_from_mapping, slice_from_options
from ptmcad.question.slice import Count

SHIPPED = Path(__file__).resolve().parents[2] / "configs"
CREASES = tuple(f"crease where spring {name} has no length" for name in ("A1A4", "A2A3"))
CONE = "point where spring A3A4 has no length"
EQUAL_BARS = {"L1": 1.0, "L2": 1.0, "F3": -0.1, "F4": -0.1, "F3x": 0.0, "F4x": 0.0}
EQUAL_BARS |= {f"{name}{i}": value for i in (1, 2, 3) for name, value in (("k", 1.0), ("l0_", 0.2))}
"""Over k."""
BAND: dict[str, Any] = yaml.safe_load("""
name: band
mechanism:
  parameters: {h: {kind: number}, F: {kind: force}, l: {kind: free length, default: 1/2}}
  unknowns: {u: length, t: angle}
  points: {O: [0, 0], M: [0, h], S: [u, 0], P: [u + cos(t), sin(t)], E: [3, 1]}
  bars: [[S, P]]
  supports: {M: pin, E: pin}
  springs: [{between: [M, S], k: 1, free: l}, {between: [P, E], k: 1}]
  loads: {S: [F, 0]}
axes: {h: [-1, 1], F: [-4, 1]}
count: index
""")
"""A slider on a spring to a point beside its guide, with a bar that a second spring pulls."""


def along(record: str, axis: str, at: dict[str, str], window: str) -> CountIntervals:
    slice = slice_from_options(SHIPPED / f"{record}.yaml", ranges=[f"{axis}={window}"])
    return certified_intervals(slice, axis, at, 10)


@pytest.mark.parametrize(
    ("record", "at"),
    [
        pytest.param(
            "free-load",
            {"F": "-10"},
            id="free-load at F = -10: ptmcad 7ed04eb8, and a dense search",
        ),
        pytest.param(
            "free02", {"L2": "1"}, id="free02 at L2 = 1: ptmcad 7ed04eb8, and a dense search"
        ),
    ],
)
def test_both_springs_of_equal_bars_lose_their_lengths_at_once(
    record: str, at: dict[str, str]
) -> None:
    found = along(record, "rho", at, "24/25:26/25")
    assert [(c.at.low, c.at.high, c.names, c.proved) for c in found.changes] == [
        (1, 1, CREASES, True)
    ]
    assert [interval.index for interval in found.intervals] == [(2, 6, 4)] * 2
    for interval in found.intervals:
        assert dense_search(EQUAL_BARS | {"rho": float(interval.sample)})["index"] == interval.index


@pytest.mark.parametrize(
    ("axis", "at", "window", "place"),
    [
        pytest.param(
            "rho",
            {"L2": "1/2"},
            "12/25:13/25",
            "1/2",
            id="rho = L2: ptmcad 7ed04eb8, and a dense search",
        ),
        pytest.param(
            "L2",
            {"rho": "1/2"},
            "7/5:8/5",
            "3/2",
            id="L2 = L1 + rho: ptmcad 7ed04eb8, and a dense search",
        ),
    ],
)
def test_springs_of_flat_poses_lose_their_lengths(
    axis: str, at: dict[str, str], window: str, place: str
) -> None:
    """Flat poses are their own images, and equilibria without a load, also where no direction of a
    spring is known.
    """
    found = along("free02-unloaded", axis, at, window)
    (change,) = found.changes
    assert (
        change.proved
        and change.at.low <= Fraction(place) <= change.at.high
        and change.at.settles(10)
    )
    assert set(change.names) == {CONE, *CREASES[: axis == "rho"]}
    unloaded = (
        EQUAL_BARS
        | {"F3": 0.0, "F4": 0.0}
        | {name: float(Fraction(value)) for name, value in at.items()}
    )
    for interval in found.intervals:
        assert dense_search(unloaded | {axis: float(interval.sample)})["index"] == interval.index


def test_folds_beside_creases_are_called_folds() -> None:
    """The springs are short there, and no chart of theirs says so."""
    found = along("free-load", "rho", {"F": "-10"}, "47/50:21/20")
    assert [change.names for change in found.changes] == [("fold",), CREASES, ("fold",)]


def test_a_crease_of_a_slider_keeps_its_unknown() -> None:
    """Where the guide runs through the fixed end of its spring, between folds; with totals by signs
    on a fine grid.
    """
    slice = slice_from_mapping(BAND)
    (crease,) = (curve for curve in curves(slice, Count.INDEX) if "has no length" in curve.name)
    assert len(crease.ranges) == 1
    found = certified_intervals(slice, "h", {"F": "-2"}, 10)
    assert [change.names for change in found.changes] == [("fold",), (crease.name,), ("fold",)]
    assert all(change.proved for change in found.changes) and found.changes[1].at.low == 0
    u = np.linspace(-10, 10, 400_001) + 1e-6
    for interval in found.intervals:
        rest = u * (1 - 0.5 / np.hypot(u, float(interval.sample))) + u - 3 + 2
        pulled = (3 - u) / np.hypot(3 - u, 1)  # the bar points to E, or away from it
        assert interval.total == sum(
            (np.diff(np.sign(rest + side * pulled)) != 0).sum() for side in (1, -1)
        )
