"""A bound on the memory of this process, and whether memory was what a process lacked.

Guarantee: on Linux the process's private memory stays below the bound: an allocation beyond it
fails, in Python as a MemoryError, in C libraries in their way, which may be to abort. Libraries are
loaded without the bound, because many neither load nor fail in an orderly way when memory runs out;
a bound that they alone exceed is refused right after.

Not guaranteed: the bound on systems that do not count mapped memory as data (macOS).
"""

from __future__ import annotations

import resource
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr
from pathlib import Path

from ptmcad.errors import ConfigError
from ptmcad.process.handover import watched

MIN_ROOM = 32 << 20
"""The room that there must be besides the libraries once they are loaded, for anything to be computed or
drawn.
"""

LOW_LIMIT = 1 << 30
"""Below so many bytes a memory limit may keep the libraries from being loaded."""

SIGNS = (
    "llocate ", "llocation still failed", "bad_alloc", "overflow in mpz", "MemoryError",
    "failed to map segment", "static TLS block", "t start new thread", "pthread_create failed",
    "LLVM ERROR: out of memory",
)  # fmt: skip
"""What FLINT, GMP, OpenBLAS, C++, LLVM, Python and the loader of libraries print when they could
not allocate, GMP also at its size limit."""


Bound = tuple[int, str]
"""A bound in bytes, and in words."""
_in_force: list[tuple[Bound, tuple[int, int]]] = []
"""The bound that this process keeps, if any, and the soft and hard limits that its caller had set.
"""


def kernel_lines(path: str | Path) -> list[str]:
    """Of a file of the kernel's; none where there is no such file."""
    try:
        return Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []


@contextmanager
def bounded(bound: Bound) -> Iterator[None]:
    """Keep this process below the bound, or below the one that its caller has set already if that
    is lower.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    size = bound[0] if soft == resource.RLIM_INFINITY else min(bound[0], soft)
    resource.setrlimit(resource.RLIMIT_DATA, (size, hard))
    _in_force.append((bound, (soft, hard)))
    try:
        yield
    finally:
        _in_force.pop()
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


@contextmanager
def loading(what: str = "") -> Iterator[None]:
    """Load libraries inside, without the bound, which holds again afterwards.

    Parameters
    ----------
    what : what they are for, if a bound is to be refused that leaves too little room besides them.

    Raises
    ------
    MemoryError
        When a library says that it cannot be loaded for lack of memory, whatever it raises, or just
        that it cannot be loaded, under a small limit of the caller's.
    ConfigError
        That names the least bound that would do.
    """
    kept = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, _in_force[-1][1] if _in_force else kept)
    # what they print meanwhile the process that watches shows, unless it comes of a limit
    printed = open(2, "w", 1, closefd=False) if watched() else sys.stderr  # noqa: SIM115 - it stays open
    try:
        with redirect_stderr(printed):
            yield
    except (
        ImportError,
        OSError,
        SystemError,
    ) as error:  # many loaders, as LLVM's, say nothing of memory
        if isinstance(error, ModuleNotFoundError) or not exhausted(str(error)):
            raise
        raise MemoryError(str(error)) from error
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, kept)
    least = missing_room()
    if what and least is not None:
        raise ConfigError(
            f"{_in_force[-1][0][1]} is too little for {what}, which has {least - MIN_ROOM >> 20}M when its "
            f"libraries are loaded: at least {-(-least // (1 << 20))}M",
            key="--max-memory",
        )


def missing_room(room: int = MIN_ROOM) -> int | None:
    """The least bound that would do, in bytes, if the libraries that are loaded by now leave less
    room; else None.
    """
    # private writable memory; where the system does not count it there is no bound either
    used = [
        int(line.split()[1]) << 10
        for line in kernel_lines("/proc/self/status")
        if line.startswith("VmData:")
    ]
    least = max(used, default=0) + room
    return least if _in_force and least > _in_force[-1][0][0] else None


def exhausted(text: str, most: int = 0, own: Sequence[str] = (), how: str = "") -> str:
    """Whether lack of memory has ended a process, in words, which name the lowest limit; empty if
    not.

    Where nothing says so it is most likely under a small limit of the caller's, or when half of a
    limit had been used.

    Parameters
    ----------
    text : its last words, and those of its libraries.
    most : bytes that it has used.
    own : the bound that it has kept, if any: in bytes, and in words.
    how : it ended, where its last words do not say so.
    """
    callers = caller_limits()
    limits = [*callers, (int(own[0]), own[1])] if own else callers
    reached = f"the memory limit of {min(limits, default=(0, 'the system'))[1]} was reached"
    if any(sign in text for sign in SIGNS):
        return reached
    if all(size >= LOW_LIMIT for size, _ in callers) and all(2 * most < size for size, _ in limits):
        return ""
    last = text.rstrip().rpartition("\n")[2][:200] or "without a word"
    return f"most likely {reached} ({how or last})"


def caller_limits() -> list[tuple[int, str]]:
    """The limits on memory that this process was started with, such as a shell's ``ulimit -v``:
    bytes, and words.
    """
    found = []
    for which, option in ((resource.RLIMIT_DATA, "-d"), (resource.RLIMIT_AS, "-v")):
        size = resource.getrlimit(which)[0]
        if size != resource.RLIM_INFINITY:
            found.append((size, f"{size >> 20}M that the caller has set (ulimit {option})"))
    return found
