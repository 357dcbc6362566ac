"""A line of the plane on which there are infinitely many solutions is named as that by every
command.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import ptmcad
from ptmcad.cli import run

DOCS = Path(__file__).resolve().parents[2] / "docs"

BALANCER = """
name: balancer
mechanism:
  parameters: {k: {kind: stiffness}, W: {kind: force, default: 1}}
  unknowns: {th: angle}
  points: {O: [0, 0], A: [0, 1], Q: [sin(th)/2, cos(th)/2], P: [2*sin(th), 2*cos(th)]}
  bars: [[O, P]]
  supports: {O: pin, A: pin}
  springs: [{between: [A, Q], k: k}]
  loads: {P: {weight: W}}
axes: {k: [1, 8], W: [0, 2]}
count: stable
"""
"""The energy is (2 W - k/2) cos th and a constant: at k = 4 W every pose is in balance."""

PAIR = """
name: pair
system:
  parameters: {a: {}, b: {}}
  unknowns: {p: angle, q: angle}
  potential: (a - b)*cos(p) + cos(q)
axes: {a: [-1, 2], b: [-1, 1]}
"""
"""At a = b the potential depends on q alone, which is 0 or half a turn, with any p."""

CHAIN = """
name: chain
mechanism:
  parameters: {k: {kind: stiffness}, W: {kind: force, default: 1}}
  unknowns: {a: angle, b: angle}
  points:
    O: [0, 0]
    C: [0, 1]
    A: [sin(a)/2, cos(a)/2]
    P: [2*sin(a), 2*cos(a)]
    B: [2*sin(a) + sin(b), 2*cos(a) + cos(b)]
  bars: [[O, P], [P, B]]
  supports: {O: pin, C: pin}
  springs: [{between: [C, A], k: k}, {between: [O, B], k: 1}]
  loads: {P: {weight: W}}
axes: {k: [1, 8], W: [0, 2]}
count: stable
"""
"""The balancer with a second bar that a spring pulls to the pivot: at k = 4 W both turn together.
"""

PRODUCT = """
name: product
system:
  parameters: {a: {}, b: {}}
  unknowns: {p: real, q: real}
  equations: ["p^2 + q^2 - a", "(a - b)*p + b*(p^2 + q^2 - a)"]
axes: {a: ["1/2", 2], b: ["-1/2", "-1/4"]}
"""


def written(record: str, folder: Path) -> Path:
    path = folder / "record.yaml"
    path.write_text(record, encoding="utf-8")
    return path


def classified(record: str, folder: Path) -> dict[str, Any]:
    assert (
        run(
            [
                "classify",
                str(written(record, folder)),
                "--out",
                str(folder / "map"),
                "--format",
                "json,svg",
            ]
        )
        == 0
    )
    (path,) = (folder / "map").glob("*.json")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(
        json.loads((DOCS / "region-map.schema.json").read_text(encoding="utf-8"))
    ).validate(found)
    return found


@pytest.mark.parametrize(
    ("record", "line", "at"),
    [
        (BALANCER, "k - 4*W", {"k": "4", "W": "1"}),
        (CHAIN, "k - 4*W", {"k": "4", "W": "1"}),
        (PAIR, "a - b", {"a": "1/2", "b": "1/2"}),
    ],
    ids=["one angle", "two angles that turn together", "one of two angles"],
)
def test_every_command_names_the_line(
    record: str, line: str, at: dict[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    many = "infinitely many solutions" if record is PAIR else "infinitely many equilibria"
    document = classified(record, tmp_path)
    assert f"continua  {many} where {line} = 0" in capsys.readouterr().out
    assert [
        c["polynomial"] for c in document["components"] if c.get("continuum") == "infinitely many"
    ] == [line]
    (path,) = (tmp_path / "map").glob("*.json")
    (picture,) = (tmp_path / "map").glob("*.svg")
    assert many in picture.read_text(encoding="utf-8")
    assert run(["verify", str(path)]) == 0
    place = ",".join(f"{name}={value}" for name, value in at.items())
    capsys.readouterr()
    assert run(["locate", str(path), "--at", place]) == 0
    assert f"remark  {many}" in capsys.readouterr().out.splitlines()
    (along, _), (fixed, value) = at.items()
    asked = ["range", str(written(record, tmp_path)), "--along", along, "--at", f"{fixed}={value}"]
    assert run([*asked, "--format", "json", "--out", str(tmp_path / "line")]) == 0
    assert "infinitely many equilibria" in capsys.readouterr().out
    (ranges,) = (tmp_path / "line").glob("*.json")
    found = json.loads(ranges.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(
        json.loads((DOCS / "range.schema.json").read_text(encoding="utf-8"))
    ).validate(found)
    assert [c.get("continuum") for c in found["line"]["changes"]] == ["infinitely many"]
    assert run(["solve", str(written(record, tmp_path)), "--at", place]) == 3
    told = capsys.readouterr()
    assert "infinitely many equilibria" in told.out and "complex" not in told.out


@pytest.mark.parametrize("many", ["infinitely many", "perhaps infinitely many"])
def test_a_forged_line_is_not_accepted(many: str, tmp_path: Path) -> None:
    """With a load across, both poses stay isolated on every line."""
    record = BALANCER.replace("P: {weight: W}", "P: [1, W]")
    classified(record, tmp_path)
    (path,) = (tmp_path / "map").glob("*.json")
    document = json.loads(path.read_text(encoding="utf-8"))
    assert document["components"] and not any("continuum" in c for c in document["components"])
    document["components"][0]["continuum"] = many
    path.write_text(json.dumps(document), encoding="utf-8")
    assert run(["verify", str(path)]) == 1


def test_complex_solutions_are_not_said_to_be_real(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """p^2 + q^2 = -1 has none but complex solutions, infinitely many of them."""
    record = """
