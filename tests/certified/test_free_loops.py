"""Closed loops on springs with free lengths: maps and poses against a search along the loop's own
angle.

The hypotheses of Theorem 5 of docs/soundness.md are dropped one by one; each time a map or a count
is wrong then.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from support.left_out import without_curves
from support.loop_search import Energy, Numbers, counts_along
from support.places import random_points

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.errors import ConfigError
from ptmcad.formulas.graph import Formula
from ptmcad.question.slice import Count
from ptmcad.show.report.reportpage import tape
from ptmcad.workbench.fields.quantityfield import field_of, request_of

pytest.importorskip("numba")

RECORD = yaml.safe_load(
    (Path(__file__).parents[2] / "configs" / "mechanisms" / "four-bar-free.yaml").read_text(
        encoding="utf-8"
    )
)
FOUR_BAR: dict[str, Any] = {key: value for key, value in RECORD.items() if key != "reference"}
ANCHORED: dict[str, Any] = {
    "name": "anchored",
    "mechanism": FOUR_BAR["mechanism"]
    | {
        "parameters": {
            name: p for name, p in FOUR_BAR["mechanism"]["parameters"].items() if name != "k2"
        }
        | {"x": {"default": 0}, "y": {"default": 0}},
        "points": FOUR_BAR["mechanism"]["points"] | {"C": ["x", "y"]},
        "springs": [{"between": ["C", "Q"], "k": "k1", "free": "l0"}],
    },
    "parameters": {"F": "1/5", "G": "1/3"},
    "axes": {"x": [0, 4], "y": [-2, 2]},
}
"""One spring, whose anchor meets the second crank's end on a circle of the window."""
FLAT = FOUR_BAR | {"parameters": {"F": "1/2", "G": 1}, "axes": {"b": [1, 4], "l0": [0, 1]}}
"""The loop folds flat on lines of the window."""
SLICES = {"four-bar-free": FOUR_BAR, "anchored": ANCHORED, "flat": FLAT}
POINTS = 200


def slice_of(name: str, **changes: Any) -> ptmcad.Slice:
    return ptmcad.slice_from_mapping(SLICES[name] | changes)


def values_at(slice: ptmcad.Slice, x: Fraction, y: Fraction) -> dict[str, float]:
    return {name: float(value.evaluate(x, y)) for name, value in slice.parameters.items()}


def energy_of(p: Mapping[str, float]) -> Energy:
    def stretched(k: float, dx: Numbers, dy: Numbers) -> Numbers:
        return k / 2 * (np.hypot(dx, dy) - p["l0"]) ** 2

    def energy(px: Numbers, py: Numbers, qx: Numbers, qy: Numbers) -> Numbers:
        loads = -p["F"] * py - p["G"] * qy
        if "x" in p:
            return loads + stretched(p["k1"], qx - p["x"], qy - p["y"])
        return loads + stretched(p["k1"], qx, qy) + stretched(p["k2"], px - p["b"], py)

    return energy


def wrong_counts(
    m: RegionMap, number: int = POINTS, seed: int = 5
) -> list[tuple[Fraction, Fraction]]:
    """Of so many random points outside of the cover those at which the search finds another count."""
    first, second = m.slice.axis_names
    found, tried = [], 0
    for x, y in random_points(m.slice, 400, seed):
        cell = m.locate(**{first: x, second: y}).cell
        if cell is None or tried == number:
            continue
        tried += 1
        p = values_at(m.slice, x, y)
        total, stable = counts_along(p, energy_of(p))
        said = m.cells[cell]
        if said.stable != stable if m.slice.count is Count.STABLE else said.total != total:
            found.append((x, y))
    assert tried == number
    return found


@cache
def map_of(name: str, count: str, tolerance: str) -> RegionMap:
    return ptmcad.classify(slice_of(name, count=count), tolerance=tolerance)


