"""The equilibria of the paper's mechanism at a point of the window, or over a box of it, counted with proof.

Guarantee: counts that are returned are true, at the point or at every point of the box; what is not proved raises
`Unproved`. `ptmcad.verification.certified.models` is the same for any other model.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from fractions import Fraction

from flint import arb, ctx

from ptmcad.answer.regionmap import Solution
from ptmcad.mechanism import Kind
from ptmcad.question.slice import Count, Slice
from ptmcad.text.balls import ball_of
from ptmcad.verification.certified.boxes import Zero
from ptmcad.verification.certified.counted import (
    Counted,
    Counts,
    Enclosed,
    Where,
)
from ptmcad.verification.certified.energy import Energy
from ptmcad.verification.certified.equilibria import (
    CIRCLES,
    MIN_HALF_WIDTH,
    TORUS,
    Square,
    Unproved,
    equilibria,
    is_same,
    signs_of,
)
from ptmcad.verification.certified.field import Matrix
from ptmcad.verification.certified.narrow import Function, judged, only
from ptmcad.verification.certified.parameters import Values, energy_at, energy_over, values_at
from ptmcad.verification.certified.vectors import CROSSING, SPRINGS, TURNED, evaluated
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import MECHANISM
from ptmcad.verification.report import Violation

PRECISIONS = (53, 128, 320)
BUDGET = 12_000
"""Squares of the torus for one box of parameters."""
_BOX_PRECISION = 128
_BASE = MECHANISM.first(Kind.BASE)


class PaperCounting:
    """The paper's mechanism, with the formulas of `ptmcad.verification.certified.energy`."""

    def at(self, claims: Claims, x: Fraction, y: Fraction, where: Where | None = None) -> Counted:
        """At a point of the window."""
        values, count = values_at(claims, x, y), claims.result.slice.count
        if where is not None:
            with suppress(Unproved):  # then the whole torus is searched
                return _counted(values, count, _start(where))
        return _counted(values, count, (TORUS,))

    def within(self, there: Counted, boxes: Sequence[Solution]) -> Sequence[Enclosed]:
        """The only equilibrium in each of the stored boxes."""
        with ctx.workprec(_BOX_PRECISION):
            # the counts may be certain with parameters that were rounded too much to say what is in a small box
            energy = energy_at(there.values)
        return [_narrow(there.values, solution, k) or _only(energy, solution, k) for k, solution in enumerate(boxes)]

    def same(self, one: Zero, two: Zero) -> bool:
        """Whether an equilibrium lies where another one is alone.

        Raises
        ------
        Unproved
            When it may or may not be the other one.
        """
        return is_same(one, two, CIRCLES)

    def over(self, slice: Slice, x: arb, y: arb, there: Counted, where: Where | None = None) -> Counts:
        """At all points of a box."""
        energy = energy_over(slice, x, y)
        # squares much smaller than the box of parameters are excluded no better than larger ones
        smallest = energy.resolution(max(float(max(x.rad(), y.rad())) / 64, 2.0**-30))
        minima = slice.count.is_of_stable
        found, _ = equilibria(energy, minima, _start(where), budget=BUDGET, smallest=smallest, near=there.found)
        kinds = [e.signs for e in found]
        stable = kinds.count("++")
        if slice.count is Count.STABLE:
            return Counts(None, stable, None, None)
        if slice.count is Count.ADMISSIBLE:
            return Counts(None, stable, None, sum(admissible(energy, e) for e in found if e.signs == "++"))
        return Counts(len(kinds), stable, (stable, kinds.count("+-"), kinds.count("--")), None)


def _counted(values: Values, count: Count, start: Sequence[Square]) -> Counted:
    energy, found = all_equilibria(values, count, start)
    return Counted(counts_of(energy, values, found, count), found, values)


def _start(where: Where | None) -> Sequence[Square]:
    """Squares in which all equilibria are that are asked for."""
    if where is None or len(where.boxes) > 1:  # boxes of several sides of a crease may meet
        return (TORUS,)
    return [(m1, r1, m2, r2) for (m1, m2), (r1, r2) in where.boxes[0]]


def all_equilibria(values: Values, count: Count, start: Sequence[Square] = (TORUS,)) -> tuple[Energy, list[Zero]]:
    """All equilibria at exact parameters, or all minima where no more is asked for; with rising precision.

    Parameters
    ----------
    start : squares that have all of them.

    Raises
    ------
    Unproved
        When they cannot be decided even then.
    """
    if not count.is_of_stable and any(evaluated(s.free, values) and s.has_crease(values) for s in TURNED):
        raise Unproved(f"{_BASE} equals the length of a bar, where the energy has a crease")
    reason: Unproved | None = None
    for bits in PRECISIONS:
        with ctx.workprec(bits):
            energy = energy_at(values)
            try:
                return energy, equilibria(
                    energy, count.is_of_stable, start, smallest=energy.resolution(MIN_HALF_WIDTH)
                )[0]
            except Unproved as unproved:
                reason = unproved
    assert reason is not None
    raise reason


