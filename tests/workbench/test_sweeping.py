"""Sweeps: members equal single runs, share results, fail alone, and are computed once whatever
interrupts them.
"""

from __future__ import annotations

import os
import random
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import yaml

import ptmcad
from ptmcad import extras
from ptmcad.answer.sweep import State, Sweep
from ptmcad.cli import run
from ptmcad.cli import sweep as command
from ptmcad.errors import ConfigError, LimitReached, OutputError
from ptmcad.question.config.sweeps import sweep_from
from ptmcad.workbench.sweeps import index
from ptmcad.workbench.sweeps import run as engine
from ptmcad.workbench.sweeps.member import Outcome, Wanted, compute, computing
from ptmcad.workbench.sweeps.pool import Pool

ROOT = Path(__file__).resolve().parents[2]
AXES = {"rho": [0, 2], "L2": [0, 2]}
QUICK = Wanted(areas=False)
CUBIC = {
    "unknowns": {"x": "real"},
    "parameters": {"d": {"kind": "length", "default": 1}},
    "potential": "x^4/4 + (a + c)*x^2/2 + d*b*x",
}
PLANE = {"system": CUBIC, "axes": {"a": [-2, 2], "b": [-1, 1]}}
CUSPS = {"name": "cusps", **PLANE, "sweep": {"c": [0, 1], "d": [1, 2, 3]}}
SQUARES = {
    "name": "squares",
    **PLANE,
    "parameters": {"c": "F*F/100", "d": "L"},
    "sweep": [
        {"F": [0, 10, -10], "L": [1]},
        {"F": [1], "L": [1, 0]},
        {"F": ["10/1"], "L": ["2/2"]},
    ],
}
"""Two members have the slice of another one, and of one a length is zero."""


def mapped(record: dict[str, Any], folder: Path, **options: Any) -> Sweep:
    return ptmcad.sweep(record, folder, **{"jobs": 1, "wanted": QUICK, **options})


@pytest.mark.slow
def test_a_member_equals_the_record_classified_alone(tmp_path: Path) -> None:
    """In processes that have computed others before; all that the index says is of that document."""
    record = {
        "name": "few",
        "parameters": {"L1": 1, "F3": "F", "F4": "F"},
        "axes": AXES,
        "sweep": {"F": [0, -10]},
    }
    sweep = ptmcad.sweep(record, tmp_path / "few", jobs=1)
    assert (len(sweep), sweep.states, sweep.complete) == (2, {State.DONE: 2}, True)
    for member in sweep:
        load = int(member.parameters["F"])
        alone = ptmcad.classify(
            {"name": "few", "parameters": {"L1": 1, "F3": load, "F4": load}, "axes": AXES}
        )
        text = (tmp_path / "few" / member.file).read_text(encoding="utf-8")
        assert text == alone.to_json(timings=False)
        assert sha256(text.encode()).hexdigest() == member.digest
        assert sweep.result(member.number) == alone
        found = member.summary
        assert (found.status, found.cells, found.regions) == (
            "exact",
            len(alone.cells),
            len(alone.regions),
        )
        for area in found.areas:
            own = [region.area for region in alone.regions if region.stable == int(area.count)]
            assert area.regions == len(own)
            assert float(area.area[0]) == pytest.approx(float(sum(low for low, _ in own)))
        widest = ptmcad.operation_widths(alone.slice, "rho", 1).maxima
        assert float(found.widest.width[0]) == pytest.approx(float(widest[0].width.low))
        assert [float(low) for low, _ in found.widest.places] == pytest.approx(
            [float(m.at.low) for m in widest]
        )


def test_the_answer_can_be_read_in_several_ways(tmp_path: Path) -> None:
    sweep = mapped(CUSPS, tmp_path / "u")
    assert len(sweep) == 6 == len(list(sweep))
    assert sweep[4] == list(sweep)[4]
    assert sweep[4].parameters == {"c": "1", "d": "2"}
    with pytest.raises(IndexError):
        sweep[6]
    lines = repr(sweep).splitlines()
    assert lines[0] == "sweep cusps over c, d: 6 members, 6 done"
    assert len(lines) == 8
    frame = sweep.to_dataframe()
    assert list(frame["d"]) == [1.0, 2.0, 3.0] * 2
    assert frame["attempts"].tolist() == [1] * 6
    text = sweep.to_csv()
    assert text.splitlines()[0].startswith("member,c,d,state,status,same_as,")
    assert "seconds" not in text.splitlines()[0]
    assert (
        ptmcad.sweep(CUSPS, tmp_path / "u", wanted={"areas": False, "along": ""}).to_csv() == text
    )
    for wrong in ({"area": 1}, {"engine": "exactly"}, {"along": "c"}):
        with pytest.raises(ConfigError, match=r"options are|none of auto|no axis: choose a or b"):
            ptmcad.sweep(CUSPS, tmp_path / "w", wanted=wrong)


