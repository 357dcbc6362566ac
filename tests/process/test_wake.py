"""The end of the child wakes the parent, at whatever moment it comes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LATE = """
import os, select, sys, time
wait4, waiting = os.wait4, select.select


def late(*given):
    found = wait4(*given)
    if not found[0]:
        time.sleep(0.03)  # so that the child ends between the question for it and what comes next
    return found


def woken(*given):
    ready = waiting(*given)
    if not any(ready):
        os._exit(99)  # nothing woke it
    return ready


os.wait4, select.select = late, woken
sys.argv = ["ptmcad", "check", "nowhere.yaml"]
from ptmcad.__main__ import main

main()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no processes are watched there")
def test_an_end_just_after_the_question_for_it_wakes_the_parent() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LATE], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2, done.stderr
    assert "nowhere.yaml" in done.stderr
