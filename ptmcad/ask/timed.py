"""A function that may take for ever, in a process of its own that is ended after some seconds.

C code that does not return to the interpreter cannot be stopped in any other way.

Guarantee: the other process ends in time, by the system's own clock, also where this one has been
killed before.
"""

import pickle
import subprocess
import sys
from collections.abc import Callable

_PROGRAM = """
import pickle, signal, sys
signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.signal(signal.SIGALRM, signal.SIG_DFL)
signal.setitimer(signal.ITIMER_REAL, float(sys.argv[1]))
sys.path[:] = sys.argv[2:]
error = None
work, arguments = pickle.load(sys.stdin.buffer)
try:
    work(*arguments)
except Exception as raised:  # the process that asked raises it again, of whatever kind it is
    error = raised
pickle.dump(error, sys.stdout.buffer)
"""
"""SIGALRM ends it, whatever code it is in; Ctrl-C is the other process's, which ends this one."""


def returns_within(seconds: float, work: Callable[..., object], *arguments: object) -> bool:
    """Whether a function returns in time; False also where its process cannot be started or comes
    to grief.

    Parameters
    ----------
    work : a function of some module, found by its name; what it returns is not looked at.
    arguments : for it, which can be pickled.

    Raises
    ------
    Exception
        What the function raises.
    """
    command = [sys.executable, "-P", "-c", _PROGRAM, str(seconds), *sys.path]
    try:
        done = subprocess.run(
            command, input=pickle.dumps((work, arguments)), capture_output=True, check=False
        )
    except OSError:
        return False
    if (
        done.returncode != 0 or not done.stdout
    ):  # what a library prints before it aborts is no answer
        return False
    error = pickle.loads(done.stdout)
    if error is not None:
        raise error
    return True
