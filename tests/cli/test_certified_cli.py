"""``ptmcad classify`` with the certified engine: a stand-in that gives a map made by hand, and,
slowly, the engine.
"""

from __future__ import annotations

import io
import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import Any

import jsonschema
import pytest
from support.certified_map import certified_map, free_slice

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.cli import run
from ptmcad.cli.progress import ProgressBar
from ptmcad.cover.rectangles import Cover
from ptmcad.errors import ConfigError, LimitReached
from ptmcad.options import Options
from ptmcad.process.handover import Own, Topic, received
from ptmcad.process.supervisor import OVERRUN_SECONDS, Watch

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / "docs" / "region-map.schema.json").read_text(encoding="utf-8"))
HAND = ["--slice", "rho,L2", "--range", "rho=0:2", "--range", "L2=1:3", "--set", "l0=1/5", "--set", "F3=-10",
        "--set", "F4=-10", "--format", "json"]  # fmt: skip
"""The options of `free_slice`."""
SAVED = "slice-rho-L2.json"


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Replace the engine by one that gives `certified_map`; the dictionary receives the arguments."""
    calls: dict[str, Any] = {}

    def stand_in(slice: ptmcad.Slice, options: Options) -> RegionMap:
        calls.update(slice=slice, options=options)
        if options.progress is not None:
            options.progress("undetermined 28 %", 1, 2)
        if "stop" in calls:
            raise LimitReached(
                "the time limit was reached", partial=certified_map(slice.count, Status.PARTIAL)
            )
        return replace(certified_map(slice.count), slice=slice, timings={"curves": 1.0})

    compiled, module = (
        ModuleType("ptmcad.formulas.compilation"),
        ModuleType("ptmcad.certified.engine"),
    )
    module.certified_map = stand_in  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "ptmcad.formulas.compilation", compiled)
    monkeypatch.setitem(sys.modules, "ptmcad.certified.engine", module)
    loading = ModuleType("ptmcad.certified.loading")
    loading.load = lambda progress: 0.0  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "ptmcad.certified.loading", loading)
    # the map made by hand has more counts than its question needs, which a stored map must not have
    monkeypatch.setattr(
        "ptmcad.verification.certified.certificate.contradiction", lambda result: ""
    )
    return calls


def test_a_map_that_contradicts_itself_is_not_gone_on_from(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without its rectangles the cells of a map are not parted, and everything would pass as
    decided.
    """
    false = replace(
        certified_map(), slice=free_slice(), cover=Cover(certified_map().cover.steps, ())
    )
    path = tmp_path / "false.json"
    path.write_text(false.to_json(), encoding="utf-8")
    assert run(["classify", *HAND, "--out", str(tmp_path), "--resume", str(path)]) == 2
    assert "contradicts itself" in capsys.readouterr().err


