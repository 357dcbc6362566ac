"""A slice as the exact engine reads it, and two of the engine's stages: its variety, and the counts
at samples. `exactmap` has the sequence of all stages.

Guarantee: no stage decides anything by rounding without an error bound.

Counts are made at every sample, or once for all cells that are proved to be joined off the variety.
The second way is about a quarter of the work, but does not check the decomposition as the first
does.
"""

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.real_roots import Window
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.answer.counts import counted_by
from ptmcad.errors import DegenerateSliceError, GeometryError, InfiniteSolutionsError
from ptmcad.exact.cad.decomposition import (
    Decomposition,
    Neighbours,
    Report,
    Sample,
    Variety,
    cut_along,
    members,
    seen_from,
    unreported,
)
from ptmcad.exact.counting import Equilibria, equilibria
from ptmcad.exact.discriminant_variety import Known, check_hypotheses, discriminant_variety
from ptmcad.exact.models import ParametricSystem, system_counted
from ptmcad.exact.models.system import SystemOnAxes, on_axes
from ptmcad.exact.point_system import DegeneratePoint
from ptmcad.model.involutions import Involution, involutions
from ptmcad.question.domain import proved
from ptmcad.question.slice import Slice, without_free_lengths
from ptmcad.text.flint_numbers import interval_of, to_fraction
from ptmcad.text.numerals import short_text


class SliceProblem(NamedTuple):
    """A slice as the stages read it.

    Attributes
    ----------
    on : its system, on the axes x and y.
    window : the ranges of x and y.
    known : what gives a family's knowledge of the equations, where the slice is of one.
    """

    slice: Slice
    on: SystemOnAxes
    window: Window
    known: Known | None = None

    @property
    def system(self) -> ParametricSystem:
        """The model's system, with all parameters symbolic."""
        return self.on.system

    @property
    def reflections(self) -> list[Involution]:
        """The involutions that map the window to itself and move some of its points; none where the
        count is by a predicate that symmetries do not keep.
        """
        slice, kind = self.slice, self.slice.count.kind
        if not kind.is_symmetric:
            return []
        first, second = ((axis.low, axis.high) for axis in slice.axes)
        return [
            c
            for c in involutions(
                slice.model, slice.parameters, (first, second), may_negate=kind.needs == "total"
            )
            if not c.keeps_points
        ]

    def place(self, at: Sample) -> str:
        """A point in words, for messages."""
        return ", ".join(
            f"{name} = {short_text(to_fraction(value))}"
            for name, value in zip(self.slice.axis_names, at, strict=True)
        )

    def solved_at(self, at: Sample) -> Equilibria:
        """The equilibria at a point off the variety; raises what `count_at` does."""
        return count_at(self.place(at), self.on, at)


class SampleCounts(NamedTuple):
    """The equilibria at each cell's sample, and the counts that distinguish regions."""

    found: tuple[Equilibria, ...]
    keys: tuple[tuple[int, ...], ...]


class Areas(NamedTuple):
    """Bounds of each region's area, written outwards in decimals, and the bits of precision that
    they needed.

    Attributes
    ----------
    change : the involution of which one half of the window was enough; None where the whole window
        was looked at.
    """

    bounds: tuple[tuple[Fraction, Fraction], ...]
    bits: int
    change: Involution | None = None


class Cells(NamedTuple):
    """The decomposition with its counts: what there is when only areas are missing."""

    cut: Decomposition
    counts: SampleCounts
    neighbours: Neighbours


def problem_without_free_lengths(slice: Slice, task: str) -> SliceProblem:
    """The problem of a slice, whose parameters are proved to have their signs.

    Parameters
    ----------
    task : with a verb: what is refused where springs have a free length.

    Raises
    ------
    ConfigError
        When springs have a free length, or a parameter has another sign.
    """
    without_free_lengths(slice.model, slice.parameters, task)
    return problem_of(proved(slice))


def problem_of(slice: Slice) -> SliceProblem:
    """The slice in the ring of the engine."""
    first, second = map(interval_of, slice.axes)
    return SliceProblem(
        slice, on_axes(system_counted(slice.model, slice.count), slice.parameters), (first, second)
    )


