"""The command line under a limit of memory, each call in a process of its own that is forked from a
warm one.

An interpreter's start and its imports take some hundred times as long as the call itself. So they
are done once, in a process that has the limit already, has no thread, and does nothing else but
fork: every call begins in the same state, under the same limit, and what it spoils is gone with it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Self

ROOT = Path(__file__).resolve().parents[2]

_CODE = """
import json, os, resource, sys
resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[1]),) * 2)
from ptmcad.cli import run
requests, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "w")
# what the commands load where they are used; each refuses at once
for name in ("classify", "verify", "locate"):
    run([name, os.devnull, *(["--at", "x=1"] if name == "locate" else [])])
for line in requests:
    arguments, folder, out, err = json.loads(line)
    child = os.fork()
    if child == 0:
        status = 1
        try:
            os.chdir(folder)
            nothing = os.open(os.devnull, os.O_RDONLY)
            os.dup2(nothing, 0)
            for number, path in ((1, out), (2, err)):
                file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
                os.dup2(file, number)
            status = run(arguments)
            sys.stdout.flush()
            sys.stderr.flush()
        except BaseException:
            import traceback
            traceback.print_exc()
            sys.stderr.flush()
        finally:
            os._exit(status)
    _, status = os.waitpid(child, 0)
    print(os.waitstatus_to_exitcode(status), file=answers, flush=True)
"""


@dataclass(frozen=True, slots=True)
class Ended:
    """What a call has left."""

    status: int
    out: bytes
    err: bytes


class Limited:
    """A command line whose address space is limited to so many bytes.

    Parameters
    ----------
    memory : bytes of address space.
    folder : where the outputs of the calls are kept meanwhile.
    """

    def __init__(self, memory: int, folder: Path) -> None:
        self._out, self._err = folder / "out", folder / "err"
        self._process = subprocess.Popen(
            [sys.executable, "-c", _CODE, str(memory)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()

    def run(self, arguments: list[str], folder: Path) -> Ended:
        """The command line with these arguments in a folder."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        request = json.dumps([arguments, str(folder), str(self._out), str(self._err)])
        self._process.stdin.write(request.encode() + b"\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        assert answer, "the process that forks has ended"
        return Ended(int(answer), self._out.read_bytes(), self._err.read_bytes())
