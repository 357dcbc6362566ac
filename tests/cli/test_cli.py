"""The command line's own logic, with a stand-in for the engine; and the real engine where it is
there.
"""

from __future__ import annotations

import errno
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from ptmcad.answer.regionmap import PlanStep, Status
from ptmcad.cli import COMMANDS, group, run
from ptmcad.errors import ConfigError, LimitReached, OutputError
from ptmcad.options import Options
from ptmcad.process.output import check_writable, text_writer, write_files
from ptmcad.show import render

ROOT = Path(__file__).resolve().parents[2]
FIG4 = ROOT / "configs" / "fig4.yaml"


class StandIn:
    """What the command line uses of a region map."""

    plan = (PlanStep("curves at infinity", False, "the unknowns are bounded", "infinity"),)

    cover = None
    status = Status.EXACT

    def __init__(self, name: str):
        self.name = name

    def to_json(self, timings: bool = True) -> str:
        return json.dumps({"name": self.name, "timings": timings})

    def table(self) -> str:
        return f"table of {self.name}"


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Replace the engine and the pictures; the dictionary receives the arguments and may hold what
    to raise.
    """
    calls: dict[str, Any] = {}

    def region_map(slice: Any, options: Options) -> StandIn:
        calls.update(slice=slice, options=options)
        assert options.progress is not None
        options.progress("counts", 1, 2)
        if "raise" in calls:
            raise calls["raise"]
        return StandIn(slice.name)

    def draw(
        result: StandIn, path: Path, *, samples: bool = False, dpi: int = 150, **_how: object
    ) -> None:
        calls["samples"] = samples
        path.write_text(f"picture of {result.name}")
        if "draw raises" in calls:
            raise calls["draw raises"]

    import_module("ptmcad.ask.checking")  # with the real one, which it asks more of
    pipeline = ModuleType("ptmcad.ask.classification")
    pipeline.region_map = region_map  # type: ignore[attr-defined]
    pipeline.prepare = lambda *_: None  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "ptmcad.ask.classification", pipeline)
    monkeypatch.setitem(vars(render), "draw", draw)
    return calls


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_files_and_table(
    engine: dict[str, Any], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "folder"
    status = run(["classify", str(FIG4), "--out", str(out), "--samples", "--jobs", "2", "--area-tolerance", "1e-9",
                  "--timeout", "5", "--engine", "exact", "--count", "index"])  # fmt: skip
    assert status == 0
    assert names(out) == ["fig4.json", "fig4.png", "fig4.svg"]
    assert json.loads((out / "fig4.json").read_text()) == {"name": "fig4", "timings": True}
    captured = capfd.readouterr()
    written = ", ".join(str(out / f"fig4.{suffix}") for suffix in ("json", "png", "svg"))
    question = "question  fig4: rho in [0, 2], L2 in [0, 2]; F3 = -10, F4 = -10; count index"
    assert captured.out == f"{question}\ntable of fig4\nwritten   {written}\n"
    assert captured.err == "note: --jobs has no effect here: the exact engine uses one thread\n"
    options = engine["options"]
    assert (options.engine, options.jobs, options.timeout, engine["samples"]) == (
        "exact",
        2,
        5.0,
        True,
    )
    assert options.area_tolerance == Fraction(1, 10**9)
    assert engine["slice"].count.value == "index"


def test_slice_options_formats_and_explain(
    engine: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert (
        run(["classify", "--slice", "L2,rho", "--format", "JSON", "--explain", "--no-timings"]) == 0
    )
    assert names(tmp_path) == ["slice-L2-rho.json"]
    assert json.loads((tmp_path / "slice-L2-rho.json").read_text())["timings"] is False
    lines = capfd.readouterr().out.splitlines()
    assert lines[0] == "question  slice-L2-rho: L2 in [0, 4], rho in [0, 4]; count stable"
    assert lines[1] == "plan of slice-L2-rho, exact engine, before it starts:"
    assert lines[-4:-1] == ["decided on the way:", *map(str, StandIn.plan), "table of slice-L2-rho"]


def test_the_folder_is_checked_before_the_computation(
    engine: dict[str, Any], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    assert run(["classify", str(FIG4), "--out", str(blocked)]) == 2
    assert run(["classify", str(FIG4), "--out", str(blocked / "below")]) == 2
    (tmp_path / "fig4.png").mkdir()
    assert run(["classify", str(FIG4), "--out", str(tmp_path)]) == 2
    assert "slice" not in engine
    assert capfd.readouterr().err.count("error: ") == 3


@pytest.mark.skipif(
    hasattr(os, "geteuid") and os.geteuid() == 0, reason="root may write everywhere"
)
def test_a_folder_without_permission(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(OutputError, match="cannot be written to"):
            check_writable(tmp_path)
    finally:
        tmp_path.chmod(0o700)


@pytest.mark.parametrize(
    ("error", "status"),
    [(OSError(errno.ENOSPC, "No space left on device"), 2), (KeyboardInterrupt(), 130)],
    ids=["disk full", "Ctrl-C"],
)
def test_a_failed_picture_leaves_the_old_files(
    engine: dict[str, Any],
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    error: BaseException,
    status: int,
) -> None:
    for suffix in ("json", "png"):
        (tmp_path / f"fig4.{suffix}").write_text("old")
    engine["draw raises"] = error
    assert run(["classify", str(FIG4), "--out", str(tmp_path)]) == status
    saved = ["fig4.complete.json"] if status == 2 else []
    assert names(tmp_path) == [*saved, "fig4.json", "fig4.png"]
    assert all((tmp_path / f"fig4.{suffix}").read_text() == "old" for suffix in ("json", "png"))
    if status == 2:
        assert json.loads((tmp_path / saved[0]).read_text())["name"] == "fig4"
        assert "No space left on device" in capfd.readouterr().err


def test_a_limit_saves_the_partial_result(
    engine: dict[str, Any], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    engine["raise"] = LimitReached("5 s are over", StandIn("partial"))
    assert run(["classify", str(FIG4), "--out", str(tmp_path)]) == 3
    assert names(tmp_path) == ["fig4.json"]
    assert json.loads((tmp_path / "fig4.json").read_text())["name"] == "partial"
    place = tmp_path / "fig4.json"
    assert capfd.readouterr().err == f"stopped: 5 s are over; partial map saved to {place}\n"
    engine["raise"] = LimitReached("at once")
    assert run(["classify", str(FIG4), "--out", str(tmp_path / "empty")]) == 3
    assert names(tmp_path / "empty") == []


def test_engine_errors_have_status_2(engine: dict[str, Any], tmp_path: Path) -> None:
    engine["raise"] = ConfigError("no")
    assert run(["classify", str(FIG4), "--out", str(tmp_path)]) == 2


def test_sigterm_removes_the_temporary_files(tmp_path: Path) -> None:
    program = (
        "import sys, time, types\n"
        "pipeline, render = types.ModuleType('ptmcad.ask.classification'), types.ModuleType('ptmcad.show.render')\n"
        "class Result:\n"
        "    cover, status = None, types.SimpleNamespace(value='exact')\n"
        "    def to_json(self, timings): return 'new'\n"
        "def draw(result, path, **how):\n"
        "    path.write_text('half'); time.sleep(60)\n"
        "pipeline.region_map, pipeline.prepare = lambda slice, options: Result(), lambda *_: None\n"
        "render.draw = draw\n"
        "sys.modules.update({'ptmcad.ask.classification': pipeline, 'ptmcad.show.render': render})\n"
        "from ptmcad.__main__ import main\n"
        f"sys.argv = ['ptmcad', 'classify', {str(FIG4)!r}, '--out', {str(tmp_path)!r}, '--format', 'png']\n"
        "main()\n"
    )
    (tmp_path / "fig4.json").write_text("old")
    process = subprocess.Popen(
        [sys.executable, "-c", program], cwd=ROOT, stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 30
    while not any(path.read_text() == "half" for path in tmp_path.glob("*/*.png")):
        assert time.monotonic() < deadline, "nothing was drawn"
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate(timeout=30)
    assert process.returncode == 143
    assert errors == "terminated (SIGTERM); nothing was saved\n"
    assert names(tmp_path) == ["fig4.json"]
    assert (tmp_path / "fig4.json").read_text() == "old"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
def test_what_is_no_file_is_not_replaced(tmp_path: Path) -> None:
    """A rename would have removed a device; /dev/null itself, for the superuser."""
    os.mkfifo(tmp_path / "a.json")
    (tmp_path / "b.json").symlink_to("a.json")
    (tmp_path / "c.json").symlink_to("nowhere")
    for name in ("a.json", "b.json"):
        for attempt in (
            lambda name=name: check_writable(tmp_path, ("c.json", name)),
            lambda name=name: write_files(tmp_path, {name: text_writer("new")}),
        ):
            with pytest.raises(
                OutputError, match=rf"{name} is no regular file, so no file can be written there"
            ):
                attempt()
    write_files(tmp_path, {"c.json": text_writer("new")})
    assert names(tmp_path) == ["a.json", "b.json", "c.json"]
    assert not (tmp_path / "c.json").is_symlink()


def test_write_files_replaces_all_or_none(tmp_path: Path) -> None:
    (tmp_path / "b.json").mkdir()
    with pytest.raises(OutputError, match=r"b\.json is a folder, so no file can be written"):
        write_files(tmp_path, {"b.json": text_writer("new")})
    assert names(tmp_path) == ["b.json"]
    umask = os.umask(0o027)
    try:
        (written,) = write_files(tmp_path, {"a.json": text_writer("ä\n")})
    finally:
        os.umask(umask)
    assert written.read_bytes() == "ä\n".encode()
    if os.name == "posix":
        assert written.stat().st_mode & 0o777 == 0o640


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("redirection", [">/dev/full", ">&-", "| head -c0"])
@pytest.mark.slow_cases("| head -c0")
def test_a_table_that_can_not_be_printed_is_no_traceback(redirection: str) -> None:
    command = f"exec '{sys.executable}' -m ptmcad --help {redirection}"
    done = subprocess.run(
        ["sh", "-c", command], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr
    if redirection == ">/dev/full":
        assert done.returncode == 2
        assert "error: No space left on device" in done.stderr


def test_every_command_has_help_with_an_example(capfd: pytest.CaptureFixture[str]) -> None:
    assert run(["--help"]) == 0
    assert "ptmcad classify --slice L2,rho" in capfd.readouterr().out
    for name in COMMANDS:
        assert run([name, "--help"]) == 0
        assert f"ptmcad {name} " in capfd.readouterr().out
    assert run(["--version"]) == 0
    assert capfd.readouterr().out.startswith("ptmcad ")


def help_examples() -> list[str]:
    examples = []
    for name in COMMANDS:
        help_text = group.get_command(None, name).help or ""  # type: ignore[arg-type, union-attr]
        examples += re.findall(r"^\s*ptmcad (\w+ .*)$", help_text, flags=re.MULTILINE)
    return examples


FAMILY = """\
system: {unknowns: {x: real}, potential: "x^4/4 + (a + c)*x^2/2 + b*x"}
axes: {a: [-1, 1], b: [-1, 1]}
sweep: {c: [0, 1]}
"""
LONG = (
    "bench fig4",
    "bench --method",
    "stress all",
    "stress --random",
    "stress stiffness",
    "design fig4 --maximise area",
)
DOCUMENTED = ("--value barrier", "--over L2", "--value stiffness", "--value length:k1", "--path", "--quantity th1",
              "--surface", "--no-ranges", "--compare heavier", "--overlay")  # fmt: skip
"""In commands that the tests of README.md, of `ptmcad range`, its branches, fields, films,
surfaces, comparisons and measured points run too.
"""


@pytest.mark.usefixtures("coarse")
@pytest.mark.parametrize("example", [
    pytest.param(e, marks=pytest.mark.slow) if e.startswith(LONG) or any(d in e for d in DOCUMENTED) else e
    # the explorer never ends
    for e in help_examples() if not e.startswith(("classify", "explore", "paper")) and "--scheduler" not in e
])  # fmt: skip
@pytest.mark.slow_cases(
    "solve fig4 --at rho=7/10,L2=3/2 --format table,json,svg",
    "plot slice-L2-rho.json --format png,svg --dpi 300",
    "plot slice-L2-rho.json --style ieee --legend below --format pdf",
    "plot slice-L2-rho.json --at L2=1,rho=1 --at L2=3,rho=1/2",
    "sweep loads.yaml --format csv,html",
)
def test_help_examples_about_a_result_run(
    shipped: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, example: str
) -> None:
    """After the example's first line, which has written the result."""
    monkeypatch.chdir(tmp_path)
    Path("slice-L2-rho.json").write_text(shipped("fig2").to_json(), encoding="utf-8")
    Path("points.csv").write_text("rho,L2\n7/10,3/2\n", encoding="utf-8")
    Path("loads.yaml").write_text(FAMILY, encoding="utf-8")
    for folder in ("configs", "docs"):
        Path(folder).symlink_to(ROOT / folder)
    for name in ("measured.csv", "heavier.json"):
        source = Path("points.csv" if name.endswith("csv") else "slice-L2-rho.json")
        Path(name).write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
    if "--compare" in example:
        Path("out").mkdir()
        Path("out/fig4.bench.json").symlink_to(ROOT / "docs" / "benchmarks" / "fig4.bench.json")
    if "loads.json" in example:
        Path("free.yaml").write_text(
            "name: loads\n" + FAMILY.replace("sweep:", "free:"), encoding="utf-8"
        )
        assert (
            run(
                [
                    "classify",
                    "free.yaml",
                    "--changes",
                    "--members",
                    "2",
                    "--no-areas",
                    "--format",
                    "json",
                ]
            )
            == 0
        )
    assert run(shlex.split(example)) == 0


