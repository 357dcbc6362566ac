"""A disk that stops or fails at chosen steps, and looks at the folder after each one."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Collection
from pathlib import Path


class Killed(BaseException):
    """The process is gone: from here on no step is done, whatever the code under test tries."""


class FaultyDisk:
    """What renames and removes while it is entered. Steps are counted from 1 on, also those that
    fail.

    Parameters
    ----------
    killed : the step before which the process is killed.
    failing : the steps that raise an OSError instead of being done.
    look : called after each step that was done.
    """

    def __init__(
        self,
        killed: int | None = None,
        failing: Collection[int] = (),
        look: Callable[[], None] = lambda: None,
    ) -> None:
        self.killed = killed
        self.failing = failing
        self.look = look
        self.steps = 0
        self.dead = False

    def _step(self, path: Path) -> None:
        if not self.dead:
            self.steps += 1
        if self.dead or self.steps == self.killed:
            self.dead = True
            raise Killed
        if self.steps in self.failing:
            raise OSError(errno.EIO, "Input/output error", str(path))

    def replace(self, source: Path, target: Path) -> None:
        self._step(target)
        self._real[0](source, target)
        self.look()

    def unlink(self, path: Path) -> None:
        self._step(path)
        self._real[1](path)
        self.look()

    def rmdir(self, path: Path) -> None:
        self._step(path)
        self._real[2](path)
        self.look()

    def __enter__(self) -> None:
        self._real = os.replace, os.unlink, os.rmdir
        os.replace, os.unlink, os.rmdir = self.replace, self.unlink, self.rmdir  # type: ignore[assignment]

    def __exit__(self, *_: object) -> None:
        os.replace, os.unlink, os.rmdir = self._real
