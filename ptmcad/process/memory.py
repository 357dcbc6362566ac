"""A bound on the memory of this process, and whether memory was what a process lacked.

Guarantee: on Linux the process's private memory stays below the bound: an allocation beyond it fails, in Python as a
MemoryError, in C libraries in their way, which may be to abort. Libraries are loaded without the bound, because many
neither load nor fail in an orderly way when memory runs out; a bound that they alone exceed is refused right after.

Not guaranteed: the bound on systems that do not count mapped memory as data (macOS).
"""

from __future__ import annotations

import os
import resource
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, suppress
from pathlib import Path
from typing import NamedTuple

from ptmcad.errors import ConfigError
from ptmcad.process.handover import watched

MIN_BOUND = 64 << 20
"""The exact engine's libraries alone need about half of this."""

MIN_ROOM = 32 << 20
"""What there must be beside the libraries once they are loaded, for anything to be computed or drawn."""

LOW_LIMIT = 1 << 30
"""Below so many bytes a memory limit may keep the libraries from being loaded."""

SIGNS = (
    "llocate ", "llocation still failed", "bad_alloc", "overflow in mpz", "MemoryError",
    "failed to map segment", "static TLS block", "t start new thread", "LLVM ERROR: out of memory",
    "pthread_create failed",
)  # fmt: skip
"""What FLINT, GMP, OpenBLAS, C++, LLVM, Python and the loader of libraries print when they could not allocate, GMP also
at its size limit."""

_GROUPS = Path("/sys/fs/cgroup")


class Bound(NamedTuple):
    """A number of bytes, and how to name it to the user."""

    size: int
    text: str


_in_force: list[tuple[Bound, tuple[int, int]]] = []
"""The bound that this process keeps, if any, and the soft and hard limits that its caller had set."""


def default_bound() -> Bound:
    """Nine tenths of the memory of the machine, or of the container if that is less."""
    sizes = [(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"), "machine")]
    for path in _container_limits():
        with suppress(OSError, ValueError):  # no such kind of container, or "max"
            sizes.append((int(path.read_text(encoding="ascii")), "container"))
    least, whose = min(sizes)
    size = least * 9 // 10
    return Bound(size, f"{size / (1 << 30):.3g}G, nine tenths of this {whose}'s (--max-memory sets another),")


def _container_limits() -> list[Path]:
    """Files that may hold a limit for this process: of its group and of those above it, or of an older container."""
    group = next((line[3:] for line in _lines("/proc/self/cgroup") if line.startswith("0::")), "")
    own = _GROUPS / group.strip("/")
    return [*(place / "memory.max" for place in (own, *own.parents)), _GROUPS / "memory" / "memory.limit_in_bytes"]


def _lines(path: str) -> list[str]:
    """Of a file of the kernel's; none where there is no such file."""
    try:
        return Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []


@contextmanager
def bounded(bound: Bound) -> Iterator[None]:
    """Keep this process below the bound, or below the one that its caller has set already if that is lower."""
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    sizes = [bound.size, *(limit for limit in (soft, hard) if limit != resource.RLIM_INFINITY)]
    resource.setrlimit(resource.RLIMIT_DATA, (min(sizes), hard))
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
    what : what they are for, if a bound is to be refused that leaves too little room beside them.

    Raises
    ------
    MemoryError
        When a library says that it cannot be loaded for lack of memory, whatever it raises, or just that it cannot be
        loaded, under a small limit of the caller's.
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
    except (ImportError, OSError, SystemError) as error:
        missing = isinstance(error, ModuleNotFoundError)
        small = any(size < LOW_LIMIT for size, _ in caller_limits())  # of which many loaders say nothing, as LLVM's
        if speaks_of_memory(str(error)) or (small and not missing):
            raise MemoryError(str(error)) from error
        raise
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, kept)
    least = missing_room()
    if what and least is not None:
        raise ConfigError(
            f"{_in_force[-1][0].text} is too little for {what}, which has {in_units(least - MIN_ROOM)} when its "
            f"libraries are loaded: at least {-(-least // (1 << 20))}M",
            key="--max-memory",
        )


def private_memory() -> int | None:
    """Bytes of private writable memory that this process has; None where the system does not say."""
    lines = _lines("/proc/self/status")
    return next((int(line.split()[1]) << 10 for line in lines if line.startswith("VmData:")), None)


def missing_room(room: int = MIN_ROOM) -> int | None:
    """The least bound that would do, in bytes, if the libraries that are loaded by now leave less room; else None."""
    used = private_memory()
    return used + room if used is not None and _in_force and used + room > _in_force[-1][0].size else None


def speaks_of_memory(text: str) -> bool:
    """Whether last words of a library say that memory ran out.

    >>> speaks_of_memory("libflint.so: failed to map segment from shared object"), speaks_of_memory("no such file")
    (True, False)
    """
    return any(sign in text for sign in SIGNS)


def caller_limits() -> list[tuple[int, str]]:
    """The limits on memory that this process was started with, such as a shell's ``ulimit -v``: bytes, and words."""
    found = []
    for which, option in ((resource.RLIMIT_DATA, "-d"), (resource.RLIMIT_AS, "-v")):
        size = resource.getrlimit(which)[0]
        if size != resource.RLIM_INFINITY:
            found.append((size, f"{in_units(size)} that the caller has set (ulimit {option})"))
    return found


def in_units(size: int) -> str:
    """A number of bytes as people write it.

    >>> in_units(150 << 20), in_units(1536 << 20), in_units(1000)
    ('150M', '1.5G', '1K')
    """
    for unit, bytes_of_it in (("G", 1 << 30), ("M", 1 << 20)):
        if size >= bytes_of_it:
            return f"{size / bytes_of_it:.4g}{unit}"
    return f"{size / (1 << 10):.0f}K"
