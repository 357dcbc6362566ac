"""Results as a notebook, a prompt and completion show them."""

from __future__ import annotations

import dataclasses
import functools
import inspect
import re
import subprocess
import sys
from fractions import Fraction
from html.parser import HTMLParser
from typing import Any

import pytest
import yaml
from support.certified_map import certified_map
from support.maps import CONFIGS, shipped

import ptmcad
from ptmcad.answer import METHODS, Method
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.text.enclosure import AlgebraicNumber

SCREEN = 200
CUBIC: dict[str, Any] = yaml.safe_load("""
name: cubic
system: {unknowns: {x: real}, equations: [x^3 - a*x + b + c*x^2]}
axes: {a: [-2, 2], b: [-2, 2]}
free: {c: [0, 3]}
""")


@functools.cache
def results() -> list[object]:
    slice = ptmcad.load(CONFIGS / "fig4.yaml")
    poses = ptmcad.solve(rho="1", L2="3/2")
    line = {"L2": "3/2"}
    return [
        slice, slice.model, shipped("fig4"), certified_map(), poses, poses.equilibria[0],
        ptmcad.verify(shipped("fig2")), ptmcad.slice_variety(slice),
        shipped("fig4").boundaries("1/10")[0], shipped("fig4").grid(5),
        shipped("fig4").field("energy", columns=5),
        ptmcad.intervals(slice, "rho", line), ptmcad.pose_paths(slice, "rho", line, "1"),
    ]  # fmt: skip


ONE_LINE = {
    "AlgebraicNumber", "Boundary", "Change", "ClosedMechanism", "Count", "Counts", "Enclosure", "Location",
    "Mechanism", "Member", "Pose", "Slice", "System",
}  # fmt: skip
"""What is answered in a line at the prompt, which is what a notebook shows of it too."""
NO_RESULTS = {"Any", "DataFrame", "Explorer", "Iterator", "None", "Point"}
"""Not of ptmcad's, or a widget, or a tuple of numbers."""


def returned() -> set[str]:
    """The names of all classes that are public, or that a public function or method says it
    returns.
    """
    methods = [method for methods in METHODS.values() for method in methods.values()]
    homes = [Method(method) if isinstance(method, str) else method for method in methods]
    functions = [home.function if isinstance(home, Method) else home for home in homes]
    public = [getattr(ptmcad, name) for name in ptmcad.__all__]
    names = {found.__name__ for found in public if isinstance(found, type)} | set(METHODS)
    for found in (*functions, *(f for f in public if inspect.isfunction(f))):
        annotation = inspect.signature(found).return_annotation
        names |= set(re.findall(r"[A-Z]\w+", str(annotation)))
    return names - NO_RESULTS


@pytest.fixture(scope="module", name="everything")
def every_kind(tmp_path_factory: pytest.TempPathFactory) -> list[object]:
    slice = ptmcad.load(CONFIGS / "fig4.yaml")
    changed = ptmcad.family(CUBIC, values=[0, 1], areas=False, changes=True)
    lengths = yaml.safe_load("""
        mechanism: ptm
        parameters: {L1: a}
        axes: {L2: [1, 2], rho: [1, 2]}
        sweep: {a: [1]}
    """)
    swept = ptmcad.sweep(
        lengths,
        tmp_path_factory.mktemp("sweep"),
        jobs=1,
        wanted={"areas": False},
    )
    circle = {"unknowns": {"u": "real"}, "equations": ["u^2 - 1 + (x - a)^2 + (a - 1)^2"]}
    designed = ptmcad.design(
        {"system": circle, "axes": {"x": [-2, 4], "a": [0, 2]}}, "range", where={"stable": 2}
    )
    made = results()
    poses = ptmcad.solve(rho="1", L2="3/2")
    return [
        *made, ptmcad.operation_widths(slice, "rho", 2), changed, changed.changes, changed.changes.changes[0],
        changed.boundary_surface("1/20"),
        shipped("fig4").compare(shipped("fig4")), shipped("fig4").animate("rho=1/10:1/5,L2=1", "stable:1", 2), swept,
        swept[0], poses.equilibria[0].energy, ptmcad.counts_at(slice.model, rho="1", L2="3/2"), slice.count,
        shipped("fig4").locate(rho=1, L2=1), ptmcad.load(CONFIGS / "systems" / "duffing.yaml").model,
        ptmcad.load(CONFIGS / "mechanisms" / "slider-crank.yaml").model,
        ptmcad.intervals(slice, "rho", {"L2": "3/2"}).changes[0].at, designed,
    ]  # fmt: skip


