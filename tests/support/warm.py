"""Programs in processes of their own that begin after their imports: forked from one that has done
them.

For tests of what a process does once it runs, and how it ends: half of its time would go to imports
that are the same every time, and of random moments half would fall into them. A forked program is a
process like any other, with its own standard streams, and ends by the interpreter's own end.
"""

from __future__ import annotations

import atexit
import json
import os
import select
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]

_SERVER = """
import importlib, json, os, socket, sys
server = socket.socket(fileno=int(sys.argv[1]))
for name in sys.argv[2:]:
    importlib.import_module(name)
while True:
    data, files, _, _ = socket.recv_fds(server, 1 << 16, 2)
    if not data:
        os._exit(0)
    request = json.loads(data)
    if "poll" in request:
        child, status = os.waitpid(request["poll"], os.WNOHANG)
        server.send(json.dumps(os.waitstatus_to_exitcode(status) if child else None).encode())
        continue
    child = os.fork()
    os.setpgid(child, child)  # by both, so that it is done whoever comes first
    if child == 0:
        break
    for file in files:
        os.close(file)
    server.send(json.dumps(child).encode())
server.close()
for number, file in enumerate(files, 1):
    os.dup2(file, number)
    os.close(file)
sys.argv[1:] = request["arguments"]
exec(compile(request["program"], "<string>", "exec"), {"__name__": "__main__"})
"""


class Started:
    """A forked process, with what the tests use of `subprocess.Popen`; it leads a group of
    processes of its own.
    """

    def __init__(self, server: _Server, pid: int, out: int, err: int) -> None:
        self.pid = pid
        self.returncode: int | Any = None
        self._server = server
        self._open = {out: bytearray(), err: bytearray()}
        self._read = list(self._open.values())

    def poll(self) -> int | None:
        if self.returncode is None:
            self.returncode = self._server.ask({"poll": self.pid})
        return self.returncode

    def wait(self, timeout: float = 60) -> int:
        deadline = time.monotonic() + timeout
        while (status := self.poll()) is None:
            assert time.monotonic() < deadline, "the process does not end"
            time.sleep(0.003)
        return status

    def communicate(self, timeout: float = 60) -> tuple[bytes, bytes]:
        """What was printed, when the streams are closed and the process has ended."""
        deadline = time.monotonic() + timeout
        while self._open:
            ready, _, _ = select.select(
                list(self._open), [], [], max(0.0, deadline - time.monotonic())
            )
            assert ready, "the streams are not closed"
            for file in ready:
                data = os.read(file, 1 << 16)
                self._open[file] += data
                if not data:
                    os.close(file)
                    del self._open[file]
        self.wait(max(0.0, deadline - time.monotonic()))
        return bytes(self._read[0]), bytes(self._read[1])

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)


class _Server:
    def __init__(self, modules: Sequence[str]) -> None:
        self._socket, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with other:
            self._process = subprocess.Popen(
                [sys.executable, "-c", _SERVER, str(other.fileno()), *modules], cwd=ROOT, pass_fds=[other.fileno()],
                start_new_session=True,
            )  # fmt: skip
        atexit.register(self.close)

    def close(self) -> None:
        """It ends when the socket does."""
        self._socket.close()
        self._process.wait()

    def ask(self, request: dict[str, object], files: Sequence[int] = ()) -> int | None:
        socket.send_fds(self._socket, [json.dumps(request).encode()], list(files))
        answer: int | None = json.loads(self._socket.recv(100))
        return answer


@cache
def _server(modules: tuple[str, ...]) -> _Server:
    return _Server(modules)


def start(program: str, arguments: Sequence[str], modules: tuple[str, ...]) -> Started:
    """Run a program's text with these arguments, in the project's folder.

    Parameters
    ----------
    modules : what is imported already.
    """
    server = _server(modules)
    out, err = os.pipe(), os.pipe()
    pid = server.ask({"program": program, "arguments": list(arguments)}, (out[1], err[1]))
    os.close(out[1])
    os.close(err[1])
    assert pid is not None
    return Started(server, pid, out[0], err[0])
