"""Three hundred interruptions of real processes: what they leave is one set of files, and no
complete result is lost.

Each run replaces the files of another, with the other count, so that every file says of which run
it is. It is ended by kill -9 of the computation, of the program, of both, or by a signal; at a
random moment, before a step of putting the files into place, or while it waits for the folder's
lock; with either engine, or with a stand-in for its time.
"""

from __future__ import annotations

import fcntl
import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from ptmcad.process.output import check_writable

ROOT = Path(__file__).resolve().parents[2]
ENDS = (
    "kill -9 of the computation",
    "kill -9 of the program",
    "kill -9 of both",
    "SIGINT",
    "SIGTERM",
    "SIGHUP",
)

PROGRAM = """
import fcntl, os, pathlib, signal, stat, sys, time, types
signal.signal(signal.SIGINT, lambda *_: os._exit(130))  # the interpreter's own start is not the program's
here, step, engine = pathlib.Path(sys.argv.pop(1)), int(sys.argv.pop(1)), sys.argv.pop(1)
program = os.getpid()
from ptmcad.process import handover
def arrived(name):
    (here / "writing").write_text(str(os.getpid()))
    (here / "writing").rename(here / name)
steps = 0
def waiting_before(work):
    def counted(*given, **named):
        global steps
        steps += 1
        if steps == step:
            arrived("arrived")
            # the end of this process, or of the program, which closes its pipes before it is gone
            deadline = time.monotonic() + 10
            while os.getppid() == program and time.monotonic() < deadline:
                time.sleep(0.001)
        return work(*given, **named)
    return counted
disk = os.replace, os.unlink, os.rmdir
flock, tell = fcntl.flock, handover.send
def waiting(file, operation):
    if step == 0 and (here / "drawn").exists() and isinstance(file, int) and stat.S_ISDIR(os.fstat(file).st_mode):
        arrived("arrived")
    return flock(file, operation)
fcntl.flock = waiting
def telling(topic, *texts):
    tell(topic, *texts)
    if topic is handover.Topic.RESULT:
        arrived("handed-over")
        if texts[0] == "complete":
            arrived("computed")
handover.send = telling
def draw(result, path, **how):
    path.write_text(result.slice.count.value)
    (here / "drawn").touch()
    os.replace, os.unlink, os.rmdir = map(waiting_before, disk)
from ptmcad.show import render
render.draw = draw
if engine != "real":
    from fractions import Fraction
    from types import SimpleNamespace as Some
    class Result:
        plan = ()
        def __init__(self, slice, status):
            self.slice, self.status = slice, Some(value=status)
            self.cover, self.undetermined = "a cover" if engine == "certified" else None, Fraction(1, 4)
        def to_json(self, timings=True):
            return '{"status": "%s", "slice": {"count": "%s"}}' % (self.status.value, self.slice.count.value)
        def table(self):
            return ""
    def region_map(slice, options):
        options.partial(Result(slice, "partial"))
        options.partial(Result(slice, engine))
        return Result(slice, engine)
    sys.modules["ptmcad.ask.classification"] = pipeline = types.ModuleType("ptmcad.ask.classification")
    pipeline.region_map, pipeline.prepare = region_map, lambda *_: None
from ptmcad.__main__ import main
main()
"""
CERTIFIED = ["--slice", "rho,L2", "--range", "rho=1/2:1", "--range", "L2=5/4:7/4", "--set", "l0=1/5", "--set", "F3=-10",
             "--set", "F4=-10", "--tolerance", "0.2", "--jobs", "1"]  # fmt: skip
EXACT = ["--slice", "rho,L2", "--range", "rho=0:2", "--range", "L2=0:2", "--no-areas"]
NAME = "slice-rho-L2"
PICTURES = (f"{NAME}.png", f"{NAME}.svg")


