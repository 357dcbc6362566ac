"""Stable equilibria at which every spring is longer than its free length, of any mechanism with
such springs.
"""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from support.dense_search import dense_search
from support.few import few
from support.loop_search import taut_along
from support.minima_search import minima

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.certified import engine
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.errors import ConfigError, DegenerateSliceError
from ptmcad.model.builtin import RECORD
from ptmcad.question.slice import Count, Slice
from ptmcad.verification import verify

pytest.importorskip("numba")

CHAIN: dict[str, Any] = {
    "name": "chain",
    "mechanism": {
        "name": "sprung_chain",
        "parameters": {"F": {"kind": "force"}, "l0": {"kind": "free length"}},
        "unknowns": {"th1": "angle", "th2": "angle"},
        "points": {
            "O": [0, 0],
            "A": [0, 2],
            "B": ["3/2", "-1/2"],
            "P": ["cos(th1)", "sin(th1)"],
            "Q": ["cos(th1) + cos(th2)", "sin(th1) + sin(th2)"],
        },
        "bars": [["O", "P"], ["P", "Q"]],
        "springs": [
            {"between": ["A", "P"], "k": 1, "free": "l0"},
            {"between": ["B", "Q"], "k": 2, "free": "l0"},
        ],
        "loads": {"Q": ["F", 0]},
    },
    "axes": {"F": [-2, 0], "l0": ["1/4", 2]},
    "count": "admissible",
}
WITHOUT: dict[str, Any] = CHAIN | {
    "mechanism": CHAIN["mechanism"]
    | {"springs": [{"between": ["A", "P"], "k": 1, "free": "l0"}, {"between": ["B", "Q"], "k": 2}]}
}
"""The second spring has no free length."""
ROOF: dict[str, Any] = {
    "name": "roof",
    "mechanism": {
        "name": "sprung_slider",
        "parameters": {
            "f": {"kind": "force"},
            "a": {"kind": "length"},
            "l0": {"kind": "free length", "default": 1},
        },
        "unknowns": {"h": "length"},
        "points": {"A": ["-a", 0], "S": [0, "h"]},
        "springs": [{"between": ["A", "S"], "k": 1, "free": "l0"}],
        "loads": {"S": [0, "f"]},
    },
    "axes": {"a": ["1/10", "19/10"], "f": ["1/100", 1]},
    "count": "admissible",
}
PLAIN_PTM: dict[str, Any] = {
    "name": "plain",
    "mechanism": {key: value for key, value in RECORD.items() if key != "symmetries"}
    | {"name": "plain"},
    "parameters": {"L1": 1, "k": 100, "l0": "1/2", "F3": -10, "F4": -10},
    "axes": {"rho": ["1/20", 2], "L2": [0, 2]},
    "count": "admissible",
}
FOUR_BAR: dict[str, Any] = {
    key: value
    for key, value in yaml.safe_load(
        (Path(__file__).parents[2] / "configs" / "mechanisms" / "four-bar-free.yaml").read_text(
            encoding="utf-8"
        )
    ).items()
    if key != "reference"
} | {"parameters": {"G": 1}, "axes": {"F": [0, 4], "l0": ["1/2", 2]}, "count": "admissible"}
RECORDS = {"chain": CHAIN, "one without": WITHOUT, "roof": ROOF, "four-bar": FOUR_BAR}
NEAR = 2e-3
"""Of a length to the free one: an equilibrium there is left to the proofs."""


def slice_of(record: dict[str, Any], **changes: Any) -> Slice:
    return ptmcad.slice_from_mapping(record | changes)


@cache
def map_of(name: str, tolerance: str) -> RegionMap:
    return ptmcad.classify(slice_of(RECORDS[name]), tolerance=tolerance)


def points_of(slice: Slice, number: int, seed: int = 1) -> list[tuple[Fraction, Fraction]]:
    rng = random.Random(seed)
    one, two = slice.axes
    shares = [
        (Fraction(rng.randrange(1, 10**4), 10**4), Fraction(rng.randrange(1, 10**4), 10**4))
        for _ in range(number)
    ]
    return [
        (one.low + u * (one.high - one.low), two.low + v * (two.high - two.low)) for u, v in shares
    ]


