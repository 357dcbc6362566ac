"""Paths of stable poses along a line, as data: how far each one can be followed, and where it snaps
to; and branches of all solutions, a bifurcation diagram of some quantities.

Guarantee: at each point of a branch the solutions are all there are, and each number is right in
every digit. Which points are on one branch is taken from their nearness, and no claim.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from ptmcad.answer import with_methods
from ptmcad.model import Model
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.numerals import Numbers


class Fate(Enum):
    """What happens to a stable pose at the end of its path."""

    WINDOW = "is stable up to the window's edge"
    SNAP = "vanishes, with a snap"
    MERGE = "goes on, without a snap"
    VANISH = "vanishes, and where it goes from there is not decided"
    UNSTABLE = "loses its stability"
    EXCLUDED = "leaves what the inequalities allow"
    UNDECIDED = "could not be followed further"


@dataclass(frozen=True, slots=True)
class PathPoint:
    """The unknowns at a value of the axis (angles not wrapped into one turn, so that they are
    continuous).

    ``sides`` tells of each point of a mechanism whose height an unknown changes whether it is
    proved to be above the x axis (1) or below (-1).
    """

    value: Fraction
    angles: tuple[Enclosure, ...]
    reals: tuple[Enclosure, ...] = ()
    sides: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Target:
    """The pose to which a state goes at a critical value: its unknowns at that value itself, and
    ``sides`` as above.
    """

    angles: tuple[Enclosure, ...]
    reals: tuple[Enclosure, ...] = ()
    sides: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class PathEnd:
    """One end of a path.

    Attributes
    ----------
    at : the critical value or the window's edge; of springs with free lengths an enclosure of the
        critical value.
    last : the last point of the path, close to ``at``.
    meeting : of the solutions on the path's side, the Morse indices (numbers of negative
        eigenvalues) of those that meet there, the path's own included; without a potential 0 for a
        stable one, and 1 for another.
    leaving : the same for those into which they go on beyond.
    energy : of the pose in which the path ends, at ``at`` itself; None where there is no target.
    target : the stable pose to which the mechanism goes, at ``at`` itself; None at the window's
        edge, and where the energy, of one value for each pose, does not tell it: under a moment it
        may turn for ever.
    target_energy : its energy, at ``at`` itself.
    among : whether it is proved that the pose vanishes together with one or more of the others in
        ``meeting``, and not with which of them.
    fallen : whether the target is one of several stable poses, which steepest descent in floating
        point chose.
    """

    fate: Fate
    at: AlgebraicNumber | Fraction | Enclosure
    last: PathPoint
    meeting: tuple[int, ...] = ()
    leaving: tuple[int, ...] = ()
    energy: Enclosure | None = None
    target: Target | None = None
    target_energy: Enclosure | None = None
    among: bool = False
    fallen: bool = False


@dataclass(frozen=True, slots=True)
class PosePath:
    """A stable pose followed in both directions.

    Attributes
    ----------
    number : of the pose at the start, counted from 1 in the order of ``ptmcad solve``.
    points : in increasing order of the axis, the start among them.
    upright : whether all moving points of the mechanism are proved to be above the x axis (of the
        paper's, y3 > 0 and y4 > 0) for all values between the first and the last point.
    reverse : whether all are proved to be below it.
    """

    number: int
    start: Fraction
    points: tuple[PathPoint, ...]
    low: PathEnd
    high: PathEnd
    upright: bool
    reverse: bool

    @classmethod
    def of(
        cls,
        number: int,
        start: Fraction,
        points: Iterable[PathPoint],
        ends: tuple[PathEnd, PathEnd],
        sides: Iterable[Sequence[int]],
    ) -> PosePath:
        """A path from its points and ends, and the sides of moving points: 1 above the x axis, -1
        below, else 0.
        """
        own = list(map(set, sides))
        upright, reverse = (all(here == {of} for here in own) for of in (1, -1))
        return cls(number, start, tuple(points), *ends, upright, reverse)

    def __repr__(self) -> str:
        ends = f"{self.low.fate.name.lower()} below, {self.high.fate.name.lower()} above"
        return f"<PosePath of pose {self.number} from {float(self.start):.6g}: {len(self.points)} points, {ends}>"


@with_methods
@dataclass(frozen=True, slots=True)
class PosePaths:
    """The paths of stable poses on a line; of all solutions where nothing says what a stable one
    is.

    Attributes
    ----------
    moved : the unknowns on which a moment or a force works somewhere on the line, so that no energy
        tells where a pose goes that vanishes.
    """

    name: str
    model: Model
    along: Axis
    at: Numbers
    start: Fraction
    paths: tuple[PosePath, ...]
    moved: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<PosePaths of {self.name} along {self.along.name}: {len(self.paths)} from {self.start}>"


@dataclass(frozen=True, slots=True)
class BranchPoint:
    """A solution at a value of the axis: the quantities, in their order; None for one that it does
    not have.
    """

    value: Fraction
    numbers: tuple[Enclosure | None, ...]


@dataclass(frozen=True, slots=True)
class Branch:
    """One solution between two critical values.

    Attributes
    ----------
    stable : None where nothing says what is stable.
    index : the number of negative eigenvalues; None without a potential.
    points : in increasing order of the axis.
    """

    stable: bool | None
    index: int | None
    points: tuple[BranchPoint, ...]


@dataclass(frozen=True, slots=True)
class Branches:
    """The answer of ``--quantity``.

    Attributes
    ----------
    quantities : their names as they were asked for.
    units : of each, as the record declares it or in words; empty for one that has none of its own.
    undecided : values of the axis at which not all solutions could be separated; there the
        branches have gaps.
    """

    name: str
    model: Model
    along: Axis
    at: Numbers
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    branches: tuple[Branch, ...]
    undecided: tuple[Fraction, ...] = ()
