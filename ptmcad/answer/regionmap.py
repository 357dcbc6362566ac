"""A region map: the result of a classification, independent of the engine that made it.

Guarantee: every number in it is exact or an enclosure; `RegionMap.from_json(result.to_json())`
gives an equal map.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from ptmcad.answer import with_methods
from ptmcad.answer.counts import Counted, MorseIndex
from ptmcad.question.slice import Point, Slice
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.plane import PlanePolynomial

if TYPE_CHECKING:
    from pandas import DataFrame

    from ptmcad.answer.boundaries import Boundary, Grid
    from ptmcad.answer.comparison import Comparison
    from ptmcad.answer.field import Field
    from ptmcad.answer.motion import Motion
    from ptmcad.cover.rectangles import Cover


class Status(Enum):
    """How far a result, or a point's answer, is proved; a PARTIAL result was stopped by a limit."""

    EXACT = "exact"
    CERTIFIED = "certified"
    PARTIAL = "partial"
    UNDECIDED = "undecided"
    ON_VARIETY = "on the variety"
    ON_EDGE = "on the window's edge"
    OUTSIDE = "outside the window"


class Kind(Enum):
    """Why a curve belongs to the variety: see `ptmcad.exact.discriminant_variety`. An AUXILIARY one does not: no
    count changes across it.

    AUXILIARY curves are there only when a saving that leaves them out was switched off
    (`ptmcad.question.savings`).
    """

    CRITICAL = "critical"
    INFINITY = "infinity"
    BOUNDARY = "boundary"
    AUXILIARY = "auxiliary"


class Continuum(Enum):
    """How many solutions there are on a curve of the variety on which they are not isolated.

    PROVED: at each of its points in the slice's domain. POSSIBLE: complex ones are, of real ones it
    is not decided.
    """

    PROVED = "infinitely many"
    POSSIBLE = "perhaps infinitely many"


NO_POINT = "no point in the window"
HARMLESS = "real solutions stay bounded and regular there"
"""Why a component is left out of the decomposition."""


class System(NamedTuple):
    """The exact equations, as text: polynomials over Q in the unknowns and the parameters.

    Attributes
    ----------
    unknowns : cosine and sine of each angle, in this order, then the real unknowns; the boxes of
        `Solution` are in these coordinates.
    relations : polynomials that vanish on the circles; of a certified map those that vanish where
        closed loops are closed, if springs have free lengths: solutions are the potential's
        critical points among such configurations.
    potential : energy, in units of force times length; empty where equations are given.
    gradient : the equations, whose common zeros are meant: of a potential its derivatives by the
        unknowns.
    hessian : their derivatives by the unknowns.
    inequalities, stability : what is positive at solutions that count, and at stable ones.
    moments : of a certified map, where some moment depends on another unknown than its own: what is
        taken off the potential's derivatives by the unknowns, in their order; empty elsewhere.
    """

    unknowns: tuple[str, ...]
    relations: tuple[str, ...]
    potential: str
    gradient: tuple[str, ...]
    hessian: tuple[tuple[str, ...], ...]
    inequalities: tuple[str, ...] = ()
    stability: tuple[str, ...] = ()
    moments: tuple[str, ...] = ()


class Component(NamedTuple):
    """An irreducible curve of the discriminant variety.

    Attributes
    ----------
    polynomial : primitive, in Z[x, y] for the axes in their order.
    left_out : empty when the decomposition uses the component, else the reason why it does not.
    separates : whether some wall on it separates two regions.
    continuum : whether solutions on it are not isolated; None where they are, or where that is not
        known.
    """

    polynomial: PlanePolynomial
    kind: Kind
    left_out: str = ""
    separates: bool = False
    continuum: Continuum | None = None


class CriticalValue(NamedTuple):
    """A critical value on the base axis: the only root of ``polynomial`` in [low, high];
    ``origin``: where from.

    ``polynomial`` holds integer coefficients, constant term first.
    """

    polynomial: tuple[int, ...]
    low: Fraction
    high: Fraction
    origin: str

    @property
    def number(self) -> AlgebraicNumber:
        return AlgebraicNumber(self.polynomial, self.low, self.high)


class Wall(NamedTuple):
    """Over its stack, the graph of the ``root``-th real root (from 0, in the window) of a
    component.
    """

    component: int
    root: int


class Stack(NamedTuple):
    """The cells over the open base interval between two consecutive critical values (or the
    window's edge).

    Attributes
    ----------
    left, right : numbers of the critical values, None at the window's edge.
    sample : rational abscissa of the stack's sample points.
    walls : from below.
    cells : numbers of its cells, from below; one more than walls.
    """

    left: int | None
    right: int | None
    sample: Fraction
    walls: tuple[Wall, ...]
    cells: tuple[int, ...]