@pytest.mark.slow
def test_the_index_does_not_depend_on_the_number_of_processes(tmp_path: Path) -> None:
    texts = {mapped(SQUARES, tmp_path / str(jobs), jobs=jobs).to_csv() for jobs in (1, 3)}
    assert len(texts) == 1


# ------------------------------------------------------------------------------------------------------------ failures


def process_of(pool: Pool) -> subprocess.Popen[bytes]:
    """That of its only worker, once a thread has started it."""
    while (found := pool._workers[0].current) is None:
        time.sleep(0.001)
    return found.process


def test_a_worker_that_dies_fails_its_member_alone() -> None:
    """The members that waited at the dead one go to another; the one that failed can be given
    again.
    """
    pool = Pool(computing(sweep_from(CUSPS), QUICK), 1)
    try:
        pool.submit(0)
        pool.submit(1)
        assert not pool.room
        process_of(pool).kill()
        found = dict(pool.answers(None))
        assert found == {0: Outcome(State.FAILED, "its process was ended by SIGKILL")}
        pool.submit(0)
        while pool.busy:
            found |= dict(pool.answers(None))
        assert found[0].state is found[1].state is State.DONE
    finally:
        pool.close()


def test_an_unexpected_error_is_its_members_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    """And ends its process, of which the next member knows nothing."""
    question = sweep_from(CUSPS)
    broken = computing(question, Wanted(areas=False, engine="broken"))
    pool = Pool(broken, 1)
    try:
        pool.submit(0)
        pool.submit(1)
        found: dict[int, Any] = {}
        while pool.busy:
            found |= dict(pool.answers(None))
        assert found[0].state is State.REFUSED and "none of auto, exact" in found[0].error
        pool.submit(2)
        pool.submit(99)
        pool.submit(3)
        while pool.busy:
            found |= dict(pool.answers(None))
        assert found[99] == Outcome(State.FAILED, "IndexError: there is no member 99 of 6")
        assert found[3].state is State.REFUSED
    finally:
        pool.close()


def test_a_member_that_overruns_its_time_is_a_failure(tmp_path: Path) -> None:
    """Also in code that does not look at the clock: the process is killed, and the words are the
    same.
    """
    question = sweep_from(CUSPS)
    assert computing(question, Wanted(timeout=1e-6))(0) == Outcome(
        State.FAILED, "the member's time limit of 1e-06 s was reached"
    )
    pool = Pool(computing(question, Wanted(timeout=1e-3)), 1, 1e-3)
    try:
        pool.submit(0)
        process_of(pool).send_signal(signal.SIGSTOP)
        assert pool.answers(None) == [
            (0, Outcome(State.FAILED, "the member's time limit of 0.001 s was reached"))
        ]
    finally:
        pool.close()


def test_failures_are_recorded_tried_again_and_stop_no_other(tmp_path: Path) -> None:
    late = Wanted(areas=False, timeout=1e-6)
    sweep = mapped(CUSPS, tmp_path / "u", wanted=late, retries=2)
    assert sweep.states == {State.FAILED: 6}
    assert [member.attempts for member in sweep] == [3] * 6
    again = mapped(CUSPS, tmp_path / "u", wanted=late, retries=0)
    assert [member.attempts for member in again] == [4] * 6


def test_other_versions_and_orders_are_told_apart(tmp_path: Path) -> None:
    found = compute(sweep_from(CUSPS), QUICK, "0.0", 0)
    assert found.state is State.FAILED and found.error.endswith("the sweep was asked with 0.0")
    mapped(CUSPS, tmp_path / "u")
    for record, options in (({**CUSPS, "count": "total"}, {}), (CUSPS, {"wanted": Wanted()})):
        with pytest.raises(
            ConfigError, match="holds the sweep of another record, or other options"
        ):
            mapped(record, tmp_path / "u", **options)
    with (
        index.opened(tmp_path / "u"),
        pytest.raises(OutputError, match="another process is working on the sweep"),
    ):
        mapped(CUSPS, tmp_path / "u")


