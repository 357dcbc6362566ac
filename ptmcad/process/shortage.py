"""Whether a process lacks memory: what it has, what its caller allows it, and whether it waits for more for ever.

Some libraries do not fail when an allocation does: OpenBLAS tries again and again, for ever, in the process that loads
it. Such a process computes nothing, but it is busy, so that no limit on time ends it soon.

Guarantee: a process is taken to wait for memory only when a limit leaves it less than `LOW_MEMORY`, its memory has not
changed by a page during seconds of its own processor time, and it is loading libraries or spends that time in the
kernel. What computes with little room, however long, is none such: arithmetic is no work for the kernel.

Not guaranteed: anything on systems without ``/proc``: there no process is taken to wait.

The watching process imports it, so it imports nothing that takes time.
"""

import os
import sys
from typing import NamedTuple

LOW_MEMORY = 64 << 20
"""Bytes: what OpenBLAS asks for at once, for each thread, is half of this."""
LOW_LIMIT = 1 << 30
"""Below so many bytes a memory limit may keep the libraries from being loaded."""
LOADING, COMPUTING = 5.0, 10.0
"""Seconds of processor time without any change, while libraries are loaded and later."""
IDLE_SECONDS = 30.0
"""Seconds without any change and without processor time, while libraries are loaded."""
KERNEL_SHARE = 0.25
"""Of the processor time, when nothing is being loaded: of a process that asks for memory in vain it is most."""

SIGNS = (
    "llocate ", "llocation still failed", "bad_alloc", "overflow in mpz", "MemoryError", "llocate memory",
    "failed to map segment", "static TLS block", "t start new thread", "LLVM ERROR: out of memory",
    "pthread_create failed",
)  # fmt: skip
"""What FLINT, GMP, OpenBLAS, C++, LLVM, Python and the loader of libraries print when they could not allocate, GMP also
at its size limit."""


def speaks_of_memory(text: str) -> bool:
    """Whether last words of a library say that memory ran out.

    >>> speaks_of_memory("libflint.so: failed to map segment from shared object"), speaks_of_memory("no such file")
    (True, False)
    """
    return any(sign in text for sign in SIGNS)


class Usage(NamedTuple):
    """What a process uses: bytes of private writable memory and of address space, resident bytes; seconds."""

    data: int
    space: int
    resident: int
    user: float
    kernel: float


class Limit(NamedTuple):
    """A limit on memory: its bytes, whether it counts the whole address space, and how to name it to the user."""

    size: int
    whole: bool
    text: str

    def room(self, usage: Usage) -> int:
        """What it leaves, in bytes."""
        return self.size - (usage.space if self.whole else usage.data)


def usage_of(process: int) -> Usage | None:
    """What a process uses by now; None when that is not known, as of one that has ended.

    >>> usage = usage_of(os.getpid())
    >>> usage is None or 0 < usage.data < usage.space
    True
    """
    try:
        with open(f"/proc/{process}/status", "rb") as file:
            lines = dict(line.split(b":", 1) for line in file.read().splitlines() if line.startswith(b"Vm"))
        with open(f"/proc/{process}/stat", "rb") as file:
            times = file.read().rpartition(b")")[2].split()[11:13]
    except OSError:
        return None
    if b"VmData" not in lines:  # it has ended
        return None
    data, space, resident = (int(lines[name].split()[0]) << 10 for name in (b"VmData", b"VmSize", b"VmRSS"))
    ticks = os.sysconf("SC_CLK_TCK")
    return Usage(data, space, resident, *(int(time) / ticks for time in times))


def caller_limits() -> tuple[Limit, ...]:
    """The limits on memory that this process was started with, such as a shell's ``ulimit -v``."""
    if sys.platform == "win32":
        return ()
    import resource  # not before it is needed: every start would pay for it

    found = []
    for which, whole, option in ((resource.RLIMIT_DATA, False, "-d"), (resource.RLIMIT_AS, True, "-v")):
        size = resource.getrlimit(which)[0]
        if size != resource.RLIM_INFINITY:
            found.append(Limit(size, whole, f"{in_units(size)} that the caller has set (ulimit {option})"))
    return tuple(found)


def in_units(size: int) -> str:
    """A number of bytes as people write it.

    >>> in_units(150 << 20), in_units(1536 << 20), in_units(1000)
    ('150M', '1.5G', '1K')
    """
    for unit, bytes_of_it in (("G", 1 << 30), ("M", 1 << 20)):
        if size >= bytes_of_it:
            return f"{size / bytes_of_it:.4g}{unit}"
    return f"{size / (1 << 10):.0f}K"


class Waiting:
    """Looks at a process, taken from time to time, and what they say of it."""

    def __init__(self) -> None:
        self.most: Usage | None = None
        self._same: Usage | None = None
        self._since = 0.0

    def look(self, usage: Usage | None, limits: tuple[Limit, ...], loading: bool, now: float) -> bool:
        """Whether the process waits for memory in vain.

        Parameters
        ----------
        usage : what it uses now.
        limits : those that are in force for it.
        loading : whether it loads libraries.
        now : a reading of a clock, in seconds.
        """
        if usage is None:
            return False
        most = self.most or usage
        self.most = usage._replace(data=max(most.data, usage.data), space=max(most.space, usage.space))
        if self._same is None or self._same[:3] != usage[:3]:
            self._same, self._since = usage, now
        if not any(limit.room(usage) < LOW_MEMORY for limit in limits):
            return False
        kernel = usage.kernel - self._same.kernel
        busy = usage.user - self._same.user + kernel
        if loading:
            return busy >= LOADING or (busy == 0 and now - self._since >= IDLE_SECONDS)
        return busy >= COMPUTING and kernel >= KERNEL_SHARE * busy
