"""Proofs that a box holds exactly one zero of a square system, by the signs of its equations on
opposite faces.

Guarantee: a box of which `isolated` says True holds exactly one zero of the equations, an inner
point. (Lemma 9 of docs/soundness.md.)

References
----------
Miranda, Boll. Un. Mat. Ital. 3 (1940); Neumaier, Interval Methods for Systems of Equations (1990),
section 5.1.
"""

from __future__ import annotations

import numpy as np

from ptmcad.certified.contraction import (
    Workspace,
    linearise,
    precondition,
    row_coefficient,
    row_constant,
)
from ptmcad.certified.system import Arguments
from ptmcad.formulas.compiled import compiled, inlined
from ptmcad.formulas.intervals import Floats
from ptmcad.formulas.rounding import down, magnitude, mignitude, up

INFLATION = 1e-5
"""The first attempt widens a box by this much on each side; each further one by 1/8 of the last."""
ATTEMPTS = 10


@compiled
def inflated(equations: Arguments, box: Floats, weights: Floats, work: Workspace) -> Floats:
    """A box around the given one that is proved to hold exactly one zero; an empty array if none is
    found.

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
    """Whether it is proved that the equations have exactly one zero in the box, and that it is an
    inner point.

    With Y the preconditioner, A = Y J(box), c = Y f(middle) and r the half-widths, |c_i| + sum_{j
    not i} |A_ij| r_j <
    |A_ii| r_i for each i. So (Y f)_i has opposite signs on opposite faces, which proves existence (Miranda), and no
    matrix in A is singular, which proves uniqueness.
    """
    if linearise(system, box_low, box_high, work) < 1:
        return False
    unknowns, middle, radius, pivots = system.unknowns, work.middle_low, work.radius, work.pivots
    precondition(work, radius)
    for i in range(len(unknowns)):
        if pivots[i] < 0:
            return False
        c_low, c_high = row_constant(i, system.equations, work)
        others, own = max(abs(c_low), abs(c_high)), 0.0
        for j in range(len(unknowns)):
            u, v = row_coefficient(i, j, work)
            if j == pivots[i]:
                # the half-width about the middle, rounded down
                x = unknowns[j]
                own = down(
                    mignitude(u, v)
                    * min(down(box_high[x] - middle[x]), down(middle[x] - box_low[x]))
                )
            else:
                others = up(others + up(magnitude(u, v) * radius[j]))
        if not others < own:
            return False
    return True
