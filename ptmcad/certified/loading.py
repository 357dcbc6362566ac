"""All compiled code made ready: read from disk, or compiled where this machine has not done it yet.

Guarantee: after `load` nothing is compiled in this process any more, whatever the slice; so no compilation falls into
the time that a limit allows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ptmcad.certified.distinct import distinct
from ptmcad.certified.evaluation import program, run
from ptmcad.certified.formula import Graph
from ptmcad.certified.search import isolate
from ptmcad.certified.strips import areas_of_pieces, numbers_of_pieces, pieces, strips
from ptmcad.certified.system import System, system
from ptmcad.certified.tiling import COMPILED
from ptmcad.cover import components
from ptmcad.cover.rectangles import Cover

STEPS = 6
_done: list[bool] = []


def load(progress: Callable[[str, int, int], None] | None = None) -> None:
    """Use each compiled function once, on the line x = y, its point (1/2, 1/2) and a cover of one square.

    Parameters
    ----------
    progress : called as progress("compiling", done, total): with the first functions done after a second or so where
        they have to be compiled.
    """
    if _done:
        return
    for step, _ in enumerate(_functions(), start=1):
        if progress is not None:
            progress("compiling", step, STEPS)
    _done.append(True)


def _functions() -> Iterator[None]:
    """Those that compile fast come first, so that there is soon something to report."""
    weights = np.ones(2)
    square = np.array([[0.0, 0.0, 1.0, 1.0]])
    distinct(square, square, 0)
    yield
    line, point = _systems()
    low, high = np.empty((2, len(line.tape)))
    run(program(line.tape), square[0, :2], square[0, 2:], low, high, 0, len(line.tape))
    yield
    components(Cover(2, ((0, 1, 0, 1),)), COMPILED)
    yield
    thin = strips(line.arguments(), square)
    yield
    numbers_of_pieces(thin, 0.25)
    areas_of_pieces(thin, 0.25)
    pieces(thin, 0.25)
    yield
    isolate(point.arguments(), point.arguments(), square, (1e-3, 64, 4), weights)
    yield


def _systems() -> tuple[System, System]:
    graph = Graph()
    x, y = graph.variable(0), graph.variable(1)
    half = graph.constant(1) / 2
    return system([x - y], (0, 1)), system([x - half, y - half], (0, 1))
