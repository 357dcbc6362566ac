"""What ties a computing process to the one that watches it: messages through a pipe, one way, and
its end.

Guarantee: a message is received whole or not at all, also from a process that is killed while it
sends. In a process that nobody watches `send` does nothing. On a system whose pipes send signals
(Linux) the kernel ends a process by `end_with`, whatever code it is in, as soon as the other one
has ended; elsewhere nothing is promised.

It is imported before everything else of the program, so it imports nothing that takes time.
"""

import fcntl
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from enum import Enum

LAST_SECONDS = 10.0
"""What a process that is asked to leave has at most for a last result, where it makes one."""
_HEAD = 9  # a topic's letter and the length of the body in 8 bytes


class Topic(Enum):
    """What a message is about, and the texts it consists of."""

    TEMPORARY = (
        b"T"  # path of the folder that is being made or used, of no use once the process is gone
    )
    SAVED = b"R"  # the last file of a set, which is in place now
    DEADLINE = b"D"  # reading of time.monotonic() at which the time is over, the limit in words
    MEMORY = b"M"  # the memory limit in bytes, and in words
    RESULT = b"P"  # "partial" or "complete", the result's text as it is by now, a remark on how far it is, or "", the path
    # of its file, and the names of the other files that are to be written
    RESUMABLE = b"S"  # the results handed over can be gone on from: they are worth saving when a signal ends the work;
    # with what there is to say while there is none, and why, if one is made at a signal; "" where
    # that is the usual end
    DONE = b"E"  # the program has come to its end and exits with its status


class Own:
    """What this process knows of its watching."""

    pipe: int | None = None
    """Its end of the pipe, when it is watched."""
    status: int | None = None
    """With which it has been asked to leave. What the signal's handler has raised may be lost: code
    that C code calls, such as a callback of the collector, loses what is raised in it."""


def watched() -> bool:
    """Whether another process watches this one, and will act when it cannot."""
    return Own.pipe is not None


def leave_if_asked() -> None:
    """Raise again what ends the process."""
    if Own.status is not None:
        raise SystemExit(Own.status)


def end_with(lifeline: int, parent: int) -> None:
    """Let the kernel end this process when the last end at which the parent holds a pipe is closed.

    Parameters
    ----------
    lifeline : the end at which the pipe is read; nobody writes to it.
    parent : the parent's number: it may have ended before.
    """
    signal.signal(signal.SIGIO, signal.SIG_DFL)  # the caller may have had it ignored
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(
        lifeline, fcntl.F_SETFL, os.O_ASYNC
    )  # sends SIGIO, whose default is to end the process
    if os.getppid() != parent:
        os._exit(1)


def send(topic: Topic, *texts: str) -> None:
    """Send a message, whole: what a signal's handler raises comes before it or after."""
    if Own.pipe is None:
        return
    body = "\0".join(texts).encode("utf-8", "surrogateescape")
    rest = memoryview(topic.value + len(body).to_bytes(_HEAD - 1, "big") + body)
    # where the watching process is gone this one goes with it, at the end of what nothing may
    # disturb
    with undisturbed(), suppress(BrokenPipeError):
        while rest:
            rest = rest[os.write(Own.pipe, rest) :]


def received(data: bytearray) -> Iterator[tuple[Topic, list[str]]]:
    """Cut the messages that are complete off the bytes that have come out of the pipe.

    >>> data = bytearray(b"M" + bytes(7) + b"\\x04" + b"500MB")
    >>> list(received(data)), data
    ([(<Topic.MEMORY: b'M'>, ['500M'])], bytearray(b'B'))
    """
    while len(data) >= _HEAD:
        end = _HEAD + int.from_bytes(data[1:_HEAD], "big")
        if len(data) < end:
            return
        topic, body = Topic(bytes(data[:1])), data[_HEAD:end].decode("utf-8", "surrogateescape")
        del data[:end]
        yield topic, body.split("\0")


def remove(folder: str | os.PathLike[str]) -> None:
    """Remove a folder in which there are files alone; what else lies in it is not ours."""
    for name in os.listdir(folder):
        os.unlink(os.path.join(folder, name))
    os.rmdir(folder)


@contextmanager
def undisturbed() -> Iterator[None]:
    """A few steps between which no signal gets in, except one that cannot be blocked."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    try:
        signal.pthread_sigmask(
            signal.SIG_BLOCK, signal.valid_signals()
        )  # a handler of one before may raise here
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
