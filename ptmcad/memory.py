"""A bound on the memory of this process.

Guarantee: on Linux the process's private memory stays below the bound: an allocation beyond it fails, in Python as a
MemoryError, in C libraries in their way, which may be to abort.

Not guaranteed: the bound on systems that do not count mapped memory as data (macOS); there is none on Windows.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction

from ptmcad.errors import ConfigError

SHARE = Fraction(9, 10)
"""The part of the machine's memory that is the bound where none is asked for."""

LEAST = 64 << 20
"""The libraries alone need about half of this."""

_SIZE = re.compile(r"([0-9]{1,12}(?:\.[0-9]{1,12})?)\s*([KMGT])(?:I?B)?", re.IGNORECASE)
_UNITS = {"K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}
_CONTAINER_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


@dataclass(frozen=True, slots=True)
class Bound:
    """A number of bytes, and how to name it to the user."""

    size: int
    text: str


def bound_of(text: str) -> Bound:
    """A bound as it is written: a number and a unit K, M, G or T (powers of 1024).

    Raises
    ------
    ConfigError
        When it is not of that form, or no sensible size.

    Examples
    --------
    >>> bound_of("500M").size, bound_of("1.5 GiB").size
    (524288000, 1610612736)
    """
    match = _SIZE.fullmatch(text.strip())
    shown = text if len(text) <= 30 else f"{text[:30]}..."
    if match is None:
        raise ConfigError(f"'{shown}' is not a size: write a number and a unit, such as 500M or 2G", key="--max-memory")
    size = int(Fraction(match[1]) * _UNITS[match[2].upper()])
    if size < LEAST:
        raise ConfigError(f"{shown} is too little to start with: at least {LEAST >> 20}M", key="--max-memory")
    if size >= 1 << 60:
        raise ConfigError(f"{shown} is more than any machine has", key="--max-memory")
    return Bound(size, text.strip())


def default_bound() -> Bound | None:
    """Nine tenths of the memory of the machine, or of the container if that is less; None where it is not known."""
    sizes = []
    if hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        sizes.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for path in _CONTAINER_LIMITS:
        try:
            with open(path, encoding="ascii") as file:
                sizes.append(int(file.read()))
        except (OSError, ValueError):  # no such kind of container, or "max"
            continue
    if not sizes or min(sizes) <= 0:
        return None
    size = int(min(sizes) * SHARE)
    return Bound(size, f"{size / (1 << 30):.3g}G, nine tenths of this machine's (--max-memory sets another),")


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
        raise ConfigError("this system can not bound a process's memory", key="--max-memory") from error
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    sizes = [bound.size, *(limit for limit in (soft, hard) if limit != resource.RLIM_INFINITY)]
    resource.setrlimit(resource.RLIMIT_DATA, (min(sizes), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
