"""Tubes: polynomials, and how far the solutions in some boxes are from them at most.

Guarantee: each solution of the equations in the boxes that `tubes` was given lies in one of its
tubes, in the coordinate of the plane that the other one tells; or it says that it failed. (Lemma 29
of docs/soundness.md.)

A polynomial is found by Newton's method on power series; that it is near the solutions follows from
how small the equations are along it, with a bound of their next coefficient over the whole
interval, and from the derivatives over each box. So the half width falls with a power of the
interval's length, and boxes need not be small.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from ptmcad.certified.branchandprune import Boxes, halved, widest_of
from ptmcad.certified.contraction import Workspace, contract, workspace
from ptmcad.certified.equationsystem import Arguments
from ptmcad.certified.expansion import approach, eliminated, expanded, residual
from ptmcad.formulas.compilation import ZERO, compiled, inlined
from ptmcad.formulas.intervalarithmetic import Floats, run
from ptmcad.formulas.rounding import down, magnitude, multiply, up

ITERATIONS = 30
"""Of the bound of the distance from the polynomial: each multiplies what is above the limit by a
matrix.
"""
SHRINKAGES = 3
"""Times that a box is made smaller by what is known of the distance."""
MAX_TUBES = 6
MAX_TRIALS = 8
FINEST = 500.0
SAME = 1e-9
"""Ends of Newton's method that are as near are one."""


class Tubes(NamedTuple):
    """Tubes over one interval [low, high] of the coordinate u, with t = (u - middle)/radius.

    Attributes
    ----------
    coefficients : shape (k, order + 1), of the other coordinate's polynomials in t, as exact as
        floats are.
    half : half widths.
    middle, radius : the interval lies in middle - radius and middle + radius, computed exactly.
    left : number of boxes whose solutions are in no tube; the rest means nothing unless it is 0.
    """

    coefficients: Floats
    half: Floats
    middle: float
    radius: float
    left: int


@compiled
def _centered(z: Floats, start: float, end: float) -> tuple[float, float]:
    """The values of a polynomial over an interval within [-1, 1]: its coefficients about the
    middle, summed up.
    """
    c = 0.5 * (start + end)
    r = up(max(end - c, c - start))
    n = len(z)
    low, high = z.copy(), z.copy()
    # Horner's rule, again and again, makes the coefficients about c
    for k in range(n - 1):
        for j in range(n - 2, k - 1, -1):
            u, v = multiply(low[j + 1], high[j + 1], c, c)
            low[j], high[j] = down(low[j] + u), up(high[j] + v)
    u = v = 0.0
    for j in range(n - 1, 0, -1):
        a = magnitude(low[j], high[j])
        v = up(up(v + a) * r)
    return down(low[0] - v), up(high[0] + v)


@compiled
def _spread(
    z: Floats, low: Floats, high: Floats, u: int, curve: tuple[Floats, Floats], far: Floats
) -> bool:
    """The polynomials' values over a box, and how far its points are from these at most; False
    where no number is.
    """
    middle, radius = z[u, 0], z[u, 1]
    t_low = max(down(down(low[u] - middle) / radius), -1.0)
    t_high = min(up(up(high[u] - middle) / radius), 1.0)
    curve_low, curve_high = curve
    finite = True
    for x in range(len(low)):
        curve_low[x], curve_high[x] = _centered(z[x], t_low, t_high)
        far[x] = 0.0 if x == u else up(max(up(high[x] - curve_low[x]), up(curve_high[x] - low[x])))
        finite = finite and far[x] < inf
    return finite


