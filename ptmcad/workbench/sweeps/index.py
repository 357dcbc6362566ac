"""The folder of a sweep: an index in SQLite, and below it the members' results, one JSON file each.

Guarantee: whatever ends the process (``kill -9`` at any moment included), the index can be opened
again, and each row that says *done* has its whole file: the file is on disk and in place before the
row is written. One process at a time uses a folder. Rows are never removed; what is written of a
member does not depend on when or by whom it was computed, but for the columns ``seconds`` and
``attempts``. Nothing is read or written through a link that leads out of the folder, or under a
name that is not made of the member's number; a result that is not the one that was computed is
neither used nor written over.

Not guaranteed: that rows of the last moments survive a machine that loses power; then those members
are computed again.
"""

from __future__ import annotations

import hashlib
import json
import os
import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from ptmcad.answer.regionmap import RegionMap
from ptmcad.answer.sweep import Member, State, Summary, Sweep
from ptmcad.errors import ConfigError, OutputError
from ptmcad.process.output import locked, reason
from ptmcad.text.node import Node
from ptmcad.text.numerals import fraction_of
from ptmcad.text.textfile import read_bytes
from ptmcad.workbench.sweeps.member import AREAS, WIDEST, Outcome

FORMAT = "ptmcad-sweep/1"
INDEX, RESULTS = "index.sqlite", "results"
MAX_BYTES = 60_000_000
"""Of a member's result."""
_IN_A_FOLDER = 1000
"""Results of a folder below `RESULTS`: a million files in one are slow to list."""
_TABLES = """
CREATE TABLE IF NOT EXISTS sweep (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS members (
    number INTEGER PRIMARY KEY,
    parameters TEXT NOT NULL,
    slice BLOB,
    same_as INTEGER,
    state TEXT NOT NULL DEFAULT 'waiting',
    status TEXT,
    cells INTEGER,
    regions INTEGER,
    undetermined TEXT,
    areas TEXT,
    widest TEXT,
    error TEXT NOT NULL DEFAULT '',
    file TEXT NOT NULL DEFAULT '',
    digest TEXT NOT NULL DEFAULT '',
    size INTEGER,
    seconds REAL,
    attempts INTEGER NOT NULL DEFAULT 0
);
CREATE UNIQUE INDEX IF NOT EXISTS slices ON members (slice) WHERE same_as IS NULL;
CREATE INDEX IF NOT EXISTS states ON members (state);
"""
_SHARED = "state, status, cells, regions, undetermined, areas, widest, error, file, digest, size"
"""What members with the same slice have in common."""
_TO_DO = "same_as IS NULL AND state IN ('waiting', 'failed')"
_MEMBER = f"number, parameters, same_as, seconds, attempts, {_SHARED}"


