"""A progress bar on standard error that appears only when the work lasts and someone is watching.

Guarantee: nothing is written when standard error is not a terminal or the work ends within a
second. The bar is one line, however narrow the terminal, goes on while nothing is reported, and is
cleared at the end.
"""

from __future__ import annotations

import os
import sys
import time
from contextlib import ExitStack
from threading import Event, RLock, Thread
from types import TracebackType

import click

PATIENCE = 1.0
_INTERVAL = 0.1
_TICK = 0.5
"""Seconds after which the time that is shown goes on."""
_WIDTH = 24
_COLUMNS = 80
"""Of a terminal that does not say how many it has."""


class ProgressBar:
    """A context manager to call with (stage, done, total); a stage that ends with "%" or "..." says
    how far it is.

    Inside of another one it is that one, so that there is one bar.
    """

    _shown_now: list[ProgressBar] = []  # noqa: RUF012 - of this process; the outermost one, if any

    def __init__(self) -> None:
        self._stream = sys.stderr  # another one is in its place while libraries are loaded
        self.watched = (
            self._stream is not None and self._stream.isatty()
        )  # None when the caller has closed it
        self.start = self.last = time.monotonic()
        self.shown = False
        self._state = ("computing ...", 0, 1)
        self._ended, self._lock = Event(), RLock()

    def __enter__(self) -> ProgressBar:
        if self._shown_now:
            return self._shown_now[0]
        if self.watched:
            self._shown_now.append(self)
            Thread(target=self._tick, daemon=True).start()
        return self

    def __call__(self, stage: str, done: int, total: int) -> None:
        self._state = (stage, done, total)
        now = time.monotonic()
        if (
            self.watched
            and now - self.start >= PATIENCE
            and (not self.shown or now - self.last >= _INTERVAL)
        ):
            self._draw(now)

    def _tick(self) -> None:
        while not self._ended.wait(_TICK):
            self(*self._state)

    def _draw(self, now: float) -> None:
        stage, done, total = self._state
        where = stage if stage.endswith(("%", "...")) else f"{stage} {done} of {total}"
        text = f"{where}, {now - self.start:.0f} s"
        room = (
            self._columns() - 4
        )  # for bar and text; the last column stays free, since some terminals wrap at it
        width = max(min(_WIDTH, room - len(text)), 4)
        filled = width * min(done, total) // total if total > 0 else 0
        line = f"[{'#' * filled}{'.' * (width - filled)}] {text}"[: room + 3]
        with self._lock:
            if self._ended.is_set():
                return
            self._stream.write(f"\r\x1b[K{line}")
            self._stream.flush()
            self.shown, self.last = True, now

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._shown_now != [self]:  # another one goes on, or nobody is watching
            return
        self._shown_now.clear()
        with self._lock:
            self._ended.set()
            self._clear()

    @classmethod
    def say(cls, text: str, err: bool = False) -> None:
        """Print a line, above the bar if there is one."""
        with ExitStack() as shown:
            for bar in cls._shown_now:
                shown.enter_context(bar._lock)
                bar._clear()
            click.echo(text, err=err)

    def _clear(self) -> None:
        if self.shown:
            self._stream.write("\r\x1b[K")
            self._stream.flush()
            self.shown = False

    def _columns(self) -> int:
        try:
            return os.get_terminal_size(self._stream.fileno()).columns or _COLUMNS
        except OSError:
            return _COLUMNS
