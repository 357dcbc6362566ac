"""A pipe by which a process learns that another one has ended, in whatever code it is.

Guarantee: where pipes send signals (Linux), the kernel ends this process when the other end is closed.
"""

import os
import signal
import sys

if sys.platform != "win32":
    import fcntl


def die_with(parent: int, lifeline: int) -> None:
    """Let the kernel end this process when the parent's end of the pipe is closed.

    Parameters
    ----------
    parent : the number of the process that holds the other end.
    lifeline : the descriptor of this end, which is for reading and of which no other process has a copy.
    """
    if hasattr(os, "O_ASYNC"):
        signal.signal(signal.SIGIO, signal.SIG_DFL)  # the caller may have had it ignored
        fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(lifeline, fcntl.F_SETFL, os.O_ASYNC)  # sends SIGIO, whose default is to end the process
    if os.getppid() != parent:
        os._exit(1)
