"""Signals, kills, limits and full disks, all from outside: a real process, what it leaves, and how
it ends.

Where a test says "in C code", the computation is one call of FLINT that would last for many minutes
and never returns to the interpreter meanwhile: the primality proof of a number of a thousand
digits.
"""

from __future__ import annotations

import fcntl
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.warm import Started, start

import ptmcad
from ptmcad.cli import run
from ptmcad.cli.commonoptions import bound_of, default_bound
from ptmcad.errors import ConfigError
from ptmcad.process.handover import Own, Topic, received, send
from ptmcad.process.output import check_writable, save_stopped, text_writer, write_files
from ptmcad.process.supervisor import what_is_there

ROOT = Path(__file__).resolve().parents[2]
FIG2 = ROOT / "configs" / "fig2.yaml"
PARTIAL = json.dumps({"status": "partial", "stage": "variety"})

linux = pytest.mark.skipif(
    sys.platform != "linux", reason="counts on Linux's signals for pipes, or on its limits"
)
pytestmark = pytest.mark.skipif(
    not hasattr(os, "fork"), reason="without fork the command line is not watched"
)

# A command line whose engine hands over a partial result, informs the test that it is there, and
# then does `work`.
STAND_IN = """
import os, signal, sys, time, types
signal.signal(signal.SIGINT, lambda *_: os._exit(130))
import flint
from pathlib import Path
here = Path(sys.argv.pop(1))
class Result:
    plan, cover = (), None
    def __init__(self, state):
        self.status = types.SimpleNamespace(value=state)
    def to_json(self, timings=True):
        return '{"status": "' + self.status.value + '", "stage": "variety"}'
    def table(self):
        return "table"
def arrived():
    (here / "pid").write_text(str(os.getpid()))
    (here / "pid").rename(here / "arrived")
def for_long_in_c():
    flint.fmpz(10**999 + 7).is_prime()
def time_is_up():
    from ptmcad.process.handover import Topic, send
    send(Topic.DEADLINE, repr(time.monotonic()), "1000 s")
def engine(progress, partial):
    pass
def draw(result, path, **how):
    path.write_text("half a picture")
{work}
def region_map(slice, options):
    options.partial(Result("partial"))
    engine(options.progress, options.partial)
    options.partial(Result("exact"))
    return Result("exact")
pipeline = types.ModuleType("ptmcad.ask.classification")
pipeline.region_map, pipeline.prepare = region_map, lambda *_: None
sys.modules["ptmcad.ask.classification"] = pipeline
from ptmcad.__main__ import main
from ptmcad.show import render
render.draw = draw
main()
"""

NEVER = (
    "import ptmcad.process.supervisor\n"
    "ptmcad.process.supervisor.GRACE_SECONDS = ptmcad.process.supervisor.OVERRUN_SECONDS = 0.01\n"
    "ptmcad.process.supervisor.LAST_SECONDS = 0.01\n"
)  # fmt: skip
"""Before work that never returns to the interpreter: whatever time it gets to do so is waited for
in vain.
"""
IN_C = f"{NEVER}def engine(progress, partial):\n    arrived()\n    for_long_in_c()\n"
OUT_OF_TIME = f"{NEVER}def engine(progress, partial):\n    time_is_up()\n    for_long_in_c()\n"
FILLING = """
def engine(progress, partial):
    with open(here / "out" / "filler", "wb", buffering=0) as file:
        try:
            while file.write(bytes(4096)):
                pass
        except OSError:
            time_is_up()
            for_long_in_c()
"""
DRAWING = "def draw(result, path, **how):\n    path.write_text('half')\n    arrived()\n"


ALWAYS = (
    "flint",
    "ptmcad.__main__",
    "ptmcad.process.supervisor",
    "ptmcad.cli.classify",
    "ptmcad.question.config",
)
"""What every command line with the stand-in imports."""


