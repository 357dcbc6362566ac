"""The stages of the exact engine, each a function of what it needs to a result with a name.

Guarantee: no stage decides anything by rounding without an error bound, and none looks at a later one.

    SliceProblem -> Variety -> Projection -> Stacks -> SampleCounts -> Neighbours -> Areas
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import islice, pairwise
from typing import NamedTuple, TypeVar

from flint import fmpq

from ptmcad.algebra.polynomials import Coefficient, Ratio, UnivariatePolynomial, from_expression, point_values
from ptmcad.algebra.real_roots import Interval, RealRoot, sign_at
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.answer.counts import Counts
from ptmcad.answer.regionmap import HARMLESS, Adjacency, Component, Merge, Segment
from ptmcad.errors import DegenerateSliceError, GeometryError, InfiniteSolutionsError
from ptmcad.exact.cad.adjacency import Crossing, Separator, cross
from ptmcad.exact.cad.curves import FibredCurve, curves_of, lines_of
from ptmcad.exact.cad.projection import Projection, predicted_cost, project
from ptmcad.exact.cad.stacks import Avoided, StackData, level_at, lift
from ptmcad.exact.counting import Equilibria, equilibria
from ptmcad.exact.models import ParametricSystem, system_counted
from ptmcad.exact.point_system import DegeneratePoint
from ptmcad.exact.regions import Link, merge
from ptmcad.exact.variety import Known, check_hypotheses, discriminant_variety
from ptmcad.model.involutions import Involution, involutions
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.numerals import short_text

_T = TypeVar("_T")
Sample = tuple[fmpq, fmpq]
Report = Callable[[int, int], None]
"""Called as report(done, total); may raise to stop."""


def unreported(_done: int, _total: int) -> None:
    """The report that nobody asked for."""


class SliceProblem(NamedTuple):
    """A slice as the stages read it.

    Attributes
    ----------
    parameters : each parameter as a ratio of polynomials in Z[x, y].
    window : the ranges of x and y.
    known : what is known of the equations from a family that the slice is of.
    """

    slice: Slice
    system: ParametricSystem
    parameters: dict[str, Ratio]
    window: tuple[Interval, Interval]
    known: Known | None = None

    @property
    def area(self) -> Fraction:
        """Of the window."""
        first, second = self.slice.axes
        return (first.high - first.low) * (second.high - second.low)

    @property
    def reflections(self) -> list[Involution]:
        """The involutions that map the window to itself and move some of its points."""
        slice = self.slice
        first, second = ((axis.low, axis.high) for axis in slice.axes)
        return [c for c in involutions(slice.model, slice.parameters, (first, second)) if not c.keeps_points]

    def place(self, at: Sample) -> str:
        """A point in words, for messages."""
        return ", ".join(
            f"{name} = {short_text(to_fraction(value))}" for name, value in zip(self.slice.axis_names, at, strict=True)
        )

    def solved_at(self, at: Sample) -> Equilibria:
        """The equilibria at a point off the variety; raises what `count_at` does."""
        return count_at(self.place(at), self.system, self.parameters, at)


class Variety(NamedTuple):
    """The discriminant variety as seen from the base axis.

    Attributes
    ----------
    curves : the components that are used, but for lines across the base.
    lines : these, by the components' numbers.
    costs : predicted for each of the two base axes.
    excludes : whether solutions at which an inequality's polynomial is zero were left out, as they are in the way.
    """

    components: tuple[Component, ...]
    complex_solutions: int
    base: int
    curves: Sequence[FibredCurve]
    lines: dict[int, UnivariatePolynomial]
    costs: tuple[int, int]
    excludes: bool = False


class Stacks(NamedTuple):
    """The stacks over the base, and the sample of every cell, stack by stack from below."""

    stacks: tuple[StackData, ...]
    points: tuple[Sample, ...]

    def rows(self, values: Iterable[_T]) -> list[tuple[_T, ...]]:
        """What there is for every cell, as a row for each stack."""
        numbers = iter(values)
        return [tuple(islice(numbers, len(stack.heights))) for stack in self.stacks]


class SampleCounts(NamedTuple):
    """The equilibria at each cell's sample, and the counts by which regions are told apart."""

    found: tuple[Equilibria, ...]
    keys: tuple[tuple[int, ...], ...]


class Neighbours(NamedTuple):
    """What separates the cells and what does not.

    Attributes
    ----------
    crossings : between neighbouring stacks.
    adjacencies : all pairs of cells with an open arc in common.
    region_of : the region of each cell.
    """

    crossings: tuple[Crossing, ...]
    adjacencies: tuple[Adjacency, ...]
    region_of: tuple[int, ...]


class Areas(NamedTuple):
    """Bounds of each region's area, written outwards in decimals, and the bits of precision that they needed.

    Attributes
    ----------
    change : the involution of which one half of the window was enough; None where the whole window was looked at.
    """

    bounds: tuple[tuple[Fraction, Fraction], ...]
    bits: int
    change: Involution | None = None


