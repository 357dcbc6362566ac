"""Proofs that a box holds exactly one zero of a square system, by the signs of its equations on
opposite faces; and which of such boxes hold the same zero.

Guarantee: a box of which `holds_one` says True holds exactly one zero of the equations, an inner
point (Lemma 9 of docs/soundness.md). Two zeros are called one only when a box that holds exactly
one holds both (moved by full turns), and different only when narrow boxes around them are disjoint
(Lemma 10).

References
----------
Miranda, Boll. Un. Mat. Ital. 3 (1940); Neumaier, Interval Methods for Systems of Equations (1990),
section 5.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.contraction import (
    Workspace,
    linearise,
    precondition,
    row_coefficient,
    row_constant,
)
from ptmcad.certified.equationsystem import Arguments
from ptmcad.formulas.compilation import compiled, inlined
from ptmcad.formulas.rounding import down, magnitude, mignitude, up
from ptmcad.formulas.tape import Floats

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

    With Y the preconditioner, A = Y J(box), c = Y f(middle), r the half-widths and p the column that
    row i is solved for, |c_i| plus the sum of |A_ij| r_j over the other columns j is less than
    |A_ip| r_p for each i. So (Y f)_i has opposite signs on opposite faces, which proves existence
    (Miranda), and no matrix in A is singular, which proves uniqueness.
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


FULL_TURN = 6.283185307179586
_TURN_ERROR = 1e-14
"""More than the error of FULL_TURN, and of adding it to an angle under 60."""


def distinct(
    unique: Floats, narrow: Floats, first: int, periods: Floats
) -> NDArray[np.int64] | None:
    """Rows of zeros that are all different; every zero is one of them. None when this cannot be
    decided for some pair.

    Parameters
    ----------
    unique, narrow : (k, 2v): boxes with exactly one zero each, and narrower ones around the same
        zero.
    first : number of the first unknown; all variables from it on are unknowns.
    periods : shape (v,), for each variable `FULL_TURN` if it is an angle, else 0.
    """
    kept = np.empty(len(unique), np.int64)
    count = int(_distinct(unique, narrow, first, periods, kept))
    return None if count < 0 else kept[:count]


@compiled
def _distinct(
    unique: Floats,
    narrow: Floats,
    first: int,
    periods: NDArray[np.float64],
    kept: NDArray[np.int64],
) -> int:
    count = 0
    for i in range(unique.shape[0]):
        known = False
        for k in range(count):
            j = kept[k]
            relation = _relation(unique, narrow, first, periods, i, j)
            if relation < 0:
                relation = _relation(unique, narrow, first, periods, j, i)
            if relation < 0:
                return -1
            if relation > 0:
                known = True
                break
        if not known:
            kept[count] = i
            count += 1
    return count


@compiled
def _relation(
    unique: Floats, narrow: Floats, first: int, periods: NDArray[np.float64], i: int, j: int
) -> int:
    """1 when zero i, moved by full turns, lies in the box in which zero j is the only one; 0
    different; -1 unknown.
    """
    variables = unique.shape[1] // 2
    inside, separate = True, False
    for k in range(first, variables):
        low, high = narrow[i, k], narrow[i, variables + k]
        if not high - low < 0.5 or not narrow[j, variables + k] - narrow[j, k] < 0.5:
            return -1
        turns = 0.0
        if periods[k] > 0:
            turns = np.rint(
                (0.5 * (narrow[j, k] + narrow[j, variables + k]) - 0.5 * (low + high)) / periods[k]
            )
        error = 0.0 if turns == 0 else _TURN_ERROR
        low, high = low + turns * periods[k] - error, high + turns * periods[k] + error
        inside = inside and unique[j, k] <= low and high <= unique[j, variables + k]
        separate = separate or high < narrow[j, k] or low > narrow[j, variables + k]
    return 1 if inside else (0 if separate else -1)