def test_a_time_limit_leaves_what_is_done(tmp_path: Path) -> None:
    with pytest.raises(
        LimitReached, match=r"of 0.001 s was reached; 0 of 6 members are done, in .*goes on"
    ):
        mapped(CUSPS, tmp_path / "u", timeout=1e-3)
    assert mapped(CUSPS, tmp_path / "u").complete


def test_a_result_that_is_lost_is_made_again_and_one_that_was_changed_is_told(
    tmp_path: Path,
) -> None:
    sweep = mapped(CUSPS, tmp_path / "u")
    text = sweep.to_csv()
    files = [tmp_path / "u" / member.file for member in sweep]
    files[1].unlink()
    files[3].write_text("{}", encoding="utf-8")
    changed = files[5].read_text(encoding="utf-8").replace("-2", "-1", 1)
    files[5].write_text(changed, encoding="utf-8")
    for number in (3, 5):  # by a run, which does not write over it, as by whoever reads it
        with pytest.raises(
            ConfigError, match=rf"00000{number}\.json: has been changed since it was computed"
        ):
            mapped(CUSPS, tmp_path / "u")
        with pytest.raises(
            ConfigError, match=rf"00000{number}\.json: has been changed since it was computed"
        ):
            sweep.result(number)
        files[number].unlink()
    assert mapped(CUSPS, tmp_path / "u").to_csv() == text
    assert [member.attempts for member in sweep] == [1, 2, 1, 2, 1, 2]
    (tmp_path / "u" / index.INDEX).write_bytes(b"no database" * 1000)
    with pytest.raises(ConfigError, match="is damaged, or no index of a sweep"):
        list(sweep)
    assert repr(sweep).startswith("<Sweep cusps: 6 members, which cannot be read in ")
    with pytest.raises(OutputError, match=r"index.sqlite: file is not a database"):
        mapped(CUSPS, tmp_path / "u")


# ------------------------------------------------------------------------------------------------------------- kill -9


def done_in(folder: Path) -> set[int]:
    """The members that the index says are done, by another process."""
    try:
        rows = sqlite3.connect(f"file:{folder / index.INDEX}?mode=ro", uri=True)
        found = {
            number for (number,) in rows.execute("SELECT number FROM members WHERE state = 'done'")
        }
        rows.close()
    except sqlite3.OperationalError:  # not there yet
        return set()
    return found


def interrupted(
    record: Path, folder: Path, kills: int, moment: Callable[[int], int], jobs: int
) -> int:
    """Runs that are killed when so many members are done; how many of the kills hit a run under
    way.
    """
    hits = 0
    command = [sys.executable, "-m", "ptmcad", "sweep", str(record), "--out", str(folder), "--no-ranges", "--no-areas",
               "--jobs", str(jobs)]  # fmt: skip
    for number in range(kills):
        before = done_in(folder)
        process = subprocess.Popen(
            command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )
        wanted = moment(number)
        while process.poll() is None and len(done_in(folder)) < wanted:
            time.sleep(0.005)
        victim = process.pid
        if number % 2:  # the process that computes, not the one that watches it
            children = Path(f"/proc/{victim}/task/{victim}/children")
            found = children.read_text().split() if children.exists() else []
            victim = int(found[0]) if found else victim
        hits += process.poll() is None
        os.kill(victim, signal.SIGKILL)
        process.communicate(timeout=60)
        assert before <= done_in(folder)
    return hits


def whole(record: dict[str, Any], folder: Path) -> Sweep:
    """The sweep as the command asks for it."""
    return ptmcad.sweep(record, folder, jobs=2, wanted=Wanted(areas=False))


def check_once(sweep: Sweep) -> None:
    """No member was recorded twice: what was done was not computed again."""
    assert {member.attempts for member in sweep} == {1}


FAMILY = {"name": "family", "parameters": {"L1": 1}, "axes": AXES,
          "sweep": {"F3": {"from": -10, "to": 0, "steps": 9}, "F4": {"from": -10, "to": 0, "steps": 9}}}  # fmt: skip


