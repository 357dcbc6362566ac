"""A standard stream whose reader may leave, as in ``ptmcad locate ... | head``.

Guarantee: once the reader of the pipe has gone, what is written is dropped and nothing fails. Every
other failure, such as a full disk, is raised as for any file, unless the stream is the one for
messages: there is no third place to report that, so there they are dropped. A descriptor that its
owner has made non-blocking is waited for.
"""

import io
import os
import select
from typing import Any, TextIO


class _Pipe(io.FileIO):
    """An open file descriptor for writing that knows whether its reader has left."""

    def __init__(self, descriptor: int, for_messages: bool) -> None:
        super().__init__(descriptor, "w", closefd=False)
        self.for_messages, self.reader_left = for_messages, False

    def write(self, data: Any, /) -> int:
        try:
            while (written := super().write(data)) is None:  # it is full, and does not block
                select.select([], [self], [])
            return written
        except BrokenPipeError:
            self.reader_left = True
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, self.fileno(), inheritable=True)
            os.close(null)
        except OSError:
            if not self.for_messages:
                raise
        return memoryview(data).nbytes


def quiet_stream(descriptor: int, like: TextIO, for_messages: bool = False) -> TextIO:
    """A text stream for the descriptor with the encoding and the line buffering of another."""
    raw = io.BufferedWriter(_Pipe(descriptor, for_messages))
    return io.TextIOWrapper(
        raw, like.encoding, like.errors, line_buffering=bool(like.line_buffering)
    )


def reader_left(stream: TextIO) -> bool:
    """Whether nobody reads any more what is written to the stream."""
    raw = getattr(getattr(stream, "buffer", None), "raw", None)
    return isinstance(raw, _Pipe) and raw.reader_left


def report(text: str) -> None:
    """Write to standard error, of whatever process."""
    stream = io.BufferedWriter(_Pipe(2, for_messages=True))
    stream.write(text.encode(errors="replace"))
    stream.flush()