def variety_of(
    problem: SliceProblem, without: frozenset[str] = frozenset(), base: int | None = None
) -> Variety:
    """The variety, over a base axis.

    Parameters
    ----------
    without : names of savings to switch off, of `ptmcad.question.savings`.
    base : 0 or 1; that of the cheaper decomposition when None.

    Raises
    ------
    DegenerateSliceError, InfiniteSolutionsError
        When every point of the slice is exceptional, with one of them as a witness.
    """
    try:
        found = discriminant_variety(problem.on, problem.window, without, problem.known)
    except (DegenerateSliceError, InfiniteSolutionsError) as error:
        raise _explained(problem, error) from error
    if base is None and "axis-order" in without:
        base = 0
    return seen_from(*found, base)


def decomposition_of(
    problem: SliceProblem, base: int | None = None, check: Check = nothing
) -> Decomposition:
    """The window cut along the variety, over a base axis: variety, projection and stacks in one."""
    return cut_along(problem.window, variety_of(problem, base=base), check)


def prove_regular(problem: SliceProblem) -> None:
    """Prove that off some curves there are solutions, finitely many, and none is multiple.

    Raises
    ------
    DegenerateSliceError, InfiniteSolutionsError
        As `variety_of`.
    """
    try:
        check_hypotheses(problem.on)
    except (DegenerateSliceError, InfiniteSolutionsError) as error:
        raise _explained(problem, error) from error


def _explained(
    problem: SliceProblem, error: DegenerateSliceError | InfiniteSolutionsError
) -> DegenerateSliceError | InfiniteSolutionsError:
    """The error with its cause, where it is a loop that folds flat, and a point that shows it."""
    # what tells faults apart is loaded only where there is one
    from ptmcad.exact.witness import points, with_folds, with_witness

    found = with_folds(error, problem.slice.model, problem.on, points(problem.window))
    return (
        with_witness(error, problem.on, problem.window, problem.place) if found is error else found
    )


def counts_of(
    problem: SliceProblem, cut: Decomposition, report: Report = unreported
) -> SampleCounts:
    """The equilibria at every sample."""
    found = []
    for k, at in enumerate(cut.points):
        report(k, len(cut.points))
        found.append(problem.solved_at(at))
    return with_keys(problem, found)


def with_keys(problem: SliceProblem, found: Sequence[Equilibria]) -> SampleCounts:
    """The equilibria with the keys that distinguish regions."""
    count = problem.slice.count
    is_predicate = count.kind.predicate is not None
    keys = tuple((e.held,) if is_predicate else counted_by(e.counts, count) for e in found)
    assert (-1,) not in keys, "a count that the model does not have is refused before"
    return SampleCounts(tuple(found), keys)


def count_at(where: str, on: SystemOnAxes, at: Sequence[fmpq]) -> Equilibria:
    """The equilibria at a sample point, after a check that the geometry exists there.

    Parameters
    ----------
    where : the point in words, for messages.

    Raises
    ------
    GeometryError
        When a parameter is negative there, or zero where it must be positive.
    DegenerateSliceError
        When some equilibrium is singular there.
    """
    system, values = on.system, on.values(at)
    for name in (*system.positive, *system.nonnegative):
        if values[name] < 0 or (values[name] == 0 and name in system.positive):
            must = (
                "be positive in the whole window"
                if name in system.positive
                else "not be negative anywhere in the window"
            )
            raise GeometryError(
                f"{name} = {values[name]} at {where}, but it must {must}; "
                f"narrow the range or change {name}"
            )
    try:
        return equilibria(system, values)
    except DegeneratePoint as error:
        raise DegenerateSliceError(
            f"{error}, a point that should lie off the variety: the slice has a whole area of singular equilibria"
        ) from error


def counts_of_parts(
    problem: SliceProblem,
    cut: Decomposition,
    part_of: Sequence[int],
    report: Report = unreported,
) -> SampleCounts:
    """The counts of every cell, and the equilibria at one sample of each part, the sample with
    the shortest numbers.

    Parameters
    ----------
    part_of : of each cell, the connected part of the variety's complement, as in
        `joined_cells`.
    """
    found: dict[int, Equilibria] = {}
    parts = members(part_of)
    for k, cells in enumerate(parts):
        report(k, len(parts))
        first = min(cells, key=lambda n: _length(cut.points[n]))
        there = problem.solved_at(cut.points[first])
        for n in cells:
            found[n] = there if n == first else there._replace(solutions=())
    return with_keys(problem, [found[n] for n in range(len(cut.points))])


def _length(at: Sample) -> int:
    """How long a sample's numbers are."""
    return max(int(n).bit_length() for x in at for n in (x.p, x.q))
