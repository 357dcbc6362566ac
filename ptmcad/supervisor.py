"""A computation in a process of its own, and the process that watches it.

C code that runs for minutes never returns to the interpreter, and may abort: neither a signal handler nor an exception
can stop or save anything there. So the computation runs in a forked child, and the parent, which only waits, acts.

Guarantee: a signal, or the time limit, ends the child within a second whatever it does: it is asked to leave first and
killed after `GRACE`. No temporary file that it has told of stays. When a limit ends it (time; memory, also where a
library aborts on a failed allocation or the system kills the child), the last result that it handed over is saved and
the status is 3. When a signal ends it, such a result is saved if one can go on from it,
and where there is none yet the message says why. A parent that is killed takes
the child with it.

Not guaranteed: the last sentence on a system whose pipes send no signal (it is tested on Linux).
"""

import atexit
import gc
import math
import os
import select
import signal
import sys
import time
from collections.abc import Callable, Sequence
from types import FrameType
from typing import NoReturn

from ptmcad.handover import Receiver, Topic, connect, disconnect, tell
from ptmcad.streams import quiet_stream

if sys.platform != "win32":
    import fcntl

GRACE = 0.3
"""Seconds from the request to leave to the kill."""

LATE = 0.25
"""Seconds by which the child may overrun its time limit: it looks at the clock itself, and does so first."""

OUT_OF_MEMORY = ("llocate ", "llocation still failed", "bad_alloc", "overflow in mpz")
"""What FLINT, GMP, OpenBLAS and C++ print at their end when they could not allocate, and GMP at its size limit."""

_CHUNK = 1 << 16
_CLEAR_LINE = b"\r\x1b[K"


def supervise(work: Callable[[], int], heeded: Sequence[int]) -> NoReturn:
    """Run a function in a child process and exit with its status.

    Parameters
    ----------
    work : what to compute; it returns an exit status.
    heeded : the signals that stop it.
    """
    _open_standard_streams()
    messages, printed, lifeline, wake = os.pipe(), os.pipe(), os.pipe(), os.pipe()
    gc.freeze()  # what there is by now is not looked through again, which would copy its pages in the child
    parent = os.getpid()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (*heeded, signal.SIGCHLD))
    try:
        child = os.fork()
    except OSError:  # no more processes allowed: better unwatched than not at all
        child = -1
    if child > 0:
        os.close(messages[1])
        os.close(printed[1])
        os.close(lifeline[0])
        os._exit(_Watch(child, messages[0], printed[0], heeded).run(wake, before))
    for number in heeded:
        signal.signal(number, _leave)
    if child == 0:
        for descriptor in (messages[0], printed[0], lifeline[1], *wake):
            os.close(descriptor)
        _die_with_the_parent(lifeline[0], parent)
        connect(messages[1])
        _redirect(printed[1])
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    status = work()
    # Taking the interpreter down object by object costs more time than watching does; multiprocessing ends so, too.
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    tell(Topic.DONE)
    os._exit(status)


