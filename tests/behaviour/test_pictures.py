"""Pictures say nothing false: what is undetermined is seen as that, a label stands on what it
names, lines are those of stability. Read from the files that the commands write: fills, outlines
and texts of an SVG.
"""

from __future__ import annotations

import csv
import re
import xml.etree.ElementTree as ET
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from matplotlib.path import Path as Curve
from support.maps import CONFIGS
from support.records import TRUSS

from ptmcad.cli import run

GREY = "#c4c4c4"
_NUMBER = r"-?[0-9.]+(?:e-?[0-9]+)?"


def texts(picture: Path) -> list[str]:
    """All texts of an SVG, in order."""
    return [
        "".join(node.itertext()).strip()
        for node in ET.parse(picture).iter()
        if node.tag.endswith("}text")
    ]


def group(picture: Path, name: str) -> ET.Element:
    """The group with this name."""
    return next(node for node in ET.parse(picture).iter() if node.get("id") == name)


def groups(picture: Path, pattern: str) -> list[str]:
    """The names of groups that a pattern matches."""
    return [
        name
        for node in ET.parse(picture).iter()
        if re.fullmatch(pattern, name := node.get("id", ""))
    ]


def paths(node: ET.Element) -> list[ET.Element]:
    return [each for each in node.iter() if each.tag.endswith("}path")]


def fill(path: ET.Element) -> str:
    return next(iter(re.findall(r"fill: ?(#[0-9a-f]+|none)", path.get("style", ""))), "#000000")


def outline(path: ET.Element) -> Curve:
    """The outline of a path of straight lines, each part of it closed."""
    points: list[tuple[float, float]] = []
    codes: list[Any] = []
    for part in path.get("d", "").split("M")[1:]:
        numbers = [float(number) for number in re.findall(_NUMBER, part)]
        corners = [*zip(numbers[::2], numbers[1::2], strict=True)]
        points += [*corners, corners[0]]
        codes += [
            int(Curve.MOVETO),
            *[int(Curve.LINETO)] * (len(corners) - 1),
            int(Curve.CLOSEPOLY),
        ]
    return Curve(points, codes)


def box(path: ET.Element) -> np.ndarray:
    """The corners and the middle of what a path covers."""
    numbers = [float(n) for n in re.findall(_NUMBER, path.get("d", ""))]
    x, y = numbers[::2], numbers[1::2]
    sides = [(u, v) for u in (min(x), max(x)) for v in (min(y), max(y))]
    return np.array([*sides, ((min(x) + max(x)) / 2, (min(y) + max(y)) / 2)])


