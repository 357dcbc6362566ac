"""A computation in a process of its own, and the process that watches it.

C code that runs for minutes never returns to the interpreter, and may abort: neither a signal handler nor an exception
can stop or save anything there. So the computation runs in a forked child, and the parent, which only waits, acts.

Guarantee: a signal to either process, or the time limit, ends the child within a second whatever it does: it is asked
to leave first and killed after `ptmcad.process.watch.GRACE_SECONDS`. After a signal, one that searches a certified map
has up to `ptmcad.process.handover.LAST_SECONDS` to hand over what it knows; a second signal ends that. What the caller
has made of signals, masks and standard streams is no obstacle. No temporary file that the child has reported stays.
When a limit ends it (time; the caller's on processor time; memory, also where a library aborts on a failed allocation
or the system kills the child), the last result that it handed over is saved and the status is 3. When a signal or a
crash ends it, such a result is saved if one can go on from it, and where there is none yet the message says why; where
there is nothing to go on from it says which files had been written before, or that nothing was saved. A parent that is
killed takes the child with it.

Not guaranteed: the last sentence on a system whose pipes send no signal (it is tested on Linux).
"""

import atexit
import fcntl
import gc
import os
import resource
import signal
import sys
from collections.abc import Callable, Sequence
from threading import Timer
from types import FrameType
from typing import Any, NoReturn

from ptmcad.process.handover import Own, Topic, send
from ptmcad.process.lifeline import end_with
from ptmcad.process.streams import quiet_stream, report
from ptmcad.process.watch import Watch

DESCRIPTORS = 24
"""That there must be: for pipes, for imports, for the files of a result."""

AGAIN_SECONDS = 0.001
"""Seconds until a signal comes again that came where nothing may be raised."""


def supervise(work: Callable[[], int], heeded: Sequence[int]) -> NoReturn:
    """Run a function in a child process and exit with its status.

    Parameters
    ----------
    work : what to compute; it returns an exit status.
    heeded : the signals that stop it.
    """
    if resource.getrlimit(resource.RLIMIT_NOFILE)[0] < DESCRIPTORS:
        report(f"error: Too many open files: ptmcad needs {DESCRIPTORS} (ulimit -n)\n")
        os._exit(2)
    while (descriptor := os.open(os.devnull, os.O_RDWR)) < 3:  # the caller has closed a standard stream
        pass
    os.close(descriptor)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # where it is ignored, nobody learns how a child has ended
    gc.freeze()  # what there is by now is not looked through again, which would copy its pages in the child
    parent = os.getpid()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (*heeded, signal.SIGCHLD))
    before -= {*heeded, signal.SIGCHLD, signal.SIGIO}  # of a caller that has blocked them, too: this waits for them
    try:
        messages, printed, lifeline, wake = os.pipe(), os.pipe(), os.pipe(), os.pipe()
        child = os.fork()
    except OSError as error:  # no more files or processes allowed
        report(f"error: ptmcad cannot start: {error.strerror}\n")
        os._exit(2)
    os.set_blocking(wake[1], False)
    if child:
        for descriptor in (messages[1], printed[1], lifeline[0]):
            os.close(descriptor)
        os._exit(Watch(child, messages[0], printed[0], heeded).run(wake, before))
    for number in heeded:
        signal.signal(number, _terminate)
    for descriptor in (messages[0], printed[0], lifeline[1], wake[0]):
        os.close(descriptor)
    # a signal to this process alone is the parent's to answer, too, which hears of it whatever code runs here
    signal.set_wakeup_fd(wake[1], warn_on_full_buffer=False)
    end_with(lifeline[0], parent)
    Own.pipe = messages[1]
    _redirect(printed[1])
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    asked = False
    try:
        status = work()
    except SystemExit as leaving:  # by `_terminate`
        asked, status = True, int(leaving.code or 0)
    # Taking the interpreter down object by object costs more time than watching does; multiprocessing ends so, too.
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    if not asked:
        send(Topic.DONE)
    os._exit(status)


def _terminate(number: int, frame: FrameType | None) -> None:
    """Leave through every ``finally``, once, and without a word: the interrupted code may be in any state.

    Numba's compiled code calls Python to unpickle its types, does not look whether that has failed, and crashes if it
    has. So a signal that comes meanwhile comes again a little later.
    """
    caller = frame
    while caller is not None:
        if caller.f_code.co_name == "_numba_unpickle":
            Timer(AGAIN_SECONDS, os.kill, [os.getpid(), number]).start()
            return
        caller = caller.f_back
    for other in signal.valid_signals():
        if signal.getsignal(other) is _terminate:
            signal.signal(other, signal.SIG_IGN)
    null = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stderr, sys.__stderr__):  # libraries that are being loaded have one of their own
        if stream is not None:
            os.dup2(null, stream.fileno())
    Own.status = 128 + number
    raise SystemExit(Own.status)


def _redirect(printed: int) -> None:
    """Give the parent what libraries print themselves, which knows what to make of it; keep Python's own streams.

    FLINT prints its last words on standard output, GMP on standard error. Errors that nobody handles Python prints to
    the parent too, which knows whether they are a limit's.
    """
    os.set_blocking(printed, False)  # a flood of messages must not stop the computation
    if sys.stdout is not None:
        sys.stdout = quiet_stream(fcntl.fcntl(1, fcntl.F_DUPFD_CLOEXEC, 3), sys.stdout)
        sys.__stdout__ = sys.stdout  # type: ignore[misc, assignment]  # of which one asks for the terminal's size
    if sys.stderr is not None:
        unexpected = quiet_stream(fcntl.fcntl(printed, fcntl.F_DUPFD_CLOEXEC, 3), sys.stderr, for_messages=True)
        sys.stderr = quiet_stream(fcntl.fcntl(2, fcntl.F_DUPFD_CLOEXEC, 3), sys.stderr, for_messages=True)
        sys.__stderr__ = sys.stderr  # type: ignore[misc, assignment]

        def to_the_parent(hook: Callable[..., None]) -> Callable[..., None]:
            def print_there(*what: Any) -> None:  # of which nothing may take memory
                sys.stderr, usual = unexpected, sys.stderr
                hook(*what)
                unexpected.flush()
                sys.stderr = usual

            return print_there

        sys.excepthook = to_the_parent(sys.__excepthook__)
        sys.unraisablehook = to_the_parent(sys.__unraisablehook__)
    os.dup2(printed, 1)
    os.dup2(printed, 2)
    os.close(printed)
