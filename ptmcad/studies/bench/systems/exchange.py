"""What the process that measures and the one that has the engine tell each other; nothing is imported for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

Point = tuple[str, str]
"""Rational numbers as text, in the order of the slice's axes."""


class Question(NamedTuple):
    """A slice as the programs see it.

    Attributes
    ----------
    name : the slice's.
    axes : their names.
    facts : of the map, for the page; empty where there is none.
    system : the elimination system as text for msolve.
    unknowns : how many of its variables are to be eliminated, the first ones.
    points : where solutions are asked for: samples of cells, or at random where there is no map.
    at_points : the equations there, as text for msolve.
    qepcad, gcad : the finished curves for either; empty where there is no map.
    """

    name: str
    axes: tuple[str, str]
    facts: dict[str, int]
    system: str
    unknowns: int
    points: tuple[Point, ...]
    at_points: tuple[str, ...]
    qepcad: str
    gcad: str

    @property
    def variables(self) -> tuple[str, str]:
        """The axes' names in the elimination system."""
        first, second = self.system.splitlines()[0].split(",")[self.unknowns :]
        return first, second


class Answers(NamedTuple):
    """What was read of each program's last run; None where there is no answer.

    Attributes
    ----------
    solve, points : for each point, the JSON of ``ptmcad solve`` and msolve's text.
    curve : msolve's text.
    singular : factors.
    qepcad : samples, the base axis first.
    gcad : number of open cells.
    """

    solve: tuple[str, ...] | None = None
    points: tuple[str, ...] | None = None
    curve: str | None = None
    singular: Sequence[str] | None = None
    qepcad: Sequence[Point] | None = None
    gcad: int | None = None


class Check(NamedTuple):
    """Whether an answer is what ptmcad says, None where that is not told; and in words."""

    agrees: bool | None
    found: str
