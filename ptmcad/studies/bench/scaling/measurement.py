"""Runs that are measured in a forked child each: processor time and memory by stage, and what the run found.

Guarantee: seconds are processor time of the child alone, all threads together; memory is what its resident set
grew by since the fork, at its highest up to the end of each stage. What was found, `Run.found`, is the same in every
run with the same family, size and seed. A run that failed or took too long is an `Unmeasured` with the reason.

Not guaranteed: memory below a few hundred KiB, which the child may find free in the pages it inherited.
"""

from __future__ import annotations

import gc
import json
import os
import resource
import select
import signal
import sys
import traceback
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

MEBIBYTE = 2**20
_STATUS = Path("/proc/self/status")
_HIGH_WATER = Path("/proc/self/clear_refs")


@dataclass(frozen=True, slots=True)
class Run:
    """One run of one size.

    Attributes
    ----------
    size : the family's size, such as the degree that its slices are made for.
    seconds : processor time.
    wall : wall time.
    stages : processor seconds by stage, in their order.
    memory : MiB by stage: the highest growth of the resident set up to its end. Empty when not measured.
    found : numbers that show what the run had to deal with, such as regions, cells, boxes.
    """

    size: int
    seconds: float
    wall: float
    stages: Mapping[str, float] = field(default_factory=dict)
    memory: Mapping[str, float] = field(default_factory=dict)
    found: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Unmeasured:
    """A run without figures."""

    reason: str


class Stages:
    """A watch to which a run reports when a stage begins."""

    def __init__(self) -> None:
        self.started, self.wall, self.memory_before = process_time(), perf_counter(), highest_mebibytes()
        self.seconds: dict[str, float] = {}
        self.memory: dict[str, float] = {}
        self._stage, self._since = "", self.started

    def begin(self, stage: str) -> None:
        """The last stage ends and this one begins; nothing happens when it is the same."""
        if stage == self._stage:
            return
        now = process_time()
        if self._stage:
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + now - self._since
            self.memory[self._stage] = round(highest_mebibytes() - self.memory_before, 2)
        self._stage, self._since = stage, now

    def run(self, size: int, found: Mapping[str, float]) -> Run:
        """The figures so far, those of the stage that has not ended yet included."""
        now, wall = process_time(), perf_counter()
        seconds, memory = dict(self.seconds), dict(self.memory)
        if self._stage:
            seconds[self._stage] = seconds.get(self._stage, 0.0) + now - self._since
            memory[self._stage] = round(highest_mebibytes() - self.memory_before, 2)
        return Run(size, now - self.started, wall - self.wall, seconds, memory, dict(found))


def highest_mebibytes() -> float:
    """The largest resident set so far: of this process image where /proc shows it, else of the whole process."""
    if _STATUS.exists():
        for line in _STATUS.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / MEBIBYTE if sys.platform == "darwin" else peak / 1024


def in_child(
    task: Callable[[], Sequence[Run]], limit: float, before: Callable[[], object] = lambda: None
) -> tuple[Run, ...] | Unmeasured:
    """Run a task in a forked child.

    Parameters
    ----------
    task : measures itself; what it returns comes back as text.
    limit : wall seconds after which the child is killed.
    before : called in the child before the task, and not measured.
    """
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        # Python warns of threads, which a numerical library may have started; the child uses none of theirs
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        _child(task, before, reading, writing)
    os.close(writing)
    ended = False
    chunks: list[bytes] = []
    deadline = perf_counter() + limit
    try:
        while select.select([reading], [], [], max(0.0, deadline - perf_counter()))[0]:
            chunk = os.read(reading, 1 << 16)
            if not chunk:
                ended = True
                break
            chunks.append(chunk)
    finally:
        os.close(reading)
        if not ended:  # too slow, or this process is being interrupted: the child must not outlive its measurement
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    if not ended:
        return Unmeasured(f"no answer within {limit:g} s")
    if status != 0 or not chunks:
        return Unmeasured(f"the child ended with status {os.waitstatus_to_exitcode(status)}")
    answer: dict[str, Any] = json.loads(b"".join(chunks))
    if "failed" in answer:
        return Unmeasured(answer["failed"])
    return tuple(Run(**run) for run in answer["runs"])


def _child(task: Callable[[], Sequence[Run]], before: Callable[[], object], reading: int, writing: int) -> None:
    """Answer through the pipe and leave without the parent's exit handlers."""
    os.close(reading)
    status = 1
    try:
        answer: dict[str, Any]
        try:
            before()
            gc.collect()
            if _HIGH_WATER.exists():
                _HIGH_WATER.write_text("5")  # the highest resident set is counted from here
            answer = {"runs": [asdict(run) for run in task()]}
        except Exception as error:  # noqa: BLE001  whatever it is, the parent records it as the run's reason
            answer = {"failed": "".join(traceback.format_exception_only(error)).strip()[:300]}
        with os.fdopen(writing, "w") as pipe:
            json.dump(answer, pipe)
        status = 0
    finally:
        os._exit(status)
