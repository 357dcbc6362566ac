"""A bound on the memory of this process.

Guarantee: on Linux the process's private memory stays below the bound: an allocation beyond it fails, in Python as a
MemoryError, in C libraries in their way, which may be to abort. Libraries are loaded without the bound, because many
neither load nor fail in an orderly way when memory runs out; a bound that they alone exceed is refused right after.

Not guaranteed: the bound on systems that do not count mapped memory as data (macOS); there is none on Windows.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from ptmcad.errors import ConfigError
from ptmcad.process.handover import Topic, send
from ptmcad.process.shortage import LOW_LIMIT, caller_limits, in_units, speaks_of_memory

DEFAULT_SHARE = Fraction(9, 10)
"""The part of the machine's memory that is the bound where none is asked for."""

MIN_BOUND = 64 << 20
"""The exact engine's libraries alone need about half of this."""

MIN_ROOM = 32 << 20
"""What there must be beside the libraries once they are loaded, for anything to be computed or drawn."""

_GROUPS = Path("/sys/fs/cgroup")
_CONTAINER_LIMITS = ("memory.max", "memory/memory.limit_in_bytes")


class Bound(NamedTuple):
    """A number of bytes, and how to name it to the user."""

    size: int
    text: str


def default_bound() -> Bound | None:
    """Nine tenths of the memory of the machine, or of the container if that is less; None where it is not known."""
    sizes = []
    if hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        sizes.append((os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"), "machine"))
    for path in _container_limits():
        try:
            sizes.append((int(path.read_text(encoding="ascii")), "container"))
        except (OSError, ValueError):  # no such kind of container, or "max"
            continue
    if not sizes or min(sizes)[0] <= 0:
        return None
    least, whose = min(sizes)
    size = int(least * DEFAULT_SHARE)
    return Bound(size, f"{size / (1 << 30):.3g}G, nine tenths of this {whose}'s (--max-memory sets another),")


def _container_limits() -> Iterator[Path]:
    """Files that may hold a limit for this process: of its container, of its own group and of those above it."""
    for name in _CONTAINER_LIMITS:
        yield _GROUPS / name
    try:
        groups = Path("/proc/self/cgroup").read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    except OSError:
        return
    for line in groups:
        _, _, group = line.partition("::")  # of the second version of groups; the first names controllers between
        while group.strip("/"):
            yield _GROUPS / group.strip("/") / "memory.max"
            group = group.rpartition("/")[0]


class _InForce:
    """The bound that this process keeps at present, and the soft and hard limits that its caller had set."""

    bound: Bound | None = None
    before: tuple[int, int] = (-1, -1)


@contextmanager
def bounded(bound: Bound) -> Iterator[None]:
    """Keep this process below the bound, or below the one that its caller has set already if that is lower.

    Raises
    ------
    ConfigError
        Where the system has no such limits.
    """
    try:
        import resource
    except ImportError as error:
        raise ConfigError("this system cannot bound a process's memory", key="--max-memory") from error
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    sizes = [bound.size, *(limit for limit in (soft, hard) if limit != resource.RLIM_INFINITY)]
    resource.setrlimit(resource.RLIMIT_DATA, (min(sizes), hard))
    outer = _InForce.bound, _InForce.before
    _InForce.bound, _InForce.before = bound, (soft, hard)
    try:
        yield
    finally:
        _InForce.bound, _InForce.before = outer
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


@contextmanager
def loading(what: str) -> Iterator[None]:
    """Load libraries inside, without the bound, which holds again afterwards.

    The watching process is informed: so it knows that a failure here under a low limit of the caller's, which cannot be
    put off, is that limit's.

    Raises
    ------
    MemoryError
        When a library says that it cannot be loaded for lack of memory, whatever it raises, or just that it cannot be
        loaded, under a small limit of the caller's.
    """
    send(Topic.LOADING, what)
    try:
        with _without_bound():
            yield
    except (ImportError, OSError) as error:
        missing = isinstance(error, ModuleNotFoundError)
        small = any(size < LOW_LIMIT for size, _ in caller_limits())  # of which many loaders say nothing, as LLVM's
        if speaks_of_memory(str(error)) or (small and not missing):
            raise MemoryError(str(error)) from error
        raise
    send(Topic.LOADING, "")


@contextmanager
def _without_bound() -> Iterator[None]:
    if _InForce.bound is None:
        yield
        return
    import resource

    kept = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, _InForce.before)
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, kept)


def private_memory() -> int | None:
    """Bytes of private writable memory that this process has; None where the system does not say."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii", errors="replace").splitlines()
    except OSError:
        return None
    return next((int(line.split()[1]) << 10 for line in lines if line.startswith("VmData:")), None)


def missing_room(room: int = MIN_ROOM) -> int | None:
    """The least bound that would do, in bytes, if the libraries that are loaded by now leave less room; else None."""
    bound, used = _InForce.bound, private_memory()
    if bound is None or used is None or used + room <= bound.size:
        return None
    return used + room


def check_room(what: str) -> None:
    """Refuse a bound below what is needed beside the libraries that are loaded by now.

    Raises
    ------
    ConfigError
        That names the least bound that would do.
    """
    least = missing_room()
    if least is not None and _InForce.bound is not None:
        raise ConfigError(
            f"{_InForce.bound.text} is too little for {what}, which has {in_units(least - MIN_ROOM)} when its "
            f"libraries are loaded: at least {-(-least // (1 << 20))}M",
            key="--max-memory",
        )
