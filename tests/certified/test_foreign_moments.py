"""Moments that depend on another unknown, with springs of free lengths: no potential, but total
counts with proof.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import yaml
from support.replacing import replace

import ptmcad
from ptmcad import counts_at
from ptmcad.ask.solving import poses_at
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Count

pytest.importorskip("numba")

TWO_BARS: dict[str, Any] = yaml.safe_load("""
mechanism:
  name: follower
  parameters: {a: {kind: base}, l0: {kind: free length}, l1: {kind: free length}, F: {}}
  unknowns: {th: angle, ph: angle}
  points: {A: [a, 3/10], B: [cos(th), sin(th)], C: [cos(th) + cos(ph), sin(th) + sin(ph)]}
  springs: [{between: [A, C], k: 2, free: l0}, {between: [A, B], k: 1, free: l1}]
  torsion: [{angle: th, k: 1/3}]
  moments: {th: F*sin(th - ph) + 1/5, ph: F*cos(th)/2}
axes: {a: [0, 3], F: [-3, 3]}
count: total
""")
POINTS = [("3/2", "5/2"), ("1/2", "-2"), ("197/100", "3/50"), ("1/4", "1/10")]


def sliced(l0: str, l1: str) -> ptmcad.Slice:
    return ptmcad.slice_from_mapping({**TWO_BARS, "parameters": {"l0": l0, "l1": l1}})


@pytest.mark.parametrize("at", POINTS)
def test_without_free_lengths_counts_are_those_of_the_exact_engine(at: tuple[str, str]) -> None:
    from ptmcad.certified.plain.pointcounts import plain_counter

    slice = sliced("0", "0")
    a, force = map(Fraction, at)
    exact = counts_at(slice.model, a=a, F=force)
    assert plain_counter(slice).at(a, force, Count.TOTAL).total == exact.total
    assert exact.stable is None


@pytest.mark.parametrize(("at", "number"), list(zip(POINTS, (4, 4, 7, 7), strict=True)))
@pytest.mark.fast_cases("at2-7")
def test_no_pose_is_missing_and_none_has_an_energy(at: tuple[str, str], number: int) -> None:
    """REFERENCE for the numbers: Newton's method from 196 starts."""
    a, force = map(Fraction, at)
    found = poses_at(
        sliced("1/2", "1/3").model,
        {"a": a, "F": force, "l0": Fraction(1, 2), "l1": Fraction(1, 3)},
        12,
    )
    assert len(found.equilibria) == number
    assert all((p.energy, p.stable, p.index, p.eigenvalues, p.admissible) == (None, None, None, (), None)
               for p in found.equilibria)  # fmt: skip


def test_a_map_states_the_moments_and_is_verified() -> None:
    slice = ptmcad.slice_from_mapping({
        **TWO_BARS, "parameters": {"l0": "1/2", "l1": 0}, "axes": {"a": ["5/2", 4], "F": ["-1/2", "1/2"]},
    })  # fmt: skip
    found = ptmcad.classify(slice, tolerance="1/3")
    assert found.system.moments == ("F*sin(th - ph) + 1/5", "F*cos(th)/2")
    again = ptmcad.RegionMap.from_json(found.to_json())
    assert ptmcad.verify(again, boxes=4).ok
    for moments in (("F*sin(th - ph)", "F*cos(th)/2"), ("0", "0"), ()):
        false = replace(again, system=replace(again.system, moments=moments))
        assert (ptmcad.verify(false, boxes=0).violation or "").startswith("equations: ")


def test_stable_counts_are_refused_by_name() -> None:
    with pytest.raises(
        ConfigError, match="a moment that depends on another unknown has no potential"
    ):
        ptmcad.slice_from_mapping({**TWO_BARS, "count": "stable"})