class Running:
    """A command line with a stand-in engine, in a folder ``out`` with an old result."""

    def __init__(
        self, folder: Path, work: str, *options: str, formats: str = "json", **popen: Any
    ) -> None:
        self.folder = folder
        self.out = folder / "out"
        self.out.mkdir(exist_ok=True)
        arguments = ["classify", str(FIG2), "--out", str(self.out), "--format", formats, *options]
        program = STAND_IN.replace("{work}", work)
        self.process: subprocess.Popen[bytes] | Started
        # what has been imported before would be no part of a limit
        if popen.keys() - {"start_new_session"} or "--max-memory" in options:
            popen = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **popen}
            self.process = subprocess.Popen(
                [sys.executable, "-c", program, str(folder), *arguments], cwd=ROOT, **popen
            )
        else:
            self.process = start(program, [str(folder), *arguments], ALWAYS)

    def arrive(self) -> int:
        """Wait until the computation has come to where it stays, and return the process that
        computes.
        """
        until(lambda: (self.folder / "arrived").exists() or self.process.poll() is not None)
        assert self.process.poll() is None, self.process.communicate()
        return int((self.folder / "arrived").read_text())

    def end(self) -> tuple[int, str]:
        """The exit status and what was printed on standard error; nothing may be left of the
        process.
        """
        _, errors = self.process.communicate(timeout=60)
        assert not [name for name in os.listdir(self.out) if name.startswith(".")]
        return self.process.returncode, (errors or b"").decode()

    def files(self) -> dict[str, str]:
        return {
            path.name: path.read_text() if path.is_file() else ""
            for path in sorted(self.out.iterdir())
        }


def until(condition: Callable[[], bool]) -> None:
    """Wait for something that the requirement itself is to happen."""
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, "it did not happen"
        time.sleep(0.01)


def lives(process: int) -> bool:
    """Whether a process runs; one that has ended and waits for its parent's notice does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def put(folder: Path, **files: str) -> dict[str, str]:
    """Old files ``fig2.SUFFIX`` in the folder ``out``."""
    (folder / "out").mkdir()
    old = {f"fig2.{suffix}": text for suffix, text in files.items()}
    for name, text in old.items():
        (folder / "out" / name).write_text(text)
    return old


# Signals


@linux
@pytest.mark.parametrize(
    ("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
@pytest.mark.parametrize("to", ["the process", "its group, twice"])
def test_a_signal_stops_c_code(
    tmp_path: Path, number: signal.Signals, status: int, to: str
) -> None:
    """Ctrl-C in a terminal goes to the whole group, and people press it twice."""
    old = put(tmp_path, json="old")
    running = Running(tmp_path, IN_C, start_new_session=True)
    computing = running.arrive()
    for _ in range(1 if to == "the process" else 2):
        (os.kill if to == "the process" else os.killpg)(running.process.pid, number)
    assert running.end() == (status, f"{HOW_ENDED[number]}; nothing was saved\n")
    assert not lives(computing)
    assert running.files() == old


HOW_ENDED = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated (SIGTERM)",
    signal.SIGHUP: "the terminal was closed (SIGHUP)",
}
FIRST_WORDS = tuple(words.encode() for words in HOW_ENDED.values())
CERTIFIED = "Result.cover, Result.undetermined = 'of a certified map', __import__('fractions').Fraction(1, 4)\n"


@linux
@pytest.mark.parametrize(
    ("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
@pytest.mark.parametrize(
    "stay", ["for_long_in_c()", "time.sleep(3600)"], ids=["in C code", "in Python"]
)
def test_a_signal_saves_a_map_that_can_be_gone_on_from(
    tmp_path: Path, number: signal.Signals, status: int, stay: str
) -> None:
    old = put(tmp_path, json='{"status": "certified"}', png="old picture")
    hasty = NEVER if stay == "for_long_in_c()" else ""
    work = f"{hasty}{CERTIFIED}def engine(progress, partial):\n    arrived()\n    {stay}\n"
    running = Running(tmp_path, work, "--engine", "certified", formats="png,json")
    running.arrive()
    running.process.send_signal(number)
    place = running.out / "fig2.partial.json"
    message = (
        f"{HOW_ENDED[number]}; partial map (25 % undetermined) saved to {place}, because fig2.json "
        f"holds an older result that is not partial; go on with --resume {place}\n"
    )
    assert running.end() == (status, message)
    assert running.files() == {**old, "fig2.partial.json": PARTIAL}


# A command line one of whose functions never ends: it computes the same again and again.
AGAIN_AND_AGAIN = """
import importlib, sys
from pathlib import Path
arrived, module, name = Path(sys.argv.pop(1)), importlib.import_module(sys.argv.pop(1)), sys.argv.pop(1)
work = getattr(module, name)
def again_and_again(*given, **named):
    arrived.touch()
    while True:
        work(*given, **named)
