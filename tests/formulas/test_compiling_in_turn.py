"""Processes that need the same compiled code take turns, and none of them waits for ever."""

from __future__ import annotations

import fcntl
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

pytest.importorskip("numba")

from ptmcad.formulas import compilation as compiled


@pytest.fixture(name="folder")
def empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(compiled, "_FOLDER", tmp_path / "not made yet")
    return tmp_path / "not made yet"


@contextmanager
def held_elsewhere(folder: Path) -> Iterator[int]:
    """A lock belongs to an open file, so this one is as good as another process's."""
    descriptor = os.open(folder / "upright.lock", os.O_RDWR | os.O_CREAT)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield descriptor
    finally:
        os.close(descriptor)


def test_one_waits_until_the_other_is_done(folder: Path) -> None:
    with compiled.in_turn("upright") as waited:
        assert waited == 0
    with held_elsewhere(folder) as descriptor:
        threading.Timer(0.1, fcntl.flock, (descriptor, fcntl.LOCK_UN)).start()
        with compiled.in_turn("upright") as waited, pytest.raises(BlockingIOError):
            assert waited > 0
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)  # now it is this one's turn


def test_another_part_is_not_waited_for(folder: Path) -> None:
    folder.mkdir()
    with held_elsewhere(folder), compiled.in_turn("slanted") as waited:
        assert waited == 0


def test_one_that_was_stopped_is_not_waited_for_for_ever(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiled, "_PATIENCE", 0.01)
    folder.mkdir()
    with held_elsewhere(folder), compiled.in_turn("upright") as waited:
        assert waited >= 0.01


def test_a_folder_that_cannot_be_written_is_no_reason_to_wait(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(compiled, "_FOLDER", tmp_path / "file" / "folder")
    with compiled.in_turn("upright") as waited:
        assert waited == 0
