"""Branch and prune: boxes that may hold solutions of a system, contracted and bisected until they are small.

Guarantee: every solution in the boxes at the start lies in one of the boxes at the end, those still waiting included.
(Lemma 11 of docs/soundness.md.)

The search knows no mathematics: `ptmcad.certified.contraction` discards and shrinks.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ptmcad.certified.compiled import compiled
from ptmcad.certified.contraction import contract, workspace
from ptmcad.certified.system import Arguments

Boxes = NDArray[np.float64]
"""Shape (k, 2v): low ends of the v variables, then high ends."""
CUT = 0.5


@compiled
def search_curve(
    system: Arguments, start: Boxes, area: float, budget: int, weights: NDArray[np.float64]
) -> tuple[Boxes, Boxes, int]:
    """Enclose a curve in the plane of variables 0 and 1 (the first two unknowns).

    Parameters
    ----------
    area : boxes whose projection to the plane has at most this area are not bisected further.
    budget : number of boxes after which the search stops.
    weights : shape (v,): the variable whose width times its weight is largest is bisected.

    Returns
    -------
    small : boxes that were not bisected further, for their area or because no float lies between their ends.
    waiting : boxes that the budget did not reach.
    used : number of boxes treated.
    """
    variables = start.shape[1] // 2
    unknowns = system[2]
    m, n = system[4].shape
    work = workspace(system[0][0].shape[0], variables, m, n)
    top = start.shape[0]
    stack = np.empty((max(256, 2 * top), 2 * variables))
    stack[:top] = start
    small = np.empty((256, 2 * variables))
    found = used = 0
    low, high = np.empty(variables), np.empty(variables)
    while top > 0 and used < budget:
        top -= 1
        used += 1
        low[:] = stack[top, :variables]
        high[:] = stack[top, variables:]
        if not contract(system, low, high, work):
            continue
        widest, width = -1, -1.0
        for x in unknowns:
            middle = low[x] + CUT * (high[x] - low[x])
            size = (high[x] - low[x]) * weights[x]
            if size > width and low[x] < middle < high[x]:
                widest, width = x, size
        if widest < 0 or (high[0] - low[0]) * (high[1] - low[1]) <= area:
            if found == small.shape[0]:
                larger = np.empty((2 * found, 2 * variables))
                larger[:found] = small
                small = larger
            small[found, :variables] = low
            small[found, variables:] = high
            found += 1
            continue
        if top + 2 > stack.shape[0]:
            larger = np.empty((2 * stack.shape[0], 2 * variables))
            larger[:top] = stack[:top]
            stack = larger
        middle = low[widest] + CUT * (high[widest] - low[widest])
        for k in range(2):
            stack[top + k, :variables] = low
            stack[top + k, variables:] = high
        stack[top, variables + widest] = middle
        stack[top + 1, widest] = middle
        top += 2
    return small[:found].copy(), stack[:top].copy(), used
