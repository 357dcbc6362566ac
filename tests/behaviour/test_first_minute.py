"""The first minute: help, misspelt words, shipped records by name, floats, the question, bars,
remedies.
"""

from __future__ import annotations

import fcntl
import json
import os
import pty
import re
import struct
import sys
import termios
import tomllib
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.cases import cases

import ptmcad
from ptmcad.cli import run
from ptmcad.errors import ConfigError

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, where the program is called."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refusal(words: list[str], capfd: pytest.CaptureFixture[str]) -> str:
    """The one line that a command is refused with."""
    assert run(words) == 2
    out, err = capfd.readouterr()
    (line,) = err.splitlines()
    assert out == "" and line.startswith("error: ")
    return line


# --------------------------------------------------------------------------------------------------- help and mistakes


def test_the_program_alone_prints_its_help(capfd: pytest.CaptureFixture[str]) -> None:
    assert run([]) == 0
    out, err = capfd.readouterr()
    assert out.startswith("Usage: ptmcad ") and "classify" in out and "\\n" not in out and err == ""
    assert max(map(len, out.splitlines())) < 80


# ------------------------------------------------------------------------------------------------------------- floats

TENTH = (0.1, np.float64(0.1), np.float32(0.1), Fraction(1, 10))
PARABOLA: dict[str, Any] = {"system": {"unknowns": {"x": "real"}, "equations": ["x^2 - a - b"]}}
UNIT = {"a": [-1, 1], "b": [-1, 1]}


@pytest.mark.parametrize("tenth", TENTH, ids=lambda value: f"{type(value).__name__}")
def test_a_float_is_its_shortest_decimal_wherever_a_number_is_taken(tenth: Any) -> None:
    record = {**PARABOLA, "axes": {"a": [-tenth, 1], "b": [0, tenth]}}
    result = ptmcad.classify(record, tolerance=None)
    assert [(axis.low, axis.high) for axis in result.slice.axes] == [
        (Fraction(-1, 10), 1),
        (0, Fraction(1, 10)),
    ]
    window = ptmcad.classify({**PARABOLA, "axes": UNIT})
    assert window.locate(a=-tenth, b="1/10").status.value == "on the variety"
    (pose,) = ptmcad.solve({**PARABOLA, "axes": UNIT}, a=tenth, b="-1/10").equilibria
    assert pose.reals[0].text() == "0"
    line = ptmcad.intervals(window.slice, "a", {"b": tenth})
    assert line.intervals[0].high.text() == "-0.1"


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -np.inf])
def test_what_is_no_number_is_refused_by_name(value: float) -> None:
    with pytest.raises(ConfigError, match=r"axes\.b.*is not a number"):
        ptmcad.classify({**PARABOLA, "axes": {"a": [0, 1], "b": [0, value]}})
    with pytest.raises(
        ConfigError, match=r"^a: .*is not a number .*; all values are finite: write a large number"
    ):
        ptmcad.solve({**PARABOLA, "axes": UNIT}, a=value, b=0)
    with pytest.raises(ConfigError, match=r"^tolerance: .*is not a number"):
        ptmcad.classify({**PARABOLA, "axes": UNIT}, tolerance=value)


# ---------------------------------------------------------------------------------------------------- shipped records


def test_no_two_shipped_records_have_one_name(capfd: pytest.CaptureFixture[str]) -> None:
    """Each is listed, and found."""
    names = [path.stem for path in (ROOT / "configs").rglob("*.yaml")]
    assert len(set(names)) == len(names) > 20
    assert run(["mechanisms"]) == 0
    listed = capfd.readouterr().out.partition("records that are shipped")[2]
    assert {line.split()[0] for line in listed.splitlines()[1:]} == set(names)


