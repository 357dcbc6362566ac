"""`verify` of maps with springs on one line each: true ones are proved whole, false ones are found."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

pytest.importorskip("numba")

from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.certified.engine import certified_map
from ptmcad.certified.plain import criticalcurves as plain_curves
from ptmcad.options import Options
from ptmcad.verification.normalform.waves import form_of, sides


def sliding(guide: str, anchor: str, count: str = "index") -> dict[str, Any]:
    """A slider with a spring along its guide, and another one that is on it, or not."""
    ex, ey = guide.split(", ")
    across, up = anchor.split(", ")
    turned = {
        name: {"kind": "number", "default": value} for name, value in (("c", "3/5"), ("s", "4/5"))
    }
    return {
        "name": "sliding",
        "mechanism": {
            "name": "sliding",
            "parameters": {
                "l": {"kind": "free length", "default": 1},
                **(turned if ex == "c" else {}),
                "F": {"kind": "force"},
            },
            "unknowns": {"x": "length"},
            "points": {"O": [0, 0], "S": [f"{ex}*x", f"{ey}*x"], "A": [across, up]},
            "springs": [
                {"between": ["O", "S"], "k": 1, "free": 1},
                {"between": ["A", "S"], "k": 1, "free": "l"},
            ],
            "loads": {"S": [f"{ex}*F", f"{ey}*F"]},
        },
        "axes": {"F": [-1, 1], "l": ["1/4", "3/4"]},
        "count": count,
    }


CASES = {
    "two springs on the guide": sliding("1, 0", "1/2, 0"),
    "a slanted guide": sliding("3/5, 4/5", "1/2, -1/2"),
    "an irrational length": sliding("1, 1", "1/2, 1/2"),
    "a direction by parameters": sliding("c, s", "1/2, -1/2", "total"),
    "minima": sliding("1, 0", "1/2, 1/2", "stable"),
}


def made(name: str) -> RegionMap:
    return certified_map(
        ptmcad.slice_from_mapping({**CASES[name], "name": "sliding"}),
        Options(tolerance=Fraction(1, 20), jobs=1),
    )


@pytest.mark.parametrize("name", list(CASES))
@pytest.mark.slow_cases("two springs on the guide", "a direction by parameters")
def test_the_whole_free_area_is_proved(name: str) -> None:
    report = ptmcad.verify(made(name), seed=1, boxes=2)
    assert report.ok
    assert not [
        c for c in report.checks if c.passed is None and c.name not in {"plan", "provenance"}
    ]


@pytest.mark.parametrize("name", ["two springs on the guide", "a slanted guide"])
@pytest.mark.slow_cases("two springs on the guide")
def test_a_map_without_kinks_is_not_proved(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain_curves, "_boundaries", lambda *_: iter(()))
    false = made(name)
    monkeypatch.undo()
    (area,) = (
        c for c in ptmcad.verify(false, seed=1, boxes=0).checks if c.name == "the whole free area"
    )
    assert not area.passed


def test_a_wrong_count_beside_a_kink_is_found() -> None:
    true = made("two springs on the guide")
    cell = true.cells[0]
    assert cell.index is not None and cell.total is not None
    wrong = replace(
        cell,
        total=cell.total + 1,
        stable=cell.index[0] + 1,
        index=(cell.index[0] + 1, cell.index[1]),
    )
    assert not ptmcad.verify(replace(true, cells=(wrong, *true.cells[1:])), boxes=0, effort=0).ok


def test_lines_are_told_from_the_vectors() -> None:
    def chosen(guide: str, anchor: str) -> int:
        form = form_of(ptmcad.slice_from_mapping(sliding(guide, anchor)))
        assert form.cones[0].line is not None
        return len(list(sides(form)))

    assert chosen("1, 0", "1/2, 0") == 4
    assert chosen("1, 0", "1/2, 1/2") == 2
    assert chosen("3/5, 4/5", "3/10, 4/10") == 4
    assert chosen("3/5, 4/5", "3/10, 1/10") == 2
    assert chosen("c, s", "1/2*c, 1/2*s") == 4
    assert chosen("c, s", "1/2, 1/2") == 2