@compiled
def _operator(
    system: Arguments, residual: Floats, work: Workspace, rest: Floats, bound: Floats
) -> None:
    """What bounds solutions' distances from the polynomials: they are at most ``bound`` plus
    ``rest`` times them.
    """
    m = len(system.equations)
    for i in range(m):
        bound[i] = 0.0
        for k in range(m):
            bound[i] = up(bound[i] + up(abs(work.inverse[i, k]) * residual[k]))
        for j in range(m):
            p = q = 0.0
            for k in range(m):
                place = system.jacobian[k, work.pivots[j]]
                a, b = multiply(
                    work.inverse[i, k], work.inverse[i, k], work.low[place], work.high[place]
                )
                p, q = down(p + a), up(q + b)
            if i == j:
                p, q = down(1.0 - q), up(1.0 - p)
            rest[i, j] = magnitude(p, q)


@compiled
def _iterate(system: Arguments, rest: Floats, bound: Floats, work: Workspace, far: Floats) -> None:
    """Make the distances smaller by the operator, several times."""
    nearer = far.copy()
    for _ in range(ITERATIONS):
        for i in range(len(bound)):
            total = bound[i]
            for j in range(len(bound)):
                total = up(total + up(rest[i, j] * far[system.unknowns[work.pivots[j]]]))
            # a sum that is no number is passed over
            x = system.unknowns[work.pivots[i]]
            nearer[x] = min(nearer[x], total)
        far[:] = nearer


@compiled
def _distance(
    system: Arguments,
    z: Floats,
    residual: Floats,
    low: Floats,
    high: Floats,
    u: int,
    far: Floats,
    work: Workspace,
) -> float:
    """How far in all variables the solutions in a box are from the polynomials at most; -1 where
    there is none.

    ``far`` becomes these bounds, variable by variable.
    """
    variables, m = len(low), len(system.equations)
    curve_low, curve_high = np.empty(variables), np.empty(variables)
    if not _spread(z, low, high, u, (curve_low, curve_high), far):
        return inf
    box_low, box_high, rest, bound = low.copy(), high.copy(), np.empty((m, m)), np.empty(m)
    for _ in range(SHRINKAGES):
        for x in range(variables):
            if x != u:
                box_low[x] = max(min(low[x], curve_low[x]), down(curve_low[x] - far[x]))
                box_high[x] = min(max(high[x], curve_high[x]), up(curve_high[x] + far[x]))
        if not run(system.program, box_low, box_high, work.low, work.high, ZERO, system.stages[3]):
            return inf
        if not eliminated(system, work):
            return inf
        _operator(system, residual, work, rest, bound)
        before = far.max()
        _iterate(system, rest, bound, work, far)
        for x in range(variables):
            if x != u and (
                down(curve_low[x] - far[x]) > high[x] or up(curve_high[x] + far[x]) < low[x]
            ):
                return -1.0
        if not far.max() <= 0.5 * before:
            break
    result: float = far.max()
    return result


@compiled
def tubes(
    system: Arguments,
    equations: Arguments,
    boxes: Boxes,
    weights: Floats,
    along: tuple[int, float, float],
    limits: tuple[int, float, int],
) -> Tubes:
    """Tubes around all solutions in boxes.

    Parameters
    ----------
    system : what the solutions are of.
    equations : the same equations and their derivatives alone.
    weights : shape (v,), of the variables' widths when a box is bisected.
    along : the coordinate u of the plane, 0 or 1, along which the tubes go, and the ends of an
        interval that holds that of all boxes.
    limits : the order of the polynomials, the half width that is not exceeded, and how many boxes
        are bisected.
    """
    u, start, end = along
    order, most, budget = limits
    variables = boxes.shape[1] // 2
    work = workspace(equations, variables)
    for j in range(len(equations.unknowns)):
        work.radius[j] = 0.0 if equations.unknowns[j] == u else 1.0
    middle = 0.5 * (start + end)
    radius = up(max(up(end - middle), up(middle - start)))
    centers = np.zeros((MAX_TUBES, variables, order + 2))
    residuals, half = np.zeros((MAX_TUBES, len(equations.equations))), np.full(MAX_TUBES, -1.0)
    points = _middles(equations, boxes, u, middle, work)
    count = 0
    for k in range(len(points)):
        # once more, for the row operations there
        if not approach(equations, points[k], work):
            continue
        centers[count] = expanded(equations, points[k], u, radius, order, work)
        residuals[count] = residual(equations, centers[count])
        if _reach(residuals[count], work) <= most:
            count += 1
    left = len(boxes)
    if count > 0:
        left = _refined(
            system,
            equations,
            boxes,
            weights,
            centers[:count],
            residuals,
            half,
            (u, most, budget),
            work,
        )
    used = half[:count] >= 0
    return Tubes(
        centers[:count, 1 - u, : order + 1][used], half[:count][used], middle, radius, left
    )