setattr(module, name, again_and_again)
from ptmcad.__main__ import main
main()
"""
HIGH_DEGREE = (
    *("--slice", "F3,F4", "--range", "F3=-1:1", "--range", "F4=-1:1"),
    *("--set", "rho=1+F3^2", "--set", "L1=1+F4^2", "--set", "L2=2+F3*F4", "--format", "json"),
)
"""Lengths that are quadratic in the axes; its projection takes three seconds."""
INTERRUPTED = {
    "map": (
        "ptmcad.workbench.fields.quantityfield filled",
        ("map", "configs/fig4.yaml", "--value", "barrier", "--pose", "stable:2"),
    ),
    "range": (
        "ptmcad.exact.ranges.exactline intervals",
        ("range", "configs/fig4.yaml", "--along", "rho", "--over", "L2", "--format", "json"),
    ),
    "animate": (
        "ptmcad.workbench.fields.posemotion filled",
        ("animate", "configs/fig4.yaml", "--path", "rho=3/4:6/5,L2=3/2", "--pose", "stable:2"),
    ),
    "classify, areas": (
        "ptmcad.exact.exactmap areas_of",
        (
            "classify",
            "configs/mechanisms/two-bar-chain.yaml",
            "--set",
            "L1=1237/1000",
            "--set",
            "L2=1013/1000",
        ),
    ),
    "classify, a slice of high degree": (
        "ptmcad.exact.exactmap projection_of",
        ("classify", *HIGH_DEGREE),
    ),
}
"""In which function a command is interrupted, as its module looks it up: by then there is nothing
worth saving.
"""


@linux
@pytest.mark.parametrize(
    "command",
    [name if name == "map" else pytest.param(name, marks=pytest.mark.slow) for name in INTERRUPTED],
)
def test_an_interrupted_command_says_so(command: str, tmp_path: Path) -> None:
    """While it computes; however long that takes, as engines get faster."""
    arrived, out = tmp_path / "arrived", tmp_path / "out"
    out.mkdir()
    place, arguments = INTERRUPTED[command]
    process = start(
        AGAIN_AND_AGAIN, [str(arrived), *place.split(), *arguments, "--out", str(out)], ALWAYS
    )
    until(lambda: arrived.exists() or process.poll() is not None)
    process.send_signal(signal.SIGINT)
    assert process.communicate() == (b"", b"interrupted; nothing was saved\n")
    assert process.returncode == 130
    assert not list(out.iterdir())


def test_what_had_been_written_before_is_told() -> None:
    assert what_is_there([]) == "nothing was saved"
    assert what_is_there(["a.json"]) == "a.json had been written before and is whole"
    assert what_is_there(["a.json", "b.json"]).startswith("2 results had been written before")


@linux
@pytest.mark.parametrize(
    "stay", ["    for_long_in_c()\n", "    time.sleep(3600)\n"], ids=["in C code", "in Python"]
)
def test_a_signal_stops_drawing(tmp_path: Path, stay: str) -> None:
    old = put(tmp_path, json="old", png="old picture")
    hasty = NEVER if "for_long_in_c" in stay else ""
    running = Running(tmp_path, hasty + DRAWING + stay, formats="png,json")
    computing = running.arrive()
    assert len(running.files()) == 3
    running.process.send_signal(signal.SIGTERM)
    status, errors = running.end()
    assert status == 143
    assert errors.startswith("terminated (SIGTERM); complete map saved to ")
    assert not lives(computing)
    assert running.files() == {**old, "fig2.complete.json": NEW["fig2.json"]}


@linux
def test_what_is_cleaned_up_is_cleaned_up_silently_and_to_the_end(tmp_path: Path) -> None:
    """A second signal does not interrupt it; and what interrupted code has to say is nobody's
    concern.
    """
    work = (
        "def engine(progress, partial):\n"
        "    try:\n"
        "        arrived()\n"
        "        time.sleep(3600)\n"
        "    finally:\n"
        "        print('interrupted', file=sys.stderr)\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "        os.kill(os.getpid(), signal.SIGTERM)\n"
        "        (here / 'clean').touch()\n"
    )
    running = Running(tmp_path, work)
    os.kill(running.arrive(), signal.SIGINT)
    assert running.end() == (130, "interrupted; nothing was saved\n")
    assert (tmp_path / "clean").exists()


@linux
def test_an_ignored_hang_up_stays_ignored(tmp_path: Path) -> None:
    """As nohup asks for."""
    wait = "while not (here / 'go').exists(): time.sleep(0.01)"
    work = f"def engine(progress, partial):\n    arrived()\n    {wait}\n"
    running = Running(
        tmp_path, work, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)
    )
    computing = running.arrive()
    running.process.send_signal(signal.SIGHUP)
    os.kill(computing, signal.SIGHUP)
    (tmp_path / "go").touch()
    assert running.end() == (0, "")


@linux
def test_signals_at_any_moment_of_the_start(tmp_path: Path) -> None:
    """Also while modules are imported: no traceback, the right status, the old file or the new one."""
    program = (
        "import os, signal, sys\n"
        "signal.signal(signal.SIGINT, lambda *_: os._exit(130))\n"  # the interpreter's own start is not the program's
        "signal.signal(signal.SIGTERM, lambda *_: os._exit(143))\n"
        "os.write(1, b'.')\n"
        "from ptmcad.__main__ import main\n"
        "main()\n"
    )
    arguments = [
        sys.executable,
        "-c",
        program,
        "classify",
        str(FIG2),
        "--out",
        str(tmp_path),
        "--format",
        "json",
    ]
    moments = random.Random(2)
    for _ in range(6):
        number = moments.choice((signal.SIGINT, signal.SIGTERM))
        process = subprocess.Popen(
            arguments, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        assert process.stdout is not None
        assert process.stdout.read(1) == b"."
        time.sleep(moments.uniform(0, 0.25))
        process.send_signal(number)
        _, errors = process.communicate(timeout=60)
        assert process.returncode in (0, 128 + number)
        # what was computed by then, and is not yet in place, is saved
        assert errors == b"" or (process.returncode and errors.startswith(FIRST_WORDS)), errors
        assert not [name for name in os.listdir(tmp_path) if name.startswith(".")]


@linux
def test_the_progress_bar_leaves_no_half_line(tmp_path: Path) -> None:
    work = (
        "import ptmcad.cli.progress\n"
        "ptmcad.cli.progress.PATIENCE = 0\n"
        "def engine(progress, partial):\n    progress('counts', 1, 2)\n    arrived()\n    for_long_in_c()\n"
    )
    terminal, other = os.openpty()
    running = Running(tmp_path, work, stderr=other)
    running.arrive()
    os.close(other)
    running.process.send_signal(signal.SIGINT)
    assert running.end()[0] == 130
    shown = b""
    with suppress(
        OSError
    ):  # at the end, as nobody has the other side any more; a single read may give a part only
        while part := os.read(terminal, 10_000):
            shown += part
    os.close(terminal)
    assert b"counts 1 of 2" in shown
    assert shown.endswith(b"\r\x1b[Kinterrupted; nothing was saved\r\n")


# Waiting for the folder

WAITING = """
flock = fcntl.flock
def waiting(file, operation):
    if isinstance(file, int) and stat.S_ISDIR(os.fstat(file).st_mode) and draws:
        arrived()
    return flock(file, operation)