@pytest.mark.slow
def test_killed_at_ten_random_moments_it_leaves_the_same_index(tmp_path: Path) -> None:
    record = tmp_path / "family.yaml"
    record.write_text(yaml.safe_dump(FAMILY, sort_keys=False), encoding="utf-8")
    choose = random.Random(18)
    moments = sorted(choose.sample(range(80), 10))
    assert interrupted(record, tmp_path / "killed", 10, lambda k: moments[k], 2) >= 8
    sweep = whole(FAMILY, tmp_path / "killed")
    assert sweep.to_csv() == whole(FAMILY, tmp_path / "whole").to_csv()
    check_once(sweep)
    one, other = ({p.name: p.read_bytes() for p in (tmp_path / name / "results").rglob("*.json")}
                  for name in ("killed", "whole"))  # fmt: skip
    assert one == other


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="processes are looked up in /proc")
def test_workers_end_with_the_process_that_has_started_them(tmp_path: Path) -> None:
    """Whatever they do: this one would sleep for minutes and not look at anything."""
    (tmp_path / "sleeper.py").write_text(
        "import time\nfrom pathlib import Path\ndef sleep(number, check):\n"
        f"    Path({str(tmp_path / 'asleep')!r}).touch()\n    time.sleep(600)\n",
        encoding="utf-8",
    )
    code = (
        f"import os, signal, sys, time\nsys.path.append({str(tmp_path)!r})\nfrom sleeper import sleep\n"
        "from ptmcad.workbench.sweeps.pool import Pool\npool = Pool(sleep, 1)\npool.submit(0)\n"
        f"while not os.path.exists({str(tmp_path / 'asleep')!r}):\n    time.sleep(0.01)\n"
        "print(pool._workers[0].current.process.pid, flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    process = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert process.returncode == -signal.SIGKILL, process.stderr
    worker = Path("/proc") / process.stdout.strip()
    end = time.monotonic() + 10
    while worker.exists() and "Z" not in (worker / "stat").read_text().split(")")[1][:3]:
        assert time.monotonic() < end
        time.sleep(0.01)


# -------------------------------------------------------------------------------------------------------- command line


@pytest.fixture(name="squares")
def squares_fixture(tmp_path: Path) -> Path:
    path = tmp_path / "squares.yaml"
    path.write_text(yaml.safe_dump(SQUARES, sort_keys=False), encoding="utf-8")
    return path


def test_the_command(squares: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    arguments = [
        "sweep",
        str(squares),
        "--out",
        str(out),
        "--no-ranges",
        "--no-areas",
        "--jobs",
        "1",
        "--format",
        "csv",
    ]
    assert run(arguments) == 3
    said, err = capsys.readouterr()
    assert said.startswith("question  squares: a in [-2, 2], b in [-1, 1]; ")
    assert "\nsweep squares over F, L: 6 members, 5 done; 1 refused, as no map" in said
    assert err.startswith(f"stopped: 1 refused of 6 members, see {out}; the first is member 4: ")
    assert (out / "squares.csv").read_text(encoding="utf-8").count("\n") == 7
    assert (command.RETRIES, command.FORMATS[0]) == (engine.RETRIES, "csv")
    assert run([*arguments, "--along", "rho"]) == 2
    assert "--no-ranges" in capsys.readouterr().err
    assert run([*arguments[:4], "--along", "F"]) == 2
    assert "--along: F is no axis: choose a or b" in capsys.readouterr().err


def test_a_cluster_needs_its_extra(
    squares: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda _name: None)
    assert run(["sweep", str(squares), "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert "pip install 'ptmcad[distributed]'" in capsys.readouterr().err


def test_check_says_how_many_members_there_are(
    squares: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["check", str(squares)]) == 0
    said = capsys.readouterr().out
    assert "sweep       6 members over F, L" in said
    assert "first member" in said


# ---------------------------------------------------------------------------------------------------------- a cluster


@pytest.mark.slow
@pytest.mark.skipif(
    find_spec("distributed") is None, reason="distributed is not installed (ptmcad[distributed])"
)
def test_a_cluster_gives_the_same_index_although_a_worker_is_killed(tmp_path: Path) -> None:
    from support.dask_cluster import scheduler_with_workers

    with scheduler_with_workers(3, tmp_path) as (address, workers):
        killed = threading.Event()

        def kill(stage: str, done: int, _total: int) -> None:
            if done >= 20 and not killed.is_set():
                killed.set()
                workers[0].kill()

        there = ptmcad.sweep(
            FAMILY, tmp_path / "there", scheduler=address, wanted=QUICK, progress=kill
        )
    assert killed.is_set()
    assert there.to_csv() == whole(FAMILY, tmp_path / "here").to_csv()
