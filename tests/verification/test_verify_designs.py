"""Stored designs are checked by other methods, and what is wrong in one is found."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
import yaml
from support.replacing import replace

import ptmcad
from ptmcad.answer.design import BestDesign
from ptmcad.answer.intervals import Span
from ptmcad.cli import run
from ptmcad.text.enclosure import Enclosure
from ptmcad.verification import verify_design
from ptmcad.verification.designclaims import _check_bound, _check_boxes, _DesignLines
from ptmcad.verification.report import NotKnown, Unchecked, Violation

BALL: dict[str, Any] = yaml.safe_load("""
name: ball
system: {unknowns: {u: real}, equations: [u^2 - 1 + (x - b)^2 + (a - 1)^2 + (b - 1/2)^2]}
parameters: {b: 0}
axes: {x: [-2, 4], a: [0, 2]}
""")
OVER = {"a": [0, 2], "b": [0, 1]}


@pytest.fixture(scope="module")
def found() -> BestDesign:
    return ptmcad.design(BALL, "range", OVER, tolerance="1/5", evaluations=30)


def test_a_true_design_passes(found: BestDesign) -> None:
    report = verify_design(found, seed=3)
    assert report.ok
    assert [check.passed for check in report.checks] == [True, True, True, True, None, None]
    assert "boxes cover the bounds" in report.checks[1].detail


def test_a_true_design_with_conditions_passes() -> None:
    where = {"conditions": ["a + b <= 1"]}
    report = verify_design(
        ptmcad.design(BALL, "range", OVER, where=where, tolerance="1/5", evaluations=60), seed=3
    )
    assert report.ok and "where the conditions hold" in report.checks[1].detail


def test_a_condition_with_a_pole_is_not_seen_to_fail(found: BestDesign) -> None:
    """It holds where b is less than 1/2; beside the pole, in the middle of the gap, it fails."""
    halves = [(Fraction(0), Fraction(1, 5)), (Fraction(41, 50), Fraction(1))]
    forged = replace(
        found,
        conditions=("1/(b - 1/2) <= 3",),
        boxes=tuple(
            replace(found.boxes[0], ranges=((Fraction(0), Fraction(2)), part)) for part in halves
        ),
        reason="by branch and bound, over 2 boxes of designs",
    )
    with pytest.raises(Violation, match="which satisfies the conditions"):
        _check_boxes(_DesignLines(forged, "3"))


def test_designs_of_which_nothing_is_found_out_are_told(
    found: BestDesign, monkeypatch: pytest.MonkeyPatch
) -> None:
    of_all, asked = _DesignLines.ranges, []

    def of_some(self: _DesignLines, design: Mapping[str, Fraction]) -> list[Span]:
        asked.append(design)
        if len(asked) == 3:
            raise NotKnown("too close")
        return of_all(self, design)

    assert not isinstance(_check_bound(_DesignLines(found, "3")), Unchecked)
    monkeypatch.setattr(_DesignLines, "ranges", of_some)
    told = _check_bound(_DesignLines(found, "3"))
    assert isinstance(told, Unchecked) and "of 1 more nothing was found out" in told


def test_forgeries_are_found(found: BestDesign) -> None:
    assert found.span is not None and found.bound is not None
    low, high = found.span
    step = Fraction(1, 10)
    later = (
        Enclosure(low.low + step, low.high + step),
        Enclosure(high.low + step, high.high + step),
    )
    smaller = tuple(replace(box, bound=box.bound / 4) for box in found.boxes)
    fewer = f"by branch and bound, over {len(found.boxes) - 1} boxes of designs"
    more = f"by branch and bound, over {len(found.boxes) + 1} boxes of designs"
    outside = replace(
        found.boxes[0], ranges=((Fraction(-1), Fraction(1)), (Fraction(0), Fraction(1)))
    )
    forged = {
        "a box is missing": (
            replace(found, boxes=found.boxes[1:], reason=fewer),
            "boxes: no box holds",
        ),
        "a box twice": (
            replace(found, boxes=(*found.boxes, found.boxes[0]), reason=more),
            "overlap",
        ),
        "a box outside": (
            replace(found, boxes=(outside, *found.boxes[1:])),
            "is not within the bounds",
        ),
        "moved ends": (replace(found, span=later), "values: the best design has no range"),
        "another count": (replace(found, working=0), "values: the longest range"),
        "bounds too small": (replace(found, boxes=smaller), "is listed with more than the bound"),
        "a bound below the value": (
            replace(found, bound=Fraction(1)),
            "is listed with more than the bound",
        ),
    }
    for name, (wrong, words) in forged.items():
        violation = verify_design(wrong, seed=3).violation
        assert violation is not None and words in violation, name


def test_the_command_takes_designs(
    found: BestDesign,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("design.json").write_text(found.to_json(), encoding="utf-8")
    assert run(["verify", "design.json"]) == 0
    assert "boxes cover the bounds" in capsys.readouterr().out
    Path("forged.json").write_text(
        replace(found, boxes=found.boxes[1:]).to_json(), encoding="utf-8"
    )
    assert run(["verify", "forged.json"]) == 1
    assert "violated: form: the reason names another number of boxes" in capsys.readouterr().err
    Path("damaged.json").write_text(found.to_json().replace('"seed"', '"sead"'), encoding="utf-8")
    assert run(["verify", "damaged.json"]) == 2
    assert "is damaged or not a ptmcad-design/1 file" in capsys.readouterr().err
