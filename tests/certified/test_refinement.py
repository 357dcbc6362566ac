"""Refinement of enclosures: where there is nothing to enclose, and where an exception breaks into
any statement.
"""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

pytest.importorskip("numba")

import ptmcad
from ptmcad.certified import refinement
from ptmcad.certified.equationsystem import system
from ptmcad.certified.refinement import CriticalCurve, CurveEnclosure, begin, refine
from ptmcad.formulas.graph import Graph

ANGLES = np.linspace(0.1, 3.1, 97)
ON_THE_CIRCLE = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)


def circle(monkeypatch: pytest.MonkeyPatch) -> list[CurveEnclosure]:
    """A half of the unit circle, in tasks so small that a level has several of them."""
    monkeypatch.setattr(refinement, "BUDGET", 24)
    monkeypatch.setattr(refinement, "BATCH", 4)
    graph = Graph()
    line = graph.variable(0).squared() + graph.variable(1).squared() - graph.constant(1)
    curve = CriticalCurve("circle", "of radius 1", system([line], (0, 1)), (), np.ones(2))
    return begin([curve], np.array([[x, 0.0, x + 0.5, 1.0] for x in np.arange(-1, 1, 0.5)]))


def lost(enclosures: list[CurveEnclosure]) -> int:
    """How many points of the circle are in no box."""
    boxes = enclosures[0].boxes()
    inside = (boxes[:, None, :2] <= ON_THE_CIRCLE) & (boxes[:, None, 2:] >= ON_THE_CIRCLE)
    return int((~inside.all(axis=2).any(axis=0)).sum())


def broken_at(statement: int, enclosures: list[CurveEnclosure]) -> bool:
    """Refine once, with a KeyboardInterrupt before so many statements of the module are done;
    whether it came.
    """
    left = statement

    def trace(frame: FrameType, event: str, _argument: Any) -> Any:
        nonlocal left
        if Path(frame.f_code.co_filename) != Path(refinement.__file__):
            return None
        if event == "line":
            left -= 1
            if left == 0:
                raise KeyboardInterrupt
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        refine(enclosures, 1e-2, 1, None)
    except KeyboardInterrupt:
        return True
    finally:
        sys.settrace(before)
    return False


def test_an_exception_at_any_statement_loses_no_box(monkeypatch: pytest.MonkeyPatch) -> None:
    """As a signal's handler raises it, or a lack of memory. What was left goes on to the same end."""
    statement = 0
    while True:
        statement += 1
        enclosures = circle(monkeypatch)
        came = broken_at(statement, enclosures)
        assert lost(enclosures) == 0, statement
        if not came:
            break
    assert statement > 60
    enclosures = circle(monkeypatch)
    assert broken_at(50, enclosures)
    assert refine(enclosures, 1e-2, 1, None)
    assert lost(enclosures) == 0


@pytest.mark.parametrize("times", [1, 2, 4])
def test_a_lack_of_threads_or_memory_loses_no_box(
    monkeypatch: pytest.MonkeyPatch, times: int
) -> None:
    enclosures = circle(monkeypatch)
    submit, calls = ThreadPoolExecutor.submit, []

    def failing(self: ThreadPoolExecutor, *arguments: Any) -> Any:
        calls.append(arguments)
        if len(calls) == times:
            raise RuntimeError("can't start new thread")
        return submit(self, *arguments)

    monkeypatch.setattr(ThreadPoolExecutor, "submit", failing)
    with pytest.raises(RuntimeError, match="thread"):
        refine(enclosures, 1e-3, 2, None)
    assert lost(enclosures) == 0


def test_a_search_that_is_to_end_says_so_and_has_all_boxes(monkeypatch: pytest.MonkeyPatch) -> None:
    for tasks in (0, 1, 2):
        enclosures = circle(monkeypatch)
        asked: list[int] = []

        def late(tasks: int = tasks, asked: list[int] = asked) -> bool:
            asked.append(1)
            return len(asked) > tasks

        assert not refine(enclosures, 1e-5, 1, None, late)
        assert len(asked) == tasks + 1
        assert lost(enclosures) == 0
        assert enclosures[0].number() == len(enclosures[0].boxes())
    assert refine(enclosures, 1e-5, 1, None, lambda: False)
    assert lost(enclosures) == 0


def test_a_window_that_no_curve_enters_is_one_region() -> None:
    """A quiet place of free02: every box is discarded, and nothing is undetermined."""
    slice = ptmcad.slice_from_options(
        slice="rho,L2",
        ranges=["rho=3/2:8/5", "L2=6/5:13/10"],
        sets=["l0=1/5", "F3=-10", "F4=-10"],
    )
    result = ptmcad.classify(slice, jobs=1)
    assert [region.stable for region in result.regions] == [1]
    assert result.undetermined == 0
    assert result.cover is not None and result.cover.rectangles == ()
