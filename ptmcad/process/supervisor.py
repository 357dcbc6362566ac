"""A computation in a process of its own, and the process that watches it.

C code that runs for minutes never returns to the interpreter, and may abort: neither a signal
handler nor an exception can stop or save anything there. So the computation runs in a forked child,
and the parent, which only waits, acts.

Guarantee: a signal to either process, or the time limit, ends the child within a second whatever it
does: it is asked to leave first and killed after `GRACE_SECONDS`. After a signal, one that searches
a certified map has up to `LAST_SECONDS` to hand over what it knows; a second signal ends that. What
the caller has made of signals, masks and standard streams is no obstacle. No temporary folder that
the child has reported stays. When a limit ends it (time; the caller's on processor time; memory,
also where a library aborts on a failed allocation or the system kills the child), the last result
that it handed over is saved and the status is 3. When a signal or a crash ends it, such a result is
saved if it is complete or one can go on from it; else the message says why there is none yet, which
files had been written before, or that nothing was saved. A parent that is killed takes the child
with it.

Not guaranteed: the last sentence on a system whose pipes send no signal (it is tested on Linux).

Nothing is imported at the start that takes time: every command would pay.
"""

import atexit
import fcntl
import gc
import math
import os
import resource
import select
import signal
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from threading import Timer
from types import FrameType
from typing import NoReturn

from ptmcad.process.handover import LAST_SECONDS, Own, Topic, end_with, received, remove, send
from ptmcad.process.streams import quiet_stream, report

DESCRIPTORS = 24
"""That there must be: for pipes, for imports, for the files of a result."""

GRACE_SECONDS = 0.3
"""Seconds from the request to leave to the kill."""

OVERRUN_SECONDS = 0.25
"""Seconds by which the child may overrun its time limit: it looks at the clock itself, and does so
first.
"""

_CRASHES = ("SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL", "SIGABRT", "SIGSYS", "SIGTRAP")
_HOW_ENDED: dict[int, str] = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated (SIGTERM)",
    signal.SIGHUP: "the terminal was closed (SIGHUP)",
}
_CLEAR_LINE = "\r\x1b[K"


def supervise(work: Callable[[], int], heeded: Sequence[int]) -> NoReturn:
    """Run a function in a child process and exit with its status.

    Parameters
    ----------
    work : what to compute; it returns an exit status.
    heeded : the signals that stop it.
    """
    signal.signal(
        signal.SIGCHLD, signal.SIG_DFL
    )  # where it is ignored, nobody learns how a child has ended
    gc.freeze()  # what there is by now is not looked through again, which would copy its pages in the child
    parent = os.getpid()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (*heeded, signal.SIGCHLD))
    before -= {
        *heeded,
        signal.SIGCHLD,
        signal.SIGIO,
    }  # of a caller that has blocked them, too: this waits for them
    try:
        for descriptor in [os.open(os.devnull, os.O_RDWR) for _ in range(DESCRIPTORS)]:
            if descriptor > 2:  # otherwise the caller has closed a standard stream
                os.close(descriptor)
        messages, printed, lifeline, wake = os.pipe(), os.pipe(), os.pipe(), os.pipe()
        child = os.fork()
    except OSError as error:  # no more files (ulimit -n) or processes allowed
        report(f"error: ptmcad cannot start: {error.strerror}\n")
        os._exit(2)
    os.set_blocking(wake[1], False)
    if child:
        os._exit(_Watch(child, messages[0], printed[0], heeded).run(wake, before))
    for number in heeded:
        signal.signal(number, _terminate)
    for descriptor in (messages[0], printed[0], lifeline[1], wake[0]):
        os.close(descriptor)
    # a signal to this process alone is the parent's to answer, too, which hears of it whatever code
    # runs here
    signal.set_wakeup_fd(wake[1], warn_on_full_buffer=False)
    end_with(lifeline[0], parent)
    Own.pipe = messages[1]
    _redirect(printed[1])
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    done = False
    try:
        status, done = work(), True
    except SystemExit as leaving:  # by `_terminate`
        status = int(leaving.code or 0)
    except MemoryError:
        status = 1
        os.write(2, b"MemoryError\n")  # the parent reads it, and says which limit that was
    except BaseException:  # raised again: the interpreter prints it where it says so
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115 - the parent shows it, unless it comes of a limit
        raise
    _leave(status, done)


def _leave(status: int, done: bool) -> NoReturn:
    """End the child, and say whether it was done.

    Taking the interpreter down object by object costs more time than watching does; multiprocessing
    ends so, too.
    """
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    if done:
        send(Topic.DONE)
    os._exit(status)


