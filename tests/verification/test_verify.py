"""The verification accepts every shipped result, and rejects what has been altered so that it is
false.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import pytest
from forger.consistency import put
from forger.judge import violation
from support.replacing import replace
from support.shipped_records import EXACT

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.question.slice import Point
from ptmcad.verification import areaclaims
from ptmcad.verification.areaclaims import check_areas
from ptmcad.verification.claims import Claims
from ptmcad.verification.report import Violation
from ptmcad.verification.wallintegrals import integrals_over

CONFIGS = [path.stem for path in EXACT]
LARGE = ("stiffness", "unequal-springs", "fig5-caption", "horizontal")
"""Maps with many cells of the kinds that the others have."""


def stored(result: RegionMap) -> RegionMap:
    """What a reader of the file has."""
    return RegionMap.from_json(result.to_json())


@pytest.mark.parametrize(("name", "tolerance"), [
    *((name, "1e-4") for name in CONFIGS if name not in LARGE),
    *(pytest.param(name, "1e-4", marks=pytest.mark.slow) for name in LARGE),
    pytest.param("stiffness", "1/10", marks=pytest.mark.slow),  # its narrow areas take longer than all else of it
])  # fmt: skip
@pytest.mark.fast_cases("fig2-1e-4")
def test_shipped_results_are_accepted(
    name: str, tolerance: str, shipped: Callable[..., RegionMap]
) -> None:
    report = ptmcad.verify(
        stored(shipped(name, area_tolerance=tolerance) if tolerance != "1e-4" else shipped(name))
    )
    assert report.ok, report.violation
    assert report.violation is None
    assert {c.name for c in report.checks if not c.passed} == {"plan without trace", "provenance"}
    assert "not checked" in report.table()


NO_CLAIMS = {"title", "name", "reference", "versions", "precision", "timings", "plan"}
"""What is no statement about the regions, and is listed as not checked."""
MAY_STAY_TRUE = {
    "low",
    "high",
    "segment",
    "below",
    "above",
    "center",
    "radius",
    "area",
    "sample",
    "reason",
    "text",
}
"""What can be altered a little without becoming false (k2 written as k1 instead of k); the forger
makes it false.
"""


def leaves(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of all values in a JSON document that are claims as they stand."""
    if path and isinstance(path[-1], str) and path[-1] in NO_CLAIMS | MAY_STAY_TRUE:
        return
    if isinstance(data, dict | list):
        for key, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from leaves(value, (*path, key))
    else:
        yield path


