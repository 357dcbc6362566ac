"""Whether memory was what a process lacked: what libraries say then, and what its caller allows it.

The watching process imports it, so it imports nothing that takes time.
"""

import sys

LOW_LIMIT = 1 << 30
"""Below so many bytes a memory limit may keep the libraries from being loaded."""

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


Limit = tuple[int, str]
"""A limit on memory in bytes, and how to name it to the user."""


def caller_limits() -> tuple[Limit, ...]:
    """The limits on memory that this process was started with, such as a shell's ``ulimit -v``."""
    if sys.platform == "win32":
        return ()
    import resource  # not before it is needed: every start would pay for it

    found = []
    for which, option in ((resource.RLIMIT_DATA, "-d"), (resource.RLIMIT_AS, "-v")):
        size = resource.getrlimit(which)[0]
        if size != resource.RLIM_INFINITY:
            found.append((size, f"{in_units(size)} that the caller has set (ulimit {option})"))
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
