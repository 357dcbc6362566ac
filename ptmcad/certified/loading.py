"""All compiled code made ready: read from disk, or compiled where this machine has not done it yet.

Guarantee: after `load` nothing is compiled in this process any more, whatever the slice; so no
compilation falls into the time that a limit allows. Processes that begin together on a new machine
compile once: one does, and the others wait for it.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

import numpy as np
from numba.core.event import Event, Listener, install_listener

from ptmcad.certified.boxstrips import areas_of_pieces, numbers_of_pieces, pieces, strips
from ptmcad.certified.branchandprune import isolate
from ptmcad.certified.equationsystem import EquationSystem, system
from ptmcad.certified.uniqueness import distinct
from ptmcad.formulas.compilation import FUNCTIONS, in_turn
from ptmcad.formulas.graph import Graph
from ptmcad.formulas.intervalarithmetic import run

STAGE = "compiling the certified engine, once on this machine:"
Progress = Callable[[str, int, int], None]
MIN_GARBAGE = 20_000
"""New objects between two collections while numba compiles, which makes millions that live: a
seventh of its time went into looking for garbage among them. More would gain nothing and take
memory."""

_done: list[bool] = []
"""Filled once all was made ready."""


def load(progress: Progress | None = None) -> float:
    """Use each compiled function once, on the line x = y, and its point (1/2, 1/2).

    Parameters
    ----------
    progress : called as progress(STAGE, done, total) with numbers of functions, as long as some
        have to be compiled.

    Returns
    -------
    The seconds that compiling took now, here or in a process that was waited for; 0 where all was
    read from disk, or had been loaded before.
    """
    if _done:
        return 0.0
    compiling = _Compiling(progress)
    with (
        install_listener("numba:compile", compiling),
        _fewer_collections(),
        in_turn("certified") as waited,
    ):
        _use_each()
    _done.append(True)
    return compiling.seconds + waited


@contextmanager
def _fewer_collections() -> Iterator[None]:
    """Without most of the garbage collector's rounds, unless a caller has switched it off or made
    them fewer yet.
    """
    youngest, *older = gc.get_threshold()
    gc.set_threshold(max(youngest, MIN_GARBAGE) if youngest else 0, *older)
    try:
        yield
    finally:
        gc.set_threshold(youngest, *older)


class _Compiling(Listener):
    """Follows numba while it compiles, and reports how many of the functions are there."""

    def __init__(self, progress: Progress | None) -> None:
        self.progress = progress
        self.seconds = 0.0
        self._depth = 0
        self._begun = 0.0

    def on_start(self, _event: Event) -> None:
        if self._depth == 0:
            self._begun = perf_counter()
        self._depth += 1
        self._report()

    def on_end(self, _event: Event) -> None:
        self._depth -= 1
        if self._depth == 0:
            self.seconds += perf_counter() - self._begun
        self._report()

    def _report(self) -> None:
        if self.progress is not None:
            self.progress(
                STAGE, sum(bool(function.overloads) for function in FUNCTIONS), len(FUNCTIONS)
            )


def _use_each() -> None:
    """Call all that Python calls, the fastest to compile first, so that there is soon something to
    report.
    """
    square = np.array([[0.0, 0.0, 1.0, 1.0]])
    line, point = _systems()
    distinct(square, square, 0, np.zeros(2))
    low, high = np.empty((2, len(line.tape)))
    run(line.tape.program, square[0, :2], square[0, 2:], low, high, 0, len(line.tape))
    thin = strips(line.arguments, square)
    numbers_of_pieces(thin, 0.25)
    areas_of_pieces(thin, 0.25)
    pieces(thin, 0.25)
    isolate(point.arguments, point.arguments, square, (1e-3, 64, 4), np.ones(2))


def _systems() -> tuple[EquationSystem, EquationSystem]:
    graph = Graph()
    x, y = graph.variable(0), graph.variable(1)
    half = graph.constant(1) / 2
    return system([x - y], (0, 1)), system([x - half, y - half], (0, 1))
