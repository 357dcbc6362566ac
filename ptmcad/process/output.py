"""The files of a result: written under hidden names first, then put into place together, under a
lock on their folder.

The last file of a set is its *voucher* (the JSON); the others are pictures of what it says, and
carry its hash.

Guarantee: every file under its own name is whole. Whatever ends the process, at every moment those
that can be seen of the names of a set are of one set: the voucher is the old one or the new one,
and the others are of the same set or missing. A picture in a format that is not written now stays
as it is; its stamp says that it is of an older result. Nothing is put into place before everything
is written and on disk; then the old pictures are hidden, the new voucher is renamed over the old
one, and the new pictures are renamed. An error before the voucher is in place restores the older
set; one after it costs the pictures that it concerns. What is hidden lies in a folder
``.NAME.*.tmp`` that its process locks and removes; one that a killed process has left is removed by
the next `check_writable` for the same name. No file in a folder says what to do. A result that a
limit has stopped replaces no complete one.

Not guaranteed: the order of the steps on disk when the machine loses power; that two processes that
write the same set at once, on a file system without locks, do not mix theirs.
"""

from __future__ import annotations

import errno
import fcntl
import json
import math
import os
import stat
import time
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from fractions import Fraction
from functools import partial
from glob import escape
from itertools import count
from pathlib import Path

from ptmcad.errors import ConfigError, OutputError
from ptmcad.process.handover import Topic, remove, send, undisturbed
from ptmcad.text.textfile import json_data, read_text

Writer = Callable[[Path], object]

MAX_BYTES = 60_000_000
"""Of an older result that is looked at."""
LOCK_PATIENCE = 1.0
"""Seconds that the parts of a program that must come to an end wait for the lock."""
UNCHANGED = "earlier files are as they were"


def text_writer(text: str) -> Writer:
    """A writer of the text, as UTF-8 with plain line feeds."""
    return partial(Path.write_text, data=text, encoding="utf-8", newline="\n")


def reason(error: OSError | ValueError) -> str:
    """What the system says."""
    return getattr(error, "strerror", None) or str(error)


