"""This machine's worker processes: each computes one member after another in one interpreter, and
may die.

A pool of the standard library does not say which task a worker has died of: all that are under way
fail together, and a member that is innocent would be blamed. Here each worker has a connection of
its own, so that its death is the failure of the one member that it had.

Guarantee: a worker that dies is replaced; when this process ends, in whatever way, its workers end
too. A worker is started when there is a member for it.

The workers of a Dask scheduler, on this machine or on others.

Guarantee: members go to the scheduler a few more at a time than there are threads to compute them.
A worker that dies costs what it was computing: Dask gives it to another one, and what kills several
workers is that member's failure. The results come back through the scheduler, so that the workers
need no file system in common with this process.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any

from ptmcad.answer.sweep import State
from ptmcad.errors import ConfigError, OutputError, shown
from ptmcad.workbench.sweeps.member import Outcome, out_of_time
from ptmcad.workbench.worker import Task, Worker, WorkerLost

_OVERRUN = 1.0
"""Seconds by which a member may overrun its time limit before its process is killed; it looks at
the clock itself.
"""
_EACH = 2
"""Members for each worker: one that is computed and one that waits, so that the worker does not."""


Answer = tuple[int, Any]
"""A member's number and what became of it: what the task returned, or an `Outcome` that has failed."""


class Pool:
    """Worker processes on this machine, each asked by a thread of its own.

    Parameters
    ----------
    jobs : how many there are.
    timeout : seconds that a member may take.
    """

    def __init__(self, task: Task, jobs: int, timeout: float | None = None) -> None:
        self.timeout, self._workers = timeout, [Worker(task) for _ in range(jobs)]
        self._idle = [*self._workers]
        self._threads = ThreadPoolExecutor(jobs)
        self._under_way: dict[Future[Any], int] = {}

    @property
    def room(self) -> bool:
        """Whether one more member is wanted now."""
        return len(self._under_way) < _EACH * len(self._workers)

    @property
    def busy(self) -> bool:
        """Whether there are members of which nothing has been returned yet."""
        return bool(self._under_way)

    def submit(self, number: int) -> None:
        """Have a member computed."""
        self._under_way[self._threads.submit(self._outcome, number)] = number

    def answers(self, seconds: float | None) -> Sequence[Answer]:
        """What has been answered; waits for an answer, for so many seconds at most."""
        done = wait(self._under_way, seconds, FIRST_COMPLETED).done
        return [(self._under_way.pop(each), each.result()) for each in done]

    def close(self) -> None:
        """End at once; what is not answered is lost."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        for worker in self._workers:
            worker.close()

    def _outcome(self, number: int) -> Any:
        worker = self._idle.pop()
        try:
            return worker.compute(number, self.timeout and self.timeout + _OVERRUN)
        except TimeoutError:
            return Outcome(State.FAILED, out_of_time(self.timeout))
        except WorkerLost as lost:
            return Outcome(State.FAILED, str(lost))
        finally:
            self._idle.append(worker)


def answers_of(
    workers: Pool | Cluster,
    following: Callable[[], int | None],
    patience: Callable[[], float | None],
) -> Iterator[Answer]:
    """The answers of all members, in any order.

    Parameters
    ----------
    following : the number of another member to compute, None while there is none.
    patience : seconds to wait for an answer.
    """
    while True:
        while workers.room and (number := following()) is not None:
            workers.submit(number)
        if not workers.busy:
            return
        yield from workers.answers(patience())


CONNECT_SECONDS = 15
_LOOK_SECONDS = 2.0
"""Between two looks at the scheduler: whether it is there, and how many threads its workers have.
"""


class Cluster:
    """A Dask cluster by its scheduler's address.

    Raises
    ------
    ConfigError
        When no scheduler answers at the address.
    """

    def __init__(self, compute: Callable[[int], Any], address: str) -> None:
        import distributed

        client = distributed.Client
        self.compute, self.address = compute, address
        try:
            self.client: Any = client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = shown(" ".join(str(error).split()), 200)
            raise ConfigError(
                f"no Dask scheduler answers at {address}: {reason}", key="--scheduler"
            ) from error
        # what it says of a scheduler that is gone is said by this program, once, as an error
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
        self._answers: SimpleQueue[tuple[int, Any]] = SimpleQueue()
        self._under_way: dict[int, Any] = {}
        self._threads = 0
        self._looked = -_LOOK_SECONDS

    @property
    def room(self) -> bool:
        if monotonic() >= self._looked + _LOOK_SECONDS:
            self._looked = monotonic()
            try:
                self._threads = sum(self.client.nthreads().values())
            except (OSError, TimeoutError) as error:
                raise self._gone() from error
        return len(self._under_way) < _EACH * max(self._threads, 1)

    @property
    def busy(self) -> bool:
        return bool(self._under_way)

    def submit(self, number: int) -> None:
        future = self._under_way[number] = self.client.submit(self.compute, number, pure=False)
        future.add_done_callback(lambda done: self._answers.put((number, done)))

    def answers(self, seconds: float | None) -> Sequence[Answer]:
        found: list[Answer] = []
        patience = _LOOK_SECONDS if seconds is None else min(seconds, _LOOK_SECONDS)
        try:
            while True:
                number, done = self._answers.get(timeout=0 if found else patience)
                del self._under_way[number]  # its copy on the cluster is given up
                outcome = (
                    done.result()
                    if done.status == "finished"
                    else Outcome(State.FAILED, _why(done))
                )
                found.append((number, outcome))
        except Empty:
            if self.client.status not in ("running", "connecting"):
                raise self._gone() from None
            return found

    def _gone(self) -> OutputError:
        return OutputError(f"the scheduler at {self.address} is gone")

    def close(self) -> None:
        with suppress(OSError, TimeoutError):  # it may be gone already
            self.client.cancel(list(self._under_way.values()))
            self.client.close(timeout=2)


def _why(done: Any) -> str:
    """Why a task has failed, in words that are the same in each run."""
    if done.status != "error":
        return f"the cluster gave it up ({done.status})"
    error = done.exception()
    if (
        type(error).__name__ == "KilledWorker"
    ):  # whose text names the task, which is another one in each run
        return "its process ended on one worker of the cluster after another"
    return shown(f"{type(error).__name__}: {error}")
