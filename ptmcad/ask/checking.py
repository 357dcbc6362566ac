"""What a record asks and what that will cost, before anything is computed.

Guarantee: what an engine would refuse without computing is refused here, in the same words. The
number of complex solutions is exact at the point that is named, and so at all points but those of
some curves. Where the degrees of the equations allow so many that counting them would itself take
long, they are not counted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from time import process_time

from flint import fmpq

from ptmcad.algebra.bases import plan_text
from ptmcad.algebra.fibre_algebra import WorkLimit
from ptmcad.ask.classification import check_flat_loops, check_taken, flat_loops
from ptmcad.ask.forecast import (
    QUICK,
    Forecast,
    curve_text,
    forecast,
    seconds_to_discriminant,
    way_text,
)
from ptmcad.ask.forecast import cost_text as in_figures
from ptmcad.ask.quantities import open_chain
from ptmcad.ask.timed import returns_within
from ptmcad.errors import ConfigError, DegenerateSliceError, LimitReached, shown
from ptmcad.exact.curvesizes import Survey, sizes, survey
from ptmcad.exact.models import ParametricSystem
from ptmcad.exact.point_system import degree_bound, none_is_stable, solutions_at
from ptmcad.exact.stages import SliceProblem, problem_of, prove_regular
from ptmcad.exact.witness import SHARES, points
from ptmcad.model import ptm
from ptmcad.model.closed import terms_of
from ptmcad.options import is_certified
from ptmcad.question.domain import proved
from ptmcad.question.slice import Slice, merged
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.text.numerals import short_text

MAX_UNKNOWNS = 4
"""Beyond, even one point takes too long for a question that should be answered at once."""
MAX_SHOWN = 60
"""Characters of a parameter's value."""
MAX_PROVED = 8
"""Complex solutions: of more it is not proved that the slice is degenerate, which takes seconds and
more.
"""
MAX_SECONDS = 4.0
"""For that proof."""
MAX_SIZING = 1.5
"""Seconds for the size of the critical curve."""
MAX_SURVEYING = 1.5
"""Seconds for the cells."""
OUT_OF_REACH = "a curve of such a degree may be out of the exact map's reach: try --timeout, or counts along lines"
MAX_EXPANDING = 1.0
"""Seconds for what is written out as functions of the axes."""
MAX_QUICK = 1_000
"""Terms of the equations times those of the longest parameter up to which that takes no while."""
MAX_DEGREE, MAX_BOUND = 12, 400
"""Of an equation, and of the number of solutions by Bezout's theorem: beyond, too."""
MAX_COUNTED = 40
"""Solutions with multiplicity: of more it takes seconds to see how many are different."""
MAX_BASIS = 100, 400, 4_000
"""Polynomials, terms of each and bits of a number in a basis of the equations at a point."""
_UNCOUNTED = "not known: try single points first, by ptmcad solve"
_UNSIZED = "not known: the critical curve's size is not found at once; try --timeout, or counts along lines"
_LONG = 16
"""Complex solutions: with more of them the exact map takes so long that the answer warns of it."""
_BY_INTERVALS = "; --engine certified encloses the map"


@dataclass(frozen=True, slots=True)
class CheckedSlice:
    """What a record asks.

    Attributes
    ----------
    complex_solutions : at ``sample``; None where they were not counted, or where there are
        infinitely many there.
    bound : of their number by Bezout's theorem, where they were not counted because of it.
    engine : the one that ``--engine auto`` takes.
    cost : in words.
    forecast : what the exact map is predicted to take; None where the curve's size is not known.
    bases : how Groebner bases at points are computed, in words; empty where they are small by the
        bound.
    """

    slice: Slice
    sample: tuple[Fraction, Fraction]
    complex_solutions: int | None
    engine: str
    cost: str
    bound: int | None = None
    forecast: Forecast | None = None
    bases: str = ""


def check(slice: Slice, sized: bool = True) -> CheckedSlice:
    """What a slice asks and what that will cost.

    Parameters
    ----------
    sized : whether the size of the curve is asked for, which takes longer than all else, where
        solutions are not many.

    Raises
    ------
    ConfigError
        When no engine takes the model.
    GeometryError
        When a parameter is not in the whole window what it needs to be, or that is not proved.
    DegenerateSliceError, InfiniteSolutionsError
        When some solution is multiple at every point of the slice, there are infinitely many, or
        there is none that counts; with a point that shows it. Where a proof would take long, the
        cost says what was seen.
    """
    slice = proved(slice)
    # thirds and sevenths of the window: rarely on a curve that a person has in mind
    sample = tuple(a.at(share) for a, share in zip(slice.axes, (_ACROSS, _UP), strict=True))
    at = (sample[0], sample[1])
    if is_certified(slice, "auto"):
        cost, flat = _CERTIFIED, flat_loops(slice)
        check_flat_loops(slice)  # however long the rest would take
        try:
            if not _is_large(slice):
                _check_certified(slice)
            elif not returns_within(MAX_EXPANDING, _check_certified, slice):
                cost = _LARGE
        except ConfigError as error:
            from ptmcad.certified.plain.problem import (
                MAX_UNKNOWNS_AT_POINTS,
            )  # loaded by what refuses

            if error.key != "unknowns" or len(slice.model.unknowns) > MAX_UNKNOWNS_AT_POINTS:
                raise
            cost = (
                f"no map can be made, since {error.message}: ask for single points, by ptmcad solve"
            )
        return CheckedSlice(slice, at, None, "certified", f"{cost}; {flat}" if flat else cost)
    uncounted = CheckedSlice(slice, at, None, "exact", _UNCOUNTED)
    many = len(slice.model.unknowns) > MAX_UNKNOWNS
    return uncounted if many else _counted(uncounted, sized)


