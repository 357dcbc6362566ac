"""Two maps compared: the area where their counts differ, against areas that are known and exact
grids.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
import yaml
from support.maps import shipped
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.show.render.comparing import CHANGES, comparison_figure
from ptmcad.show.render.printing import settings
from ptmcad.show.style import styled


def parabola(shift: str, top: str = "1", engine: str = "exact", **further: object) -> RegionMap:
    """x^2 = a - shift has two solutions above a line, none below: areas are known."""
    return ptmcad.classify(
        {
            "system": {"unknowns": {"x": "real"}, "equations": [f"x^2 - b + a*({shift})"]},
            "axes": {"a": [0, 1], "b": [0, top]},
            "count": "total",
            **further,
        },
        engine=engine,
    )


def test_the_area_between_two_lines() -> None:
    """Two solutions where b > a / 2, and where b > a / 3: a triangle of 1/12 lies between."""
    found = parabola("1/2").compare(parabola("1/3"))
    (change,) = found.changes
    assert change.area[0] <= Fraction(1, 12) <= change.area[1]
    assert change.area[1] - change.area[0] < Fraction(1, 10**6)
    assert (
        found.first.regions[change.before].total == 0
        and found.second.regions[change.after].total == 2
    )
    assert found.share == found.area


def test_lines_that_cross_make_changes_of_both_kinds() -> None:
    """b > a / 2 against b > 1/4: they cross at a = 1/2, with triangles of 1/16 at both sides."""
    level = yaml.safe_load("""
        system: {unknowns: {x: real}, equations: [x^2 - b + 1/4 + 0*a]}
        axes: {a: [0, 1], b: [0, 1]}
        count: total
    """)
    found = parabola("1/2").compare(ptmcad.classify(level))
    assert len(found.changes) == 2
    for change in found.changes:
        assert change.area[0] <= Fraction(1, 16) <= change.area[1]
    assert {found.first.regions[c.before].total for c in found.changes} == {0, 2}


def test_a_map_does_not_differ_from_itself() -> None:
    for name, count in (("fig4", None), ("fig3", "index")):
        found = shipped(name, count).compare(shipped(name, count))
        assert found.changes == () and found.area == (0, 0)


def test_maps_that_are_not_of_one_window_are_refused() -> None:
    with pytest.raises(ConfigError, match="not the same axes"):
        parabola("1/2").compare(parabola("1/3", "2"))
    with pytest.raises(ConfigError, match="not the same count"):
        shipped("fig4").compare(shipped("fig4", "index"))


def test_the_picture_has_both_maps_and_the_difference() -> None:
    found = parabola("1/2").compare(parabola("1/3"))
    style = styled(size="7x4in", font_size=8)
    with settings(style):
        made = comparison_figure(found, 100, style)
    assert tuple(made.get_size_inches()) == pytest.approx((7, 4)) and len(made.axes) == 3
    said = [t.get_text() for t in made.texts]
    assert any(text.startswith("0 → 2, area 0.0833333") for text in said)
    (rim,) = [a for a in made.axes[2].get_children() if str(a.get_gid()).startswith("change-")]
    assert rim.get_edgecolor()[0][:3] == pytest.approx(
        [int(CHANGES[0][k : k + 2], 16) / 255 for k in (1, 3, 5)]
    )
    with pytest.raises(ConfigError, match="at least"), settings():
        comparison_figure(found, 100, styled("ieee", size="2x1.6in"))


def test_a_change_on_a_strip_that_is_not_seen_has_a_mark() -> None:
    with settings():
        wide = comparison_figure(parabola("1/2").compare(parabola("1/3")), 100, styled())
        narrow = comparison_figure(parabola("1/2").compare(parabola("499/1000")), 100, styled())
    marks = [[t.get_text() for t in made.axes[2].texts if str(t.get_gid()).startswith("arrow-")]
             for made in (wide, narrow)]  # fmt: skip
    assert marks == [[], ["0 → 2"]]


def test_the_command_line_compares(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, shift in (("one", "1/2"), ("two", "1/3")):
        (tmp_path / f"{name}.json").write_text(parabola(shift).to_json())
    one, two = (str(tmp_path / f"{name}.json") for name in ("one", "two"))
    assert run(["plot", one, "--compare", two, "--format", "svg,pdf"]) == 0
    said = capsys.readouterr().out
    assert "0 → 2: area 0.0833333" in said and f"A is {one}; B is {two}" in said
    assert {path.name for path in tmp_path.iterdir()} >= {"one-and-two.svg", "one-and-two.pdf"}
    assert run(["plot", one, "--compare", two, "--format", "csv"]) == 2
    assert run(["plot", one, "--compare", two, "--at", "a=1,b=1"]) == 2
    assert run(["plot", one, "--compare", str(tmp_path / "none.json")]) == 2


@pytest.mark.parametrize("engine", ["exact", "certified"])
@pytest.mark.parametrize("which", ["first", "second"])
def test_a_map_whose_cells_are_in_no_region_is_named(engine: str, which: str) -> None:
    if engine == "certified":
        pytest.importorskip("numba")
    maps = [parabola(shift, engine=engine) for shift in ("1/2", "1/3")]
    place = ("first", "second").index(which)
    maps[place] = replace(maps[place], regions=maps[place].regions[:1])
    with pytest.raises(ConfigError, match="contradicts itself") as caught:
        maps[0].compare(maps[1])
    assert caught.value.key == which
