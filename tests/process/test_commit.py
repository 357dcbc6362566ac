"""Sets of files put into place: stopped or failing at every step, and what can be seen then."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
from collections.abc import Collection, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import combinations
from pathlib import Path

import pytest
from support.faulty_disk import FaultyDisk, Killed

from ptmcad.errors import OutputError
from ptmcad.process.output import (
    UNCHANGED,
    check_writable,
    locked,
    save_stopped,
    text_writer,
    write_files,
)

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="without locks nothing is removed")

NAMES = ("fig2.png", "fig2.svg", "fig2.json")
VOUCHER = NAMES[-1]
STEPS = 10
"""More than putting three files into place over three others, or taking that back, and tidying up
take.
"""
Files = dict[str, str]


@pytest.fixture(autouse=True)
def whole_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each test gets the real disk back, and does not wait for it."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)


def visible(folder: Path) -> Files:
    return {
        path.name: path.read_text()
        for path in sorted(folder.iterdir())
        if not path.name.startswith(".")
    }


def fill(folder: Path, files: Files) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, text in files.items():
        (folder / name).write_text(text)
    return folder


def subsets(names: Collection[str]) -> Iterator[tuple[str, ...]]:
    for size in range(len(names) + 1):
        yield from combinations(names, size)


class Case:
    """One set that replaces another in a folder, with files of others beside it."""

    others = {"fig3.json": "other", "fig2.pdf": "not of this run"}  # noqa: RUF012 - a constant

    def __init__(self, folder: Path, old: Collection[str]) -> None:
        self.old = {name: "old" for name in old} | self.others
        self.new = {**self.old, **dict.fromkeys(NAMES, "new")}
        self.folder = fill(folder, self.old)

    def look(self) -> None:
        """What anybody may see at any moment: no mixed set, and a voucher where there was one, or
        new pictures are.
        """
        seen = visible(self.folder)
        assert seen.items() >= self.others.items()
        mine = {name: text for name, text in seen.items() if name in NAMES}
        assert len(set(mine.values())) <= 1, mine
        if VOUCHER in self.old or "new" in mine.values():
            assert VOUCHER in mine, mine

    def disk(self, killed: int | None = None, failing: Collection[int] = ()) -> FaultyDisk:
        return FaultyDisk(killed, failing, self.look)

    def write(self, disk: FaultyDisk) -> str:
        """Write the new set on such a disk: "killed", "" for success, or the message."""
        try:
            with disk:
                write_files(self.folder, {name: text_writer("new") for name in NAMES})
        except Killed:
            return "killed"
        except OutputError as error:
            return str(error)
        else:
            return ""
        finally:
            self.look()

    def check_tidy(self) -> None:
        """A run that comes next changes nothing that can be seen, and leaves nothing else."""
        before = visible(self.folder)
        check_writable(self.folder, NAMES)
        assert visible(self.folder) == before
        assert set(os.listdir(self.folder)) == set(before)


OLDS = [
    pytest.param((NAMES,), id="a whole older set"),
    pytest.param(tuple(subsets(NAMES)), id="every older set", marks=pytest.mark.slow),
]


@pytest.mark.parametrize("olds", OLDS)
def test_killed_at_every_step(tmp_path: Path, olds: tuple[tuple[str, ...], ...]) -> None:
    """The voucher is the old or the new one, and pictures are missing at most."""
    seen = set()
    for old in olds:
        for killed in range(1, STEPS + 4):
            case = Case(tmp_path, old)
            ended = case.write(case.disk(killed))
            seen.add((ended, visible(tmp_path).get(VOUCHER)))
            wanted = case.new if visible(tmp_path).get(VOUCHER) == "new" else case.old
            assert visible(tmp_path).items() <= wanted.items()
            if killed == 1 or ended == "":
                assert visible(tmp_path) == wanted
            case.check_tidy()
    assert seen >= {("killed", "old"), ("killed", "new"), ("", "new")}


def failures(most: int) -> Iterator[tuple[int, ...]]:
    """Steps that fail: one, two, and all from one on, or all of a stretch."""
    yield from ((n,) for n in range(1, most))
    yield from combinations(range(1, most), 2)
    yield from (tuple(range(n, m)) for n in range(1, most) for m in range(n + 3, 3 * most, 4))


@pytest.mark.parametrize("olds", OLDS)
def test_errors_at_every_step(tmp_path: Path, olds: tuple[tuple[str, ...], ...]) -> None:
    """Wholly old, wholly new, or what is missing is named; and what is named is what is missing."""
    ends = set()
    for old in olds:
        for failing in failures(STEPS):
            case = Case(tmp_path, old)
            said = case.write(case.disk(failing=failing))
            seen = visible(tmp_path)
            missing = {name for name in {**case.old, **case.new} if name not in seen}
            if said == "":
                kind, wanted = "new", case.new
            elif said.endswith(f"; {tmp_path / VOUCHER} itself is saved"):
                kind, wanted = "saved", case.new
                assert said.startswith("cannot be put into place: ")
                assert missing
            elif said.endswith(f" cannot be written: Input/output error; {UNCHANGED}"):
                kind, wanted = "unchanged", case.old
                missing -= case.new.keys() - case.old.keys()
                assert not missing
            else:
                kind, wanted = "not put back", case.old
                assert (
                    " cannot be written: Input/output error; earlier files that cannot be put back: "
                    in said
                )
                missing -= case.new.keys() - case.old.keys()
                assert missing
                said = said.partition("put back: ")[2]
            assert seen == {name: text for name, text in wanted.items() if name not in missing}, (
                failing,
                said,
            )
            for name in NAMES[:-1]:
                assert (f"{tmp_path / name} (Input/output error)" in said) == (name in missing)
            ends.add(kind)
            case.check_tidy()
    assert ends == {"new", "saved", "unchanged", "not put back"}


@pytest.mark.parametrize("first", range(1, STEPS))
def test_errors_and_then_a_kill(tmp_path: Path, first: int) -> None:
    """Also while it is taken back: `look` sees to it."""
    for old in (NAMES, ("fig2.png",), ("fig2.svg", "fig2.json")):
        for killed in range(first + 1, STEPS + 2):
            case = Case(tmp_path, old)
            case.write(case.disk(killed, (first,)))
            case.check_tidy()


def test_a_single_file_takes_one_step(tmp_path: Path) -> None:
    fill(tmp_path, {"fig2.json": "old", "fig2.png": "old"})
    refused = pytest.raises(
        OutputError, match=rf"fig2\.json cannot be written: Input/output error; {UNCHANGED}"
    )
    with refused, FaultyDisk(failing=(1,)):
        write_files(tmp_path, {"fig2.json": text_writer("new")})
    assert visible(tmp_path) == {"fig2.json": "old", "fig2.png": "old"}
    write_files(tmp_path, {"fig2.json": text_writer("new")})
    assert visible(tmp_path) == {"fig2.json": "new", "fig2.png": "old"}
    assert set(os.listdir(tmp_path)) == {"fig2.json", "fig2.png"}


def test_under_new_names_what_is_saved_stays(tmp_path: Path) -> None:
    """A picture that cannot be put into place takes along neither the result nor the other picture."""
    for failing in range(1, STEPS):
        fill(tmp_path, {})
        try:
            with FaultyDisk(failing=(failing,)):
                write_files(tmp_path, {name: text_writer("new") for name in NAMES}, new=True)
        except OutputError as error:
            if not str(error).endswith("itself is saved"):
                assert visible(tmp_path) == {}
                continue
            (missing,) = (name for name in NAMES if name not in visible(tmp_path))
            assert f"{missing} (Input/output error); " in str(error)
        assert visible(tmp_path)[VOUCHER] == "new"
        assert set(visible(tmp_path).values()) == {"new"}


def test_two_runs_for_the_same_name_at_once(tmp_path: Path) -> None:
    """Whenever the folder's lock is free, all files are of one run."""
    fill(tmp_path, dict.fromkeys(NAMES, "old"))
    seen: set[str] = set()

    def run(text: str) -> None:
        for k in range(2000):
            if (
                k >= 15 and len(seen - {"old"}) > 1
            ):  # on a busy machine whoever looks may wait for long
                return
            check_writable(tmp_path, NAMES)
            write_files(tmp_path, {name: text_writer(text) for name in NAMES})

    with ThreadPoolExecutor(3) as pool:
        running = [pool.submit(run, text) for text in ("first", "second", "third")]
        while not all(future.done() for future in running):
            with locked(tmp_path):
                texts = tuple(visible(tmp_path).values())
            assert len(texts) == len(NAMES)
            assert len(set(texts)) == 1
            seen.add(texts[0])
        for future in running:
            future.result()
    assert len(seen & {"first", "second", "third"}) > 1
    assert set(os.listdir(tmp_path)) == set(NAMES)


