"""A computation in a process of its own, and the process that watches it.

C code that runs for minutes never returns to the interpreter, and may abort: neither a signal handler nor an exception
can stop or save anything there. So the computation runs in a forked child, and the parent, which only waits, acts.

Guarantee: a signal, or the time limit, ends the child within a second whatever it does: it is asked to leave first and
killed after `GRACE_SECONDS`. A library that waits for memory in vain (`ptmcad.process.shortage`) is ended in seconds.
What the caller has made of signals, masks and standard streams is no obstacle. No temporary file that the child has
reported stays. When a limit ends it (time; the caller's on processor time; memory, also where a library aborts on a
failed allocation or the system kills the child), the last result that it handed over is saved and the status is 3. When
a signal ends it, such a result is saved if one can go on from it, and where there is none yet the message says why. A
parent that is killed takes the child with it.

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
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, NoReturn, TextIO

from ptmcad.process.handover import Receiver, Topic, connect, disconnect, send
from ptmcad.process.streams import open_standard_streams, quiet_stream

if sys.platform != "win32":
    import fcntl
if TYPE_CHECKING:
    from ptmcad.process.shortage import Limit, Usage, Waiting

GRACE_SECONDS = 0.3
"""Seconds from the request to leave to the kill."""

OVERRUN_SECONDS = 0.25
"""Seconds by which the child may overrun its time limit: it looks at the clock itself, and does so first."""

POLL_SECONDS = 0.25
"""Seconds between two looks at the child's memory."""

SPARE_DESCRIPTORS = 16
"""Descriptors that there must be beside the open ones: for pipes, for imports, for the files of a result."""

_CHUNK = 1 << 16
_CLEAR_LINE = b"\r\x1b[K"


def supervise(work: Callable[[], int], heeded: Sequence[int]) -> NoReturn:
    """Run a function in a child process and exit with its status.

    Parameters
    ----------
    work : what to compute; it returns an exit status.
    heeded : the signals that stop it.
    """
    open_standard_streams()
    _check_descriptors()
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # where it is ignored, nobody learns how a child has ended
    messages, printed, lifeline, wake = os.pipe(), os.pipe(), os.pipe(), os.pipe()
    gc.freeze()  # what there is by now is not looked through again, which would copy its pages in the child
    parent = os.getpid()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (*heeded, signal.SIGCHLD))
    before -= {*heeded, signal.SIGCHLD, *_PIPE_SIGNAL}  # of a caller that has blocked them, too: this waits for them
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
        signal.signal(number, _terminate)
    if child == 0:
        for descriptor in (messages[0], printed[0], lifeline[1], *wake):
            os.close(descriptor)
        _die_with_the_parent(lifeline[0], parent)
        connect(messages[1])
        _redirect(printed[1])
    elif sys.stderr is not None:
        sys.stderr = quiet_stream(2, sys.stderr, for_messages=True)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    status = work()
    # Taking the interpreter down object by object costs more time than watching does; multiprocessing ends so, too.
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    send(Topic.DONE)
    os._exit(status)


