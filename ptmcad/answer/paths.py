"""Paths of stable poses along a line, as data: how far each one can be followed, and where it snaps to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure


class Fate(Enum):
    """What happens to a stable pose at the end of its path."""

    WINDOW = "is stable up to the window's edge"
    SNAP = "vanishes and the mechanism snaps"
    MERGE = "merges with others into one stable pose, without a snap"
    UNDECIDED = "could not be followed further"


@dataclass(frozen=True, slots=True)
class PathPoint:
    """The pose's angles at a value of the axis (not wrapped into one turn, so that they are continuous)."""

    value: Fraction
    angles: tuple[Enclosure, Enclosure]


@dataclass(frozen=True, slots=True)
class PathEnd:
    """One end of a path.

    Attributes
    ----------
    at : the critical value or the window's edge.
    last : the last point of the path, close to ``at``.
    meeting : of the equilibria on the path's side, the Morse indices (numbers of negative eigenvalues) of those that
        meet there, the path's own included.
    leaving : the same for those into which they go on beyond.
    energy : of the pose at ``last``.
    target : the stable pose beyond, to which the mechanism goes, close to ``at``; None at the window's edge.
    target_energy : its energy.
    """

    fate: Fate
    at: AlgebraicNumber | Fraction
    last: PathPoint
    meeting: tuple[int, ...] = ()
    leaving: tuple[int, ...] = ()
    energy: Enclosure | None = None
    target: PathPoint | None = None
    target_energy: Enclosure | None = None


@dataclass(frozen=True, slots=True)
class PosePath:
    """A stable pose followed in both directions.

    Attributes
    ----------
    number : of the pose at the start, counted from 1 in the order of ``ptmcad solve``.
    points : in increasing order of the axis, the start among them.
    upright : whether y3 > 0 and y4 > 0 are proved for all values between the first and the last point.
    reverse : whether y3 < 0 and y4 < 0 are.
    """

    number: int
    start: Fraction
    points: tuple[PathPoint, ...]
    low: PathEnd
    high: PathEnd
    upright: bool
    reverse: bool


@dataclass(frozen=True, slots=True)
class PosePaths:
    """The paths of stable poses on a line."""

    name: str
    along: Axis
    at: Mapping[str, Fraction]
    start: Fraction
    paths: tuple[PosePath, ...]
