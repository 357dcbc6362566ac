"""Files that belong together, put into place together: a lock on their folder, a journal, and what completes it.

A set of files has been written under hidden names and takes the place of an older set. The last file of a set is its
*voucher* (the JSON); the others are pictures of what it says.

Guarantee: whatever ends the process, at every moment the files that can be seen under their names are of one set: the
voucher is the old one or the new one, and the others are of the same set or missing. Once the journal is in place,
`finish` and `recover` complete the set, or restore the older one, from any state in which a process, or a recovery, was
killed. An error restores the older set. When that fails too, the journal stays, and the message says so.

The states are distinguished by which hidden names exist. For every file the journal names the target, the new file's
hidden name, and a hidden name for the old file. Forward: hide the old pictures, keep the old voucher under a second
name, rename the new voucher, rename the new pictures, remove the journal. Back: hide the new pictures, rename the old
voucher, rename the old pictures, remove the journal. The journal's suffix says the direction. Either can be begun again
after any of its steps, and back after any step of forward.

Not guaranteed: the order of the steps on disk when the machine loses power; that the voucher is there at every moment
on file systems without hard links, where it is missing between two renames; recovery by another process on file systems
without locks, where what is left of a dead process cannot be distinguished from what a live one uses.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ptmcad.errors import OutputError
from ptmcad.process.handover import Topic, send, undisturbed
from ptmcad.process.journal import REDO, UNDO, Journal, Move, as_text, hidden, journals, read_journal

if sys.platform != "win32":
    import fcntl

UNCHANGED = "earlier files are as they were"
UNFINISHED = "the next ptmcad that reads or writes results in this folder completes this"
_PAUSE = 0.01
_SILENCE = 1.0
"""Seconds after which a process that waits for the lock as long as it takes says so."""


class Disk:
    """The steps that change a folder. A test puts another in place of `disk`, which stops or fails between two."""

    def replace(self, source: Path, target: Path) -> None:
        """Rename, over what is there."""
        os.replace(source, target)

    def link(self, source: Path, target: Path) -> None:
        """A second name for the same file."""
        os.link(source, target, follow_symlinks=False)

    def unlink(self, path: Path) -> None:
        """Remove; it need not be there."""
        path.unlink(missing_ok=True)


disk = Disk()


@contextmanager
def locked(folder: Path, patience: float | None = None) -> Iterator[bool]:
    """Keep other processes of this program from renaming files in the folder.

    Yields whether they are kept out: False where the system or the file system has no locks, or the folder may be
    written to but not read.

    Parameters
    ----------
    patience : seconds to wait for the lock; None for as long as it takes. A signal's handler runs meanwhile.

    Raises
    ------
    BlockingIOError
        When another process has held the lock all the time.
    """
    if sys.platform == "win32":
        yield False
        return
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except PermissionError:
        yield False
        return
    try:
        yield _lock(descriptor, folder, patience)
    finally:
        os.close(descriptor)


def _lock(descriptor: int, folder: Path, patience: float | None) -> bool:
    until, silent = time.monotonic() + (_SILENCE if patience is None else patience), True
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB if silent else fcntl.LOCK_EX)
        except BlockingIOError:
            if time.monotonic() < until:
                time.sleep(_PAUSE)
            elif patience is None:
                silent = False
                send(Topic.WAITING, str(folder))
            else:
                raise
        except OSError:  # a file system without locks
            return False
        else:
            return True


def put_into_place(files: Mapping[Path, Path]) -> None:
    """Put a set into place, while no signal gets in. The caller holds the folder's lock and has called `settle`.

    Parameters
    ----------
    files : for each target, in one folder, the whole file that is to be there. The last is the voucher.

    Raises
    ------
    OutputError
        When a file cannot be renamed; the message says what there is now.
    """
    *others, (voucher, new) = files.items()
    journal = voucher.with_name(f".{voucher.stem}.{os.urandom(4).hex()}{REDO}")
    with undisturbed():
        send(Topic.RENAMES, str(journal), str(voucher), identity(new))
        if not others:  # one step, which needs no journal
            with _as_output_error(voucher):
                disk.replace(new, voucher)
            return
        moves = tuple(
            Move(target, source, hidden(target, "old") if os.path.lexists(target) else None)
            for target, source in files.items()
        )
        with _as_output_error(voucher):
            for target in files:
                if target.is_dir() and not target.is_symlink():
                    raise IsADirectoryError(None, "Is a directory", str(target))
            _write(journal, moves)
        _carry_out(Journal(journal, moves))


def settle(folder: Path) -> tuple[Journal, ...]:
    """Complete the sets whose process has ended, or take them back, and return those of which neither can be done.

    The caller holds the folder's lock.
    """
    for journal in journals(folder):
        if _is_ours(journal.path):
            with undisturbed(), suppress(OutputError):  # then it was taken back, or is still there and returned
                _carry_out(journal)
    return journals(folder)


def recover(folder: Path, patience: float = 1.0) -> None:
    """Complete what a killed process has left in a folder from which a result is to be read.

    Whatever keeps it from that is no obstacle to reading: what can be seen belongs together in any case.
    """
    if not journals(folder):
        return
    with suppress(OSError), locked(folder, patience) as alone:
        if alone:
            settle(folder)


def finish(journal: Path, patience: float) -> None:
    """Complete the one set of a process that is known to have ended.

    Where another process holds the lock all the time, it is left to that one, which completes what it finds.

    Raises
    ------
    OutputError
        When a file cannot be renamed.
    """
    with suppress(BlockingIOError), locked(journal.parent, patience), undisturbed():
        for path in (journal, journal.with_suffix(UNDO)):
            found = read_journal(path)
            if found is not None:
                _carry_out(found)


def discard(paths: Iterable[Path]) -> None:
    """Remove hidden files that no journal needs.

    Raises
    ------
    OSError
        When one cannot be removed.
    """
    paths = tuple(paths)
    for folder in {path.parent for path in paths}:
        needed = {name for journal in journals(folder) for name in journal.names}
        for path in paths:
            if path.parent == folder and path.name not in needed:
                disk.unlink(path)


def identity(path: Path) -> str:
    """What distinguishes a file from all others wherever it is renamed to; empty when there is none."""
    try:
        found = os.lstat(path)
    except OSError:
        return ""
    return f"{found.st_dev}:{found.st_ino}:{found.st_size}:{found.st_mtime_ns}"


def reason(error: OSError | ValueError) -> str:
    """What the system says."""
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


@contextmanager
def _as_output_error(voucher: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise OutputError(f"{_place(error, voucher)} cannot be written: {reason(error)}; {UNCHANGED}") from error


def _place(error: OSError, default: Path) -> str:
    """The file that could not be written, by the name that the user knows."""
    names = [os.fsdecode(name) for name in (error.filename2, error.filename) if isinstance(name, str | bytes)]
    return next((name for name in names if not os.path.basename(name).startswith(".")), str(default))


def _carry_out(journal: Journal) -> None:
    """Complete a journal, or take it back.

    Raises
    ------
    OutputError
        When a file cannot be renamed.
    """
    if journal.path.suffix == UNDO:
        try:
            _back(journal)
        except OSError as error:
            place = _place(error, journal.moves[-1].target)
            raise OutputError(f"{place} cannot be put back: {reason(error)}; {UNFINISHED}") from error
        return
    try:
        _forward(journal.moves)
    except OSError as error:
        text = f"{_place(error, journal.moves[-1].target)} cannot be written: {reason(error)}"
        undo = Journal(journal.path.with_suffix(UNDO), journal.moves)
        try:
            disk.replace(journal.path, undo.path)
            _back(undo)
        except OSError as again:
            text += f", and earlier files cannot be put back: {reason(again)}; {UNFINISHED}"
            raise OutputError(text) from error
        raise OutputError(f"{text}; {UNCHANGED}") from error
    with suppress(OSError):  # everything is in place; what stays is hidden, without effect, and removed by a later run
        disk.unlink(journal.path)
        for move in journal.moves:
            if move.old is not None:
                disk.unlink(move.old)


def _forward(moves: tuple[Move, ...]) -> None:
    """Put the new files into place, from whatever step on.

    Raises
    ------
    OSError
        When one cannot be renamed.
    """
    *others, voucher = moves
    for move in others:
        if _there(move.new) and _there(move.target) and move.old is not None:
            disk.replace(move.target, move.old)
    if _there(voucher.new):
        if voucher.old is not None and _there(voucher.target) and not _there(voucher.old):
            try:
                disk.link(voucher.target, voucher.old)
            except OSError:  # no hard links here, or not to this file
                disk.replace(voucher.target, voucher.old)
        disk.replace(voucher.new, voucher.target)
    for move in others:
        if _there(move.new):
            disk.replace(move.new, move.target)


def _back(journal: Journal) -> None:
    """Put the old files into place, from whatever step of either direction on, and end the journal.

    Raises
    ------
    OSError
        When one cannot be renamed.
    """
    *others, voucher = journal.moves
    for move in others:
        if _there(move.target) and not _there(move.new):
            disk.replace(move.target, move.new)
    if voucher.old is not None:
        if _there(voucher.old):
            disk.replace(voucher.old, voucher.target)
            disk.unlink(voucher.old)  # two names of one file are not renamed into one
    elif not _there(voucher.new):
        disk.unlink(voucher.target)
    for move in others:
        if move.old is not None and _there(move.old):
            disk.replace(move.old, move.target)
    disk.unlink(journal.path)
    with suppress(OSError):  # hidden, and removed by a later run
        for move in journal.moves:
            disk.unlink(move.new)


def _there(path: Path) -> bool:
    return os.path.lexists(path)


def _write(journal: Path, moves: tuple[Move, ...]) -> None:
    """Put the journal into place, whole and on disk."""
    temporary = hidden(moves[-1].target.with_suffix(REDO))
    olds = [str(move.old) for move in moves if move.old is not None]
    send(Topic.TEMPORARY, str(temporary), *olds)
    write_through(temporary, journal, as_text(moves).encode())


def write_through(temporary: Path, target: Path, data: bytes) -> None:
    """Put one file into place, whole and on disk: it is made under a hidden name, which nothing has, and then renamed.

    Raises
    ------
    OSError
        When it cannot be written; what is at the target is as it was.
    """
    try:
        with temporary.open("xb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        disk.replace(temporary, target)
    except OSError:
        with suppress(OSError):  # the first error is the one to report, and the file is hidden
            disk.unlink(temporary)
        raise


def _is_ours(path: Path) -> bool:
    """Whether this user has made it: nobody else instructs this program what to rename."""
    return sys.platform == "win32" or os.lstat(path).st_uid == os.geteuid()
