"""Branch and prune: boxes that may hold solutions of a system, contracted and bisected until they
are small.

Guarantee: every solution in the boxes at the start lies in one of the boxes at the end, those still
waiting included. Each box that is called proved holds exactly one zero of the equations, and it
lies in the narrow box that comes with it; two proved boxes may hold the same zero. (Lemmas 9 and 11
of docs/soundness.md.)

The search knows no mathematics: `ptmcad.certified.contraction` discards and shrinks,
`ptmcad.certified.uniqueness` proves.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from ptmcad.certified.contraction import Workspace, contract, contract_curve, determined, workspace
from ptmcad.certified.equationsystem import Arguments
from ptmcad.certified.linear import space_for
from ptmcad.certified.uniqueness import inflated
from ptmcad.formulas.affine import LANES
from ptmcad.formulas.compilation import ZERO, compiled, inlined
from ptmcad.formulas.tape import Floats

Boxes = Floats
"""Shape (k, 2v): low ends of the v variables, then high ends; of rectangles v is 2."""
CUT = 0.5
SOLVED_WEIGHT = 0.1
"""Of the width of an axis that the equations are solved for: it follows from the other variables.
"""
MAX_SLIVER_RATIO = 8
"""With an axis that is solved for a box is left alone only if it is at most this many times as long
in any variable as its projection would be as a square: a box whose edge alone has the value of the
axis has no area, and says nothing."""
FLAT = 1e-6
"""The same holds without such an axis, but only for boxes whose area is less than this part of what
is asked: all of a box may lie at one value of an axis, at which a spring may have no length, before
its other variables have been looked at."""
MAX_PROOF_WIDTH = 1e-2
"""Boxes at most this wide are tried for a proof of existence."""
NEVER = -1.0
"""A limit of areas or widths that no box reaches."""
MAX_BOXES = 2**62


class SearchResult(NamedTuple):
    """What a search leaves.

    Attributes
    ----------
    unique, narrow : boxes that hold exactly one zero each, and narrower ones around it, row by row.
    small : boxes that were not bisected further, for their size or because no float lies between
        their ends.
    waiting : boxes that were not treated.
    used : number of boxes treated.
    """

    unique: Boxes
    narrow: Boxes
    small: Boxes
    waiting: Boxes
    used: int

    def left(self) -> Boxes:
        """The boxes that are not decided."""
        return np.concatenate((self.small, self.waiting))


def search_curve(
    system: Arguments, start: Boxes, area: float, budget: int, weights: Floats
) -> SearchResult:
    """Enclose a curve in the plane of variables 0 and 1 (the first two unknowns).

    Parameters
    ----------
    area : boxes whose projection has at most this area are not bisected further.
    budget : number of boxes after which the search stops.
    weights : shape (v,): the variable whose width times its weight is largest is bisected.
    """
    return branch_and_prune(
        system, system, start, (area, NEVER, NEVER), (budget, MAX_BOXES), weights
    )


def isolate(
    system: Arguments,
    equations: Arguments,
    start: Boxes,
    limits: tuple[float, int, int],
    weights: Floats,
) -> SearchResult:
    """Isolate the solutions of a square system.

    Parameters
    ----------
    system : with what discards boxes that hold no solution looked for.
    equations : the same equations alone, for the proofs.
    limits : boxes at most this wide are not bisected further; the number of boxes after which the
        search stops; and the number that may stay open, beyond which it does.
    weights : shape (v,), positive: of the variables' widths.
    """
    width, budget, allowed = limits
    sizes = NEVER, width, MAX_PROOF_WIDTH
    return branch_and_prune(system, equations, start, sizes, (budget, allowed), weights)


@compiled
def branch_and_prune(
    system: Arguments,
    equations: Arguments,
    start: Boxes,
    sizes: tuple[float, float, float],
    numbers: tuple[int, int],
    weights: Floats,
) -> SearchResult:
    """The one loop of both: it follows a curve, without proofs, where the limit of areas is
    positive, and isolates solutions otherwise.

    Boxes of curves are contracted by affine forms where these have room for all unknowns; others
    by derivatives.

    Parameters
    ----------
    sizes : the area of a projection, and the width by weights, at which boxes are not bisected
        further; and the width at which they are tried for a proof that they hold exactly one zero.
    numbers : of boxes that are treated, and of those that may stay open, before the search stops.
    """
    least_area, least_width, proof_width = sizes
    budget, allowed = numbers
    variables = start.shape[1] // 2
    larger = (
        system if len(system.program.operations) > len(equations.program.operations) else equations
    )
    work = workspace(larger, variables)
    linear = least_area > 0 and len(system.unknowns) <= LANES
    space = space_for(system, variables)
    stack, small = start.copy(), np.empty((64, 2 * variables))
    unique, narrow = np.empty((4, 2 * variables)), np.empty((4, 2 * variables))
    top = start.shape[0]
    proved = finished = used = ZERO
    longest, flat = inf, 0.0
    if least_area > 0:
        longest = MAX_SLIVER_RATIO * sqrt(least_area * weights[0] * weights[1])
        flat = least_area if len(system.solved) > 0 else FLAT * least_area
    box = np.empty(2 * variables)
    low, high = box[:variables], box[variables:]
    while top > 0 and used < budget and finished <= allowed:
        top -= 1
        used += 1
        for k in range(len(box)):
            box[k] = stack[top, k]
        kept = (
            contract_curve(system, low, high, work, space)
            if linear
            else contract(system, low, high, work)
        )
        if not kept:
            continue
        widest, width = widest_of(system, box, weights, work, SOLVED_WEIGHT)
        if width <= proof_width:
            wide = inflated(equations, box, weights, work)
            if len(wide) > 0:
                unique = _with(unique, proved, wide)
                # several rounds, because each stops after some sweeps
                for _ in range(3):
                    contract(equations, wide[:variables], wide[variables:], work)
                narrow = _with(narrow, proved, wide)
                proved += 1
                continue
        area = (high[0] - low[0]) * (high[1] - low[1])
        if (
            widest < 0
            or width <= least_width
            or (area <= least_area and (area > flat or width <= longest))
        ):
            small = _with(small, finished, box)
            finished += 1
            continue
        stack = halved(stack, top, box, widest)
        top += 2
    return SearchResult(
        unique[:proved].copy(),
        narrow[:proved].copy(),
        small[:finished].copy(),
        stack[:top].copy(),
        used,
    )


@inlined
def is_known(variable: int, system: Arguments, work: Workspace) -> bool:
    """Whether the equations, solved for the variable, bound it over the box that was contracted
    last.
    """
    for k in range(len(system.solved)):
        if system.solved[k, 0] == variable and determined(system.solved[k], work.low, work.high):
            return True
    return False


@compiled
def widest_of(
    system: Arguments, box: Floats, weights: Floats, work: Workspace, solved_weight: float
) -> tuple[int, float]:
    """The unknown to bisect, -1 where no float lies between the ends of any, and its width by
    weights.

    Parameters
    ----------
    solved_weight : of the width of one that the equations are solved for.
    """
    variables = len(weights)
    widest, width = -1, 0.0
    for x in system.unknowns:
        low, high = box[x], box[variables + x]
        size = (high - low) * weights[x]
        if is_known(x, system, work):
            size *= solved_weight
        if size > width and low < low + CUT * (high - low) < high:
            widest, width = x, size
    return widest, width


@compiled
def halved(stack: Boxes, top: int, box: Floats, x: int) -> Boxes:
    """The stack of so many boxes with both halves of one more, bisected in the variable x."""
    variables = len(box) // 2
    middle = box[x] + CUT * (box[variables + x] - box[x])
    stack = _with(_with(stack, top, box), top + 1, box)
    stack[top, variables + x] = middle
    stack[top + 1, x] = middle
    return stack


@compiled
def _with(store: Boxes, count: int, box: Floats) -> Boxes:
    """The store of so many boxes with one more; a larger one where it is full."""
    if count == store.shape[0]:
        larger = np.empty((2 * count, store.shape[1]))
        for i in range(count):
            for k in range(store.shape[1]):
                larger[i, k] = store[i, k]
        store = larger
    for k in range(store.shape[1]):
        store[count, k] = box[k]
    return store