def test_every_result_has_a_view_for_notebooks_and_fits_one_screen(
    everything: list[object],
) -> None:
    seen: set[str] = set()
    for result in everything:
        name = type(result).__name__
        seen.add(name)
        assert len(repr(result)) < 24 * 80 and repr(result).count("\n") < 24, name
        if name in ONE_LINE:
            assert "\n" not in repr(result) and len(repr(result)) < SCREEN, repr(result)
        else:
            html = result._repr_html_()  # type: ignore[attr-defined]
            assert html.startswith("<"), name
            read(html)
    assert returned() <= seen, returned() - seen


def test_what_results_are_made_of_fits_one_screen_too(everything: list[object]) -> None:
    waiting, done = list(everything), set()
    while waiting:
        part = waiting.pop()
        if isinstance(part, tuple):
            waiting += part[:1]
        if type(part) in done or not dataclasses.is_dataclass(part):
            continue
        done.add(type(part))
        assert len(repr(part)) < 24 * 80, (type(part), len(repr(part)))
        waiting += [getattr(part, field.name) for field in dataclasses.fields(part)]
    assert {"Region", "Cell"} <= {kind.__name__ for kind in done}


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
    assert [(r[1], r[2], r[-1]) for r in rows[1:]] == [
        ("1", "varies", "3.2536"),
        ("2", "6", "0.7464"),
    ]
    svg, png = shipped("fig4")._repr_svg_(), shipped("fig4")._repr_png_()
    assert svg is not None
    assert "<svg" in svg
    assert png is not None
    assert png.startswith(b"\x89PNG")


def test_a_map_without_cells_has_no_picture() -> None:
    whole = shipped("fig2")
    empty = RegionMap(
        slice=whole.slice, status=Status.PARTIAL, system=whole.system, undetermined=1, versions={}
    )  # type: ignore[arg-type]
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


def test_public_names_are_listed_before_they_are_loaded() -> None:
    program = "import ptmcad; assert dir(ptmcad) == sorted(ptmcad.__all__); assert 'classify' in dir(ptmcad)"
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.parametrize("name", ptmcad.__all__)
def test_public_names_exist(name: str) -> None:
    assert getattr(ptmcad, name) is not None


def test_answers_about_lines_and_comparisons_are_shown(everything: list[object]) -> None:
    by_name: dict[str, Any] = {type(result).__name__: result for result in everything}
    for name in ("CountIntervals", "PosePaths", "OperationWidths", "VerifyReport"):
        assert by_name[name]._repr_html_().startswith("<pre>")
    html = by_name["Comparison"]._repr_html_()
    assert "data:image/png" in html
    assert "the same counts everywhere" in html


def test_a_number_without_a_root_in_its_interval_is_shown_all_the_same() -> None:
    # a damaged file may say so, and bisection would go on for ever
    assert repr(AlgebraicNumber((-2, 0, 1), Fraction(3), Fraction(4))).startswith(
        "<AlgebraicNumber "
    )
    assert repr(AlgebraicNumber((0, 0, -1, 1), Fraction(-1, 2), Fraction(1, 2))).startswith(
        "<AlgebraicNumber "
    )
    assert "1.414213562" in repr(AlgebraicNumber((-2, 0, 1), Fraction(1), Fraction(2)))