fcntl.flock, draws = waiting, []
def draw(result, path, **how):
    path.write_text("half a picture")
    draws.append(path)
"""
"""The computation says when it has drawn and waits for the folder's lock."""


ENDS = ("SIGINT", "SIGTERM", "SIGHUP", "time limit", "kill -9", "kill -9 of the program")
OLDER = {"json": "old", "png": "old picture"}


@linux
@pytest.mark.parametrize(
    ("ended", "certified", "old"),
    [
        ("SIGINT", False, OLDER),
        ("SIGTERM", True, OLDER),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in product(ENDS, (False, True), ({}, OLDER))
            if case not in (("SIGINT", False, OLDER), ("SIGTERM", True, OLDER))
        ),
    ],
)
def test_waiting_for_the_folder(
    tmp_path: Path, ended: str, certified: bool, old: dict[str, str]
) -> None:
    """Nothing is put into place without the lock; what was computed goes to a new name."""
    before = put(tmp_path, **old)
    held = os.open(tmp_path / "out", os.O_RDONLY)
    # the lock is held to the end: however long it is waited for, the outcome is the same
    hasty = "import ptmcad.process.output\nptmcad.process.output.LOCK_PATIENCE = 0.1\n"
    work = f"import fcntl, stat\n{hasty}{WAITING}{CERTIFIED if certified else ''}"
    options = [
        *(["--timeout", "1"] if ended == "time limit" else []),
        *(["--engine", "certified"] if certified else []),
    ]
    running = Running(tmp_path, work, *options, formats="png,json")
    fcntl.flock(
        held, fcntl.LOCK_EX
    )  # meanwhile the program starts; it can look at the folder later, too
    try:
        computing = running.arrive()
        if ended == "kill -9":
            os.kill(computing, signal.SIGKILL)
        elif ended == "kill -9 of the program":
            running.process.kill()
        elif ended != "time limit":
            running.process.send_signal(signal.Signals[ended])
        _, errors = running.process.communicate(timeout=60)
        until(lambda: not lives(computing))
    finally:
        os.close(held)
    files = {name: text for name, text in running.files().items() if not name.startswith(".")}
    saved = {"fig2.complete.json": NEW["fig2.json"]}
    if ended == "kill -9 of the program":
        assert (files, errors) == (before, b"")
    else:
        assert files == {**before, **saved}
        assert b"; complete map" in errors
        assert b"fig2.complete.json, because " in errors
    check_writable(running.out, ("fig2.png", "fig2.json"))
    assert set(os.listdir(running.out)) == set(files)


