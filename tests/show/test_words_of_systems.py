"""What the terminal and pictures say of systems and of several solutions of one kind, where only
words can be wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest
import yaml

import ptmcad
from ptmcad.answer.poses import Poses
from ptmcad.ask.lines.along import operation_widths
from ptmcad.ask.solving import poses_at
from ptmcad.exact.ranges.exactline import intervals
from ptmcad.question.config import point_from_mapping
from ptmcad.question.slice import Slice
from ptmcad.show.ranges.linetable import table, width_table
from ptmcad.show.ranges.rangedocument import part
from ptmcad.show.render.landscape import draw_landscape
from ptmcad.text.expressions import axis
from ptmcad.text.parsing import parse

QUINTIC: Mapping[str, Any] = yaml.safe_load("""
system:
  parameters: {c: {}}
  unknowns: {x: real}
  equations: [x^5 - 5*x^3 + 4*x - a*c + b]
  stable: [x - 1/2]
parameters: {c: 1/(1 - b - 3)}
axes: {a: [-2, 2], b: [-1, 2]}
""")
"""At a = 1/3 two roots that are not stable vanish at b = 1.318, and two stable ones are left on
either side.
"""

CONDITION_THAT_VANISHES: Mapping[str, Any] = yaml.safe_load("""
system: {unknowns: {x: real}, equations: [(x - a)*(x^2 - b)], stable: [a - x]}
axes: {a: [-2, 2], b: [-1, 2]}
""")


def slice_of(record: Mapping[str, Any]) -> Slice:
    return ptmcad.slice_from_mapping(dict(record))


def test_neighbours_with_as_many_stable_solutions_are_one_range() -> None:
    found = intervals(slice_of(QUINTIC), "b", {"a": "1/3"})
    (range_,) = found.operation
    assert [i.total for i in range_.parts] == [5, 3]
    assert (range_.low, range_.high) == (-1, 2)
    assert (
        "range with two stable solutions: -1 to 2, width 3 (the whole window)"
        in table(found).splitlines()
    )
    assert part(found, 6)["line"]["operation"] == [0, 1]


def test_a_system_has_no_operation_range(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "ptmcad.exact.ranges.width._MAX_PIECES", 50
    )  # where exactly it is widest is not asked
    slice = slice_of(QUINTIC)
    widths = operation_widths(slice, "b", 3)
    text = table(intervals(slice, "b", {"a": "1/3"})) + width_table(widths)
    assert "operation" not in text
    assert "widest range with three stable solutions: " in text
    assert [len(row["operation"]) for row in part(widths, 6)["over"]["rows"]] == [
        len(r.operation) for r in widths.rows
    ]


@pytest.mark.parametrize(
    ("written", "shown"),
    [
        ("-x/(x - 1)", "x/(1 - x)"),
        ("(2 - x)/(y - 3)", "(-2 + x)/(3 - y)"),
        ("-1/(2 + y)", "-1/(2 + y)"),
        ("(1 + x)/(2 + y)", "(1 + x)/(2 + y)"),
    ],
)
def test_a_fraction_is_written_with_few_signs(written: str, shown: str) -> None:
    names = {"x": axis(0), "y": axis(1)}
    expression = parse(written, names)
    assert expression.to_text() == shown
    assert parse(shown, names) == expression


def solved(record: Mapping[str, Any], **at: str) -> Poses:
    model = slice_of(record).model
    return poses_at(model, point_from_mapping(at, model), 10)


def test_a_condition_that_is_zero_is_told() -> None:
    found = solved(CONDITION_THAT_VANISHES, a="0", b="1")
    assert [pose.stable for pose in found.equilibria] == [True, False, False]
    assert found.remark == "a - x is zero at solution 3, which counts as unstable"
    assert "zero      in 4 cells" in ptmcad.classify(slice_of(CONDITION_THAT_VANISHES)).table()
    assert "zero" not in ptmcad.classify(slice_of(QUINTIC)).table()


def test_a_legend_says_maxima_of_two() -> None:
    system = {"unknowns": {"t": "angle"}, "potential": "cos(2*t) + a*cos(t)/9 + b*sin(t)/9"}
    figure = draw_landscape(
        solved({"system": system, "axes": {"a": [0, 1], "b": [0, 1]}}, a="1", b="1/2")
    )
    texts = {
        text.get_text() for text in figure.findobj(match=lambda artist: hasattr(artist, "get_text"))
    }
    assert {"2 stable (minima)", "2 maxima"} <= texts