class Cells(NamedTuple):
    """The decomposition with its counts: what there is when only areas are missing."""

    projection: Projection
    stacks: Stacks
    counts: SampleCounts
    neighbours: Neighbours


def problem_of(slice: Slice) -> SliceProblem:
    """The slice in the ring of the engine."""
    system = system_counted(slice.model, slice.count)
    parameters = {name: from_expression(slice.parameters[name]) for name in system.ring.parameters}
    first, second = ((from_fraction(a.low), from_fraction(a.high)) for a in slice.axes)
    return SliceProblem(slice, system, parameters, (first, second))


def variety_of(problem: SliceProblem, without: frozenset[str] = frozenset(), base: int | None = None) -> Variety:
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
    system, parameters, window = problem.system, problem.parameters, problem.window
    try:
        found = discriminant_variety(
            system, parameters, window, domain_limits(system, parameters), without, problem.known
        )
    except (DegenerateSliceError, InfiniteSolutionsError) as error:
        raise _explained(problem, error) from error
    views = [curves_of(found.components, base) for base in (0, 1)]
    costs = (predicted_cost(views[0]), predicted_cost(views[1]))
    if base is None:
        base = 1 if costs[1] < costs[0] and "axis-order" not in without else 0
    lines = lines_of(found.components, base)
    return Variety(found.components, found.complex_solutions, base, views[base], lines, costs, found.excludes)


def prove_regular(problem: SliceProblem) -> None:
    """Prove that off some curves there are solutions, finitely many, and none is multiple.

    Raises
    ------
    DegenerateSliceError, InfiniteSolutionsError
        As `variety_of`.
    """
    system, parameters = problem.system, problem.parameters
    try:
        check_hypotheses(system, parameters)
    except (DegenerateSliceError, InfiniteSolutionsError) as error:
        raise _explained(problem, error) from error


def _explained(
    problem: SliceProblem, error: DegenerateSliceError | InfiniteSolutionsError
) -> DegenerateSliceError | InfiniteSolutionsError:
    """The error with its cause, where it is a loop that folds flat, and a point that shows it."""
    system, parameters, window = problem.system, problem.parameters, problem.window
    # what tells faults apart is loaded only where there is one
    from ptmcad.exact.folds import with_folds
    from ptmcad.exact.witness import points, with_witness

    told = with_folds(error, problem.slice.model, system, parameters, points(window))
    return with_witness(error, system, parameters, window, problem.place) if told is error else told


def domain_limits(system: ParametricSystem, parameters: Mapping[str, Ratio]) -> list[Coefficient]:
    """What bounds the slice's domain: lengths and stiffnesses that vary, and the parameters' denominators."""
    names = (*system.positive, *system.nonnegative)
    limits = [*(parameters[name][0] for name in names), *(below for _, below in parameters.values())]
    return [limit for limit in limits if not limit.is_constant()]


def projection_of(
    problem: SliceProblem, variety: Variety, without: frozenset[str] = frozenset(), check: Check = nothing
) -> Projection:
    """The abscissae over which the order of the curves can change."""
    window, base = problem.window, variety.base
    return project(variety.curves, list(variety.lines.values()), window[base], window[1 - base], check, without)


def stacks_of(problem: SliceProblem, variety: Variety, projection: Projection) -> Stacks:
    """The stacks between them, with samples."""
    window, base = problem.window, variety.base
    # there real solutions stay regular but complex ones are lost, and a fibre may not be finite
    lines = lines_of(variety.components, base, HARMLESS)
    avoided = Avoided(curves_of(variety.components, base, HARMLESS), list(lines.values()))
    stacks = lift(variety.curves, projection.abscissae, window[base], window[1 - base], avoided)
    points = (((s.sample, height) if base == 0 else (height, s.sample)) for s in stacks for height in s.heights)
    return Stacks(stacks, tuple(points))


def decomposition_of(
    problem: SliceProblem, base: int | None = None, check: Check = nothing
) -> tuple[Variety, Projection, Stacks]:
    """The window cut along the variety, over a base axis: the first stages in one."""
    variety = variety_of(problem, base=base)
    projection = projection_of(problem, variety, check=check)
    return variety, projection, stacks_of(problem, variety, projection)


def counts_of(problem: SliceProblem, stacks: Stacks, report: Report = unreported) -> SampleCounts:
    """The equilibria at every sample."""
    found = []
    for k, at in enumerate(stacks.points):
        report(k, len(stacks.points))
        found.append(problem.solved_at(at))
    return with_keys(problem, found)


def with_keys(problem: SliceProblem, found: Sequence[Equilibria]) -> SampleCounts:
    """The equilibria with what tells regions apart."""
    count = problem.slice.count
    is_predicate = count.kind.predicate is not None
    keys = ((e.held,) if is_predicate else count_key(e.counts, count) for e in found)
    return SampleCounts(tuple(found), tuple(keys))