@pytest.mark.parametrize(
    ("name", "count", "tolerance"),
    [
        ("four-bar-free", "stable", "1/500"),
        ("flat", "total", "1/200"),
        pytest.param("four-bar-free", "total", "1/500", marks=pytest.mark.slow),
        pytest.param("flat", "stable", "1/500", marks=pytest.mark.slow),
        pytest.param("anchored", "total", "1/500", marks=pytest.mark.slow),
        pytest.param("anchored", "stable", "1/500", marks=pytest.mark.slow),
    ],
)
@pytest.mark.slow_cases("flat-total-1/200")
def test_counts_are_those_of_a_search_along_the_loop(name: str, count: str, tolerance: str) -> None:
    m = map_of(name, count, tolerance)
    assert m.undetermined < Fraction(tolerance)
    assert not wrong_counts(m)


def test_a_relaxed_spring_is_told() -> None:
    """Of an unloaded loop on one spring: its force and the energy are zero, to 100 digits, and the
    pose is stable.
    """
    poses = ptmcad.solve(ANCHORED | {"parameters": {}}, x="3/2", y=1)
    relaxed = [
        pose for pose in poses.equilibria if abs(pose.springs[0].force.high) < Fraction(1, 10**100)
    ]
    assert len(relaxed) == poses.stable == 4
    assert all(
        pose.energy is not None and abs(pose.energy.high) < Fraction(1, 10**100) for pose in relaxed
    )
    assert all(pose.stable and pose.admissible is None for pose in relaxed)
    assert len(poses.equilibria) == 8


def test_a_map_of_an_angle_is_that_of_the_poses() -> None:
    """Followed in floating point with the springs' roots, and compared with proved poses."""
    result = map_of("four-bar-free", "stable", "1/500")
    field = field_of(result, request_of(result.slice, "th1", "stable:1"), 6, checks=12)
    assert field.checked == 12
    assert field.difference < 1e-9
    assert tape(result) is None, "the report's page has no roots of loops, and follows nothing"


CRANK: dict[str, Any] = yaml.safe_load(
    (Path(__file__).parents[2] / "configs" / "mechanisms" / "slider-crank.yaml").read_text(
        encoding="utf-8"
    )
)


def crank(unknowns: Mapping[str, str]) -> dict[str, Any]:
    spring = {"between": ["A", "S"], "k": "k", "free": "1/3"}
    mechanism = CRANK["mechanism"] | {"unknowns": dict(unknowns), "springs": [spring]}
    return {"mechanism": mechanism, "axes": {"W": [-2, 2], "M": [-2, 2]}}


def crank_counts(weight: float, moment: float) -> tuple[int, int]:
    """Along the crank's angle, for either way of assembling; the moment's work grows with the
    turns.
    """
    th = np.linspace(-np.pi, np.pi, 20001)
    total = minima = 0
    for side in (1, -1):
        x = np.cos(th) + side * np.sqrt(4 - np.sin(th) ** 2)
        energy = (np.hypot(x - 1, 1) - 1 / 3) ** 2 / 2 + weight * np.sin(th) - moment * th
        rising = np.diff(energy) > 0  # the same after a turn
        before = np.roll(rising, 1)
        total, minima = (
            total + int((rising != before).sum()),
            minima + int((rising & ~before).sum()),
        )
    return total, minima


@pytest.mark.parametrize(
    "unknowns", [{"th": "angle", "x": "length"}, {"x": "length", "th": "angle"}], ids=str
)
@pytest.mark.slow_cases("{'th': 'angle', 'x': 'length'}")
def test_a_slider_in_any_order_of_the_unknowns(unknowns: dict[str, str]) -> None:
    """Bounds of the slider follow from the loop; the determinant's sign from the order."""
    record = crank(unknowns)
    slice = ptmcad.slice_from_mapping(record)
    for x, y in random_points(slice, 4, 2):
        poses = ptmcad.solve(record, W=x, M=y)
        assert (len(poses.equilibria), poses.stable) == crank_counts(float(x), float(y))
    # as many minima as maxima are along a closed curve: which pose is stable is told by energies
    ordered = sorted(
        ptmcad.solve(record, W="1/3", M=0).equilibria, key=lambda pose: pose.known_energy.center
    )
    assert ordered[0].stable is True
    assert ordered[-1].stable is False
    stable = ptmcad.classify(slice, tolerance="1/50")
    assert stable.undetermined < Fraction(1, 50)
    for x, y in random_points(slice, 40, 4):
        cell = stable.locate(W=x, M=y).cell
        assert cell is None or stable.cells[cell].stable == crank_counts(float(x), float(y))[1]