class Campaign:
    """A folder, and the count of which all of its files are."""

    def __init__(self, folder: Path, engine: str, real: bool) -> None:
        self.here = folder
        self.out = folder / "out"
        self.engine = engine
        self.real = real
        self.span = 0.0
        self.seen: Counter[str] = Counter()
        for count in ("total", "stable"):
            started = time.monotonic()
            process = self.start(count, -1)
            _, errors = process.communicate(timeout=600)
            assert (process.returncode, errors) == (0, b""), errors.decode()
            self.span = time.monotonic() - started
        assert self.counts() == dict.fromkeys((f"{NAME}.json", *PICTURES), "stable")

    def start(self, count: str, step: int) -> subprocess.Popen[bytes]:
        for marker in ("arrived", "drawn", "handed-over", "computed"):
            (self.here / marker).unlink(missing_ok=True)
        slice = CERTIFIED if self.engine == "certified" else EXACT
        arguments = [
            "classify",
            *slice,
            "--count",
            count,
            "--out",
            str(self.out),
            "--format",
            "png,svg,json",
        ]
        engine = "real" if self.real else self.engine
        program = [sys.executable, "-c", PROGRAM, str(self.here), str(step), engine, *arguments]
        return subprocess.Popen(
            program, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )

    def counts(self) -> dict[str, str]:
        """Of which run every file is that has a result's own name."""
        found = {}
        for path in (self.out / f"{NAME}.json", *(self.out / name for name in PICTURES)):
            if path.exists():
                text = path.read_text()
                found[path.name] = (
                    json.loads(text)["slice"]["count"] if path.suffix == ".json" else text
                )
        return found

    def interrupt(self, end: str, moment: str, choose: random.Random) -> None:
        """One run, ended so; what it has left is checked, and what it has saved is cleared away."""
        before = self.counts()[f"{NAME}.json"]
        count = "total" if before == "stable" else "stable"
        step = {"a step": choose.randint(1, 8), "the lock": 0}.get(moment, -1)
        held = os.open(self.out, os.O_RDONLY)
        process = self.start(count, step)
        if moment == "a random moment":
            time.sleep(choose.uniform(0.2, 1.1) * self.span)
        else:
            if moment == "the lock":
                while not (self.here / "drawn").exists():
                    fcntl.flock(held, fcntl.LOCK_UN)
                    time.sleep(0.002)
                    fcntl.flock(held, fcntl.LOCK_EX)
            while not (self.here / "arrived").exists() and process.poll() is None:
                time.sleep(0.01)
        handed_over, computed = (
            (self.here / marker).exists() for marker in ("handed-over", "computed")
        )
        self.end(process, end)
        _, errors = process.communicate(
            timeout=120
        )  # standard error is closed when both have ended
        os.close(held)
        text = errors.decode()
        assert "Traceback" not in text, text
        assert len(set(self.counts().values())) <= 1, (end, moment, step, self.counts())
        assert f"{NAME}.json" in self.counts()
        after = self.counts()[f"{NAME}.json"]
        assert after in (before, count)
        saved = [
            path
            for path in self.out.iterdir()
            if path.name.startswith((f"{NAME}.partial", f"{NAME}.complete"))
        ]
        for path in saved:
            status = json.loads(path.read_text())["status"]
            assert (status == "partial") == (".partial" in path.name), path
            assert str(path) in text
        worth_saving = (
            self.engine == "certified" or computed
        )  # an exact map on the way is made anew in less time
        left_to_save = end == "kill -9 of the computation" or (
            end.startswith("SIG") and worth_saving
        )
        if handed_over and left_to_save and process.returncode != 0:
            assert re.search(r" map( \(.* undetermined\))? saved to ", text), (end, moment, text)
            assert saved or after == count
        while [name for name in os.listdir(self.out) if name.startswith(".")]:
            # a process that ends closes standard error a little before it drops its locks
            check_writable(self.out, (f"{NAME}.json", *PICTURES))
        for path in saved:
            path.unlink()
        kept = "saved beside it" if saved else "the older set"
        self.seen[f"{end}, {moment}: {'the new set' if after == count else kept}"] += 1

    def end(self, process: subprocess.Popen[bytes], end: str) -> None:
        if end.startswith("SIG"):
            process.send_signal(signal.Signals[end])
            return
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        try:
            computing = [int(child) for child in children.read_text().split()]
        except OSError:
            computing = []
        if end != "kill -9 of the computation":
            process.kill()
        if end != "kill -9 of the program":
            for child in computing:
                try:
                    os.kill(child, signal.SIGKILL)
                except ProcessLookupError:  # it has ended meanwhile
                    continue


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts on Linux's signals for pipes")
@pytest.mark.parametrize("engine", ["exact", "certified"])
@pytest.mark.parametrize(
    ("real", "moments"),
    [
        (False, {"a step": 12, "the lock": 4}),
        (True, {"a random moment": 7, "a step": 1, "the lock": 1}),
    ],
    ids=["putting into place", "the engine"],
)
def test_interruptions(tmp_path: Path, engine: str, real: bool, moments: dict[str, int]) -> None:
    campaign = Campaign(tmp_path, engine, real)
    choose = random.Random(f"{engine} {real}")
    plan = [
        (end, moment) for end in ENDS for moment, times in moments.items() for _ in range(times)
    ]
    choose.shuffle(plan)
    for end, moment in plan:
        campaign.interrupt(end, moment, choose)
    for line in sorted(campaign.seen):
        print(f"{campaign.seen[line]:4}  {line}")
    assert any("the new set" in line for line in campaign.seen)
    assert any("the new set" not in line for line in campaign.seen)
