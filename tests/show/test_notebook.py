"""Results as a notebook, a prompt and completion show them."""

from __future__ import annotations

import subprocess
import sys
from html.parser import HTMLParser

import pytest
from support.certified_map import certified_map
from support.maps import CONFIGS, shipped

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status

SCREEN = 200


def results() -> list[object]:
    slice = ptmcad.load(CONFIGS / "fig4.yaml")
    poses = ptmcad.solve(rho="1", L2="3/2")
    line = {"L2": "3/2"}
    return [
        slice, slice.model, shipped("fig4"), certified_map(), poses, poses.equilibria[0],
        ptmcad.verify(shipped("fig2")), ptmcad.slice_variety(slice), shipped("fig4").components[0].polynomial,
        shipped("fig4").boundaries("1/10")[0], shipped("fig4").grid(5),
        shipped("fig4").field("energy", columns=5),
        ptmcad.intervals(slice, "rho", line), ptmcad.pose_paths(slice, "rho", line, "1"),
    ]  # fmt: skip


def test_every_result_is_a_line_at_the_prompt() -> None:
    for result in results():
        text = repr(result)
        assert text.startswith(f"<{type(result).__name__} ") or text.startswith(f"<{type(result).__name__}:"), text
        assert len(text) < SCREEN, text
        assert "\n" not in text


class Reader(HTMLParser):
    """The open tags and the cells of tables; fails where tags do not match."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.rows: list[list[str]] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag != "img":
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] in (["td"], ["th"]):
            self.rows[-1][-1] += data


def read(html: str) -> list[list[str]]:
    reader = Reader()
    reader.feed(html)
    assert not reader.open
    return reader.rows


def test_a_map_is_a_picture_and_a_table() -> None:
    html = shipped("fig4")._repr_html_()
    assert html.count("data:image/png;base64,") == 1
    assert "http" not in html
    rows = read(html)
    assert rows[0][:2] == ["region", "stable"]
    assert [(r[1], r[2], r[-1]) for r in rows[1:]] == [("1", "varies", "3.2536"), ("2", "6", "0.7464")]
    svg, png = shipped("fig4")._repr_svg_(), shipped("fig4")._repr_png_()
    assert svg is not None
    assert "<svg" in svg
    assert png is not None
    assert png.startswith(b"\x89PNG")


def test_a_certified_map_too() -> None:
    assert [r[1] for r in read(certified_map()._repr_html_())[1:]] == ["2", "1", "2"]


def test_a_map_without_cells_has_no_picture() -> None:
    whole = shipped("fig2")
    empty = RegionMap(slice=whole.slice, status=Status.PARTIAL, system=whole.system, undetermined=1, versions={})  # type: ignore[arg-type]
    assert (empty._repr_svg_(), empty._repr_png_()) == (None, None)
    assert "<img" not in empty._repr_html_()


def test_poses_are_a_table() -> None:
    rows = read(ptmcad.solve(rho="1", L2="3/2")._repr_html_())
    assert rows[0] == ["", "stable", "th1 (°)", "th2 (°)", "energy", "index"]
    assert [r[1] for r in rows[1:]] == ["yes", "yes", "no", "no", "no", "no"]
    assert rows[1][2:] == ["46.5675", "28.9550", "112.5", "0"]


def test_names_from_records_are_escaped() -> None:
    record = {
        "name": "m", "title": "<script>alert(1)</script>", "mechanism": "ptm",
        "axes": {"L2": [1, 2], "rho": [1, 2]},
    }  # fmt: skip
    html = ptmcad.classify(ptmcad.slice_from_mapping(record))._repr_html_()
    assert "<script" not in html
    assert "&lt;script&gt;" in html


def test_a_variety_is_its_text() -> None:
    html = ptmcad.slice_variety(ptmcad.load(CONFIGS / "fig2.yaml"))._repr_html_()
    assert html.startswith("<pre>")
    assert "critical" in html


def test_public_names_are_listed_before_they_are_loaded() -> None:
    program = "import ptmcad; assert dir(ptmcad) == sorted(ptmcad.__all__); assert 'classify' in dir(ptmcad)"
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.parametrize("name", ptmcad.__all__)
def test_public_names_exist(name: str) -> None:
    assert getattr(ptmcad, name) is not None


def test_answers_about_lines_and_comparisons_are_shown() -> None:
    slice, line = ptmcad.load(CONFIGS / "fig4.yaml"), {"L2": "3/2"}
    shown = [
        ptmcad.intervals(slice, "rho", line),
        ptmcad.pose_paths(slice, "rho", line, "1"),
        ptmcad.operation_widths(slice, "rho", 2),
        ptmcad.verify(shipped("fig2")),
    ]
    for answer in shown:
        assert getattr(answer, "_repr_html_")().startswith("<pre>")  # noqa: B009
    html = getattr(shipped("fig4").compare(shipped("fig4")), "_repr_html_")()  # noqa: B009
    assert "data:image/png" in html
    assert "the same counts everywhere" in html
