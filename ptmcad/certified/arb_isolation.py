"""Isolated solutions in Arb's ball arithmetic: for what floats cannot separate, and for any number
of digits.

Guarantee: as for `ptmcad.certified.uniqueness`, with the same lemmas but none of its code.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat, ctx, fmpq

from ptmcad.certified.equationsystem import EquationSystem
from ptmcad.formulas.ballarithmetic import EmptyMeet, run_arb

Box = tuple[arb, ...]
"""The balls of all variables, by number; those that are not searched are the same in all boxes."""


def newton(system: EquationSystem, box: Box, precision: int) -> tuple[Box, bool] | None:
    """The box that the linearised equations leave of a box, and whether it is proved to hold
    exactly one zero.

    None when there is no solution in the box (discarding formulas included).
    """
    own = system.arguments
    unknowns, size = [int(k) for k in own.unknowns], len(own.unknowns)
    try:
        values = run_arb(system.tape, box, precision)
    except EmptyMeet:
        return None
    if any(
        _nonzero(values[int(place)])
        for group in (own.cheap, own.rest, own.costly)
        for place in group
    ):
        return None
    if any(values[int(place)] < 0 for place in own.nonnegative):
        return None
    with ctx.workprec(precision):
        middle = list(box)
        for k in unknowns:
            middle[k] = box[k].mid()
        at = run_arb(system.tape, middle, precision, 2)
        entries = [values[int(place)] for place in own.jacobian.flat]
        if not all(entry.is_finite() for entry in entries):
            return box, False
        jacobian = arb_mat(size, size, entries)
        residual = arb_mat(size, 1, [at[int(place)] for place in own.equations])
        radii = [box[k].rad() for k in unknowns]
        shrunk, proved = list(box), False
        for complete in (True, False):
            rows, pivots = _elimination(
                arb_mat(size, size, [entry.mid() for entry in entries]), radii, complete
            )
            matrix, constant = rows * jacobian, rows * residual
            inside = len(pivots) == size
            for i, pivot in pivots.items():
                rest = constant[i, 0]
                for j, other in enumerate(unknowns):
                    if j != pivot:
                        rest += matrix[i, j] * (box[other] - middle[other])
                factor, k = matrix[i, pivot], unknowns[pivot]
                if not _nonzero(factor):
                    inside = False
                    if _nonzero(rest + factor * (box[k] - middle[k])):
                        return None
                    continue
                found = middle[k] - rest / factor
                if not found.overlaps(shrunk[k]):
                    return None
                inside = inside and bool(box[k].contains_interior(found))
                shrunk[k] = found.intersection(shrunk[k])
            if inside:
                proved = True
                break
        return tuple(shrunk), proved


def _elimination(
    middle: arb_mat, radii: Sequence[arb], complete: bool
) -> tuple[arb_mat, dict[int, int]]:
    """Row operations that solve for one unknown in each row, and which; any are valid, rounding
    needs no care.

    Gauss-Jordan elimination with full pivoting; when not ``complete``, without its steps upwards,
    so that next to a singular matrix the rows that are regular stay useful.
    """
    size = middle.nrows()
    rows = arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
    pivots: dict[int, int] = {}
    for _ in range(size):
        current = rows * middle
        free = [
            (i, j)
            for i in range(size)
            if i not in pivots
            for j in range(size)
            if j not in pivots.values()
        ]
        row, column = max(
            free, key=lambda place: float(abs(current[place].mid()) * radii[place[1]])
        )
        factor = current[row, column].mid()
        if not _nonzero(factor):
            break
        pivots[row] = column
        for i in range(size):
            if i != row and (complete or i not in pivots):
                ratio = (current[i, column] / factor).mid()
                for j in range(size):
                    rows[i, j] = (rows[i, j] - ratio * rows[row, j]).mid()
    return rows, pivots


def _nonzero(value: arb) -> bool:
    return bool(value > 0 or value < 0)


def largest_radius(system: EquationSystem, box: Box) -> arb:
    """The largest radius in the unknowns, as an exact ball."""
    widest = arb(0)
    for k in system.arguments.unknowns:
        radius = box[int(k)].rad()
        widest = radius if radius > widest else widest
    return widest


def refined(equations: EquationSystem, box: Box, precision: int) -> Box:
    """The zero in a box that holds exactly one, as narrow as the precision allows."""
    finest = arb(fmpq(1, 4**precision))  # zeros that are dyadic have ever smaller boxes
    while True:
        step = newton(equations, box, precision)
        if step is None:
            raise ArithmeticError("a zero that was proved to exist is not there")
        size = largest_radius(equations, step[0])
        if not 100 * size < 99 * largest_radius(equations, box) or size < finest:
            return step[0]
        box = step[0]


def isolate_arb(
    system: EquationSystem,
    equations: EquationSystem,
    start: Sequence[Box],
    precision: int,
    budget: int,
) -> list[tuple[Box, Box]] | None:
    """Isolate the solutions in some boxes: for each the box in which it is the only one, and a
    narrow one in there.

    A zero may be found more than once. None when the budget does not suffice.

    Parameters
    ----------
    system : with what discards boxes that hold no solution looked for.
    equations : the same equations alone, for the proofs.
    precision : in bits; boxes are bisected down to two thirds as many.
    budget : number of boxes.
    """
    found: list[tuple[Box, Box]] = []
    waiting = list(start)
    finest = arb(fmpq(1, 2 ** (precision * 2 // 3)))
    while waiting:
        budget -= 1
        if budget < 0:
            return None
        box = waiting.pop()
        step = newton(system, box, precision)
        if step is None:
            continue
        size = largest_radius(system, step[0])
        proved = _proved(equations, step[0], size, precision)
        if proved is not None:
            found.append((proved, refined(equations, proved, precision)))
        elif 2 * size < largest_radius(system, box):
            waiting.append(step[0])
        elif size < finest:
            return None
        else:
            waiting.extend(_halves(system, step[0], precision))
    return found


def _proved(equations: EquationSystem, box: Box, size: arb, precision: int) -> Box | None:
    """A box around the given one, proved to hold exactly one zero."""
    with ctx.workprec(precision):
        least = arb(fmpq(1, 2 ** (precision // 2)))
        wide = list(box)
        for k in equations.arguments.unknowns:
            wide[int(k)] = arb(box[int(k)].mid(), 2 * size + least)
        step = newton(equations, tuple(wide), precision)
        return tuple(wide) if step is not None and step[1] else None


def _halves(system: EquationSystem, box: Box, precision: int) -> tuple[Box, Box]:
    with ctx.workprec(2 * precision):
        widest = max((int(k) for k in system.arguments.unknowns), key=lambda k: float(box[k].rad()))
        middle, half = box[widest].mid(), box[widest].rad() / 2
        left, right = list(box), list(box)
        left[widest], right[widest] = arb(middle - half, half), arb(middle + half, half)
        return tuple(left), tuple(right)