class _Watch:
    """The parent's side: what the child has reported, what has been asked of it, and what to do at its end."""

    def __init__(self, child: int, messages: int, printed: int, heeded: Sequence[int]) -> None:
        self.child = child
        self.messages = messages
        self.printed = printed
        self.heeded = heeded
        self.receiver = Receiver()
        self.caught: list[int] = []
        self.text = bytearray()
        self.reports: dict[Topic, list[str]] = {}
        self.temporaries: list[str] = []
        self.out_of_time = False
        self.waiting: Waiting | None = None
        self.waits_for_memory = False
        self.processor_time = 0.0

    def run(self, wake: tuple[int, int], before: set[int | signal.Signals]) -> int:
        """Watch until the child has ended, tidy up, and return the exit status."""
        for descriptor in (self.messages, self.printed, *wake):
            os.set_blocking(descriptor, False)
        signal.set_wakeup_fd(wake[1], warn_on_full_buffer=False)
        for number in self.heeded:
            signal.signal(number, lambda caught, _frame: self.caught.append(caught))
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)  # it has to be caught to wake the parent
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            ended = self._wait(wake[0])
            self._read(self.messages)
            self._read(self.printed)
            return self._end(ended)
        except MemoryError:  # of this process, which needs little: it is the caller's limit
            os.kill(self.child, signal.SIGKILL)  # it may be there, or wait to be asked for its end: not for another yet
            _report("stopped: memory ran out, also for the process that watches; no result could be saved\n")
            return 3

    def _wait(self, wake: int) -> int:
        """The child's exit code, or minus the signal that ended it."""
        open_ends = {self.messages, self.printed, wake}
        kill_at: float | None = None
        look_at = time.monotonic() + POLL_SECONDS
        while True:
            due = kill_at if kill_at is not None else self._deadline()
            timeout = POLL_SECONDS if due is None else min(POLL_SECONDS, max(0.0, due - time.monotonic()))
            for end in select.select(list(open_ends), [], [], timeout)[0]:
                if not self._read(end):
                    open_ends.discard(end)
            child, status, used = os.wait4(self.child, os.WNOHANG)
            if child:
                self.processor_time = used.ru_utime + used.ru_stime
                return os.waitstatus_to_exitcode(status)
            now = time.monotonic()
            if kill_at is not None:
                if now >= kill_at:
                    os.kill(self.child, signal.SIGKILL)
                    kill_at = now + 60
                continue
            due = self._deadline()
            self.out_of_time = not self.caught and due is not None and now >= due
            if not self.caught and not self.out_of_time and now >= look_at:
                look_at = now + POLL_SECONDS
                if self._waits_for_memory(now):
                    self.waits_for_memory = True
                    os.kill(self.child, signal.SIGKILL)  # it would not listen
                    kill_at = now + 60
            if self.caught or self.out_of_time:
                os.kill(self.child, signal.SIGTERM if signal.SIGTERM in self.heeded else signal.SIGKILL)
                kill_at = now + GRACE_SECONDS

    def _waits_for_memory(self, now: float) -> bool:
        """Look at the child's memory."""
        if self.waiting is None:
            from ptmcad.process.shortage import Waiting  # not before it is needed: every start would pay for it

            self.waiting = Waiting()
        from ptmcad.process.shortage import usage_of

        loading = self._loading()
        return self.waiting.look(usage_of(self.child), self._limits(lifted=bool(loading)), bool(loading), now)

    def _loading(self) -> str:
        """The libraries that the child was loading when it was last heard of."""
        return self.reports.get(Topic.LOADING, ["the program"])[0]

    def _limits(self, lifted: bool = False) -> "tuple[Limit, ...]":
        """The limits on the child's memory, without the option's while that is lifted."""
        from ptmcad.process.shortage import Limit, caller_limits

        own = self.reports.get(Topic.MEMORY)
        return (*caller_limits(), *([] if own is None or lifted else [Limit(int(own[0]), False, own[1])]))

    def _deadline(self) -> float | None:
        limit = float(self.reports[Topic.DEADLINE][0]) if Topic.DEADLINE in self.reports else math.inf
        return None if limit == math.inf else limit + OVERRUN_SECONDS  # infinite while the clock stands still

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
                    self.reports[topic] = texts
                    if topic is Topic.TEMPORARY:
                        self.temporaries += texts
                    if topic is Topic.WAITING:
                        _report(f"waiting   another process is writing in {texts[0]}\n")
            elif end == self.printed:
                self.text += data

    def _end(self, ended: int) -> int:
        """Leave nothing behind, say what there is to say, and return the exit status."""
        # a library may call exit() when memory runs out: then the child has not said that it was done
        deserted = ended >= 0 and Topic.DONE not in self.reports and ended <= 128
        if ended < 0 or deserted or self.caught or self.out_of_time or Topic.EXHAUSTED in self.reports:
            self._clean_up()
        if self.caught:
            if Topic.RESUMABLE in self.reports or self.reports.get(Topic.RESULT, [""])[0] == "complete":
                self._stopped(f"by {signal.Signals(self.caught[0]).name}")
            return 128 + self.caught[0]
        text = self.text.decode(errors="replace")
        if self.out_of_time and (ended < 0 or ended > 128):
            return self._stopped(f"the time limit of {self.reports[Topic.DEADLINE][1]} was reached")
        if Topic.EXHAUSTED in self.reports or self.waits_for_memory:
            return self._stopped(f"the memory limit of {self._limit_reached()} was reached")
        if -ended in (signal.SIGXCPU, signal.SIGKILL) and self._processor_time_is_over():
            return self._stopped("the limit on processor time that the caller has set (ulimit -t) was reached")
        if ended == -signal.SIGKILL:
            return self._stopped("the computation was killed from outside, most likely because memory ran out")
        crashed = ended < 0 and -ended not in self.heeded
        if deserted or crashed:
            from ptmcad.process.shortage import speaks_of_memory

            if speaks_of_memory(text):
                return self._stopped(f"the memory limit of {self._limit_reached()} was reached")
            if self._little_memory():
                last = "".join(text.rstrip().rpartition("\n")[2:])[:200] or "without a word"
                how = signal.Signals(-ended).name if crashed else last
                return self._stopped(f"most likely the memory limit of {self._limit_reached()} was reached ({how})")
        _report(text)
        if deserted:
            _report(f"error: the computation ended by itself with status {ended}; this is a bug, please report it\n")
            return ended or 1
        if ended >= 0:
            return ended
        if -ended not in self.heeded:
            _report(
                f"error: the computation crashed ({signal.Signals(-ended).name}); this is a bug, please report it\n"
            )
        return 128 - ended

    def _limit_reached(self) -> str:
        """The limit that left the child the least room, in words."""
        limits, most = self._limits(), self._peak_usage()
        if not limits:
            return "the system"
        return min(limits, key=lambda limit: limit.size if most is None else limit.room(most)).text

    def _peak_usage(self) -> "Usage | None":
        """The most that the child was seen to use; None when it ended too soon to be looked at."""
        return None if self.waiting is None else self.waiting.most

    def _little_memory(self) -> bool:
        """Whether a crash is most likely for lack of memory, though nothing says so.

        That is: while libraries were loaded under a small limit, or when half of a limit had been used.
        """
        from ptmcad.process.shortage import LOW_LIMIT

        most = self._peak_usage()
        if self._loading() and any(limit.size < LOW_LIMIT for limit in self._limits(lifted=True)):
            return True
        return most is not None and any(2 * limit.room(most) <= limit.size for limit in self._limits())

    def _processor_time_is_over(self) -> bool:
        """Whether the child had the processor time that the caller allows."""
        import resource

        soft, hard = resource.getrlimit(resource.RLIMIT_CPU)
        return any(limit != resource.RLIM_INFINITY and self.processor_time >= limit - 0.5 for limit in (soft, hard))

    def _clean_up(self) -> None:
        """Do what the child would have done: clear its line, put into place what it has begun to, remove its files."""
        if Topic.PROGRESS in self.reports:
            _report(_CLEAR_LINE.decode())
        journal = self.reports.get(Topic.RENAMES, [""])[0]
        temporaries = [path for path in self.temporaries if os.path.lexists(path)]
        if not journal and not temporaries:
            return
        from pathlib import Path  # not before it is needed: every start would pay for it

        from ptmcad.errors import OutputError
        from ptmcad.process.commit import discard, finish

        try:
            if journal:
                finish(Path(journal), GRACE_SECONDS)
            discard(map(Path, temporaries))
        except (OSError, OutputError) as error:
            _report(f"error: {error}\n")

    def _stopped(self, why: str) -> int:
        """Save the result that was handed over last, unless the child had come to that itself."""
        if Topic.TARGET not in self.reports:
            _report(f"stopped: {why}\n")
            return 3
        if Topic.RESULT not in self.reports:
            reason = f": {self.reports[Topic.RESUMABLE][0]}" if Topic.RESUMABLE in self.reports else ""
            _report(f"stopped: {why}; there was no partial result to save yet{reason}\n")
            return 3
        from pathlib import Path  # not before it is needed: every start would pay for it

        from ptmcad.errors import OutputError
        from ptmcad.process.commit import identity
        from ptmcad.process.output import how_to_go_on, save_stopped, where_saved

        target, beside = Path(self.reports[Topic.TARGET][0]), self.reports[Topic.TARGET][1:]
        state, text, remark = self.reports[Topic.RESULT]
        _, placed, mark = self.reports.get(Topic.RENAMES, ("", "", ""))
        try:
            if mark and identity(Path(placed)) == mark:
                place = Path(placed)
            else:
                place = save_stopped(target, text, whole=state == "complete", beside=beside)
        except OutputError as error:
            _report(f"error: {why}, and the {state} result was lost: {error}\n")
            return 2
        further = how_to_go_on(place) if Topic.RESUMABLE in self.reports and state == "partial" else ""
        where = f"{place}{where_saved(target, place, beside)}{further}"
        _report(f"stopped: {why}; the {state} result{remark} is in {where}\n")
        return 3