@contextmanager
def locked(folder: Path, patience: float = math.inf) -> Iterator[bool]:
    """Keep other processes of this program from renaming files in the folder.

    Yields whether they are kept out: False where the file system has no locks, the folder may be
    written to but not read, or is gone.

    Parameters
    ----------
    patience : seconds to wait for the lock. A signal's handler runs meanwhile.

    Raises
    ------
    BlockingIOError
        When another process has held the lock all the time.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except (PermissionError, FileNotFoundError):
        yield False
        return
    try:
        yield _lock(descriptor, time.monotonic() + patience)
    finally:
        os.close(descriptor)


def _lock(descriptor: int, until: float) -> bool:
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        except BlockingIOError:
            if time.monotonic() >= until:
                raise
            time.sleep(0.01)
        except OSError:  # a file system without locks
            return False


@contextmanager
def _hidden_folder(target: Path) -> Iterator[Path]:
    """A new folder beside the target, locked while it is used, and removed in the end with what is
    in it.
    """
    while True:
        path = target.with_name(f".{target.stem}.{os.urandom(4).hex()}.tmp")
        send(Topic.TEMPORARY, str(path))
        path.mkdir()
        try:
            with locked(path):
                if (
                    path.exists()
                ):  # otherwise another process has taken it for a stale one before it was locked
                    yield path
                    return
        finally:
            with suppress(OSError):  # what cannot be removed is hidden, and removed by a later run
                remove(path)


def _remove_stale(folder: Path, names: Iterable[str]) -> None:
    """Remove hidden folders for these names whose process has ended: one that lives holds a lock on
    its own.
    """
    for stem in {escape(Path(name).stem) for name in names}:
        for left in folder.glob(f".{stem}.{'[0-9a-f]' * 8}.tmp"):
            with suppress(OSError), locked(left, patience=0) as alone:
                if alone and not left.is_symlink():
                    remove(left)


def check_writable(folder: Path, names: tuple[str, ...] = ()) -> None:
    """Create the folder if it is missing and prove, by writing, that files of these names can be
    put there.

    To be called before a long computation. What killed runs have left there is removed.

    Raises
    ------
    OutputError
        With the folder or file and the reason.
    """
    wanted = "made"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        wanted = "written to"
        _check_kinds(folder / name for name in names)
        names = ("probe", *names)
        _remove_stale(folder, names)
        with _hidden_folder(folder / names[-1]) as hidden:
            for name in names:
                (hidden / name).write_bytes(b"writable")
    except (OSError, ValueError) as error:
        why = f"the folder {folder} cannot be {wanted}: {reason(error)}; choose another with --out"
        raise OutputError(why) from error


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
            mode = os.stat(target).st_mode  # once: another run may move it in between
        except (OSError, ValueError):
            continue
        if not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "no regular file"
            raise OutputError(
                f"{target} is {kind}, so no file can be written there; choose another --out"
            )


def write_files(
    folder: Path, writers: Mapping[str, Writer], *, new: bool = False
) -> tuple[Path, ...]:
    """Write all files, then put them into place.

    Parameters
    ----------
    folder : where they go; it exists.
    writers : for each file's name, one at least, a function that writes the file at the path it is
        given (the path has the name's suffix). The last one is the file that vouches for the
        others.
    new : that nothing, not even a link, may have these names yet.

    Raises
    ------
    OutputError
        If a file cannot be written or renamed; the message says what there is then.
    """
    with _written(folder, writers) as files, locked(folder):
        _check_kinds(files)
        if new and any(map(os.path.lexists, files)):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
        _put_into_place(files)
        return tuple(files)


@contextmanager
def _written(folder: Path, writers: Mapping[str, Writer]) -> Iterator[dict[Path, Path]]:
    """For each target, where the whole file is that is to be there, hidden and on disk."""
    files: dict[Path, Path] = {}
    current = folder
    try:
        with _hidden_folder(folder / [*writers][-1]) as hidden:
            for name, write in writers.items():
                current = folder / name
                files[current] = hidden / name
                write(files[current])
            stamp([*files.values()][:-1], files[current])
            for path in files.values():
                with path.open("rb+") as file:
                    os.fsync(file)
            yield files
    except OSError as error:
        raise OutputError(f"{current} cannot be written: {reason(error)}; {UNCHANGED}") from error


def stamp(pictures: Iterable[Path], voucher: Path) -> None:
    """Give every picture among the files the SHA-256 of a JSON document, which tells whether both
    are of one set.

    Guarantee: what is drawn stays as it was; readers of each format pass over the stamp, which
    ``grep -a sha256`` shows. It is a text chunk of a PNG, and a comment in an SVG, a PDF and an
    EPS.

    Raises
    ------
    OSError
        When a file cannot be read or written.
    """
    pictures = tuple(pictures)
    if voucher.suffix != ".json" or not pictures:
        return
    from hashlib import sha256  # with OpenSSL, which only runs that draw need

    text = f"sha256 of {voucher.name}: {sha256(voucher.read_bytes()).hexdigest()}".encode(
        "ascii", "replace"
    )
    for path in pictures:
        content = path.read_bytes()
        if content.startswith(b"\x89PNG"):
            chunk = b"tEXtSource\0" + text
            chunk = (len(chunk) - len(b"tEXt")).to_bytes(4) + chunk + zlib.crc32(chunk).to_bytes(4)
            content = content[:-12] + chunk + content[-12:]  # before the last chunk, which is empty
        elif content.startswith(b"<?xm"):
            content += b"<!-- " + text.replace(b"--", b"- -") + b" -->\n"
        elif content.startswith((b"%PDF", b"%!PS")):
            body, end, rest = content.rpartition(b"%%EOF")
            content = body + b"% " + text + b"\n" + end + rest
        else:
            continue
        path.write_bytes(content)


def _put_into_place(files: Mapping[Path, Path]) -> None:
    """Put a set into place, while no signal gets in. The caller holds the folder's lock.

    Raises
    ------
    OutputError
        When a file cannot be renamed; the message says what there is now.
    """
    *others, (voucher, new) = files.items()
    old = [
        (target, path.with_name(f".old-{path.name}"))
        for target, path in others
        if os.path.lexists(target)
    ]
    with undisturbed():
        try:
            for source, target in (*old, (new, voucher)):
                os.replace(source, target)
        except OSError as error:
            lost = _rename((path, target) for target, path in old if os.path.lexists(path))
            state = f"earlier files that cannot be put back: {lost}" if lost else UNCHANGED
            place = voucher if source == new else source
            raise OutputError(f"{place} cannot be written: {reason(error)}; {state}") from error
        send(Topic.SAVED, str(voucher))
        missing = _rename((path, target) for target, path in others)
        with suppress(OSError):  # before a signal that has come meanwhile ends this process
            remove(new.parent)
        if missing:
            raise OutputError(f"cannot be put into place: {missing}; {voucher} itself is saved")


def _rename(moves: Iterable[tuple[Path, Path]]) -> str:
    """Rename every file that can be renamed; return which cannot, and why."""
    failures = []
    for source, target in moves:
        try:
            os.replace(source, target)
        except OSError as error:
            failures.append(f"{target} ({reason(error)})")
    return ", ".join(failures)


def save_stopped(
    target: Path, text: str, *, whole: bool = False, beside: Iterable[str] = ()
) -> tuple[Path, str]:
    """Save the result of a computation that a limit has stopped.

    Returns where, and why not in the file that was asked for, as the end of a sentence; empty if
    there.

    Guarantee: a whole older result stays, and so do its pictures. Only a file that is marked as
    partial is replaced, and only where none of the pictures is there that the run would have
    replaced. Otherwise the result goes to ``NAME.partial.json``, or ``NAME.complete.json`` if all
    but its pictures is done, where the newest is kept. What is no such result, or has less
    undetermined, stays there, and ``NAME.partial-2.json`` is taken, and so on.

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
    further = (f"{label}-{number}" if number > 1 else label for number in count(1))
    names = (target.with_name(f"{target.stem}.{name}{target.suffix}") for name in further)
    with _written(target.parent, {target.name: text_writer(text)}) as files, ExitStack() as lock:
        busy = ""
        try:
            lock.enter_context(locked(target.parent, LOCK_PATIENCE))
        except (
            BlockingIOError
        ):  # a process that does not move on has it: what is no part of a set needs no lock
            busy = f", because another process is writing {target.name}"
        why = _why_not(target, text, beside=beside) or busy
        place = next(name for name in names if not _why_not(name, text, whole)) if why else target
        _put_into_place({place: files[target]})
    return place, why


def _why_not(place: Path, text: str, whole: bool = False, beside: Iterable[str] = ()) -> str:
    """Why a stopped result may not take this place, as the end of a sentence; empty where it may.

    Parameters
    ----------
    whole : whether it replaces results that are complete, too.
    """
    if os.path.lexists(place):
        try:
            stored = json_data(read_text(place, MAX_BYTES, "a result"))
        except (ConfigError, ValueError):
            stored = None
        # what is no result is not ours to replace unasked
        if not isinstance(stored, dict) or not (whole or stored.get("status") == "partial"):
            return f", because {place.name} holds an older result that is not partial"
        with suppress(
            KeyError, TypeError, ValueError, ZeroDivisionError
        ):  # an exact result, or no map of this program
            new = json.loads(text)
            maps = stored["cover"] is not None and new["cover"] is not None
            if maps and Fraction(stored["undetermined"]) < Fraction(new["undetermined"]):
                return f", because less is undetermined in the older partial result {place.name}"
    pictures = [name for name in beside if os.path.lexists(place.with_name(name))]
    return f", because {pictures[0]} shows an older result" if pictures else ""


def how_to_go_on(place: Path) -> str:
    """What goes on from a stopped result that can be gone on from, as the end of a sentence."""
    import shlex  # which a run that ends well does not need

    return f"; go on with --resume {shlex.quote(str(place))}"