# kill -9


@linux
def test_a_killed_program_takes_its_computation_along(tmp_path: Path) -> None:
    running = Running(tmp_path, IN_C)
    computing = running.arrive()
    running.process.kill()
    running.process.communicate(timeout=60)
    until(lambda: not lives(computing))


KILLER = """
program, steps = os.getpid(), 0
def killing(work):
    def step(*given, **named):
        global steps
        steps += 1
        if steps == {step}:
            arrived()
            for process in ({victims}):
                os.kill(process, signal.SIGKILL)
            while os.getppid() == program:  # it closes its pipes, by which this one hears of it, before it is gone
                time.sleep(0.001)
        return work(*given, **named)
    return step
def engine(progress, partial):
    os.replace, os.unlink, os.rmdir = map(killing, (os.replace, os.unlink, os.rmdir))
"""
OLD = {"fig2.json": "old", "fig2.png": "old picture", "fig2.svg": "old picture"}
"""Eight steps: two old pictures are hidden, JSON, two pictures; then what is hidden is removed, and
its folder.
"""
NEW = {
    "fig2.json": '{"status": "exact", "stage": "variety"}',
    "fig2.png": "half a picture",
    "fig2.svg": "half a picture",
}


def killed_before_step(folder: Path, step: int, victims: str) -> tuple[Running, int, bytes]:
    """Kill processes before one of the steps that put a result into place."""
    put(folder, json="old", png="old picture", svg="old picture")
    work = KILLER.replace("{step}", str(step)).replace("{victims}", victims)
    running = Running(folder, work, formats="png,svg,json")
    running.process.wait(timeout=60)
    until((folder / "arrived").exists)
    computing = int((folder / "arrived").read_text())
    until(lambda: not lives(computing))
    _, errors = running.process.communicate(timeout=60)
    return running, running.process.returncode, errors


@linux
@pytest.mark.parametrize(
    "step", [2, 4, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 3, 5, 6, 7, 8))]
)
def test_a_killed_computation_between_two_steps(tmp_path: Path, step: int) -> None:
    """The result is in place, or the program saves it beside the older one, and says which;
    pictures may be missing.
    """
    running, status, errors = killed_before_step(tmp_path, step, "os.getpid(),")
    assert status == 3
    placed = step > 3
    place = running.out / ("fig2.json" if placed else "fig2.complete.json")
    why = "" if placed else ", because fig2.json holds an older result that is not partial"
    assert errors.decode().endswith(f"; complete map saved to {place}{why}\n")
    left = visible_before(step)
    assert running.files() == (left if placed else {**left, "fig2.complete.json": NEW["fig2.json"]})


def visible_before(step: int) -> dict[str, str]:
    """What can be seen before one of the steps that put a result into place."""
    files, pictures = (
        (OLD, ("png", "svg")[step - 1 :]) if step <= 3 else (NEW, ("png", "svg")[: step - 4])
    )
    return {name: files[name] for name in ("fig2.json", *(f"fig2.{kind}" for kind in pictures))}


@linux
@pytest.mark.parametrize(
    "step", [2, 4, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 3, 5, 6, 7, 8))]
)
def test_a_kill_of_both_between_two_steps(tmp_path: Path, step: int) -> None:
    """Never a picture beside the JSON of another run; and who comes next removes what is hidden."""
    running, _, _ = killed_before_step(tmp_path, step, "os.getppid(), os.getpid()")
    files = {name: text for name, text in running.files().items() if not name.startswith(".")}
    assert files == visible_before(step)
    check_writable(running.out, tuple(NEW))
    assert running.files() == files


