"""The files of a result: all of them written under hidden names first, then put into place together.

Guarantee: every file under its own name is whole, and the files of one run replace those of another all or none, as
`ptmcad.process.commit` says. Nothing is put into place before everything is written and on disk. Whatever stops the
writing (an error, Ctrl-C, a signal that raises) leaves no temporary file; a process that is killed outright may leave
hidden ``.NAME.*.tmp.*`` and ``.NAME.*.old.*`` files and nothing else, and the next `check_writable` for the same name
removes them. Files of live processes are recognised by the lock that these hold. A result that a limit has stopped
replaces no complete one.
"""

from __future__ import annotations

import json
import os
import stat
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from fractions import Fraction
from itertools import chain, count
from pathlib import Path
from typing import Any

from ptmcad.errors import ConfigError, OutputError
from ptmcad.process.commit import UNCHANGED, discard, identity, locked, put_into_place, reason, settle
from ptmcad.process.handover import Topic, send, undisturbed
from ptmcad.process.journal import HIDDEN, REDO, hidden, journals
from ptmcad.text.textfile import json_data, read_text

if sys.platform != "win32":
    import fcntl

Writer = Callable[[Path], None]
Placing = Callable[[Path, Mapping[Path, Path]], tuple[Path, ...]]

_PROBE = "probe"
MAX_BYTES = 60_000_000
"""Of an older result that is looked at."""
LOCK_PATIENCE = 1.0
"""Seconds that the parts of a program that must come to an end wait for the lock."""


def text_writer(text: str) -> Writer:
    """A writer of the text, as UTF-8 with plain line feeds."""

    def write(path: Path) -> None:
        path.write_text(text, encoding="utf-8", newline="\n")

    return write


def check_writable(folder: Path, names: tuple[str, ...] = ()) -> None:
    """Create the folder if it is missing and prove, by writing, that files of these names can be put there.

    To be called before a long computation. What killed runs have left there is completed or removed.

    Raises
    ------
    OutputError
        With the folder or file and the reason.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise OutputError(f"the folder {folder} cannot be made: {reason(error)}; choose another with --out") from error
    _check_kinds(folder, names)
    try:
        with suppress(BlockingIOError), locked(folder, LOCK_PATIENCE) as alone:
            if alone:  # otherwise what is left of a dead process cannot be distinguished from what a live one uses
                settle(folder)
                _check_free(folder, names)
                _remove_stale(folder, (*names, _PROBE))
        for name in (_PROBE, *(f"{Path(name).stem}{REDO}" for name in names)):  # no hidden name is longer
            probe, lock = _create(folder / name)
            try:
                probe.write_text("writable", encoding="utf-8")
            finally:
                probe.unlink(missing_ok=True)
                os.close(lock)
    except OSError as error:
        raise OutputError(
            f"the folder {folder} cannot be written to: {reason(error)}; choose another with --out"
        ) from error


def _check_kinds(folder: Path, names: Iterable[str]) -> None:
    """Refuse to replace what is no file: a rename would remove a device as well.

    A symbolic link is replaced if it leads to a file or nowhere; what it leads to stays as it is.

    Raises
    ------
    OutputError
        With the path and what is there.
    """
    for name in names:
        try:
            mode = (folder / name).stat().st_mode
        except (OSError, ValueError):  # nothing there; or a name that writing will refuse, with the reason
            continue
        if not stat.S_ISREG(mode):
            kind = next((what for test, what in _KINDS if test(mode)), "no regular file")
            raise OutputError(f"{folder / name} is {kind}, so no file can be written there; choose another --out")


_KINDS = ((stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"),
          (stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device"))  # fmt: skip


def write_files(folder: Path, writers: Mapping[str, Writer], *, new: bool = False) -> tuple[Path, ...]:
    """Write all files or none, and put them into place.

    Parameters
    ----------
    folder : where they go; it exists.
    writers : for each file's name, one at least, a function that writes the file at the path it is given (the path has
        the name's suffix). The last one is the file that vouches for the others.
    new : that nothing, not even a link, may have these names yet.

    Raises
    ------
    OutputError
        If a file cannot be written or renamed.
    """
    return _write(folder, writers, _under_new_names if new else _under_own_names)


def _under_new_names(folder: Path, temporaries: Mapping[Path, Path]) -> tuple[Path, ...]:
    """Take the names first, as one process alone can do, so that what is replaced is nobody else's."""
    taken: list[Path] = []
    try:
        for target in temporaries:
            target.open("x").close()
            taken.append(target)
        return _under_own_names(folder, temporaries)
    except BaseException:
        for target in taken:
            target.unlink(missing_ok=True)
        raise


