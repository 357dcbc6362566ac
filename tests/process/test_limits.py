"""Limits, and what else a caller may have set around the program: memory, descriptors, signals,
streams, settings.

Whatever they are, the program ends, with one message and a status that says why, and nothing that
is done is lost.
"""

from __future__ import annotations

import fcntl
import json
import os
import re
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from test_faults import FIG2, IN_C, PARTIAL, ROOT, Running, classified, linux

from ptmcad.cli import run
from ptmcad.cli.drawing import picture, write_result
from ptmcad.errors import ConfigError, PictureError
from ptmcad.process.memory import MIN_ROOM, bounded, loading
from ptmcad.process.streams import quiet_stream

pytestmark = linux
MIB = 1 << 20


def limited(which: int, soft: int, hard: int | None = None) -> Callable[[], None]:
    """What a shell's ``ulimit`` does, to be called in the new process."""
    return lambda: resource.setrlimit(which, (soft, soft if hard is None else hard))


# Memory


@pytest.mark.parametrize(
    ("which", "option"), [(resource.RLIMIT_AS, "-v"), (resource.RLIMIT_DATA, "-d")]
)
@pytest.mark.slow_cases("2--d")
def test_the_limit_that_was_reached_is_named(tmp_path: Path, which: int, option: str) -> None:
    """The caller's own, though the program has one too."""
    work = "def engine(progress, partial):\n    bytes(1 << 30)\n"
    running = Running(tmp_path, work, preexec_fn=limited(which, 300 * MIB))
    place = tmp_path / "out" / "fig2.json"
    assert running.end() == (
        3,
        f"stopped: the memory limit of 300M that the caller has set (ulimit {option}) was reached; "
        f"partial map saved to {place}\n",
    )
    assert running.files() == {"fig2.json": PARTIAL}


@pytest.mark.parametrize(
    ("end", "how"),
    [
        ("os.kill(os.getpid(), signal.SIGSEGV)", "SIGSEGV"),
        (
            "raise SystemError('error return without exception set')",
            "SystemError: error return without exception set",
        ),
    ],
)
@pytest.mark.slow_cases(
    "raise SystemError('error return without exception set')-SystemError: error return without exception set"
)
def test_a_crash_with_little_memory_left(tmp_path: Path, end: str, how: str) -> None:
    """No library said that it was for lack of memory, so the message says how it ended, and the
    result is kept.
    """
    work = (
        "import resource\n"
        "def engine(progress, partial):\n"
        "    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))\n"
        "    kept = bytes([1]) * (100 << 20)\n"
        f"    {end}\n"
    )
    running = Running(tmp_path, work, "--max-memory", "150M")
    status, errors = running.end()
    place = tmp_path / "out" / "fig2.json"
    assert (
        errors
        == f"stopped: most likely the memory limit of 150M was reached ({how}); partial map saved to {place}\n"
    )
    assert status == 3


def test_a_failure_with_memory_left_is_shown(tmp_path: Path) -> None:
    """A traceback is a bug's, also under a limit, and nothing is saved."""
    running = Running(tmp_path, "def engine(progress, partial):\n    [][0]\n", "--max-memory", "2G")
    status, errors = running.end()
    assert status == 1
    assert "IndexError" in errors
    assert "this is a bug" in errors
    assert running.files() == {}


NO_ROOM = """
import resource
from ptmcad.__main__ import main
with open("/proc/self/status") as file:
    used = next(int(line.split()[1]) for line in file if line.startswith("{counted}"))
resource.setrlimit(resource.{which}, (used + {spare} << 10, resource.RLIM_INFINITY))
main()
"""


@pytest.mark.parametrize("spare", [0, 256])
@pytest.mark.parametrize(
    ("which", "counted", "option"), [("RLIMIT_DATA", "VmData", "-d"), ("RLIMIT_AS", "VmSize", "-v")]
)
def test_a_limit_under_which_nothing_can_be_loaded_is_named(
    spare: int, which: str, counted: str, option: str
) -> None:
    """Not even what watches and knows of limits; what Python raises then is a MemoryError or
    something odd.
    """
    program = NO_ROOM.format(which=which, counted=counted, spare=spare)
    command = [sys.executable, "-c", program]
    ended = subprocess.run(
        command, check=False, capture_output=True, text=True, timeout=60, cwd=ROOT
    )
    assert ended.returncode == 2
    said = rf"error: ptmcad cannot start: .*, with the memory limit of [0-9]+K .* \(ulimit {option}\)\n"
    assert re.fullmatch(said, ended.stderr), ended.stderr


