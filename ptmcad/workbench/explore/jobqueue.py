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
from itertools import count

from ptmcad.workbench.explore.jobs import SUPERSEDED, Job, Reply
from ptmcad.workbench.worker import Task, Worker

ANSWER_SECONDS = 180.0
"""After which a worker is ended: FLINT's code, and compiling the certified engine, do not look at
any clock.
"""
CANCEL_SECONDS = 2.0
"""In which a superseded job has to leave; it is ended then."""
Key = tuple[str, str]
"""A tab, and what it asks for: a later request of the same key supersedes an earlier one."""


class JobQueue:
    """The jobs of one worker, which is replaced when it has ended."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.worker: Worker | None = None
        self.waiting: OrderedDict[Key, tuple[Job, asyncio.Future[Reply]]] = OrderedDict()
        self.current: tuple[Key, int] | None = None
        self.wanted = asyncio.Event()
        self.numbers = count(1)
        self.killer: asyncio.TimerHandle | None = None

    async def ask(self, tab: str, job: Job) -> Reply:
        """The answer to a job, which supersedes an earlier one of its kind and tab."""
        key = (tab, job["kind"])
        future: asyncio.Future[Reply] = asyncio.get_running_loop().create_future()
        before = self.waiting.pop(key, None)
        if before is not None and not before[1].done():
            before[1].set_result(SUPERSEDED)
        self.waiting[key] = (job, future)
        if self.current is not None and self.current[0] == key:
            self._cancel(self.current[1])
        self.wanted.set()
        return await future

    async def run(self) -> None:
        """Hand out jobs, the oldest first, until this is cancelled; then end the process."""
        try:
            self._running()
            while True:
                await self.wanted.wait()
                self.wanted.clear()
                while self.waiting:
                    key, (job, future) = self.waiting.popitem(last=False)
                    if future.done():  # whoever asked has gone
                        continue
                    answer = await self._answered(key, job)
                    if not future.done():
                        future.set_result(answer)
        finally:
            self._end()

    def _end(self) -> None:
        """End the process, which has nothing to tidy up."""
        if self.worker is not None:
            self.worker.process.kill()
            self.worker.bury()
            self.worker = None

    def _running(self) -> Worker:
        """The process, another one where it has ended."""
        if self.worker is not None and self.worker.process.poll() is not None:
            self._end()
        if self.worker is None:
            self.worker = Worker(self.task)
        return self.worker

    async def _answered(self, key: Key, job: Job) -> Reply:
        worker, number = self._running(), next(self.numbers)
        self.current = (key, number)
        worker.ask(number, job)
        reading = asyncio.create_task(asyncio.to_thread(worker.answer))
        reading.add_done_callback(lambda done: done.cancelled() or done.exception())
        try:
            await asyncio.wait([reading], timeout=ANSWER_SECONDS)
            late = not reading.done()
            if late:
                worker.process.kill()
            _, reply, error = await reading
            how = f"failed with {error}"
        except (EOFError, OSError):
            reply, error = None, "it has died"
            how = (
                f"took more than {ANSWER_SECONDS:g} s and was stopped"
                if late
                else "ended unexpectedly"
            )
        finally:
            self.current, killer, self.killer = None, self.killer, None
            if killer is not None:
                killer.cancel()
        if not error:
            found: Reply = reply
            return found
        self._end()
        self._running()
        if killer is not None:  # a superseded job that had to be ended is just that
            return SUPERSEDED
        reason = {"error": f"the process that computes {how}; another one is there now"}
        return "lost", json.dumps(reason).encode()

    def _cancel(self, number: int) -> None:
        """Ask the process to leave its job, and end it if it does not."""
        if self.worker is None or self.killer is not None:
            return
        self.worker.cancel(number)
        loop = asyncio.get_running_loop()
        self.killer = loop.call_later(CANCEL_SECONDS, self.worker.process.kill)