_ACROSS, _UP = Fraction(10, 21), Fraction(19, 35)
_CERTIFIED = (
    "grows as the tolerance falls, and where springs get short: begin with --tolerance 1/20 --timeout 60, and go on "
    "with --resume"
)


_LARGE = (
    "not known: with such long expressions for parameters the equations take long to be written out; try single points "
    "first, by ptmcad solve"
)


def _is_large(slice: Slice) -> bool:
    """Whether the equations may take more than some tenths of a second to be written out as
    functions of the axes.
    """
    longest = max(
        (len(e.numerator) + len(e.denominator) for e in slice.parameters.values()), default=1
    )
    return slice.model != ptm() and terms_of(slice.model) * longest > MAX_QUICK


def _check_certified(slice: Slice) -> None:
    """Refuse what the certified engine refuses before it searches: also free lengths where no
    bounds of unknown lengths are known.
    """
    check_taken(slice)
    if slice.model == ptm() or not slice.model.reals:
        return
    from ptmcad.certified.plain.problem import problem_of as problem_in_intervals
    from ptmcad.certified.plain.straight import branches
    from ptmcad.certified.plain.unknownranges import ranges

    for branch in branches(problem_in_intervals(slice), slice.axes):
        ranges(branch, slice.axes)


def _counted(asked: CheckedSlice, sized: bool) -> CheckedSlice:
    """The check of a slice that the exact engine takes."""
    slice, problem = asked.slice, problem_of(asked.slice)
    x, y = map(from_fraction, asked.sample)
    values = problem.on.values((x, y))
    degree, bound = degree_bound(problem.system, values)
    asked = replace(asked, bases=plan_text(bound))
    if degree > MAX_DEGREE or bound > MAX_BOUND:
        return replace(asked, bound=bound)
    others = (problem.on.values(at) for at in points(problem.window))
    try:
        found, doubt = _solutions(problem.system, values)
        everywhere = bool(doubt) and all(_solutions(problem.system, other)[1] for other in others)
    except LimitReached:
        return replace(asked, bound=bound)
    if everywhere:
        seen = f"at {len(SHARES)} points that were tried {doubt}"
        if (found or 0) > MAX_PROVED:
            refused = f"not known: {seen}; a slice where that is so everywhere is refused"
            return replace(asked, complex_solutions=found, cost=refused)
        if not returns_within(MAX_SECONDS, _prove, slice):
            late = (
                "; that it is so everywhere, where the slice is refused, was not proved in the time"
            )
            return replace(asked, complex_solutions=found, cost=f"not known: {seen}{late}")
    if not found:
        return replace(asked, cost=f"not known: at the sample {doubt}")
    predicted = _predicted(problem, found) if not doubt and (sized or found > _LONG) else None
    words = _UNSIZED if predicted is None else in_figures(predicted)
    far = found > _LONG if predicted is None else not predicted.reachable
    if far and predicted is not None:
        words += f"; {OUT_OF_REACH}"
    offered = _BY_INTERVALS if far and _encloses(slice) else ""
    return replace(asked, complex_solutions=found, cost=words + offered, forecast=predicted)


def _predicted(problem: SliceProblem, solutions: int) -> Forecast | None:
    """The forecast for a slice with simple solutions; None where the curve is too large to tell its
    size at once.
    """
    found = sizes(problem, solutions, MAX_SIZING, WorkLimit(MAX_COUNTED, *MAX_BASIS))
    if found is None:
        return None
    quick = seconds_to_discriminant(solutions, found) <= QUICK
    return forecast(solutions, found, _surveyed(problem) if quick else None)


def _surveyed(problem: SliceProblem) -> Survey | None:
    """The decomposition's sizes; None where it takes much longer than predicted."""
    end = process_time() + MAX_SURVEYING

    def check() -> None:
        if process_time() > end:
            raise LimitReached("the survey takes too long")

    try:
        return survey(problem, check)
    except LimitReached:
        return None


