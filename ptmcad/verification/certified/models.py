"""The solutions of any model at a point of the window, or over a box of it, counted with proof.

Guarantee: counts that are returned are true, at the point or at every point of the box; what is not
proved raises `Unproved`. Springs without length are no solutions.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from flint import arb, ctx

from ptmcad.answer.counts import euler_sum
from ptmcad.answer.regionmap import Solution
from ptmcad.model import Model
from ptmcad.question.counts import Count
from ptmcad.question.slice import Point, Slice
from ptmcad.text.balls import ball_of
from ptmcad.verification.certified.boxes import MIN_HALF_WIDTH, Box, Unproved, Zero, is_same
from ptmcad.verification.certified.counted import CellCounts, CountedPoint, Where
from ptmcad.verification.certified.field import BallEquations, Matrix
from ptmcad.verification.certified.kinks import Sides, sides
from ptmcad.verification.certified.narrow import Function, judged, only
from ptmcad.verification.certified.parameters import values_over
from ptmcad.verification.certified.ranges import half_widths
from ptmcad.verification.certified.solving import Spent, zeros
from ptmcad.verification.certified.waves import Form
from ptmcad.verification.claims import Claims
from ptmcad.verification.coordinates import evaluated
from ptmcad.verification.kinds import kind_of
from ptmcad.verification.principalminors import inertia
from ptmcad.verification.report import Violation

PRECISIONS = ((53, MIN_HALF_WIDTH), (128, 2.0**-80))
"""Bits, and the share of all configurations below which boxes are not halved: a spring may be as
short as that.
"""
_BOX_PRECISION = 128
BUDGETS = (20_000, 40_000, 60_000)
"""Boxes of the unknowns for one point, by their number; one more unknown makes each of them dearer,
too.
"""
BOX_BUDGET_SHARE = 4
"""For a box of parameters so many times fewer."""
_HALVINGS = 60
MAX_ANGLE = 8
"""Of the middle of a stored box, where an unknown is an angle."""
MAX_REAL = 2**1000
"""... and where it is a length: a number that floats have."""


@dataclass(frozen=True, slots=True)
class ModelCounting:
    """Counts for one model, from the form that follows from its description."""

    form: Form

    def at(
        self, claims: Claims, x: Fraction, y: Fraction, where: Where | None = None
    ) -> CountedPoint:
        """At a point of the window."""
        values, count = _values_at(claims, self.form, x, y), claims.result.slice.count
        reason: Unproved | None = None
        for bits, smallest in PRECISIONS:
            with ctx.workprec(bits):
                try:
                    return self._at(values, count, where, smallest)
                except Spent:
                    raise  # more digits would not make them fewer
                except Unproved as unproved:
                    reason = unproved
        assert reason is not None
        raise reason

    def _at(
        self,
        values: Mapping[str, Fraction],
        count: Count,
        where: Where | None = None,
        smallest: float = MIN_HALF_WIDTH,
    ) -> CountedPoint:
        """At the context's precision."""
        numbers = _balls(values)
        found = self._found(numbers, count, where, smallest)
        return CountedPoint(self._counts(numbers, found, count), found, values)

    def _found(
        self,
        values: Mapping[str, arb],
        count: Count,
        where: Where | None,
        smallest: float,
        there: CountedPoint | None = None,
    ) -> list[Zero]:
        """The solutions that count, with springs on one line each on all sides of length zero.

        Parameters
        ----------
        there : those for some of the parameters, which are proved first for all of them.
        """
        found, near = list[Zero](), () if there is None else there.found
        budget = self._budget // (1 if there is None else BOX_BUDGET_SHARE)
        for k, side in enumerate(sides(self.form)):
            field = _field(self.form, values, count, side)
            start, whole = (
                ([_start(field)], None) if where is None else (where.boxes[k], where.whole)
            )
            known = [zero for zero in near if _may_be_on_side(field, zero)]
            on_side, _ = zeros(
                field, _only_minima(self.form, count), start, budget, smallest, known, whole
            )
            counted = _counted(field, on_side, count)
            if count is Count.TOTAL and self.form.conditions_for_stability:
                counted = _with_signs(
                    _field(self.form, values, Count.STABLE, side), self.form, counted
                )
            # at both ends of a box of angles one may be there on two sides
            found += [
                zero for zero in counted if not any(self.same(zero, other) for other in found)
            ]
        return found

    def _counts(self, values: Mapping[str, arb], found: Sequence[Zero], count: Count) -> CellCounts:
        """The counts, with the number of stable solutions with margins where these are asked for.

        Raises
        ------
        Unproved
            When a margin may be zero at a stable solution.
        """
        counts, kind = counts_of(self.form, found, count), kind_of(count)
        if not kind.is_predicate:
            return counts
        field = BallEquations(self.form, values, ("margins",))
        stable = (zero for zero in found if "-" not in zero.signs)
        number = sum(_has_margins(field, zero, kind.undecided) for zero in stable)
        return replace(counts, further={count.value: number})

    def within(
        self, values: Mapping[str, Fraction], boxes: Sequence[Solution], first: int = 0
    ) -> list[Zero]:
        """The only solution in each of the stored boxes at parameters; the first box's number is
        given.
        """
        with ctx.workprec(_BOX_PRECISION):
            fields = [_field(self.form, _balls(values), None, side) for side in sides(self.form)]
            return [
                self._in_box(fields, values, solution, k) for k, solution in enumerate(boxes, first)
            ]

    def _in_box(
        self,
        fields: Sequence[BallEquations],
        values: Mapping[str, Fraction],
        solution: Solution,
        k: int,
    ) -> Zero:
        _check_box(self.form, solution, k)
        # where it may be on several sides of springs' lines, it has to be searched on each of them
        box = [ball_of(x) + arb(0, ball_of(solution.radius)) for x in solution.center]
        possible = [field for field in fields if not any(c < 0 for c in _ahead(field, box))]
        narrow = (
            _narrow(self.form, values, possible[0].sides, solution, k)
            if len(possible) == 1
            else None
        )
        return narrow or _only(fields, solution, k, self._budget)

    def in_box(self, claims: Claims, at: Point, solution: Solution, k: int) -> Zero:
        """The only solution in a stored box at a point of the window; the box's number is told
        where there is none.
        """
        values = _values_at(claims, self.form, *at)
        (found,) = self.within(values, [solution], k)
        return found

    def same(self, one: Zero, two: Zero) -> bool:
        """Whether a solution lies where another one is alone.

        Raises
        ------
        Unproved
            When it may or may not be the other one.
        """
        return is_same(one, two, self.form.is_circle)

    def over(
        self, slice: Slice, x: arb, y: arb, there: CountedPoint, where: Where | None = None
    ) -> CellCounts:
        """At all points of a box."""
        values = values_over(slice, x, y)
        for name, value in values.items():
            if not _is_in_domain(slice.model, name, value):
                raise Unproved(f"{name} may be outside of its domain")
        if not all(evaluated(cone.pull, values) >= 0 for cone in self.form.cones):
            raise Unproved("a stiffness times a free length may be negative")
        # boxes much smaller than the box of parameters are excluded no better than larger ones
        smallest = max(float(max(x.rad(), y.rad())) / 256, 2.0**-32)
        found = self._found(values, slice.count, where, smallest, there)
        return self._counts(values, found, slice.count)

    @property
    def _budget(self) -> int:
        return BUDGETS[self.form.size - 1]


