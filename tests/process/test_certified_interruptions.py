"""The certified engine interrupted at random moments: what is saved, what is said, and that one can
go on from it.
"""

from __future__ import annotations

import json
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import pytest

pytest.importorskip("numba")

from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.text.numerals import percent

ROOT = Path(__file__).resolve().parents[2]
NAMES = ("free02", "free-load", "free-l0-L1")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
NOTHING = (
    "was still being loaded or compiled",
    "the first level of the search was not done",
    "no map to save yet",
)

WATCHING = """
import sys
from pathlib import Path
from ptmcad.process import handover

marker, tell = Path(sys.argv.pop(1)), handover.send

def telling(topic, *texts):
    tell(topic, *texts)
    if topic is handover.Topic.RESULT:
        marker.write_text(texts[2])

handover.send = telling
from ptmcad.__main__ import main
sys.exit(main())
"""
"""The program, which also keeps the remark on the last result that it has handed over."""


@dataclass(frozen=True)
class Interrupted:
    """A run, how it was ended, and what it left; ``"itself"`` where it was faster than that."""

    name: str
    how: str
    seconds: float
    status: int
    message: str
    handed: str | None
    saved: RegionMap | None
    path: Path

    def fault(self) -> str:
        """What is not as it was promised; empty if nothing."""
        if not self.message and self.saved is None and self.handed is None:
            return ""  # the command line was not read yet: nothing has begun
        if self.how == "itself":
            done = (
                self.saved is not None
                and self.saved.status is Status.CERTIFIED
                and not self.message
            )
            return "" if done else "it ended without a map"
        if "Traceback" in self.message or self.message.count("\n") != 1:
            return "not one message"
        if self.saved is None:
            said = any(reason in self.message for reason in NOTHING)
            return "" if said and self.handed is None else "nothing is saved"
        share = re.search(r"([0-9.e+-]+ %) (?:of it )?undetermined", self.message)
        if share is None or f"--resume {self.path}" not in self.message:
            return "it is not said what was saved, or how to go on"
        if share[1] != percent(self.saved.undetermined):
            return "another share is said than was saved"
        return "" if self.saved.status is Status.PARTIAL else "not marked as partial"


def worked(process: int) -> float:
    """Seconds of processor time of a process and of those that it has started: the same on a busy
    machine.
    """
    children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK") + sum(
        worked(int(c)) for c in children
    )


def interrupted(name: str, how: str, seconds: float, folder: Path) -> Interrupted:
    """Run a shipped slice, and end it by a signal after so much processor time, or by its time
    limit.
    """
    marker = folder / "handed"
    options = ["--timeout", f"{seconds}"] if how == "timeout" else []
    command = [sys.executable, "-c", WATCHING, str(marker), "classify", f"configs/{name}.yaml", "--format", "json",
               "--tolerance", "1e-9", "--out", str(folder), *options]  # fmt: skip
    with subprocess.Popen(
        command, cwd=ROOT, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL
    ) as process:
        if how != "timeout":
            while worked(process.pid) < seconds and process.poll() is None:
                time.sleep(0.02)
            process.send_signal(signal.Signals[how])
        _, errors = process.communicate()
        how = "itself" if process.returncode == 0 else how
    path = folder / f"{name}.json"
    saved = RegionMap.from_json(path.read_text(encoding="utf-8")) if path.exists() else None
    handed = marker.read_text() if marker.exists() else None
    return Interrupted(name, how, seconds, process.returncode, errors.decode(), handed, saved, path)


def campaign(number: int, seed: int) -> Iterator[Interrupted]:
    """Runs of all slices ended in all ways, at random moments within 15 seconds."""
    generator = random.Random(seed)
    for k in range(number):
        name, how = NAMES[k % 3], (*(s.name for s in SIGNALS), "timeout")[k // 3 % 4]
        # none before the program has its handlers, which takes the interpreter's own start
        seconds = round(0.5 + generator.random() ** 1.5 * 14.5, 2)
        with tempfile.TemporaryDirectory() as folder:
            yield interrupted(name, how, seconds, Path(folder))


def goes_on(run: Interrupted) -> bool:
    """Whether the saved map is verified, and a run from it ends with less undetermined."""
    assert run.saved is not None
    env = {**os.environ}
    checked = subprocess.run([sys.executable, "-m", "ptmcad", "verify", str(run.path)], cwd=ROOT, env=env,
                             capture_output=True, check=False)  # fmt: skip
    wanted = float(run.saved.undetermined) * 0.7
    command = [sys.executable, "-m", "ptmcad", "classify", f"configs/{run.name}.yaml", "--format", "json",
               "--resume", str(run.path), "--tolerance", f"{wanted}", "--out", str(run.path.parent)]  # fmt: skip
    further = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, check=False)
    after = json.loads(run.path.read_text(encoding="utf-8"))
    return checked.returncode == 0 and further.returncode == 0 and after["status"] == "certified"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads the processor time from /proc")
def test_interrupted_at_60_random_moments() -> None:
    saved = 0
    for k, run in enumerate(campaign(60, 14)):
        assert not run.fault(), (run.fault(), run)
        status = {"timeout": 3, "itself": 0}
        assert run.status == (
            status[run.how] if run.how in status else 128 + signal.Signals[run.how]
        )
        saved += run.saved is not None and run.how != "itself"
        if run.saved is not None and k % 7 == 0 and run.saved.undetermined < Fraction(1, 2):
            assert goes_on(run)
    assert saved > 20