def counts_of(energy: Energy, values: Mapping[str, Fraction], found: list[Zero], count: Count) -> Counts:
    """The counts that follow from the equilibria; Euler's sum is checked where all are known.

    Raises
    ------
    Unproved
        When a spring may be as long as its free length, or a cone may be about to swallow an equilibrium.
    Violation
        When the sum is wrong, which would be a fault of this check.
    """
    signs = Counter(e.signs for e in found)
    if count is Count.STABLE:
        return Counts(None, signs["++"], None, None)
    if count is Count.ADMISSIBLE:
        return Counts(None, signs["++"], None, sum(admissible(energy, e) for e in found if e.signs == "++"))
    index = (signs["++"], signs["+-"], signs["--"])
    peaks = cones(energy, values)
    if index[0] - index[1] + index[2] + peaks != 0:
        raise Violation(f"minima, saddles and maxima {index} with {peaks} cones contradict Euler's sum")
    return Counts(sum(index), index[0], index, None)


def admissible(energy: Energy, e: Zero) -> bool:
    """Whether every spring is longer than its free length.

    Raises
    ------
    Unproved
        When it is not certain.
    """
    squares = energy.squares(*e.within)
    excess = [q - s.free * s.free for q, s in zip(squares, energy.springs, strict=True)]
    if any(x < 0 for x in excess):
        return False
    if all(x > 0 for x in excess):
        return True
    raise Unproved("a spring may be as long as its free length")


def cones(energy: Energy, values: Mapping[str, Fraction]) -> int:
    """How many of the configurations where the spring between the bars has no length are peaks.

    They are those where the cone outweighs the slope of the rest. There its vectors are the sides of a triangle.
    """
    fixed, *arms = (evaluated(z, values) for z in CROSSING.vectors)
    base, (l1, l2) = abs(fixed), map(abs, arms)
    if evaluated(CROSSING.free, values) == 0 or not abs(l1 - l2) <= base <= l1 + l2:
        return 0
    if base == 0:
        raise Unproved(f"{_BASE} is zero and the bars are equally long, where "
                       f"spring {SPRINGS.index(CROSSING) + 1} has no length on a circle")  # fmt: skip
    angles = [ball_of((z**2 - y**2 - fixed**2) / (2 * fixed * y)).acos() for y, z in (arms, arms[::-1])]
    peaks = 0
    for side in (1, -1):
        at = side * angles[0], side * angles[1]
        balance = energy.cone(*at, energy(*at))
        if balance < 0:
            peaks += 1
        elif not balance > 0:
            raise Unproved(
                f"an equilibrium may be at the point where spring {SPRINGS.index(CROSSING) + 1} has length zero"
            )
    return peaks


def _narrow(values: Values, solution: Solution, k: int) -> Zero | None:
    """The one equilibrium in a stored box that is narrow; None where a search has to tell."""
    _check_box(solution, k)

    def function() -> Function:
        energy = energy_at(values)

        def at(box: Sequence[arb]) -> tuple[Sequence[arb], Matrix] | None:
            one, two = box
            d = energy(one, two)
            if d.short or energy.one_sided(one, two):
                return None
            return (d.e1, d.e2), [[d.e11, d.e12], [d.e21, d.e22]]

        return at

    found = judged(function, solution)
    if found is None:
        return None
    if not found.holds:
        return only([], solution, k)  # which refuses it
    with ctx.workprec(_BOX_PRECISION):
        one, two = found.within
        signs = signs_of(energy_at(values)(one, two))
    (x, y), (r1, r2) = found.in_floats()
    # nothing is said of what is around the box
    return None if signs is None else Zero((x, y), (r1, r2), (0.0, 0.0), signs)


def _check_box(solution: Solution, k: int) -> None:
    if len(solution.center) != 2 or not 0 < solution.radius <= 1 or any(abs(x) > 8 for x in solution.center):
        raise Violation(f"box {k} of the solutions is not a box of two angles")


def _only(energy: Energy, solution: Solution, k: int) -> Zero:
    """The one equilibrium in a stored box."""
    _check_box(solution, k)
    x, y = (float(c) for c in solution.center)
    # floats have the centers and radii of stored boxes exactly, or nearly: then the box is made a little larger
    radius = float(solution.radius) * (1 + 2.0**-40) + 2.0**-50
    start: Square = (x, radius, y, radius)
    with ctx.workprec(_BOX_PRECISION):
        inside, _ = equilibria(energy, False, [start], smallest=energy.resolution(min(MIN_HALF_WIDTH, radius / 1024)))
        return only(inside, solution, k)