def _prove(slice: Slice) -> None:
    prove_regular(problem_of(slice))


def _solutions(system: ParametricSystem, values: Mapping[str, fmpq]) -> tuple[int | None, str]:
    """The number of different complex solutions at a point, and what casts doubt on the slice, in
    words.

    Raises
    ------
    LimitReached
        When they are not counted within about a second.
    """
    most = WorkLimit(MAX_COUNTED, *MAX_BASIS)
    different, multiplicity = solutions_at(system, values, most=most)
    if system.inequalities:
        counted, of = solutions_at(system, values, saturated=True, most=most)
        if counted == 0 and different != 0:
            return different, "each solution makes the left side of an inequality zero"
        if different != multiplicity or different is None:
            different, multiplicity = counted, of
    if different is None:
        return None, "there are infinitely many solutions"
    if not different:
        return 0, "there is no solution, real or complex"
    if different == multiplicity and none_is_stable(system, values, most):
        return different, "each solution makes the left side of a condition for stability zero"
    return different, "" if different == multiplicity else "some solution is multiple"


def _encloses(slice: Slice) -> bool:
    """Whether the certified engine takes a slice that the exact one takes too, as far as that is
    known at once.
    """
    if _is_large(slice):
        return False
    try:
        check_taken(slice)
    except (ConfigError, DegenerateSliceError):
        return False
    return True


def warning(slice: Slice) -> str:
    """What to say before an exact map that will take long; empty where it will not, or nobody
    knows.
    """
    if slice.model == ptm():
        return ""
    found = check(slice, sized=False)
    if found.engine != "exact" or (found.complex_solutions or 0) <= _LONG:
        return ""
    takes = (
        "the exact map's cost is" if found.cost.startswith("not known") else "the exact map takes"
    )
    return (
        f"the equations have {found.complex_solutions} complex solutions, and {takes} {found.cost}"
    )


def predictions(slice: Slice) -> Iterator[str]:
    """What is known of an exact map before its heavy part: solutions, the curve, how it is
    projected, the cost.
    """
    found = check(slice)
    if found.complex_solutions is not None:
        yield f"{found.complex_solutions} complex solutions"
    if found.forecast is not None:
        yield f"curves {curve_text(found.forecast, slice.axis_names)}"
        yield way_text(found.forecast)
    if found.bases:
        yield f"bases at points of {found.bases}"
    yield (
        f"the whole map takes {found.cost}" if found.forecast is not None else f"cost {found.cost}"
    )


def asked_text(slice: Slice) -> Iterator[str]:
    """What a slice asks as lines of text, before anything is computed."""
    model = slice.model
    mechanism = open_chain(model)
    yield f"{'system' if mechanism is None else 'mechanism':<12}{model.name}"
    yield f"{'unknowns':<12}{', '.join(f'{name} ({kind.value})' for name, kind in model.unknowns.items())}"
    if mechanism is not None:
        words = (
            f"{number} {one if number == 1 else many}"
            for (one, many), number in mechanism.census.items()
        )
        yield f"{'parts':<12}{', '.join(words)}"
        yield from (f"{key:<12}{law}" for key, law in mechanism.laws.items())
    values = {
        name: e.to_text(slice.axis_names)
        for name, e in slice.parameters.items()
        if name not in slice.axis_names
    }
    fixed = [
        f"{name} = {value if len(value) <= MAX_SHOWN else shown(slice.text.get(name, value), MAX_SHOWN)}"
        for name, value in merged(values, model).items()
    ]
    yield f"{'parameters':<12}{', '.join(fixed) or 'none but the axes'}"
    ends = (f"{a.name} from {short_text(a.low)} to {short_text(a.high)}" for a in slice.axes)
    yield f"{'axes':<12}{', '.join(ends)}"
    yield f"{'count':<12}{slice.count.value}"


def cost_text(found: CheckedSlice) -> Iterator[str]:
    """What it will cost as lines of text."""
    slice = found.slice
    at = ", ".join(
        f"{a.name} = {short_text(value)}" for a, value in zip(slice.axes, found.sample, strict=True)
    )
    number = (
        "not counted"
        if found.complex_solutions is None
        else _complex(found.complex_solutions, f" at {at}")
    )
    if found.bound is not None:
        number = "at most " + _complex(
            found.bound, ", or infinitely many, by the equations' degrees"
        )
    yield f"{'solutions':<12}{number}"
    if found.forecast is not None:
        yield f"{'curves':<12}{curve_text(found.forecast, slice.axis_names)}"
    yield f"{'engine':<12}{found.engine}"
    if found.bases:
        yield f"{'bases':<12}{found.bases}"
    yield f"{'cost':<12}{found.cost}"


def _complex(number: int, rest: str) -> str:
    return f"{number} complex one{'s' * (number != 1)}{rest}"
