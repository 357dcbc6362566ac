"""Checks of the counts and the solutions at every cell's sample.

*Counts* come from signatures of trace forms, exactly. That they hold in the whole cells follows
from the checks of the variety and of the decomposition.

*Solutions.* Each stored box, in the coordinates of the unknowns, is tested by Krawczyk's image
(`certified.narrow`). Where it has one solution, the signs of the Hessian's eigenvalues, of
inequalities and of conditions for stability are those on its image, or precision is doubled.
Where that shows nothing, as of a box much larger than the distance over which the equations bend,
trace forms count the solutions in the box and give their signs.

Guarantee: boxes that pass are disjoint and contain at least one solution each. As their number is
the total that the signatures give, each contains exactly one and together they contain all. No box
has a real solution that does not count: it has one real solution by the test, or trace forms count
one; where neither decides, that is listed as not checked. Conditions for stability that are said to
be zero are so: trace forms give the number of solutions at which one is, and in the other boxes it
is not. A box is refused on such a count alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations

from flint import arb, ctx, fmpq_mat

from ptmcad.answer.counts import Counts, euler_sum
from ptmcad.answer.regionmap import Cell, RegionMap, Solution, Status, System
from ptmcad.cover.rectangles import Cover
from ptmcad.model import Model
from ptmcad.question.slice import Slice
from ptmcad.text.numerals import approximate_text, text_of
from ptmcad.verification.certified.ballequations import Matrix
from ptmcad.verification.certified.narrow import narrowed, precisions, tested
from ptmcad.verification.claims import Claims
from ptmcad.verification.coordinates import ball_at
from ptmcad.verification.derivation import Derivation, not_positive
from ptmcad.verification.fibrealgebra import SolutionAlgebra
from ptmcad.verification.kinds import kind_of
from ptmcad.verification.principalminors import inertia
from ptmcad.verification.report import Unchecked, Violation

_NARROWINGS = 4
"""Images of a box that a solution is proved to be in, until signs on it are certain."""


def check_solutions(claims: Claims) -> str:
    """Every solution of every cell."""
    number = undecided = 0
    for n, cell in enumerate(claims.result.cells):
        if len(cell.solutions) != cell.total:
            raise Violation(
                f"cell {n} has {len(cell.solutions)} boxes of solutions, but {cell.total} equilibria"
            )
        check_disjoint(n, cell, claims.model)
        for k, solution in enumerate(cell.solutions):
            try:
                undecided += not _check_signs(claims, cell, solution)
            except Violation as violation:
                center = ", ".join(map(approximate_text, solution.center))
                radius = approximate_text(solution.radius)
                raise Violation(
                    f"box {k} of cell {n} around ({center}), radius {radius}: {violation}"
                ) from None
            number += 1
        _check_zeros(claims, n, cell)
        _check_index(claims, n, cell)
    if undecided:
        return Unchecked(
            f"{undecided} of {number} boxes may hold solutions at which an inequality's polynomial is zero"
        )
    return f"{number} boxes"


def _check_signs(claims: Claims, cell: Cell, solution: Solution) -> bool:
    """The box holds a solution that counts with these signs; whether it is proved that no other
    real one is in it.

    Raises
    ------
    Violation
    """
    true, alone = signs_in(claims, cell, solution)
    if true != solution.signs:
        raise Violation(claims.meaning.in_box.format(true, solution.signs[:10]))
    return alone


def signs_in(claims: Claims, cell: Cell, solution: Solution) -> tuple[str, bool]:
    """The signs at the one solution that counts in a box, by a test of the box, else by trace
    forms; and whether it is proved that no other real solution is in it.

    Raises
    ------
    Violation
        When there is none, or several.
    """
    fibre = claims.fibre_at(*cell.sample)
    for bits in precisions(solution):
        with ctx.workprec(bits):
            signs = _tested(fibre.point, solution)
        if signs is not None:
            return signs, True
    place = place_of(fibre, solution)
    if fibre.is_degenerate(place):
        raise Violation("the solution in it is degenerate")
    if not fibre.point.inequalities:
        return fibre.signs(
            place
        ), True  # all real solutions count, and have as many boxes that do not meet
    real, _ = fibre.within(solution.center, solution.radius, counted=False)
    if real > 1:
        raise Violation(f"{real} real solutions are in it")
    return fibre.signs(place), not fibre.saturated


def place_of(fibre: SolutionAlgebra, solution: Solution) -> list[fmpq_mat]:
    """Functions that are all positive at the one solution that counts in a box, and at no other.

    Raises
    ------
    Violation
        When there is none, or several.
    """
    number, place = fibre.within(solution.center, solution.radius, counted=True)
    if number != 1:
        raise Violation(f"{number or 'no'} solution{'s' * (number > 1)} found in it")
    return place


def _check_index(claims: Claims, n: int, cell: Cell) -> None:
    index = claims.meaning.indices(
        [claims.meaning.index(solution.signs) for solution in cell.solutions]
    )
    if index != cell.index:
        raise Violation(f"cell {n}: the solutions have index {index}, the cell {cell.index}")


def _check_zeros(claims: Claims, n: int, cell: Cell) -> None:
    """As many solutions as trace forms tell have a condition for stability that is zero."""
    if not any("0" in solution.signs for solution in cell.solutions):
        return
    fibre = claims.fibre_at(*cell.sample)
    for k, p in enumerate(fibre.point.stability):
        stored = sum(solution.signs[k] == "0" for solution in cell.solutions)
        if (true := fibre.number_of_zeros(p)) != stored:
            raise Violation(
                f"cell {n}: condition {k} for stability is said to be zero at {stored} solutions, but it is at {true}"
            )


def check_disjoint(n: int, cell: Cell, model: Model) -> None:
    turning = 2 * len(model.angles)
    for k, s in enumerate(cell.solutions):
        far = any(abs(x) > 2 for x in s.center[:turning])
        if len(s.center) != turning + len(model.reals) or s.radius <= 0 or s.radius > 1 or far:
            raise Violation(f"cell {n}: box {k} is not a box around a point of the torus")
    for (j, a), (k, b) in combinations(enumerate(cell.solutions), 2):
        if all(abs(x - y) <= a.radius + b.radius for x, y in zip(a.center, b.center, strict=True)):
            raise Violation(f"cell {n}: the boxes {j} and {k} of its solutions meet")


def _tested(point: Derivation, solution: Solution) -> str | None:
    """The signs at the only solution in a box, which counts; None where that is not proved at this
    precision.

    Those of the Hessian's eigenvalues, or of the conditions for stability; where one of these is
    said to be zero it is left to `_check_zeros`.
    """
    system = (*point.equations, *point.ring.relations)
    slopes = [[p.derivative(k) for k in range(point.coordinates)] for p in system]

    def function(x: Sequence[arb]) -> tuple[list[arb], Matrix]:
        value = ball_at(x)
        return list(map(value, system)), [list(map(value, row)) for row in slopes]

    found = tested(function, solution)
    for _ in range(_NARROWINGS):
        if found is None or not found.holds:
            return None
        value = ball_at(found.within)
        if all(value(p) > 0 for p in point.inequalities):
            hessian = [list(map(value, row)) for row in point.hessian]
            conditions = list(map(value, point.stability))
            signs = inertia(hessian) if hessian else _of_conditions(conditions, solution.signs)
            if signs is not None:
                return signs
        found = narrowed(function, found)
    return None


def _of_conditions(conditions: list[arb], stored: str) -> str | None:
    """The conditions' signs, 0 where that is stored and not refuted; None when one is not certain."""
    if len(stored) != len(conditions):
        stored = " " * len(conditions)
    signs = ""
    for value, sign in zip(conditions, stored, strict=True):
        if value.contains(0):
            if sign != "0":
                return None
            signs += "0"
        else:
            signs += "+" if value > 0 else "-"
    return signs