def test_a_file_wins_over_a_shipped_record(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """A folder of the name does not."""
    Path("duffing").write_text(
        (ROOT / "configs" / "systems" / "cubic.yaml").read_text("utf-8"), encoding="utf-8"
    )
    Path("fig4").mkdir()
    assert ptmcad.load("duffing").axis_names == ptmcad.load("cubic").axis_names
    assert ptmcad.load("fig4").name == "fig4"


def test_an_extra_has_all_that_messages_name() -> None:
    """But msolve, which is a program of its own and not for every system."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
        "optional-dependencies"
    ]
    (everything,) = extras["all"]
    named = set(re.findall(r"\w+", everything.partition("[")[2]))
    assert named == extras.keys() - {"all", "large", "test", "check", "fuzz", "docs", "dev"}


# ----------------------------------------------------------------------------------------------- the question, and bars


@pytest.mark.parametrize(
    ("command", "question"),
    [
        (
            "classify fig4 --format json --no-areas",
            "fig4: rho in [0, 2], L2 in [0, 2]; F3 = -10, F4 = -10; count stable",
        ),
        (
            "range --along rho --over L2 --range L2=0:2 --at F3=-10,k=100 --rows 2",
            "slice-rho-L2: rho in [0, 4], L2 in [0, 2]; F3 = -10; count stable",
        ),
        ("range duffing --along W --at G=1/2", "duffing: W in [0, 3], G in [0, 1]; count total"),
        (
            "classify fig2 --set F3=F --free F=-2:0 --members 2 --format json --no-areas",
            "fig2: L2 in [0, 4], rho in [0, 4]; F3 = F; count stable",
        ),
    ],
)
@pytest.mark.slow_cases(
    "range --along rho --over L2 --range L2=0:2 --at F3=-10,k=100 --rows 2"
    "-slice-rho-L2: rho in [0, 4], L2 in [0, 2]; F3 = -10; count stable"
)
def test_the_answer_begins_with_the_question(
    command: str, question: str, folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run(command.split()) == 0
    lines = capfd.readouterr().out.splitlines()
    assert lines[0] == f"question  {question}"
    assert all(len(line) <= 80 for line in lines[:2])


IMPATIENT = """
from ptmcad.cli import progress
progress.PATIENCE, progress._TICK = 0, 0.01
from ptmcad.__main__ import main
main()
"""
"""The program, whose bar appears at once."""


def on_a_terminal(
    words: list[str], columns: int, program: tuple[str, ...] = ("-m", "ptmcad")
) -> str:
    """What a command shows on a terminal of so many columns."""
    child, terminal = pty.fork()
    if child == 0:
        fcntl.ioctl(2, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        os.execvpe(
            sys.executable,
            [sys.executable, *program, *words],
            os.environ | {"PYTHONPATH": str(ROOT)},
        )
    shown = b""
    try:
        while part := os.read(terminal, 1 << 16):
            shown += part
    except OSError:  # the other end is closed
        pass
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    os.close(terminal)
    return shown.decode()


MAP = ["map", "fig4", "--value", "barrier", "--pose", "stable:2", "--pixels", "60"]
SEARCH = [
    "design",
    "fig4",
    "--along",
    "rho",
    "--over",
    "L1=1/2:2",
    "--over",
    "L2=1/2:2",
    "--boxes",
    "2000",
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "columns"),
    [
        pytest.param([*SEARCH, "--tolerance", "1/20"], 40, id="design"),
        pytest.param(MAP, 80, id="map"),
    ],
)
def test_a_long_command_has_one_bar_on_one_line(
    words: list[str], columns: int, folder: Path
) -> None:
    shown = on_a_terminal(words, columns)
    bars = re.findall(r"\r\x1b\[K(\[[#.]+\][^\r\n]*)", shown)
    assert bars and all(len(bar) < columns for bar in bars)
    assert shown.count("\r\x1b[K") == len(bars) + 1  # it is cleared at the end
    assert not re.search(r"\[[#.]+\][^\r]*\n", shown)


def test_lines_and_the_bar_stay_apart(folder: Path) -> None:
    """Rows that are printed while a check goes on; and nothing is left of a bar drawn as libraries
    were loaded.
    """
    made = on_a_terminal(["classify", "duffing", "--format", "json,png"], 40, ("-c", IMPATIENT))
    checked = on_a_terminal(["verify", "duffing.json"], 40, ("-c", IMPATIENT))
    for shown in (made, checked):
        bars = re.findall(r"\[[#.]{4,}\][^\r\n]*.", shown, re.DOTALL)
        assert bars and all(len(bar) <= 40 and bar.endswith("\r") for bar in bars)
    assert len(re.findall(r"(?:\n|\x1b\[K)ok ", checked)) > 10


# ------------------------------------------------------------------------------------------------------------ remedies


@pytest.mark.parametrize(
    ("text", "remedy"),
    cases("first_minute", "values"),
)
def test_a_message_says_what_to_write_instead(
    text: str, remedy: str, folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """In a record's values, and in options."""
    Path("mine.yaml").write_text(
        f'parameters: {{L1: "{text}"}}\naxes: {{rho: [0, 2], L2: [0, 2]}}\n', encoding="utf-8"
    )
    said = refusal(["classify", "mine.yaml"], capfd)
    assert said.startswith("error: mine.yaml:1: parameters.L1: ") and remedy in said
    if "rho" not in text and "," not in text:  # a comma begins the next name there
        assert remedy in refusal(["solve", "--at", f"L1={text}"], capfd)


@pytest.mark.parametrize(
    ("equation", "remedy"),
    cases("first_minute", "equations"),
)
def test_a_message_says_what_to_write_instead_in_an_equation(
    equation: str, remedy: str, folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    lines = [
        "system:",
        "  unknowns: {x: real}",
        f"  equations: ['{equation}']",
        "axes: {a: [0, 1], n: [1, 2]}",
    ]
    Path("mine.yaml").write_text("\n".join(lines), encoding="utf-8")
    said = refusal(["classify", "mine.yaml"], capfd)
    assert said.startswith("error: mine.yaml:3: system.equations.1: ") and remedy in said


# --------------------------------------------------------------------------------------------------------------- check


@pytest.mark.parametrize("number", [4, 5])
def test_check_says_where_points_are_answered_and_maps_are_not(
    number: int, folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """A chain of springs with free lengths: no map of so many unknowns is made, and `solve`
    answers.
    """
    masses = ["P", "Q", "R"][: (number + 1) // 2]
    heights = {
        name: f"y{name}" if n < number - len(masses) else "-1" for n, name in enumerate(masses)
    }
    record = {
        "mechanism": {
            "parameters": {
                "k": {"kind": "stiffness", "default": 5},
                "g": {"default": 10},
                "m": {"default": 1},
            },
            "unknowns": {f"x{n}": "length" for n in masses}
            | {y: "length" for y in heights.values() if y != "-1"},
            "points": {"A": [0, 0], "B": [4, 0]} | {n: [f"x{n}", heights[n]] for n in masses},
            "springs": [
                {"between": list(ends), "k": "k", "free": 1}
                for ends in zip(["A", *masses], [*masses, "B"], strict=True)
            ],
            "loads": {n: [0, "-g*m"] for n in masses if heights[n] != "-1"},
        },
        "axes": {"g": [5, 20], "m": [1, 2]},
    }
    Path("mine.yaml").write_text(json.dumps(record), encoding="utf-8")
    assert run(["check", "mine.yaml"]) == 0
    out = capfd.readouterr().out
    assert "no map can be made" in out and "by ptmcad solve" in out and "hours" not in out


def test_check_has_no_word_for_what_it_has_not_counted(
    folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    unknowns = "xyzuv"
    record = {
        "system": {
            "unknowns": dict.fromkeys(unknowns, "real"),
            "equations": [f"{u}^2 - a*{v} - b" for u, v in zip(unknowns, "yzuvx", strict=True)],
        },
        "axes": {"a": [0, 1], "b": [0, 1]},
    }
    Path("mine.yaml").write_text(json.dumps(record), encoding="utf-8")
    assert run(["check", "mine.yaml"]) == 0
    out = capfd.readouterr().out
    assert (
        "solutions   not counted" in out and "cost        not known" in out and "hours" not in out
    )
