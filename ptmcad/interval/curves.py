"""The curves of a slice at which counts change, as systems whose solutions project to them.

Guarantee: each point of the window at which the chosen count changes lies on the projection of one of the curves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ptmcad.interval.formula import Graph
from ptmcad.interval.parameters import slice_mechanism
from ptmcad.interval.search import Boxes
from ptmcad.interval.system import System, system
from ptmcad.slice import Count, Slice

TORUS = (-3.0, -3.0 + 6.2832)
"""A little more than a full turn, cut where no symmetric solution lies."""


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One curve: its name and the system that defines it; the boxes' variables are x, y and those that ``ranges`` gives."""

    name: str
    system: System
    ranges: tuple[tuple[float, float], ...]

    def start(self, window: Boxes) -> Boxes:
        """Boxes over rectangles (low x, low y, high x, high y) of the window that hold the whole curve over them."""
        count = len(window)
        low = np.tile(np.array([r[0] for r in self.ranges]), (count, 1))
        high = np.tile(np.array([r[1] for r in self.ranges]), (count, 1))
        return np.concatenate([window[:, :2], low, window[:, 2:], high], axis=1)


def curves(slice: Slice, count: Count) -> tuple[Curve, ...]:
    """The curves at which ``count`` may change."""
    graph = Graph()
    m = slice_mechanism(graph, slice)
    there = m.at_equilibrium
    fold = system(
        [*m.equilibrium, m.hessian.determinant],
        (0, 1, 2, 3),
        (m.dependent, [there.determinant]),
        [there.p11, there.p22],
    )
    return (Curve("fold of a stable equilibrium", fold, (TORUS, TORUS)),)
