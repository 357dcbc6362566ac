"""A progress bar on standard error that appears only when the work lasts and someone is watching.

Guarantee: nothing is written when standard error is not a terminal or the work ends within a second; the line is
cleared at the end.
"""

from __future__ import annotations

import sys
import time
from types import TracebackType

from ptmcad.process.handover import Topic, send

PATIENCE = 1.0
_INTERVAL = 0.1
_WIDTH = 24


class ProgressBar:
    """A context manager to call with (stage, done, total); a stage that ends with "%" or "..." says how far it is."""

    def __init__(self) -> None:
        self.watched = sys.stderr is not None and sys.stderr.isatty()  # None when the caller has closed it
        self.start = self.last = time.monotonic()
        self.shown = False

    def __enter__(self) -> ProgressBar:
        return self

    def __call__(self, stage: str, done: int, total: int) -> None:
        now = time.monotonic()
        if not self.watched or now - self.start < PATIENCE or (self.shown and now - self.last < _INTERVAL):
            return
        filled = _WIDTH * min(done, total) // total if total > 0 else 0
        bar = "#" * filled + "." * (_WIDTH - filled)
        if not self.shown:
            send(Topic.PROGRESS)  # this process may not live to clear the line
        where = stage if stage.endswith(("%", "...")) else f"{stage} {done} of {total}"
        sys.stderr.write(f"\r\x1b[K[{bar}] {where}, {now - self.start:.0f} s")
        sys.stderr.flush()
        self.shown, self.last = True, now

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.shown:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
