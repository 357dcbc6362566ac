"""Units that a record declares: axes, areas and stored results name them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml
from jsonschema import Draft202012Validator

import ptmcad
from ptmcad.ask.quantities import quantity, unit_of
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.model import ptm
from ptmcad.question.config import slice_from
from ptmcad.show.report.reportpage import page
from ptmcad.show.units import area_unit, energy_unit, unit

ROOT = Path(__file__).resolve().parents[2]
RECORD = yaml.safe_load("""
axes: {rho: [0, 2], L2: [0, 2]}
parameters: {F3: -10, F4: -10}
units: {length: mm, force: N}
""")


@pytest.mark.parametrize(
    ("axes", "units", "expected"),
    [
        ({"k": [50, 200], "F3": [-10, 0]}, {"length": "mm", "force": "N"}, ("N/mm", "N", "N/mm·N")),
        (
            {"k": [50, 200], "k1": [50, 200]},
            {"length": "m", "force": "kN"},
            ("kN/m", "kN/m", "(kN/m)²"),
        ),
        ({"L2": [0, 2], "F3": [-10, 0]}, {"length": "mm"}, ("mm", "force", "")),
        ({"L2": [0, 2], "rho": [0, 2]}, {}, ("length", "length", "")),
    ],
)
def test_derived_units(
    axes: dict[str, list[int]], units: dict[str, str], expected: tuple[str, str, str]
) -> None:
    slice = slice_from({"axes": axes, "units": units})
    assert (unit(slice, 0), unit(slice, 1), area_unit(slice)) == expected


@pytest.mark.parametrize(
    ("stiffness", "spring", "expected"),
    [("2*c", "k", "N·mm"), ("c", "k", "N·mm"), ("c*L^2", "k", "N/mm"), ("c", "c", "N/mm")],
)
def test_a_torsion_springs_stiffness_is_a_moment(
    stiffness: str, spring: str, expected: str
) -> None:
    """Unless a length makes one of it, or a spring between points has it, too."""
    record = {
        "mechanism": {
            "parameters": {
                "L": {"kind": "length"},
                **{name: {"kind": "stiffness", "default": 1} for name in "kc"},
            },
            "unknowns": {"th": "angle"},
            "points": {"A": [0, 3], "P": ["L*cos(th)", "L*sin(th)"]},
            "springs": [{"between": ["A", "P"], "k": spring}, {"between": ["A", "P"], "k": "k/9"}],
            "torsion": [{"angle": "th", "k": stiffness}],
        },
        "axes": {"L": [1, 2], "c": [1, 2]},
        "units": {"length": "mm", "force": "N"},
    }
    slice = slice_from(record)
    assert (unit(slice, 0), unit(slice, 1)) == ("mm", expected)
    assert area_unit(slice) == f"mm·{expected}"


def test_stored_results_keep_units_and_match_the_schemas() -> None:
    result = ptmcad.classify(RECORD)
    text = result.to_json()
    assert ptmcad.RegionMap.from_json(text).slice.units == {"length": "mm", "force": "N"}
    schema = json.loads((ROOT / "docs" / "region-map.schema.json").read_text())
    Draft202012Validator(schema).validate(json.loads(text))
    Draft202012Validator(json.loads((ROOT / "ptmcad" / "record.schema.json").read_text())).validate(
        RECORD
    )
    bare = ptmcad.classify({key: value for key, value in RECORD.items() if key != "units"})
    assert "units" not in json.loads(bare.to_json())["slice"]


@pytest.mark.parametrize(
    ("units", "expected"),
    [
        ({"length": "mm", "force": "N"}, ["N·mm", "N", "mm", "degrees"]),
        ({"length": "mm"}, ["force × mm", "force", "mm", "degrees"]),
        ({"force": "N"}, ["N × length", "N", "length", "degrees"]),
        ({}, ["force × length", "force", "length", "degrees"]),
    ],
)
def test_units_of_quantities(units: dict[str, str], expected: list[str]) -> None:
    slice = slice_from({**RECORD, "units": units})
    names = ("energy", "force:k1", "length:k1", "th1")
    assert [unit_of(quantity(slice.model, name), slice) for name in names] == expected


@pytest.mark.parametrize(
    ("units", "words"),
    [
        ({"lenght": "mm"}, "length"),
        ("mm", "mapping"),
        ({"length": "x" * 30}, "20"),
        ({"force": ""}, "short text"),
        ({"force": "-2.5"}, "short text"),
    ],
)
def test_bad_units_are_refused(units: object, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        slice_from({**RECORD, "units": units})


LIFT = """
name: lift
mechanism:
  parameters: {b: {kind: base, default: 2}, r: {kind: length}, k: {kind: stiffness, default: 5}, P: {kind: force}}
  unknowns: {alpha: angle, x: length}
  points: {O: [0, 0], S: [x, 0], E: [r*cos(alpha), r*sin(alpha)], W: [b, 0]}
  bars: [[O, E]]
  springs: [{between: [E, S], k: k}, {between: [S, W], k: k}]
  supports: {O: pin, S: slider x, W: pin}
  loads: {E: {weight: P}}
