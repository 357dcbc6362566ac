"""The solutions of any model at a point of the window, or over a box of it, counted with proof.

Guarantee: counts that are returned are true, at the point or at every point of the box; what is not
proved raises `Unproved`. Springs without length are no solutions.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from flint import arb, ctx

from ptmcad.answer.counts import euler_sum
from ptmcad.answer.regionmap import Solution
from ptmcad.errors import PoleError
from ptmcad.question.counts import Count
from ptmcad.text.balls import ball_of
from ptmcad.verification.certified.ballequations import BallEquations, Matrix
from ptmcad.verification.certified.counted import CellCounts, CountedPoint
from ptmcad.verification.certified.krawczyk import Spent, zeros
from ptmcad.verification.certified.narrow import is_wide, precisions, tested
from ptmcad.verification.coordinates import evaluated
from ptmcad.verification.derivation import not_positive
from ptmcad.verification.kinds import kind_of
from ptmcad.verification.normalform.boxes import (
    MIN_HALF_WIDTH,
    Floats,
    Unproved,
    Zero,
    in_words,
    is_same,
)
from ptmcad.verification.normalform.lattice import Range, SliceLattice
from ptmcad.verification.normalform.waves import Form, Sides, form_of, sides
from ptmcad.verification.principalminors import inertia
from ptmcad.verification.report import Violation

if TYPE_CHECKING:
    from ptmcad.verification.exclusion.places import Isolation, SolutionPlaces

Values = Mapping[str, arb]
"""Of the parameters."""
PRECISIONS = ((53, MIN_HALF_WIDTH), (128, 2.0**-80))
"""Bits, and the share of all configurations below which boxes are not halved: a spring may be as
short as that.
"""
BUDGETS = (20_000, 40_000, 60_000)
"""Boxes of the unknowns for one point, by the number of unknowns."""
BOX_BUDGET_SHARE = 4
"""For a box of parameters so many times fewer."""
_HALVINGS = 60
MAX_ANGLE = 8
"""Of the middle of a stored box, where an unknown is an angle."""
MAX_REAL = 2**1000
"""... and where it is a length: a number that floats have."""


@dataclass(frozen=True)
class ModelCounting:
    """Counts for one model, from the form that follows from its description."""

    lattice: SliceLattice

    @cached_property
    def form(self) -> Form:
        """What is zero at the solutions."""
        return form_of(self.lattice.slice)

    @cached_property
    def _places(self) -> SolutionPlaces:
        from ptmcad.verification.exclusion.places import SolutionPlaces  # loads numba

        return SolutionPlaces(self.lattice)

    @property
    def _count(self) -> Count:
        return self.lattice.slice.count

    def at(self, x: Fraction, y: Fraction) -> CountedPoint:
        """At a point of the window."""
        values = self._values(x, y)
        u, v = self.lattice.on(x, y)
        starts = self._places((u, u), (v, v))
        reason: Unproved | None = None
        for bits, smallest in PRECISIONS:
            with ctx.workprec(bits):
                try:
                    numbers = _balls(values)
                    found = self._found(numbers, starts, smallest)
                    return CountedPoint(self._counts(numbers, found), found)
                except Spent:
                    raise  # more digits would not make them fewer
                except Unproved as unproved:
                    reason = unproved
        assert reason is not None
        raise reason

    def over(self, u: Range, v: Range, there: CountedPoint) -> CellCounts:
        """At all points of a rectangle in lattice steps.

        Parameters
        ----------
        there : the solutions at one of the points, which are proved first for all of them.
        """
        slice = self.lattice.slice
        x, y = self.lattice.balls(u, v)
        values = self.lattice.values(u, v)
        if (name := not_positive(slice.model, values)) is not None:
            raise Unproved(f"{name} may be outside of its domain")
        if not all(evaluated(cone.pull, values) >= 0 for cone in self.form.cones):
            raise Unproved("a stiffness times a free length may be negative")
        # boxes much smaller than the box of parameters are excluded no better than larger ones
        smallest = max(float(max(x.rad(), y.rad())) / 256, 2.0**-32)
        found = self._found(values, self._places(u, v), smallest, there)
        return self._counts(values, found)

    def _found(
        self,
        values: Values,
        starts: Sequence[Isolation],
        smallest: float,
        there: CountedPoint | None = None,
    ) -> list[Zero]:
        """The solutions that count, with springs on one line each on all sides of length zero."""
        found, near = list[Zero](), () if there is None else there.found
        is_of_stable = kind_of(self._count).is_of_stable
        asked = ("inequalities", "stability") if is_of_stable else ("inequalities",)
        budget = BUDGETS[self.form.size - 1] // (1 if there is None else BOX_BUDGET_SHARE)
        for side, start in zip(sides(self.form), starts, strict=True):
            field = BallEquations(self.form, values, asked, side)
            known = [zero for zero in near if _may_be_on_side(field, zero.within)]
            on_side = zeros(field, start, start.whole, budget, smallest, known)
            counted = _counted(field, on_side, self._count)
            if self._count is Count.TOTAL and self.form.conditions_for_stability:
                counted = [replace(zero, signs=_stability(field, zero)) for zero in counted]
            # at both ends of a box of angles one may be there on two sides
            found += [
                zero for zero in counted if not any(self.same(zero, other) for other in found)
            ]
        return found

    def _counts(self, values: Values, found: Sequence[Zero]) -> CellCounts:
        """The counts, with the number of stable solutions with margins where these are asked for.

        Raises
        ------
        Unproved
            When a margin may be zero at a stable solution.
        """
        counts = counts_of(self.form, found, self._count)
        if not kind_of(self._count).is_predicate:
            return counts
        stable = (zero for zero in found if "-" not in zero.signs)
        number = sum(self._has_margins(values, zero) for zero in stable)
        return replace(counts, further={self._count.value: number})

    def in_box(self, x: Fraction, y: Fraction, solution: Solution, k: int) -> Zero:
        """The only solution in a stored box at a point of the window.

        Parameters
        ----------
        k : the number of the box.

        Raises
        ------
        Violation
            When none is in it, or several are.
        Unproved
            When one may be, or may be next to it.
        """
        _check_box(self.form, solution, k)
        values = self._values(x, y)
        near = f"box {k} of the solutions, around ({in_words(map(float, solution.center))})"
        try:
            found = [_zero_in(self.form, values, side, solution) for side in sides(self.form)]
        except Unproved:
            raise Unproved(f"a solution may be in {near}, or next to it") from None
        held = [zero for zero in found if zero is not None]
        if len(held) != 1:
            raise Violation(f"{near}, has {len(held)} equilibria, not one")
        return held[0]

    def stability_at(self, x: Fraction, y: Fraction, zero: Zero) -> str:
        """The signs of the conditions for stability at a solution at a point of the window; empty
        where there are none, or one is not certain.
        """
        values = _balls(self._values(x, y))
        for side in sides(self.form) if self.form.conditions_for_stability else ():
            field = BallEquations(self.form, values, sides=side)
            if _may_be_on_side(field, zero.within):
                return _stability(field, zero)
        return ""

    def has_margins(self, x: Fraction, y: Fraction, zero: Zero) -> bool:
        """Whether all margins are positive at a solution at a point of the window.

        Raises
        ------
        Unproved
            When one may be zero.
        """
        return self._has_margins(_balls(self._values(x, y)), zero)

    def _has_margins(self, values: Values, zero: Zero) -> bool:
        margins = BallEquations(self.form, values)(zero.within).of("margins")
        return _are_positive(margins, kind_of(self._count).undecided)

    def _values(self, x: Fraction, y: Fraction) -> dict[str, Fraction]:
        """Every parameter at a point.

        Raises
        ------
        Violation
            When one has a pole there, or is outside its domain.
        """
        model = self.lattice.slice.model
        values = {name: Fraction(0) for name in model.free_lengths}
        try:
            values |= {n: e.evaluate(x, y) for n, e in self.lattice.slice.parameters.items()}
        except PoleError as error:
            raise Violation(str(error)) from error
        if (name := not_positive(model, values)) is not None:
            raise Violation(f"{name} is {'not positive' if name in model.positive else 'negative'}")
        for cone in self.form.cones:
            if evaluated(cone.pull, values) < 0:
                raise Violation(
                    f"stiffness times free length of the spring {cone.name} is negative"
                )
        return values

    def same(self, one: Zero, two: Zero) -> bool:
        """Whether a solution lies where another one is alone.

        Raises
        ------
        Unproved
            When it may or may not be the other one.
        """
        return is_same(one, two, self.form.is_circle)


def _may_be_on_side(field: BallEquations, box: Sequence[arb]) -> bool:
    """Whether some of a box may be on the field's side of the lengths zero."""
    return not any(c < 0 for c in field(box).of("ahead"))


