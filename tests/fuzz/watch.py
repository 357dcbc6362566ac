"""A worker process that runs cases under a watchdog.

Guarantee: a case that takes longer than the limit, ends the process or raises is reported with its
input, which is stored in the folder of findings; the other cases go on in a new worker.
"""

from __future__ import annotations

import hashlib
import os
import resource
import time
import traceback
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from fuzz.targets import make, run

LIMIT = 5.0
"""Seconds that a case may take."""
MEMORY = 2 << 30
"""Bytes of address space that a worker may have, so that a blow-up is a finding."""


@dataclass(frozen=True)
class Finding:
    """An input that was not answered as it must be."""

    kind: str
    seed: int
    what: str
    trace: str
    file: Path | None = None

    def __str__(self) -> str:
        return f"{self.kind} {self.seed}: {self.what}{f', input in {self.file}' if self.file else ''}\n{self.trace}"


@dataclass
class Tally:
    """What a campaign saw."""

    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: tuple[float, str, int] = (0.0, "", 0)
    findings: list[Finding] = field(default_factory=list)

    @property
    def cases(self) -> int:
        return sum(self.outcomes.values())


def watched(
    kind: str,
    seeds: Iterable[int],
    folder: Path | None = None,
    limit: float = LIMIT,
    most: int = 50,
    start_method: str = "spawn",
) -> Tally:
    """Run the cases of the seeds; stop early after `most` findings."""
    tally = Tally()
    waiting = list(seeds)
    while waiting and len(tally.findings) < most:
        done = _one_worker(kind, waiting, tally, folder, limit, most, start_method)
        waiting = waiting[done:]
    return tally


def _one_worker(
    kind: str,
    seeds: list[int],
    tally: Tally,
    folder: Path | None,
    limit: float,
    most: int,
    start_method: str,
) -> int:
    """The number of seeds done, the last of which may have ended the worker."""
    context: Any = get_context(start_method)
    ours, theirs = context.Pipe()
    worker = context.Process(target=_work, args=(theirs, kind, seeds), daemon=True)
    worker.start()
    theirs.close()
    try:
        ours.recv()  # ready: the honest inputs have been computed
        for number, seed in enumerate(seeds):
            what, trace = "", ""
            try:
                if _answers(ours, worker.pid or 0, limit):
                    outcome, seconds, trace = ours.recv()
                    tally.slowest = max(tally.slowest, (seconds, kind, seed))
                    what = trace.strip().rpartition("\n")[2] if trace else ""
                else:
                    outcome, what = "hang", f"takes longer than {limit} s"
            except EOFError:
                worker.join()
                outcome, what = "died", f"ended the process with {worker.exitcode}"
            tally.outcomes[f"{kind} {outcome}"] += 1
            if what:
                tally.findings.append(Finding(kind, seed, what, trace, _stored(kind, seed, folder)))
            if outcome in ("hang", "died") or len(tally.findings) >= most:
                return number + 1
        return len(seeds)
    finally:
        worker.kill()
        worker.join()
        ours.close()


def _answers(pipe: Connection, process: int, limit: float) -> bool:
    """Wait for an answer until the process has computed for `limit` seconds, or has slept for many
    times that long.

    On a machine that is busy with other things, a case is not slow because it waits for its turn.
    """
    start, asleep = _computed(process), time.monotonic() + 12 * limit
    while not pipe.poll(0.2):
        if _computed(process) - start > limit or time.monotonic() > asleep:
            return pipe.poll(0)
    return True


def _computed(process: int) -> float:
    """Seconds of processor time that a process has had; the clock's time where the system does not
    tell.
    """
    try:
        fields = (
            Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        )
    except OSError:
        return time.monotonic()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _work(pipe: Connection, kind: str, seeds: list[int]) -> None:
    """The worker: one message before the first case and one after each."""
    make(kind, 0)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    pipe.send("ready")
    for seed in seeds:
        data = make(kind, seed)
        start = time.process_time()
        outcome, trace = "failed", ""
        try:
            outcome = run(kind, data)
        except Exception:  # noqa: BLE001 - what is looked for; it is reported
            trace = traceback.format_exc(limit=-12)
        pipe.send((outcome, time.process_time() - start, trace))


def _stored(kind: str, seed: int, folder: Path | None) -> Path | None:
    if folder is None:
        return None
    data = make(kind, seed)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{kind}-{hashlib.sha256(data).hexdigest()[:12]}"
    path.write_bytes(data)
    return path