class _Watch:
    """The parent's side: what the child has told, what has been asked of it, and what to do at its end."""

    def __init__(self, child: int, messages: int, printed: int, heeded: Sequence[int]) -> None:
        self.child = child
        self.messages = messages
        self.printed = printed
        self.heeded = heeded
        self.receiver = Receiver()
        self.caught: list[int] = []
        self.text = bytearray()
        self.told: dict[Topic, list[str]] = {}
        self.temporaries: list[str] = []
        self.out_of_time = False

    def run(self, wake: tuple[int, int], before: set[int | signal.Signals]) -> int:
        """Watch until the child has ended, tidy up, and return the exit status."""
        for descriptor in (self.messages, self.printed, *wake):
            os.set_blocking(descriptor, False)
        signal.set_wakeup_fd(wake[1], warn_on_full_buffer=False)
        for number in self.heeded:
            signal.signal(number, lambda caught, _frame: self.caught.append(caught))
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)  # it has to be caught to wake the parent
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        ended = self._wait(wake[0])
        self._read(self.messages)
        self._read(self.printed)
        return self._end(ended)

    def _wait(self, wake: int) -> int:
        """The child's exit code, or minus the signal that ended it."""
        open_ends = {self.messages, self.printed, wake}
        kill_at: float | None = None
        while True:
            due = kill_at if kill_at is not None else self._deadline()
            timeout = None if due is None else max(0.0, due - time.monotonic())
            for end in select.select(list(open_ends), [], [], timeout)[0]:
                if not self._read(end):
                    open_ends.discard(end)
            child, status = os.waitpid(self.child, os.WNOHANG)
            if child:
                return os.waitstatus_to_exitcode(status)
            now = time.monotonic()
            if kill_at is not None:
                if now >= kill_at:
                    os.kill(self.child, signal.SIGKILL)
                    kill_at = now + 60
                continue
            due = self._deadline()
            self.out_of_time = not self.caught and due is not None and now >= due
            if self.caught or self.out_of_time:
                os.kill(self.child, signal.SIGTERM if signal.SIGTERM in self.heeded else signal.SIGKILL)
                kill_at = now + GRACE

    def _deadline(self) -> float | None:
        told = float(self.told[Topic.DEADLINE][0]) if Topic.DEADLINE in self.told else math.inf
        return None if told == math.inf else told + LATE  # infinite while the clock stands still

    def _read(self, end: int) -> bool:
        """Take what there is; False at the end of the pipe."""
        while True:
            try:
                data = os.read(end, _CHUNK)
            except BlockingIOError:
                return True
            if not data:
                return False
            if end == self.messages:
                for topic, texts in self.receiver.feed(data):
                    self.told[topic] = texts
                    if topic is Topic.TEMPORARY:
                        self.temporaries += texts
            elif end == self.printed:
                self.text += data

    def _end(self, ended: int) -> int:
        """Leave nothing behind, say what there is to say, and return the exit status."""
        # a library may call exit() when memory runs out: then the child has not said that it was done
        deserted = ended >= 0 and Topic.DONE not in self.told and ended <= 128
        if ended < 0 or deserted or self.caught or self.out_of_time:
            self._tidy()
        if self.caught:
            if Topic.RESUMABLE in self.told:
                self._stopped(f"by {signal.Signals(self.caught[0]).name}")
            return 128 + self.caught[0]
        text = self.text.decode(errors="replace")
        aborted = (ended == -signal.SIGABRT or deserted) and any(sign in text for sign in OUT_OF_MEMORY)
        if self.out_of_time and (ended < 0 or ended > 128):
            return self._stopped(f"the time limit of {self.told[Topic.DEADLINE][1]} was reached")
        if aborted or Topic.EXHAUSTED in self.told:
            return self._stopped(f"the memory limit of {self.told.get(Topic.MEMORY, ['the system'])[0]} was reached")
        if ended == -signal.SIGKILL:
            return self._stopped("the computation was killed from outside, most likely because memory ran out")
        _say(text)
        if deserted:
            _say(f"error: the computation ended by itself with status {ended}; this is a bug, please report it\n")
            return ended or 1
        if ended >= 0:
            return ended
        if -ended not in self.heeded:
            _say(f"error: the computation crashed ({signal.Signals(-ended).name}); this is a bug, please report it\n")
        return 128 - ended

    def _tidy(self) -> None:
        """What the child would have done: complete the renames it had begun, or remove its files; clear its line."""
        renames = self.told.get(Topic.RENAMES, [])
        for temporary, target in zip(renames[::2], renames[1::2], strict=True):
            if os.path.exists(temporary):
                os.replace(temporary, target)
        for temporary in self.temporaries:
            if os.path.lexists(temporary):
                os.unlink(temporary)
        if Topic.PROGRESS in self.told:
            _say(_CLEAR_LINE.decode())

    def _stopped(self, why: str) -> int:
        """Save the result that was handed over last, unless the child had come to that itself."""
        if Topic.TARGET not in self.told:
            _say(f"stopped: {why}\n")
            return 3
        if Topic.RESULT not in self.told:
            reason = f": {self.told[Topic.RESUMABLE][0]}" if Topic.RESUMABLE in self.told else ""
            _say(f"stopped: {why}; there was no partial result to save yet{reason}\n")
            return 3
        from pathlib import Path  # not before it is needed: every start would pay for it

        from ptmcad.errors import OutputError
        from ptmcad.output import how_to_go_on, save_stopped, where_saved

        target = Path(self.told[Topic.TARGET][0])
        state, text, remark = self.told[Topic.RESULT]
        try:
            place = Path(self.told[Topic.RENAMES][1]) if Topic.RENAMES in self.told else save_stopped(target, text)
        except OutputError as error:
            _say(f"error: {why}, and the {state} result was lost: {error}\n")
            return 2
        further = how_to_go_on(place) if Topic.RESUMABLE in self.told and state == "partial" else ""
        _say(f"stopped: {why}; the {state} result{remark} is in {place}{where_saved(target, place)}{further}\n")
        return 3


def _leave(number: int, _frame: FrameType | None) -> NoReturn:
    """Leave through every ``finally``, once, and without a word: the interrupted code may be in any state."""
    for other in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(other, signal.SIG_IGN)
    disconnect()  # a message may have been cut
    if sys.stderr is not None:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, sys.stderr.fileno())
        os.close(null)
    raise SystemExit(128 + number)


def _open_standard_streams() -> None:
    """Occupy descriptors 0 to 2 where the caller has closed them, so that no pipe is taken for a standard stream."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) < 3:
        pass
    os.close(descriptor)


def _die_with_the_parent(lifeline: int, parent: int) -> None:
    """Let the kernel end this process when the parent's end of the pipe is closed, whatever code it is in."""
    if hasattr(os, "O_ASYNC"):
        fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
        fcntl.fcntl(lifeline, fcntl.F_SETFL, os.O_ASYNC)  # sends SIGIO, whose default is to end the process
    if os.getppid() != parent:
        os._exit(1)


def _redirect(printed: int) -> None:
    """Give the parent what libraries print themselves, which knows what to make of it; keep Python's own streams.

    FLINT prints its last words on standard output, GMP on standard error.
    """
    if sys.stdout is not None:
        sys.stdout = quiet_stream(fcntl.fcntl(1, fcntl.F_DUPFD_CLOEXEC, 3), sys.stdout)
        sys.__stdout__ = sys.stdout  # type: ignore[misc, assignment]  # of which one asks for the terminal's size
    if sys.stderr is not None:
        sys.stderr = quiet_stream(fcntl.fcntl(2, fcntl.F_DUPFD_CLOEXEC, 3), sys.stderr)
    os.set_blocking(printed, False)  # a flood of messages must not stop the computation
    os.dup2(printed, 1)
    os.dup2(printed, 2)
    os.close(printed)


def _say(text: str) -> None:
    try:
        rest = memoryview(text.encode(errors="replace"))
        while rest:
            rest = rest[os.write(2, rest) :]
    except OSError:  # nobody reads standard error, or it is full: there is no third place to tell it
        return
