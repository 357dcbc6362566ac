"""``ptmcad mechanisms`` and ``ptmcad init``: what is listed can be named, and what is written runs
as it is.
"""

from __future__ import annotations

from collections import Counter
from math import pi
from pathlib import Path
from xml.etree import ElementTree

import pytest

from ptmcad import RegionMap, classify, load, slice_from_mapping
from ptmcad.cli import run
from ptmcad.cli.mechanisms import starter_model
from ptmcad.model import Mechanism, ptm
from ptmcad.question.config.starters import NAMES

# known by construction, see `pendulum` below; of a cubic 4 a^3 = 27 b^2: 2 * integral of
# sqrt(4 a^3/27) from 0 to 2
STABLE = {"ptm": {1, 2}, "pendulum": {1, 2}, "chain": {1, 2}, "platform": {1, 2}, "cusp": {1, 3}}
AREAS = {"pendulum": 3 * pi / 8, "cusp": 2 * (4 / 27) ** 0.5 * 2**2.5 * 2 / 5, "ptm": 0.7463806752}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.slow_cases("ptm", "platform", "chain")
def test_what_init_writes_runs_as_it_is(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.yaml"
    assert run(["init", name, "--out", str(path)]) == 0
    assert run(["check", str(path)]) == 0
    result = classify(load(path), area_tolerance="1e-4" if name in AREAS else "1/2")
    counts = [region.total if name == "cusp" else region.stable for region in result.regions]
    assert set(counts) == STABLE[name]
    if name in AREAS:
        found = [
            region
            for region, count in zip(result.regions, counts, strict=True)
            if count == max(STABLE[name])
        ]
        assert float(sum(region.area[0] for region in found)) == pytest.approx(
            AREAS[name], rel=1e-3
        )
    before = path.read_text(encoding="utf-8")
    capsys.readouterr()
    assert run(["init", name, "--out", str(path)]) == 2
    assert "is there already" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == before
    assert run(["init", name]) == 0
    assert capsys.readouterr().out.replace("THIS-FILE", "mine.yaml") == before


def test_a_record_names_a_built_in_mechanism() -> None:
    """And the result holds its description, which another version may have changed."""
    slice = slice_from_mapping(
        {"mechanism": "pendulum", "axes": {"H": ["-3/2", "3/2"], "W": [0, 1]}}
    )
    assert slice.model == starter_model("pendulum")
    again = RegionMap.from_json(classify(slice).to_json())
    assert again.slice == slice
    assert again.slice.model.source["springs"]
    assert starter_model("ptm") is ptm()


def test_all_are_listed_with_a_drawing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["mechanisms", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    for name in NAMES:
        model = starter_model(name)
        assert f"{name}\n  unknowns" in out
        assert all(f" {parameter}" in out for parameter in model.parameters)
        if isinstance(model, Mechanism):
            text = (tmp_path / f"{name}.svg").read_text(encoding="utf-8")
            root = ElementTree.fromstring(text)
            parts = Counter(str(group.get("id")).partition("-")[0] for group in root.iter())
            assert parts["bar"] == len(model.bars) and parts["spring"] == len(model.springs)
            assert parts["node"] == len(model.points)
    assert run(["mechanisms", "pendulun"]) == 2
    assert "did you mean 'pendulum'?" in capsys.readouterr().err


def test_a_mechanism_by_an_option(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """By name, or in a file anywhere: a description, or a record with one."""
    window = ["--slice", "H,W", "--range", "H=-3/2:3/2", "--range", "W=-3/2:3/2"]
    path = tmp_path / "mine.yaml"
    assert run(["init", "pendulum", "--out", str(path)]) == 0
    for mechanism in ("pendulum", str(path)):
        arguments = ["--mechanism", mechanism, "--out", str(tmp_path), "--format", "json"]
        assert run(["classify", *window, *arguments]) == 0
        assert "2: 1.1781" in capsys.readouterr().out
    assert run(["classify", str(path), "--mechanism", "pendulum"]) == 2
    assert "--mechanism: the record says which" in capsys.readouterr().err
    assert run(["classify", *window, "--mechanism", "pendulun"]) == 2
    assert "--mechanism: unknown mechanism; did you mean 'pendulum'?" in capsys.readouterr().err


def test_indices_of_one_angle_are_listed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.yaml"
    assert run(["init", "pendulum", "--out", str(path)]) == 0
    assert (
        run(["classify", str(path), "--count", "index", "--format", "json", "--out", str(tmp_path)])
        == 0
    )
    assert "(2, 2)" in capsys.readouterr().out


def test_a_missing_folder_is_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "new" / "folder" / "mine.yaml"
    assert run(["init", "--out", str(path)]) == 0
    assert path.read_text(encoding="utf-8")
    capsys.readouterr()
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert run(["init", "--out", str(tmp_path / "file" / "mine.yaml")]) == 2
    assert f"the folder {tmp_path / 'file'} cannot be made" in capsys.readouterr().err
