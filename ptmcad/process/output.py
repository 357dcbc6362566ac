"""The files of a result: all of them written under hidden names first, then put into place together.

Guarantee: every file under its own name is whole, and the files of one run replace those of another as
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
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from fractions import Fraction
from itertools import chain, count
from pathlib import Path
from typing import Any, BinaryIO

from ptmcad.errors import ConfigError, OutputError
from ptmcad.process import commit
from ptmcad.process.commit import HIDDEN, UNCHANGED, hidden, locked, put_into_place, reason
from ptmcad.process.handover import Topic, identity, send
from ptmcad.text.textfile import json_data, read_text

if sys.platform != "win32":
    import fcntl

Writer = Callable[[Path], None]
Placing = Callable[[Path, Mapping[Path, Path]], tuple[Path, ...]]

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

    To be called before a long computation. What killed runs have left there is removed.

    Raises
    ------
    OutputError
        With the folder or file and the reason.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise OutputError(f"the folder {folder} cannot be made: {reason(error)}; choose another with --out") from error
    _check_kinds(folder / name for name in names)
    names = (*names, "probe")
    try:
        with suppress(BlockingIOError), locked(folder, LOCK_PATIENCE) as alone:
            if alone:  # otherwise what is left of a dead process cannot be distinguished from what a live one uses
                _remove_stale(folder, names)
        for name in names:
            with _temporary(folder / name) as probe:
                probe.write_bytes(b"writable")
    except OSError as error:
        raise OutputError(
            f"the folder {folder} cannot be written to: {reason(error)}; choose another with --out"
        ) from error


def _check_kinds(targets: Iterable[Path]) -> None:
    """Refuse to replace what is no file: a rename would remove a device as well.

    A symbolic link is replaced if it leads to a file or nowhere; what it leads to stays as it is.

    Raises
    ------
    OutputError
        With the path and what is there.
    """
    for target in targets:
        try:
            mode = target.stat().st_mode
        except (OSError, ValueError):  # nothing there; or a name that writing will refuse, with the reason
            continue
        if not stat.S_ISREG(mode):
            kind = _KINDS.get(stat.S_IFMT(mode), "no regular file")
            raise OutputError(f"{target} is {kind}, so no file can be written there; choose another --out")


_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def write_files(folder: Path, writers: Mapping[str, Writer], *, new: bool = False) -> tuple[Path, ...]:
    """Write all files, then put them into place.

    Parameters
    ----------
    folder : where they go; it exists.
    writers : for each file's name, one at least, a function that writes the file at the path it is given (the path has
        the name's suffix). The last one is the file that vouches for the others.
    new : that nothing, not even a link, may have these names yet.

    Raises
    ------
    OutputError
        If a file cannot be written or renamed; the message says what there is then.
    """
    return _write(folder, writers, _under_new_names if new else _under_own_names)


def _under_new_names(folder: Path, temporaries: Mapping[Path, Path]) -> tuple[Path, ...]:
    """Take the names first, as one process alone can do, so that what is replaced is nobody else's."""
    taken: dict[Path, str] = {}
    try:
        for target in temporaries:
            target.open("x").close()
            taken[target] = identity(target)
        return _under_own_names(folder, temporaries)
    except BaseException:
        for target, mark in taken.items():
            if identity(target) == mark:  # not what has been saved there since
                target.unlink()
        raise


def _under_own_names(folder: Path, temporaries: Mapping[Path, Path]) -> tuple[Path, ...]:
    with locked(folder):
        _check_kinds(temporaries)
        put_into_place(temporaries)
    return tuple(temporaries)


def _write(folder: Path, writers: Mapping[str, Writer], place: Placing) -> tuple[Path, ...]:
    """Write the files under hidden names, have them put into place, and return where they are."""
    temporaries: dict[Path, Path] = {}
    current = folder
    with ExitStack() as needed:
        try:
            for name, write in writers.items():
                current = folder / name
                temporaries[current] = needed.enter_context(_temporary(current))
                write(temporaries[current])
                with temporaries[current].open("rb+") as file:
                    os.fsync(file)
            return place(folder, temporaries)
        except OSError as error:
            raise OutputError(f"{current} cannot be written: {reason(error)}; {UNCHANGED}") from error


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
    further = chain([""], (f"-{number}" for number in count(2)))
    names = (target.with_name(f"{target.stem}.{label}{end}{target.suffix}") for end in further)

    def place(folder: Path, temporaries: Mapping[Path, Path]) -> tuple[Path, ...]:
        (temporary,) = temporaries.values()
        try:
            with locked(folder, LOCK_PATIENCE):
                free = not any(os.path.lexists(folder / name) for name in beside) and _replaceable(target, text)
                chosen = target if free else next(name for name in names if _replaceable(name, text))
                put_into_place({chosen: temporary})
                return (chosen,)
        except BlockingIOError:  # a process that does not move on has it: a name that nothing has needs no lock
            return (_put_at_new_name(temporary, names),)

    return _write(target.parent, {target.name: text_writer(text)}, place)[0]


def _put_at_new_name(temporary: Path, names: Iterable[Path]) -> Path:
    for name in names:
        send(Topic.RENAMES, str(name), identity(temporary))
        with suppress(FileExistsError):
            os.link(temporary, name)
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
    return text is None or not _leaves_less_open(stored, json.loads(text))


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
    kinds = {(Path(name).stem, Path(name).suffix) for name in names}
    with suppress(OSError):  # a folder one may write to but not list
        for entry in list(os.scandir(folder)):
            match = HIDDEN.fullmatch(entry.name)
            if match is None or match.groups() not in kinds or not entry.is_file(follow_symlinks=False):
                continue
            # it may be gone meanwhile, another user's, or of a process that lives; or there are no locks
            with suppress(OSError), open(entry.path, "rb+", buffering=0) as file:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                os.unlink(entry.path)


@contextmanager
def _temporary(target: Path) -> Iterator[Path]:
    """A hidden file in the target's folder with the target's suffix and the permissions that the umask gives.

    It is locked, and removed in the end if it still has its hidden name.
    """
    while True:
        path = hidden(target)
        send(Topic.TEMPORARY, str(path))
        with path.open("xb") as file:
            if sys.platform == "win32" or _locked(file):
                try:
                    yield path
                finally:
                    with suppress(OSError):  # it is hidden, and removed by a later run
                        commit.disk.unlink(path)
                return


def _locked(file: BinaryIO) -> bool:
    """Lock a new file; False when another process has taken it for a stale one and removed it before."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX)
    except OSError:  # a file system without locks: there nothing is taken for stale either
        return True
    return os.fstat(file.fileno()).st_nlink > 0