def test_stale_temporary_files_go_and_live_ones_stay(tmp_path: Path) -> None:
    stale = [".fig2.0123abcd.tmp", ".probe.0123abcd.tmp"]
    others = [
        ".fig3.0123abcd.tmp",
        ".fig2.0123abcd.old",
        ".fig2.mine.tmp",
        "fig2.json",
        ".fig2.00000000.tmp",
    ]
    for name in (*stale, *others):
        (tmp_path / name).mkdir()
        (tmp_path / name / "fig2.png").touch()
    (tmp_path / ".fig2.1234abcd.tmp").symlink_to(tmp_path / "fig2.json")
    (tmp_path / ".fig2.2345abcd.tmp").touch()
    live = os.open(tmp_path / ".fig2.00000000.tmp", os.O_RDONLY)
    fcntl.flock(live, fcntl.LOCK_EX)
    check_writable(tmp_path, ("fig2.png",))
    os.close(live)
    assert set(os.listdir(tmp_path)) == {*others, ".fig2.1234abcd.tmp", ".fig2.2345abcd.tmp"}
    assert all((tmp_path / name / "fig2.png").exists() for name in others)


def test_a_live_writer_keeps_its_file(tmp_path: Path) -> None:
    """Another run for the same name, which clears the folder while this one writes."""

    def write(path: Path) -> None:
        path.write_text("new")
        check_writable(tmp_path, ("fig2.json",))
        assert path.read_text() == "new"

    write_files(tmp_path, {"fig2.json": write})
    assert os.listdir(tmp_path) == ["fig2.json"]


# Limits


@linux
def test_a_time_limit_stops_c_code(tmp_path: Path) -> None:
    work = "def engine(progress, partial):\n    for_long_in_c()\n"
    running = Running(tmp_path, work, "--timeout", "0.2")
    status, errors = running.end()
    assert status == 3
    assert errors == (
        f"stopped: the time limit of 0.2 s was reached; partial map saved to {tmp_path / 'out' / 'fig2.json'}\n"
    )
    assert running.files() == {"fig2.json": PARTIAL}


@linux
def test_a_time_limit_while_drawing_loses_no_result(tmp_path: Path) -> None:
    work = f"{NEVER}{DRAWING}    time_is_up()\n    for_long_in_c()\n"
    running = Running(tmp_path, work, "--timeout", "1000", formats="png,json")
    status, errors = running.end()
    assert (status, errors.count("\n")) == (3, 1)
    assert "complete map saved to" in errors
    assert list(running.files()) == ["fig2.json"]


@linux
@pytest.mark.parametrize(
    ("old", "place"),
    [
        (PARTIAL, "fig2.json"),
        ('{"status": "exact"}', "fig2.partial.json"),
        ("[" * 10**6, "fig2.partial.json"),
    ],
    ids=["older partial result", "whole result", "something else"],
)
def test_a_stopped_run_replaces_no_whole_result(tmp_path: Path, old: str, place: str) -> None:
    put(tmp_path, json=old)
    running = Running(tmp_path, OUT_OF_TIME, "--timeout", "1000")
    status, errors = running.end()
    assert status == 3
    assert str(tmp_path / "out" / place) in errors
    assert ("because fig2.json holds" in errors) == (place != "fig2.json")
    assert running.files() == {"fig2.json": old} | {place: PARTIAL}


@linux
def test_a_time_limit_before_there_is_anything(tmp_path: Path) -> None:
    work = "class Result:\n    def __init__(self, state):\n        arrived()\n        for_long_in_c()\n"
    running = Running(tmp_path, work, "--timeout", "0.2")
    assert running.end() == (3, "stopped: the time limit of 0.2 s was reached; nothing was saved\n")


@linux
@pytest.mark.parametrize(
    "allocate",
    [
        "flint.fmpz(3) ** (1 << 34)",
        "flint.fmpz_poly([1, 1]) ** 100_000",
        "flint.fmpq_mat(5000, 5000)",
        "[0] * (1 << 30)",
        "[bytes(k) for k in range(10**6)]",
    ],
)
@pytest.mark.fast_cases("flint.fmpz_poly([1, 1]) ** 100_000", "[0] * (1 << 30)")
def test_a_memory_limit(tmp_path: Path, allocate: str) -> None:
    """C code that aborts and Python's MemoryError end alike: one message, the partial result,
    status 3.
    """
    work = f"def engine(progress, partial):\n    {allocate}\n"
    running = Running(tmp_path, work, "--max-memory", "150M")
    status, errors = running.end()
    assert status == 3
    place = tmp_path / "out" / "fig2.json"
    assert (
        errors == f"stopped: the memory limit of 150M was reached; partial map saved to {place}\n"
    )
    assert running.files() == {"fig2.json": PARTIAL}