def _terminate(number: int, frame: FrameType | None) -> None:
    """Leave through every ``finally``, once, and without a word: the interrupted code may be in any
    state.

    Numba's compiled code calls Python to unpickle its types, does not look whether that has failed,
    and crashes if it has. So a signal that comes meanwhile comes again a millisecond later.
    """
    caller = frame
    while caller is not None:
        if caller.f_code.co_name == "_numba_unpickle":
            Timer(0.001, os.kill, [os.getpid(), number]).start()
            return
        caller = caller.f_back
    for other in signal.valid_signals():
        if signal.getsignal(other) is _terminate:
            signal.signal(other, signal.SIG_IGN)
    if sys.__stderr__ is not None:  # of other streams the parent shows nothing after a signal
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.__stderr__.fileno())
    Own.status = 128 + number
    raise SystemExit(Own.status)


def _redirect(printed: int) -> None:
    """Give the parent what libraries print themselves, which knows what to make of it; keep
    Python's own streams.

    FLINT prints its last words on standard output, GMP on standard error.
    """
    os.set_blocking(printed, False)  # a flood of messages must not stop the computation
    for number, name in enumerate(("stdout", "stderr"), 1):
        like = getattr(sys, name)
        if like is not None:
            kept = quiet_stream(
                fcntl.fcntl(number, fcntl.F_DUPFD_CLOEXEC, 3), like, for_messages=number == 2
            )
            setattr(sys, name, kept)
            setattr(sys, f"__{name}__", kept)  # of which one asks for the terminal's size
        os.dup2(printed, number)
    os.close(printed)
    sys.unraisablehook = lambda what: report(
        f"{what.exc_type.__name__}: {what.exc_value} in {what.object!r}\n"
    )


