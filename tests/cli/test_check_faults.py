"""Faults that ``ptmcad check`` tells: each with its place, none that follows from another, none left out."""

from __future__ import annotations

from pathlib import Path

import pytest

from ptmcad.cli import run
from ptmcad.errors import MAX_FAULTS


def faults_of(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """The faults of a record as they are printed, without the file: line, key and message."""
    path = folder / "bad.yaml"
    path.write_text(text, encoding="utf-8")
    assert run(["check", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert all(line.startswith(f"error: {path}") for line in lines if line.startswith("error: "))
    return [line.removeprefix(f"error: {path}:") for line in lines]


@pytest.mark.parametrize("springs", [MAX_FAULTS - 1, MAX_FAULTS, MAX_FAULTS + 10])
def test_every_fault_keeps_its_place_however_many_there_are(
    springs: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "mechanism:\n  unknowns: {th: angle}\n  points: {O: [0, 0], A: [1, 2], P: [sin(th), cos(th)]}\n  springs:\n"
    text += "    - {between: [A, Z], k: 1}\n" * springs + "axes: {k: [1, 2], W: [0, 1]}\n"
    found = [fault for fault in faults_of(text, tmp_path, capsys) if "there is no point" in fault]
    assert len(found) == min(springs, MAX_FAULTS)
    for n, fault in enumerate(found):
        assert fault.startswith(f"{5 + n}: mechanism.springs.{n + 1}.between: there is no point 'Z'")
