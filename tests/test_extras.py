"""What needs a package that is not installed says so before it computes anything."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path

import pytest

from ptmcad.cli import run
from ptmcad.extras import EXTRAS, remedy
from ptmcad.studies.stress import campaign
from ptmcad.studies.stress.case import Case, chosen, free_lengths, point

HAS_NUMBA = find_spec("numba") is not None
ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(autouse=True)
def without_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    loaded = [name for name in sys.modules if name.startswith("ptmcad.certified.")]
    for name in (*loaded, *({"ptmcad.formulas.compilation"} & sys.modules.keys())):
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "numba", None)


def refuse(*_: object, **__: object) -> None:
    raise AssertionError("something was computed")


@pytest.mark.parametrize("names", [("all",), ("free length",), ("units", "free-length-1e-3")])
def test_stress_refuses_before_the_first_case(
    names: tuple[str, ...],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(campaign, "run", refuse)
    assert run(["stress", *names, "--out", str(tmp_path)]) == 2
    assert "runs on the package numba" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_stress_needs_numba_for_free_lengths_only() -> None:
    """At points, on lines and on maps."""
    free = {case.name for case in chosen(()) if free_lengths(case.question.parameters)}
    assert {name for name in free if "free" in name}
    for case in chosen(()):
        assert (case.name in free) == any(k.startswith("l0") for k in case.question.parameters), (
            case.name
        )
    plain = Case("plain", "units", Fraction(1), point(), "none")
    assert not free_lengths(plain.question.parameters)
    done = campaign.campaign((plain,), seed=1, repeats=1)
    assert len(done["cases"]) == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ["classify", "configs/free02.yaml"],
        ["solve", "--set", "l0=1/5", "--at", "rho=1,L2=3/2"],
        ["range", "configs/free02.yaml", "--along", "rho", "--at", "L2=3/2"],
    ],
)
def test_commands_on_free_lengths_refuse(
    arguments: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    assert run(arguments) == 2
    message = capsys.readouterr().err
    assert "runs on the package numba" in message
    assert message.count("\n") == 1


@pytest.mark.skipif(not HAS_NUMBA, reason="numba is not installed")
def test_a_variable_that_numba_refuses() -> None:
    """It is read as numba is loaded, so this takes a process of its own."""
    done = subprocess.run(
        [sys.executable, "-m", "ptmcad", "solve", "--set", "l0=1/5", "--at", "rho=1,L2=3/2"],
        env={**os.environ, "NUMBA_NUM_THREADS": "0"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "must be > 0" in done.stderr
    assert "NUMBA_" in done.stderr
    assert done.stderr.count("\n") == 1


def test_messages_name_an_extra_that_has_the_package() -> None:
    """As pyproject.toml has them; each package's own name is that under which it is imported."""
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
        "optional-dependencies"
    ]
    for extra, (package, _) in EXTRAS.items():
        assert any(need.startswith(f"{package}>=") for need in groups[extra])
        assert f"the package {package}" in remedy(extra)
        assert f"pip install 'ptmcad[{extra}]'" in remedy(extra)