def count_key(counts: Counts, count: Count) -> tuple[int, ...]:
    """The count by which regions are told apart."""
    known = counts.number(count)
    return (counts.total,) if known is None else known if isinstance(known, tuple) else (known,)


def crossings_of(
    problem: SliceProblem, variety: Variety, stacks: Stacks, report: Report = unreported, check: Check = nothing
) -> tuple[Crossing, ...]:
    """What is adjacent across each abscissa, with proof."""
    fibre, crossings = problem.window[1 - variety.base], []
    for k, (left, right) in enumerate(pairwise(stacks.stacks)):
        report(k, len(stacks.stacks) - 1)
        crossings.append(cross(variety.curves, left, right, fibre, check))
    return tuple(crossings)


def neighbours_of(
    variety: Variety,
    projection: Projection,
    stacks: Stacks,
    counts: SampleCounts,
    crossings: tuple[Crossing, ...],
) -> Neighbours:
    """The adjacencies, and the cells merged into regions.

    Raises
    ------
    ArithmeticError
        When the counts contradict the decomposition.
    """
    adjacencies = tuple(adjacencies_of(stacks.stacks, crossings, lines_across(variety, projection), counts.keys))
    region_of = merge(counts.keys, [Link(a.first, a.second, a.component) for a in adjacencies])
    return Neighbours(crossings, adjacencies, region_of)


def lines_across(variety: Variety, projection: Projection) -> list[int | None]:
    """The component that is a line over each abscissa, if one is."""
    lines = {_coefficients(p): n for n, p in variety.lines.items()}
    return [lines.get(_coefficients(r.polynomial)) for r in projection.abscissae]


def adjacencies_of(
    stacks: Sequence[StackData],
    crossings: Sequence[Crossing],
    across: Sequence[int | None],
    keys: Sequence[tuple[int, ...]],
) -> Iterator[Adjacency]:
    """Pairs of cells within each stack, and then with the next one.

    Parameters
    ----------
    across : the component that is a line over each abscissa, if one is.
    """

    def link(first: int, second: int, component: int | None, segment: Segment | None) -> Adjacency:
        if component is None:
            kind = Merge.PROVEN
        else:
            kind = Merge.EQUAL_COUNT if keys[first] == keys[second] else Merge.SEPARATED
        return Adjacency(first, second, component, segment, kind)

    first = 0
    for s, stack in enumerate(stacks):
        for level, wall in enumerate(stack.walls):
            yield link(first + level, first + level + 1, wall.component, None)
        following = first + len(stack.heights)
        if s < len(crossings):
            for p in crossings[s].separators:
                yield link(first + p.left, following + p.right, across[s], segment_of(p))
        first = following


def segment_of(separator: Separator) -> Segment:
    """The open segment that proves a separator."""
    return (to_fraction(separator.low), to_fraction(separator.high), to_fraction(separator.height))


def cell_at(problem: SliceProblem, variety: Variety, known: tuple[Projection, Stacks], at: Sample) -> int | None:
    """The cell in which a point of the window lies; None on the curves, and on lines over critical abscissae."""
    projection, stacks = known
    u, v = at[variety.base], at[1 - variety.base]
    place = 0
    for r in projection.abscissae:
        if r.low <= u <= r.high and sign_at(r.polynomial, u) == 0:
            return None
        place += _is_below(r, u)
    if any(sign_at(c.fibre(u), v) == 0 for c in variety.curves):
        return None
    first = sum(len(stack.heights) for stack in stacks.stacks[:place])
    return first + level_at(variety.curves, u, v, problem.window[1 - variety.base])


def _is_below(root: RealRoot, u: fmpq) -> bool:
    """Whether a root, which is not u, is less than u."""
    if not root.low < u < root.high:
        return bool(u >= root.high)
    return sign_at(root.polynomial, u) == sign_at(root.polynomial, root.high)


def count_at(where: str, system: ParametricSystem, parameters: Mapping[str, Ratio], at: Sequence[fmpq]) -> Equilibria:
    """The equilibria at a sample point, after a check that the geometry exists there.

    Parameters
    ----------
    where : the point in words, for messages.

    Raises
    ------
    GeometryError
        When a length or stiffness is not positive there.
    DegenerateSliceError
        When some equilibrium is singular there.
    """
    values = point_values(parameters, at)
    for name in (*system.positive, *system.nonnegative):
        if values[name] < 0 or (values[name] == 0 and name in system.positive):
            raise GeometryError(
                f"{name} = {values[name]} at {where}, but it must be positive in the whole window; "
                f"narrow the range or change {name}"
            )
    try:
        return equilibria(system, values)
    except DegeneratePoint as error:
        raise DegenerateSliceError(
            f"{error}, a point that should lie off the variety: the slice has a whole area of singular equilibria"
        ) from error


def _coefficients(p: UnivariatePolynomial) -> tuple[int, ...]:
    return tuple(int(c) for c in p.coeffs())
