"""A journal: what is to be renamed so that a set of files takes the place of another, written down in their folder.

Guarantee: a journal that is read names visible files and, for each, only hidden ones that are made for it, all in the
journal's own folder; everything else is taken for no journal.
"""

from __future__ import annotations

import json
import os
import re
import stat
from pathlib import Path
from typing import NamedTuple

HIDDEN = re.compile(r"\.(?P<stem>.*)\.[0-9a-f]{8}\.(?P<kind>tmp|old)(?P<suffix>\.[^.]+)?", re.DOTALL)
REDO, UNDO = ".redo", ".undo"
_JOURNAL = re.compile(r"\..*\.[0-9a-f]{8}\.(?:redo|undo)", re.DOTALL)
_FORMAT = "ptmcad-journal-1"
_MAX_BYTES = 1_000_000


class Move(NamedTuple):
    """One file: ``new`` becomes ``target``, and what is there now is ``old`` meanwhile (empty: there is nothing)."""

    target: Path
    new: Path
    old: Path | None


class Journal(NamedTuple):
    """The moves of a set, the voucher's last, and where they are written down."""

    path: Path
    moves: tuple[Move, ...]

    @property
    def names(self) -> frozenset[str]:
        """All names that it is about."""
        paths = (path for move in self.moves for path in (move.target, move.new, move.old))
        return frozenset(path.name for path in paths if path is not None)


def hidden(target: Path, kind: str = "tmp") -> Path:
    """A new hidden name in the target's folder with the target's suffix."""
    return target.with_name(f".{target.stem}.{os.urandom(4).hex()}.{kind}{target.suffix}")


def journals(folder: Path) -> tuple[Journal, ...]:
    """The journals in a folder, as far as it may be listed."""
    try:
        names = sorted(entry.name for entry in os.scandir(folder) if _JOURNAL.fullmatch(entry.name))
    except OSError:
        return ()
    return tuple(journal for name in names if (journal := read_journal(folder / name)) is not None)


def as_text(moves: tuple[Move, ...]) -> str:
    """What a journal's file holds."""
    rows = [[move.target.name, move.new.name, None if move.old is None else move.old.name] for move in moves]
    return json.dumps({"format": _FORMAT, "moves": rows})


def read_journal(path: Path) -> Journal | None:
    """A journal; None when there is none, or it is not one that this program writes."""
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
        with open(descriptor, "rb") as stream:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                return None
            stored = json.loads(stream.read(_MAX_BYTES))
    except (OSError, ValueError, RecursionError):
        return None
    rows = stored.get("moves") if isinstance(stored, dict) and stored.get("format") == _FORMAT else None
    if not isinstance(rows, list) or not rows or not all(_is_row(row) for row in rows):
        return None
    moves = (
        Move(path.with_name(target), path.with_name(new), None if old is None else path.with_name(old))
        for target, new, old in rows
    )
    return Journal(path, tuple(moves))


def _is_row(row: object) -> bool:
    """Whether a row names a visible file and hidden ones that are made for it: a journal reaches nothing else."""
    if not isinstance(row, list) or len(row) != 3 or not all(isinstance(name, str) for name in row[:2]):
        return False
    target, new, old = row
    if target in ("", ".", "..") or target.startswith(".") or any(c in "/\\\0" for c in target):
        return False
    names = [(new, "tmp")] if old is None else [(new, "tmp"), (old, "old")]
    stem, suffix = os.path.splitext(target)
    for name, kind in names:
        match = HIDDEN.fullmatch(name) if isinstance(name, str) else None
        if match is None or (match["stem"], match["kind"], match["suffix"] or "") != (stem, kind, suffix):
            return False
    return True
