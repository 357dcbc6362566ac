"""The limits that every command has: ``--timeout`` and ``--max-memory``.

Guarantee: in a watched process (`ptmcad.process.supervisor`) they hold whatever code runs;
elsewhere the memory limit holds, and the time limit where the command itself looks at the clock.
"""

from __future__ import annotations

import math
import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import click

from ptmcad.cli.commonoptions import F, gathered, reading
from ptmcad.errors import ConfigError
from ptmcad.options import Progress
from ptmcad.process.handover import Topic, send, watched
from ptmcad.process.memory import Bound, bounded, kernel_lines

MIN_BOUND = 64 << 20
"""The exact engine's libraries alone need about half of this."""

_GROUPS = "/sys/fs/cgroup"
_SIZE = re.compile(r"([0-9]{1,12}(?:\.[0-9]{1,12})?)\s*([KMGT])(?:I?B)?", re.IGNORECASE)
_UNITS = {"K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}


def seconds_of(_key: str, value: float) -> float:
    """A positive number of seconds."""
    if not 0 < value < 1e9:
        raise click.BadParameter(f"{value} is not a positive number of seconds")
    return value


def bound_of(text: str) -> Bound:
    """A bound as it is written: a number and a unit K, M, G or T (powers of 1024).

    Raises
    ------
    ConfigError
        When it is not of that form, or no sensible size.

    Examples
    --------
    >>> bound_of("500M")[0], bound_of("1.5 GiB")[0]
    (524288000, 1610612736)
    """
    match = _SIZE.fullmatch(text.strip())
    shown = text if len(text) <= 30 else f"{text[:30]}..."
    if match is None:
        raise ConfigError(
            f"'{shown}' is not a size: write a number and a unit, such as 500M or 2G",
            key="--max-memory",
        )
    size = int(Fraction(match[1]) * _UNITS[match[2].upper()])
    if size < MIN_BOUND:
        raise ConfigError(
            f"{shown} is too little to start with: at least {MIN_BOUND >> 20}M", key="--max-memory"
        )
    if size >= 1 << 60:
        raise ConfigError(f"{shown} is more than any machine has", key="--max-memory")
    return size, text.strip()


def default_bound() -> Bound:
    """Nine tenths of the memory of the machine, or of the container if that is less."""
    machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    group = Path(
        _GROUPS,
        *(line[4:] for line in kernel_lines("/proc/self/cgroup") if line.startswith("0::/")),
    )
    older = Path(_GROUPS, "memory", "memory.limit_in_bytes")  # of the first kind of control groups
    paths = [*(place / "memory.max" for place in (group, *group.parents)), older]
    texts = [text for path in paths for text in kernel_lines(path)]
    least, whose = min(
        [(machine, "machine"), *((int(text), "container") for text in texts if text.isdigit())]
    )
    size = least * 9 // 10
    return (
        size,
        f"{size / (1 << 30):.3g}G, nine tenths of this {whose}'s (--max-memory sets another),",
    )


class ResourceLimits(NamedTuple):
    """Seconds and memory that a command may take, None for no limit of its own."""

    timeout: float | None
    max_memory: Bound | None


def limit_options(command: F) -> F:
    """Add ``--timeout`` and ``--max-memory``, which the command gets as ``limits``."""
    command = gathered(limits=ResourceLimits)(command)
    command = click.option("--max-memory", callback=reading(lambda _, text: bound_of(text)), metavar="SIZE",
                           help="Stop before using more memory, such as 500M or 2G (exit status 3; 2 when it is "
                                "too little to start with).  "
                                "[default: 9/10 of the machine's]")(command)  # fmt: skip
    return click.option("--timeout", type=float, callback=reading(seconds_of), metavar="S",
                        help="Stop after S seconds (exit status 3); loading the certified engine, and compiling it "
                             "once on a machine, are not counted.")(command)  # fmt: skip


def report_deadline(timeout: float | None, spent: float = 0.0) -> None:
    """The time limit starts now, or started so many seconds ago."""
    if timeout is not None:
        send(Topic.DEADLINE, repr(time.monotonic() + timeout - spent), f"{timeout:g} s")


@contextmanager
def clock_stopped(timeout: float | None, spent: float = 0.0) -> Iterator[None]:
    """The time limit does not run inside; it starts at the end, or has started so many seconds
    before.
    """
    if timeout is not None:
        send(Topic.DEADLINE, repr(math.inf), "")
    yield
    report_deadline(timeout, spent)


def compile_certified(timeout: float | None, progress: Progress) -> None:
    """Load the certified engine, and compile it where that is needed, outside of the time limit."""
    from ptmcad.ask.classification import load_certified

    with clock_stopped(timeout):
        load_certified(progress)


@contextmanager
def held(limits: ResourceLimits) -> Iterator[None]:
    """Set the limits for what is done inside."""
    report_deadline(limits.timeout)
    bound = limits.max_memory or (default_bound() if watched() else None)
    # NumPy's linear algebra would reserve memory for every processor; the small matrices here are
    # no faster on several
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if bound is not None:
        send(Topic.MEMORY, str(bound[0]), bound[1])
    with nullcontext() if bound is None else bounded(bound):
        yield