class Index:
    """An open index, for writing; `opened` gives one."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        # every statement is a transaction of its own, which a kill undoes or leaves whole
        self.rows = sqlite3.connect(folder / INDEX, isolation_level=None)
        self.rows.execute("PRAGMA journal_mode = WAL")
        self.rows.execute("PRAGMA synchronous = NORMAL")
        self.rows.executescript(_TABLES)

    def claim(self, facts: dict[str, str], asked: str) -> None:
        """Say of which question this is the index, or find that it is the same one, whichever
        version began it.

        Raises
        ------
        ConfigError
            When the folder holds another sweep.
        """
        known = dict(self.rows.execute("SELECT key, value FROM sweep"))
        wanted = {"format": FORMAT, "asked": asked, **facts}
        if known and any(known.get(key) != wanted[key] for key in ("format", "asked")):
            what = (
                "another version of ptmcad"
                if known.get("asked") == asked
                else "another record, or other options"
            )
            raise ConfigError(
                f"{self.folder} holds the sweep of {what}: choose another folder", key="--out"
            )
        with self.transaction():
            self.rows.executemany("INSERT OR IGNORE INTO sweep VALUES (?, ?)", wanted.items())

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Some steps of which all are done or none."""
        self.rows.execute("BEGIN")
        try:
            yield
        except BaseException:  # raised again: whatever stops the steps, none of them stays
            self.rows.execute("ROLLBACK")
            raise
        self.rows.execute("COMMIT")

    def plan(
        self, number: int, parameters: dict[str, str], slice: bytes | None, refused: str = ""
    ) -> bool:
        """Enter a member; whether it is to be computed: one whose slice another one has shares that
        one's result.
        """
        same = None
        if slice is not None:
            found = self.rows.execute(
                "SELECT number FROM members WHERE slice = ? AND same_as IS NULL", (slice,)
            ).fetchone()
            same = found and found[0]
        self.rows.execute(
            "INSERT INTO members (number, parameters, slice, same_as, state, error) VALUES (?, ?, ?, ?, ?, ?)",
            (
                number,
                json.dumps(parameters),
                slice,
                same,
                "refused" if refused else "waiting",
                refused,
            ),
        )
        return same is None and not refused

    @property
    def planned(self) -> int:
        """How many members have been entered; they are the first ones."""
        return int(self.rows.execute("SELECT COUNT(*) FROM members").fetchone()[0])

    def count_waiting(self) -> int:
        """How many of them are to be computed, each slice once."""
        return int(self.rows.execute(f"SELECT COUNT(*) FROM members WHERE {_TO_DO}").fetchone()[0])

    def waiting(self, below: int) -> Iterator[int]:
        """The members with numbers below a bound that are to be computed, in their order, each
        once.

        What is recorded meanwhile does not matter. Those that have failed before are among them.
        """
        last = -1
        while found := self.rows.execute(
            f"SELECT number FROM members WHERE number > ? AND number < ? AND {_TO_DO} ORDER BY number LIMIT 500",
            (last, below),
        ).fetchall():
            yield from (number for (number,) in found)
            last = found[-1][0]

    def check(self, names: Sequence[str]) -> None:
        """Have members computed again whose file is not there, and remove what killed runs have
        left beside the files.

        Raises
        ------
        ConfigError
            When a row is damaged, or a result has been changed: neither is written over.
        """
        lost = []
        for row in self.rows.execute(f"SELECT {_MEMBER} FROM members"):
            member = _member(self.folder, names, row)
            if member.state is State.DONE and member.same_as is None:
                if os.path.lexists(self.folder / member.file):
                    _result(self.folder, member)
                else:
                    lost.append((member.number,))
        for left in (self.folder / RESULTS).rglob(".*.tmp*"):  # which does not look behind links
            left.unlink()
        with self.transaction():
            self.rows.executemany("UPDATE members SET state = 'waiting' WHERE number = ?", lost)

    def record(self, number: int, outcome: Outcome) -> None:
        """Enter what became of a member; a failed one stays to be tried again."""
        columns = {
            "state": outcome.state.value, "error": outcome.error, "seconds": outcome.seconds,
        }  # fmt: skip
        if (found := outcome.summary) is not None:
            data = outcome.text.encode()
            columns |= {
                "status": found.status, "cells": found.cells, "regions": found.regions,
                "undetermined": found.undetermined, "areas": json.dumps(AREAS.write(found.areas)),
                "widest": None if found.widest is None else json.dumps(WIDEST.write(found.widest)),
                "file": self._write(number, data), "digest": hashlib.sha256(data).hexdigest(), "size": len(data),
            }  # fmt: skip
        changes = ", ".join(f"{column} = ?" for column in columns)
        self.rows.execute(
            f"UPDATE members SET {changes}, attempts = attempts + 1 WHERE number = ?",
            (*columns.values(), number),
        )

    def _write(self, number: int, data: bytes) -> str:
        """Put a result's file into place, whole and on disk; its name below the folder."""
        name = _name(number)
        path = self.folder / name
        temporary = path.with_name(f".{path.stem}.{os.urandom(4).hex()}.tmp")
        try:
            _inside(self.folder, path.parent).mkdir(exist_ok=True)
            with temporary.open("xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file)
            os.replace(temporary, path)
        except OSError as error:
            with suppress(OSError):  # hidden, and removed by a later run
                temporary.unlink()
            raise OutputError(f"{path} cannot be written: {reason(error)}") from error
        return name

    def share(self) -> None:
        """Give members the result of the first one with the same slice."""
        columns = _SHARED.split(", ")
        self.rows.execute(
            f"UPDATE members SET {', '.join(f'{c} = first.{c}' for c in columns)} FROM members AS first "
            "WHERE first.number = members.same_as"
        )

    def states(self) -> dict[State, int]:
        """Numbers of members by what has become of them."""
        return _states(self.rows)

    def close(self) -> None:
        """Close it; the index is then one file."""
        self.rows.close()


def _name(number: int) -> str:
    """Of a member's result, below the folder."""
    return f"{RESULTS}/{number // _IN_A_FOLDER:03}/{number:06}.json"


def _inside(folder: Path, path: Path) -> Path:
    """A path below the sweep's folder, if no link leads elsewhere from there.

    Raises
    ------
    ConfigError
    """
    if not Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder)):
        raise ConfigError(
            "is or lies behind a link that leads out of the sweep's folder: remove it",
            file=str(path),
        )
    return path


@contextmanager
def opened(folder: Path) -> Iterator[Index]:
    """The index of a folder, made if there is none, which no other process opens meanwhile.

    Raises
    ------
    OutputError
        When the folder cannot be written to, or another process uses it.
    """
    try:
        _inside(folder, folder / RESULTS)
        for path in folder.glob(f"{INDEX}*"):  # with SQLite's own beside it
            if not _inside(folder, path).is_file():
                raise ConfigError(
                    "is no file, so it is no index of a sweep: remove it", file=str(path)
                )
        (folder / RESULTS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"the folder {folder} cannot be written to: {reason(error)}") from error
    with ExitStack() as stack:
        try:
            stack.enter_context(locked(folder / RESULTS, patience=0))
        except BlockingIOError as error:
            raise OutputError(f"another process is working on the sweep in {folder}") from error
        try:
            yield stack.enter_context(closing(Index(folder)))
        except sqlite3.DatabaseError as error:
            raise OutputError(f"{folder / INDEX}: {error}; once that is mended the same command goes on, and without "
                              "this file it computes all members anew") from error  # fmt: skip


