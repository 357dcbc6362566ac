"""A function that may take for ever, in a process of its own that is ended after some seconds.

C code that does not return to the interpreter cannot be stopped in any other way.

Guarantee: the other process ends in time, or with this one.
"""

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable

from ptmcad.process.lifeline import end_with

_PROGRAM = (
    "import sys; sys.path[:] = sys.argv[3:]; from ptmcad.process.timed import answer; "
    "answer(int(sys.argv[1]), int(sys.argv[2]))"
)


def returns_within(seconds: float, work: Callable[..., object], *arguments: object) -> bool:
    """Whether a function returns in time; False also where its process cannot be started or comes to grief.

    Parameters
    ----------
    work : a function of some module, found by its name; what it returns is not looked at.
    arguments : for it, which can be pickled.

    Raises
    ------
    Exception
        What the function raises.
    """
    lifeline, ours = os.pipe()
    command = [sys.executable, "-P", "-c", _PROGRAM, str(lifeline), str(os.getpid()), *sys.path]
    try:
        done = subprocess.run(
            command,
            input=pickle.dumps((work, arguments)),
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            pass_fds=(lifeline,),
            timeout=seconds,
            check=False,
        )
    except (subprocess.TimeoutExpired, OSError):
        return False
    finally:
        os.close(lifeline)
        os.close(ours)
    if done.returncode < 0 or not done.stdout:  # what a library prints before it aborts is no answer
        return False
    error = pickle.loads(done.stdout)
    if error is not None:
        raise error
    return True


def answer(lifeline: int, parent: int) -> None:
    """Call the function that standard input names, and write what it raises to standard output; None for nothing."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the other process's, which ends this one
    end_with(lifeline, parent)
    work, arguments = pickle.load(sys.stdin.buffer)
    try:
        work(*arguments)
    except BaseException as error:
        sys.stdout.buffer.write(pickle.dumps(error))
        raise
    sys.stdout.buffer.write(pickle.dumps(None))