def check_counts(claims: Claims) -> str:
    """Total, stable and index of every cell; on a torus the sum of the signs; lengths and
    stiffnesses positive.
    """
    model, name = claims.model, claims.result.slice.count.value
    kind = kind_of(claims.result.slice.count)
    for n, cell in enumerate(claims.result.cells):
        where = ", ".join(f"{axis}={text_of(cell.sample[axis])}" for axis in cell.sample.names)
        if (wrong := not_positive(model, claims.parameters_at(*cell.sample))) is not None:
            raise Violation(f"{wrong} is not positive at {where} in cell {n}")
        fibre = claims.fibre_at(*cell.sample)
        counts = fibre.counts()
        if counts is None:
            raise Violation(f"{claims.meaning.solution} is degenerate at {where} in cell {n}")
        if not model.reals and not fibre.point.inequalities and _euler_sum(fibre, counts) != 0:
            raise Violation(
                f"the Euler sum of {in_words(counts)} at {where} in cell {n} is not zero"
            )
        stored = Counts(cell.total or 0, cell.stable, cell.index)
        if cell.total is None or stored != counts:
            raise Violation(
                f"cell {n} is said to have {in_words(stored)}; at {where} there are {in_words(counts)}"
            )
        if kind.is_predicate and cell.further != (true := {name: fibre.number_held()}):
            raise Violation(
                f"cell {n} is said to have {_further(cell.further)}; at {where} there are {_further(true)}"
            )
    return f"{len(claims.result.cells)} samples"


def _euler_sum(fibre: SolutionAlgebra, counts: Counts) -> int:
    """The sum of the signs of the Jacobian's determinant, which is zero on a torus (Poincare and
    Hopf).
    """
    if counts.index is None:
        return fibre.balance()
    return euler_sum(counts.index)


def _further(numbers: Mapping[str, int]) -> str:
    return ", ".join(f"{number} {name}" for name, number in numbers.items()) or "no further count"


def in_words(counts: Counts) -> str:
    """Counts in a message."""
    parts = [f"{counts.total} {'solutions' if counts.index is None else 'equilibria'}"]
    if counts.stable is not None:
        parts.append(f"{counts.stable} stable")
    if counts.index is not None:
        parts.append(f"index {counts.index}")
    return ", ".join(parts)


def map_of(slice: Slice, cells: tuple[Cell, ...], status: Status = Status.EXACT) -> RegionMap:
    """A map of a slice that has cells only, for what is checked of points."""
    return RegionMap(
        slice=slice,
        status=status,
        system=System((), (), "", (), ()),
        cells=cells,
        undetermined=Fraction(0),
        versions={},
        cover=Cover(2, ()),
    )