class _Watch:
    """The parent's side: what the child has reported, what has been asked of it, and what to do at
    its end.
    """

    def __init__(self, child: int, messages: int, printed: int, heeded: Sequence[int]) -> None:
        self.child, self.messages, self.printed, self.heeded = child, messages, printed, heeded
        self.asked = math.inf
        """When the child was asked to leave."""
        self.caught: list[int] = []
        """The signal that ends the work, and those that came after it and are not taken for the
        same one.
        """
        self.received, self.text = bytearray(), bytearray()
        self.reports: dict[Topic, list[str]] = {}
        """What the child has said last on each topic."""
        self.saved: list[str] = []
        self.used: resource.struct_rusage
        """By the child, once it has ended."""

    def run(self, wake: tuple[int, int], before: set[int | signal.Signals]) -> int:
        """_Watch until the child has ended, tidy up, and return the exit status."""
        ends = [self.messages, self.printed, wake[0]]
        for descriptor in ends:
            os.set_blocking(descriptor, False)
        signal.set_wakeup_fd(wake[1], warn_on_full_buffer=False)
        for number in self.heeded:
            signal.signal(number, lambda caught, _frame: self.caught.append(caught))
        signal.signal(
            signal.SIGCHLD, lambda _number, _frame: None
        )  # it has to be caught to wake the parent
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            return self._end(self._wait(ends))
        except MemoryError:  # of this process, which needs little: it is the caller's limit
            os.kill(
                self.child, signal.SIGKILL
            )  # it may be there, or wait to be asked for its end: not for another yet
            report(
                "stopped: memory ran out, also for the process that watches; no result could be saved\n"
            )
            return 3

    def _wait(self, ends: list[int]) -> int:
        """The child's exit code, or minus the signal that ended it."""
        kill_at = math.inf
        while True:
            self._read(ends)  # before the child is asked for: an end after that wakes `select`
            child, status, self.used = os.wait4(self.child, os.WNOHANG)
            if child:
                self._read(ends)  # now all that it has said is there
                return os.waitstatus_to_exitcode(status)
            now = time.monotonic()
            if now < self.asked + GRACE_SECONDS:
                del self.caught[
                    1:
                ]  # Ctrl-C that comes twice, by a terminal or by somebody's finger
            if self.asked == math.inf and (self.caught or now >= self._deadline()):
                os.kill(
                    self.child, signal.SIGTERM if signal.SIGTERM in self.heeded else signal.SIGKILL
                )
                state = self.reports.get(Topic.RESULT, ["partial"])[0]
                last_map = (
                    self.caught
                    and state == "partial"
                    and len(self.reports.get(Topic.RESUMABLE, ())) > 1
                )
                self.asked, kill_at = now, now + (LAST_SECONDS if last_map else GRACE_SECONDS)
                if last_map and os.isatty(2):
                    report(
                        f"{_CLEAR_LINE}making the map of what is known by now; a second Ctrl-C saves an earlier one"
                    )
            elif now >= kill_at or len(self.caught) > 1:
                os.kill(self.child, signal.SIGKILL)
                kill_at = math.inf
            due = min(self._deadline() if self.asked == math.inf else kill_at, now + 60)
            select.select(ends, [], [], max(0.0, due - now))

    def _deadline(self) -> float:
        return (
            float(self.reports.get(Topic.DEADLINE, ["inf"])[0]) + OVERRUN_SECONDS
        )  # infinite while the clock stands

    def _read(self, ends: list[int]) -> None:
        """Take what there is; a pipe has no end, since this process could write to it, too."""
        for end in ends:
            with suppress(BlockingIOError):
                while data := os.read(end, 1 << 16):
                    if end == self.messages:
                        self.received += data
                        for topic, texts in received(self.received):
                            self.reports[topic] = texts
                            self.saved += texts if topic is Topic.SAVED else ()
                    elif end == self.printed:
                        self.text += data
                    elif (
                        self.asked == math.inf
                    ):  # afterwards it is the child's echo of what asked it
                        self.caught += [number for number in data if number in self.heeded]

    def _end(self, ended: int) -> int:
        """Leave nothing behind, say what there is to say, and return the exit status."""
        done = Topic.DONE in self.reports
        if not done:  # do what the child would have done: clear its line, remove its files
            if os.isatty(2):
                report(_CLEAR_LINE)
            for path in filter(os.path.lexists, self.reports.get(Topic.TEMPORARY, ())):
                with suppress(
                    OSError
                ):  # what cannot be removed is hidden, and removed by a later run
                    remove(path)
        if self.caught:
            number = self.caught[0]
            if self.reports.get(Topic.RESUMABLE) == [""]:  # it is the usual end
                return 128 + number
            return self._report(_HOW_ENDED.get(number, f"stopped by {_name(number)}"), 128 + number)
        # a library may call exit() when memory runs out: then the child has not said that it was
        # done
        deserted = 0 <= ended <= 128 and not done
        text = self.text.decode(errors="replace")
        if why := self._why_stopped(ended, deserted, text):
            return self._report(f"stopped: {why}", 3)
        report(text)
        if ended >= 0 and not deserted:
            return ended
        how = f"ended by itself with status {ended}" if deserted else f"crashed ({_name(-ended)})"
        status = 128 - ended if ended < 0 else ended or 1
        return self._report(
            f"error: the computation {how}; this is a bug, please report it", status
        )

    def _why_stopped(self, ended: int, deserted: bool, text: str) -> str:
        """What ended the child before it was done, in words; empty when nothing did."""
        if self.asked < math.inf and (ended < 0 or ended > 128):
            return f"the time limit of {self.reports[Topic.DEADLINE][1]} was reached"
        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        spent = 0 < hard <= self.used.ru_utime + self.used.ru_stime + 0.5
        if ended == -signal.SIGXCPU or (ended == -signal.SIGKILL and spent):
            return "the limit on processor time that the caller has set (ulimit -t) was reached"
        if ended == -signal.SIGKILL:
            return "the computation was killed from outside, most likely because memory ran out"
        if ended >= 0 and not deserted:
            return ""
        if ended < 0 and _name(-ended) not in _CRASHES:
            return f"the computation was ended from outside ({_name(-ended)})"
        from ptmcad.process.memory import exhausted

        most = self.used.ru_maxrss << (0 if sys.platform == "darwin" else 10)
        return exhausted(
            text, most, self.reports.get(Topic.MEMORY, ()), "" if deserted else _name(-ended)
        )

    def _report(self, how: str, status: int) -> int:
        """Say how the work ended and what there is of it, and return the exit status.

        The result that was handed over last is saved, unless the child had come to that itself:
        after a limit always, otherwise where it is complete or can be gone on from.
        """
        resumable = ": ".join(self.reports.get(Topic.RESUMABLE, ()))
        state, text, remark, target, *beside = self.reports.get(Topic.RESULT, ("", "", "", ""))
        if not state or not (status == 3 or resumable or state == "complete"):
            report(f"{how}; {resumable or what_is_there(self.saved)}\n")
            return status
        from pathlib import Path

        from ptmcad.errors import OutputError
        from ptmcad.process.output import how_to_go_on, save_stopped

        try:
            if self.saved:
                place, where = Path(self.saved[-1]), ""
            else:
                place, where = save_stopped(
                    Path(target), text, whole=state == "complete", beside=beside
                )
        except OutputError as error:
            report(f"error: {how}, and the {state} map was lost: {error}\n")
            return 2 if status == 3 else status
        further = how_to_go_on(place) if resumable and state == "partial" else ""
        report(f"{how}; {state} map{remark} saved to {place}{where}{further}\n")
        return status


def what_is_there(saved: Sequence[str]) -> str:
    """In words, what a stopped command has saved: the last file of each set that was put into
    place.
    """
    if not saved:
        return "nothing was saved"
    if len(saved) == 1:
        return f"{saved[0]} had been written before and is whole"
    return (
        f"{len(saved)} results had been written before and are whole, the last of them {saved[-1]}"
    )


def _name(number: int) -> str:
    """A signal's name; most real-time signals have none."""
    names = {each.value: each.name for each in signal.Signals}
    return names.get(number, f"signal {number}")