FAILING = """
import resource, sys
from ptmcad.__main__ import main

class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == "ptmcad.process.supervisor":
            raise {error}

sys.meta_path.insert(0, Finder())
resource.setrlimit(resource.RLIMIT_DATA, ({size} << 20, resource.RLIM_INFINITY))
main()
"""


@pytest.mark.parametrize(
    ("size", "named"),
    [(300, ", with the memory limit of 307200K that the caller has set (ulimit -d)"), (1024, "")],
)
@pytest.mark.parametrize(
    "error", ["MemoryError", "SystemError", "ImportError", "OSError", "SyntaxError"]
)
def test_whatever_python_makes_of_too_little_memory(error: str, size: int, named: str) -> None:
    """Its parser says that a colon was expected. A limit that is high enough for all libraries is
    not named.
    """
    command = [sys.executable, "-c", FAILING.format(error=f"{error}('in vain')", size=size)]
    ended = subprocess.run(
        command, check=False, capture_output=True, text=True, timeout=60, cwd=ROOT
    )
    assert (ended.returncode, ended.stderr) == (
        2,
        f"error: ptmcad cannot start: {error} in vain{named}\n",
    )


def test_what_waiting_for_the_child_needs_is_loaded_before_there_is_one() -> None:
    """os.wait4 imports a module for what it returns; where there was no room for it, the child was
    left alone.
    """
    program = "import sys\nfrom ptmcad.__main__ import main\nsys.modules['resource'] = None\nmain()"
    command = [sys.executable, "-c", program]
    ended = subprocess.run(
        command, check=False, capture_output=True, text=True, timeout=60, cwd=ROOT
    )
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr.startswith("error: ptmcad cannot start: ModuleNotFoundError ")


