"""Runs that are measured in a forked child each: processor time and memory by stage, and what the run found.

Guarantee: seconds are processor time of the child alone, all threads together; memory is what its resident set
grew by since the fork, at its highest up to the end of each stage. What was found, `Run.found`, is the same in every
run with the same family, size and seed. Where a run failed or took too long there is a reason in its place.

Not guaranteed: memory below a few hundred KiB, which the child may find free in the pages it inherited.
"""

from __future__ import annotations

import gc
import resource
import sys
import traceback
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter, process_time

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
        """The figures so far, the stage that has not ended yet ending now."""
        now, wall = process_time(), perf_counter()
        self.begin("")
        return Run(size, now - self.started, wall - self.wall, self.seconds, self.memory, dict(found))


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
) -> tuple[Run, ...] | str:
    """Run a task in a forked child; without figures, the reason.

    Parameters
    ----------
    task : measures itself.
    limit : wall seconds after which the child is killed.
    before : called in the child before the task, and not measured.
    """
    context = get_context("fork")
    reading, writing = context.Pipe(duplex=False)
    child = context.Process(target=_child, args=(task, before, writing))
    with warnings.catch_warnings():
        # Python warns of threads, which a numerical library may have started; the child uses none of theirs
        warnings.simplefilter("ignore", DeprecationWarning)
        child.start()
    writing.close()
    try:
        found: tuple[Run, ...] | str = reading.recv() if reading.poll(limit) else f"no answer within {limit:g} s"
    except EOFError:
        child.join()
        found = f"the child ended with status {child.exitcode}"
    finally:  # also when this process is being interrupted: the child must not outlive its measurement
        reading.close()
        child.kill()
        child.join()
    return found


def _child(task: Callable[[], Sequence[Run]], before: Callable[[], object], writing: Connection) -> None:
    try:
        before()
        gc.collect()
        if _HIGH_WATER.exists():
            _HIGH_WATER.write_text("5")  # the highest resident set is counted from here
        answer: tuple[Run, ...] | str = tuple(task())
    except Exception as error:  # noqa: BLE001  whatever it is, the parent records it as the run's reason
        answer = "".join(traceback.format_exception_only(error)).strip()[:300]
    writing.send(answer)