@pytest.mark.parametrize(
    "size",
    [
        "",
        "lots",
        "500",
        "-1G",
        "1e3M",
        "nan",
        "1M",
        "0G",
        "1GG",
        "٥٠٠M",
        "9" * 10**6,
        "99999999999T",
        "1/2G",
    ],
)
def test_nonsense_for_a_size(capfd: pytest.CaptureFixture[str], size: str) -> None:
    with pytest.raises(ConfigError):
        bound_of(size)
    assert run(["classify", str(FIG2), "--max-memory", size]) == 2
    errors = capfd.readouterr().err
    assert errors.startswith("error: --max-memory: ")
    assert errors.count("\n") == 1
    assert len(errors) < 200


@linux
def test_the_memory_limit_is_taken_back(tmp_path: Path) -> None:
    """The command line as a function leaves its caller's limits as they were."""
    before = resource.getrlimit(resource.RLIMIT_DATA)
    assert (
        run(
            [
                "classify",
                str(FIG2),
                "--out",
                str(tmp_path),
                "--format",
                "json",
                "--max-memory",
                "8G",
            ]
        )
        == 0
    )
    assert resource.getrlimit(resource.RLIMIT_DATA) == before


@linux
def test_the_default_bound_is_below_the_machine() -> None:
    size, _ = default_bound()
    assert 0 < size < os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


@linux
def test_a_computation_that_the_system_kills(tmp_path: Path) -> None:
    running = Running(tmp_path, IN_C)
    os.kill(running.arrive(), signal.SIGKILL)
    status, errors = running.end()
    assert (status, errors.count("\n")) == (3, 1)
    assert "most likely because memory ran out" in errors
    assert running.files() == {"fig2.json": PARTIAL}


@linux
@pytest.mark.parametrize(
    ("number", "said"), [(signal.SIGSEGV, ""), (signal.SIGABRT, "impossible inverse")]
)
def test_a_crash_is_not_taken_for_a_limit(
    tmp_path: Path, number: signal.Signals, said: str
) -> None:
    """What the library said last is shown; the old result stays."""
    old = put(tmp_path, json="old")
    work = (
        "import resource\n"
        "def engine(progress, partial):\n"
        "    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))\n"
        f"    os.write(2, {said!r}.encode())\n"
        f"    os.kill(os.getpid(), {number})\n"
    )
    running = Running(tmp_path, work)
    status, errors = running.end()
    assert status == 128 + number
    assert errors.startswith(said)
    assert f"crashed ({number.name})" in errors
    assert running.files() == old


# Full disks and closed pipes


@pytest.fixture
def full_disk(tmp_path: Path) -> Iterator[Path]:
    """A folder of a file system without room, with an old result in it."""
    folder = tmp_path / "full"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", str(folder)]
    done = (
        subprocess.run(mount, capture_output=True, text=True, check=False)
        if os.geteuid() == 0
        else None
    )
    if done is None or done.returncode:
        pytest.skip(
            f"no small file system can be mounted: {done.stderr.strip() if done else 'this is not root'}"
        )
    try:
        (folder / "fig2.json").write_text("old")
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def fill(folder: Path, left: int) -> None:
    """Take all room but so many bytes."""
    room = os.statvfs(folder)
    (folder / "filler").write_bytes(bytes(max(0, room.f_bavail * room.f_frsize - left)))


def classified(folder: Path, *options: str, formats: str = "json", **popen: Any) -> tuple[int, str]:
    arguments = ["classify", str(FIG2), "--out", str(folder), "--format", formats, *options]
    process = [sys.executable, "-m", "ptmcad", *arguments]
    done = subprocess.run(process, cwd=ROOT, capture_output=True, text=True, check=False, **popen)
    return done.returncode, done.stderr


@linux
@pytest.mark.parametrize("left", [0, 4096], ids=["from the start", "while writing"])
@pytest.mark.slow_cases("while writing")
def test_a_full_disk(full_disk: Path, left: int) -> None:
    fill(full_disk, left)
    status, errors = classified(full_disk)
    assert (status, errors.count("\n")) == (2, 1)
    assert "No space left on device" in errors
    assert sorted(os.listdir(full_disk)) == ["fig2.json", "filler"]
    assert (full_disk / "fig2.json").read_text() == "old"


@linux
def test_a_full_disk_for_a_stopped_result(full_disk: Path, tmp_path: Path) -> None:
    (full_disk / "fig2.json").unlink()
    (tmp_path / "out").symlink_to(full_disk)
    running = Running(tmp_path, NEVER + FILLING, "--timeout", "1000")
    status, errors = running.end()
    assert (status, errors.count("\n")) == (2, 1)
    assert "No space left on device" in errors
    assert os.listdir(full_disk) == ["filler"]


