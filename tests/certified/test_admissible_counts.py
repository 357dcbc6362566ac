"""Stable equilibria at which every spring is longer than its free length, of any mechanism with
such springs.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from support.few import few
from support.left_out import without_curves
from support.loop_search import taut_along
from support.places import random_points
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.errors import ConfigError, DegenerateSliceError
from ptmcad.question.slice import Slice
from ptmcad.verification import verify

pytest.importorskip("numba")

CHAIN: dict[str, Any] = yaml.safe_load("""
name: chain
mechanism:
  name: sprung_chain
  parameters: {F: {kind: force}, l0: {kind: free length}}
  unknowns: {th1: angle, th2: angle}
  points:
    O: [0, 0]
    A: [0, 2]
    B: [3/2, -1/2]
    P: [cos(th1), sin(th1)]
    Q: [cos(th1) + cos(th2), sin(th1) + sin(th2)]
  bars: [[O, P], [P, Q]]
  springs: [{between: [A, P], k: 1, free: l0}, {between: [B, Q], k: 2, free: l0}]
  loads: {Q: [F, 0]}
axes: {F: [-2, 0], l0: [1/4, 2]}
count: admissible
""")
ROOF: dict[str, Any] = yaml.safe_load("""
name: roof
mechanism:
  name: sprung_slider
  parameters: {f: {kind: force}, a: {kind: length}, l0: {kind: free length, default: 1}}
  unknowns: {h: length}
  points: {A: [-a, 0], S: [0, h]}
  springs: [{between: [A, S], k: 1, free: l0}]
  loads: {S: [0, f]}
axes: {a: [1/10, 19/10], f: [1/100, 1]}
count: admissible
""")
FOUR_BAR: dict[str, Any] = {
    key: value
    for key, value in yaml.safe_load(
        (Path(__file__).parents[2] / "configs" / "mechanisms" / "four-bar-free.yaml").read_text(
            encoding="utf-8"
        )
    ).items()
    if key != "reference"
} | {"parameters": {"G": 1}, "axes": {"F": [0, 4], "l0": ["1/2", 2]}, "count": "admissible"}
RECORDS = {"chain": CHAIN, "roof": ROOF, "four-bar": FOUR_BAR}


def slice_of(record: dict[str, Any], **changes: Any) -> Slice:
    return ptmcad.slice_from_mapping(record | changes)


@cache
def map_of(name: str, tolerance: str) -> RegionMap:
    return ptmcad.classify(slice_of(RECORDS[name]), tolerance=tolerance)


def test_the_known_answer_of_a_spring_on_a_slider() -> None:
    """(h - l0 h/l) = f > 0 has just one solution with l > l0: below, where h < 0, it is compressed."""
    m = map_of("roof", "1/200")
    assert m.undetermined < Fraction(1, 200)
    assert {cell.admissible for cell in m.cells} == {1}
    assert {cell.stable for cell in m.cells} == {1, 2}


def test_closed_loops() -> None:
    m = map_of("four-bar", "1/100")
    assert {cell.admissible for cell in m.cells} >= {0, 1, 2}
    tried = 0
    for x, y in random_points(m.slice, 80, 1):
        at = m.locate(F=x, l0=y)
        if at.cell is None:
            continue
        tried += 1
        p = {"L1": 1.0, "L2": 1.2, "L3": 1.5, "b": 2.0}
        f, free = float(x), float(y)

        def lengths(px: Any, py: Any, qx: Any, qy: Any) -> tuple[Any, Any]:
            return np.hypot(qx, qy), np.hypot(px - 2, py)

        def energy(px: Any, py: Any, qx: Any, qy: Any, f: float = f, free: float = free) -> Any:
            one, two = lengths(px, py, qx, qy)
            return (one - free) ** 2 / 2 + (two - free) ** 2 / 2 - f * py - qy

        def taut(*curve: Any, free: float = free) -> Any:
            one, two = lengths(*curve)
            return (one > free) & (two > free)

        assert at.admissible == taut_along(p, energy, taut), (x, y)
    assert tried > 70


@pytest.mark.parametrize("name", ["four-bar", "chain"])
@pytest.mark.slow_cases("chain")
def test_poses_say_the_same(name: str) -> None:
    m = map_of(name, "1/100")
    for cell in sorted(m.cells, key=lambda c: c.level)[:4]:
        at = dict(zip(m.slice.axis_names, cell.sample, strict=True))
        values = {key: value.evaluate(*cell.sample) for key, value in m.slice.parameters.items()}
        poses = ptmcad.solve(model=m.slice.model, **values, digits=4)
        assert poses.status is Status.CERTIFIED, at
        assert sum(pose.admissible is True for pose in poses.equilibria) == cell.admissible, at


@pytest.mark.parametrize("name", few(["roof", "four-bar", "chain"], "roof"))
def test_the_checker_agrees(name: str) -> None:
    m = map_of(name, "1/100" if name != "roof" else "1/200")
    assert m.status is Status.CERTIFIED
    report = verify(m, seed=1)
    assert report.ok
    assert any(c.name == "counts and solutions" and c.passed for c in report.checks)


@pytest.mark.parametrize("name", ["roof", "four-bar"])
def test_a_count_that_is_wrong_by_one_is_refused(name: str) -> None:
    m = map_of(name, "1/100" if name != "roof" else "1/200")
    for by in (1, -1):
        cell, region = m.cells[0], m.regions[m.cells[0].region]
        assert cell.admissible is not None
        further = {"admissible": cell.admissible + by}
        changed = replace(
            m,
            cells=(replace(cell, further=further), *m.cells[1:]),
            regions=tuple(replace(r, further=further) if r is region else r for r in m.regions),
        )
        assert not verify(changed, seed=1).ok


@pytest.mark.parametrize(("name", "tolerance"), [("chain", "1/20"), ("four-bar", "1/20")])
@pytest.mark.slow_cases("chain-1/20")
@pytest.mark.slow
def test_without_boundaries_at_free_lengths_counts_are_wrong(
    name: str, tolerance: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = map_of(name, "1/100")
    without_curves(monkeypatch, "has its free length")
    wrong = ptmcad.classify(slice_of(RECORDS[name]), tolerance=tolerance)
    one, two = right.slice.axis_names
    assert any(
        other.locate(**{one: cell.sample[0], two: cell.sample[1]}).admissible
        not in (None, cell.admissible)
        for some, other in ((right, wrong), (wrong, right))
        for cell in some.cells
    )


def test_what_cannot_be_counted_is_refused_by_name() -> None:
    with pytest.raises(
        DegenerateSliceError, match=r"the length of spring .* less its free length is zero"
    ):
        plain_counter(
            slice_of(ROOF, parameters={"f": 0}, axes={"a": ["1/10", "9/10"], "l0": [1, 2]})
        )
    free = [{"between": ["A", "P"], "k": "k"}, {"between": ["B", "Q"], "k": 2}]
    with pytest.raises(ConfigError, match=r"none has a free length here: choose stable"):
        slice_of(
            CHAIN,
            mechanism=CHAIN["mechanism"]
            | {"springs": free, "parameters": {"F": {"kind": "force"}, "k": {"kind": "stiffness"}}},
            axes={"F": [-2, 0], "k": [1, 2]},
        )
