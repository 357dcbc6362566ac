"""What the shell is told when Tab is pressed, by real processes and click's protocol."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.maps import shipped

from ptmcad.cli import COMMANDS, group, run
from ptmcad.cli.completion import answer

ROOT = Path(__file__).resolve().parents[2]
FIG4 = str(ROOT / "configs" / "fig4.yaml")


def request(shell: str, *words: str) -> dict[str, str]:
    """What the shell puts into the environment."""
    # fish says what is being typed, the others the place of it
    place = words[-1] if shell == "fish" else str(len(words))
    return {"COMP_WORDS": " ".join(("ptmcad", *words)), "COMP_CWORD": place}


def asked(shell: str, *words: str, cwd: Path | None = None) -> list[str]:
    """What the program answers; the last word is the one that is being typed."""
    environment = os.environ | {"_PTMCAD_COMPLETE": f"{shell}_complete"} | request(shell, *words)
    done = subprocess.run(
        [sys.executable, "-m", "ptmcad"],
        env=environment,
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return [line for line in done.stdout.splitlines() if line]


def plain(*words: str, cwd: Path | None = None) -> list[str]:
    """The values that bash is given."""
    return values_in(asked("bash", *words, cwd=cwd))


def values_in(lines: list[str]) -> list[str]:
    assert all(line.startswith("plain,") for line in lines)
    return [line.removeprefix("plain,") for line in lines]


def test_every_shell_is_answered() -> None:
    assert asked("bash", "cl") == ["plain,classify"]
    assert asked("zsh", "cl")[:2] == ["plain", "classify"]
    assert [line.partition("\t")[0] for line in asked("fish", "cl")] == ["plain,classify"]


def told(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> list[str]:
    """What bash is told, asked for in this process."""
    for name, value in request("bash", *words).items():
        monkeypatch.setenv(name, value)
    assert answer(group, "bash_complete", "ptmcad", "_PTMCAD_COMPLETE") == 0
    out, err = capsys.readouterr()
    assert err == ""
    return values_in([line for line in out.splitlines() if line])


def test_all_commands_and_one_option(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told([""], monkeypatch, capsys) == list(COMMANDS)
    assert told(["verify", "--bo"], monkeypatch, capsys) == ["--boxes"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_of_a_shell(shell: str) -> None:
    environment = os.environ | {"_PTMCAD_COMPLETE": f"{shell}_source"}
    done = subprocess.run(
        [sys.executable, "-m", "ptmcad"],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert f"_PTMCAD_COMPLETE={shell}_complete" in done.stdout and done.stderr == ""


@pytest.mark.parametrize("value", ["", "bash", "tcsh_complete", "bash_now"])
@pytest.mark.fast_cases("tcsh_complete", "bash_now")
def test_no_request_of_a_shell(value: str) -> None:
    environment = os.environ | {"_PTMCAD_COMPLETE": value}
    done = subprocess.run(
        [sys.executable, "-m", "ptmcad"],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "error: _PTMCAD_COMPLETE is no request of bash, zsh or fish: unset it\n"


@pytest.mark.parametrize(
    ("words", "values"),
    [
        (["classify", "--format", "json,p"], ["json,png", "json,pdf"]),
        (["solve", "--format", "png,"], ["png,table", "png,json", "png,svg", "png,pdf"]),
        (["classify", "--count", "s"], ["stable"]),
        (["init", "p"], ["ptm", "pendulum", "platform"]),
        (["classify", "--mechanism", "pl"], ["platform"]),
        (["classify", "--mechanism", "pendulum", "--set", ""], ["L=", "k=", "W=", "H="]),
        (["classify", FIG4, "--slice", ""], ["rho,", "L2,", "L1,", "k,"]),
        (["classify", FIG4, "--slice", "L2,r"], ["L2,rho"]),
        (["range", FIG4, "--along", "rh"], ["rho"]),
        (["solve", "--at", "rho=1,L"], ["rho=1,L1=", "rho=1,L2="]),
        (["classify", "missing.yaml", "--slice", ""], []),
    ],
)
def test_values(
    words: list[str],
    values: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = told(words, monkeypatch, capsys)
    assert found[: len(values)] == values and (values or not found)


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_bash_itself(tmp_path: Path) -> None:
    """The script as bash runs it: what it would put at the cursor, and whether a space would
    follow.
    """
    (tmp_path / "ptmcad").write_text(
        f"#!/bin/sh\nexec {sys.executable} -m ptmcad\n", encoding="utf-8"
    )
    (tmp_path / "ptmcad").chmod(0o755)
    program = (
        'eval "$(_PTMCAD_COMPLETE=bash_source ptmcad)"\n'
        'compopt() { echo "$@"; }\n'
        "COMP_WORDS=(ptmcad classify --set rh) COMP_CWORD=3\n"
        "_ptmcad_completion ptmcad; printf '%s\\n' \"${COMPREPLY[@]}\"\n"
    )
    environment = os.environ | {"PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(
        ["bash", "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-2:] == ["-o nospace", "rho="]


def test_values_of_maps_and_palettes_are_proposed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stored = tmp_path / "fig4.json"
    stored.write_text(shipped("fig4").to_json())
    for given in (FIG4, str(stored)):
        assert told(["map", given, "--value", "bar"], monkeypatch, capsys) == ["barrier"]
        assert "length:k1" in told(["map", given, "--value", "len"], monkeypatch, capsys)
    assert told(["map", FIG4, "--pose", "sa"], monkeypatch, capsys) == ["saddle:"]
    assert told(["plot", str(stored), "--palette", ""], monkeypatch, capsys) == ["default", "grey"]
    assert told(["plot", str(stored), "--palette", "white,or"], monkeypatch, capsys) == [
        "white,orange"
    ]


def test_options_without_effect_on_pictures_say_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stored = tmp_path / "fig2.json"
    stored.write_text(shipped("fig2").to_json())
    assert run(["plot", str(stored), "--format", "csv", "--size", "3x3in"]) == 0
    assert "--size has no effect here: no picture is written" in capsys.readouterr().err
    compare = ["plot", str(stored), "--compare", str(stored), "--samples", "--legend", "right"]
    assert run(compare) == 0
    said = capsys.readouterr().err
    assert "--samples has no effect" in said and "--legend has no effect" in said
    assert run(["classify", FIG4, "--set", "F3=F", "--free", "F=-40:0", "--members", "abc"]) == 2
    assert "abc is neither how many members there are" in capsys.readouterr().err