def _terminate(number: int, _frame: FrameType | None) -> NoReturn:
    """Leave through every ``finally``, once, and without a word: the interrupted code may be in any state."""
    for other in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(other, signal.SIG_IGN)
    disconnect()  # a message may have been cut
    if sys.stderr is not None:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, sys.stderr.fileno())
        os.close(null)
    raise SystemExit(128 + number)


def _check_descriptors() -> None:
    """Refuse a limit on open files that would be met somewhere on the way."""
    spare: list[int] = []
    try:
        while len(spare) < SPARE_DESCRIPTORS:
            spare.append(os.dup(0))
    except OSError as error:
        _report(f"error: {error.strerror}: ptmcad needs {SPARE_DESCRIPTORS} more than are open (ulimit -n)\n")
        os._exit(2)
    finally:
        for descriptor in spare:
            os.close(descriptor)


_PIPE_SIGNAL = (signal.SIGIO,) if hasattr(signal, "SIGIO") else ()


def _die_with_the_parent(lifeline: int, parent: int) -> None:
    """Let the kernel end this process when the parent's end of the pipe is closed, whatever code it is in."""
    if hasattr(os, "O_ASYNC"):
        signal.signal(signal.SIGIO, signal.SIG_DFL)  # the caller may have had it ignored
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
        unexpected = quiet_stream(fcntl.fcntl(printed, fcntl.F_DUPFD_CLOEXEC, 3), sys.stderr, for_messages=True)
        sys.stderr = quiet_stream(fcntl.fcntl(2, fcntl.F_DUPFD_CLOEXEC, 3), sys.stderr, for_messages=True)
        _redirect_tracebacks(unexpected)
    os.set_blocking(printed, False)  # a flood of messages must not stop the computation
    os.dup2(printed, 1)
    os.dup2(printed, 2)
    os.close(printed)


def _redirect_tracebacks(unexpected: TextIO) -> None:
    """Let Python print errors that nobody handles to the parent too, which knows whether they are a limit's."""

    def uncaught(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        sys.stderr = unexpected
        sys.__excepthook__(kind, error, trace)
        unexpected.flush()

    def unraisable(what: "sys.UnraisableHookArgs", /) -> None:
        sys.stderr, usual = unexpected, sys.stderr
        sys.__unraisablehook__(what)
        unexpected.flush()
        sys.stderr = usual

    sys.excepthook, sys.unraisablehook = uncaught, unraisable


def _report(text: str) -> None:
    try:
        rest = memoryview(text.encode(errors="replace"))
        while rest:
            try:
                rest = rest[os.write(2, rest) :]
            except BlockingIOError:  # of a caller that has made it non-blocking
                select.select([], [2], [])
    except OSError:  # nobody reads standard error, or it is full: there is no third place to report it
        return
