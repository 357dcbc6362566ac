"""The process that watches a computation, until that has ended, and what it makes of the end.

Guarantee: see `ptmcad.process.supervisor`.
"""

import math
import os
import select
import signal
import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ptmcad.process.handover import LAST_SECONDS, Receiver, Topic
from ptmcad.process.salvage import clean_up, save_last, what_is_there
from ptmcad.process.streams import report

if sys.platform != "win32":
    import resource  # noqa: F401 - os.wait4 does, when the child has ended: there may be no room left for it then

if TYPE_CHECKING:
    from ptmcad.process.shortage import Limit

GRACE_SECONDS = 0.3
"""Seconds from the request to leave to the kill."""

OVERRUN_SECONDS = 0.25
"""Seconds by which the child may overrun its time limit: it looks at the clock itself, and does so first."""

POLL_SECONDS = 0.25
"""Seconds between two looks at whether the child lives."""

LONG_SECONDS = 1.0
"""Seconds after which it is said why the child has not left yet."""

_CRASHES = {
    signal.SIGSEGV,
    signal.SIGBUS,
    signal.SIGFPE,
    signal.SIGILL,
    signal.SIGABRT,
    signal.SIGSYS,
    signal.SIGTRAP,
}
_HOW_ENDED: dict[int, str] = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated (SIGTERM)",
    signal.SIGHUP: "the terminal was closed (SIGHUP)",
}
_CHUNK = 1 << 16