def test_the_check_of_a_map_to_go_on_from_is_part_of_the_time_limit(
    engine: dict[str, Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The check is made to take 1000 seconds by the clock that is read; of 3600 there are 2600
    left.
    """
    assert run(["classify", *HAND, "--out", str(tmp_path)]) == 0
    clock = {"ahead": 0}
    real = time.monotonic
    monkeypatch.setattr(time, "monotonic", lambda: real() + clock["ahead"])

    def slow(result: RegionMap) -> str:
        clock["ahead"] += 1000
        return ""

    monkeypatch.setattr("ptmcad.verification.certified.certificate.contradiction", slow)
    options = ["--out", str(tmp_path), "--resume", str(tmp_path / SAVED), "--timeout"]
    for limit, least, most in (("3600", 2400, 2600), ("600", 0, 1)):
        engine.clear()
        begun = perf_counter()
        assert run(["classify", *HAND, *options, limit]) == 0
        assert least <= engine["options"].deadline - begun <= most + (perf_counter() - begun)


def test_auto_gives_free_lengths_to_the_certified_engine(engine: dict[str, Any]) -> None:
    before = perf_counter()
    result = ptmcad.classify(free_slice(), tolerance="1/50", timeout=100, jobs=2, count="total")
    options = engine["options"]
    assert (options.tolerance, options.jobs, options.resume) == (Fraction(1, 50), 2, None)
    assert before + 100 <= options.deadline <= perf_counter() + 100
    assert engine["slice"].count is ptmcad.Count.TOTAL
    assert result.timings.keys() == {"curves", "total"}
    engine.clear()
    ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho", ranges=["L2=1:2", "rho=0:1/2"]))
    assert not engine
    ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"), engine="certified")
    assert not engine["slice"].has_free_lengths


def test_a_result_to_files_and_on_from_it(
    engine: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["classify", *HAND, "--out", str(tmp_path), "--tolerance", "0.3", "--explain"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("question  slice-rho-L2: rho in [0, 2], L2 in [1, 3]; ")
    assert "plan of slice-rho-L2, certified engine, before it starts:" in lines[1:4]
    at = lines.index("decided on the way:")
    assert "left out: terms of F3x, F4x (they are zero on this slice)" in lines[:at]
    assert lines[at + 1].startswith("computed: fold of a stable equilibrium")
    assert lines[at + 2] == "regions   3 of 3 cells, certified"
    assert lines[-2].endswith("28 % undetermined; area bounds at most 9.7e-01 apart")
    assert lines[-1] == f"written   {tmp_path / SAVED}"
    stored = RegionMap.from_json((tmp_path / SAVED).read_text(encoding="utf-8"))
    assert stored == replace(certified_map(), slice=stored.slice)
    assert (
        run(
            [
                "classify",
                *HAND,
                "--out",
                str(tmp_path),
                "--resume",
                str(tmp_path / SAVED),
                "--jobs",
                "1",
            ]
        )
        == 0
    )
    assert engine["options"].resume.cover == certified_map().cover
    assert engine["options"].jobs == 1


def test_compilation_is_told_apart(
    engine: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    taken = [38.0, 0.0, 0.0, 0.0]
    monkeypatch.setattr(
        sys.modules["ptmcad.certified.loading"], "load", lambda progress: taken.pop(0)
    )
    assert run(["classify", *HAND, "--out", str(tmp_path)]) == 0
    assert " s, of which 38 s compilation (once); 28 % undetermined;" in capsys.readouterr().out
    timings = json.loads((tmp_path / SAVED).read_text(encoding="utf-8"))["timings"]
    assert timings["compilation"] == 38 and timings["total"] < 38
    assert run(["classify", *HAND, "--out", str(tmp_path)]) == 0
    assert "s compilation" not in capsys.readouterr().out


def test_the_engine_is_compiled_beforehand(
    engine: dict[str, Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    taken = [12.34, 0.0]
    monkeypatch.setattr(
        sys.modules["ptmcad.certified.loading"], "load", lambda progress: taken.pop(0)
    )
    assert run(["warm-up"]) == run(["warm-up"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said == [
        "the certified engine is compiled (12.3 s)",
        "the certified engine was compiled already",
    ]


def test_areas_cost_nothing(
    engine: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["classify", *HAND, "--out", str(tmp_path), "--no-areas"]) == 0
    said = capsys.readouterr()
    assert (
        said.err == "note: --no-areas has no effect here: this engine gets areas at no extra cost\n"
    )
    assert "\nareas     1: " in said.out


def test_the_time_limit_saves_the_map_so_far(
    engine: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    engine["stop"] = True
    assert run(["classify", *HAND, "--out", str(tmp_path), "--timeout", "5"]) == 3
    place = tmp_path / SAVED
    said = (
        f"stopped: the time limit was reached; partial map (28 % undetermined) saved to {place}; "
        f"go on with --resume {place}"
    )
    assert capsys.readouterr().err == f"{said}\n"
    assert (
        RegionMap.from_json((tmp_path / SAVED).read_text(encoding="utf-8")).status is Status.PARTIAL
    )
    del engine["stop"]
    assert run(["classify", *HAND, "--out", str(tmp_path), "--resume", str(tmp_path / SAVED)]) == 0
    assert (
        RegionMap.from_json((tmp_path / SAVED).read_text(encoding="utf-8")).status
        is Status.CERTIFIED
    )
    engine["stop"] = True
    assert run(["classify", *HAND, "--out", str(tmp_path), "--resume", str(tmp_path / SAVED)]) == 3
    assert "slice-rho-L2.partial.json, because" in capsys.readouterr().err


def test_without_numba_there_is_one_clear_message(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    loaded = [name for name in sys.modules if name.startswith("ptmcad.certified.")]
    for name in (*loaded, *({"ptmcad.formulas.compilation"} & sys.modules.keys())):
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "numba", None)
    assert run(["classify", *HAND, "--out", str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert "runs on the package numba" in message
    assert message.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_tolerances_are_checked_by_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for option in ("--tolerance", "--area-tolerance"):
        assert run(["classify", *HAND, "--out", str(tmp_path), option, "2"]) == 2
        assert f"error: {option}: 2 is not between 0 and 1" in capsys.readouterr().err
    assert run(["classify", *HAND, "--out", str(tmp_path), "--area-tolerance", "0.1"]) == 2
    assert "give tolerance instead" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("stage", "shown"),
    [("undetermined 1.3 %", "] undetermined 1.3 %, "), ("counts", "] counts 6 of 24, ")],
)
def test_the_progress_bar_shows_the_undetermined_share(
    stage: str, shown: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = io.StringIO()
    monkeypatch.setattr(terminal, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr("ptmcad.cli.progress.PATIENCE", 0)
    with ProgressBar() as progress:
        progress(stage, 6, 24)
    assert f"[######..................{shown}" in terminal.getvalue()


# ------------------------------------------------------------------------------- whole processes, a stand-in's engine

STAND_IN = """
import sys, time
from dataclasses import replace
from pathlib import Path
from types import ModuleType
here, tests = Path(sys.argv.pop(1)), sys.argv.pop(1)
sys.path.insert(0, tests)
from support import certified_map as by_hand
from ptmcad.errors import LimitReached
from ptmcad.answer.regionmap import Status
from ptmcad.question.slice import Count

def arrived():
    (here / "arrived").touch()
    time.sleep(60)
def load(progress):
    return 0.0
def search():
    pass
def draw(result, path, **how):
    path.write_text("a picture")
{work}
def certified_map(slice, options):
    options.partial(replace(by_hand.certified_map(Count.STABLE, Status.PARTIAL), slice=slice))
    search()
    return replace(by_hand.certified_map(Count.STABLE), slice=slice)
for name in ("compiled", "loading", "engine"):
    sys.modules["ptmcad.certified." + name] = ModuleType(name)
sys.modules["ptmcad.certified.loading"].load = load
sys.modules["ptmcad.certified.engine"].certified_map = certified_map
from ptmcad.__main__ import main
from ptmcad.show import render
render.draw = draw
main()
"""


def _stand_in(
    folder: Path, work: str, *options: str, stop: signal.Signals | None = None
) -> tuple[int, str]:
    """Run the program with this work, and end it by a signal when it has arrived where it stays;
    status and message.
    """
    program = STAND_IN.replace("{work}", work)
    arguments = [
        str(folder),
        str(Path(__file__).parents[1]),
        "classify",
        *HAND,
        "--out",
        str(folder / "out"),
        *options,
    ]
    with subprocess.Popen(
        [sys.executable, "-c", program, *arguments], cwd=ROOT, stderr=subprocess.PIPE
    ) as running:
        while stop is not None and not (folder / "arrived").exists():
            assert running.poll() is None, running.communicate()
            time.sleep(0.02)
        if stop is not None:
            running.send_signal(stop)
        _, errors = running.communicate()
    return running.returncode, errors.decode()


HOW_ENDED = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated (SIGTERM)",
    signal.SIGHUP: "the terminal was closed (SIGHUP)",
}
forked = pytest.mark.skipif(
    not hasattr(os, "fork"), reason="without fork the command line is not watched"
)


@forked
@pytest.mark.parametrize(
    "stop", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP], ids=lambda s: s.name
)
@pytest.mark.slow_cases("SIGINT", "SIGHUP")
def test_a_signal_saves_the_best_map_and_says_how_to_go_on(
    tmp_path: Path, stop: signal.Signals
) -> None:
    status, said = _stand_in(tmp_path, "search = arrived", stop=stop)
    place = tmp_path / "out" / SAVED
    assert status == 128 + stop
    assert said == (
        f"{HOW_ENDED[stop]}; partial map (28 % undetermined) saved to {place}; go on with --resume {place}\n"
    )
    assert RegionMap.from_json(place.read_text(encoding="utf-8")).status is Status.PARTIAL


@forked
def test_a_signal_before_the_first_map_says_that_there_is_none(tmp_path: Path) -> None:
    status, said = _stand_in(tmp_path, "def load(progress):\n    arrived()", stop=signal.SIGTERM)
    why = "the engine was still being loaded or compiled"
    assert (status, said) == (
        143,
        f"terminated (SIGTERM); there was no partial map to save yet: {why}\n",
    )
    assert not list((tmp_path / "out").iterdir())


def test_compiling_is_no_part_of_the_time_limit(
    engine: dict[str, Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """It takes 1000 seconds by the clock that is read, the limit is 600: for both processes 600 are
    left after it.
    """
    clock = {"ahead": 0}
    monotonic, counter = time.monotonic, perf_counter
    monkeypatch.setattr(time, "monotonic", lambda: monotonic() + clock["ahead"])
    monkeypatch.setattr(
        "ptmcad.ask.classification.perf_counter", lambda: counter() + clock["ahead"]
    )

    def load(progress: object) -> float:
        clock["ahead"] += 1000
        return 1000.0

    monkeypatch.setattr(sys.modules["ptmcad.certified.loading"], "load", load)
    begun, counted = monotonic(), counter()
    read, write = os.pipe()
    Own.pipe = write
    try:
        assert run(["classify", *HAND, "--out", str(tmp_path), "--timeout", "600"]) == 0
    finally:
        Own.pipe = None
        os.close(write)
    with open(read, "rb") as pipe:
        told = [
            (topic, float(texts[0]))
            for topic, texts in received(bytearray(pipe.read()))
            if topic is Topic.DEADLINE
        ]
    first, stopped, again = (at for _, at in told)
    taken = monotonic() - begun
    assert 600 <= first - begun <= 600 + taken
    assert stopped == math.inf
    assert 1600 <= again - begun <= 1600 + taken
    # the library loads once more, which takes no time outside of this test
    assert 2600 <= engine["options"].deadline - counted <= 2600 + taken
    watch = Watch(0, 0, 0, ())
    watch.reports[Topic.DEADLINE] = [repr(stopped), ""]
    assert watch._deadline() == math.inf
    watch.reports[Topic.DEADLINE] = [repr(again), "600 s"]
    assert watch._deadline() == again + OVERRUN_SECONDS


@forked
@pytest.mark.parametrize("options", [["--timeout", "1000"], []], ids=["time", "signal"])
def test_a_complete_map_is_not_lost_while_its_pictures_are_drawn(
    tmp_path: Path, options: list[str]
) -> None:
    out_of_time = "from ptmcad.process.handover import Topic, send; send(Topic.DEADLINE, repr(time.monotonic()), '1 s')"
    work = (
        f"def draw(result, path, **how):\n    {out_of_time if options else 'pass'}\n    arrived()"
    )
    stop = None if options else signal.SIGINT
    status, said = _stand_in(tmp_path, work, "--format", "json,png", *options, stop=stop)
    assert status == (3 if options else 130)
    assert "complete map (28 % undetermined) saved to" in said
    assert "--resume" not in said
    text = (tmp_path / "out" / SAVED).read_text(encoding="utf-8")
    assert RegionMap.from_json(text).status is Status.CERTIFIED


def test_a_run_that_goes_on_from_a_map_does_not_replace_it_by_a_worse_one() -> None:
    before = replace(certified_map(status=Status.PARTIAL), slice=free_slice())
    better = replace(before, undetermined=before.undetermined / 2)
    with pytest.raises(
        LimitReached, match="the map to go on from has no more, and is kept"
    ) as limit:
        _resumed_and_stopped(better, before)
    assert limit.value.partial == better
    with pytest.raises(LimitReached) as limit:
        _resumed_and_stopped(before, better)
    assert limit.value.partial == better


def _resumed_and_stopped(earlier: RegionMap, found: RegionMap) -> None:
    """Go on from a map, be handed another one, and be stopped with that."""
    handed: list[RegionMap] = []

    def stand_in(slice: ptmcad.Slice, options: Options) -> RegionMap:
        assert options.partial is not None
        options.partial(found)
        assert handed == ([found] if found.undetermined < earlier.undetermined else [])
        raise LimitReached("the time limit was reached", partial=found)

    loading, module = ModuleType("ptmcad.certified.loading"), ModuleType("ptmcad.certified.engine")
    loading.load = lambda progress: 0.0  # type: ignore[attr-defined]
    module.certified_map = stand_in  # type: ignore[attr-defined]
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(
            sys.modules, "ptmcad.formulas.compilation", ModuleType("ptmcad.formulas.compilation")
        )
        patch.setitem(sys.modules, "ptmcad.certified.loading", loading)
        patch.setitem(sys.modules, "ptmcad.certified.engine", module)
        ptmcad.classify(earlier.slice, resume=earlier, partial=handed.append)


# ---------------------------------------------------------------------------------------------------- the real engine

WINDOW = ["--slice", "rho,L2", "--range", "rho=1/2:1", "--range", "L2=5/4:7/4", "--set", "l0=1/5", "--set", "F3=-10",
          "--set", "F4=-10", "--format", "json"]  # fmt: skip


MARKING = """
import sys
import time
from pathlib import Path
from ptmcad.process import handover

marker, tell = Path(sys.argv.pop(1)), handover.send

def telling(topic, *texts):
    tell(topic, *texts)
    if topic is handover.Topic.RESULT:
        marker.touch()
        time.sleep(3600)

handover.send = telling
from ptmcad.__main__ import main
sys.exit(main())
"""
"""The program, which makes a file as soon as it has handed over a result, and gets no further."""


def _command(folder: Path, *options: str) -> list[str]:
    return [sys.executable, "-m", "ptmcad", "classify", *WINDOW, "--out", str(folder), *options]


def _done(folder: Path, *options: str) -> str:
    """Run to the end; the text of the result."""
    done = subprocess.run(
        _command(folder, *options), cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    return (folder / SAVED).read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_engine_stopped_by_ctrl_c_and_gone_on_with(tmp_path: Path) -> None:
    coarse = RegionMap.from_json(_done(tmp_path, "--tolerance", "0.1"))
    assert coarse.status is Status.CERTIFIED
    assert coarse.undetermined <= Fraction(1, 10)
    text = _done(tmp_path, "--tolerance", "0.02", "--resume", str(tmp_path / SAVED))
    jsonschema.validate(json.loads(text), SCHEMA, cls=jsonschema.Draft202012Validator)
    finer = RegionMap.from_json(text)
    assert finer.undetermined <= Fraction(1, 50)
    for cell in coarse.cells:
        found = finer.locate(**cell.sample)
        assert found.status is Status.UNDECIDED or found.stable == cell.stable
    marker = tmp_path / "handed-over"
    command = _command(tmp_path, "--tolerance", "1e-13", "--resume", str(tmp_path / SAVED))
    command[1:3] = ["-c", MARKING, str(marker)]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE) as stopped:
        while not marker.exists():
            assert stopped.poll() is None, "the computation ended before it had handed over a map"
            time.sleep(0.1)
        stopped.send_signal(signal.SIGINT)
        _, errors = stopped.communicate()
    assert stopped.returncode == 130
    assert re.match(
        r"interrupted; partial map \([0-9.e-]+ % undetermined\) saved to ", errors.decode()
    )
    assert "--resume" in errors.decode()
    partial = RegionMap.from_json(
        (tmp_path / "slice-rho-L2.partial.json").read_text(encoding="utf-8")
    )
    assert partial.status is Status.PARTIAL
    with pytest.raises(ConfigError, match="axes differs"):
        ptmcad.classify(free_slice(), resume=partial)