def _counted(field: BallEquations, found: Sequence[Zero], count: Count) -> list[Zero]:
    """The solutions at which all conditions of the field are positive; stable ones have the signs
    of those for it.

    Raises
    ------
    Unproved
        When a condition may be zero at one of them.
    """
    if not field.form.is_gradient and kind_of(count).is_of_stable:
        found = [replace(zero, signs="+" * field.form.conditions_for_stability) for zero in found]
    undecided = "a condition may be zero at the solution near ({})"
    return [
        _apart(field, zero)
        for zero in found
        if _are_positive(field(zero.within).conditions, undecided.format(in_words(zero.center)))
    ]


def _apart(field: BallEquations, zero: Zero) -> Zero:
    """A solution alone where every spring on one line is on its side: so it is alone among those of
    all sides, too.
    """
    for k in range(_HALVINGS if field.sides else 0):
        alone = tuple(max(r, a / 2**k) for r, a in zip(zero.radii, zero.alone, strict=True))
        if all(c > 0 for c in field(tuple(map(arb, zero.center, alone))).of("ahead")):
            return replace(zero, alone=alone)
    if field.sides:
        raise Unproved("a solution may be where a spring on one line has no length")
    return zero


def _stability(field: BallEquations, zero: Zero) -> str:
    """The signs of the conditions for stability at a solution; empty where one is not certain."""
    conditions = field(zero.within).of("stability")
    certain = all(c > 0 or c < 0 for c in conditions)
    return "".join("+" if c > 0 else "-" for c in conditions) if certain else ""


