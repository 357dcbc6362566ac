"""What the shell is told when Tab is pressed, by click's protocol, and by bash itself."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.maps import shipped

from ptmcad.cli import COMMANDS, COMPLETION, run

ROOT = Path(__file__).resolve().parents[2]
FIG4 = str(ROOT / "configs" / "fig4.yaml")


def request(shell: str, *words: str) -> dict[str, str]:
    """What the shell puts into the environment."""
    # fish says what is being typed, the others the place of it
    place = words[-1] if shell == "fish" else str(len(words))
    return {"COMP_WORDS": " ".join(("ptmcad", *words)), "COMP_CWORD": place}


Asked = Callable[..., str]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Asked:
    """What the program prints where a shell asks it; the last word is the one that is being typed.
    Real processes are asked by bash itself."""

    def answer(instruction: str, *words: str, status: int = 0) -> str:
        shell = instruction.partition("_")[0]
        for name, value in request(shell, *words).items() if words else ():
            monkeypatch.setenv(name, value)
        monkeypatch.setenv(COMPLETION, instruction)
        assert run([]) == status
        out, err = capsys.readouterr()
        assert not (err if status == 0 else out)
        return out or err

    return answer


def values_in(lines: list[str]) -> list[str]:
    assert all(line.startswith("plain,") for line in lines)
    return [line.removeprefix("plain,") for line in lines]


def test_every_shell_is_answered(asked: Asked) -> None:
    assert asked("bash_complete", "cl").split() == ["plain,classify"]
    assert asked("zsh_complete", "cl").split()[:2] == ["plain", "classify"]
    assert asked("fish_complete", "cl").partition("\t")[0] == "plain,classify"


@pytest.fixture
def told(asked: Asked) -> Callable[[list[str]], list[str]]:
    """The values that bash is given."""
    return lambda words: values_in(asked("bash_complete", *words).split())


def test_all_commands_and_one_option(told: Callable[[list[str]], list[str]]) -> None:
    assert told([""]) == list(COMMANDS)
    assert told(["verify", "--bo"]) == ["--boxes"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_of_a_shell(shell: str, asked: Asked) -> None:
    assert f"_PTMCAD_COMPLETE={shell}_complete" in asked(f"{shell}_source")


@pytest.mark.parametrize("value", ["", "bash", "tcsh_complete", "bash_now"])
def test_no_request_of_a_shell(value: str, asked: Asked) -> None:
    said = "error: _PTMCAD_COMPLETE is no request of bash, zsh or fish: unset it\n"
    assert asked(value, status=2) == said


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
    words: list[str], values: list[str], told: Callable[[list[str]], list[str]]
) -> None:
    found = told(words)
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
    tmp_path: Path, told: Callable[[list[str]], list[str]]
) -> None:
    stored = tmp_path / "fig4.json"
    stored.write_text(shipped("fig4").to_json())
    for given in (FIG4, str(stored)):
        assert told(["map", given, "--value", "bar"]) == ["barrier"]
        assert "length:k1" in told(["map", given, "--value", "len"])
    assert told(["map", FIG4, "--pose", "sa"]) == ["saddle:"]
    assert told(["plot", str(stored), "--palette", ""]) == ["default", "grey"]
    assert told(["plot", str(stored), "--palette", "white,or"]) == ["white,orange"]


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
