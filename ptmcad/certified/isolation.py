"""Branch and prune for isolated solutions: boxes with exactly one solution each, and what could not be decided.

Guarantee: every solution in the boxes at the start lies in one of the boxes at the end (proved, open or waiting); each
proved box holds exactly one zero of the equations, and it lies in the narrow box that comes with it. Two proved boxes
may hold the same zero. (Lemma 9 of docs/soundness.md.)

References
----------
Miranda, Boll. Un. Mat. Ital. 3 (1940); Neumaier, Interval Methods for Systems of Equations (1990), section 5.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.arithmetic import down, mignitude, multiply, up
from ptmcad.certified.compiled import compiled
from ptmcad.certified.contraction import Floats, Workspace, contract, precondition, workspace
from ptmcad.certified.evaluation import run
from ptmcad.certified.search import CUT, Boxes
from ptmcad.certified.system import Arguments

MAX_PROOF_WIDTH = 1e-2
"""Boxes at most this wide are tried for a proof of existence."""
INFLATION = 1e-5
"""The first attempt widens a box by this much on each side; each further one by 1/8 of the last."""
ATTEMPTS = 10


@compiled
def holds_one(system: Arguments, box_low: Floats, box_high: Floats, work: Workspace) -> bool:
    """Whether it is proved that the equations have exactly one zero in the box, and that it is an inner point.

    With Y the preconditioner, A = Y J(box), c = Y f(middle) and r the half-widths, |c_i| + sum_{j not i} |A_ij| r_j <
    |A_ii| r_i for each i. So (Y f)_i has opposite signs on opposite faces, which proves existence (Miranda), and no
    matrix in A is singular, which proves uniqueness.
    """
    program, stages, unknowns, equations, jacobian, _, _, _, _ = system
    low, high, low_at, high_at, middle_low, middle_high, radius, _, _, matrix, inverse = work
    m, n = jacobian.shape
    if not run(program, box_low, box_high, low, high, 0, stages[3]):
        return False
    for k in range(box_low.shape[0]):
        middle_low[k], middle_high[k] = box_low[k], box_high[k]
    for j in range(n):
        k = unknowns[j]
        middle = 0.5 * (box_low[k] + box_high[k])
        middle_low[k] = middle_high[k] = middle
        radius[j] = min(down(box_high[k] - middle), down(middle - box_low[k]))
        if not radius[j] > 0:
            return False
    run(program, middle_low, middle_high, low_at, high_at, 0, stages[1])
    for i in range(m):
        for j in range(n):
            place = jacobian[i, j]
            matrix[i, j] = 0.5 * (low[place] + high[place])
            if not abs(matrix[i, j]) < 1e150:
                return False
    pivots = np.empty(m, np.int64)
    precondition(matrix, inverse, radius, pivots, 1e-200)
    for i in range(m):
        if pivots[i] < 0:
            return False
        c_low = c_high = 0.0
        for k in range(m):
            u, v = multiply(inverse[i, k], inverse[i, k], low_at[equations[k]], high_at[equations[k]])
            c_low, c_high = down(c_low + u), up(c_high + v)
        others, own = max(abs(c_low), abs(c_high)), 0.0
        for j in range(n):
            u = v = 0.0
            for k in range(m):
                factor = inverse[i, k]
                p, q = multiply(factor, factor, low[jacobian[k, j]], high[jacobian[k, j]])
                u, v = down(u + p), up(v + q)
            if j == pivots[i]:
                own = down(mignitude(u, v) * radius[j])
            else:
                # the half-width about the middle, rounded up
                k = unknowns[j]
                reach = up(max(box_high[k] - middle_low[k], middle_low[k] - box_low[k]))
                others = up(others + up(max(abs(u), abs(v)) * reach))
        if not others < own:
            return False
    return True


@compiled
def _enlarged(store: Boxes, count: int) -> Boxes:
    larger = np.empty((2 * store.shape[0], store.shape[1]))
    larger[:count] = store[:count]
    return larger


@compiled
def isolate(
    system: Arguments,
    narrowing: Arguments,
    start: Boxes,
    finest: float,
    budget: int,
    allowed: int,
    weights: NDArray[np.float64],
) -> tuple[Boxes, Boxes, Boxes, int]:
    """Isolate the solutions of a square system.

    Parameters
    ----------
    system : with what discards boxes that hold no solution looked for.
    narrowing : the same equations alone, for the proofs.
    finest : boxes at most this wide are not bisected further; widths count by their weights.
    budget : number of boxes after which the search stops.
    allowed : number of boxes that may stay open; the search stops beyond.
    weights : shape (v,), positive: of the variables' widths.

    Returns
    -------
    unique, narrow : boxes that hold exactly one zero each, and narrower ones around it, row by row.
    left : boxes that are not decided; the last ones are those that were not treated.
    used : number of boxes treated.
    """
    variables = start.shape[1] // 2
    unknowns = system[2]
    m, n = system[4].shape
    work = workspace(max(system[0][0].shape[0], narrowing[0][0].shape[0]), variables, m, n)
    top = start.shape[0]
    stack = np.empty((max(256, 2 * top), 2 * variables))
    stack[:top] = start[::-1]
    unique, narrow, left = np.empty((64, 2 * variables)), np.empty((64, 2 * variables)), np.empty((64, 2 * variables))
    found = open_boxes = used = 0
    low, high = np.empty(variables), np.empty(variables)
    wide_low, wide_high = np.empty(variables), np.empty(variables)
    while top > 0 and used < budget and open_boxes <= allowed:
        top -= 1
        used += 1
        low[:] = stack[top, :variables]
        high[:] = stack[top, variables:]
        if not contract(system, low, high, work):
            continue
        widest, width = 0, -1.0
        for x in unknowns:
            size = (high[x] - low[x]) * weights[x]
            if size > width:
                widest, width = x, size
        if width <= MAX_PROOF_WIDTH:
            inflation, proved = INFLATION, False
            for _ in range(ATTEMPTS):
                wide_low[:], wide_high[:] = low, high
                for x in unknowns:
                    wide_low[x], wide_high[x] = low[x] - inflation / weights[x], high[x] + inflation / weights[x]
                proved = holds_one(narrowing, wide_low, wide_high, work)
                if proved or inflation * 8 < width:
                    break
                inflation /= 8
            if proved:
                if found == unique.shape[0]:
                    unique, narrow = _enlarged(unique, found), _enlarged(narrow, found)
                unique[found, :variables] = wide_low
                unique[found, variables:] = wide_high
                # several rounds, because each stops after some sweeps
                for _ in range(3):
                    contract(narrowing, wide_low, wide_high, work)
                narrow[found, :variables] = wide_low
                narrow[found, variables:] = wide_high
                found += 1
                continue
        middle = low[widest] + CUT * (high[widest] - low[widest])
        if width <= finest or not (low[widest] < middle < high[widest]):
            if open_boxes == left.shape[0]:
                left = _enlarged(left, open_boxes)
            left[open_boxes, :variables] = low
            left[open_boxes, variables:] = high
            open_boxes += 1
            continue
        if top + 2 > stack.shape[0]:
            stack = _enlarged(stack, top)
        for k in range(2):
            stack[top + k, :variables] = low
            stack[top + k, variables:] = high
        stack[top, variables + widest] = middle
        stack[top + 1, widest] = middle
        top += 2
    return unique[:found].copy(), narrow[:found].copy(), np.concatenate((left[:open_boxes], stack[:top])), used
