"""`ptmcad verify` of every kind of document: true ones hold, and what is changed in one is refused.

What may be changed without being false is listed in `STILL_TRUE`, each with the reason.
"""

from __future__ import annotations

import copy
import json
import random
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from support.forged import forged

import ptmcad
from ptmcad.cli import run

CUBIC = '{unknowns: {x: real}, equations: ["x^3 - a*x + b + c*a^2"]}'
RECORDS = {
    "design": (
        'name: best\nsystem: {unknowns: {t: angle}, potential: "a*cos(t) + b*sin(t) + c*cos(2*t)"}\n'
        "parameters: {c: 1/2}\naxes: {a: [-2, 2], b: [-2, 2]}\n"
        "design: {maximise: range, along: a, over: {b: [-1, 1], c: [1/10, 1]}, "
        'where: {stable: 2, conditions: ["b + c <= 3/2"]}}\n'
    ),
    "family": f"name: fam\nsystem: {CUBIC}\naxes: {{a: [-1, 2], b: [-1, 1]}}\nfree: {{c: [-1, 1]}}\nmembers: [-1/2]\n",
    "arm": (
        "name: arm\nmechanism:\n  parameters: {F: {kind: force}, P: {kind: force}}\n  unknowns: {t: angle}\n"
        "  points: {root: [0, 0], anchor: [0, 2], tip: [cos(t), sin(t)]}\n  bars: [[root, tip]]\n"
        "  supports: {root: pin, anchor: pin}\n  springs: [{between: [tip, anchor], k: 1}]\n"
        "  loads: {tip: [F, P]}\naxes: {F: [-1, 1], P: [-1, 1]}\n"
    ),
    "line": f"name: line\nsystem: {CUBIC}\nparameters: {{c: 1/3}}\naxes: {{a: [-1, 2], b: [-1, 1]}}\n",
    "sweep": f"name: sw\nsystem: {CUBIC}\naxes: {{a: [-1, 2], b: [-1, 1]}}\nsweep: {{c: [0, 1/2]}}\n",
}
COMMANDS = {
    "design": (["design", "design.yaml", "--evaluations", "6"], "best-design.json"),
    "family": (["classify", "family.yaml", "--changes"], "fam.json"),
    "poses": (["solve", "line.yaml", "--at", "a=1,b=1/50"], "poses.json"),
    "range": (["range", "line.yaml", "--along", "a", "--at", "b=1/50"], "line-range.json"),
    "map": (["classify", "line.yaml"], "line.json"),
    "poses of a mechanism": (
        ["solve", "arm.yaml", "--at", "F=1/2,P=1/4", "--name", "arm"],
        "arm.json",
    ),
}
STILL_TRUE = {
    ("title",): "free text",
    ("slice", "title"): "free text",
    ("slice", "reference"): "published answers, of which nothing is claimed",
    ("system", "name"): "free text",
    ("model", "system", "name"): "free text",
    ("mechanism",): "of a range, whose model is in its slice",
    ("bound",): "a larger bound is true, too",
    (
        "points",
    ): "of the designs that were evaluated one may be left out; the values of the others are evaluated anew",
    ("reason",): "no number of boxes is another",
    ("seed",): "of the search, on which nothing rests",
    ("tolerance",): "what was asked for",
    ("evaluations",): "what was asked for",
    ("value",): "a wider enclosure has the value, too",
    ("span",): "wider enclosures have the ends, too",
    ("boxes",): "a larger bound of a box is true, too",
    ("name",): "free text",
    ("versions",): "of the program that made it",
    ("extremes",): "a claim less",
    (
        "parameters",
        "c",
    ): "of a family the free parameter itself, of a design the present one's value",
    ("conditions",): "a condition that holds for the same designs",
    ("members",): "a member less",
    ("slice", "axes", "b"): "the line is at one value of it",
    ("request", "pose"): "of paths, which were not asked for",
    ("request", "rows"): "of a table, which was not asked for",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("documents")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(path)
        for name, text in RECORDS.items():
            Path(f"{name}.yaml").write_text(text, encoding="utf-8")
        for command, _ in COMMANDS.values():
            assert run([*command, "--format", "json"]) == 0
        assert run(["sweep", "sweep.yaml", "--out", "swept"]) == 0
    return path


@pytest.fixture(autouse=True)
def within(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


def document(kind: str) -> Any:
    return json.loads(Path(COMMANDS[kind][1]).read_text(encoding="utf-8"))


def verified(data: Any) -> int:
    Path("forged.json").write_text(json.dumps(data), encoding="utf-8")
    return run(["verify", "forged.json"])


@pytest.mark.parametrize("kind", [*COMMANDS, "sweep"])
def test_a_true_document_holds_and_its_last_line_says_so(
    kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["verify", "swept" if kind == "sweep" else COMMANDS[kind][1]]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert "hold" in lines[-1] and "false" not in lines[-1]


def test_a_design_without_any_range_holds() -> None:
    """A cubic has one root or three, never two."""
    asked = "design: {maximise: range, along: a, over: {b: [-1, 1]}, where: {stable: 2}}\n"
    Path("none.yaml").write_text(
        RECORDS["line"].replace("name: line", "name: none") + asked, encoding="utf-8"
    )
    assert run(["design", "none.yaml", "--format", "json"]) in (
        0,
        3,
    )  # a bound of what there is not is not proved
    assert run(["verify", "none-design.json"]) == 0


def test_the_verdict_counts_what_holds_and_what_was_not_checked(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(["verify", "line.json"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "20 claims hold, 2 not checked"


def maximise_area(data: Any) -> None:
    data["maximise"] = "area"


def shorter_window(data: Any) -> None:
    data["along"]["low"], data["along"]["high"] = "-1", "1"


def design_over_the_bound(data: Any) -> None:
    point = next(
        p
        for p in data["points"]
        if p["value"] is not None and p["at"] != list(data["best"].values())
    )
    point["value"] = ["10", "10"]


def another_value_of_a_design(data: Any) -> None:
    point = next(p for p in data["points"] if p["value"] not in (None, data["value"]))
    point["value"] = ["1/7", "1/7"]


def other_words(data: Any) -> None:
    data["changes"]["found"][0]["words"] = ["7 regions of 5 stable solutions vanish"]


def words_at_the_ends(data: Any) -> None:
    data["changes"]["at_ends"] = [["everything vanishes"], []]


def another_critical_value(data: Any) -> None:
    data["changes"]["others"].append({"polynomial": ["-1", "2"], "low": "1/2", "high": "1/2"})


def another_free_parameter(data: Any) -> None:
    data["parameters"]["c"] = "c + 1"


def value_that_is_near(data: Any) -> None:
    near = "-5221655/10000000"  # 2.7e-8 from the root of 432 c^2 + 216 c - 5
    data["changes"]["found"][0]["value"] = {
        "polynomial": ["5221655", "10000000"],
        "low": near,
        "high": near,
    }


def another_event(data: Any) -> None:
    data["line"]["changes"][0]["text"] = "gains 4 solutions"


def another_end(data: Any) -> None:
    data["line"]["intervals"][0]["high"]["decimal"] = "0.5"


def one_interval_less(data: Any) -> None:
    del data["line"]["intervals"][1]


def another_number_of_solutions(data: Any) -> None:
    data["line"]["intervals"][0]["total"] += 2


def no_decimal(data: Any) -> None:
    del data["line"]["intervals"][0]["high"]["decimal"]


def no_tip(data: Any) -> None:
    del data["equilibria"][0]["nodes"]["tip"]


def no_load(data: Any) -> None:
    del data["parameters"]["F"]


def a_pose_less(data: Any) -> None:
    del data["equilibria"][0]


def a_pose_elsewhere(data: Any) -> None:
    number = data["equilibria"][0]["reals"][0]
    number |= {"text": "0.25", "center": "0.25", "radius": "0"}


@pytest.mark.parametrize(
    ("kind", "forge"),
    [
        *(("design", f) for f in (maximise_area, shorter_window, design_over_the_bound, another_value_of_a_design)),
        *(("family", f) for f in (value_that_is_near, another_free_parameter)),
        *(pytest.param("family", f, marks=pytest.mark.slow)
          for f in (other_words, words_at_the_ends, another_critical_value)),
        *(("range", f)
          for f in (another_event, another_end, one_interval_less, another_number_of_solutions, no_decimal)),
        *(("poses", f) for f in (a_pose_less, a_pose_elsewhere)),
        *(("poses of a mechanism", f) for f in (no_tip, no_load)),
    ],
)  # fmt: skip
def test_a_false_document_is_refused(
    kind: str, forge: Callable[[Any], None], capsys: pytest.CaptureFixture[str]
) -> None:
    data = document(kind)
    forge(data)
    status = verified(data)
    printed = capsys.readouterr()
    assert status in (1, 2)
    if status == 1:
        assert "false" in printed.out.splitlines()[-1]
        assert printed.err.startswith("violated: ")


@pytest.mark.parametrize("kind", [name for name in COMMANDS if name != "map"])
@pytest.mark.slow
def test_whatever_is_changed_is_refused_or_still_true(
    kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A sample of all changes of single entries; maps have a forger of their own."""
    false = list(forged(document(kind)))
    accepted = []
    for place, data in random.Random(kind).sample(false, min(len(false), 60)):
        keys = tuple(key for key in place if isinstance(key, str))
        if verified(data) == 0 and not any(
            keys[: len(allowed)] == allowed for allowed in STILL_TRUE
        ):
            accepted.append(place)
        capsys.readouterr()
    assert not accepted


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE members SET cells = 99 WHERE number = 0",
        "UPDATE members SET areas = REPLACE(areas, '1', '2') WHERE number = 1",
        "UPDATE members SET widest = REPLACE(widest, '0', '1') WHERE number = 1",
        "UPDATE members SET widest = NULL WHERE number = 0",
        "UPDATE members SET error = 'it has no solution' WHERE number = 0",
        'INSERT INTO members (number, parameters) VALUES (2, \'{"c": "3"}\')',
        'UPDATE members SET parameters = \'{"c": "1/3"}\' WHERE number = 1',
        "UPDATE members SET status = 'certified' WHERE number = 1",
        "UPDATE members SET same_as = 0 WHERE number = 1",
        "DELETE FROM members WHERE number = 0",
    ],
)
def test_a_false_index_of_a_sweep_is_refused(
    statement: str, capsys: pytest.CaptureFixture[str]
) -> None:
    index = Path("swept/index.sqlite")
    true = index.read_bytes()
    try:
        with sqlite3.connect(index) as rows:
            rows.execute(statement)
        rows.close()
        status, shown = run(["verify", "swept"]), capsys.readouterr()
        damaged = status == 2 and "swept" in shown.err  # what contradicts itself is not read
        assert damaged or (status == 1 and "is false" in shown.out.splitlines()[-1])
    finally:
        index.write_bytes(true)


def test_a_forged_map_of_a_sweep_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    member = Path("swept/results/000/000001.json")
    true = member.read_text(encoding="utf-8")
    try:
        member.write_text(true.replace('"total": 3', '"total": 5'), encoding="utf-8")
        assert run(["verify", "swept"]) == 2
        assert "has been changed" in capsys.readouterr().err
    finally:
        member.write_text(true, encoding="utf-8")


@pytest.mark.parametrize("text", ["[]", "{", "\udcff"])
def test_a_member_that_is_no_map_is_named(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The index has the digest of what stands in its place."""
    index, member = Path("swept/index.sqlite"), Path("swept/results/000/000001.json")
    true = index.read_bytes(), member.read_bytes()
    data = text.encode(errors="surrogateescape")
    try:
        member.write_bytes(data)
        with sqlite3.connect(index) as rows:
            rows.execute(
                "UPDATE members SET digest = ? WHERE number = 1", (sha256(data).hexdigest(),)
            )
        rows.close()
        assert run(["verify", "swept"]) == 2
        assert "000001.json: is damaged or no region map" in capsys.readouterr().err
    finally:
        index.write_bytes(true[0])
        member.write_bytes(true[1])


def test_an_index_of_before_does_not_tell_attainment(capsys: pytest.CaptureFixture[str]) -> None:
    index = Path("swept/index.sqlite")
    true = index.read_bytes()
    try:
        with sqlite3.connect(index) as rows:
            for number, widest in rows.execute("SELECT number, widest FROM members").fetchall():
                before = json.dumps(json.loads(widest)[:-1])
                rows.execute("UPDATE members SET widest = ? WHERE number = ?", (before, number))
        rows.close()
        assert run(["verify", "swept"]) == 0
        assert capsys.readouterr().out.splitlines()[-1] == "1 claim holds, 2 not checked"
    finally:
        index.write_bytes(true)


def test_at_a_time_limit_it_is_said_what_was_checked(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", "fam.json", "--timeout", "0.05"]) == 3
    printed = capsys.readouterr()
    assert "not checked" in printed.out.splitlines()[-1]
    assert "the time limit of 0.05 s was reached" in printed.err


@pytest.mark.slow
def test_a_time_limit_ends_the_program_with_its_own_status() -> None:
    """The watched process has a clock of its own, which the watching one does not take for a signal
    from outside.
    """
    assert run(["classify", "fig4", "--format", "json"]) == 0
    command = [sys.executable, "-m", "ptmcad", "verify", "fig4.json", "--timeout", "0.5"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (3, "stopped: the time limit of 0.5 s was reached\n")


def test_answers_in_python_are_verified_too() -> None:
    poses = ptmcad.solve("line.yaml", a="1", b="1/50")
    assert ptmcad.verify(poses).verdict == "1 claim holds"
    false = copy.deepcopy(document("poses"))
    del false["equilibria"][0]
    assert not ptmcad.verify(type(poses).from_json(json.dumps(false))).ok