def _only_minima(form: Form, count: Count) -> bool:
    return form.is_gradient and kind_of(count).is_of_stable


def _may_be_on_side(field: BallEquations, zero: Zero) -> bool:
    """Whether a solution may be on the field's side of the lengths zero."""
    return not any(c < 0 for c in _ahead(field, zero.within))


def _ahead(field: BallEquations, box: Sequence[arb]) -> Sequence[arb]:
    """What is positive on the field's side of the lengths zero."""
    return field(box).conditions[: len(field.sides)]


def _field(
    form: Form, values: Mapping[str, arb], count: Count | None, side: Sides
) -> BallEquations:
    """The equations with what is positive at the solutions that are counted, and at no others, if a
    count is given.
    """
    if count is None:
        return BallEquations(form, values, sides=side)
    stable = kind_of(count).is_of_stable
    asked = ("inequalities", "stability") if stable else ("inequalities",)
    return BallEquations(form, values, asked, stable and bool(form.closing), side)


def _counted(field: BallEquations, found: Sequence[Zero], count: Count) -> list[Zero]:
    """The solutions at which all conditions of the field are positive; stable ones have the signs
    of those for it.

    Raises
    ------
    Unproved
        When a condition may be zero at one of them.
    """
    kept = []
    for zero in found:
        conditions = field(zero.within).conditions
        if any(c < 0 for c in conditions):
            continue
        if not all(c > 0 for c in conditions):
            where = ", ".join(f"{x:.6g}" for x in zero.center)
            raise Unproved(f"a condition may be zero at the solution near ({where})")
        of_equations = not field.form.is_gradient and kind_of(count).is_of_stable
        signs = "+" * field.form.conditions_for_stability if of_equations else zero.signs
        kept.append(_apart(field, replace(zero, signs=signs)))
    return kept


def _apart(field: BallEquations, zero: Zero) -> Zero:
    """A solution alone where every spring on one line is on its side: so it is alone among those of
    all sides, too.
    """
    for k in range(_HALVINGS if field.sides else 0):
        alone = tuple(max(r, a / 2**k) for r, a in zip(zero.radii, zero.alone, strict=True))
        if all(
            c > 0 for c in field(tuple(map(arb, zero.center, alone))).conditions[: len(field.sides)]
        ):
            return replace(zero, alone=alone)
    if field.sides:
        raise Unproved("a solution may be where a spring on one line has no length")
    return zero


