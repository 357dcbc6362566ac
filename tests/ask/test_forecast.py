"""What an exact map is predicted to take, and where that is printed."""

from __future__ import annotations

from pathlib import Path

import pytest

from ptmcad.ask.checking import check as checked
from ptmcad.ask.checking import cost_text
from ptmcad.ask.forecast import WITHIN, forecast
from ptmcad.exact.curvesizes import CurveSizes, Survey
from ptmcad.question.config import load

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


def test_a_record_is_told_its_curve_and_its_cost() -> None:
    lines = list(cost_text(checked(load(CONFIGS / "fig5-text.yaml"))))
    assert [line[:12].strip() for line in lines] == ["solutions", "curves", "engine", "cost"]
    assert "degree 24, 24 in rho, 12 in F4: up to 127 terms" in lines[1]
    assert lines[3].endswith(f"up to a factor of {WITHIN}")


def test_a_component_that_is_an_axis_is_told() -> None:
    """Von Mises' truss is flat where a = 0, and its two poses are one."""
    lines = list(cost_text(checked(load(CONFIGS / "systems" / "von-mises-truss.yaml"))))
    assert lines[1].endswith(
        "critical of degree 6, 6 in a, 6 in f: up to 10 terms; and the line a = 0"
    )


def test_a_curve_out_of_reach_is_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ptmcad.ask.checking.sizes", lambda *_: CurveSizes((60, 50), 70, (1, 1)))
    found = checked(load(CONFIGS / "systems" / "kuramoto.yaml"))
    assert "out of the exact map's reach" in found.cost
    assert "--engine certified encloses the map" in found.cost


def test_where_the_size_is_not_known_neither_is_the_cost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ptmcad.ask.checking.sizes", lambda *_: None)
    found = checked(load(CONFIGS / "forces.yaml"))
    assert found.forecast is None
    assert found.cost.startswith("not known: the critical curve's size")


def test_more_solutions_and_higher_degrees_take_longer() -> None:
    known = (
        (6, CurveSizes((12, 12), 24, (1, 1))),
        (6, CurveSizes((24, 24), 24, (1, 1))),
        (12, CurveSizes((24, 24), 24, (1, 1))),
    )
    least, middle, most = (forecast(n, sizes) for n, sizes in known)
    assert least.seconds < middle.seconds < most.seconds
    assert least.megabytes < middle.megabytes
    assert forecast(6, CurveSizes((24, 24), 24, (2, 2))).seconds < middle.seconds
    assert not forecast(6, CurveSizes((60, 50), 70, (1, 1))).reachable


def test_seconds_follow_what_there_is_to_compute() -> None:
    curve = CurveSizes((12, 12), 24, (1, 1), (5, 5, 5))
    cells = Survey(40, 20, 12)
    usual = forecast(6, curve, cells).seconds
    assert usual < forecast(6, curve._replace(tables=(25, 25, 25)), cells).seconds
    assert usual < forecast(6, curve, cells._replace(cells=4000)).seconds
    assert usual < forecast(6, curve, cells._replace(walls=2000)).seconds
    assert usual < forecast(6, curve, cells._replace(degree=48)).seconds


def test_cells_are_counted_where_the_curve_is_quick(monkeypatch: pytest.MonkeyPatch) -> None:
    slice, asked = load(CONFIGS / "forces.yaml"), []

    def counted(*_: object) -> Survey:
        asked.append(True)
        return Survey(1_000_000, 0, 1)

    monkeypatch.setattr("ptmcad.ask.checking.survey", counted)
    found = checked(slice).forecast
    assert found is not None and found.seconds > 100 and asked
    monkeypatch.setattr("ptmcad.ask.checking.QUICK", 0.0)
    without = checked(slice).forecast
    assert without == forecast(6, found.sizes) and len(asked) == 1


def test_a_survey_that_takes_too_long_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ptmcad.ask.checking.MAX_SURVEYING", 0.0)
    found = checked(load(CONFIGS / "forces.yaml")).forecast
    assert found is not None and found == forecast(6, found.sizes)