# ------------------------------------------------------------------------------------------------------------- reading


_REMEDY = "remove this file, and `ptmcad sweep` computes all members anew"


@contextmanager
def _undamaged(folder: Path, what: str) -> Iterator[None]:
    """Read a part of the index; whatever cannot be read there is a damage of the index."""
    try:
        yield
    except (LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise ConfigError(
            f"{what} is damaged ({error}): {_REMEDY}", file=str(folder / INDEX)
        ) from error


@contextmanager
def _reading(folder: Path) -> Iterator[sqlite3.Connection]:
    path = _inside(folder, folder / INDEX)
    if not path.is_file():
        raise ConfigError("there is no sweep in this folder", file=str(folder))
    try:
        with closing(sqlite3.connect(path)) as rows:
            yield rows
    except sqlite3.DatabaseError as error:
        raise ConfigError(f"is damaged, or no index of a sweep: {error}", file=str(path)) from error


def read_sweep(folder: Path) -> Sweep:
    """The sweep in a folder.

    Raises
    ------
    ConfigError
        When there is none.
    """
    with _reading(folder) as rows:
        known = dict(rows.execute("SELECT key, value FROM sweep"))
        if known.get("format") != FORMAT:
            raise ConfigError(
                f"is no index of a sweep of the form {FORMAT}", file=str(folder / INDEX)
            )
        states = _states(rows)
        with _undamaged(folder, "what it says of the sweep"):
            states[State.WAITING] = int(known["members"]) - sum(
                n for s, n in states.items() if s is not State.WAITING
            )
            names = tuple(json.loads(known["names"]))
            return Sweep(known["name"], folder, names, {s: n for s, n in states.items() if n})


def _states(rows: sqlite3.Connection) -> dict[State, int]:
    found = dict(rows.execute("SELECT state, COUNT(*) FROM members GROUP BY state"))
    return {state: found[state.value] for state in State if found.get(state.value)}


def members(sweep: Sweep, numbers: Iterable[int] | None = None) -> Iterator[Member]:
    """Members of a sweep as far as they were entered, all in their order or those with these
    numbers.

    Raises
    ------
    ConfigError
        When the index is gone or damaged.
    """
    with _reading(sweep.folder) as rows:
        if numbers is None:
            for row in rows.execute(f"SELECT {_MEMBER} FROM members ORDER BY number"):
                yield _member(sweep.folder, sweep.names, row)
            return
        for number in numbers:
            row = rows.execute(
                f"SELECT {_MEMBER} FROM members WHERE number = ?", (number,)
            ).fetchone()
            if row is None:
                raise IndexError(f"there is no member {number} yet")
            yield _member(sweep.folder, sweep.names, row)


def _member(folder: Path, names: Sequence[str], row: tuple[Any, ...]) -> Member:
    """A row as data.

    Raises
    ------
    ConfigError
        When it is none that this program has written.
    """
    number, parameters, same_as, seconds, attempts, state, *facts = row
    status, cells, regions, open_share, areas, widest, error, file, digest, _ = facts
    summary = None
    with _undamaged(folder, f"the row of member {number}"):
        values = json.loads(parameters)
        exact = [values[name] for name in names]
        if state == State.DONE.value:
            counted = AREAS.read(Node(json.loads(areas), "areas"))
            found = None if widest is None else WIDEST.read(Node(json.loads(widest), "widest"))
            summary = Summary(status, cells, regions, open_share, counted, found)
            exact += [open_share, *(bound for area in counted for bound in area.area if bound)]
            if file != _name(number if same_as is None else same_as):
                raise ValueError("it names another result")
            if error:
                raise ValueError("it has a result, and says why it has none")
        _ = [fraction_of(text) for text in exact]
        return Member(
            number, values, State(state), summary, same_as, error, file, digest, seconds, attempts
        )


def member_map(sweep: Sweep, member: Member) -> RegionMap:
    """The region map of a member, from its file.

    Raises
    ------
    ConfigError
        When it has none, or the file is not the one that the index names.
    """
    if member.state is not State.DONE:
        raise ConfigError(
            f"member {member.number} has no result: {member.error or member.state.value}"
        )
    data = _result(sweep.folder, member)
    try:
        return RegionMap.from_json(data.decode())
    except ValueError as error:
        raise ConfigError(
            f"is damaged or no region map: {error}", file=str(sweep.folder / member.file)
        ) from error


def _result(folder: Path, member: Member) -> bytes:
    """What is in a member's file.

    Raises
    ------
    ConfigError
        When that is not what was computed.
    """
    path = _inside(folder, folder / member.file)
    data = read_bytes(path, MAX_BYTES, "a member's result")
    if hashlib.sha256(data).hexdigest() != member.digest:
        raise ConfigError("has been changed since it was computed: remove it, and `ptmcad sweep` makes it anew",
                          file=str(path))  # fmt: skip
    return data