def test_a_bound_that_the_libraries_exceed_is_refused() -> None:
    status = Path("/proc/self/status").read_text()
    used = int(re.findall(r"VmData:\s+([0-9]+) kB", status)[0]) << 10
    before = resource.getrlimit(resource.RLIMIT_DATA)
    with bounded((used + 4 * MIN_ROOM, "100M")), loading("the engine"):
        assert resource.getrlimit(resource.RLIMIT_DATA) == before
    refused = pytest.raises(
        ConfigError, match=r"100M is too little for the engine, which has .*: at least [0-9]+M"
    )
    with bounded((used + MIN_ROOM // 2, "100M")):
        with refused as caught, loading("the engine"):
            assert resource.getrlimit(resource.RLIMIT_DATA) == before
        assert resource.getrlimit(resource.RLIMIT_DATA) != before
    least = int(re.findall("at least ([0-9]+)M", str(caught.value))[0])
    assert used + MIN_ROOM <= least * MIB < used + MIN_ROOM + 8 * MIB


def test_a_library_that_says_it_lacks_memory() -> None:
    with pytest.raises(MemoryError), loading("a library"):
        raise ImportError("libx.so: failed to map segment from shared object")
    with pytest.raises(ImportError), loading("a library"):
        raise ImportError("libx.so: no such file")


def test_a_library_that_does_not_say_why(monkeypatch: pytest.MonkeyPatch) -> None:
    """LLVM's loader says under a low limit on address space that its file is not found."""
    failure = OSError("Could not find/load shared object file 'libllvmlite.so'")
    for size, expected in ((200 * MIB, MemoryError), (1 << 40, OSError)):
        monkeypatch.setattr(
            "ptmcad.process.memory.caller_limits", lambda size=size: ((size, "a limit"),)
        )
        with pytest.raises(expected), loading("a library"):
            raise failure
        with pytest.raises(ModuleNotFoundError), loading("a library"):
            raise ModuleNotFoundError("No module named 'numba'")


@pytest.mark.slow
def test_the_callers_limit_on_processor_time(tmp_path: Path) -> None:
    for limits in ((1, 1), (1, 100)):
        work = "def engine(progress, partial):\n    while True:\n        pass\n"
        folder = tmp_path / str(limits[1])
        folder.mkdir()
        running = Running(folder, work, preexec_fn=limited(resource.RLIMIT_CPU, *limits))
        status, errors = running.end()
        assert status == 3
        assert errors.startswith(
            "stopped: the limit on processor time that the caller has set (ulimit -t) was reached; "
        )
        assert running.files() == {"fig2.json": PARTIAL}


SIZES = [round(20 * (1024 / 20) ** (k / 39)) for k in range(40)]
"""In MiB: from 20M to 1G."""
FREE = [
    *("--slice", "rho,L2", "--range", "rho=1/2:3/5", "--range", "L2=1:11/10"),
    *("--set", "l0=1/5", "--set", "F3=-10", "--set", "F4=-10", "--tolerance", "9/10"),
]
WITHOUT_SCIPY = """
import sys
class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "scipy":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Hidden())
"""


def ended(
    folder: Path, engine: str, scipy: bool, options: list[str], **popen: Any
) -> tuple[int, str, float]:
    """Exit status, standard error and seconds of a run in an empty folder."""
    hiding = folder / "hiding"
    hiding.mkdir(exist_ok=True)
    (hiding / "sitecustomize.py").write_text("" if scipy else WITHOUT_SCIPY)
    for path in folder.glob("out/*"):
        path.unlink()
    slice = FREE if engine == "certified" else [str(FIG2)]
    arguments = ["classify", *slice, "--out", str(folder / "out"), "--format", "json,png", *options]
    popen["env"] = {**os.environ, "PYTHONPATH": str(hiding)}
    started = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-m", "ptmcad", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        **popen,
    )
    return done.returncode, done.stderr, time.monotonic() - started


def judge(folder: Path, status: int, errors: str, limit: str) -> str:
    """What kind of an end it was; asserts that it is a proper one."""
    assert status in (0, 2, 3), (status, errors)
    assert errors.count("\n") == (status != 0), errors
    assert "Traceback" not in errors
    assert status == 0 or limit in errors, errors
    files = sorted(path.name for path in folder.glob("out/*") if not path.name.startswith("."))
    assert not list(folder.glob("out/.*"))
    saved = re.findall(
        r"(partial|complete) map(?: \([^)]* undetermined\))? saved to [^;]*/([^;/\s]*)", errors
    )
    if status == 0:
        assert len(files) == 2
    else:
        assert files == [name for _, name in saved]
    for name in files:
        if name.endswith(".json"):
            assert json.loads((folder / "out" / name).read_text())["status"]
    likely = ", most likely" if "most likely" in errors else ""
    return {0: "done", 2: "refused"}.get(
        status, f"stopped{likely}, {saved[0][0] if saved else 'nothing'} saved"
    )


def campaign(
    folder: Path, engine: str, scipy: bool, sizes: list[int]
) -> Iterator[tuple[int, int, str, float]]:
    """For each size in MiB: the status, the kind of end, the seconds."""
    for size in sizes:
        status, errors, seconds = ended(folder, engine, scipy, ["--max-memory", f"{size}M"])
        yield size, status, judge(folder, status, errors, f"{size}M"), seconds


@pytest.mark.slow
@pytest.mark.parametrize("scipy", [True, False], ids=["scipy", "no-scipy"])
@pytest.mark.parametrize("engine", ["exact", "certified"])
def test_every_size_of_memory(tmp_path: Path, engine: str, scipy: bool) -> None:
    assert ended(tmp_path, engine, scipy, ["--max-memory", "4G"])[0] == 0  # compiles what has to be
    kinds = [status for _, status, _, _ in campaign(tmp_path, engine, scipy, SIZES)]
    assert kinds[0] == 2
    assert kinds[-1] == 0
    order = [kinds.index(status) for status in (2, 3, 0) if status in kinds]
    assert order == sorted(order)


# Signals and descriptors


def with_everything_blocked() -> None:
    signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())


def with_children_ignored() -> None:
    for number in (signal.SIGCHLD, signal.SIGIO, signal.SIGPIPE):
        signal.signal(number, signal.SIG_IGN)


@pytest.mark.parametrize("caller", [with_everything_blocked, with_children_ignored])
def test_what_the_caller_made_of_signals(tmp_path: Path, caller: Callable[[], None]) -> None:
    """It is the caller's own; the program ends when its computation does, and when it is asked to."""
    running = Running(tmp_path, "", preexec_fn=caller)
    assert running.end() == (0, "")
    running = Running(tmp_path, IN_C, preexec_fn=caller)
    running.arrive()
    running.process.send_signal(signal.SIGTERM)
    assert running.end() == (143, "terminated (SIGTERM); nothing was saved\n")


