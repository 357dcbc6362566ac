"""The workers as the server sees them: each takes one job at a time, and of each tab the last one
that was asked for.

Guarantee: every request is answered: with what it asked for, with a reason in words, or with the
word that a later request of its tab has superseded it. A worker that has died, or does not end in
`ANSWER_SECONDS`, is replaced.
"""

from __future__ import annotations

import asyncio
import json
from collections import OrderedDict

from ptmcad.workbench.explore.jobs import SUPERSEDED, Job, Reply
from ptmcad.workbench.worker import Task, Worker, WorkerLost

ANSWER_SECONDS = 180.0
"""After which a worker is ended: FLINT's code, and compiling the certified engine, do not look at
any clock.
"""
CANCEL_SECONDS = 2.0
"""In which a superseded job has to leave; it is ended then."""
Key = tuple[str, str]
"""A tab, and what it asks for: a later request of the same key supersedes an earlier one."""


class JobQueue:
    """The jobs of one worker."""

    def __init__(self, task: Task) -> None:
        self.worker = Worker(task)
        self.waiting: OrderedDict[Key, tuple[Job, asyncio.Future[Reply]]] = OrderedDict()
        self.current: Key | None = None
        self.wanted = asyncio.Event()
        self.killer: asyncio.TimerHandle | None = None

    async def ask(self, tab: str, job: Job) -> Reply:
        """The answer to a job, which supersedes an earlier one of its kind and tab."""
        key = (tab, job["kind"])
        loop = asyncio.get_running_loop()
        future: asyncio.Future[Reply] = loop.create_future()
        before = self.waiting.pop(key, None)
        if before is not None and not before[1].done():
            before[1].set_result(SUPERSEDED)
        self.waiting[key] = (job, future)
        if self.current == key and self.killer is None:
            self.worker.cancel()
            self.killer = loop.call_later(CANCEL_SECONDS, self.worker.end)
        self.wanted.set()
        return await future

    async def run(self) -> None:
        """Hand out jobs, the oldest first, until this is cancelled; then end the process."""
        try:
            self.worker.open()
            while True:
                await self.wanted.wait()
                self.wanted.clear()
                while self.waiting:
                    key, (job, future) = self.waiting.popitem(last=False)
                    if future.done():  # whoever asked has gone
                        continue
                    self.current = key
                    answer = await self._answered(job)
                    if not future.done():
                        future.set_result(answer)
        finally:
            self.worker.close()

    async def _answered(self, job: Job) -> Reply:
        try:
            found: Reply = await asyncio.to_thread(self.worker.compute, job, ANSWER_SECONDS)
        except (WorkerLost, TimeoutError) as lost:
            self.worker.open()
            if self.killer is not None:  # a superseded job that had to be ended is just that
                return SUPERSEDED
            reason = f"the process that computes has failed ({lost}); another one is there now"
            return "lost", json.dumps({"error": reason}).encode()
        finally:
            self.current, killer, self.killer = None, self.killer, None
            if killer is not None:
                killer.cancel()
        return found
