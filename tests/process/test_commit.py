"""Sets of files put into place: stopped or failing at every step, and completed or taken back from there."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Collection, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import combinations, product
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.faulty_disk import FaultyDisk, Killed

from ptmcad.cli.stored import read_result
from ptmcad.errors import ConfigError, OutputError
from ptmcad.process import commit
from ptmcad.process.commit import UNCHANGED, UNFINISHED, recover
from ptmcad.process.journal import REDO, UNDO, journals
from ptmcad.process.output import check_writable, save_stopped, text_writer, where_saved, write_files

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="without locks nothing is recovered")

NAMES = ("fig2.png", "fig2.svg", "fig2.json")
STEPS = 12
"""More than putting three files into place over three others takes."""
Files = dict[str, str]


@pytest.fixture(autouse=True)
def whole_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each test gets the real disk back, and does not wait for it."""
    monkeypatch.setattr(commit, "disk", commit.disk)
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)


def visible(folder: Path) -> Files:
    return {path.name: path.read_text() for path in sorted(folder.iterdir()) if not path.name.startswith(".")}


def fill(folder: Path, files: Files) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.iterdir():
        path.unlink()
    for name, text in files.items():
        (folder / name).write_text(text)
    return folder


def subsets(names: Collection[str]) -> Iterator[tuple[str, ...]]:
    for size in range(len(names) + 1):
        yield from combinations(names, size)


class Case:
    """One set that replaces another in a folder, with files of others beside it."""

    others = {"fig3.json": "other", "fig2.pdf": "not of this run"}  # noqa: RUF012 - a constant

    def __init__(self, folder: Path, old: Collection[str], new: Collection[str] = NAMES, links: bool = True) -> None:
        self.old = {name: "old" for name in old} | self.others
        self.new = {**self.old, **{name: "new" for name in new}}
        self.names = tuple(new)
        self.links = self.voucher_stays = links
        self.folder = fill(folder, self.old)

    def look(self) -> None:
        """What anybody may see at any moment: no mixed set, and the voucher where it can be linked."""
        seen = visible(self.folder)
        voucher = self.names[-1]
        assert seen.items() >= self.others.items()
        mine = {name: text for name, text in seen.items() if name in self.names}
        pictures = {text for name, text in mine.items() if name != voucher}
        assert len(set(mine.values())) <= 1, mine
        if voucher in self.old and self.voucher_stays:
            assert voucher in mine, mine
        if voucher not in mine:
            assert pictures <= {"old"}, mine

    def disk(self, killed: int | None = None, failing: Collection[int] = ()) -> FaultyDisk:
        self.voucher_stays = self.voucher_stays and not failing  # the link may fail
        return FaultyDisk(killed, failing, self.links, self.look)

    def write(self, disk: FaultyDisk) -> str:
        """Write the new set on such a disk: "killed", "" for success, or the message."""
        commit.disk = disk
        try:
            write_files(self.folder, {name: text_writer("new") for name in self.names})
        except Killed:
            return "killed"
        except OutputError as error:
            return str(error)
        else:
            return ""
        finally:
            commit.disk = commit.Disk()
            self.look()

    def recover(self, disk: FaultyDisk) -> None:
        commit.disk = disk
        try:
            recover(self.folder)
        except Killed:
            pass
        finally:
            commit.disk = commit.Disk()
            self.look()

    def check_settled(self, expected: tuple[Files, ...]) -> None:
        """After recovery it is one of these, and a run that comes next leaves nothing else."""
        recover(self.folder)
        assert visible(self.folder) in expected
        check_writable(self.folder, NAMES)
        assert set(os.listdir(self.folder)) == set(visible(self.folder))