units: {length: m, force: kN}
axes: {P: [0, 6], b: [1, 3]}
parameters: {r: 1}
count: stable
"""
SVG_TEXT = "{http://www.w3.org/2000/svg}text"


def solved(record: Path, formats: str) -> None:
    asked = [
        "solve",
        str(record),
        "--at",
        "P=2,b=2",
        "--format",
        formats,
        "--landscape",
        "--out",
        str(record.parent),
    ]
    assert run(asked) == 0


def words_of(picture: Path) -> set[str]:
    """The texts of an SVG file."""
    return {node.text or "" for node in ElementTree.parse(picture).iter(SVG_TEXT)}


def data_of(result: ptmcad.RegionMap) -> dict[str, Any]:
    """What the page's script reads."""
    (text,) = re.findall(r'<script[^>]*id="data"[^>]*>(.*?)</script>', page(result), re.DOTALL)
    found: dict[str, Any] = json.loads(text)
    return found


def test_poses_their_pictures_and_the_landscape_have_the_declared_units(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = tmp_path / "lift.yaml"
    record.write_text(LIFT)
    solved(record, "table,json,svg")
    said = " ".join(capsys.readouterr().out.split())
    assert (
        "units lengths and coordinates in m, forces in kN, energies and the Hessian's eigenvalues in kN·m"
        in said
    )
    text = (tmp_path / "poses.json").read_text(encoding="utf-8")
    poses = ptmcad.Poses.from_json(text)
    assert poses.units == {"length": "m", "force": "kN"} and poses.to_json() == text
    schema = json.loads((ROOT / "docs" / "poses.schema.json").read_text(encoding="utf-8"))
    Draft202012Validator(schema).validate(json.loads(text))
    assert {"U: energy, in kN·m", "length 1 m"} <= words_of(tmp_path / "poses.svg")
    assert {"x (m)", "U (kN·m)"} <= words_of(tmp_path / "poses-landscape.svg")


def test_without_declared_units_words_stand_for_them(tmp_path: Path) -> None:
    record = tmp_path / "lift.yaml"
    record.write_text(LIFT.replace("units: {length: m, force: kN}", ""))
    solved(record, "json,svg")
    assert "units" not in json.loads((tmp_path / "poses.json").read_text(encoding="utf-8"))
    assert {"x (length)", "U (force · length)"} <= words_of(tmp_path / "poses-landscape.svg")
    assert energy_unit(ptm(), {"force": "kN"}) == "kN · length"


def test_the_page_has_the_declared_units_of_its_tables() -> None:
    found = data_of(ptmcad.classify(RECORD))["units"]
    assert found == {"length": "mm", "force": "N", "energy": "N·mm", "unknowns": ["", ""]}
    lift = ptmcad.classify(yaml.safe_load(LIFT), areas=False)
    assert data_of(lift)["units"]["unknowns"] == ["", "m"]


def test_the_page_names_the_units_of_areas_and_axes() -> None:
    found = ptmcad.classify(ptmcad.slice_from_mapping(yaml.safe_load("""
        axes: {rho: [0, 2], F3: [-20, 0]}
        parameters: {L2: 3/2, F4: -10}
        units: {length: mm, force: N}
    """)))  # fmt: skip
    text = page(found)
    assert "area (N·mm)" in text
    assert "ρ from 0 to 2 mm; F₃ from -20 to 0 N" in text
