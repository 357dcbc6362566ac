"""A sweep's folder under planted links, changed results, full disks, damaged indexes: what is said,
and what stays.
"""

from __future__ import annotations

import errno
import json
import os
import resource
import shutil
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

import ptmcad
from ptmcad.cli import run
from ptmcad.errors import ConfigError

RECORD = """\
name: cusps
system:
  unknowns: {x: real}
  parameters: {d: {kind: length, default: 1}}
  potential: "x^4/4 + (a + c)*x^2/2 + d*b*x"
axes: {a: [-2, 2], b: [-1, 1]}
sweep: {c: [0, 1], d: VALUES}
"""
FEW, MANY = "[1, 2]", "{from: 1, to: 2, steps: 20}"
OPTIONS = ("--no-ranges", "--no-areas", "--jobs", "1")


@pytest.fixture(name="record")
def record_fixture(tmp_path: Path) -> Path:
    path = tmp_path / "cusps.yaml"
    path.write_text(RECORD.replace("VALUES", FEW), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("swept")
    path = folder / "cusps.yaml"
    path.write_text(RECORD.replace("VALUES", FEW), encoding="utf-8")
    assert run(["sweep", str(path), "--out", str(folder / "out"), *OPTIONS, "--format", "csv"]) == 0
    return folder / "out"


@pytest.fixture(name="whole")
def whole_fixture(swept: Path, tmp_path: Path) -> Path:
    """A folder of its own with the finished sweep."""
    return Path(shutil.copytree(swept, tmp_path / "whole"))


@pytest.fixture(name="said", autouse=True)
def said_fixture(capsys: pytest.CaptureFixture[str]) -> Iterator[pytest.CaptureFixture[str]]:
    capsys.readouterr()
    yield capsys


def sweep(record: Path, folder: Path, *more: str) -> int:
    return run(["sweep", str(record), "--out", str(folder), *OPTIONS, *more])


def one_error(capsys: pytest.CaptureFixture[str]) -> str:
    """The one line that standard error holds."""
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    return line


# ---------------------------------------------------------------------------------------------------------------- links


def test_planted_links_to_a_file_are_not_written_through(record: Path, tmp_path: Path) -> None:
    """Neither under a result's name nor under the temporary one that earlier versions used."""
    precious = tmp_path / "precious"
    precious.write_text("mine", encoding="utf-8")
    results = tmp_path / "out" / "results" / "000"
    results.mkdir(parents=True)
    for name in (".000000.json.tmp", "000001.json", ".000002.json.00000000.tmp"):
        (results / name).symlink_to(precious)
    assert sweep(record, tmp_path / "out") == 0
    assert precious.read_text(encoding="utf-8") == "mine"
    assert sorted(path.name for path in results.iterdir()) == [f"00000{k}.json" for k in range(4)]
    assert not any(path.is_symlink() for path in results.iterdir())


@pytest.mark.parametrize(
    "name", ["results", "results/000", "index.sqlite", "index.sqlite-wal", "index.sqlite-shm"]
)
def test_a_link_out_of_the_folder_is_refused(
    record: Path, tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    outside, link = tmp_path / "outside", tmp_path / "out" / name
    outside.mkdir()
    link.parent.mkdir(parents=True)
    for target in (outside, tmp_path / "not-there"):
        link.unlink(missing_ok=True)
        link.symlink_to(target)
        assert sweep(record, tmp_path / "out") == 2
        assert (
            f"{link}: is or lies behind a link that leads out of the sweep's folder"
            in one_error(capsys)
        )
        assert not list(outside.iterdir()) and not (tmp_path / "not-there").exists()


def test_a_result_behind_a_link_is_not_read(whole: Path, record: Path, tmp_path: Path) -> None:
    result = whole / "results" / "000" / "000002.json"
    result.rename(tmp_path / "elsewhere.json")
    result.symlink_to(tmp_path / "elsewhere.json")
    assert sweep(record, whole) == 2


def test_hidden_files_of_a_killed_run_are_removed(whole: Path, record: Path) -> None:
    left = whole / "results" / "000" / ".000001.01234567.tmp.json"
    left.write_text("{", encoding="utf-8")
    assert sweep(record, whole) == 0
    assert not left.exists()


def test_an_index_that_is_a_pipe_is_refused_at_once(whole: Path, record: Path) -> None:
    (whole / "index.sqlite").unlink()
    os.mkfifo(whole / "index.sqlite")
    assert sweep(record, whole) == 2


# -------------------------------------------------------------------------------------------------------------- changes


@pytest.mark.parametrize("kind", ["", "csv", "html", "gif"])
@pytest.mark.parametrize("size", ["same", "another"])
@pytest.mark.slow_cases("same-csv")
def test_a_changed_result_is_noticed_by_every_format_and_not_written_over(
    whole: Path, record: Path, kind: str, size: str, capsys: pytest.CaptureFixture[str]
) -> None:
    result = whole / "results" / "000" / "000002.json"
    text = result.read_text(encoding="utf-8")
    changed = text.replace("-2", "-1", 1) if size == "same" else f"\ufeff{text}"
    result.write_text(changed, encoding="utf-8")
    before = (whole / "cusps.csv").read_bytes()
    assert sweep(record, whole, *(["--format", kind] if kind else [])) == 2
    assert f"{result}: has been changed since it was computed" in one_error(capsys)
    assert (
        result.read_text(encoding="utf-8") == changed
        and (whole / "cusps.csv").read_bytes() == before
    )
    if kind == "csv":
        result.unlink()  # as the message says
        assert sweep(record, whole) == 0
        assert result.read_text(encoding="utf-8") == text


# -------------------------------------------------------------------------------------------------------- damaged index

DAMAGES = {
    "areas are cut": (
        "UPDATE members SET areas = '[[\"1\", 1' WHERE number = 2",
        "the row of member 2 is damaged",
    ),
    "areas are a number": (
        "UPDATE members SET areas = '5' WHERE number = 2",
        "the row of member 2 is damaged",
    ),
    "areas are deep": (
        f"UPDATE members SET areas = '{'[' * 100_000}'",
        "the row of member 0 is damaged",
    ),
    "an area is no number": ('UPDATE members SET areas = \'[["1", 1, ["a", "b"]]]\'', "is damaged"),
    "nothing is there": ("UPDATE members SET cells = NULL, areas = NULL", "is damaged"),
    "values are cut": (
        "UPDATE members SET parameters = '{' WHERE number = 3",
        "the row of member 3 is damaged",
    ),
    "values are a list": ("UPDATE members SET parameters = '[1]'", "is damaged"),
    "values are others": ('UPDATE members SET parameters = \'{"c": 1, "d": null}\'', "is damaged"),
    "another folder": (
        "UPDATE members SET file = '../../outside.json' WHERE number = 1",
        "the row of member 1 is",
    ),
    "an absolute path": (
        "UPDATE members SET file = '/etc/passwd' WHERE number = 1",
        "the row of member 1 is damaged",
    ),
    "bytes for a path": (
        "UPDATE members SET file = x'00ff' WHERE number = 1",
        "the row of member 1 is damaged",
    ),
    "another's result": (
        "UPDATE members SET same_as = 3 WHERE number = 2",
        "the row of member 2 is damaged",
    ),
    "no such state": (
        "UPDATE members SET state = 'perhaps' WHERE number = 2",
        "the row of member 2 is damaged",
    ),
    "no text": ("UPDATE members SET error = CAST(x'ff' AS TEXT)", "Could not decode"),
    "a row is gone": ("DELETE FROM members WHERE number = 1", "UNIQUE constraint failed"),
    "a column is gone": ("ALTER TABLE members DROP COLUMN seconds", "no such column: seconds"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_index_is_named_in_one_line(
    whole: Path, record: Path, damage: str, capsys: pytest.CaptureFixture[str]
) -> None:
    statement, said = DAMAGES[damage]
    rows = sqlite3.connect(whole / "index.sqlite")
    with rows:
        rows.execute(statement)
    rows.close()
    results = {path: path.read_bytes() for path in whole.rglob("*.json")}
    assert sweep(record, whole, "--format", "csv") == 2
    line = one_error(capsys)
    assert line.startswith(f"error: {whole / 'index.sqlite'}: ") and said in line
    assert {path: path.read_bytes() for path in whole.rglob("*.json")} == results


@pytest.mark.parametrize("size", [3, 9000])
def test_an_index_that_is_cut_off_is_named(
    whole: Path, record: Path, size: int, capsys: pytest.CaptureFixture[str]
) -> None:
    index = whole / "index.sqlite"
    index.write_bytes(index.read_bytes()[:size])
    assert sweep(record, whole) == 2
    assert f"{index}: " in one_error(capsys)
    if size == 3:
        index.unlink()  # as the message says
        assert sweep(record, whole, "--format", "csv") == 0


def test_who_reads_the_index_later_is_told_as_well(whole: Path, record: Path) -> None:
    found = ptmcad.sweep(record, whole, wanted={"areas": False, "along": ""})
    rows = sqlite3.connect(whole / "index.sqlite")
    with rows:
        rows.execute("UPDATE members SET file = '../cusps.yaml' WHERE number = 1")
    rows.close()
    for read in (lambda: list(found), found.table, found.to_csv, lambda: found.result(1)):
        with pytest.raises(ConfigError, match="the row of member 1 is damaged"):
            read()


# ----------------------------------------------------------------------------------------- disks, processes, schedulers


@pytest.fixture(name="many")
def many_fixture(tmp_path: Path) -> Path:
    path = tmp_path / "cusps.yaml"
    path.write_text(RECORD.replace("VALUES", MANY), encoding="utf-8")
    return path


@pytest.mark.parametrize("number", [7, 0])
@pytest.mark.slow_cases("0")
def test_a_full_disk_is_named_and_what_is_done_stays(
    many: Path,
    tmp_path: Path,
    number: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The disk is full when a file is flushed, as on file systems that allot space late."""
    flush, flushed = os.fsync, 0

    def full(descriptor: int) -> None:
        nonlocal flushed
        flushed += 1
        if flushed > number:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        flush(descriptor)

    folder = tmp_path / "out"
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        assert sweep(many, folder) == 2
    line = one_error(capsys)
    assert (
        f"{number:06}.json cannot be written: No space left on device; {number} of 40 members are done"
        in line
    )
    assert "the same command goes on" in line
    rows = sqlite3.connect(folder / "index.sqlite")
    done = [file for (file,) in rows.execute("SELECT file FROM members WHERE state = 'done'")]
    rows.close()
    assert len(done) == number and all(json.loads((folder / file).read_bytes()) for file in done)
    assert sorted(path.name for path in folder.rglob("*.json")) == sorted(
        Path(file).name for file in done
    )
    assert sweep(many, folder, "--format", "csv") == 0
    assert (folder / "cusps.csv").read_text(encoding="utf-8").count(",done,") == 40


@pytest.mark.slow
@pytest.mark.parametrize("size", [20_000, 60_000])
def test_files_that_may_not_grow_end_the_run_in_one_line(
    many: Path, tmp_path: Path, size: int
) -> None:
    """By the system's own limit: the index cannot grow then."""
    ended = subprocess.run(
        [sys.executable, "-m", "ptmcad", "sweep", str(many), "--out", str(tmp_path / "out"), *OPTIONS],
        capture_output=True, text=True, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
    )  # fmt: skip
    assert (
        ended.returncode == 2
        and len(ended.stderr.splitlines()) == 1
        and "index.sqlite: disk I/O" in ended.stderr
    )
    assert sweep(many, tmp_path / "out", "--format", "csv") == 0
    assert (tmp_path / "out" / "cusps.csv").read_text(encoding="utf-8").count(",done,") == 40


def test_results_are_on_disk_before_the_index_says_so(
    record: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever is flushed is no result of which the index knows already; all results are flushed."""
    folder, flush, said = tmp_path / "out", os.fsync, list[int]()

    def look(descriptor: int) -> None:
        flush(descriptor)
        rows = sqlite3.connect(folder / "index.sqlite")
        said.append(rows.execute("SELECT COUNT(*) FROM members WHERE state = 'done'").fetchone()[0])
        rows.close()

    monkeypatch.setattr(os, "fsync", look)
    assert sweep(record, folder) == 0
    assert said == [0, 1, 2, 3]


@pytest.mark.slow
def test_two_sweeps_at_once_in_one_folder(
    many: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = [
        sys.executable,
        "-m",
        "ptmcad",
        "sweep",
        str(many),
        "--out",
        str(tmp_path / "out"),
        *OPTIONS[1:],
    ]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as other:
        while not list((tmp_path / "out").rglob("*.json")):
            assert other.poll() is None
            time.sleep(0.01)
        assert sweep(many, tmp_path / "out") == 2
        assert "another process is working on the sweep in" in one_error(capsys)
        assert other.wait(300) == 0


@pytest.mark.slow
@pytest.mark.skipif(
    find_spec("distributed") is None, reason="distributed is not installed (ptmcad[distributed])"
)
def test_a_scheduler_that_dies_is_named_and_what_is_done_stays(many: Path, tmp_path: Path) -> None:
    from support.dask_cluster import scheduler_with_workers

    with scheduler_with_workers(1, tmp_path) as (address, _):
        command = [sys.executable, "-m", "ptmcad", "sweep", str(many), "--out", str(tmp_path / "out"), *OPTIONS[:1],
                   "--scheduler", address]  # fmt: skip
        run_ = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        while not list((tmp_path / "out").rglob("*.json")):
            assert run_.poll() is None
            time.sleep(0.01)
    (line,) = run_.communicate(timeout=120)[1].splitlines()
    assert run_.returncode == 2
    assert (
        line.startswith(f"error: the scheduler at {address} is gone; ")
        and "the same command goes on" in line
    )
