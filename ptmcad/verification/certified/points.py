"""Checks of the counts of a certified map: at every cell's sample, proved once more.

Guarantee: exact at the samples. That the counts hold in the whole cells rests on the cover, of which
`ptmcad.verification.certified.sampling` tries points.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, ctx

from ptmcad.answer.counts import MorseIndex
from ptmcad.answer.regionmap import Cell, Solution
from ptmcad.mechanism import Kind
from ptmcad.question.slice import Count
from ptmcad.text.numerals import text_of
from ptmcad.verification.certified.energy import Energy
from ptmcad.verification.certified.equilibria import MIN_HALF_WIDTH, TORUS, Equilibrium, Square, Unproved, equilibria
from ptmcad.verification.certified.parameters import Values, energy_at, exact, values_at
from ptmcad.verification.certified.vectors import CROSSING, SPRINGS, TURNED, evaluated
from ptmcad.verification.claims import Claims
from ptmcad.verification.derivation import MECHANISM
from ptmcad.verification.report import Violation

PRECISIONS = (53, 128, 320)
_BOX_PRECISION = 128
_BASE = MECHANISM.first(Kind.BASE)
MINIMA = (Count.STABLE, Count.ADMISSIBLE)


@dataclass(frozen=True, slots=True)
class Counts:
    """What a `Count` asks for; None what it does not need."""

    total: int | None
    stable: int | None
    index: MorseIndex | None
    admissible: int | None

    def __str__(self) -> str:
        parts = [("total", self.total), ("stable", self.stable), ("index", self.index), ("admissible", self.admissible)]
        return ", ".join(f"{name} {value}" for name, value in parts if value is not None)


def stored(cell: Cell) -> Counts:
    """The counts of a cell as they are stored."""
    return Counts(cell.total, cell.stable, cell.index, cell.admissible)


def differs(cell: Cell, true: Counts) -> bool:
    """Whether the stored counts of a cell are not these."""
    return stored(cell) != true


def check_points(claims: Claims) -> str:
    """Counts and stored solutions of every cell."""
    number = 0
    for n, cell in enumerate(claims.result.cells):
        where = _where(claims, *cell.sample)
        try:
            values = values_at(claims, *cell.sample)
            found = _check_cell(claims.result.slice.count, cell, values)
        except Unproved as reason:
            raise Violation(f"cell {n}: the counts {where} could not be confirmed: {reason}") from None
        except Violation as violation:
            raise Violation(f"cell {n}, {where}: {violation}") from None
        number += found
    return f"{len(claims.result.cells)} samples, {number} equilibria"


def _where(claims: Claims, x: Fraction, y: Fraction) -> str:
    one, two = claims.result.slice.axis_names
    return f"at {one}={text_of(x)}, {two}={text_of(y)}"


def _check_cell(count: Count, cell: Cell, values: Values) -> int:
    energy, found = all_equilibria(values, count)
    true = counts_of(energy, values, found, count)
    if differs(cell, true):
        raise Violation(f"said to have {stored(cell)}; there are {true}")
    kept = [e for e in found if count not in MINIMA or e.signs == "++"]
    if len(cell.solutions) != len(kept):
        raise Violation(f"{len(cell.solutions)} boxes of solutions for {len(kept)} equilibria")
    taken: set[int] = set()
    with ctx.workprec(_BOX_PRECISION):
        # the counts may be certain with parameters that were rounded too much to say what is in a small box
        energy = energy_at(values)
    for k, solution in enumerate(cell.solutions):
        e = _only(energy, solution, k)
        match = [i for i, other in enumerate(kept) if _same(e, other)]
        if len(match) != 1 or match[0] in taken:
            raise Violation(
                f"the solution {k} near ({e.center[0]:.6g}, {e.center[1]:.6g}) is stored twice, or not asked for"
            )
        if kept[match[0]].signs != solution.signs:
            raise Violation(
                f"the Hessian at the solution {k} has eigenvalues of signs {e.signs}, not {solution.signs!r}"
            )
        taken.add(match[0])
    return len(kept)


def all_equilibria(values: Values, count: Count) -> tuple[Energy, list[Equilibrium]]:
    """All equilibria at exact parameters, or all minima where no more is asked for; with rising precision.

    Raises
    ------
    Unproved
        When they cannot be decided even then.
    """
    if count not in MINIMA and any(evaluated(s.free, values) and s.has_crease(values) for s in TURNED):
        raise Unproved(f"{_BASE} equals the length of a bar, where the energy has a crease")
    reason: Unproved | None = None
    for bits in PRECISIONS:
        with ctx.workprec(bits):
            energy = energy_at(values)
            try:
                return energy, equilibria(
                    energy, count in MINIMA, (TORUS,), smallest=energy.resolution(MIN_HALF_WIDTH)
                )[0]
            except Unproved as unproved:
                reason = unproved
    assert reason is not None
    raise reason


def counts_of(energy: Energy, values: Mapping[str, Fraction], found: list[Equilibrium], count: Count) -> Counts:
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


def admissible(energy: Energy, e: Equilibrium) -> bool:
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
    angles = [exact((z**2 - y**2 - fixed**2) / (2 * fixed * y)).acos() for y, z in (arms, arms[::-1])]
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


def _only(energy: Energy, solution: Solution, k: int) -> Equilibrium:
    """The one equilibrium in a stored box."""
    if len(solution.center) != 2 or not 0 < solution.radius <= 1 or any(abs(x) > 8 for x in solution.center):
        raise Violation(f"box {k} of the solutions is not a box of two angles")
    x, y = (float(c) for c in solution.center)
    # floats have the centers and radii of stored boxes exactly, or nearly: then the box is made a little larger
    radius = float(solution.radius) * (1 + 2.0**-40) + 2.0**-50
    start: Square = (x, radius, y, radius)
    with ctx.workprec(_BOX_PRECISION):
        inside, _ = equilibria(energy, False, [start], smallest=energy.resolution(min(MIN_HALF_WIDTH, radius / 1024)))
        held = [e for e in inside if _in(e, solution)]
        open_ = [e for e in inside if e not in held and not _out(e, solution)]
    if len(held) != 1 or open_:
        raise Violation(f"box {k} of the solutions, around ({x:.6g}, {y:.6g}), has {len(held)} equilibria, not one")
    return held[0]


def _in(e: Equilibrium, solution: Solution) -> bool:
    radius = exact(solution.radius)
    return all(
        bool(abs(angle - exact(center)) <= radius) for angle, center in zip(e.within, solution.center, strict=True)
    )


def _out(e: Equilibrium, solution: Solution) -> bool:
    radius = exact(solution.radius)
    return any(
        bool(abs(angle - exact(center)) > radius) for angle, center in zip(e.within, solution.center, strict=True)
    )


def _same(one: Equilibrium, two: Equilibrium) -> bool:
    """Whether an equilibrium lies where another one is alone."""
    full = 2 * arb.pi()
    return all(
        bool(abs(angle - middle - round((float(angle.mid()) - middle) / 6.283185307179586) * full) < alone)
        for angle, middle, alone in zip(one.within, two.center, two.alone, strict=True)
    )
