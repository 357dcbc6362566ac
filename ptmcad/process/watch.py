"""The process that watches a computation, until that has ended, and what it makes of the end.

Guarantee: see `ptmcad.process.supervisor`. Nothing is imported at the start that takes time: every command would pay.
"""

import math
import os
import resource
import select
import signal
import sys
import time
from collections.abc import Sequence

from ptmcad.process.handover import LAST_SECONDS, Topic, received, remove
from ptmcad.process.streams import report

GRACE_SECONDS = 0.3
"""Seconds from the request to leave to the kill."""

OVERRUN_SECONDS = 0.25
"""Seconds by which the child may overrun its time limit: it looks at the clock itself, and does so first."""

POLL_SECONDS = 0.25
"""Seconds between two looks at whether the child lives."""

LONG_SECONDS = 1.0
"""Seconds after which it is said why the child has not left yet."""

_CRASHES = ("SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL", "SIGABRT", "SIGSYS", "SIGTRAP")
_HOW_ENDED: dict[int, str] = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated (SIGTERM)",
    signal.SIGHUP: "the terminal was closed (SIGHUP)",
}
_CLEAR_LINE = "\r\x1b[K"
_CHUNK = 1 << 16


class Watch:
    """The parent's side: what the child has reported, what has been asked of it, and what to do at its end."""

    def __init__(self, child: int, messages: int, printed: int, heeded: Sequence[int]) -> None:
        self.child, self.messages, self.printed, self.heeded = child, messages, printed, heeded
        self.asked = math.inf
        """When the child was asked to leave, or killed."""
        self.heard = 0
        """How many of the signals are taken for one."""
        self.caught: list[int] = []
        self.received, self.text = bytearray(), bytearray()
        self.reports: dict[Topic, list[str]] = {}
        """What the child has said last on each topic."""
        self.temporaries, self.saved = list[str](), list[str]()
        self.out_of_time = False
        self.used: resource.struct_rusage
        """By the child, once it has ended."""

    def run(self, wake: tuple[int, int], before: set[int | signal.Signals]) -> int:
        """Watch until the child has ended, tidy up, and return the exit status."""
        ends = {self.messages, self.printed, wake[0]}
        for descriptor in ends:
            os.set_blocking(descriptor, False)
        signal.set_wakeup_fd(wake[1], warn_on_full_buffer=False)
        for number in self.heeded:
            signal.signal(number, lambda caught, _frame: self.caught.append(caught))
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)  # it has to be caught to wake the parent
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            ended = self._wait(set(ends))
            for descriptor in ends:
                self._read(descriptor)
            return self._end(ended)
        except MemoryError:  # of this process, which needs little: it is the caller's limit
            os.kill(self.child, signal.SIGKILL)  # it may be there, or wait to be asked for its end: not for another yet
            report("stopped: memory ran out, also for the process that watches; no result could be saved\n")
            return 3

    def _wait(self, ends: set[int]) -> int:
        """The child's exit code, or minus the signal that ended it."""
        kill_at = math.inf
        while True:
            due = self._deadline() if self.asked == math.inf else kill_at
            timeout = min(POLL_SECONDS, max(0.0, due - time.monotonic()))
            for end in select.select(list(ends), [], [], timeout)[0]:
                if not self._read(end):
                    ends.discard(end)
            child, status, self.used = os.wait4(self.child, os.WNOHANG)
            if child:
                return os.waitstatus_to_exitcode(status)
            now = time.monotonic()
            if self.asked < math.inf:
                if now >= kill_at or self._asked_again(now):
                    os.kill(self.child, signal.SIGKILL)
                    kill_at = now + 60
            elif self.caught or now >= self._deadline():
                self.out_of_time = not self.caught
                os.kill(self.child, signal.SIGTERM if signal.SIGTERM in self.heeded else signal.SIGKILL)
                self.asked, kill_at = now, now + (LAST_SECONDS if self._makes_a_last_map() else GRACE_SECONDS)

    def _deadline(self) -> float:
        return float(self.reports.get(Topic.DEADLINE, ["inf"])[0]) + OVERRUN_SECONDS  # infinite while the clock stands

    def _makes_a_last_map(self) -> bool:
        """Whether the child, asked to leave, hands over what it knows of a map that can be gone on from."""
        state = self.reports.get(Topic.RESULT, ["partial"])[0]
        resumable = self.reports.get(Topic.RESUMABLE, [""]) != [""]
        return bool(self.caught) and Topic.TARGET in self.reports and resumable and state == "partial"

    def _asked_again(self, now: float) -> bool:
        """Whether a signal has come after those that ended the work, as a second Ctrl-C; one at once is of the first.

        A terminal is told in time what is waited for.
        """
        if now < self.asked + GRACE_SECONDS:
            self.heard = len(self.caught)
        elif now >= self.asked + LONG_SECONDS and self.caught and os.isatty(2):
            report(f"{_CLEAR_LINE}making the map of what is known by now; a second Ctrl-C saves an earlier one")
            self.reports[Topic.PROGRESS] = []
        return len(self.caught) > self.heard

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
                self.received += data
                for topic, texts in received(self.received):
                    self.reports[topic] = texts
                    if topic is Topic.TEMPORARY:
                        self.temporaries += texts
                    if topic is Topic.SAVED:
                        self.saved += texts
            elif end == self.printed:
                self.text += data
            elif self.asked == math.inf:  # afterwards it is the child's echo of what asked it
                self.caught += [number for number in data if number in self.heeded]

    def _end(self, ended: int) -> int:
        """Leave nothing behind, say what there is to say, and return the exit status."""
        # a library may call exit() when memory runs out: then the child has not said that it was done
        deserted = 0 <= ended <= 128 and Topic.DONE not in self.reports
        if Topic.DONE not in self.reports:
            self._clean_up()
        resumable = self.reports.get(Topic.RESUMABLE)
        if self.caught and resumable != [""]:  # otherwise it is the usual end
            how = _HOW_ENDED.get(self.caught[0], f"stopped by {_name(self.caught[0])}")
            if resumable or self.reports.get(Topic.RESULT, [""])[0] == "complete":
                self._save_last(how)
            elif Topic.DONE not in self.reports:
                report(f"{how}; {what_is_there(self.saved)}\n")
        if self.caught:
            return 128 + self.caught[0]
        text = self.text.decode(errors="replace")
        why = self._why_stopped(ended, deserted, text)
        if why:
            return self._save_last(f"stopped: {why}")
        report(text)
        if ended >= 0 and not deserted:
            return ended
        how = f"ended by itself with status {ended}" if deserted else f"crashed ({_name(-ended)})"
        how = f"error: the computation {how}; this is a bug, please report it"
        if resumable and Topic.RESULT in self.reports:
            self._save_last(how)
        else:
            report(f"{how}\n")
        return 128 - ended if ended < 0 else ended or 1

    def _why_stopped(self, ended: int, deserted: bool, text: str) -> str:
        """What ended the child before it was done, in words; empty when nothing did."""
        if self.out_of_time and (ended < 0 or ended > 128):
            return f"the time limit of {self.reports[Topic.DEADLINE][1]} was reached"
        if -ended in (signal.SIGXCPU, signal.SIGKILL) and any(
            limit != resource.RLIM_INFINITY and self.used.ru_utime + self.used.ru_stime >= limit - 0.5
            for limit in resource.getrlimit(resource.RLIMIT_CPU)
        ):
            return "the limit on processor time that the caller has set (ulimit -t) was reached"
        if ended == -signal.SIGKILL:
            return "the computation was killed from outside, most likely because memory ran out"
        crashed = ended < 0 and _name(-ended) in _CRASHES
        if ended < 0 and not crashed:
            return f"the computation was ended from outside ({_name(-ended)})"
        return self._why_of_memory(_name(-ended) if crashed else "", deserted, text)

    def _why_of_memory(self, crash: str, deserted: bool, text: str) -> str:
        """Whether lack of memory has ended the child, in words, which name the lowest limit; empty if not.

        Where nothing says so it is most likely under a small limit of the caller's, or when half of a limit had been
        used.
        """
        if not crash and not deserted and Topic.EXHAUSTED not in self.reports:
            return ""
        from ptmcad.process.memory import LOW_LIMIT, caller_limits, speaks_of_memory

        callers, own = caller_limits(), self.reports.get(Topic.MEMORY)
        limits = [*callers, *([] if own is None else [(int(own[0]), own[1])])]
        reached = f"the memory limit of {min(limits, default=(0, 'the system'))[1]} was reached"
        if Topic.EXHAUSTED in self.reports or speaks_of_memory(text):
            return reached
        most = self.used.ru_maxrss << (0 if sys.platform == "darwin" else 10)
        if all(size >= LOW_LIMIT for size, _ in callers) and all(2 * most < size for size, _ in limits):
            return ""
        last = text.rstrip().rpartition("\n")[2][:200] or "without a word"
        return f"most likely {reached} ({crash or last})"

    def _clean_up(self) -> None:
        """Do what the child would have done: clear its line, remove its files."""
        if Topic.PROGRESS in self.reports:
            report(_CLEAR_LINE)
        for path in filter(os.path.lexists, self.temporaries):
            try:
                remove(path)
            except OSError as error:
                report(f"error: {error}\n")

    def _save_last(self, why: str) -> int:
        """Save the result that was handed over last, unless the child had come to that itself; return the exit status.

        Parameters
        ----------
        why : it was stopped, as the start of a sentence.
        """
        resumable = list(filter(None, self.reports.get(Topic.RESUMABLE, ())))
        if Topic.TARGET not in self.reports:
            report("; ".join((why, *resumable)) + "\n")
            return 3
        if Topic.RESULT not in self.reports:
            report(": ".join((f"{why}; there was no partial map to save yet", *resumable)) + "\n")
            return 3
        from pathlib import Path

        from ptmcad.errors import OutputError
        from ptmcad.process.output import how_to_go_on, save_stopped

        target, beside = Path(self.reports[Topic.TARGET][0]), self.reports[Topic.TARGET][1:]
        state, text, remark = self.reports[Topic.RESULT]
        try:
            if self.saved:
                place, where = Path(self.saved[-1]), ""
            else:
                place, where = save_stopped(target, text, whole=state == "complete", beside=beside)
        except OutputError as error:
            report(f"error: {why}, and the {state} map was lost: {error}\n")
            return 2
        further = how_to_go_on(place) if resumable and state == "partial" else ""
        report(f"{why}; {state} map{remark} saved to {place}{where}{further}\n")
        return 3


def what_is_there(saved: Sequence[str]) -> str:
    """In words, what a stopped command has saved: the last file of each set that was put into place."""
    found = list(filter(os.path.lexists, saved))
    if not found:
        return "nothing was saved"
    if len(found) == 1:
        return f"{found[0]} had been written before and is whole"
    return f"{len(found)} results had been written before and are whole, the last of them {found[-1]}"


def _name(number: int) -> str:
    """A signal's name; most real-time signals have none."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
