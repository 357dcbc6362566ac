"""The README does what it says: its blocks are taken out of it and run."""

from __future__ import annotations

import ast
import os
import re
import shlex
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest
from support.maps import part_of_free02, record_of_part_of_free02, shipped_certified

import ptmcad
from ptmcad.cli import run
from ptmcad.options import Options

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)
RESULTS = re.compile(r"^(?P<expression>[^#\n]+?)\s*#\s*(?P<value>\S.*)$")


def blocks(language: str) -> list[str]:
    return [text for found, text in BLOCKS if found == language]


def shell_lines() -> list[str]:
    return [
        line.partition("#")[0].strip()
        for block in blocks("sh")
        for line in block.splitlines()
        if line.strip()
    ]


MAKE_LINES = [line for line in shell_lines() if line.startswith("make ")]
PROGRAM_LINES = [line for line in shell_lines() if not line.startswith("make ")]


def test_the_parts_are_there() -> None:
    assert MAKE_LINES == ["make demo", "make test"]
    commands = " ".join(shlex.split(line)[1] for line in PROGRAM_LINES)
    assert (
        commands
        == "classify classify verify locate report range map animate solve solve variety classify verify solve"
    )
    assert len(blocks("yaml")) == 2
    assert len(blocks("python")) == 1


@pytest.mark.parametrize("line", MAKE_LINES)
def test_make_command(line: str) -> None:
    """The targets exist and run what the README says; they are not run here, or the tests would run
    themselves.
    """
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    dry = subprocess.run(
        [*shlex.split(line), "--dry-run"],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert dry.returncode == 0, dry.stderr
    expected = {
        "make demo": "ptmcad classify fig4 --format json,png,svg --out out",
        "make test": "pytest",
    }
    assert expected[line] in dry.stdout
    assert "warm-up" not in dry.stdout  # nothing is compiled that the target does not use


FEWER = {"frames": 4, "pixels": 20, "boxes": 1}
"""Of what the README's commands take more of."""
SAYS = {
    "classify": "regions ",
    "verify": "ok ",
    "locate": "stable  2\n",
    "range": "operation range: 0.4981306959 to 1.041432630",
    "report": "fig4.html",
    "map": "50 random pixels agree with exact poses to ",
    "animate": " of equilibria, each one of as many as are counted exactly there\n"
    "snap at rho = 1.04143, L2 = 1.5: the pose vanishes and falls to th1 = -47.52",
    "solve": "6 equilibria: 2 stable, 3 saddles, 1 maximum",
    "variety": "variety := [",
}


SAYS_FREE = {
    "classify": "2 stable: {} regions",
    "verify": "ok ",
    "solve": "7 equilibria: 2 stable, 4 saddles",
}


@pytest.mark.usefixtures("coarse")
@pytest.mark.parametrize(
    "part", [True, pytest.param(False, marks=pytest.mark.slow)], ids=["part of free02", "free02"]
)
def test_program_commands_in_their_order(
    part: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Each command ends well and says what it should, in a folder that is empty at first.

    The first one is the installed program; to start it for the others too would show no more. The
    map of free02 takes most of the time, even that of a part of its window; it is one that other
    tests read too, and here counts that it is asked for.
    """

    free02, asked = part_of_free02() if part else shipped_certified("free02", "1/50"), []

    def certified_map(slice: ptmcad.Slice, options: Options) -> ptmcad.RegionMap:
        assert (slice, options.tolerance) == (free02.slice, Fraction(1, 50))
        asked.append(slice.name)
        return free02

    monkeypatch.setattr("ptmcad.certified.engine.certified_map", certified_map)
    monkeypatch.setattr(
        "ptmcad.verification.certified.certificate.BOXES", 4
    )  # of 40: enough to see that some are tried
    if part:  # a file wins over the shipped record of its name
        (tmp_path / "free02").write_text(record_of_part_of_free02(), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    installed = Path(sys.executable).with_name("ptmcad")
    for n, shown in enumerate(PROGRAM_LINES):
        line = (
            re.sub(r"(?<=--)(frames|pixels|boxes) \d+", lambda m: f"{m[1]} {FEWER[m[1]]}", shown)
            if part
            else shown
        )
        program, command, *arguments = shlex.split(line)
        assert program == ".venv/bin/ptmcad"
        if n == 0:
            done = subprocess.run(
                [str(installed), command, *arguments], capture_output=True, text=True, check=False
            )
            status, out, err = done.returncode, done.stdout, done.stderr
        else:
            status = run([command, *arguments])
            out, err = capfd.readouterr()
        assert (status, err) == (0, ""), line
        says = (SAYS_FREE if "free02" in line or "l0=" in line else SAYS)[command]
        assert says.replace("{}", "2" if part else "4") in out, line
    assert asked == ["free02"]
    written = {path.name for path in (tmp_path / "out").iterdir()}
    maps = {
        "fig4.html",
        "fig4.json",
        "fig4.svg",
        "slice-L2-rho.json",
        "slice-L2-rho.png",
        "slice-L2-rho.svg",
    }
    maps |= {"free02.json", "free02.png", "fig4-stiffness-stable-1.png", "fig4-motion.gif"}
    assert written == maps | {"poses.json", "poses.svg", "poses-landscape.svg"}


def test_python_block(monkeypatch: pytest.MonkeyPatch) -> None:
    """The block runs; a line that ends in a comment evaluates to what the comment says."""
    monkeypatch.chdir(ROOT)
    (block,) = blocks("python")
    names: dict[str, object] = {}
    checked = 0
    for line in block.splitlines():
        result = RESULTS.match(line)
        if result is None:
            exec(line, names)
        else:
            assert eval(result["expression"], names) == ast.literal_eval(result["value"])
            checked += 1
    assert checked


@pytest.mark.parametrize(("number", "path"), [(0, "fig4.yaml"), (1, "systems/duffing.yaml")])
def test_yaml_block(tmp_path: Path, number: int, path: str) -> None:
    """The record is read, and is the shipped one with its reference left out."""
    from ptmcad.question import config

    record = tmp_path / "record.yaml"
    record.write_text(blocks("yaml")[number], encoding="utf-8")
    shown, shipped = config.load(record), config.load(ROOT / "configs" / path)
    assert (shown.name, shown.model.unknowns, shown.axes, shown.count) == (
        shipped.name,
        shipped.model.unknowns,
        shipped.axes,
        shipped.count,
    )
    assert dict(shown.parameters) == dict(shipped.parameters)


def test_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
