"""Compiled systems: whose formulas they are."""

from __future__ import annotations

from typing import Any

from ptmcad.exact.models.potential import system_from
from ptmcad.model import Model, described
from ptmcad.model.closed import without_loops
from ptmcad.model.compile import compiled

LOOP: dict[str, Any] = {
    "name": "loop",
    "parameters": {"a": {"default": 1}, "k": {"kind": "stiffness", "default": 1}, "F": {"kind": "force", "default": 1}},
    "unknowns": {"t": "angle", "s": "angle"},
    "points": {"A": [0, 0], "B": [2, 0], "P": ["a*cos(t)", "a*sin(t)"], "Q": ["2 + a*cos(s)", "a*sin(s)"]},
    "bars": [["A", "P"], ["B", "Q"]],
    "closing": [{"between": ["P", "Q"], "length": "3/2"}],
    "springs": [{"between": ["A", "Q"], "k": "k"}],
    "loads": {"P": [0, "F"]},
}


def closed(record: dict[str, Any]) -> Model:
    return without_loops(described(record))


def test_loops_with_the_same_equations_have_points_of_their_own() -> None:
    """A point that nothing is fixed to changes no equation."""
    plain = closed(LOOP)
    marked = closed({**LOOP, "points": {**LOOP["points"], "M": ["a*cos(t)/2", "a*sin(t)/2"]}})
    assert system_from(plain) == system_from(marked)
    assert "M" not in compiled(plain).points
    assert "M" in compiled(marked).points


def test_heights_are_those_of_points_that_no_loop_holds() -> None:
    """One for each point that rises; of the loop's none."""
    open_chain = {key: value for key, value in LOOP.items() if key != "closing"}
    assert len(compiled(closed(open_chain)).heights) == 2
    assert compiled(closed(LOOP)).heights == ()
