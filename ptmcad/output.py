"""The files of a result: all of them written beside their places first, then renamed together.

Guarantee: at every moment each target file is either the old one or the new one, whole. Nothing is renamed before
everything is written and on disk. Whatever stops the writing (an error, Ctrl-C, a signal that raises) leaves no
temporary file; a process that is killed outright may leave a hidden ``.NAME.*.tmp.*`` file and nothing else.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from ptmcad.errors import OutputError

Writer = Callable[[Path], None]


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
    probe = _temporary(folder / "probe")
    try:
        _create(probe)
        probe.write_text("writable", encoding="utf-8")
    except OSError as error:
        raise OutputError(
            f"the folder {folder} can not be written to: {_reason(error)}; choose another with --out"
        ) from error
    finally:
        probe.unlink(missing_ok=True)


def write_files(folder: Path, writers: Mapping[str, Writer]) -> tuple[Path, ...]:
    """Write all files or none, and rename them into place in the given order.

    Parameters
    ----------
    folder : where they go; it exists.
    writers : for each file's name, a function that writes the file at the path it is given (the path has the name's
        suffix). Put the file that vouches for the others last.

    Raises
    ------
    OutputError
        If a file can not be written or renamed.
    """
    targets = {folder / name: _temporary(folder / name) for name in writers}
    current = folder
    try:
        for (target, temporary), write in zip(targets.items(), writers.values(), strict=True):
            current = target
            _create(temporary)
            write(temporary)
            _flush_to_disk(temporary)
        for target, temporary in targets.items():
            current = target
            temporary.replace(target)
    except OSError as error:
        raise OutputError(f"{current} can not be written: {_reason(error)}; earlier files are as they were") from error
    finally:
        for temporary in targets.values():
            temporary.unlink(missing_ok=True)
    return tuple(targets)


def _temporary(target: Path) -> Path:
    """A new hidden name in the target's folder with the target's suffix."""
    return target.with_name(f".{target.stem}.{os.urandom(4).hex()}.tmp{target.suffix}")


def _create(path: Path) -> None:
    """Create the file, which must not exist, with the permissions that the user's umask gives."""
    os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))


def _flush_to_disk(path: Path) -> None:
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())


def _reason(error: OSError | ValueError) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