class Solution(NamedTuple):
    """One equilibrium at a sample: the only one within ``radius`` of ``center`` in every unknown.

    Attributes
    ----------
    center : rational, in the order of the system's unknowns.
    signs : the signs of the Hessian's eigenvalues there, positive ones first, such as ``"+-"`` for
        a saddle; without a potential those of the conditions for stability in their order, ``0``
        where one is zero.
    """

    center: tuple[Fraction, ...]
    radius: Fraction
    signs: str


@dataclass(frozen=True, slots=True)
class Cell(Counted):
    """An open cell with its rational sample point and the counts there, which hold in the whole
    cell.

    In a certified map ``stack`` is None and the cell is the connected component of the cover's
    complement that holds its sample; ``level`` is its number. ``further`` is empty in an exact map
    that is by no predicate.

    ``solutions`` proves the counts: disjoint boxes, one around each of the real solutions at the
    sample. Empty when the counts were proved in another way.
    """

    stack: int | None
    level: int
    sample: Point
    region: int
    total: int | None
    stable: int | None
    index: MorseIndex | None
    solutions: tuple[Solution, ...] = ()
    further: Mapping[str, int] = field(default_factory=dict)

    def __repr__(self) -> str:
        at = ", ".join(f"{float(value):.6g}" for value in self.sample)
        return f"<Cell {_counts_in_words(self)}, in region {self.region}, sample near ({at})>"


def _counts_in_words(counts: Cell | Region) -> str:
    """What is known of the counts, in few words."""
    known = ((counts.stable, "stable"), (counts.total, "in all"))
    return (
        " of ".join(f"{number} {word}" for number, word in known if number is not None)
        or "of unknown count"
    )


class Merge(Enum):
    """What joins or parts two adjacent cells."""

    PROVEN = "proven"
    EQUAL_COUNT = "equal count"
    SEPARATED = "separated"


class Adjacency(NamedTuple):
    """Two cells that share an open arc.

    Attributes
    ----------
    merge : PROVEN when the arc is an artefact of the decomposition; EQUAL_COUNT when it lies on the
        variety and the counts on both sides are equal; SEPARATED when they differ.
    component : the variety's component that contains the arc; None when the arc is an artefact of
        the decomposition.
    segment : for cells of neighbouring stacks, (low, high, height): the open segment that joins
        them, free of all curves but a vertical line.
    """

    first: int
    second: int
    component: int | None
    segment: Segment | None
    merge: Merge


class Reason(Enum):
    """Why the half-branches between two segments, or a segment and the window's edge, run into one
    point at most of the line over a critical value.

    PAIR: there are two of them, and an even number runs into each inner point of the window.
    EDGE: there is a single one, so it ends on the window's edge.
    POINT: the curves have no two points in that part of the line.
    """

    PAIR = "two half-branches meet"
    EDGE = "a half-branch ends on the window's edge"
    POINT = "one point of the curves"


Segment = tuple[Fraction, Fraction, Fraction]
"""(low, high, height): the segment from low to high along the base axis, at a height on the other
axis.
"""


class NonAdjacency(NamedTuple):
    """Cells of two neighbouring stacks that are not adjacent although their order would allow it.

    Attributes
    ----------
    critical_value : number of the critical value between the stacks.
    left, right : numbers of consecutive cells, from below. No cell of ``left`` is adjacent to a
        cell of ``right`` but, where there is a segment ``below``, the first to the first, and where
        there is one ``above``, the last to the last.
    below, above : segments free of the curves between which these cells reach the critical value;
        None at the window's edge.
    """

    critical_value: int
    left: tuple[int, ...]
    right: tuple[int, ...]
    below: Segment | None
    above: Segment | None
    reason: Reason


@dataclass(frozen=True, slots=True)
class Region(Counted):
    """A maximal set of cells that are joined and have equal counts.

    Attributes
    ----------
    stable, total, index : None where it varies within the region (the chosen count does not tell
        it).
    area : certified lower and upper bound, in the product of the axes' units.
    cells : numbers of its cells.
    sample : a point of the region of small height.
    """

    stable: int | None
    total: int | None
    index: MorseIndex | None
    area: tuple[Fraction, Fraction]
    cells: tuple[int, ...]
    sample: Point
    further: Mapping[str, int] = field(default_factory=dict)

    def __repr__(self) -> str:
        area = f"{float(self.area[0]):.6g} to {float(self.area[1]):.6g}"
        return f"<Region {_counts_in_words(self)}, {len(self.cells)} cells, area {area}>"


