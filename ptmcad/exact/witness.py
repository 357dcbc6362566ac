"""A point that shows what is wrong with a slice that is degenerate at every point.

Guarantee: exact. A point is called one where nothing else degenerates only by proof: no solution has left to infinity
there, as the dimension of the algebra is the one over Q(x, y), and as many solutions are different there as at any
other point but those of some curves, as this number is the rank of the trace form (Hermite), over Q(x, y) as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations_with_replacement

from flint import fmpq, fmpq_mat

from ptmcad.algebra.determinants import determinant
from ptmcad.algebra.groebner import MonomialOrder, groebner_basis
from ptmcad.algebra.polynomials import Ratio, evaluate
from ptmcad.algebra.quotient import multiplication_denominator, quotient_algebra, trace_form
from ptmcad.errors import DegenerateSliceError, HypothesisError, InfiniteSolutionsError, NothingToCountError
from ptmcad.exact.models.system import ParametricSystem, on_slice, saturated
from ptmcad.exact.point_system import solutions_at
from ptmcad.text.flint_numbers import from_fraction

Point = tuple[fmpq, fmpq]
Window = tuple[tuple[fmpq, fmpq], tuple[fmpq, fmpq]]
SHARES = tuple(
    (Fraction(a, b), Fraction(c, d))
    for a, b, c, d in ((10, 21, 19, 35), (5, 11, 4, 13), (7, 17, 12, 19), (9, 23, 13, 29), (14, 31, 15, 37))
)
"""Of the window: rarely on a curve that a person has in mind."""
MAX_DIMENSION, MAX_MINORS = 12, 60
"""Of what is proved; beyond, a point is an example only."""


def with_witness(
    error: DegenerateSliceError | InfiniteSolutionsError,
    system: ParametricSystem,
    parameters: Mapping[str, Ratio],
    window: Window,
    place: Callable[[Point], str],
) -> DegenerateSliceError | InfiniteSolutionsError:
    """The error, with a point of the window that shows it added to its words; as it is where none was found.

    Parameters
    ----------
    place : a point in words.
    """
    examples = (
        example
        for at in points(window)
        if all(evaluate(below, *at) for _, below in parameters.values())
        and (example := _example(error, system, parameters, at))
    )
    first = next(examples, None)
    if first is None:
        return error
    # one that is not proved to be typical is shown only where none is
    words, at, _ = first if first[2] else next((e for e in examples if e[2]), first)
    return type(error)(f"{error}; for example at {place(at)}{words}", part=error.part)


def _example(
    error: HypothesisError, system: ParametricSystem, parameters: Mapping[str, Ratio], at: Point
) -> tuple[str, Point, bool] | None:
    """What shows a point's fault in words, the point, and whether it is typical; None where the fault does not show."""
    words, typical = "", True
    values = {name: evaluate(a, *at) / evaluate(b, *at) for name, (a, b) in parameters.items()}
    if isinstance(error, NothingToCountError):
        words = _nothing(system, values)
    elif isinstance(error, InfiniteSolutionsError):
        infinite = solutions_at(system, values, saturated=True)[0] is None
        words = " there are infinitely many solutions" if infinite else ""
    else:
        different, multiplicity, typical = multiple_solutions(system, parameters, at) or (0, 0, False)
        if different < multiplicity:
            clause = ", where nothing else degenerates," if typical else ""
            words = f"{clause} only {different} of {multiplicity} solutions are different"
    return (words, at, typical) if words else None


def _nothing(system: ParametricSystem, values: Mapping[str, fmpq]) -> str:
    """How it shows at a point that there is nothing to count, in words."""
    counted = solutions_at(system, values, saturated=True)[0]
    if counted is None or counted > 0:
        return ""
    different = solutions_at(system, values)[0]
    if different is None:
        return " infinitely many solutions are all excluded"
    if not different:
        return " there is none"
    return f" the equations have {different} different solution{'s' * (different > 1)}, all excluded"


def points(window: Window) -> Iterator[Point]:
    """Some points of a window."""
    for shares in SHARES:
        x, y = (
            low + (high - low) * from_fraction(s)
            for (low, high), s in zip(window, shares, strict=True)
        )  # fmt: skip
        yield x, y


def multiple_solutions(
    system: ParametricSystem, parameters: Mapping[str, Ratio], at: Point
) -> tuple[int, int, bool] | None:
    """Numbers of different solutions and of all with multiplicity at a point, and whether they are proved generic.

    Solutions that an inequality excludes are left out. None where solutions have left to infinity, which says nothing
    of the slice.
    """
    equations = on_slice(system if system.turns is None else system.turns.system, parameters)
    for condition in equations.inequalities:
        lifted = {(*m, *(0,) * (equations.unknowns - len(m))): c for m, c in condition.items()}
        equations = saturated(equations, lifted)
    algebra = quotient_algebra(groebner_basis(equations.equations, MonomialOrder(tuple(range(equations.unknowns)))))
    if algebra is None or not evaluate(multiplication_denominator(algebra), *at):
        return None
    form = trace_form(algebra)
    if any(not evaluate(below, *at) for row in form for _, below in row):
        return None
    rows = _independent_rows(form, at)
    return len(rows), algebra.dimension, _is_rank(form, rows)


def _independent_rows(form: Sequence[Sequence[Ratio]], at: Point) -> list[int]:
    """Rows of a symmetric matrix that are a basis of all at a point."""
    values = [[evaluate(a, *at) / evaluate(b, *at) for a, b in row] for row in form]
    chosen: list[int] = []
    for k in range(len(values)):
        some = [*chosen, k]
        if fmpq_mat([values[i] for i in some]).rank() == len(some):
            chosen = some
    return chosen


def _is_rank(form: Sequence[Sequence[Ratio]], rows: Sequence[int]) -> bool:
    """Whether the rank over Q(x, y) is proved to be no greater: every minor with one more row and column is zero.

    A symmetric matrix has independent columns where it has independent rows, so that the minor of these is not zero.
    """
    others = [k for k in range(len(form)) if k not in rows]
    pairs = tuple(combinations_with_replacement(others, 2))
    if len(form) > MAX_DIMENSION or len(pairs) > MAX_MINORS:
        return False
    return all(
        determinant([[form[i][j] for j in (*rows, b)] for i in (*rows, a)])[0].is_zero() for a, b in pairs
    )  # fmt: skip
