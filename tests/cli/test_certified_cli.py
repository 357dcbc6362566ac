"""``ptmcad classify`` with the certified engine: a stand-in that gives a map made by hand, and,
slowly, the engine.
"""

from __future__ import annotations

import io
import math
import os
import sys
import time
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import Any

import pytest
from support.certified_map import certified_map, free_slice
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.cli import run
from ptmcad.cli.progress import ProgressBar
from ptmcad.cover.rectangles import Cover
from ptmcad.errors import LimitReached
from ptmcad.options import Options
from ptmcad.process.handover import Own, Topic, received
from ptmcad.process.supervisor import OVERRUN_SECONDS, _Watch

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
    watch = _Watch(0, 0, 0, ())
    watch.reports[Topic.DEADLINE] = [repr(stopped), ""]
    assert watch._deadline() == math.inf
    watch.reports[Topic.DEADLINE] = [repr(again), "600 s"]
    assert watch._deadline() == again + OVERRUN_SECONDS


# ---------------------------------------------------------------------------------------------------- the real engine
