"""Proofs that a box holds exactly one zero of a square system, by the signs of its equations on opposite faces.

Guarantee: a box of which `isolated` says True holds exactly one zero of the equations, an inner point. (Lemma 9 of
docs/soundness.md.)

References
----------
Miranda, Boll. Un. Mat. Ital. 3 (1940); Neumaier, Interval Methods for Systems of Equations (1990), section 5.1.
"""

from __future__ import annotations

import numpy as np

from ptmcad.certified.arithmetic import down, mignitude, multiply, up
from ptmcad.certified.compiled import ZERO, compiled, inlined
from ptmcad.certified.contraction import Workspace, precondition, row_constant
from ptmcad.certified.evaluation import Floats, run
from ptmcad.certified.system import Arguments

INFLATION = 1e-5
"""The first attempt widens a box by this much on each side; each further one by 1/8 of the last."""
ATTEMPTS = 10


@compiled
def inflated(equations: Arguments, box: Floats, weights: Floats, work: Workspace) -> Floats:
    """A box around the given one that is proved to hold exactly one zero; an empty array if none is found.

    Parameters
    ----------
    box : shape (2v,): low ends, then high ends.
    weights : shape (v,), positive: of the variables' widths.
    """
    variables = len(weights)
    width = 0.0
    for x in equations.unknowns:
        width = max(width, (box[variables + x] - box[x]) * weights[x])
    inflation = INFLATION
    for _ in range(ATTEMPTS):
        wide = box.copy()
        for x in equations.unknowns:
            wide[x] = box[x] - inflation / weights[x]
            wide[variables + x] = box[variables + x] + inflation / weights[x]
        if holds_one(equations, wide[:variables], wide[variables:], work):
            return wide
        if inflation * 8 < width:
            break
        inflation /= 8
    return np.empty(0)


@inlined
def holds_one(system: Arguments, box_low: Floats, box_high: Floats, work: Workspace) -> bool:
    """Whether it is proved that the equations have exactly one zero in the box, and that it is an inner point.

    With Y the preconditioner, A = Y J(box), c = Y f(middle) and r the half-widths, |c_i| + sum_{j not i} |A_ij| r_j <
    |A_ii| r_i for each i. So (Y f)_i has opposite signs on opposite faces, which proves existence (Miranda), and no
    matrix in A is singular, which proves uniqueness.
    """
    program, stages, unknowns, equations, jacobian, _, _, _, _, _, _ = system
    low, high, low_at, high_at, middle_low, middle_high, radius, _, _, matrix, inverse = work
    m, n = jacobian.shape
    if not run(program, box_low, box_high, low, high, ZERO, stages[3]):
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
    run(program, middle_low, middle_high, low_at, high_at, ZERO, stages[1])
    for i in range(m):
        for j in range(n):
            place = jacobian[i, j]
            matrix[i, j] = 0.5 * (low[place] + high[place])
            if not abs(matrix[i, j]) < 1e150:
                return False
    pivots = np.empty(m, np.int64)
    precondition(matrix, inverse, radius, pivots)
    for i in range(m):
        if pivots[i] < 0:
            return False
        c_low, c_high = row_constant(i, equations, work)
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