name: circle
system:
  parameters: {a: {}, b: {}}
  unknowns: {p: real, q: real}
  equations: ["p^2 + q^2 + a + b", "p^2 + q^2 + 1"]
axes: {a: [0, 2], b: [0, 1]}
"""
    assert run(["solve", str(written(record, tmp_path)), "--at", "a=1,b=0"]) == 3
    assert "infinitely many solutions, complex ones included" in capsys.readouterr().out


def test_equations_that_depend_on_each_other_on_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """At a = b each solution of the first equation is one of both: perhaps infinitely many, as is
    said.
    """
    classified(PRODUCT.replace('["-1/2", "-1/4"]', '["3/4", 1]'), tmp_path)
    assert "perhaps infinitely many solutions where a - b = 0" in capsys.readouterr().out
    (path,) = (tmp_path / "map").glob("*.json")
    true = path.read_text(encoding="utf-8")
    assert run(["verify", str(path)]) == 0
    # at points of the other components there are finitely many
    document = json.loads(true)
    others = [c for c in document["components"] if "continuum" not in c]
    assert others
    for component in others:
        component["continuum"] = "perhaps infinitely many"
        path.write_text(json.dumps(document), encoding="utf-8")
        assert run(["verify", str(path)]) == 1
        del component["continuum"]


FOUR_BAR = """
name: four-bar
mechanism:
  parameters: {r2: {kind: length}, M: {kind: number}}
  unknowns: {t2: angle, t4: angle}
  points: {O: [0, 0], Q: [3, 0], A: [r2*cos(t2), r2*sin(t2)], B: [3 + 3.672*cos(t4), 3.672*sin(t4)]}
  bars: [[O, A], [Q, B]]
  closing: [{between: [A, B], length: 3.71}]
  supports: {O: pin, Q: pin}
  torsion: [{angle: t4, k: 1, rest: pi/2}]
  moments: {t2: M}
axes: {M: [-2, 2], r2: [3/4, 2]}
count: stable
"""
"""At M = 0 complex solutions leave to infinity; all four real ones stay."""


def test_points_on_a_curve_that_no_count_feels(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    classified(FOUR_BAR, tmp_path)
    (path,) = (tmp_path / "map").glob("*.json")
    capsys.readouterr()
    here, beside = (
        ptmcad.RegionMap.from_json(path.read_text(encoding="utf-8")).locate(M=m, r2=1)
        for m in ("0", "1/1000")
    )
    assert (here.status.value, here.total, here.stable) == ("exact", 4, 2)
    assert (here.region, here.cell) == (beside.region, None)
    assert run(["locate", str(path), "--at", "M=0,r2=1"]) == 0
    assert "counted at the point itself" in capsys.readouterr().out
    assert [
        pose.stable for pose in ptmcad.solve(written(FOUR_BAR, tmp_path), M=0, r2=1).equilibria
    ].count(True) == 2


def test_paths_start_at_such_a_point(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record = str(written(FOUR_BAR, tmp_path))
    assert run(["range", record, "--along", "M", "--at", "r2=1", "--path", "0"]) == 0
    told = capsys.readouterr().out
    assert "solution 1 at M = 0" in told and "solution 2 at M = 0" in told
    # at a fold a pose is degenerate: there no path starts
    system = "{parameters: {a: {}, b: {}}, unknowns: {x: real}, equations: [x^2 - a - b]}"
    fold = f"name: fold\nsystem: {system}\naxes: {{a: [-1, 1], b: [-1, 1]}}\n"
    assert (
        run(["range", str(written(fold, tmp_path)), "--along", "a", "--at", "b=0", "--path", "0"])
        == 2
    )
    assert "critical value" in capsys.readouterr().err