def _under_own_names(folder: Path, temporaries: Mapping[Path, Path]) -> tuple[Path, ...]:
    with locked(folder) as alone:
        if alone:
            settle(folder)
            _check_free(folder, [target.name for target in temporaries])
        _check_kinds(folder, [target.name for target in temporaries])
        put_into_place(temporaries)
    return tuple(temporaries)


def _write(folder: Path, writers: Mapping[str, Writer], place: Placing) -> tuple[Path, ...]:
    """Write the files under hidden names, have them put into place, and return where they are."""
    temporaries: dict[Path, Path] = {}
    locks = []
    current = folder
    try:
        for name, write in writers.items():
            current = folder / name
            temporary, lock = _create(current)
            temporaries[current] = temporary
            locks.append(lock)
            write(temporary)
            _flush_to_disk(temporary)
        return place(folder, temporaries)
    except OSError as error:
        raise OutputError(f"{current} cannot be written: {reason(error)}; {UNCHANGED}") from error
    finally:
        try:
            with suppress(OSError):  # hidden, and removed by a later run; there is a result or another error to report
                discard(temporaries.values())
        finally:
            for lock in locks:
                os.close(lock)


def _check_free(folder: Path, names: Iterable[str]) -> None:
    """Refuse to write what an unfinished journal would write over later.

    Raises
    ------
    OutputError
        With the journal's path.
    """
    wanted = set(names)
    for journal in journals(folder):
        if journal.names & wanted:
            raise OutputError(
                f"{journal.path} holds files that a killed run could not put into place, and this one cannot either: "
                "see to it that this user may rename files there, or choose another --out"
            )


