"""The files of a result: all of them written beside their places first, then renamed together.

Guarantee: at every moment each target file is whole, and all that are there belong to one result: the old one or the
new one. The file that vouches for the others is always there; the others may be missing for the moment of the renames,
because old pictures beside new numbers would lie. Nothing is renamed before everything is written and on disk.
Whatever stops the writing (an error, Ctrl-C, a signal that raises) leaves no temporary file; a process that is killed
outright may leave a hidden ``.NAME.*.tmp.*`` file and nothing else, and the next `check_writable` for the same name
removes it. Files of live processes are told by the lock that these hold.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ptmcad.errors import ConfigError, OutputError
from ptmcad.handover import Topic, tell, undisturbed
from ptmcad.textfile import read_text

if sys.platform != "win32":
    import fcntl

Writer = Callable[[Path], None]

_TEMPORARY = re.compile(r"\.(?P<stem>.*)\.[0-9a-f]{8}\.tmp(?P<suffix>\.[a-z]+)?", re.DOTALL)
_PROBE = "probe"
MOST_BYTES = 60_000_000
"""Of an older result that is looked at."""


def text_writer(text: str) -> Writer:
    """A writer of the text, as UTF-8 with plain line feeds."""

    def write(path: Path) -> None:
        path.write_text(text, encoding="utf-8", newline="\n")

    return write


def check_writable(folder: Path, names: tuple[str, ...] = ()) -> None:
    """Create the folder if it is missing and prove, by writing, that files of these names can be put there.

    To be called before a long computation.

    Raises
    ------
    OutputError
        With the folder or file and the reason.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise OutputError(
            f"the folder {folder} can not be made: {_reason(error)}; choose another with --out"
        ) from error
    for name in names:
        if (folder / name).is_dir():
            raise OutputError(f"{folder / name} is a folder, so no file can be written there; choose another --out")
    _remove_stale(folder, (*names, _PROBE))
    try:
        probe, lock = _create(folder / _PROBE)
        try:
            probe.write_text("writable", encoding="utf-8")
        finally:
            probe.unlink(missing_ok=True)
            os.close(lock)
    except OSError as error:
        raise OutputError(
            f"the folder {folder} can not be written to: {_reason(error)}; choose another with --out"
        ) from error


def write_files(folder: Path, writers: Mapping[str, Writer]) -> tuple[Path, ...]:
    """Write all files or none, and put them into place.

    Parameters
    ----------
    folder : where they go; it exists.
    writers : for each file's name, one at least, a function that writes the file at the path it is given (the path has
        the name's suffix). The last one is the file that vouches for the others.

    Raises
    ------
    OutputError
        If a file can not be written or renamed.
    """
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
        _put_into_place(temporaries)
    except OSError as error:
        raise OutputError(f"{current} can not be written: {_reason(error)}; earlier files are as they were") from error
    finally:
        for temporary in temporaries.values():
            temporary.unlink(missing_ok=True)
        for lock in locks:
            os.close(lock)
    return tuple(temporaries)


def _put_into_place(temporaries: Mapping[Path, Path]) -> None:
    """Rename the files, the last one first, while the older files of the others are out of the way.

    Raises
    ------
    OutputError
        When a file can not be renamed.
    """
    *others, (voucher, temporary) = temporaries.items()
    tell(Topic.RENAMES, str(temporary), str(voucher), *(str(path) for pair in others for path in reversed(pair)))
    aside = {target: _name_beside(target) for target, _ in others if target.exists()}
    if aside:
        tell(Topic.TEMPORARY, *map(str, aside.values()))
    current = voucher
    with undisturbed(), _one_at_a_time(voucher.parent):
        try:
            for current, place in aside.items():
                current.replace(place)
            current = voucher
            temporary.replace(voucher)
        except OSError as error:
            for target, place in aside.items():
                if place.exists():
                    place.replace(target)
            raise OutputError(
                f"{current} can not be written: {_reason(error)}; earlier files are as they were"
            ) from error
        try:
            for current, new in others:
                new.replace(current)
        except OSError as error:
            raise OutputError(f"{current} can not be written: {_reason(error)}; {voucher} is new") from error
        finally:
            for place in aside.values():
                place.unlink(missing_ok=True)


@contextmanager
def _one_at_a_time(folder: Path) -> Iterator[None]:
    """Keep other processes of this program from renaming files in the folder, where the file system has locks."""
    if sys.platform == "win32":
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def save_stopped(target: Path, text: str) -> Path:
    """Save the result of a computation that a limit has stopped, and return where.

    Guarantee: a whole older result stays. Only a file that is marked as partial is replaced; when anything else has
    the target's name, the result goes to ``NAME.partial.json`` beside it.

    Raises
    ------
    OutputError
        If the file can not be written.
    """
    place = target if _replaceable(target) else target.with_name(f"{target.stem}.partial{target.suffix}")
    write_files(place.parent, {place.name: text_writer(text)})
    return place


def where_saved(target: Path, place: Path) -> str:
    """Why a stopped result is not in the file that was asked for, as the end of a sentence."""
    return "" if place == target else f", because {target.name} holds an older result that is not partial"


def how_to_go_on(place: Path) -> str:
    """What goes on from a stopped result that can be gone on from, as the end of a sentence."""
    return f"; --resume {shlex.quote(str(place))} goes on from there"


def _replaceable(target: Path) -> bool:
    """Whether there is no such file, or only a partial result."""
    if not os.path.lexists(target):
        return True
    try:
        stored = json.loads(read_text(target, MOST_BYTES, "a result"))
    except (ConfigError, ValueError, RecursionError):  # not a result: not ours to replace unasked
        return False
    return isinstance(stored, dict) and stored.get("status") == "partial"


def _remove_stale(folder: Path, names: Iterable[str]) -> None:
    """Remove temporary files for these names whose process has ended: one that lives holds a lock on its files."""
    if sys.platform == "win32":
        return
    kinds = {(Path(name).stem, Path(name).suffix) for name in names}
    try:
        found = [entry for entry in os.scandir(folder) if (match := _TEMPORARY.fullmatch(entry.name))
                 and (match["stem"], match["suffix"] or "") in kinds]  # fmt: skip
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


def _name_beside(target: Path) -> Path:
    """A new hidden name in the target's folder with the target's suffix."""
    return target.with_name(f".{target.stem}.{os.urandom(4).hex()}.tmp{target.suffix}")


def _create(target: Path) -> tuple[Path, int]:
    """Create a hidden file in the target's folder with the target's suffix and the permissions that the umask gives.

    Returns its path and an open descriptor that holds a lock on it.
    """
    while True:
        path = _name_beside(target)
        tell(Topic.TEMPORARY, str(path))
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


def _reason(error: OSError | ValueError) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
