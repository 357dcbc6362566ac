"""A process that ends with another one, whatever code it is in.

Guarantee: on a system whose pipes send signals (Linux) the kernel ends this process as soon as the last end at which
the other one holds the pipe is closed. Elsewhere nothing is promised.
"""

import fcntl
import os
import signal


def end_with(lifeline: int, parent: int) -> None:
    """Let the kernel end this process when the parent's end of the pipe is closed.

    Parameters
    ----------
    lifeline : the end at which the pipe is read; nobody writes to it.
    parent : the parent's number: it may have ended before.
    """
    signal.signal(signal.SIGIO, signal.SIG_DFL)  # the caller may have had it ignored
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(lifeline, fcntl.F_SETFL, os.O_ASYNC)  # sends SIGIO, whose default is to end the process
    if os.getppid() != parent:
        os._exit(1)
