"""How the inner loops are compiled: by numba, kept on disk, without any licence to change
floating-point arithmetic.

Guarantee: each operation is rounded once, to nearest, as IEEE 754 says; no fused or reordered
operations, and division by zero gives an infinity. Nothing that depends on a slice is compiled in,
so a new slice compiles nothing. What is kept on disk belongs to the present text of all modules of
the rooms that have compiled code: numba looks only at the file of a function, and not at those of
the functions that it calls, so that after a correction of the arithmetic old code would have gone
on.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np

from ptmcad.errors import ConfigError
from ptmcad.extras import remedy

if sys.platform != "win32":
    import fcntl

F = TypeVar("F", bound=Callable[..., Any])

try:
    from numba import config, njit
    from numba.np import arraymath as _linear_algebra  # noqa: F401 - loads scipy's if there is one, now and not later
except ImportError as missing:
    if not isinstance(missing, ModuleNotFoundError):  # it is installed, and does not work
        raise
    raise ConfigError(remedy("certified")) from missing
except ValueError as error:  # numba reads its variables as it loads
    raise ConfigError(
        f"numba, on which the certified engine runs, cannot be loaded: {error} "
        "Are all variables of the environment right that begin with NUMBA_?"
    ) from error


_CONFIG: Any = config
ROOMS = ("certified", "formulas")
"""Folders of the package of whose own modules the digest is; elsewhere, and in folders within
them, nothing is compiled."""


def _folder() -> Path:
    """Where compiled code is kept: a folder for the present sources.

    It is where NUMBA_CACHE_DIR says, else beside the sources, else in the user's cache.
    """
    here = Path(__file__).parent
    beside = here / "__pycache__"
    if not os.access(beside if beside.exists() else here, os.W_OK):
        beside = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ptmcad"
    return Path(_CONFIG.CACHE_DIR or beside) / f"compiled-{digest_of(here.parent)[:16]}"


def digest_of(package: Path) -> str:
    """The digest of the text of all modules that compiled code may call."""
    digest = sha256()
    for room in ROOMS:
        for source in sorted((package / room).glob("*.py")):
            digest.update(f"{room}/{source.name}".encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()


_FOLDER = _folder()


_PAUSE = 0.05
_PATIENCE = 120.0
"""Seconds for which a process waits until another one has compiled: more than all takes on a slow
machine. It then compiles by itself, as the other may have been stopped without being ended."""


@contextmanager
def in_turn(part: str) -> Iterator[float]:
    """While this lasts no other process compiles the part; yields the seconds of waiting for one
    that did.

    Where files cannot be written or locked, each process compiles by itself, which is right as
    well, only slower.
    """
    if sys.platform == "win32":
        yield 0.0
        return
    try:
        _FOLDER.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(
            _FOLDER / f"{part}.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666
        )
    except OSError:  # numba has ways of its own where this folder may not be written
        yield 0.0
        return
    try:
        yield _waited(descriptor)
    finally:
        os.close(descriptor)


def _waited(descriptor: int) -> float:
    """Lock the file, or give up; the seconds until then, 0 where nobody else had it."""
    began, seconds = time.monotonic(), 0.0
    while seconds < _PATIENCE:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(_PAUSE)
            seconds = time.monotonic() - began
        except OSError:  # a file system without locks
            break
        else:
            break
    return seconds


ZERO, ONE = cast("int", np.int64(0)), cast("int", np.int64(1))
"""Numbers that numba takes for integers like any other: what takes a literal is compiled for that
one besides.
"""
FUNCTIONS: list[Any] = []
"""All that is compiled and kept, as numba's dispatchers."""


def compiled(function: F) -> F:
    """Compile for the machine; the global interpreter lock is released while the function runs.

    Each function is optimised once more with every one that calls it, and for each type that it is
    called with, for which a literal counts as one of its own. So what has one caller is better
    `inlined`, and a literal argument is written as `ZERO` or `ONE`. Assigning one array to a slice
    of another compiles numba's broadcasting, with the texts of its errors: a loop takes a twentieth
    of the time.
    """
    usual = _CONFIG.CACHE_DIR
    # numba asks for the folder when it decorates
    _CONFIG.CACHE_DIR = str(_FOLDER)
    try:
        decorated = njit(cache=True, nogil=True, error_model="numpy", fastmath=False)(function)
    finally:
        _CONFIG.CACHE_DIR = usual
    FUNCTIONS.append(decorated)
    return cast("F", decorated)


def inlined(function: F) -> F:
    """The same for a function of a few operations, which is written out where it is used."""
    return cast(
        "F", njit(nogil=True, error_model="numpy", fastmath=False, inline="always")(function)
    )
