"""`verify` of maps with lengths that springs alone hold: its own bounds, and solutions that are
left out everywhere.
"""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from functools import cache
from math import inf
from typing import Any

import pytest
import yaml
from flint import arb
from hypothesis import given, settings
from support.examples import examples
from support.held_sliders import PAIR, SLANTED, pairs
from support.multistart import Model, model_of, solutions

from ptmcad.text.balls import ball_of

pytest.importorskip("numba")

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.verification.normalform import unknownbounds
from ptmcad.verification.normalform.boxes import Unproved
from ptmcad.verification.normalform.unknownbounds import half_widths
from ptmcad.verification.normalform.waves import Form, form_of

APART: dict[str, Any] = {**SLANTED, "axes": {"a": ["1/4", "3/4"], "F": [1, 2]}}
"""The same where the guides are not parallel."""
CURVED: dict[str, Any] = yaml.safe_load("""
name: curved
mechanism:
  name: curved
  parameters: {F: {kind: force}, l: {kind: free length}}
  unknowns: {x: length, y: length}
  points: {S: [x*(1 - y/10), 1], T: [y, 1/3], A: [0, 0]}
  springs: [{between: [A, S], k: 1, free: l}, {between: [A, T], k: 1, free: 1/2}]
  loads: {S: [1, 0], T: [F, 0]}
axes: {F: [-1, 1], l: [1/2, 1]}
count: total
""")
"""The equations are not linear in the two lengths together, but for the springs."""


@cache
def searched(name: str) -> Model:
    return model_of({"pair": PAIR, "slanted": APART, "curved": CURVED}[name])


def form(record: dict[str, Any]) -> Form:
    return form_of(ptmcad.slice_from_mapping(record))


def balls(values: dict[str, Fraction]) -> dict[str, arb]:
    return {name: ball_of(value) for name, value in values.items()}


@cache
def true_map() -> str:
    return ptmcad.classify(PAIR, tolerance="1/20", jobs=1).to_json()


def test_a_solution_that_is_left_out_of_counts_and_lists_alike_is_missed() -> None:
    forged = copy.deepcopy(json.loads(true_map()))
    left = 0
    for part in forged["cells"] + forged["regions"]:
        stable = next((k for k, n in enumerate(part["index"]) if n and part["total"] > 1), None)
        if stable is None:
            continue
        part["total"] -= 1
        part["index"][stable] -= 1
        part["stable"] -= stable == 0
        for k, solution in enumerate(part.get("solutions", ())):
            if solution["signs"].count("-") == stable:
                left += 1
                del part["solutions"][k]
                break
    assert left
    report = ptmcad.verify(RegionMap.from_json(json.dumps(forged)), seed=1, boxes=0, effort=0)
    assert not report.ok
    assert report.violation.startswith("counts and solutions")


@settings(max_examples=examples(12), deadline=None)
@given(pairs().map(lambda values: values | {"G": Fraction(1, 7)}))
def test_no_equilibrium_is_beyond_the_checkers_bounds(values: dict[str, Fraction]) -> None:
    bounds = half_widths(form(PAIR), balls(values))
    assert max(bounds) < 1e4
    for found in solutions(searched("pair"), values, 200, seed=1):
        assert all(abs(x) < bound for x, bound in zip(found.at, bounds, strict=True))


def test_bounds_need_a_dominant_diagonal_in_all_of_the_balls(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As near as one likes to parallel guides an equilibrium is far away; without the test there is
    a false bound.
    """
    values = {"a": Fraction(1, 100000), "F": Fraction(3, 2)}
    (found,) = solutions(searched("slanted"), values, 4000, seed=3)
    whole = {"a": arb("1/4", "1/2"), "F": arb(1.5, 0.5)}
    with pytest.raises(Unproved, match="no bound of the unknown x"):
        half_widths(form(APART), whole)
    assert abs(found.at[0]) < half_widths(form(APART), balls(values))[0]
    monkeypatch.setattr(unknownbounds, "MAX_SHARE", inf)
    assert abs(found.at[0]) > half_widths(form(APART), whole)[0]


def test_bounds_need_equations_that_are_linear(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the products of the two lengths there would be a bound, and an equilibrium beyond."""
    values = {"F": Fraction(47, 5), "l": Fraction(1)}
    found = solutions(searched("curved"), values, 4000, 3)
    with pytest.raises(Unproved, match="no bound"):
        half_widths(form(CURVED), balls(values))
    monkeypatch.setattr(unknownbounds, "_present", lambda terms: set())
    bounds = half_widths(form(CURVED), balls(values))
    assert any(abs(f.at[0]) > 2 * bounds[0] for f in found)
