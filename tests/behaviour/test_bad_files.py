"""Results that were renamed, cut, retyped, made later or never: one clear message and status 2,
never a traceback.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from support.cases import cases

import ptmcad
from ptmcad.cli import run

ROOT = Path(__file__).resolve().parents[2]
SYSTEM = {"unknowns": {"u": "real"}, "potential": "u^3/3 + (a^2 + b^2 - c)*u"}
RECORD = {
    "name": "disc",
    "system": SYSTEM,
    "axes": {"a": [-2, 2], "b": [-2, 2]},
    "parameters": {"c": 1},
}
FAMILY = {
    **{k: v for k, v in RECORD.items() if k != "parameters"},
    "name": "discs",
    "free": {"c": [0, 3]},
}
DESIGN = yaml.safe_load("""
name: best
system: {unknowns: {t: angle}, potential: a*cos(t) + b*sin(t) + c*cos(2*t)}
parameters: {c: 1/2}
axes: {a: [-2, 2], b: [-2, 2]}
count: stable
design: {maximise: range, along: a, over: {b: [-1, 1], c: [1/10, 1]}, where: {stable: 2}}
""")
CERTIFIED = ["--slice", "rho,L2", "--range", "rho=1/2:1", "--range", "L2=5/4:7/4", "--set", "l0=1/5", "--set", "F3=-10",
             "--set", "F4=-10", "--tolerance", "0.2", "--no-timings"]  # fmt: skip
MAKING: dict[str, tuple[dict[str, Any], list[str], str]] = {
    "exact": (RECORD, ["classify", "--no-timings"], "disc.json"),
    "certified": ({}, ["classify", *CERTIFIED], "slice-rho-L2.json"),
    "family": (FAMILY, ["classify", "--members", "1,2", "--no-timings"], "discs.json"),
    "changes": (
        FAMILY,
        ["classify", "--members", "1,2", "--changes", "--no-timings"],
        "discs.json",
    ),
    "design": (DESIGN, ["design"], "best-design.json"),
    "poses": (RECORD, ["solve", "--at", "a=0,b=0"], "poses.json"),
    "range": (RECORD, ["range", "--along", "a", "--over", "b"], "disc-range.json"),
}
READING = {
    "exact": (
        "report",
        "locate --at a=0,b=0",
        "plot --format csv",
        "verify",
        "map --value u --pose 1 --pixels 4",
    ),
    "certified": ("report", "locate --at rho=3/4,L2=3/2", "plot --format csv"),
    "family": ("verify", "plot --format png"),
    "changes": ("verify",),
    "design": ("verify",),
    "poses": ("verify",),
    "range": ("verify",),
}

ASKING = """
from ptmcad.algebra import bases
from ptmcad.algebra.fibre_algebra import WorkLimit
bases.MANY, bases.SMALL = 1, WorkLimit(0, 0, 0, 0)
from ptmcad.__main__ import main
main()
"""
"""The program, which asks msolve also where it can do without."""


@cache
def _made(folder: Path, kind: str) -> Path:
    """The folder with a document of a kind, made by the command line."""
    record, (command, *options), name = MAKING[kind]
    place = folder / kind
    place.mkdir()
    (place / "record.yaml").write_text(json.dumps(record))
    given = [str(place / "record.yaml")] if record else []
    assert run([command, *given, *options, "--format", "json", "--out", str(place)]) == 0
    return place / name


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("documents")


def part(data: Any, path: tuple[Any, ...]) -> Any:
    for step in path:
        data = data[step]
    return data


def _read(
    path: Path, data: Any, capsys: pytest.CaptureFixture[str], *command: str
) -> tuple[int, str]:
    """The status and the message of a command that reads the document once it is changed."""
    changed = path.with_name("changed.json")
    changed.write_text(json.dumps(data))
    capsys.readouterr()
    options = ["--out", str(path.parent / "out")] if command[0] in ("report", "plot", "map") else []
    status = run([command[0], str(changed), *command[1:], *options])
    return status, capsys.readouterr().err


@pytest.mark.parametrize(
    ("kind", "path", "value", "words"),
    cases("bad_files", "faults"),
)
def test_a_fault_names_the_keys_place(
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    kind: str,
    path: tuple[Any, ...],
    value: Any,
    words: str,
) -> None:
    made = _made(folder, kind)
    data = json.loads(made.read_text())
    part(data, path[:-1])[path[-1]] = value
    if kind == "poses":
        with pytest.raises(ValueError, match=words):
            ptmcad.Poses.from_json(json.dumps(data))
        return
    for command in READING[kind]:
        if (
            command != "verify" or kind != "exact"
        ):  # which says itself where a map contradicts itself
            status, said = _read(made, data, capsys, *command.split())
            assert (status, said.count("\n"), words in said) == (2, 1, True), (command, said)


@pytest.mark.parametrize(
    "kind", ["exact", "family", pytest.param("design", marks=pytest.mark.slow), "poses", "range"]
)
def test_a_later_version_needs_a_newer_program(
    folder: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    made = _made(folder, kind)
    data = json.loads(made.read_text())
    name, _, version = data["format"].partition("/")
    later = f"{name}/{int(version) + 1}"
    data |= {"format": later, "a key of later": 1}
    if kind == "poses":
        with pytest.raises(ValueError, match=f"{later}.*needs a newer ptmcad"):
            ptmcad.Poses.from_json(json.dumps(data))
        return
    status, said = _read(made, data, capsys, "verify")
    assert (status, said.count("\n")) == (2, 1)
    assert later in said
    assert "needs a newer ptmcad" in said


@pytest.mark.skipif(sys.platform != "linux", reason="bounds memory")
@pytest.mark.parametrize(
    "head", ["[", '{"format": "ptmcad-region-map/2", "status": ['], ids=["other", "map"]
)
@pytest.mark.slow_cases("other")
def test_a_large_file_that_is_no_result_is_refused_in_little_memory(
    tmp_path: Path, head: str
) -> None:
    path = tmp_path / "large.json"
    path.write_text(f"{head}{'{},' * 8_000_000}0]{'}' * (head[0] == '{')}")
    command = [sys.executable, "-m", "ptmcad", "report", str(path), "--max-memory", "300M"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert done.stderr.startswith(f"error: {path}: "), done.stderr


def test_a_large_result_is_read(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made = _made(folder, "exact")
    data = json.loads(made.read_text())
    data["slice"]["reference"] = {"notes": ["measured on a Monday"] * 100_000}
    assert _read(made, data, capsys, "locate", "--at", "a=0,b=0") == (0, "")


@pytest.mark.skipif(sys.platform != "linux", reason="files without names have none on Linux alone")
@pytest.mark.parametrize("to", ["the computation", "both"])
def test_a_kill_leaves_nothing_of_msolve(tmp_path: Path, to: str) -> None:
    """Whatever msolve reads and writes: nothing is there any more when all have ended."""
    asked, temporary, program = tmp_path / "asked", tmp_path / "temporary", tmp_path / "msolve"
    temporary.mkdir()
    waits = f"import pathlib, time\npathlib.Path({str(asked)!r}).touch()\ntime.sleep(600)\n"
    program.write_text(f"#!{sys.executable}\n{waits}")
    program.chmod(0o755)
    record = yaml.safe_load("""
        system: {unknowns: {x: real, y: real}, equations: [x^2 - a, y^2 - b]}
        axes: {a: [1, 2], b: [1, 2]}
    """)
    (tmp_path / "record.yaml").write_text(json.dumps(record))
    command = [
        sys.executable,
        "-c",
        ASKING,
        "solve",
        str(tmp_path / "record.yaml"),
        "--at",
        "a=1,b=1",
    ]
    environment = {
        **os.environ,
        "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}",
        "TMPDIR": str(temporary),
    }
    with subprocess.Popen(command, cwd=ROOT, env=environment, stderr=subprocess.DEVNULL) as process:
        while not asked.exists():
            assert process.poll() is None
            time.sleep(0.02)
        (computing,) = map(
            int, Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        )
        os.kill(computing, signal.SIGKILL)
        if to == "both":
            process.kill()
    assert not list(temporary.iterdir())
