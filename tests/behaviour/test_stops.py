"""Certified runs that are stopped in a terminal: what is saved is what the bar had shown, and the
message says so.
"""

from __future__ import annotations

import itertools
import json
import os
import random
import re
import select
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import pytest

pytest.importorskip("numba")
pty = pytest.importorskip("pty")

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(
    sys.platform != "linux", reason="finds the computing process in /proc"
)

HOW = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated (SIGTERM)",
    signal.SIGHUP: "the terminal was closed (SIGHUP)",
}
RECORDS = ("free02", "free-load", "free-l0-L1", "free08", "free-l0-L32")
PROGRAM, COMPUTATION = "the program", "the computation"


@dataclass(frozen=True)
class Stopped:
    """A run under a pseudo-terminal that a signal has ended, or that had ended before."""

    record: str
    number: int
    to: str
    signalled: bool
    status: int
    shown: str
    """The last share that the bar has shown as undetermined, as it is written."""
    message: str
    """What is said on standard error once the bar is gone."""
    saved: Fraction | None
    """The share that the file leaves undetermined."""
    path: Path

    def fault(self) -> str:
        """What is not as it has to be after a signal that the program heeds; empty if nothing."""
        if not self.signalled:
            return (
                ""
                if (self.status, self.message) == (0, "")
                else "it ended by itself with a message"
            )
        if self.status != 128 + self.number:
            return "the status is not the signal's"
        found = re.fullmatch(
            r"(.*); partial map \((\S+) % undetermined\) saved to (\S+); go on with .*",
            self.message,
        )
        if found is None:
            return "not one line that names what was saved"
        how, said, place = found.groups()
        if how != HOW.get(
            signal.Signals(self.number), f"stopped by {signal.Signals(self.number).name}"
        ):
            return "another signal is named"
        if self.saved is None or Path(place) != self.path:
            return "nothing is saved where it is said"
        if (
            not 0 <= Fraction(said) - 100 * self.saved < Fraction(said) / 10
        ):  # rounded up to two digits
            return "another share is said than was saved"
        return (
            ""
            if 100 * self.saved <= 2 * Fraction(self.shown)
            else "more is undetermined than twice what was shown"
        )


def children(process: int) -> list[int]:
    return [
        int(child) for child in Path(f"/proc/{process}/task/{process}/children").read_text().split()
    ]


def stopped(record: str, number: int, to: str, seconds: float, folder: Path) -> Stopped:
    """Classify a shipped record, and send a signal so many seconds after the first level of the
    search was done.
    """
    terminal, end = pty.openpty()
    command = [sys.executable, "-m", "ptmcad", "classify", f"configs/{record}.yaml", "--format", "json",
               "--tolerance", "1e-9", "--out", str(folder)]  # fmt: skip
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=end)
    os.close(end)
    printed, due, signalled = b"", float("inf"), False
    while True:
        if select.select([terminal], [], [], 0.01)[0]:
            try:
                data = os.read(terminal, 1 << 16)
            except OSError:  # nobody holds the other end any more
                break
            printed += data
        shares = re.findall(rb"undetermined (\S+) %", printed.rpartition(b"\r\x1b[K")[0])
        if due == float("inf") and any(share != b"100" for share in shares):
            due = time.monotonic() + seconds
        if not signalled and time.monotonic() >= due:
            computing = children(process.pid) if process.poll() is None else []
            if computing:
                os.kill(process.pid if to is PROGRAM else computing[0], number)
                signalled = True
            due = float("inf") if signalled else due
    os.close(terminal)
    status = process.wait()
    path = folder / f"{record}.json"
    saved = Fraction(json.loads(path.read_text())["undetermined"]) if path.exists() else None
    message = printed.rpartition(b"\x1b[K")[2].decode().strip()
    shown = shares[-1].decode() if shares else "100"
    return Stopped(
        record, number, to, signalled and status != 0, status, shown, message, saved, path
    )


def test_a_signal_to_the_computing_process_saves_what_was_shown(tmp_path: Path) -> None:
    run = stopped("free-load", signal.SIGTERM, COMPUTATION, 0.0, tmp_path)
    assert not run.fault(), (run.fault(), run)
    assert run.signalled


@pytest.mark.slow
@pytest.mark.parametrize("to", [PROGRAM, COMPUTATION])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
def test_25_interruptions_at_random_moments(
    tmp_path: Path, number: signal.Signals, to: str
) -> None:
    """Most in the first seconds, when maps are made one after the other; runs that ended before do
    not count.
    """
    generator = random.Random(f"{number.name} {to}")
    interrupted = 0
    for k in itertools.count():
        run = stopped(
            RECORDS[k % len(RECORDS)], number, to, 4 * generator.random() ** 1.5, tmp_path / str(k)
        )
        print(f"{run.record:12} {number.name} to {to:16} shown {run.shown:>8} %  saved "
              f"{'-' if run.saved is None else f'{100 * float(run.saved):.3g}':>8} %  status {run.status}")  # fmt: skip
        assert not run.fault(), (run.fault(), run)
        interrupted += run.signalled
        if interrupted == 25:
            break


@pytest.mark.slow
def test_a_signal_while_compiled_code_unpickles(tmp_path: Path) -> None:
    """It makes a map of many small counts then, each of which asks Python for a type: what is
    raised there crashes.
    """
    for k in range(10):
        run = stopped("free08", signal.SIGTERM, PROGRAM, 1.6, tmp_path / str(k))
        assert not run.fault(), (run.fault(), run)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGUSR2, signal.SIGALRM],
                         ids=lambda number: number.name)  # fmt: skip
@pytest.mark.parametrize("to", [PROGRAM, COMPUTATION])
def test_other_signals_that_end_a_program(tmp_path: Path, number: signal.Signals, to: str) -> None:
    run = stopped("free-load", number, to, 0.3, tmp_path)
    assert not run.fault(), (run.fault(), run)


@pytest.mark.slow
@pytest.mark.parametrize(("number", "status", "words"), [
    (signal.SIGKILL, 3, "stopped: the computation was killed from outside, most likely because memory ran out"),
    (signal.SIGVTALRM, 3, "stopped: the computation was ended from outside (SIGVTALRM)"),
    (signal.SIGRTMIN + 3, 3, f"stopped: the computation was ended from outside (signal {signal.SIGRTMIN + 3})"),
    (signal.SIGSEGV, 139, "error: the computation crashed (SIGSEGV); this is a bug, please report it"),
])  # fmt: skip
def test_signals_that_nothing_can_answer(
    tmp_path: Path, number: int, status: int, words: str
) -> None:
    """There is no last map then; the one that was handed over before is saved."""
    run = stopped("free-load", number, COMPUTATION, 0.0, tmp_path)
    assert run.status == status
    assert run.message.startswith(f"{words}; partial map ("), run.message
    assert run.saved is not None
    assert run.saved < 1