def in_chain(force: float, free: tuple[float, float]) -> tuple[int, int, bool]:
    """The numbers of minima and of admissible ones, and whether a spring is nearly as long as its
    free length.
    """

    def lengths(a: Any, b: Any) -> tuple[Any, Any]:
        px, py = np.cos(a), np.sin(a)
        return np.hypot(px, py - 2), np.hypot(px + np.cos(b) - 1.5, py + np.sin(b) + 0.5)

    def energy(a: Any, b: Any) -> Any:
        one, two = lengths(a, b)
        return (one - free[0]) ** 2 / 2 + (two - free[1]) ** 2 - force * (np.cos(a) + np.cos(b))

    found = [lengths(*p) for p in minima(energy)]
    taut = [l1 > free[0] and l2 > free[1] for l1, l2 in found]
    return (
        len(found),
        sum(taut),
        any(min(abs(l1 - free[0]), abs(l2 - free[1])) < NEAR for l1, l2 in found),
    )


@pytest.mark.parametrize(("name", "tolerance"), [("chain", "1/100"), ("one without", "1/100")])
@pytest.mark.slow_cases("chain-1/100")
def test_counts_in_cells_are_those_of_a_search(name: str, tolerance: str) -> None:
    m = map_of(name, tolerance)
    assert m.undetermined < Fraction(tolerance)
    assert {cell.admissible for cell in m.cells} >= {1, 2}
    known = 0
    for x, y in points_of(m.slice, 60):
        at = m.locate(F=x, l0=y)
        stable, admissible, close = in_chain(
            float(x), (float(y), 0.0 if name == "one without" else float(y))
        )
        if at.cell is None or close:
            continue
        known += 1
        assert (at.stable, at.admissible) == (stable, admissible), (x, y)
    assert known > 45


def test_the_known_answer_of_a_spring_on_a_slider() -> None:
    """(h - l0 h/l) = f > 0 has just one solution with l > l0: below, where h < 0, it is compressed."""
    m = map_of("roof", "1/200")
    assert m.undetermined < Fraction(1, 200)
    assert {cell.admissible for cell in m.cells} == {1}
    assert {cell.stable for cell in m.cells} == {1, 2}


@pytest.mark.parametrize("number", [5, pytest.param(20, marks=pytest.mark.slow)])
def test_by_the_papers_mechanism(number: int) -> None:
    """Against formulas made by hand for it, and against a search."""
    plain, seen = plain_counter(slice_of(PLAIN_PTM)), set()
    for x, y in points_of(slice_of(PLAIN_PTM), number, seed=3):
        count = plain.at(x, y, Count.ADMISSIBLE)
        values = {f"k{n}": 100.0 for n in (1, 2, 3)} | {f"l0_{n}": 0.5 for n in (1, 2, 3)}
        values |= {
            "rho": float(x),
            "L1": 1,
            "L2": float(y),
            "F3": -10,
            "F4": -10,
            "F3x": 0,
            "F4x": 0,
        }
        known = dense_search(values)
        if known["margin"] < 1e-6 or np.min(np.abs(known["lengths"] - 0.5)) < NEAR:
            continue
        assert count.decided
        assert (count.stable, count.admissible) == (known["stable"], known["admissible"]), (x, y)
        seen.add(count.admissible)
    assert seen >= {0, 1, 2}


@pytest.mark.slow
def test_maps_by_plain_formulas_and_those_made_by_hand() -> None:
    window = {"rho": ["7/5", "3/2"], "L2": ["21/20", "23/20"]}
    one, two = (
        ptmcad.classify(slice_of(PLAIN_PTM, axes=window, mechanism=mechanism), tolerance="1/20")
        for mechanism in (PLAIN_PTM["mechanism"], "ptm")
    )
    for a, b in ((one, two), (two, one)):
        for cell in a.cells:
            at = b.locate(rho=cell.sample[0], L2=cell.sample[1])
            assert at.admissible in (None, cell.admissible)
    assert {cell.admissible for cell in one.cells} == {cell.admissible for cell in two.cells}
    assert len(one.regions) == len(two.regions) == 2


def test_closed_loops() -> None:
    m = map_of("four-bar", "1/100")
    assert {cell.admissible for cell in m.cells} >= {0, 1, 2}
    tried = 0
    for x, y in points_of(m.slice, 80):
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


def without(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """Leave out the curves whose names have one of these."""

    def kept(name: str) -> bool:
        return not any(part in name for part in names)

    complete = engine.curves

    def some(*given: Any, **options: Any) -> tuple[CriticalCurve, ...]:
        return tuple(curve for curve in complete(*given, **options) if kept(curve.name))

    monkeypatch.setattr(engine, "curves", some)


@pytest.mark.parametrize(("name", "tolerance"), [("chain", "1/20"), ("four-bar", "1/20")])
@pytest.mark.slow_cases("chain-1/20")
@pytest.mark.slow
def test_without_boundaries_at_free_lengths_counts_are_wrong(
    name: str, tolerance: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = map_of(name, "1/100")
    without(monkeypatch, "has its free length")
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
