"""Contraction of a box around the solutions of a system: natural tests, mean-value test, and the
linearised equations.

Guarantee: a box that is discarded holds no solution, and a contracted box holds every solution of
the box that it was made of. (Lemmas 4 to 8, 24 and 25 of docs/soundness.md.)

References
----------
Neumaier, Interval Methods for Systems of Equations (1990), chapter 5; Hansen & Sengupta, BIT 21
(1981).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ptmcad.certified.equationsystem import Arguments
from ptmcad.certified.linear import Linear, contract_linear
from ptmcad.formulas.compilation import ZERO, compiled, inlined
from ptmcad.formulas.intervalarithmetic import run
from ptmcad.formulas.rounding import down, magnitude, multiply, reciprocal, up
from ptmcad.formulas.tape import Floats, Indices

MIN_PIVOT = 1e-200
SWEEPS = 10
SWEEP_SHRINKAGE = 0.8
"""Another sweep follows as long as some width shrinks below this part of itself."""


class Workspace(NamedTuple):
    """Arrays that a search uses again for every box; flat, because nested ones slow the search down
    by a tenth.

    Attributes
    ----------
    low, high : the tape's values over the box.
    low_at, high_at : its values at the middle.
    middle_low, middle_high : the box with its unknowns at their middles.
    radius : of each unknown.
    j_low, j_high : the Jacobian over the box, shape (m, n).
    matrix, inverse : what `precondition` eliminates, and the row operations; shapes (m, n) and (m,
        m).
    pivots : the column that each row solves for, or -1.
    """

    low: Floats
    high: Floats
    low_at: Floats
    high_at: Floats
    middle_low: Floats
    middle_high: Floats
    radius: Floats
    j_low: Floats
    j_high: Floats
    matrix: Floats
    inverse: Floats
    pivots: Indices


@compiled
def workspace(system: Arguments, variables: int) -> Workspace:
    """Arrays for boxes of a system, or of another one with the same equations whose tape is at most as
    long.
    """
    length = len(system.program.operations)
    m, n = system.jacobian.shape
    return Workspace(
        np.empty(length), np.empty(length), np.empty(length), np.empty(length),
        np.empty(variables), np.empty(variables), np.empty(n),
        np.empty((m, n)), np.empty((m, n)), np.empty((m, n)), np.empty((m, m)), np.empty(m, np.int64),
    )  # fmt: skip


@inlined
def discarded(low: Floats, high: Floats, vanishing: Indices) -> bool:
    """Whether one of the formulas that vanish at solutions has no zero."""
    for place in vanishing:
        if low[place] > 0 or high[place] < 0:
            return True
    return False


@compiled
def precondition(work: Workspace, widths: Floats) -> None:
    """Gauss-Jordan elimination of the matrix with full pivoting, columns weighted by ``widths``.

    Rounding needs no care here: any matrix is a valid preconditioner.
    """
    middle, inverse, pivots = work.matrix, work.inverse, work.pivots
    m, n = middle.shape
    for i in range(m):
        pivots[i] = -1
        for j in range(m):
            inverse[i, j] = 1.0 if i == j else 0.0
    for _ in range(m):
        best, row, column = MIN_PIVOT, -1, -1
        for i in range(m):
            if pivots[i] >= 0:
                continue
            for j in range(n):
                taken = False
                for k in range(m):
                    if pivots[k] == j:
                        taken = True
                size = abs(middle[i, j]) * widths[j]
                if not taken and size > best:
                    best, row, column = size, i, j
        if row < 0:
            return
        pivots[row] = column
        factor = 1 / middle[row, column]
        for j in range(n):
            middle[row, j] *= factor
        for j in range(m):
            inverse[row, j] *= factor
        for i in range(m):
            other = middle[i, column]
            if i != row and other != 0.0:
                for j in range(n):
                    middle[i, j] -= other * middle[row, j]
                for j in range(m):
                    inverse[i, j] -= other * inverse[row, j]


@compiled
def contract(system: Arguments, box_low: Floats, box_high: Floats, work: Workspace) -> bool:
    """Shrink the box in place around the solutions in it; False when there are none."""
    pivots = work.pivots
    for _ in range(SWEEPS):
        usable = linearise(system, box_low, box_high, work)
        if usable < 0:
            return False
        if usable == 0:
            return True
        precondition(work, work.radius)
        shrunk = False
        for i in range(len(pivots)):
            if pivots[i] < 0:
                continue
            step = solve_row(system, i, pivots[i], box_low, box_high, work)
            if step < 0:
                return False
            shrunk = shrunk or step > 0
        if not shrunk:
            return True
    return True


@inlined
def determined(quotient: Indices, low: Floats, high: Floats) -> bool:
    """Whether a row of ``Arguments.solved`` tells its variable from the others over the whole box."""
    slope = quotient[2]
    positive: bool = low[slope] > 0
    negative: bool = high[slope] < 0
    return positive or negative


@compiled
def narrowed(
    quotient: Indices, low: Floats, high: Floats, box_low: Floats, box_high: Floats
) -> bool:
    """Intersect the variable of a row of ``Arguments.solved`` with its value at solutions; False when
    nothing is left.
    """
    if determined(quotient, low, high):
        x, rest, slope = quotient[0], quotient[1], quotient[2]
        u, v = reciprocal(low[slope], high[slope])
        u, v = multiply(-high[rest], -low[rest], u, v)
        box_low[x] = max(box_low[x], u)
        box_high[x] = min(box_high[x], v)
        if box_low[x] > box_high[x]:
            return False
    return True


@compiled
def survives(system: Arguments, box_low: Floats, box_high: Floats, work: Workspace) -> bool:
    """Narrow the axes that are solved for, and run all stages but the Jacobian; False when there is
    no solution.
    """
    program, stages, _, _, _, cheap, rest, costly, nonnegative, solved, solved_end = system
    low, high = work.low, work.high
    begin = ZERO
    if len(solved) > 0:
        if not run(program, box_low, box_high, low, high, ZERO, solved_end):
            return False
        begin = solved_end
        for k in range(len(solved)):
            if not narrowed(solved[k], low, high, box_low, box_high):
                return False
    for stage in range(3):
        if not run(program, box_low, box_high, low, high, begin, stages[stage]):
            return False
        begin = stages[stage]
        if discarded(low, high, cheap if stage == 0 else rest if stage == 1 else costly):
            return False
    for place in nonnegative:
        if high[place] < 0:
            return False
    return True


@compiled
def contract_curve(
    system: Arguments, box_low: Floats, box_high: Floats, work: Workspace, space: Linear
) -> bool:
    """Shrink the box of a curve as `contract` does, but by affine forms, without derivatives."""
    for _ in range(SWEEPS):
        if not survives(system, box_low, box_high, work):
            return False
        step = contract_linear(system, box_low, box_high, work.low, work.high, space)
        if step < 0:
            return False
        if step == 0:
            return True
    return True


@compiled
def linearise(system: Arguments, box_low: Floats, box_high: Floats, work: Workspace) -> int:
    """Test a box and enclose its equations' derivatives: -1 no solution, 0 a derivative may be
    unbounded or the middle tells nothing, 1 done.

    Afterwards ``work`` has the middle and the radii of the box, the equations there, their
    derivatives over the box, and the middles of these.
    """
    program, stages, unknowns, equations, jacobian = system[:5]
    low, high, low_at, high_at, middle_low, middle_high, radius, j_low, j_high, matrix = work[:10]
    m, n = jacobian.shape
    if not survives(system, box_low, box_high, work):
        return -1
    if not run(program, box_low, box_high, low, high, stages[2], stages[3]):
        return -1
    for k in range(box_low.shape[0]):
        middle_low[k], middle_high[k] = box_low[k], box_high[k]
    for j in range(n):
        k = unknowns[j]
        middle = 0.5 * (box_low[k] + box_high[k])
        middle_low[k] = middle_high[k] = middle
        radius[j] = up(max(box_high[k] - middle, middle - box_low[k]))
    # only the equations: at a middle that is no solution, the two formulas of a `meet` may differ
    if not run(program, middle_low, middle_high, low_at, high_at, ZERO, stages[1]):
        return 0
    usable = True
    for i in range(m):
        u, v = low_at[equations[i]], high_at[equations[i]]
        for j in range(n):
            place = jacobian[i, j]
            j_low[i, j], j_high[i, j] = low[place], high[place]
            matrix[i, j] = 0.5 * (low[place] + high[place])
            usable = usable and abs(matrix[i, j]) < 1e150
            change = up(magnitude(low[place], high[place]) * radius[j])
            u, v = down(u - change), up(v + change)
        if u > 0 or v < 0:
            return -1
    return 1 if usable else 0


@compiled
def row_constant(i: int, equations: Indices, work: Workspace) -> tuple[float, float]:
    """Row i of the preconditioned equations at the middle."""
    low_at, high_at, inverse = work.low_at, work.high_at, work.inverse
    c_low = c_high = 0.0
    for k in range(inverse.shape[0]):
        u, v = multiply(inverse[i, k], inverse[i, k], low_at[equations[k]], high_at[equations[k]])
        c_low, c_high = down(c_low + u), up(c_high + v)
    return c_low, c_high


@compiled
def row_coefficient(i: int, j: int, work: Workspace) -> tuple[float, float]:
    """Entry j of row i of the preconditioned derivatives."""
    j_low, j_high, inverse = work.j_low, work.j_high, work.inverse
    u = v = 0.0
    for k in range(inverse.shape[0]):
        factor = inverse[i, k]
        if factor >= 0:
            u, v = down(u + down(factor * j_low[k, j])), up(v + up(factor * j_high[k, j]))
        else:
            u, v = down(u + down(factor * j_high[k, j])), up(v + up(factor * j_low[k, j]))
    return u, v


@compiled
def row_rest(
    i: int,
    kept: tuple[int, int],
    system: Arguments,
    box_low: Floats,
    box_high: Floats,
    work: Workspace,
) -> tuple[float, float]:
    """Row i of the preconditioned linear equations over the box, without the terms of two columns,
    which may be the same one.
    """
    unknowns, middle = system.unknowns, work.middle_low
    c_low, c_high = row_constant(i, system.equations, work)
    for j in range(len(unknowns)):
        if j not in kept:
            u, v = row_coefficient(i, j, work)
            x = unknowns[j]
            u, v = multiply(u, v, down(box_low[x] - middle[x]), up(box_high[x] - middle[x]))
            c_low, c_high = down(c_low + u), up(c_high + v)
    return c_low, c_high


@inlined
def solve_row(
    system: Arguments, i: int, pivot: int, box_low: Floats, box_high: Floats, work: Workspace
) -> int:
    """Row i of the preconditioned linear equations, solved for its pivot: -1 no solution, 1 much
    narrower, 0 else.
    """
    unknowns, middle_low, radius = system.unknowns, work.middle_low, work.radius
    c_low, c_high = row_rest(i, (pivot, pivot), system, box_low, box_high, work)
    p_low, p_high = row_coefficient(i, pivot, work)
    # c + p (x - middle) = 0 for the pivot's unknown x
    if not (p_low > 0 or p_high < 0):
        reach = up(magnitude(p_low, p_high) * radius[pivot])
        return -1 if down(c_low - reach) > 0 or up(c_high + reach) < 0 else 0
    u, v = reciprocal(p_low, p_high)
    u, v = multiply(-c_high, -c_low, u, v)
    x = unknowns[pivot]
    u, v = down(middle_low[x] + u), up(middle_low[x] + v)
    before = box_high[x] - box_low[x]
    box_low[x] = max(box_low[x], u)
    box_high[x] = min(box_high[x], v)
    if box_low[x] > box_high[x]:
        return -1
    return 1 if box_high[x] - box_low[x] < SWEEP_SHRINKAGE * before else 0