class Watch:
    """The parent's side: what the child has reported, what has been asked of it, and what to do at its end."""

    def __init__(self, child: int, messages: int, printed: int, heeded: Sequence[int]) -> None:
        self.child = child
        self.messages = messages
        self.printed = printed
        self.heeded = heeded
        self.wake = -1
        self.asked: float | None = None
        """When the child was asked to leave, or killed."""
        self.heard = 0
        """How many of the signals are taken for one."""
        self.receiver = Receiver()
        self.caught: list[int] = []
        self.text = bytearray()
        self.reports: dict[Topic, list[str]] = {}
        self.temporaries: list[str] = []
        self.placed: list[list[str]] = []
        self.out_of_time = False
        self.processor_time = 0.0
        self.most_memory = 0
        """Resident bytes that the child had at most."""

    def run(self, wake: tuple[int, int], before: set[int | signal.Signals]) -> int:
        """Watch until the child has ended, tidy up, and return the exit status."""
        self.wake = wake[0]
        for descriptor in (self.messages, self.printed, self.wake):
            os.set_blocking(descriptor, False)
        signal.set_wakeup_fd(wake[1], warn_on_full_buffer=False)
        for number in self.heeded:
            signal.signal(number, lambda caught, _frame: self.caught.append(caught))
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)  # it has to be caught to wake the parent
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            ended = self._wait()
            for descriptor in (self.messages, self.printed, self.wake):
                self._read(descriptor)
            return self._end(ended)
        except MemoryError:  # of this process, which needs little: it is the caller's limit
            os.kill(self.child, signal.SIGKILL)  # it may be there, or wait to be asked for its end: not for another yet
            report("stopped: memory ran out, also for the process that watches; no result could be saved\n")
            return 3

    def _wait(self) -> int:
        """The child's exit code, or minus the signal that ended it."""
        open_ends = {self.messages, self.printed, self.wake}
        kill_at: float | None = None
        while True:
            due = kill_at if kill_at is not None else self._deadline()
            timeout = POLL_SECONDS if due is None else min(POLL_SECONDS, max(0.0, due - time.monotonic()))
            for end in select.select(list(open_ends), [], [], timeout)[0]:
                if not self._read(end):
                    open_ends.discard(end)
            child, status, used = os.wait4(self.child, os.WNOHANG)
            if child:
                self.processor_time = used.ru_utime + used.ru_stime
                self.most_memory = used.ru_maxrss << (0 if sys.platform == "darwin" else 10)
                return os.waitstatus_to_exitcode(status)
            now = time.monotonic()
            if kill_at is not None:
                if now >= kill_at or self._asked_again(now):
                    os.kill(self.child, signal.SIGKILL)
                    kill_at = now + 60
                continue
            due = self._deadline()
            self.out_of_time = not self.caught and due is not None and now >= due
            if self.caught or self.out_of_time:
                os.kill(self.child, signal.SIGTERM if signal.SIGTERM in self.heeded else signal.SIGKILL)
                self.asked, kill_at = now, now + (LAST_SECONDS if self._makes_a_last_map() else GRACE_SECONDS)

    def _makes_a_last_map(self) -> bool:
        """Whether the child, asked to leave, hands over what it knows of a map that can be gone on from."""
        state = self.reports.get(Topic.RESULT, ["partial"])[0]
        resumable = self.reports.get(Topic.RESUMABLE, [""]) != [""]
        return bool(self.caught) and Topic.TARGET in self.reports and resumable and state == "partial"

    def _asked_again(self, now: float) -> bool:
        """Whether a signal has come after those that ended the work, as a second Ctrl-C; one at once is of the first.

        A terminal is told in time what is waited for.
        """
        assert self.asked is not None
        if now < self.asked + GRACE_SECONDS:
            self.heard = len(self.caught)
        elif now >= self.asked + LONG_SECONDS and self.caught and os.isatty(2):
            report("\r\x1b[Kmaking the map of what is known by now; a second Ctrl-C saves an earlier one")
            self.reports[Topic.PROGRESS] = []
        return len(self.caught) > self.heard

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
                    if topic is Topic.RENAMES:
                        self.placed.append(texts)
                    if topic is Topic.WAITING:
                        clear = "\r\x1b[K" if Topic.PROGRESS in self.reports else ""
                        report(f"{clear}waiting   another process is writing in {texts[0]}\n")
            elif end == self.printed:
                self.text += data
            elif self.asked is None:  # afterwards it is the child's echo of what asked it
                self.caught += [number for number in data if number in self.heeded]

    def _end(self, ended: int) -> int:
        """Leave nothing behind, say what there is to say, and return the exit status."""
        # a library may call exit() when memory runs out: then the child has not said that it was done
        deserted = ended >= 0 and Topic.DONE not in self.reports and ended <= 128
        if ended < 0 or deserted or self.caught or self.out_of_time or Topic.EXHAUSTED in self.reports:
            clean_up(self.reports, self.temporaries)
        if self.caught:
            how = _HOW_ENDED.get(self.caught[0], f"stopped by {_name(self.caught[0])}")
            if self.reports.get(Topic.RESUMABLE) == [""]:
                return 128 + self.caught[0]
            if Topic.RESUMABLE in self.reports or self.reports.get(Topic.RESULT, [""])[0] == "complete":
                save_last(self.reports, how)
            elif Topic.DONE not in self.reports:
                report(f"{how}; {what_is_there(self.placed)}\n")
            return 128 + self.caught[0]
        text = self.text.decode(errors="replace")
        why = self._why_stopped(ended, deserted, text)
        if why:
            return save_last(self.reports, f"stopped: {why}")
        report(text)
        if ended >= 0 and not deserted:
            return ended
        how = f"ended by itself with status {ended}" if deserted else f"crashed ({_name(-ended)})"
        how = f"error: the computation {how}; this is a bug, please report it"
        if Topic.RESUMABLE in self.reports and Topic.RESULT in self.reports:
            save_last(self.reports, how)
        else:
            report(f"{how}\n")
        return 128 - ended if ended < 0 else ended or 1

    def _why_stopped(self, ended: int, deserted: bool, text: str) -> str:
        """What ended the child before it was done, in words; empty when nothing did."""
        if self.out_of_time and (ended < 0 or ended > 128):
            return f"the time limit of {self.reports[Topic.DEADLINE][1]} was reached"
        if Topic.EXHAUSTED in self.reports:
            return f"the memory limit of {self._limit_reached()} was reached"
        if -ended in (signal.SIGXCPU, signal.SIGKILL) and self._processor_time_is_over():
            return "the limit on processor time that the caller has set (ulimit -t) was reached"
        if ended == -signal.SIGKILL:
            return "the computation was killed from outside, most likely because memory ran out"
        crashed = -ended in _CRASHES
        if ended < 0 and not crashed:
            return f"the computation was ended from outside ({_name(-ended)})"
        if deserted or crashed:
            from ptmcad.process.shortage import speaks_of_memory

            if speaks_of_memory(text):
                return f"the memory limit of {self._limit_reached()} was reached"
            if self._little_memory():
                last = "".join(text.rstrip().rpartition("\n")[2:])[:200] or "without a word"
                how = _name(-ended) if crashed else last
                return f"most likely the memory limit of {self._limit_reached()} was reached ({how})"
        return ""

    def _limits(self) -> "list[Limit]":
        """The limits on the child's memory: its caller's, and its own."""
        from ptmcad.process.shortage import caller_limits  # not before it is needed: every start would pay

        own = self.reports.get(Topic.MEMORY)
        return [*caller_limits(), *([] if own is None else [(int(own[0]), own[1])])]

    def _limit_reached(self) -> str:
        """The lowest limit, in words."""
        return min(self._limits(), default=(0, "the system"))[1]

    def _little_memory(self) -> bool:
        """Whether a crash is most likely for lack of memory, though nothing says so.

        That is: while libraries were loaded under a small limit, or when half of a limit had been used.
        """
        from ptmcad.process.shortage import LOW_LIMIT, caller_limits

        loading = self.reports.get(Topic.LOADING, ["the program"])[0]
        if loading and any(size < LOW_LIMIT for size, _ in caller_limits()):
            return True
        return any(2 * self.most_memory >= size for size, _ in self._limits())

    def _processor_time_is_over(self) -> bool:
        """Whether the child had the processor time that the caller allows."""
        import resource

        soft, hard = resource.getrlimit(resource.RLIMIT_CPU)
        return any(limit != resource.RLIM_INFINITY and self.processor_time >= limit - 0.5 for limit in (soft, hard))


def _name(number: int) -> str:
    """A signal's name; most real-time signals have none."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