def test_few_descriptors(tmp_path: Path) -> None:
    status, errors = classified(tmp_path, preexec_fn=limited(resource.RLIMIT_NOFILE, 8))
    assert (status, errors) == (2, "error: ptmcad cannot start: Too many open files\n")
    assert not list(tmp_path.iterdir())


# Streams


def test_no_room_for_messages(tmp_path: Path) -> None:
    arguments = [sys.executable, "-m", "ptmcad", "classify", "nothing.yaml"]
    with open("/dev/full", "w") as full:
        assert subprocess.run(arguments, cwd=ROOT, stderr=full, check=False).returncode == 2


def test_a_stream_that_does_not_block() -> None:
    """It is waited for, and nothing is lost."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    room = fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 4096)
    text = "".join(f"{number}\n" for number in range(3 * room))
    found = bytearray()

    def read() -> None:
        while data := os.read(reading, 1000):
            found.extend(data)

    reader = threading.Thread(target=read)
    reader.start()
    try:
        with open(os.devnull, "w") as like:
            stream = quiet_stream(writing, like)
        stream.write(text)
        stream.flush()
    finally:
        os.close(writing)
        reader.join()
        os.close(reading)
    assert found.decode() == text


# Pictures


NOTEBOOK = {"MPLBACKEND": "module://matplotlib_inline.backend_inline"}
NO_FOLDERS = {"HOME": "/proc", "XDG_CACHE_HOME": "/proc", "XDG_CONFIG_HOME": "/proc"}
PECULIAR = {
    "MPLBACKEND": "nonsense", "TERM": "dumb", "COLUMNS": "1", "LC_ALL": "C", "PYTHONWARNINGS": "error",
    "PYTHONOPTIMIZE": "2",
}  # fmt: skip


@pytest.mark.parametrize(
    "environment",
    [NOTEBOOK, *(pytest.param(each, marks=pytest.mark.slow) for each in (NO_FOLDERS, PECULIAR))],
    ids=["notebook", "no folders", "peculiar"],
)
def test_pictures_whatever_the_environment_says(
    tmp_path: Path, environment: dict[str, str]
) -> None:
    """Another backend, settings that are no text, no folder for caches: pictures as usual, and
    without a word.
    """
    settings = tmp_path / "settings"
    settings.write_bytes(b"backend: \xff\n")
    environment = {**os.environ, "MATPLOTLIBRC": str(settings), **environment}
    assert classified(tmp_path / "out", formats="json,png", env=environment) == (0, "")
    assert sorted(os.listdir(tmp_path / "out")) == ["fig2.json", "fig2.png"]


@pytest.mark.parametrize(
    "error", [KeyError("font"), OSError(28, "No space left on device"), RuntimeError("x\ny")]
)
def test_a_picture_that_fails_leaves_the_result(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    error: Exception,
) -> None:
    import ptmcad.show.render.mappicture

    def fail(*_: Any, **__: Any) -> None:
        raise error

    monkeypatch.setattr(ptmcad.show.render.mappicture, "draw", fail)
    arguments = ["classify", str(FIG2), "--out", str(tmp_path), "--format", "json,svg"]
    assert run(arguments) == 2
    errors = capfd.readouterr().err
    assert errors.startswith("error: fig2.svg cannot be drawn: ")
    assert errors.endswith(f"the result, without pictures, is in {tmp_path / 'fig2.json'}\n")
    assert errors.count("\n") == 1 and type(error).__name__ not in errors
    assert json.loads((tmp_path / "fig2.json").read_text())["status"] == "exact"
    assert os.listdir(tmp_path) == ["fig2.json"]
    # beside older pictures it would lie
    (tmp_path / "fig2.svg").write_text("older")
    assert run(arguments) == 2
    assert sorted(os.listdir(tmp_path)) == ["fig2.complete.json", "fig2.json", "fig2.svg"]


def test_lack_of_memory_is_no_failed_picture(tmp_path: Path) -> None:
    def fail(_: Path) -> None:
        raise MemoryError

    with pytest.raises(MemoryError):
        write_result(tmp_path, {"a.png": picture("a.png", fail)}, "a.json", "{}")
    with pytest.raises(
        PictureError,
        match=r"a\.png cannot be drawn: drawing failed unexpectedly: integer .*a\.json",
    ):
        write_result(tmp_path, {"a.png": picture("a.png", lambda _: 1 // 0)}, "a.json", "{}")  # type: ignore[arg-type,return-value]