def _with_signs(field: BallEquations, form: Form, found: Sequence[Zero]) -> list[Zero]:
    """The solutions with the signs of the conditions for stability; empty where one is not certain."""
    kept = []
    for zero in found:
        conditions = field(zero.within).conditions[len(field.sides) + len(form.inequalities) :]
        certain = all(c > 0 or c < 0 for c in conditions)
        kept.append(
            replace(
                zero, signs="".join("+" if c > 0 else "-" for c in conditions) if certain else ""
            )
        )
    return kept


def _is_in_domain(model: Model, name: str, value: Any) -> bool:
    """Whether a parameter, a number or a ball, surely is what its kind asks for."""
    return bool(
        value > 0 if name in model.positive else value >= 0 if name in model.nonnegative else True
    )


def _values_at(claims: Claims, form: Form, x: Fraction, y: Fraction) -> dict[str, Fraction]:
    """Every parameter at a point.

    Raises
    ------
    Violation
        When one has a pole there, or is outside its domain.
    """
    model = claims.model
    values = {name: Fraction(0) for name in model.free_lengths} | claims.parameters_at(x, y)
    for name, value in values.items():
        if not _is_in_domain(model, name, value):
            raise Violation(f"{name} is {'not positive' if name in model.positive else 'negative'}")
    for cone in form.cones:
        if evaluated(cone.pull, values) < 0:
            raise Violation(f"stiffness times free length of the spring {cone.name} is negative")
    return values


def _balls(values: Mapping[str, Fraction]) -> dict[str, arb]:
    return {name: ball_of(value) for name, value in values.items()}


def _start(field: BallEquations) -> Box:
    """All configurations that may be solutions."""
    widths = half_widths(field.form, field.values)
    return (0.0,) * len(widths), widths


def _has_margins(field: BallEquations, zero: Zero, undecided: str) -> bool:
    """Whether all conditions of a field hold at a solution."""
    found = field(zero.within).conditions
    if any(value < 0 for value in found):
        return False
    if all(value > 0 for value in found):
        return True
    raise Unproved(undecided)


def counts_of(form: Form, found: Sequence[Zero], count: Count) -> CellCounts:
    """The counts that follow from the solutions and their signs; Euler's sum is checked where it
    holds.

    Raises
    ------
    Violation
        When the sum is wrong, which would be a fault of this check.
    """
    if not form.is_gradient:
        number = len(found)
        return (
            CellCounts(stable=number) if kind_of(count).is_of_stable else CellCounts(total=number)
        )
    negative = Counter(zero.signs.count("-") for zero in found)
    index = tuple(negative[k] for k in range(form.size + 1))
    if kind_of(count).is_of_stable:
        return CellCounts(stable=index[0])
    if form.is_smooth_on_a_torus and euler_sum(index):
        raise Violation(
            f"critical points of a function on the torus by index {index} contradict Euler's sum"
        )
    return CellCounts(len(found), index[0], index)


def _narrow(
    form: Form, values: Mapping[str, Fraction], side: Sides, solution: Solution, k: int
) -> Zero | None:
    """The one solution in a stored box that is narrow, and on one side; None where a search has to
    tell.
    """

    def function() -> Function:
        field = _field(form, _balls(values), None, side)

        def at(box: Sequence[arb]) -> tuple[Sequence[arb], Matrix] | None:
            jet = field(box)
            return None if jet.short else (jet.values, jet.jacobian)

        return at

    found = judged(function, solution)
    if found is None:
        return None
    if not found.holds:
        return only([], solution, k)  # which refuses it
    signs = inertia(found.jacobian) if form.is_gradient else ""
    # nothing is said of what is around the box
    return None if signs is None else Zero(*found.in_floats(), (0.0,) * form.size, signs)


def _check_box(form: Form, solution: Solution, k: int) -> None:
    """Refuse what is no box within the bounds of unknowns."""
    circles = form.is_circle
    if len(solution.center) != len(circles) or not 0 < solution.radius <= (
        1 if any(circles) else MAX_REAL
    ):
        raise Violation(f"box {k} of the solutions is not a box of {len(circles)} unknowns")
    if any(
        circle and abs(x) > MAX_ANGLE for circle, x in zip(circles, solution.center, strict=True)
    ):
        raise Violation(f"box {k} of the solutions is too many turns away")
    if any(abs(x) > MAX_REAL for x in solution.center):
        raise Violation(f"box {k} of the solutions is beyond all bounds of unknowns")


def _only(fields: Sequence[BallEquations], solution: Solution, k: int, budget: int) -> Zero:
    """The one solution in a stored box, on whichever side it is."""
    center = tuple(float(x) for x in solution.center)
    # floats have the centers and radii of stored boxes exactly, or nearly: then the box is made a
    # little larger
    radii = tuple(
        float(solution.radius) * (1 + 2.0**-40) + 2.0**-50 * max(1.0, abs(x)) for x in center
    )
    inside = list[Zero]()
    for field in fields:
        found, _ = zeros(field, False, [(center, radii)], budget)
        inside += [zero for zero in found if _may_be_on_side(field, zero)]
    return only(inside, solution, k)
