"""Files that belong together, put into place together, under a lock on their folder.

A set of files has been written under hidden names and takes the place of an older set. The last file of a set is its
*voucher* (the JSON); the others are pictures of what it says.

Guarantee: whatever ends the process, at every moment the files that can be seen under their names are of one set: the
voucher is the old one or the new one, and the others are of the same set or missing. The old pictures are hidden first,
then the new voucher is renamed over the old one, then the new pictures are renamed. An error before the voucher is in
place restores the older set; one after it costs the pictures that it concerns. No file in the folder says what to do.

Not guaranteed: the order of the steps on disk when the machine loses power; that two processes that write the same
set at once, on a file system without locks, do not mix theirs.
"""

from __future__ import annotations

import math
import os
import re
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ptmcad.errors import OutputError
from ptmcad.process.handover import Topic, identity, send, undisturbed

if sys.platform != "win32":
    import fcntl

UNCHANGED = "earlier files are as they were"
HIDDEN = re.compile(r"\.(.*)\.[0-9a-f]{8}\.(?:tmp|old)((?:\.[^.]+)?)", re.DOTALL)
"""What `hidden` makes, with the target's stem and suffix."""
_PAUSE = 0.01
_SILENCE = 1.0
"""Seconds after which a process that waits for the lock as long as it takes says so."""
disk: Any = os
"""What renames and removes. A test puts another in its place, which stops or fails between two steps."""


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
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except PermissionError:  # which Windows raises for every folder
        yield False
        return
    try:
        yield _lock(descriptor, folder, patience)
    finally:
        os.close(descriptor)


def _lock(descriptor: int, folder: Path, patience: float | None) -> bool:
    until = time.monotonic() + (_SILENCE if patience is None else patience)
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() >= until:
                if patience is not None:
                    raise
                send(Topic.WAITING, str(folder))
                until = math.inf
            time.sleep(_PAUSE)
        except OSError:  # a file system without locks
            return False
        else:
            return True


def hidden(target: Path, kind: str = "tmp") -> Path:
    """A new hidden name in the target's folder with the target's suffix."""
    return target.with_name(f".{target.stem}.{os.urandom(4).hex()}.{kind}{target.suffix}")


def put_into_place(files: Mapping[Path, Path]) -> None:
    """Put a set into place, while no signal gets in. The caller holds the folder's lock.

    Parameters
    ----------
    files : for each target, in one folder, the whole file that is to be there. No target is a folder. The last one is
        the voucher.

    Raises
    ------
    OutputError
        When a file cannot be renamed; the message says what there is now.
    """
    *others, (voucher, new) = files.items()
    old = [(target, hidden(target, "old")) for target, _ in others if os.path.lexists(target)]
    with undisturbed():
        if old:
            send(Topic.TEMPORARY, *(str(path) for _, path in old))
        send(Topic.RENAMES, str(voucher), identity(new))
        try:
            for source, target in (*old, (new, voucher)):
                disk.replace(source, target)
        except OSError as error:
            lost = _rename((path, target) for target, path in old if os.path.lexists(path))
            state = f"earlier files that cannot be put back: {lost}" if lost else UNCHANGED
            place = voucher if source == new else source
            raise OutputError(f"{place} cannot be written: {reason(error)}; {state}") from error
        missing = _rename((path, target) for target, path in others)
        with suppress(OSError):  # what stays is hidden, without effect, and removed by a later run
            for _, path in old:
                disk.unlink(path)
        if missing:
            raise OutputError(f"cannot be put into place: {missing}; {voucher} itself is saved")


def _rename(moves: Iterable[tuple[Path, Path]]) -> str:
    """Rename every file that can be renamed; return which cannot, and why."""
    failures = []
    for source, target in moves:
        try:
            disk.replace(source, target)
        except OSError as error:
            failures.append(f"{target} ({reason(error)})")
    return ", ".join(failures)


def reason(error: OSError | ValueError) -> str:
    """What the system says."""
    return getattr(error, "strerror", None) or str(error)