@linux
def test_a_file_that_may_not_grow(tmp_path: Path) -> None:
    """The same without root: the process may write files of 2000 bytes at most."""
    (tmp_path / "fig2.json").write_text("old")
    limit = (2000, 2000)
    status, errors = classified(
        tmp_path, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    )
    assert (status, errors.count("\n")) == (2, 1)
    assert "File too large" in errors
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"fig2.json": "old"}


@pytest.mark.parametrize(
    ("arguments", "reader", "statuses"),
    [
        ("--help", "true", {0}),
        ("classify --help", "head -1", {0}),
        (f"classify {FIG2} --format json --out new", "head -1", {0}),
        (f"classify {FIG2} --format json --out new", "true", {0}),
        ("verify fig2.json", "true", {0}),
        ("verify wrong.json", "true", {1}),
        pytest.param("locate fig2.json --csv points.csv", "head -1", {0}, marks=pytest.mark.slow),
        ("classify nothing.yaml 2>&1", "true", {2}),
    ],
)
@pytest.mark.slow_cases("--help-true-statuses0", "verify wrong.json-true-statuses5")
def test_a_reader_that_leaves(
    shipped: Callable[..., Any], tmp_path: Path, arguments: str, reader: str, statuses: set[int]
) -> None:
    """Quietly, with the files saved, and with the status that it would have had."""
    text = shipped("fig2").to_json()
    (tmp_path / "fig2.json").write_text(text)
    stored = json.loads(text)
    stored["cells"][0]["total"] += 2
    (tmp_path / "wrong.json").write_text(json.dumps(stored))
    (tmp_path / "points.csv").write_text("rho,L2\n" + "7/10,3/2\n" * 3000)
    script = f"{{ '{sys.executable}' -m ptmcad {arguments}; echo $? >status; }} | {reader}"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        ["sh", "-c", script],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    assert int((tmp_path / "status").read_text()) in statuses
    assert done.stderr.replace("violated", "").count("\n") <= (1 in statuses)
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr
    if "--out new" in arguments:
        assert ptmcad.RegionMap.from_json((tmp_path / "new" / "fig2.json").read_text()).regions


# The parts


@given(
    st.lists(
        st.tuples(
            st.sampled_from(Topic), st.lists(st.text("aä\n ", max_size=5), min_size=1, max_size=3)
        )
    ),
    st.integers(1, 40),
    st.integers(0, 60),
)
def test_messages_arrive_whole_or_not_at_all(
    messages: list[tuple[Topic, list[str]]], chunk: int, lost: int
) -> None:
    """In whatever pieces they come, and wherever the sender was killed."""
    with tempfile.TemporaryFile() as file:
        Own.pipe = file.fileno()
        try:
            for topic, texts in messages:
                send(topic, *texts)
        finally:
            Own.pipe = None
        file.seek(0)
        data = file.read()
    kept = data[: max(0, len(data) - lost)]
    waiting, found = bytearray(), list[tuple[Topic, list[str]]]()
    for k in range(0, len(kept), chunk):
        waiting += kept[k : k + chunk]
        found += received(waiting)
    assert found == messages[: len(found)]
    if lost == 0:
        assert found == messages


@pytest.mark.parametrize("old", [{}, {"fig2.json": "old"}, {"fig2.json": PARTIAL}])
def test_where_a_stopped_result_goes(tmp_path: Path, old: Mapping[str, str]) -> None:
    for name, text in old.items():
        write_files(tmp_path, {name: text_writer(text)})
    place, _ = save_stopped(tmp_path / "fig2.json", PARTIAL + " ")
    assert place.name == ("fig2.partial.json" if "old" in old.values() else "fig2.json")
    assert place.read_text() == PARTIAL + " "


def test_a_signal_is_not_raised_where_compiled_code_unpickles() -> None:
    """Numba's code crashes when that fails: the signal comes again once the function has returned."""
    program = """
import os, signal, time
from ptmcad.process.supervisor import supervise
def _numba_unpickle():
    os.kill(os.getpid(), signal.SIGTERM)
    return sum(range(1000))
def work():
    found = []
    try:
        found.append(_numba_unpickle())
        time.sleep(60)
    finally:
        print(found)
supervise(work, [signal.SIGTERM])
"""
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stdout) == (128 + signal.SIGTERM, "[499500]\n")
