"""A curve of a slice at which counts change, as a system whose solutions project to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.search import Boxes
from ptmcad.certified.system import EquationSystem


@dataclass(frozen=True, slots=True, eq=False)
class CriticalCurve:
    """One curve: its name, why counts change there, and the system that defines it.

    The variables of its boxes are x, y and those that ``ranges`` gives.
    """

    name: str
    reason: str
    system: EquationSystem
    ranges: tuple[tuple[float, float], ...]
    weights: NDArray[np.float64] | None = None
    """Of the variables' widths in the choice which one to bisect; equal ones when None."""

    def importance(self) -> NDArray[np.float64]:
        """The weights of all variables."""
        return np.ones(2 + len(self.ranges)) if self.weights is None else self.weights

    def start(self, window: Boxes) -> Boxes:
        """Boxes over rectangles (low x, low y, high x, high y) of the window that hold the whole
        curve over them.
        """
        count = len(window)
        low = np.tile(np.array([r[0] for r in self.ranges]), (count, 1))
        high = np.tile(np.array([r[1] for r in self.ranges]), (count, 1))
        return np.concatenate([window[:, :2], low, window[:, 2:], high], axis=1)
