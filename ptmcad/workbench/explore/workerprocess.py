"""The workers as the server sees them: each takes one job at a time, and of each tab the last one
that was asked for.

Guarantee: every request is answered: with what it asked for, with a reason in words, or with the
word that a later request of its tab has superseded it. A worker that has died, or does not end in
`ANSWER_SECONDS`, is replaced.
"""

from __future__ import annotations

import asyncio
import base64
import json
import os
import pickle
import signal
import sys
from collections import OrderedDict
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

from ptmcad.workbench.explore.panel import SliderPanel

ANSWER_SECONDS = 180.0
"""After which a worker is ended: FLINT's code, and compiling the certified engine, do not look at
any clock.
"""
CANCEL_SECONDS = 2.0
"""In which a superseded job has to leave; it is ended then."""
_MAX_BYTES = 1 << 26
"""Bytes of one answer."""


@dataclass(frozen=True, slots=True)
class Reply:
    """How a job ended (``done``, ``refused``, ``superseded``, ``lost``), and the JSON that the page
    is told.
    """

    ended: str
    body: bytes


SUPERSEDED = Reply("superseded", b"{}")
Key = tuple[str, str]
"""A tab, and what it asks for: a later request of the same key supersedes an earlier one."""


class WorkerProcess:
    """One process, started when it is first needed, and again when it has ended."""

    def __init__(self, panel: SliderPanel, folder: Path) -> None:
        self.first = base64.b64encode(pickle.dumps(panel)) + b"\n"
        self.folder = folder
        self.process: asyncio.subprocess.Process | None = None
        self.lifeline: int | None = None
        self.waiting: OrderedDict[Key, tuple[dict[str, Any], asyncio.Future[Reply]]] = OrderedDict()
        self.current: tuple[Key, int] | None = None
        self.wanted = asyncio.Event()
        self.numbers = count(1)
        self.killer: asyncio.TimerHandle | None = None

    async def ask(self, tab: str, job: dict[str, Any]) -> Reply:
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
            await self._start()
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
            self.end()

    def end(self) -> None:
        """End the process, which has nothing to tidy up."""
        if self.process is not None:
            _kill(self.process)
        self.process = None
        if self.lifeline is not None:
            os.close(self.lifeline)
            self.lifeline = None

    async def _start(self) -> asyncio.subprocess.Process:
        self.end()
        read, self.lifeline = os.pipe()
        try:
            self.process = await asyncio.create_subprocess_exec(
                sys.executable, "-m", "ptmcad.workbench.explore.jobloop", str(read), str(os.getpid()), str(self.folder),
                stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, pass_fds=(read,), limit=_MAX_BYTES,
            )  # fmt: skip
        finally:
            os.close(read)
        assert self.process.stdin is not None
        self.process.stdin.write(self.first)
        return self.process

    async def _answered(self, key: Key, job: dict[str, Any]) -> Reply:
        process = self.process
        if process is None or process.returncode is not None:
            process = await self._start()
        assert process.stdin is not None and process.stdout is not None
        number = next(self.numbers)
        self.current = (key, number)
        try:
            async with asyncio.timeout(ANSWER_SECONDS):
                process.stdin.write(json.dumps({**job, "number": number}).encode() + b"\n")
                await process.stdin.drain()
                head = await process.stdout.readline()
                body = await process.stdout.readline()
            if not body.endswith(b"\n"):
                return await self._lost(process, "ended unexpectedly")
            return Reply(json.loads(head)["ended"], body)
        except TimeoutError:
            return await self._lost(process, f"took more than {ANSWER_SECONDS:g} s and was stopped")
        except ConnectionError:
            return await self._lost(process, "had ended")
        finally:
            self.current = None
            if self.killer is not None:
                self.killer.cancel()
                self.killer = None

    async def _lost(self, process: asyncio.subprocess.Process, how: str) -> Reply:
        """Start another process, and say so; a superseded job that had to be ended is just that."""
        superseded = self.killer is not None
        _kill(process)
        await process.wait()
        await self._start()
        if superseded:
            return SUPERSEDED
        reason = {"error": f"the process that computes {how}; another one is there now"}
        return Reply("lost", json.dumps(reason).encode())

    def _cancel(self, number: int) -> None:
        """Ask the process to leave its job, and end it if it does not."""
        if self.process is None or self.process.stdin is None or self.killer is not None:
            return
        with suppress(ConnectionError):
            self.process.stdin.write(json.dumps({"cancel": number}).encode() + b"\n")
        self.killer = asyncio.get_running_loop().call_later(CANCEL_SECONDS, _kill, self.process)


def _kill(process: asyncio.subprocess.Process) -> None:
    """End a process, if it is there; asyncio's own way would take its status from the thread that
    waits for it.
    """
    if process.returncode is None:
        with suppress(ProcessLookupError):
            os.kill(process.pid, signal.SIGKILL)