def test_what_is_not_computed_is_refused() -> None:
    mechanism = FOUR_BAR["mechanism"]
    two_free = mechanism | {
        "unknowns": mechanism["unknowns"] | {"th3": "angle"},
        "points": mechanism["points"] | {"R": ["b + 2*L2*cos(th3)", "sin(th3)"]},
        "loads": mechanism["loads"] | {"R": [0, "F"]},
    }
    with pytest.raises(
        ConfigError, match=r"free lengths in closed loops .* one degree of freedom, not 2"
    ):
        ptmcad.slice_from_mapping(FOUR_BAR | {"mechanism": two_free})
    with pytest.raises(ConfigError, match="choose certified or auto"):
        ptmcad.classify(slice_of("four-bar-free"), engine="exact")


@pytest.mark.slow
def test_without_flat_loops_counts_are_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fold at which the tangent is not zero is not all: at b = L1 + L2 + L3 = 37/10 the whole
    loop comes to be.
    """
    original = plain_curves.system

    def bent(
        equations: list[Formula],
        unknowns: Any,
        vanishing: Any,
        nonnegative: Sequence[Formula] = (),
        **more: Any,
    ) -> Any:
        closed = equations[-3]  # the loop's equation, the slope and the determinant
        slopes = [closed.graph.derivative(closed, k) for k in unknowns[2:4]]
        far = slopes[0].squared() + slopes[1].squared() - Fraction(1, 10**4)
        return original(equations, unknowns, vanishing, [*nonnegative, far], **more)

    monkeypatch.setattr(plain_curves, "system", bent)
    wrong = ptmcad.classify(
        slice_of("flat", count="total", axes={"b": ["7/2", 4], "l0": [0, 1]}), tolerance="1/20"
    )
    assert wrong_counts(wrong, 40)
    monkeypatch.undo()
    right = ptmcad.classify(
        slice_of("flat", count="total", axes={"b": ["7/2", 4], "l0": [0, 1]}), tolerance="1/20"
    )
    assert not wrong_counts(right, 40)
    assert {0, 2} <= {cell.total for cell in right.cells}


SMALL = {"axes": {"x": ["9/5", "11/5"], "y": [1, "7/5"]}, "count": "total"}
"""Around a place at which the second crank's end may be, upright over its pivot."""
MET = {"x": Fraction(2), "y": Fraction(6, 5)}


@pytest.mark.slow
def test_where_a_spring_has_no_length_there_is_an_equilibrium_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """On the circle itself, which a map has to leave out: beside it the peak is a smooth one, and
    counts.
    """
    slice = slice_of("anchored", **SMALL)
    complete = ptmcad.classify(slice, tolerance="1/20")
    assert complete.locate(**MET).cell is None
    counter = plain_counter(slice)
    beside = counter.at(MET["x"] + Fraction(1, 1000), MET["y"], Count.TOTAL)
    p = values_at(slice, MET["x"], MET["y"])
    total, _ = counts_along(p, energy_of(p))  # with the peak
    assert beside.decided and beside.total == total
    assert not counter.at(MET["x"], MET["y"], Count.TOTAL).decided
    without_curves(monkeypatch, "point where")
    assert ptmcad.classify(slice, tolerance="1/20").locate(**MET).cell is not None


@pytest.mark.slow
def test_without_short_springs_counts_are_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """Folds at which a spring is shorter than an eighth of what is usual have a search of their
    own.
    """
    slice = slice_of("anchored", **SMALL)
    assert not wrong_counts(ptmcad.classify(slice, tolerance="1/50"))
    without_curves(monkeypatch, "fold with spring")
    assert wrong_counts(ptmcad.classify(slice, tolerance="1/50"))
