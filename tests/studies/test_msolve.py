"""msolve's answers are read, and what goes wrong with it is named."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest
from flint import fmpq

from ptmcad.studies.msolve import MsolveError, parsed_basis, real_solutions

FAULTS = {
    "silent": ("pass", "failed with status 0"),
    "status": ("sys.exit('no memory')", "failed with status 1: 'no memory"),
    "crash": ("os.abort()", "failed with status -6"),
    "garbage": ("open(FILE, 'w').write('import this')", "not understood"),
    "not text": ("open(FILE, 'wb').write(bytes(range(256)))", "not understood"),
    "endless": ("time.sleep(60)", "did not end within 0.2 s"),
}


def fake(folder: Path, lines: str) -> str:
    """The PATH with a program named msolve before all others; FILE is where its answer goes."""
    program = folder / "msolve"
    program.write_text(f"#!{sys.executable}\nimport os, sys, time\nFILE = sys.argv[-1]\n{lines}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return f"{folder}{os.pathsep}{os.environ['PATH']}"


@pytest.mark.parametrize("what", FAULTS)
def test_what_goes_wrong_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    lines, why = FAULTS[what]
    monkeypatch.setenv("PATH", fake(tmp_path, lines))
    with pytest.raises(MsolveError, match=why):
        real_solutions(["u0"], ["u0^2-1"], 0.2 if what == "endless" else 20)


def test_what_is_no_list_of_polynomials_is_refused() -> None:
    assert parsed_basis("#x\n[-2/3*u0^2*u1+u1*5,\n 7]:", 2) == (
        {(2, 1): fmpq(-2, 3), (0, 1): fmpq(5)},
        {(0, 0): fmpq(7)},
    )
    for text in (
        "",
        "[]:",
        "[u0",
        "[u0,]:",
        "[u0u1]:",
        "[2u0]:",
        "[u0^]:",
        "[1/0]:",
        "[u0^99999]:",
        "[--u0]:",
    ):
        with pytest.raises(MsolveError, match="not understood"):
            parsed_basis(text, 2)


@pytest.mark.skipif(not hasattr(os, "O_ASYNC"), reason="pipes of this system send no signals")
def test_msolve_ends_with_the_process_that_asks_it_even_if_that_is_killed(tmp_path: Path) -> None:
    noted = tmp_path / "pid"
    path = fake(tmp_path, f"open({str(noted)!r}, 'w').write(str(os.getpid()))\ntime.sleep(600)")
    program = "from ptmcad.studies.msolve import real_solutions; real_solutions(['u0'], ['u0'], 60)"
    with subprocess.Popen(
        [sys.executable, "-c", program], env={**os.environ, "PATH": path}
    ) as process:
        while not (noted.exists() and noted.read_text()):
            assert process.poll() is None
            time.sleep(0.02)
        process.kill()
    pid = int(noted.read_text())
    for _ in range(100):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    os.kill(pid, 9)
    pytest.fail("msolve goes on")