def test_help_examples_have_known_options(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Those too that take long."""
    monkeypatch.chdir(tmp_path)
    for folder in ("configs", "docs"):
        Path(folder).symlink_to(ROOT / folder)
    for name in (
        "slice-L2-rho.json",
        "heavier.json",
        "measured.csv",
        "points.csv",
        "out/fig4.bench.json",
    ):
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).touch()
    for example in help_examples():
        name, *arguments = shlex.split(example)
        command = group.get_command(None, name)  # type: ignore[arg-type]
        assert command is not None
        command.make_context(name, arguments)


@pytest.mark.parametrize(
    "example",
    [
        e
        for e in help_examples()
        if e.startswith("classify") and not ("--free" in e or "--surface" in e)
    ],
)
def test_help_examples_run(
    engine: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, example: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(shlex.split(example)) == 0
    assert names(tmp_path)


def test_start_up_is_lean() -> None:
    program = (
        "import sys, ptmcad.cli, ptmcad.cli.classify, ptmcad.question.config\n"
        "print([m for m in ('numpy', 'flint', 'sympy', 'matplotlib', 'asyncio') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
def test_pictures_of_a_window_narrower_than_any_float(tmp_path: Path) -> None:
    """1e-400 is no floating-point number."""
    options = [
        "classify",
        "--slice",
        "L2,rho",
        "--range",
        "rho=1/2:1/2+1e-400",
        "--out",
        str(tmp_path),
    ]
    assert run([*options, "--format", "json,png"]) == 0
    assert {path.suffix for path in tmp_path.iterdir()} == {".json", ".png"}