def test_no_file_in_the_folder_is_obeyed(tmp_path: Path) -> None:
    """Neither a journal that an older version left, nor one that somebody planted."""
    new, old = ".fig2.00000000.tmp", ".fig2.00000000.old.json"
    journal = json.dumps({"format": "ptmcad-journal-1", "moves": [["fig2.json", new, old]]})
    for suffix in ("redo", "undo"):
        left = {f".fig2.00000001.{suffix}": journal, new: "new", old: "older"}
        fill(tmp_path, {"fig2.json": "old", "fig3.json": "other", **left})
        check_writable(tmp_path, ("fig3.json",))
        assert visible(tmp_path) == {"fig2.json": "old", "fig3.json": "other"}
        check_writable(tmp_path, ("fig2.json",))
        assert visible(tmp_path) == {"fig2.json": "old", "fig3.json": "other"}
        write_files(tmp_path, {"fig2.json": text_writer("newest")})
        assert visible(tmp_path) == {"fig2.json": "newest", "fig3.json": "other"}
        assert {name for name in os.listdir(tmp_path) if name.startswith(".")} == set(left)


# Where a stopped result goes

PARTIAL, WHOLE = json.dumps({"status": "partial"}), json.dumps({"status": "exact"})


@pytest.mark.parametrize(
    ("old", "whole", "place"),
    [
        ({}, False, "fig2.json"),
        ({}, True, "fig2.json"),
        ({"fig2.json": PARTIAL}, False, "fig2.json"),
        ({"fig2.json": PARTIAL}, True, "fig2.json"),
        ({"fig2.json": PARTIAL, "fig2.pdf": "of no concern"}, True, "fig2.json"),
        ({"fig2.json": PARTIAL, "fig2.png": "of the partial result"}, False, "fig2.partial.json"),
        ({"fig2.png": "of an earlier result"}, True, "fig2.complete.json"),
        ({"fig2.json": WHOLE}, False, "fig2.partial.json"),
        ({"fig2.json": WHOLE}, True, "fig2.complete.json"),
        ({"fig2.json": WHOLE, "fig2.partial.json": PARTIAL}, False, "fig2.partial.json"),
        ({"fig2.json": WHOLE, "fig2.partial.json": WHOLE}, False, "fig2.partial-2.json"),
        ({"fig2.json": WHOLE, "fig2.complete.json": WHOLE}, True, "fig2.complete.json"),
        ({"fig2.json": WHOLE, "fig2.complete.json": "?"}, True, "fig2.complete-2.json"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("busy", [False, True])
def test_a_stopped_result_loses_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, old: Files, whole: bool, place: str, busy: bool
) -> None:
    """Its name says truly whether it is complete; where another process stays in the folder it is
    no part of a set.
    """
    fill(tmp_path, old)
    target, beside = tmp_path / "fig2.json", ("fig2.png", "fig2.svg")
    text = WHOLE if whole else PARTIAL + " "
    held = os.open(tmp_path, os.O_RDONLY)
    if busy:
        monkeypatch.setattr("ptmcad.process.output.LOCK_PATIENCE", 0.02)
        fcntl.flock(held, fcntl.LOCK_EX)
    saved, why = save_stopped(target, text, whole=whole, beside=beside)
    os.close(held)
    if busy and place == "fig2.json":
        place = "fig2.complete.json" if whole else "fig2.partial.json"
    assert saved.name == place
    assert visible(tmp_path) == {**old, saved.name: text}
    assert set(os.listdir(tmp_path)) == set(visible(tmp_path))
    if saved == target:
        assert why == ""
    elif old.get("fig2.json") == WHOLE:
        assert why == ", because fig2.json holds an older result that is not partial"
    elif "fig2.png" in old:
        assert why == ", because fig2.png shows an older result"
    else:
        assert why == ", because another process is writing fig2.json"


@pytest.mark.parametrize(
    ("older", "newer", "replaced"),
    [
        ("1/50", "1/2", False),
        ("1/2", "1/50", True),
        ("1/50", "1/50", True),
        ("nonsense", "1/2", True),
    ],
)
def test_a_stopped_map_replaces_none_with_less_undetermined(
    tmp_path: Path, older: str, newer: str, replaced: bool
) -> None:
    def stopped(share: str) -> str:
        return json.dumps({"status": "partial", "cover": {}, "undetermined": share})

    target = tmp_path / "free02.json"
    target.write_text(stopped(older))
    place, why = save_stopped(target, stopped(newer))
    if replaced:
        assert (place, why) == (target, "")
    else:
        assert place.name == "free02.partial.json"
        assert why == ", because less is undetermined in the older partial result free02.json"
        assert target.read_text() == stopped(older)
    assert place.read_text() == stopped(newer)