def save_stopped(target: Path, text: str, *, whole: bool = False, beside: Iterable[str] = ()) -> Path:
    """Save the result of a computation that a limit has stopped, and return where.

    Guarantee: a whole older result stays, and so do its pictures. Only a file that is marked as partial is replaced,
    and only where none of the pictures is there that the run would have replaced. Otherwise the result goes to
    ``NAME.partial.json``, or ``NAME.complete.json`` if all but its pictures is done, or the first of
    ``NAME.partial-2.json``, ``NAME.partial-3.json`` ... that holds nothing or a partial result.

    Parameters
    ----------
    whole : whether the result itself is complete.
    beside : names of the other files that the run was to write.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    label = "complete" if whole else "partial"
    further = chain([label], (f"{label}-{number}" for number in count(2)))
    names = (target.with_name(f"{target.stem}.{end}{target.suffix}") for end in further)

    def place(folder: Path, temporaries: Mapping[Path, Path]) -> tuple[Path, ...]:
        (temporary,) = temporaries.values()
        try:
            with locked(folder, LOCK_PATIENCE) as alone:
                if alone:
                    settle(folder)
                free = not any(os.path.lexists(folder / name) for name in beside) and _replaceable(target, text)
                chosen = target if free else next(name for name in names if _replaceable(name, text))
                if alone:
                    _check_free(folder, [chosen.name])
                put_into_place({chosen: temporary})
                return (chosen,)
        except BlockingIOError:  # a process that does not move on has it: a name that nothing has needs no lock
            return (_put_at_new_name(temporary, names),)

    return _write(target.parent, {target.name: text_writer(text)}, place)[0]


def _put_at_new_name(temporary: Path, names: Iterable[Path]) -> Path:
    for name in names:
        send(Topic.RENAMES, "", str(name), identity(temporary))
        try:
            with undisturbed():
                os.link(temporary, name)
        except FileExistsError:
            continue
        return name
    raise AssertionError("there are infinitely many names")


def where_saved(target: Path, place: Path, beside: Iterable[str] = ()) -> str:
    """Why a stopped result is not in the file that was asked for, as the end of a sentence."""
    if place == target:
        return ""
    if not _replaceable(target):
        return f", because {target.name} holds an older result that is not partial"
    pictures = [name for name in beside if os.path.lexists(target.with_name(name))]
    if pictures:
        return f", because {pictures[0]} shows an older result"
    if _leaves_less_open(_stored(target) or {}, _stored(place)):
        return f", because less is undetermined in the older partial result {target.name}"
    return f", because another process is writing {target.name}"


def _stored(path: Path) -> dict[str, Any] | None:
    """The document in a file; None when there is no result in it."""
    try:
        found = json_data(read_text(path, MAX_BYTES, "a result"))
    except (ConfigError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def how_to_go_on(place: Path) -> str:
    """What goes on from a stopped result that can be gone on from, as the end of a sentence."""
    import shlex  # which a run that ends well does not need

    return f"; go on with --resume {shlex.quote(str(place))}"


def _replaceable(target: Path, text: str | None = None) -> bool:
    """Whether there is no such file, or only a partial result; with a text: one that leaves no less open than it."""
    if not os.path.lexists(target):
        return True
    stored = _stored(target)
    if stored is None or stored.get("status") != "partial":  # what is no result is not ours to replace unasked
        return False
    return text is None or stored.get("cover") is None or not _leaves_less_open(stored, json.loads(text))


def _leaves_less_open(stored: dict[str, Any], new: Any) -> bool:
    """Whether an older certified map has less undetermined than a new result: then it is worth more than that."""
    if stored.get("cover") is None or not isinstance(new, dict) or new.get("cover") is None:
        return False
    try:
        return Fraction(stored["undetermined"]) < Fraction(new["undetermined"])
    except (KeyError, TypeError, ValueError, ZeroDivisionError):  # no map that this program has made
        return False


def _remove_stale(folder: Path, names: Iterable[str]) -> None:
    """Remove hidden files for these names whose process has ended: one that lives holds a lock on its files.

    The caller holds the folder's lock: hidden old files are used under it only.
    """
    if sys.platform == "win32":
        return
    kinds = {(Path(name).stem, Path(name).suffix) for name in names}
    kinds |= {(stem, REDO) for stem, _ in kinds}
    needed = {name for journal in journals(folder) for name in journal.names}
    try:
        found = [entry for entry in os.scandir(folder) if (match := HIDDEN.fullmatch(entry.name))
                 and (match["stem"], match["suffix"] or "") in kinds and entry.name not in needed]  # fmt: skip
    except OSError:  # a folder one may write to but not list
        return
    for entry in found:
        try:
            descriptor = os.open(entry.path, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK)
        except OSError:  # gone meanwhile, or another user's
            continue
        try:
            if stat.S_ISREG(os.fstat(descriptor).st_mode):
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                os.unlink(entry.path)
        except OSError:  # its process lives, the file system has no locks, or the file may not be removed
            continue
        finally:
            os.close(descriptor)


def _create(target: Path) -> tuple[Path, int]:
    """Create a hidden file in the target's folder with the target's suffix and the permissions that the umask gives.

    Returns its path and an open descriptor that holds a lock on it.
    """
    while True:
        path = hidden(target)
        send(Topic.TEMPORARY, str(path))
        descriptor = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666)
        if sys.platform == "win32" or _locked(descriptor):
            return path, descriptor
        os.close(descriptor)


def _locked(descriptor: int) -> bool:
    """Lock a new file; False when another process has taken it for a stale one and removed it before."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
    except OSError:  # a file system without locks: there nothing is taken for stale either
        return True
    return os.fstat(descriptor).st_nlink > 0


def _flush_to_disk(path: Path) -> None:
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())
