"""A worker process, which `ptmcad.workbench.sweeps.pool` starts.

Guarantee: it computes the members that it is told, one after another, and ends with the process
that has started it. An error that is no answer about a member is told as that member's failure, and
ends the process: nothing of its state is trusted afterwards.
"""

from __future__ import annotations

import os
import signal
from multiprocessing.connection import Connection

from ptmcad.process.handover import end_with


def serve(connection: Connection) -> None:
    """Compute members until there are no more."""
    from ptmcad.errors import shown
    from ptmcad.workbench.sweeps.member import Failed

    work = connection.recv()
    while True:
        number = connection.recv()
        try:
            outcome = work.answer(number)
        except BaseException as error:  # raised again, and ends this process: the sweep hears why
            connection.send((number, Failed(shown(f"{type(error).__name__}: {error}")), True))
            raise
        connection.send((number, outcome, False))


def main(arguments: list[str]) -> None:
    """Be a worker; Ctrl-C is the other process's, which ends this one.

    Parameters
    ----------
    arguments : the descriptors of the connection and of the lifeline, and the other process's
        number.
    """
    connection, lifeline, parent = map(int, arguments)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with(lifeline, parent)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        serve(Connection(connection))
    except EOFError:  # there are no more members
        return