def _balls(values: Mapping[str, Fraction]) -> dict[str, arb]:
    return {name: ball_of(value) for name, value in values.items()}


def _are_positive(values: Sequence[arb], undecided: str) -> bool:
    """Whether all of some values are positive.

    Raises
    ------
    Unproved
        When one may be zero.
    """
    if any(value < 0 for value in values):
        return False
    if all(value > 0 for value in values):
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


def _zero_in(
    form: Form, values: Mapping[str, Fraction], side: Sides, solution: Solution
) -> Zero | None:
    """The solution in a stored box that has springs on one line on one side; None where none is.

    Raises
    ------
    Unproved
        When one may be.
    """
    for bits in precisions(solution):
        with ctx.workprec(bits):
            field = BallEquations(form, _balls(values), sides=side)
            reach = arb(0, ball_of(solution.radius))
            if not _may_be_on_side(field, [ball_of(x) + reach for x in solution.center]):
                return None

            def function(
                box: Sequence[arb], field: BallEquations = field
            ) -> tuple[Sequence[arb], Matrix]:
                jet = field(box)
                return jet.values, jet.jacobian

            found = tested(function, solution)
            if found is None:
                continue
            if not found.holds or not _may_be_on_side(field, found.within):
                return None
            signs = inertia(found.jacobian) if form.is_gradient else ""
            if signs is not None and all(c > 0 for c in field(found.within).of("ahead")):
                center, radii = found.in_floats()
                return _apart(field, Zero(center, radii, _room(solution, center), signs))
    raise Unproved("not decided")


def _room(solution: Solution, center: Floats) -> Floats:
    """How far around a point the solution in a stored box is alone, as it is in one twice as wide
    (`tested`).
    """
    wide = 2 * ball_of(solution.radius)
    room = (wide - abs(x - ball_of(c)) for x, c in zip(center, solution.center, strict=True))
    return tuple(max(0.0, float(r.lower()) * (1 - 2.0**-40)) for r in room)


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
    if is_wide(solution):
        raise Violation(f"box {k} of the solutions is wider than boxes of one solution are")