THOROUGH = [
    pytest.param(True, (NAMES,), id="a whole older set"),
    pytest.param(True, tuple(subsets(NAMES)), id="every older set", marks=pytest.mark.slow),
    pytest.param(False, tuple(subsets(NAMES)), id="every older set, no hard links", marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("links", "olds"), THOROUGH)
def test_killed_at_every_step_and_again_while_it_is_completed(
    tmp_path: Path, links: bool, olds: tuple[tuple[str, ...], ...]
) -> None:
    """Wholly the old set before the journal is in place, wholly the new one from then on."""
    seen = set()
    for old in olds:
        for killed in range(1, STEPS + 4):
            for again in range(1, STEPS):
                case = Case(tmp_path, old, links=links)
                ended = case.write(case.disk(killed))
                disk = case.disk(again)
                case.recover(disk)
                case.check_settled((case.old,) if killed == 1 else (case.new,))
                seen.add((ended, disk.dead))
                if not disk.dead:
                    break  # it was complete before it could be killed
    assert seen == {("killed", True), ("killed", False), ("", False)}


def failures(most: int) -> Iterator[tuple[int, ...]]:
    """Steps that fail: one, two, and all from one on, or all of a stretch."""
    yield from ((n,) for n in range(1, most))
    yield from combinations(range(1, most), 2)
    yield from (tuple(range(n, m)) for n in range(1, most) for m in range(n + 3, 3 * most, 4))


@pytest.mark.parametrize(("links", "olds"), THOROUGH)
def test_errors_at_every_step(tmp_path: Path, links: bool, olds: tuple[tuple[str, ...], ...]) -> None:
    """Wholly old or wholly new, as the message says; where neither can be had, the next one does it."""
    ends = set()
    for old in olds:
        for failing in failures(STEPS):
            case = Case(tmp_path, old, links=links)
            said = case.write(case.disk(failing=failing))
            ended = next((end for end in (UNCHANGED, UNFINISHED) if said.endswith(end)), said)
            ends.add(ended)
            if ended == UNFINISHED:
                (journal,) = journals(case.folder)
                case.check_settled((case.new if journal.path.suffix == REDO else case.old,))
                continue
            assert visible(case.folder) == (case.old if ended == UNCHANGED else case.new), (failing, said)
            assert not journals(case.folder) or ended == ""  # one whose removal failed has no effect
            case.check_settled((visible(case.folder),))
    assert ends == {"", UNCHANGED, UNFINISHED}


@pytest.mark.slow
def test_errors_and_then_a_kill(tmp_path: Path) -> None:
    """Also while it is taken back, and while that is done again by somebody else."""
    for old, first, killed, again in product((NAMES, ("fig2.png",)), range(2, 9), range(3, 18), (2, 4)):
        if killed > first:
            case = Case(tmp_path, old)
            case.write(case.disk(killed, (first,)))
            case.recover(case.disk(again))
            case.check_settled((case.old, case.new))


def test_an_error_while_another_set_is_completed(tmp_path: Path) -> None:
    """Reading goes on; a run that would write over it says so, and one in the same folder with other names does not."""
    case = Case(tmp_path, NAMES)
    case.write(case.disk(killed=3))
    commit.disk = case.disk(failing=range(1, 100))
    before = visible(tmp_path)
    with pytest.raises(ConfigError):  # the text is no map, but it is read
        read_result(tmp_path / "fig2.json")
    for write in (
        lambda: check_writable(tmp_path, NAMES),
        lambda: write_files(tmp_path, {"fig2.json": text_writer("newer")}),
    ):
        with pytest.raises(OutputError, match=r"\.fig2\..*\.redo holds files that a killed run"):
            write()
        assert visible(tmp_path) == before
    check_writable(tmp_path, ("fig3.json",))
    commit.disk = commit.Disk()
    case.check_settled((case.new,))


@pytest.mark.parametrize("reading", [True, False])
def test_who_comes_next_completes_it(tmp_path: Path, reading: bool) -> None:
    case = Case(tmp_path, NAMES)
    case.write(case.disk(killed=6))
    assert visible(tmp_path) != case.new
    if reading:
        with pytest.raises(ConfigError):
            read_result(tmp_path / "fig2.json")
    else:
        check_writable(tmp_path, ("fig3.json",))
    assert visible(tmp_path) == case.new


def test_what_a_live_process_does_is_left_to_it(tmp_path: Path) -> None:
    case = Case(tmp_path, NAMES)
    case.write(case.disk(killed=6))
    before = {path.name: path.read_text() for path in tmp_path.iterdir()}
    held = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    recover(tmp_path, patience=0.02)
    commit.finish(journals(tmp_path)[0].path, patience=0.02)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == before
    os.close(held)
    case.check_settled((case.new,))


def test_two_runs_for_the_same_name_at_once(tmp_path: Path) -> None:
    """Whenever the folder's lock is free, all files are of one run."""
    fill(tmp_path, dict.fromkeys(NAMES, "old"))
    seen: set[str] = set()

    def run(text: str) -> None:
        for k in range(2000):
            if k >= 15 and len(seen - {"old"}) > 1:  # on a busy machine whoever looks may wait for long
                return
            check_writable(tmp_path, NAMES)
            write_files(tmp_path, {name: text_writer(text) for name in NAMES})

    with ThreadPoolExecutor(3) as pool:
        running = [pool.submit(run, text) for text in ("first", "second", "third")]
        while not all(future.done() for future in running):
            with commit.locked(tmp_path):
                texts = tuple(visible(tmp_path).values())
            assert len(texts) == len(NAMES)
            assert len(set(texts)) == 1
            seen.add(texts[0])
        for future in running:
            future.result()
    assert len(seen & {"first", "second", "third"}) > 1
    assert set(os.listdir(tmp_path)) == set(NAMES)


def test_journals_that_this_program_has_not_written(tmp_path: Path) -> None:
    """They are not followed: a journal reaches a visible file and the hidden ones made for it, in its own folder."""
    new = ".fig2.00000000.tmp.json"
    rows: list[object] = [
        ["fig2.json", new, "fig3.json"],
        ["../fig2.json", new, None], ["/etc/fig2.json", new, None], [".fig2.json", new, None], ["", new, None],
        ["..", new, None], ["fig2.json", "fig3.json", None], ["fig2.json", "../x", None],
        ["fig2.json", ".fig3.00000000.tmp.json", None], ["fig2.json", ".fig2.00000000.old.json", None],
        ["fig2.json", new, new], ["fig2.json", new], ["fig2.json", new, 7], [7, new, None], "fig2", None, {},
    ]  # fmt: skip
    texts = [json.dumps({"format": "ptmcad-journal-1", "moves": [row]}) for row in rows]
    texts += ["", "[", "[]", "{}", "[" * 10**5, json.dumps({"format": "other", "moves": [["fig2.json", new, None]]})]
    for text in texts:
        for suffix in (REDO, UNDO):
            fill(tmp_path, {"fig2.json": "old", "fig3.json": "other", new: "new", f".fig2.00000001{suffix}": text})
            recover(tmp_path)
            assert visible(tmp_path) == {"fig2.json": "old", "fig3.json": "other"}, text
            assert journals(tmp_path) == ()
    whole = json.dumps({"format": "ptmcad-journal-1", "moves": [["fig2.json", new, None]]})
    fill(tmp_path, {"fig2.json": "old", new: "new", ".fig2.00000001.redo": whole})
    recover(tmp_path)
    assert visible(tmp_path) == {"fig2.json": "new"}


@settings(max_examples=40)
@given(
    st.lists(
        st.tuples(
            st.lists(st.sampled_from(NAMES), min_size=1, unique=True),
            st.sampled_from(["whole", "killed", "failing", "failing for ever"]),
            st.integers(1, 14),
        ),
        min_size=1,
        max_size=6,
    )
)
def test_runs_one_after_the_other(
    tmp_path_factory: pytest.TempPathFactory, runs: list[tuple[list[str], str, int]]
) -> None:
    """Every run replaces its files all or none, whatever the runs before it have left, and touches no others."""
    folder = fill(tmp_path_factory.getbasetemp() / "sequence", {})
    states: list[Files] = [{}]
    for number, (names, kind, step) in enumerate(runs):
        failing = {"failing": (step,), "failing for ever": range(step, 1000)}.get(kind, ())
        commit.disk = FaultyDisk(step if kind == "killed" else None, failing)
        text = str(number)
        done = False
        try:
            write_files(folder, {name: text_writer(text) for name in names})
            done = True
        except (Killed, OutputError):
            pass
        commit.disk = commit.Disk()
        new = [{**state, **{name: text for name in names}} for state in states]
        states = new if done else [*states, *new]
    recover(folder)
    assert visible(folder) in states


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
        ({"fig2.json": WHOLE, "fig2.complete.json": WHOLE, "fig2.complete-2.json": "?"}, True, "fig2.complete-3.json"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("busy", [False, True])
def test_a_stopped_result_loses_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, old: Files, whole: bool, place: str, busy: bool
) -> None:
    """Its name says truly whether it is complete; where another process stays in the folder it gets a new name."""
    fill(tmp_path, old)
    target, beside = tmp_path / "fig2.json", ("fig2.png", "fig2.svg")
    text = WHOLE if whole else PARTIAL + " "
    held = os.open(tmp_path, os.O_RDONLY)
    if busy:
        monkeypatch.setattr("ptmcad.process.output.LOCK_PATIENCE", 0.02)
        fcntl.flock(held, fcntl.LOCK_EX)
    saved = save_stopped(target, text, whole=whole, beside=beside)
    os.close(held)
    if busy:
        assert saved.name not in old
        assert saved.name.startswith("fig2.complete" if whole else "fig2.partial")
    else:
        assert saved.name == place
    assert visible(tmp_path) == {**old, saved.name: text}
    assert set(os.listdir(tmp_path)) == set(visible(tmp_path))
    why = where_saved(target, saved, beside)
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
    [("1/50", "1/2", False), ("1/2", "1/50", True), ("1/50", "1/50", True), ("nonsense", "1/2", True)],
)
def test_a_stopped_map_replaces_none_with_less_undetermined(
    tmp_path: Path, older: str, newer: str, replaced: bool
) -> None:
    def stopped(share: str) -> str:
        return json.dumps({"status": "partial", "cover": {}, "undetermined": share})

    target = tmp_path / "free02.json"
    target.write_text(stopped(older))
    place = save_stopped(target, stopped(newer))
    if replaced:
        assert (place, where_saved(target, place)) == (target, "")
    else:
        assert place.name == "free02.partial.json"
        why = ", because less is undetermined in the older partial result free02.json"
        assert where_saved(target, place) == why
        assert target.read_text() == stopped(older)
    assert place.read_text() == stopped(newer)
