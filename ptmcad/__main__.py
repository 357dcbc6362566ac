"""The program's entry: ``ptmcad`` and ``python -m ptmcad``.

Guarantee: from the first statement of `main` on, the signals of `STOPPING` end the program without a traceback; they
stay without effect where the caller has had them ignored (``nohup``, a shell's background jobs).

Nothing is imported here but what the signals need, because a signal that comes during an import must find its handler.
"""

import gc
import os
import signal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

_ROOM = [bytearray(96 << 10)]
"""Given back where there is none left, for the few lines that say so."""

_YOUNG_OBJECTS = 100_000
"""More than a short run makes: the collector looks at those made since its last look when they are
so many.
"""

STOPPING = (
    signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGUSR2, signal.SIGALRM,
)  # fmt: skip
"""The signals that people and batch systems send to end a program, and whose default is to do so.
"""


def main() -> "NoReturn":
    """Run the command line in a process of its own, watched by this one, and exit with its status."""
    heeded = tuple(number for number in STOPPING if signal.getsignal(number) is not signal.SIG_IGN)
    for number in heeded:
        signal.signal(
            number, lambda caught, _frame: os._exit(128 + caught)
        )  # there is nothing to tidy up yet
    try:
        from ptmcad.process.supervisor import supervise
    except (MemoryError, OSError, ImportError, SystemError, SyntaxError) as error:
        _refuse(
            error
        )  # the caller's limits, which Python's parser may take for a mistake, or a broken installation
    supervise(_command_line, heeded)


def _refuse(error: Exception) -> "NoReturn":
    """Say that not even what watches can be loaded, with as little as there is, and exit."""
    try:
        _ROOM.clear()
        error.__traceback__ = None  # it holds what the import had made so far
        why = f"{type(error).__name__} {error}".strip()
        os.write(
            2, f"error: ptmcad cannot start: {why}{_low_memory_limits()}\n".encode(errors="replace")
        )
    finally:
        os._exit(2)


def _low_memory_limits() -> str:
    """Name the caller's low limits on memory: what Python raises under them need not be a
    MemoryError.

    They are read from a file, because there may be no room to import a module.
    """
    try:
        file = os.open("/proc/self/limits", os.O_RDONLY)  # and never closed: the process ends
        lines = os.read(file, 4096).decode("ascii").splitlines()
    except OSError:  # no such file on this system
        return ""
    named = ""
    for line in lines:
        for option, name in (("-d", "Max data size"), ("-v", "Max address space")):
            soft = line[len(name) :].split()[0] if line.startswith(name) else "unlimited"
            if soft != "unlimited" and int(soft) < 1 << 30:  # `ptmcad.process.memory.LOW_LIMIT`
                named += f", with the memory limit of {int(soft) >> 10}K that the caller has set (ulimit {option})"
    return named


def _command_line() -> int:
    # pictures go to files, by the program's own settings: the caller's backend or settings may not
    # work here
    os.environ["MPLBACKEND"], os.environ["MATPLOTLIBRC"] = "agg", os.devnull
    # The collector would visit what is imported, which lives to the end, again and again: a tenth
    # of a short run. Only garbage in cycles waits for it, of which there is little.
    gc.set_threshold(_YOUNG_OBJECTS)
    from ptmcad.cli import run

    return run()


if __name__ == "__main__":
    main()
