"""Families on the command line: their files, pictures and checks."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli import run
from ptmcad.show.document.familydocument import read_family

RECORD = """name: loads
title: Loads
axes: {rho: [0, 2], L2: [0, 2]}
parameters: {F3: F, F4: F}
free: {F: [-40, 0]}
members: [-40, -10]
"""
COARSE = ("--boundary-tolerance", "1/20")


@pytest.fixture(name="folder", scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("family")
    (folder / "loads.yaml").write_text(RECORD)
    arguments = [
        "classify",
        str(folder / "loads.yaml"),
        "--out",
        str(folder),
        "--format",
        "json,csv",
        "--no-areas",
    ]
    assert run([*arguments, *COARSE]) == 0
    return folder


def test_a_family_is_drawn_again(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [
        "plot",
        str(folder / "loads.json"),
        "--out",
        str(tmp_path),
        "--format",
        "svg",
        "--style",
        "beamer",
    ]
    assert run(arguments) == 0
    text = (tmp_path / "loads.svg").read_text()
    assert {path.name for path in tmp_path.iterdir()} == {"loads.svg", "loads-3d.svg"}
    assert "F = −40" in text
    assert "F = −10" in text
    capsys.readouterr()
    assert run(["plot", str(folder / "loads.json"), "--format", "csv"]) == 2
    assert run(["plot", str(folder / "loads.json"), "--at", "rho=1,L2=1"]) == 2
    assert "give a member's file" in capsys.readouterr().err


def test_another_map_under_a_members_name_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "swapped.json"
    data = json.loads((folder / "loads.json").read_text())
    data["members"][0]["file"] = data["members"][1]["file"]
    path.write_text(json.dumps(data))
    for command in ("verify", "plot"):
        assert run([command, str(path)]) == 2
        assert (
            "is not the member at F = -40 that swapped.json names: F3 is -10, not -40"
            in capsys.readouterr().err
        )


def test_numbers_alone_are_written_too(tmp_path: Path) -> None:
    (tmp_path / "cubics.yaml").write_text(
        "system: {unknowns: {x: real}, equations: [x^3 + a*x + b + c]}\n"
        "axes: {a: [-2, 2], b: [-2, 2]}\nfree: {c: [0, 3]}\nmembers: [0, 1]\n"
    )
    asked = ["--out", str(tmp_path / "out"), "--format", "csv", "--no-areas", *COARSE]
    assert run(["classify", str(tmp_path / "cubics.yaml"), *asked]) == 0
    assert len(list((tmp_path / "out").iterdir())) == 6


def test_two_free_parameters_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["classify", "--slice", "rho,L2", "--free", "F3=-10:-5", "--free", "F4=-3:-2"]) == 2
    assert (
        "--free: a family has one free parameter: `ptmcad sweep` goes through several"
        in capsys.readouterr().err
    )


def test_a_member_has_ranges(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for given in (["--set", "F=-10", "--at", "L2=1"], ["--at", "L2=1,F=-10"]):
        assert run(["range", str(folder / "loads.yaml"), "--along", "rho", *given]) == 0
        assert "0.2149411958 to 0.8034910267" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda data: data | {"format": "ptmcad-family/2"},
            "not 'ptmcad-family/1'; it needs a newer ptmcad",
        ),
        (lambda data: data | {"members": []}, "do not increase"),
        (lambda data: data | {"members": data["members"][::-1]}, "do not increase"),
        (
            lambda data: data | {"members": [{"value": "1", "file": "../loads-F-10.json"}]},
            "a file beside it",
        ),
        (lambda data: data | {"members": [{"value": "-1", "file": "none.json"}]}, "none.json"),
        (lambda data: data | {"free": {"name": "F"}}, "free lacks the key 'low'"),
        (lambda data: {k: v for k, v in data.items() if k != "title"}, "lacks the key 'title'"),
    ],
)
def test_damaged_families_are_refused(
    folder: Path, change: object, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "changed.json"
    path.write_text(json.dumps(change(json.loads((folder / "loads.json").read_text()))))  # type: ignore[operator]
    assert run(["verify", str(path)]) == 2
    assert message in capsys.readouterr().err


DISC = """name: disc
system: {unknowns: {u: real}, equations: ["u^2 - c + a^2 + b^2"]}
axes: {a: [-1, 1], b: [-1, 1]}
free: {c: [-1, 3]}
"""


@pytest.fixture(name="disc", scope="module")
def changing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("disc")
    (folder / "disc.yaml").write_text(DISC)
    wanted = ["--changes", "--members", "between", "--format", "json", "--no-areas"]
    assert run(["classify", str(folder / "disc.yaml"), "--out", str(folder), *wanted]) == 0
    return folder


def test_a_member_between_the_changes_and_the_changes_in_the_file(disc: Path) -> None:
    stored, files = read_family((disc / "disc.json").read_text())
    assert stored.changes is not None
    assert stored.changes.complete
    assert [change.value.text() for change in stored.changes] == ["0", "1", "2"]
    assert stored.values == stored.changes.between
    assert len(files) == 4
    asked = ptmcad.changes(disc / "disc.yaml")
    assert asked == stored.changes
    assert ptmcad.family(disc / "disc.yaml", "between", areas=False).changes == asked
    assert "exact" in ptmcad.family(disc / "disc.yaml", [1], areas=False, changes=True).table()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda found: found | {"complete": "yes"}, "changes.complete is not true or false"),
        (lambda found: found | {"between": found["between"][1:]}, "do not lie between"),
        (lambda found: found | {"between": [found["between"][0]] * 4}, "do not lie between"),
        (
            lambda found: found | {"found": [{"value": {"low": "0", "high": "1/10"}, "words": []}]},
            "not exact",
        ),
        (
            lambda found: found | {"others": [{"low": "1", "high": "0"}]},
            "lacks the key 'polynomial'",
        ),
        (lambda found: found | {"at_ends": [[], [3]]}, "is not a text"),
        (
            lambda found: {k: v for k, v in found.items() if k != "between"},
            "lacks the key 'between'",
        ),
    ],
)
def test_damaged_changes_are_refused(disc: Path, change: object, message: str) -> None:
    data = json.loads((disc / "disc.json").read_text())
    with pytest.raises(ValueError, match=message):
        read_family(json.dumps(data | {"changes": change(data["changes"])}))  # type: ignore[operator]


def test_changes_are_told_with_their_kind(
    disc: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    common = ["--out", str(tmp_path), "--format", "json", "--no-areas"]
    asked = ["classify", str(disc / "disc.yaml"), *common, "--members=1/2,2/3"]
    assert run([*asked, "--changes", "--set", "c=c"]) == 2
    capsys.readouterr()
    assert run([*asked, "--changes"]) == 0
    out = capsys.readouterr().out
    assert "changes of the arrangement for c between -1 and 3: 3" in out
    assert "  1  exact  the region of 0 solutions splits into 4" in out
    assert "proved by elimination: within the range nothing can change but at 3 values" in out
    monkeypatch.setattr("ptmcad.ask.changes.critical_values", lambda *_: "for a reason")
    assert run([*asked, "--changes", "--tolerance", "1/100"]) == 0
    out = capsys.readouterr().out
    assert "enclosed  a region of 2 solutions appears" in out
    assert "not proved complete: for a reason" in out
    assert run(["verify", str(tmp_path / "disc.json")]) == 0
    assert "changes, compared with members" in capsys.readouterr().out
    assert run(["classify", "--slice", "L2,rho", "--changes", *common]) == 0
    assert "--changes has no effect here" in capsys.readouterr().err


def test_without_a_surface_the_picture_is_a_stack_and_a_mesh_needs_no_option(
    disc: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    common = [
        "classify",
        str(disc / "disc.yaml"),
        "--out",
        str(tmp_path),
        "--no-areas",
        "--members",
        "1/2,3/2",
    ]
    assert run([*common, "--format", "svg,obj"]) == 0
    assert "between 0 and 2" not in (tmp_path / "disc-3d.svg").read_text()
    assert (tmp_path / "disc.obj").read_text().startswith("# boundary surface over a, b, c")
    capsys.readouterr()
    assert run([*common, "--format", "json", "--surface"]) == 0
    told = capsys.readouterr()
    assert "--surface has no effect here: no picture and no mesh" in told.err
    assert "boundary surface" not in told.out
    for asked, message in (
        (
            ["plot", str(tmp_path / "disc.json"), "--surface"],
            "disc.json: a sheet must not reach past a change",
        ),
        (
            ["plot", str(tmp_path / "disc-c1_2.json"), "--format", "ply"],
            "ply is for a family's boundary surface",
        ),
        (
            ["classify", "--slice", "L2,rho", "--format", "obj", "--out", str(tmp_path)],
            "add --free NAME=LO:HI",
        ),
    ):
        assert run(asked) == 2
        assert message in capsys.readouterr().err
    plain = [
        "classify",
        "--slice",
        "L2,rho",
        "--surface",
        "--format",
        "json",
        "--no-areas",
        "--out",
        str(tmp_path),
    ]
    assert run(plain) == 0
    assert "--surface has no effect here: no parameter is free" in capsys.readouterr().err
    assert run(["plot", str(tmp_path / "disc-c1_2.json"), "--surface", "--format", "svg"]) == 0
    assert "--surface has no effect here: this is one map" in capsys.readouterr().err


def test_a_family_is_verified_member_by_member_with_its_changes(
    disc: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["verify", str(disc / "disc.json")]) == 0
    out = capsys.readouterr().out
    stored, files = read_family((disc / "disc.json").read_text())
    assert all(f"c = {value}\n" in out for value in stored.values)
    out = " ".join(out.split())
    assert (
        "3 changes, compared with members 1/1000000 of the range away on both sides; 8 random members"
        in out
    )
    assert "not checked changes complete" in out
    for name in ("disc.json", *files):
        (tmp_path / name).write_text((disc / name).read_text())
    damaged = tmp_path / files[-1]
    damaged.write_text(damaged.read_text().replace('"total": 2', '"total": 3'))
    assert run(["verify", str(tmp_path / "disc.json")]) == 1
    assert "violated: counts: cell 0 is said to have 3 solutions" in capsys.readouterr().err


def _without(found: dict[str, Any], number: int) -> dict[str, Any]:
    """A change dropped, and what was listed above it."""
    return found | {
        "found": found["found"][:number] + found["found"][number + 1 :],
        "between": found["between"][: number + 1] + found["between"][number + 2 :],
    }


def _moved(found: dict[str, Any], number: int, by: Fraction) -> dict[str, Any]:
    """A rational change elsewhere."""
    value = Fraction(found["found"][number]["value"]["low"]) + by
    polynomial = [str(-value.numerator), str(value.denominator)]
    moved = found["found"][number] | {
        "value": {"polynomial": polynomial, "low": str(value), "high": str(value)}
    }
    return found | {"found": [*found["found"][:number], moved, *found["found"][number + 1 :]]}


def _added(found: dict[str, Any], value: str) -> dict[str, Any]:
    """A change between the first two, where nothing changes."""
    one = {
        "value": {"polynomial": [f"-{value[0]}", value[2]], "low": value, "high": value},
        "words": ["it changes"],
    }
    other = found["between"][1] | {"value": "3/4"}
    return found | {
        "found": [found["found"][0], one, *found["found"][1:]],
        "between": [*found["between"][:2], other, *found["between"][2:]],
    }


def _another_arrangement(found: dict[str, Any]) -> dict[str, Any]:
    """The disc is said to have three solutions more."""
    inner = found["between"][1]
    counts = [[5] if key == [2] else key for key in inner["arrangement"]["counts"]]
    forged = inner | {"arrangement": inner["arrangement"] | {"counts": counts}}
    return found | {"between": [found["between"][0], forged, *found["between"][2:]]}


def _side_forgotten(found: dict[str, Any], side: str) -> dict[str, Any]:
    """What touches a side is said to be what lies beside it."""
    inner = found["between"][2]
    sides = inner["arrangement"]["sides"]
    forged = inner | {
        "arrangement": inner["arrangement"] | {"sides": sides | {side: sides[side][:1]}}
    }
    return found | {"between": [*found["between"][:2], forged, *found["between"][3:]]}


FORGED: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "dropped": lambda found: _without(found, 1),
    "first dropped": lambda found: _without(found, 0),
    "moved": lambda found: _moved(found, 0, Fraction(1, 10**5)),
    "moved down": lambda found: _moved(found, 2, Fraction(-1, 10**5)),
    "added": lambda found: _added(found, "2/3"),
    "another count": _another_arrangement,
    "a side": lambda found: _side_forgotten(found, "high x"),
    "another side": lambda found: _side_forgotten(found, "low y"),
    "two roots": lambda found: found
    | {"found": [found["found"][0] | {"value": {"polynomial": ["0", "-1", "100000000"], "low": "-1/2", "high": "1/2"}},
                 *found["found"][1:]]},
}  # fmt: skip


@pytest.mark.parametrize("forgery", FORGED)
def test_forged_changes_are_refused(
    disc: Path, forgery: str, capsys: pytest.CaptureFixture[str]
) -> None:
    data = json.loads((disc / "disc.json").read_text())
    # of the members one is enough here: they are verified elsewhere
    data |= {"changes": FORGED[forgery](data["changes"]), "members": data["members"][:1]}
    path = disc / f"forged-{forgery.replace(' ', '-')}.json"
    path.write_text(json.dumps(data))
    assert run(["verify", str(path)]) == 1
    assert "violated: changes: " in capsys.readouterr().err


def test_other_commands_ask_for_a_member(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["locate", str(folder / "loads.json"), "--at", "rho=1,L2=1"]) == 2
    assert "give the file of one of its members" in capsys.readouterr().err
    assert run(["solve", str(folder / "loads.yaml"), "--at", "rho=1,L2=1,F=-10"]) == 0
    assert "F3 = -10, F4 = -10" in capsys.readouterr().out
    assert run(["solve", str(folder / "loads.yaml"), "--at", "rho=1,L2=1"]) == 2
    assert "F is free" in capsys.readouterr().err
    assert run(["check", str(folder / "loads.yaml")]) == 0
    assert "family      of 2 such slices, F from -40 to 0" in capsys.readouterr().out


def test_what_is_wrong_with_a_member_names_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = tmp_path / "slope.yaml"
    record.write_text("system: {unknowns: {x: real}, equations: ['c*(x^3 + a*x + b)']}\n"
                      "axes: {a: [-1, 1], b: [-1, 1]}\nfree: {c: [0, 1]}\nmembers: [0, 1]\n")  # fmt: skip
    assert run(["classify", str(record), "--out", str(tmp_path), "--format", "json"]) == 2
    assert "(at c = 0)" in capsys.readouterr().err


def test_a_time_limit_leaves_whole_members(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "loads.yaml").write_text(RECORD.replace("[-40, -10]", "40"))
    limited = [
        "classify",
        str(tmp_path / "loads.yaml"),
        "--out",
        str(tmp_path),
        "--format",
        "json",
        "--timeout",
        ".3",
    ]
    assert run(limited) == 3
    number = int(capsys.readouterr().err.partition("the maps of ")[2].partition(" of 40")[0])
    made = list(tmp_path.glob("loads-F*.json"))
    assert len(made) == number
    for path in made:
        RegionMap.from_json(path.read_text())
    assert not (tmp_path / "loads.json").exists()
