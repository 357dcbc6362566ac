"""What a computing process reports to the process that watches it: messages through a pipe, one way.

Guarantee: a message is received whole or not at all, also from a process that is killed while it sends. In a process
that nobody watches every function here does nothing.

It is imported before everything else of the program, so it imports nothing that takes time.
"""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum

LAST_SECONDS = 10.0
"""What a process that is asked to leave has at most for a last result, where it makes one."""
_HEAD = 9  # a topic's letter and the length of the body in 8 bytes


class Topic(Enum):
    """What a message is about, and the texts it consists of."""

    TEMPORARY = b"T"  # paths of hidden files that are about to be made, and that nothing needs once the process is gone
    RENAMES = b"R"  # the last file of a set about to be put into place, and that file's identity
    DEADLINE = b"D"  # reading of time.monotonic() at which the time is over, the limit in words
    MEMORY = b"M"  # the memory limit in bytes, in words, and "asked" or "default"
    LOADING = b"L"  # the libraries that are about to be loaded, or nothing when they are
    TARGET = b"F"  # path of the result file, names of the other files that are to be written
    RESULT = b"P"  # "partial" or "complete", the result's text as it is by now, and a remark on how far it is, or ""
    RESUMABLE = b"S"  # the results handed over can be gone on from: they are worth saving when a signal ends the work;
    # with the reason why there is none as long as none has been handed over; empty where a signal is the usual end
    WAITING = b"W"  # the folder on whose lock, which another process holds, this one has waited for some time
    PROGRESS = b"B"  # the progress bar stands in the terminal's line
    EXHAUSTED = b"X"  # memory has run out
    DONE = b"E"  # the program has come to its end and exits with its status


class _Sender:
    """The process's own end of the pipe, when it is watched."""

    pipe: int | None = None


class Leaving:
    """Whether this process has been asked to leave, by which signal: what its handler has raised may be lost.

    Code that C code calls, such as a callback of the collector, loses what is raised in it.
    """

    status: int | None = None

    @classmethod
    def check(cls) -> None:
        """Raise again what ends the process."""
        if cls.status is not None:
            raise SystemExit(cls.status)


def connect(pipe: int) -> None:
    """Send messages of this process into a pipe from now on."""
    _Sender.pipe = pipe


def disconnect() -> None:
    """Send nothing any more."""
    _Sender.pipe = None


def watched() -> bool:
    """Whether another process watches this one, and will act when it cannot."""
    return _Sender.pipe is not None


def send(topic: Topic, *texts: str) -> None:
    """Send a message, whole: what a signal's handler raises comes before it or after."""
    if _Sender.pipe is None:
        return
    body = "\0".join(texts).encode("utf-8", "surrogateescape")
    rest = memoryview(topic.value + len(body).to_bytes(_HEAD - 1, "big") + body)
    try:
        with undisturbed():
            while rest:
                rest = rest[os.write(_Sender.pipe, rest) :]
    except BrokenPipeError:
        os._exit(1)  # the watching process is gone, and this one has to go with it


class Receiver:
    """Bytes as they come out of the pipe, cut into messages."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def feed(self, data: bytes) -> Iterator[tuple[Topic, list[str]]]:
        """The messages that are complete with these bytes.

        >>> receiver = Receiver()
        >>> list(receiver.feed(b"M" + bytes(7) + b"\\x04" + b"50")), list(receiver.feed(b"0M" + b"B"))
        ([], [(<Topic.MEMORY: b'M'>, ['500M'])])
        """
        self._bytes += data
        while len(self._bytes) >= _HEAD:
            end = _HEAD + int.from_bytes(self._bytes[1:_HEAD], "big")
            if len(self._bytes) < end:
                return
            topic = Topic(bytes(self._bytes[:1]))
            body = bytes(self._bytes[_HEAD:end]).decode("utf-8", "surrogateescape")
            del self._bytes[:end]
            yield topic, body.split("\0")


def identity(path: str | os.PathLike[str]) -> str:
    """What distinguishes a file from all others wherever it is renamed to; empty when there is none."""
    try:
        found = os.lstat(path)
    except OSError:
        return ""
    return f"{found.st_dev}:{found.st_ino}:{found.st_size}:{found.st_mtime_ns}"


@contextmanager
def undisturbed() -> Iterator[None]:
    """A few steps between which no signal gets in, except one that cannot be blocked."""
    mask: Callable[..., set[int]] | None = getattr(signal, "pthread_sigmask", None)
    if mask is None:
        yield
        return
    before = mask(signal.SIG_BLOCK, ())
    try:
        mask(signal.SIG_BLOCK, signal.valid_signals())  # the handler of one that came before may raise here
        yield
    finally:
        mask(signal.SIG_SETMASK, before)
