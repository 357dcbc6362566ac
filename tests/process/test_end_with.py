"""A process ends with the one that holds its lifeline, whatever code it is in."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

BUSY = """
import sys
from ptmcad.process.handover import end_with
end_with(int(sys.argv[1]), int(sys.argv[2]))
print("begun", flush=True)
sum(range(10**13))  # C code that returns to no interpreter for days
"""


@pytest.mark.skipif(not hasattr(os, "O_ASYNC"), reason="pipes send no signals here")
def test_closing_the_lifeline_ends_c_code() -> None:
    read, write = os.pipe()
    process = subprocess.Popen(
        [sys.executable, "-c", BUSY, str(read), str(os.getpid())],
        stdout=subprocess.PIPE,
        pass_fds=(read,),
    )
    os.close(read)
    try:
        assert process.stdout is not None and process.stdout.readline() == b"begun\n"
        assert process.poll() is None
        os.close(write)
        assert process.wait(20) == -signal.SIGIO
    finally:
        process.kill()
        process.communicate()


def test_a_parent_that_is_gone_is_noticed() -> None:
    read, write = os.pipe()
    script = BUSY.replace("int(sys.argv[2])", "1 - int(sys.argv[2])")  # nobody's number
    words = [sys.executable, "-c", script, str(read), str(os.getpid())]
    found = subprocess.run(words, pass_fds=(read,), timeout=20, check=False)
    os.close(read)
    os.close(write)
    assert found.returncode == 1