@pytest.fixture(scope="module")
def truss(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A certified map of which 8 % are undetermined."""
    folder = tmp_path_factory.mktemp("truss")
    (folder / "truss.yaml").write_text(yaml.safe_dump({"name": "truss", **TRUSS}))
    options = [
        "--engine",
        "certified",
        "--tolerance",
        "1/10",
        "--format",
        "json,svg",
        "--out",
        str(folder),
    ]
    assert run(["classify", str(folder / "truss.yaml"), *options]) == 0
    return folder


def test_pixels_that_are_undetermined_are_said_to_be_so(
    truss: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = [
        "map",
        str(truss / "truss.json"),
        "--value",
        "energy",
        "--checks",
        "2",
        "--pixels",
        "12",
        "--out",
    ]
    assert run([*asked, str(truss), "--format", "svg"]) == 0
    assert re.search(r"of the pixels; [0-9.]+ % undetermined", capsys.readouterr().out)
    found = texts(truss / "truss-energy-stable-1.svg")
    assert "undetermined" in found
    assert "no stable pose 1" not in found  # each determined pixel has one
    assert run([*asked, str(truss), "--format", "svg", "--pose", "stable:2"]) == 0
    found = texts(truss / "truss-energy-stable-2.svg")
    assert "undetermined" in found and "no stable pose 2" in found


def test_a_barrier_that_is_not_there_is_no_missing_pose(tmp_path: Path) -> None:
    asked = [
        "map",
        str(CONFIGS / "fig4.yaml"),
        "--value",
        "barrier",
        "--checks",
        "2",
        "--pixels",
        "6",
    ]
    assert run([*asked, "--format", "svg", "--out", str(tmp_path)]) == 0
    found = texts(tmp_path / "fig4-barrier-stable-1.svg")
    assert "no barrier" in found and "undetermined" not in found


def test_what_is_undetermined_is_seen_in_its_grey_over_its_rims(truss: Path) -> None:
    """It is drawn after the regions and their rims, and with a line of its own, so that no rim
    hides it.
    """
    picture = truss / "truss.svg"
    names = groups(picture, r"region-\d+|edges")
    assert names[-1] == "edges"
    grey = paths(group(picture, "edges"))[0]
    wide = float(re.findall(r"stroke-width: ?([0-9.]+)", grey.get("style", ""))[0])
    assert fill(grey) == GREY and f"stroke: {GREY}" in grey.get("style", "")
    for name in names[:-1]:
        style = paths(group(picture, name))[0].get("style", "")
        assert float(re.findall(r"stroke-width: ?([0-9.]+)", style)[0]) > wide >= 0.5


@pytest.mark.parametrize("style", ["default", "ieee", "elsevier", "springer", "beamer", "poster"])
@pytest.mark.parametrize("name", ["fig3", "fig4", "fig5-text"])
@pytest.mark.fast_cases("fig3-default", "fig4-ieee")
def test_a_label_stands_on_a_region_of_its_own_count(name: str, style: str, tmp_path: Path) -> None:
    options = ["--format", "svg", "--style", style, "--no-areas", "--out", str(tmp_path)]
    assert run(["classify", str(CONFIGS / f"{name}.yaml"), *options]) == 0
    picture = tmp_path / f"{name}.svg"
    regions = {
        region: paths(group(picture, region))[0] for region in groups(picture, r"region-\d+")
    }
    arrows = groups(picture, r"arrow-\d+")
    assert arrows
    for arrow in arrows:
        label = next(path for path in paths(group(picture, arrow)) if fill(path) == "#ffffff")
        own = fill(regions[arrow.replace("arrow", "region")])
        for corner in box(label):
            assert [
                fill(path) for path in regions.values() if outline(path).contains_point(corner)
            ] == [own]


SWEPT = """
name: swept
parameters: {L1: 1, k: 100, F3: F, F4: F}
axes: {rho: [0, 2], L2: [0, 2]}
sweep: {F: [0, -10]}
count: stable
"""


def test_an_atlas_is_headed_by_what_all_members_have_in_common(tmp_path: Path) -> None:
    (tmp_path / "swept.yaml").write_text(SWEPT)
    folder = tmp_path / "out"
    asked = [
        "sweep",
        str(tmp_path / "swept.yaml"),
        "--no-ranges",
        "--no-areas",
        "--jobs",
        "1",
        "--format",
        "html",
    ]
    assert run([*asked, "--out", str(folder)]) == 0
    assert "<h1>L₁ = 1, k = 100</h1>" in (folder / "swept.html").read_text(encoding="utf-8")


def test_bounds_of_an_area_are_the_same_everywhere_and_what_is_proved(
    truss: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of regions alone with their counts: not more than the table of numbers proves, to two digits
    at least.
    """
    assert run(["plot", str(truss / "truss.json"), "--format", "csv", "--out", str(truss)]) == 0
    rows = list(csv.DictReader((truss / "truss-regions.csv").read_text().splitlines()))
    proved = {
        f"({row['index'].replace(' ', ', ')})": (row["area_low"], row["area_high"]) for row in rows
    }
    capsys.readouterr()
    assert run(["classify", str(truss / "truss.yaml"), "--engine", "certified", "--tolerance", "1/10", "--out",
                str(truss), "--format", "json"]) == 0  # fmt: skip
    table = capsys.readouterr().out
    legend = " ".join(texts(truss / "truss.svg"))
    assert len(proved) == len(rows)
    for count, bounds in proved.items():
        low, high = map(Fraction, bounds)
        shown = re.findall(rf"{re.escape(count)}: ([0-9.e-]+) to ([0-9.e-]+)", table)[0]
        assert f"area {' to '.join(shown)}" in legend
        assert 0 <= low - Fraction(shown[0]) <= max(low / 10, (high - low) / 100)
        assert 0 <= Fraction(shown[1]) - high <= (high - low) / 100


def lines(node: ET.Element) -> list[dict[str, str]]:
    """The styles of the lines below a node."""
    styles = [
        dict(re.findall(r"([a-z-]+): ?([^;]+)", path.get("style", ""))) for path in paths(node)
    ]
    return [style for style in styles if "stroke" in style and style.get("fill") == "none"]


def test_stable_branches_are_solid_and_no_others_are(tmp_path: Path) -> None:
    """In both pictures of a line; and no colour is that of a stable branch and of another."""
    asked = [
        "range",
        str(CONFIGS / "fig4.yaml"),
        "--along",
        "rho",
        "--at",
        "L2=3/2",
        "--format",
        "svg",
    ]
    assert run([*asked, "--path", "3/4", "--quantity", "th1", "--out", str(tmp_path)]) == 0
    solid: set[str] = set()
    broken: set[str] = set()
    for name, stable in (("fig4-range-path", r"pose \d at"), ("fig4-range-branches", "stable$")):
        keys = [
            text
            for text in texts(tmp_path / f"{name}.svg")
            if re.match(rf"{stable}|saddle|maximum", text)
        ]
        marks = [
            style
            for style in lines(ET.parse(tmp_path / f"{name}.svg").getroot())
            if style["stroke"] != "#111111"
        ]
        assert keys
        of_legend = marks[-len(keys) :]
        for text, style in zip(keys, of_legend, strict=True):
            is_stable = re.match(stable, text) is not None
            assert ("stroke-dasharray" not in style) == is_stable, text
            (solid if is_stable else broken).add(style["stroke"])
        drawn = {(style["stroke"], style.get("stroke-dasharray")) for style in of_legend}
        assert {
            (s["stroke"], s.get("stroke-dasharray")) for s in marks if s["stroke"] in solid | broken
        } == drawn
    assert len(solid) == 2 and not solid & broken


def test_names_have_greek_letters_in_all_of_a_picture_or_in_none(tmp_path: Path) -> None:
    """The record's title has rho and L1, as a keyboard has them."""
    record = CONFIGS / "forces.yaml"
    assert (
        run(["classify", str(record), "--no-areas", "--format", "json,svg", "--out", str(tmp_path)])
        == 0
    )
    assert "The two loads, L₁ = 1, L₂ = 3/2, ρ = 3/4, k = 100" in texts(tmp_path / "forces.svg")
    assert run(["report", str(tmp_path / "forces.json"), "--out", str(tmp_path)]) == 0
    page = (tmp_path / "forces.html").read_text(encoding="utf-8")
    assert "<dd>L₁ = 1, L₂ = 3/2, ρ = 3/4, k = 100; zero: F₃ₓ, F₄ₓ</dd>" in page
    names = {"omega1": [-1, 1], "Sigma": [0, 1]}
    system = {"unknowns": {"x": "real"}, "equations": ["x^2 - omega1 - Sigma"]}
    (tmp_path / "greek.yaml").write_text(
        yaml.safe_dump({"name": "greek", "system": system, "axes": names})
    )
    assert (
        run(
            [
                "classify",
                str(tmp_path / "greek.yaml"),
                "--no-areas",
                "--format",
                "svg",
                "--out",
                str(tmp_path),
            ]
        )
        == 0
    )
    assert {"ω₁", "Σ"} <= set(texts(tmp_path / "greek.svg"))


ARM = """
name: arm
mechanism:
  parameters: {mu_s: {kind: stiffness, default: 2}, k: {kind: stiffness}, W: {kind: force}}
  unknowns: {alpha_1: angle, beta: angle}
  points: {O: [0, 0], P: [sin(alpha_1), cos(alpha_1)], Q: [sin(alpha_1) + sin(beta), cos(alpha_1) + cos(beta)]}
  bars: [[O, P], [P, Q]]
  torsion: [{angle: alpha_1, k: mu_s}, {angle: beta - alpha_1, k: k, at: P}]
  loads: {Q: [0, -W]}
axes: {W: [0, 3], k: [1/2, 3]}
count: stable
"""
"""Upright under a small weight, with both angles 0, and hanging under a large one, with both at
half a turn.
"""


def test_half_a_turn_is_one_angle_and_its_symbol_stands_in_all_of_a_picture(tmp_path: Path) -> None:
    """Half a turn is 180 degrees at every pixel, never -180; names with an underscore have their
    letter, too.
    """
    record, out = tmp_path / "arm.yaml", ["--out", str(tmp_path)]
    record.write_text(ARM, encoding="utf-8")
    asked = ["map", str(record), "--pixels", "10", "--checks", "2", "--format", "svg,csv", *out]
    assert run([*asked, "--value", "angle:alpha_1"]) == 0
    rows = (
        (tmp_path / "arm-angle-alpha-1-stable-1.csv").read_text(encoding="utf-8").splitlines()[1:]
    )
    hanging = [float(row.split(",")[2]) for row in rows if float(row.split(",")[0]) > 2]
    assert hanging == pytest.approx([180] * (3 * 10))
    assert "angle α_1 (degrees)" in texts(tmp_path / "arm-angle-alpha-1-stable-1.svg")
    assert run([*asked, "--value", "cos(alpha_1)*mu_s"]) == 0
    assert "cos(α_1)*μ_s" in texts(tmp_path / "arm-cos-alpha-1-mu-s-stable-1.svg")
    assert run(["range", str(record), "--along", "W", "--at", "k=1", "--path", "1/2", "--quantity", "angle:alpha_1",
                "--format", "svg", *out]) == 0  # fmt: skip
    assert "angle α_1 (degrees)" in texts(tmp_path / "arm-range-branches.svg")
    # beyond W = 0.59 two other poses are stable, then the one that hangs
    assert "stable, not followed" in texts(tmp_path / "arm-range-path.svg")
