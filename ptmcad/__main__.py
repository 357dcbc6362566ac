"""The program's entry: ``ptmcad`` and ``python -m ptmcad``.

Guarantee: from the first statement of `main` on, SIGINT, SIGTERM and SIGHUP end the program without a traceback; they
stay without effect where the caller has had them ignored (``nohup``, a shell's background jobs).

Nothing is imported here but what the signals need, because a signal that comes during an import must find its handler.
"""

import os
import signal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

STOPPING = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


def main() -> "NoReturn":
    """Run the command line in a process of its own, watched by this one, and exit with its status."""
    if not hasattr(os, "fork"):
        from ptmcad.cli import main as run_here

        run_here()
    heeded = tuple(number for number in STOPPING if signal.getsignal(number) is not signal.SIG_IGN)
    for number in heeded:
        signal.signal(number, lambda caught, _frame: os._exit(128 + caught))  # there is nothing to tidy up yet
    try:
        from ptmcad.process.supervisor import supervise
    except (MemoryError, OSError, ImportError, SystemError) as error:  # the caller's limits, or a broken installation
        _refuse(error)
    supervise(_command_line, heeded)


def _refuse(error: Exception) -> "NoReturn":
    """Say that not even what watches can be loaded, with as little as there is, and exit."""
    try:
        os.write(2, f"error: ptmcad cannot start: {type(error).__name__} {error}\n".encode(errors="replace"))
    finally:
        os._exit(2)


def _command_line() -> int:
    # pictures go to files, by the program's own settings: the caller's backend or settings may not work here
    os.environ["MPLBACKEND"], os.environ["MATPLOTLIBRC"] = "agg", os.devnull
    from ptmcad.cli import run

    return run()


if __name__ == "__main__":
    main()