@dataclass(frozen=True, slots=True)
class Location(Counted):
    """Where a point lies; region, cell and counts are None unless the point is decided and in a
    cell.

    A point on a curve that no count feels has counts of its own, and the region on both sides; it
    is in no cell.
    """

    status: Status
    region: int | None = None
    cell: int | None = None
    total: int | None = None
    stable: int | None = None
    index: MorseIndex | None = None
    further: Mapping[str, int] = field(default_factory=dict)
    remark: str = ""


class PlanStep(NamedTuple):
    """One decision of the plan: what, whether it is done or left out, and why.

    ``saving`` is the name in `ptmcad.question.savings` of the saving that was made when the step is
    left out, and switched off when it is done; empty for other steps.
    """

    what: str
    done: bool
    reason: str
    saving: str = ""

    def __str__(self) -> str:
        return f"{'computed' if self.done else 'left out'}: {self.what} ({self.reason})"


@with_methods
@dataclass(frozen=True, slots=True, repr=False, kw_only=True)
class RegionMap:
    """The answer to a `Slice`; what is not given is what a certified map or a partial one does not
    have.

    Attributes
    ----------
    base : the axis (0 or 1) over which the stacks stand.
    undetermined : fraction of the window's area that is not decided; 0 for the exact engine.
    complex_solutions : number of complex solutions at a generic point.
    precision : largest number of bits that signs of Hessians and areas needed.
    timings : seconds by stage; not part of equality.
    cover : what a certified map leaves open, None in an exact map. A certified map has no
        components, critical values and stacks; its cells are the connected components of the
        cover's complement in the open window.
    """

    slice: Slice
    status: Status
    system: System
    base: int = 0
    complex_solutions: int = 0
    components: tuple[Component, ...] = ()
    critical_values: tuple[CriticalValue, ...] = ()
    stacks: tuple[Stack, ...] = ()
    cells: tuple[Cell, ...] = ()
    adjacencies: tuple[Adjacency, ...] = ()
    non_adjacencies: tuple[NonAdjacency, ...] = ()
    regions: tuple[Region, ...] = ()
    plan: tuple[PlanStep, ...] = ()
    undetermined: Fraction
    versions: Mapping[str, str]
    precision: Mapping[str, int] = field(default_factory=dict)
    timings: Mapping[str, float] = field(default_factory=dict, compare=False)
    cover: Cover | None = None

    def __str__(self) -> str:
        return self.table()

    @property
    def only_stable(self) -> bool:
        """Whether the stable solutions alone are known, as in certified maps that count these."""
        return any(
            cell.total is None or len(cell.solutions) < cell.total
            for cell in self.cells
            if cell.solutions
        )

    @property
    def continua(self) -> dict[int, Continuum]:
        """The components on which solutions are not isolated, by number."""
        return {n: c.continuum for n, c in enumerate(self.components) if c.continuum is not None}

    def __repr__(self) -> str:
        return f"<RegionMap {self.slice.name}: {len(self.regions)} regions, {self.status.value}>"

    if TYPE_CHECKING:  # `ptmcad.methods` has them

        def locate(self, point: Any = None, /, **at: Any) -> Location: ...

        def to_json(self, timings: bool = True) -> str: ...

        @classmethod
        def from_json(cls, text: str) -> RegionMap: ...

        def table(self) -> str: ...

        def boundaries(self, tolerance: Any = "1/1000") -> tuple[Boundary, ...]: ...

        def grid(self, columns: int = 200, rows: int | None = None) -> Grid: ...

        def field(
            self,
            value: str = "energy",
            pose: str = "stable:1",
            columns: int = 400,
            rows: int | None = None,
        ) -> Field: ...

        def to_dataframe(self, what: str = "regions", **options: Any) -> DataFrame: ...

        def compare(self, other: RegionMap) -> Comparison: ...

        def animate(self, path: Any, pose: str = "stable:1", frames: int = 90) -> Motion: ...

        def explore(self) -> Any: ...

        def plot(
            self,
            ax: Any = None,
            style: Any = "default",
            *,
            samples: bool = False,
            dpi: int = 150,
            **options: Any,
        ) -> Any: ...


COMPILATION = "compilation"
"""The timing, besides those of stages, of what was compiled before the computation: once on a
machine.
"""


def with_compilation(result: RegionMap, seconds: float) -> RegionMap:
    """The map with the seconds that its run has spent compiling, if any, besides its own."""
    return replace(result, timings={**result.timings, COMPILATION: seconds}) if seconds else result
