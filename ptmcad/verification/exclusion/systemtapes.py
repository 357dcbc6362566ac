"""A system of equations and signs in axes and unknowns, as a tape of operations, and in the arrays that
the compiled search takes.

Guarantee: what is left out of a system only makes its solutions more.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ptmcad.verification.exclusion.forms import IntervalTape, tape_of
from ptmcad.verification.normalform.boxes import Floats
from ptmcad.verification.normalform.operations import Formulas


class Compiled(NamedTuple):
    """What is zero at critical points, and what is not negative there, by the numbers of values of
    a tape.

    Attributes
    ----------
    early : how many of ``zero`` are known after the first operations, ``first`` many.
    measured : the values by which the variable to halve is chosen.
    units : of each variable a length that is large.
    least : of each variable; a box that is narrower in all of them is not halved.
    halved : the first variable along which boxes are halved: 0, or 2 where the window's are only
        looked at.
    """

    tape: IntervalTape
    zero: Any
    not_negative: Any
    measured: Any
    early: int
    first: int
    units: Any
    least: Any
    halved: int


@dataclass(frozen=True)
class CriticalSystem:
    """A system in lattice steps of both axes and in its unknowns.

    Attributes
    ----------
    zeros, signs : the numbers of the formulas that are zero, and of those that are not negative.
    early : how many of ``zeros`` are evaluated before all others.
    start : (variables, 2), a box that has all solutions over the window.
    """

    name: str
    formulas: Formulas
    zeros: tuple[int, ...]
    signs: tuple[int, ...]
    early: int
    start: Any

    @cached_property
    def _tape(self) -> tuple[IntervalTape, int, list[int]]:
        """The operations, how many of them the first formulas need, and the places of all."""
        later = (*self.zeros[self.early :], *self.signs)
        return tape_of(self.formulas, self.zeros[: self.early], later)

    @property
    def measured(self) -> int:
        """How many of the formulas that are zero choose the variable to halve; over a place one
        less.
        """
        return len(self.start) - 1

    def with_some(self, chosen: Any) -> CriticalSystem:
        """The same without some of its formulas.

        Parameters
        ----------
        chosen : for each formula that is zero, and then for each that is not negative, whether it
            is kept; the first ones are.
        """
        chosen = chosen | (np.arange(len(chosen)) < max(self.early, self.measured))
        number = len(self.zeros)
        zeros, signs = (
            tuple(n for n, kept in zip(some, which, strict=True) if kept)
            for some, which in ((self.zeros, chosen[:number]), (self.signs, chosen[number:]))
        )
        return replace(self, zeros=zeros, signs=signs)

    def compiled(self, smallest: float, halves: Floats | None = None) -> Compiled:
        """In arrays, to be looked at over boxes of the window that are wider than a share of it.

        Parameters
        ----------
        halves : of one box of the window instead, and of boxes of the unknowns that are wider than
            a share of all: half the widths of these.
        """
        units, over_place = self.start[:, 1] - self.start[:, 0], halves is not None
        if halves is not None:
            units[2:] = [2 * half for half in halves]
        least = np.where((np.arange(len(units)) < 2) != over_place, smallest * units, np.inf)
        tape, first, places = self._tape
        place, number = np.array(places, dtype=np.int64), len(self.zeros)
        zero, not_negative = place[:number], place[number:]
        measured = zero[: self.measured - over_place]
        return Compiled(
            tape, zero, not_negative, measured, self.early, first, units, least, 2 * over_place
        )
