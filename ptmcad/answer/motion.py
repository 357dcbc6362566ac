"""The motion of one pose along a path of the map, through the falls where it vanishes, step by
step, in floating point.

Not guaranteed: more than `Step` says. Every step but those of a fall is an equilibrium, found by
Newton's method; where a step has counts, they are the map's own, or those of an exact solution
there, and as many different equilibria were found.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from ptmcad.answer import with_methods
from ptmcad.answer.regionmap import RegionMap

if TYPE_CHECKING:
    from typing import Any

Place = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class Step:
    """The pose at one moment.

    Attributes
    ----------
    share : of the path that is done.
    at : the point of the map.
    unknowns : angles in radians, not wrapped into one turn, then unknowns on the line.
    height : the energy less the work of moments; None where there is no energy.
    falling : whether this is no equilibrium, but a place on the steepest descent to one.
    total, stable : exact numbers of all and of stable equilibria; None where they are not known.
    points : places of a mechanism's points, in its order; none of a system.
    others : height of each equilibrium at this point, with whether it is stable; empty where they
        are not all known.
    """

    share: float
    at: Place
    unknowns: tuple[float, ...]
    height: float | None
    falling: bool = False
    total: int | None = None
    stable: int | None = None
    points: tuple[tuple[float, float], ...] = ()
    others: tuple[tuple[float, bool], ...] = ()


@dataclass(frozen=True, slots=True)
class Fall:
    """Where the pose vanishes, and to which it falls.

    Attributes
    ----------
    share : of the path, to 1e-7.
    at : the point of the map, in floating point.
    before, after : the unknowns of the pose that vanishes and of the one in which the descent ends.
    drop : by how much the height is lower there.
    """

    share: float
    at: tuple[float, float]
    before: tuple[float, ...]
    after: tuple[float, ...]
    drop: float


@with_methods
@dataclass(frozen=True, slots=True)
class Motion:
    """The motion of a pose along a path.

    Attributes
    ----------
    result : the map.
    path : its corners.
    pose : which one was followed, as it was asked for.
    steps : in their order, those of falls among them.
    falls : in their order.
    end : why it does not reach the path's end; empty where it does.
    """

    result: RegionMap
    path: tuple[Place, ...]
    pose: str
    steps: tuple[Step, ...]
    falls: tuple[Fall, ...]
    end: str = ""

    @property
    def counted(self) -> int:
        """The number of steps whose equilibria are all known."""
        return sum(bool(step.others) for step in self.steps)

    def __repr__(self) -> str:
        number = len(self.falls)
        falls = f"{number} fall" if number == 1 else f"{number} falls"
        return f"<Motion of {self.pose} over {self.result.slice.name}: {len(self.steps)} steps, {falls}>"

    if TYPE_CHECKING:  # `ptmcad.methods` has them

        def save(
            self,
            path: Any,
            *,
            fps: int = 20,
            size: Any = None,
            palette: Any = None,
            title: Any = None,
            dpi: int = 100,
        ) -> None: ...
