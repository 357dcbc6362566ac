"""A standard stream whose reader may leave, as in ``ptmcad locate ... | head``.

Guarantee: once the reader of the pipe has gone, what is written is dropped and nothing fails. Every other failure, such
as a full disk, is raised as for any file, unless the stream is the one for messages: there is no third place to report
that, so there they are dropped. A descriptor that its owner has made non-blocking is waited for.
"""

import io
import os
import select
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class _Pipe(io.FileIO):
    """An open file descriptor for writing that knows whether its reader has left."""

    reader_left = False
    for_messages = False

    def write(self, data: "ReadableBuffer", /) -> int:
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
    raw = _Pipe(descriptor, "w", closefd=False)
    raw.for_messages = for_messages
    buffer = io.BufferedWriter(raw)
    return io.TextIOWrapper(buffer, like.encoding, like.errors, line_buffering=bool(like.line_buffering))


def reader_left(stream: TextIO) -> bool:
    """Whether nobody reads any more what is written to the stream."""
    raw = getattr(getattr(stream, "buffer", None), "raw", None)
    return isinstance(raw, _Pipe) and raw.reader_left


def report(text: str) -> None:
    """Write to standard error, of whatever process."""
    try:
        rest = memoryview(text.encode(errors="replace"))
        while rest:
            try:
                rest = rest[os.write(2, rest) :]
            except BlockingIOError:  # of a caller that has made it non-blocking
                select.select([], [2], [])
    except OSError:  # nobody reads standard error, or it is full: there is no third place to report it
        return