@inlined
def _reach(residual: Floats, work: Workspace) -> float:
    """About how far solutions are from polynomials with such a residual."""
    result = 0.0
    for i in range(len(residual)):
        total = 0.0
        for k in range(len(residual)):
            total += abs(work.inverse[i, k]) * residual[k]
        result = max(result, total)
    return result if result == result else inf


@compiled
def _middles(equations: Arguments, boxes: Boxes, u: int, middle: float, work: Workspace) -> Floats:
    """Points of the curves over the middle, about: where Newton's method ends that begins in boxes
    next to it.
    """
    variables = boxes.shape[1] // 2
    distance = np.abs(0.5 * (boxes[:, u] + boxes[:, variables + u]) - middle)
    order = np.argsort(distance)
    low, high = np.full(variables, inf), np.full(variables, -inf)
    for k in range(len(boxes)):
        for x in range(variables):
            low[x], high[x] = min(low[x], boxes[k, x]), max(high[x], boxes[k, variables + x])
    points, count = np.empty((MAX_TUBES, variables)), 0
    for n in range(min(len(order), MAX_TRIALS)):
        k = order[n]
        point = 0.5 * (boxes[k, :variables] + boxes[k, variables:])
        point[u] = middle
        if not approach(equations, point, work):
            continue
        known = False
        for x in range(variables):
            room = 0.5 * (high[x] - low[x])
            if not low[x] - room <= point[x] <= high[x] + room:
                known = True
        for j in range(count):
            same = True
            for x in range(variables):
                if abs(points[j, x] - point[x]) > SAME:
                    same = False
            known = known or same
        if not known and count < MAX_TUBES:
            points[count] = point
            count += 1
    return points[:count]


@compiled
def _refined(
    system: Arguments,
    equations: Arguments,
    boxes: Boxes,
    weights: Floats,
    centers: Floats,
    residuals: Floats,
    half: Floats,
    limits: tuple[int, float, int],
    work: Workspace,
) -> int:
    """Bisect boxes until their solutions are near one of the centers, or the budget is gone; what
    is left then.

    ``half`` becomes what it has to be.
    """
    u, most, budget = limits
    variables = boxes.shape[1] // 2
    contraction = workspace(system, variables)
    distance = np.empty(variables)
    least = 0.0
    for x in (0, 1):
        least = max(
            least, (np.max(boxes[:, variables + x]) - np.min(boxes[:, x])) * weights[x] / FINEST
        )
    stack = np.empty((len(boxes) + 200, 2 * variables))
    stack[: len(boxes)] = boxes
    top = len(boxes)
    box = np.empty(2 * variables)
    low, high = box[:variables], box[variables:]
    while top > 0:
        if budget == 0 or top + 2 > len(stack):
            return top
        budget -= 1
        top -= 1
        for k in range(len(box)):
            box[k] = stack[top, k]
        if not contract(system, low, high, contraction):
            continue
        near = False
        for k in range(len(centers)):
            far = _distance(equations, centers[k], residuals[k], low, high, u, distance, work)
            if far <= most:
                if far >= 0:
                    half[k] = max(half[k], distance[1 - u])
                near = True
                break
        if near:
            continue
        widest, width = widest_of(system, box, weights, contraction, 1.0)
        if widest < 0 or width < least:
            return top + 1
        stack = halved(stack, top, box, widest)
        top += 2
    return 0
