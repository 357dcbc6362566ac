"""Documents as version 0.1.0 wrote them, in tests/data, are read by every later version; and a map
with slanted pieces, of a later one.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from ptmcad.cli import run
from ptmcad.version import __version__

EARLIER = Path(__file__).resolve().parents[1] / "data" / "written-by-0.1.0"
MAPS = ["cubic", "family/cubics-c1_3", "truss", "slanted"]


@pytest.mark.parametrize(
    "name",
    [
        *MAPS,
        "two-waves-design",
        "family/cubics",
        "changes/cubics",
        "poses",
        "poses-free",
        "range",
        "range-free",
        "widths",
    ],
)
@pytest.mark.slow_cases("two-waves-design")
def test_an_earlier_document_is_verified(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", str(EARLIER / f"{name}.json")]) == 0
    assert "false" not in capsys.readouterr().out.lower()


@pytest.mark.parametrize("name", MAPS)
def test_an_earlier_map_answers_at_a_point(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    point = "a=3/2,F=1/4" if name == "truss" else "a=-1/2,b=0"
    assert run(["locate", str(EARLIER / f"{name}.json"), "--at", point]) == 0
    assert ["total", "1"] in [line.split() for line in capsys.readouterr().out.splitlines()]


@pytest.mark.parametrize("command", ["report", "plot"])
@pytest.mark.parametrize("name", MAPS)
def test_an_earlier_map_is_drawn(name: str, command: str, tmp_path: Path) -> None:
    assert run([command, str(EARLIER / f"{name}.json"), "--out", str(tmp_path)]) == 0
    assert any(path.stat().st_size for path in tmp_path.iterdir())


def test_what_another_version_left_undecided_is_not_false(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    point = "rho=1,L2=1,l0=1/2"  # where a pose is degenerate
    assert run(["solve", "--at", point, "--format", "json", "--out", str(tmp_path)]) == 3
    document = json.loads((path := tmp_path / "poses.json").read_text("utf-8"))
    versions = document.pop("versions")
    assert versions == {"ptmcad": __version__}
    document["undecided"] += 1
    for written, status in ((document, 0), (document | {"versions": versions}, 1)):
        path.write_text(json.dumps(written), "utf-8")
        capsys.readouterr()
        assert run(["verify", str(path)]) == status
        printed = capsys.readouterr().out
        assert ("another version made it" in printed) is (written is document)
        assert ("FALSE" in printed) is (written is not document)


def test_an_earlier_sweep_is_verified(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Where a width is attained its index does not say, and bounds that another version finds may
    be others.
    """
    folder = tmp_path / "grid"
    shutil.copytree(EARLIER / "sweep", folder)
    assert run(["verify", str(folder)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "1 claim holds, 3 not checked"


def test_an_earlier_sweep_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "grid"
    shutil.copytree(EARLIER / "sweep", folder)
    record = tmp_path / "grid.yaml"
    record.write_text(
        'name: grid\nsystem: {unknowns: {x: real}, equations: ["x^3 - a*x + b + c*a^2"]}\n'
        "axes: {a: [-1, 2], b: [-1, 1]}\nsweep: {c: [-1/2, 0, 1/3]}\n",
        encoding="utf-8",
    )
    before = {path: path.read_bytes() for path in folder.rglob("*.json")}
    assert run(["sweep", str(record), "--out", str(folder)]) == 0
    assert "3 done" in capsys.readouterr().out
    assert before == {path: path.read_bytes() for path in folder.rglob("*.json")}
