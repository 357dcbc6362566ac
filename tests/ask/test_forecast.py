"""What an exact map is foretold to take, and where that is said."""

from __future__ import annotations

from pathlib import Path

import pytest

from ptmcad.ask.checking import check as checked
from ptmcad.ask.checking import cost_text, foretold
from ptmcad.ask.forecast import WITHIN, forecast
from ptmcad.exact.sizes import Sizes
from ptmcad.question.config import load

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


def test_a_record_is_told_its_curve_and_its_cost() -> None:
    lines = list(cost_text(checked(load(CONFIGS / "fig5-text.yaml"))))
    assert [line[:12].strip() for line in lines] == ["solutions", "curves", "engine", "cost"]
    assert "degree 24, 24 in rho, 12 in F4: up to 127 terms" in lines[1]
    assert lines[3].endswith(f"up to a factor of {WITHIN}")


def test_the_way_of_the_projection_is_told() -> None:
    small, large = (list(foretold(load(CONFIGS / f"{name}.yaml"))) for name in ("fig4", "systems/kuramoto-4"))
    assert "the curve's discriminant from 121 values in integers" in small
    assert "14 complex solutions" in large
    assert "the curve's discriminant from 1985 values modulo primes" in large


def test_a_curve_out_of_reach_is_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ptmcad.exact.sizes.sizes", lambda *_: Sizes((60, 50), 70, (1, 1)))
    found = checked(load(CONFIGS / "systems" / "kuramoto.yaml"))
    assert "out of the exact map's reach" in found.cost
    assert "--engine certified encloses the map" in found.cost


def test_where_the_size_is_not_known_the_cost_is_a_class(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ptmcad.exact.sizes.sizes", lambda *_: None)
    found = checked(load(CONFIGS / "forces.yaml"))
    assert found.forecast is None
    assert found.cost == "about a second"


def test_more_solutions_and_higher_degrees_take_longer() -> None:
    known = (6, Sizes((12, 12), 24, (1, 1))), (6, Sizes((24, 24), 24, (1, 1))), (12, Sizes((24, 24), 24, (1, 1)))
    least, middle, most = (forecast(n, sizes) for n, sizes in known)
    assert least.seconds < middle.seconds < most.seconds
    assert least.megabytes < middle.megabytes
    assert forecast(6, Sizes((24, 24), 24, (2, 2))).seconds < middle.seconds
    assert not forecast(6, Sizes((60, 50), 70, (1, 1))).reachable