def changed(value: Any, rng: random.Random) -> Any:
    """Another value of the same type, or of another."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + rng.choice([-2, -1, 1, 2, 10**6])
    if value is None:
        return rng.choice([0, 1, "0"])
    digits = [k for k, c in enumerate(value) if c.isdigit()]
    if digits and rng.random() < 0.8:
        k = rng.choice(digits)
        return value[:k] + rng.choice([d for d in "123456789" if d != value[k]]) + value[k + 1 :]
    return rng.choice([value + "1", "-" + value, value[:-1], None, 7]) if value else "x"


FIRST_OF = {
    "critical_values": "critical values", "stacks": "walls and samples",
    "cells": "solutions", "adjacencies": "adjacencies", "non_adjacencies": "non-adjacencies", "regions": "regions",
}  # fmt: skip
"""The check that is tried first, by the table in which an entry is changed."""


def is_accepted(altered: RegionMap, table: str) -> bool:
    if (
        altered.status is not Status.EXACT or altered.cover is not None
    ):  # it is not said to be an exact map any more
        return ptmcad.verify(altered).ok
    return violation(altered, FIRST_OF.get(table, "")) is None


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("fig2", 50),
        pytest.param("fig2", 150, marks=pytest.mark.slow),
        pytest.param("fig3", 1500, marks=pytest.mark.slow),
        pytest.param("fig4", 300, marks=pytest.mark.slow),
    ],
)
def test_any_changed_entry_of_the_file_is_rejected(
    name: str, number: int, shipped: Callable[..., RegionMap]
) -> None:
    text = shipped(name).to_json()
    paths = list(leaves(json.loads(text)))
    rng = random.Random(name)
    accepted = []
    for path in rng.choices(paths, k=number):
        data = json.loads(text)
        place = data
        for key in path[:-1]:
            place = place[key]
        old, new = place[path[-1]], changed(place[path[-1]], rng)
        place[path[-1]] = new
        try:
            altered = RegionMap.from_json(json.dumps(data))
        except ValueError:
            continue
        if is_accepted(altered, path[0]) and altered != shipped(name):
            accepted.append((path, old, new))
    assert not accepted


CUBIC = {"unknowns": {"x": "real"}, "equations": ["x^3 - a*x + b"]}
WAVES = {"unknowns": {"t": "angle"}, "potential": "a*cos(t) + b*sin(t) + cos(2*t)"}
HUGE, UNIT = ["-1e30", "1e30"], [-1, 1]


@pytest.mark.parametrize(
    ("system", "axes"),
    [(CUBIC, {"a": HUGE, "b": HUGE}), (CUBIC, {"a": UNIT, "b": HUGE}), (WAVES, {"a": HUGE, "b": HUGE})],
    ids=["cubic", "flat cubic", "waves"],
)  # fmt: skip
def test_areas_in_large_windows_are_told(
    system: dict[str, Any], axes: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """By some panels for each doubling; from wrong ones, of a small region beside a huge one, too."""
    true = stored(ptmcad.classify({"name": "large", "system": system, "axes": axes}))
    tried = []

    def counted(*given: Any) -> Any:
        tried.append(given)
        return integrals_over(*given)

    monkeypatch.setattr(areaclaims, "integrals_over", counted)
    check_areas(Claims(true))
    assert len(tried) < 600 * sum(len(stack.walls) for stack in true.stacks)
    small = min(range(len(true.regions)), key=lambda n: true.regions[n].area[0])
    low, high = true.regions[small].area
    for shift in (2 * (high - low), 2 * (low - high)):
        false = replace(true, regions=put(true.regions, small, area=(low + shift, high + shift)))
        with pytest.raises(Violation, match="its area is"):
            check_areas(Claims(false))


def test_areas_beside_branches_that_run_close_together_take_few_panels(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two of the branches that meet at the origin are v = c u^3 +- d u^(11/2), nearly."""
    equations = ["a*y^2 - b + x^6", "a*x^2 - b*x*y + y^2"]
    system = {"unknowns": {"x": "real", "y": "real"}, "equations": equations}
    axes = {"a": [-5, 5], "b": [-5, 5]}
    true = stored(ptmcad.classify({"name": "close", "system": system, "axes": axes}))
    tried = []

    def counted(*given: Any) -> Any:
        tried.append(given)
        return integrals_over(*given)

    monkeypatch.setattr(areaclaims, "integrals_over", counted)
    check_areas(Claims(true))
    assert len(tried) < 90


def test_a_tiny_change_of_an_area_is_rejected(shipped: Callable[..., RegionMap]) -> None:
    true = stored(shipped("fig3", area_tolerance="1e-9"))
    check_areas(Claims(true))
    low, high = true.regions[1].area
    shift = Fraction(2, 10**9)
    first = replace(
        true.regions[0], area=(true.regions[0].area[0] - shift, true.regions[0].area[1] - shift)
    )
    second = replace(true.regions[1], area=(low + shift, high + shift))
    found = violation(replace(true, regions=(first, second, *true.regions[2:])), "areas")
    assert found is not None
    assert found[0] == "areas"


def test_bounds_too_narrow_to_be_confirmed_are_rejected(shipped: Callable[..., RegionMap]) -> None:
    """An area that is not rational, said to be known exactly: no enclosure can confirm it."""
    true = stored(shipped("fig3"))
    low, high = true.regions[1].area
    point = (low + high) / 2
    report = ptmcad.verify(replace(true, regions=put(true.regions, 1, area=(point, point))))
    assert not report.ok


def test_the_report_names_the_claim_and_a_witness(shipped: Callable[..., RegionMap]) -> None:
    true = stored(shipped("fig2"))
    report = ptmcad.verify(replace(true, cells=put(true.cells, 0, stable=2)))
    assert report.violation is not None
    assert report.violation.startswith("counts: cell 0 is said to have 4 equilibria, 2 stable")
    assert "L2=" in report.violation
    assert "FALSE" in report.table()
    assert "not reached" in report.table()


def test_a_true_alteration_is_accepted(shipped: Callable[..., RegionMap]) -> None:
    """Wider bounds, and a sample elsewhere in the same cell, are as true as before."""
    true = stored(shipped("fig2"))
    low, high = true.regions[0].area
    wide = replace(
        true, regions=put(true.regions, 0, area=(low * Fraction(9, 10), high + Fraction(1, 10)))
    )
    assert ptmcad.verify(wide).ok
    assert ptmcad.verify(true, seed=7).ok
    assert isinstance(true.cells[0].sample, Point)
