"""Work that depends on no clock: how many functions are called to answer a question of a stress
case.
"""

from __future__ import annotations

import gc
import sys

from ptmcad.studies.stress.campaign import answer
from ptmcad.studies.stress.case import Question


def work_of(question: Question) -> int:
    """Functions called, Python's and built in; not of the first answer in a process, which also
    loads modules.
    """
    answer(question)
    calls = 0

    def count(_frame: object, event: str, _argument: object) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    before, collecting = sys.getprofile(), gc.isenabled()
    gc.disable()  # what it calls, and when, depends on what else the process has made
    sys.setprofile(count)
    try:
        answer(question)
    finally:
        sys.setprofile(before)
        if collecting:
            gc.enable()
    return calls
