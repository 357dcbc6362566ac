"""Tubes: polynomials, and how far the solutions in some boxes are from them at most.

Guarantee: each solution of the equations in the boxes that `tubes` was given lies in one of its tubes, in the
coordinate of the plane that the other one tells; or it says that it failed. (Lemma 29 of docs/soundness.md.)

A polynomial is found by Newton's method on power series; that it is near the solutions follows from how small the
equations are along it, with a bound of their next coefficient over the whole interval, and from the derivatives over
each box. So the half width falls with a power of the interval's length, and boxes need not be small.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from ptmcad.certified.contraction import contract, precondition, workspace
from ptmcad.certified.search import Boxes
from ptmcad.certified.system import Arguments
from ptmcad.formulas.compiled import ZERO, compiled, inlined
from ptmcad.formulas.intervals import Floats, Indices, run
from ptmcad.formulas.rounding import down, magnitude, multiply, up
from ptmcad.formulas.taylor import extend, series

NEWTON_STEPS = 12
MAX_STEP = 1.0
"""Newton's method that steps farther is lost."""
SMALL_STEP = 1e-15
ITERATIONS = 30
"""Of the bound of the distance from the polynomial: each multiplies what is above the limit by a matrix."""
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
    coefficients : shape (k, order + 1), of the other coordinate's polynomials in t, as exact as floats are.
    half : half widths.
    middle, radius : the interval lies in middle - radius and middle + radius, computed exactly.
    left : number of boxes whose solutions are in no tube; the rest means nothing unless it is 0.
    """

    coefficients: Floats
    half: Floats
    middle: float
    radius: float
    left: int


class _Work(NamedTuple):
    low: Floats
    high: Floats
    matrix: Floats
    inverse: Floats
    widths: Floats
    pivots: Indices


@inlined
def _work(system: Arguments) -> _Work:
    m, n = system.jacobian.shape
    nodes = len(system.program.operations)
    return _Work(
        np.empty(nodes), np.empty(nodes), np.empty((m, n)), np.empty((m, m)), np.empty(n), np.empty(m, np.int64)
    )


@inlined
def _eliminated(system: Arguments, work: _Work) -> bool:
    """Row operations from the middles of the Jacobian that was run last; False where there are none."""
    jacobian = system.jacobian
    for i in range(jacobian.shape[0]):
        for j in range(jacobian.shape[1]):
            place = jacobian[i, j]
            work.matrix[i, j] = 0.5 * (work.low[place] + work.high[place])
            if not abs(work.matrix[i, j]) < 1e150:
                return False
    precondition(work.matrix, work.inverse, work.widths, work.pivots)
    for i in range(len(work.pivots)):
        if work.pivots[i] < 0:
            return False
    return True


@compiled
def _newton(system: Arguments, point: Floats, work: _Work) -> bool:
    """Move a point near to a zero of the equations, along all unknowns but u, in place; False where that fails."""
    equations, unknowns = system.equations, system.unknowns
    for _ in range(NEWTON_STEPS):
        run(system.program, point, point, work.low, work.high, ZERO, system.stages[3])
        if not _eliminated(system, work):
            return False
        change = 0.0
        for i in range(len(equations)):
            step = 0.0
            for k in range(len(equations)):
                step += work.inverse[i, k] * 0.5 * (work.low[equations[k]] + work.high[equations[k]])
            if not abs(step) < MAX_STEP:
                return False
            point[unknowns[work.pivots[i]]] -= step
            change = max(change, abs(step))
        if change < SMALL_STEP:
            break
    return True


@compiled
def _expanded(system: Arguments, point: Floats, u: int, radius: float, order: int, work: _Work) -> Floats:
    """Coefficients of a curve of zeros through a point, about, in t = (u - middle)/radius; shape (variables, order+2).

    The last column is zero.
    """
    equations, unknowns, end = system.equations, system.unknowns, system.stages[1]
    z = np.zeros((len(point), order + 2))
    for x in range(len(point)):
        z[x, 0] = point[x]
    z[u, 1] = radius
    values = series(end, order)
    extend(system.program, z, z, values, 0, 0, end)
    for k in range(1, order + 1):
        extend(system.program, z, z, values, k, k, end)
        for i in range(len(equations)):
            step = 0.0
            for j in range(len(equations)):
                f = equations[j]
                step += work.inverse[i, j] * 0.5 * (values.low[f, k] + values.high[f, k])
            z[unknowns[work.pivots[i]], k] -= step
        extend(system.program, z, z, values, k, k, end)
    return z


@compiled
def _about_all(z: Floats) -> tuple[Floats, Floats]:
    """Enclosures of the polynomials' coefficients about every point of [-1, 1]: of p(s + t) for all s there."""
    variables, terms = z.shape
    low, high = np.zeros((variables, terms)), np.zeros((variables, terms))
    for x in range(variables):
        for k in range(terms):
            u = v = 0.0
            for j in range(terms - 1, k - 1, -1):
                u, v = multiply(u, v, -1.0, 1.0)
                # binomials of such small numbers are exact
                binomial = 1.0
                for i in range(k):
                    binomial = binomial * (j - i) / (i + 1)
                u, v = down(u + down(z[x, j] * binomial)), up(v + up(z[x, j] * binomial))
            low[x, k], high[x, k] = u, v
    return low, high


@compiled
def _residual(system: Arguments, z: Floats) -> Floats:
    """Bounds of the equations' absolute values along the polynomials, for t in [-1, 1]."""
    equations, end = system.equations, system.stages[1]
    last = z.shape[1] - 1
    thin, wide = series(end, last), series(end, last)
    extend(system.program, z, z, thin, 0, last - 1, end)
    low, high = _about_all(z)
    extend(system.program, low, high, wide, 0, last, end)
    bound = np.empty(len(equations))
    for i in range(len(equations)):
        f = equations[i]
        total = magnitude(wide.low[f, last], wide.high[f, last])
        for k in range(last):
            total = up(total + magnitude(thin.low[f, k], thin.high[f, k]))
        bound[i] = total
    return bound


@compiled
def _centered(z: Floats, start: float, end: float) -> tuple[float, float]:
    """The values of a polynomial over an interval within [-1, 1]: its coefficients about the middle, summed up."""
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
def _distance(
    system: Arguments, z: Floats, residual: Floats, low: Floats, high: Floats, u: int, far: Floats, work: _Work
) -> float:
    """How far in all variables the solutions in a box are from the polynomials at most; -1 where there is none.

    ``far`` becomes these bounds, variable by variable.
    """
    unknowns, m = system.unknowns, len(system.equations)
    middle, radius = z[u, 0], z[u, 1]
    t_low = max(down(down(low[u] - middle) / radius), -1.0)
    t_high = min(up(up(high[u] - middle) / radius), 1.0)
    curve_low, curve_high = np.empty(len(low)), np.empty(len(low))
    box_low, box_high = low.copy(), high.copy()
    for x in range(len(low)):
        curve_low[x], curve_high[x] = _centered(z[x], t_low, t_high)
    for x in range(len(low)):
        far[x] = 0.0 if x == u else up(max(up(high[x] - curve_low[x]), up(curve_high[x] - low[x])))
    for x in range(len(low)):
        if not far[x] < inf:
            return inf
    rest, bound, nearer = np.empty((m, m)), np.empty(m), np.empty(len(low))
    for _ in range(SHRINKAGES):
        for x in range(len(low)):
            if x != u:
                box_low[x], box_high[x] = min(low[x], curve_low[x]), max(high[x], curve_high[x])
                box_low[x] = max(box_low[x], down(curve_low[x] - far[x]))
                box_high[x] = min(box_high[x], up(curve_high[x] + far[x]))
        if not run(system.program, box_low, box_high, work.low, work.high, ZERO, system.stages[3]):
            return inf
        if not _eliminated(system, work):
            return inf
        for i in range(m):
            bound[i] = 0.0
            for k in range(m):
                bound[i] = up(bound[i] + up(abs(work.inverse[i, k]) * residual[k]))
            for j in range(m):
                p = q = 0.0
                for k in range(m):
                    place = system.jacobian[k, work.pivots[j]]
                    a, b = multiply(work.inverse[i, k], work.inverse[i, k], work.low[place], work.high[place])
                    p, q = down(p + a), up(q + b)
                if i == j:
                    p, q = down(1.0 - q), up(1.0 - p)
                rest[i, j] = magnitude(p, q)
        before = far.max()
        for _ in range(ITERATIONS):
            for x in range(len(low)):
                nearer[x] = far[x]
            for i in range(m):
                x = unknowns[work.pivots[i]]
                total = bound[i]
                for j in range(m):
                    total = up(total + up(rest[i, j] * far[unknowns[work.pivots[j]]]))
                # a sum that is no number is passed over
                nearer[x] = min(nearer[x], total)
            for x in range(len(low)):
                far[x] = nearer[x]
        for x in range(len(low)):
            if x != u and (down(curve_low[x] - far[x]) > high[x] or up(curve_high[x] + far[x]) < low[x]):
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
    along : the coordinate u of the plane, 0 or 1, along which the tubes go, and the ends of an interval that holds
        that of all boxes.
    limits : the order of the polynomials, the half width that is not exceeded, and how many boxes are bisected.
    """
    u, start, end = along
    order, most, budget = limits
    variables = boxes.shape[1] // 2
    work = _work(equations)
    for j in range(len(equations.unknowns)):
        work.widths[j] = 0.0 if equations.unknowns[j] == u else 1.0
    middle = 0.5 * (start + end)
    radius = up(max(up(end - middle), up(middle - start)))
    centers = np.zeros((MAX_TUBES, variables, order + 2))
    residuals, half = np.zeros((MAX_TUBES, len(equations.equations))), np.full(MAX_TUBES, -1.0)
    points = _middles(equations, boxes, u, middle, work)
    count = 0
    for k in range(len(points)):
        # once more, for the row operations there
        if not _newton(equations, points[k], work):
            continue
        centers[count] = _expanded(equations, points[k], u, radius, order, work)
        residuals[count] = _residual(equations, centers[count])
        if _reach(residuals[count], work) <= most:
            count += 1
    left = len(boxes)
    if count > 0:
        left = _refined(system, equations, boxes, weights, centers[:count], residuals, half, (u, most, budget), work)
    used = half[:count] >= 0
    return Tubes(centers[:count, 1 - u, : order + 1][used], half[:count][used], middle, radius, left)


@inlined
def _reach(residual: Floats, work: _Work) -> float:
    """About how far solutions are from polynomials with such a residual."""
    result = 0.0
    for i in range(len(residual)):
        total = 0.0
        for k in range(len(residual)):
            total += abs(work.inverse[i, k]) * residual[k]
        result = max(result, total)
    return result if result == result else inf


@compiled
def _middles(equations: Arguments, boxes: Boxes, u: int, middle: float, work: _Work) -> Floats:
    """Points of the curves over the middle, about: where Newton's method ends that begins in boxes next to it."""
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
        if not _newton(equations, point, work):
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
    work: _Work,
) -> int:
    """Bisect boxes until their solutions are near one of the centers, or the budget is gone; what is left then.

    ``half`` becomes what it has to be.
    """
    u, most, budget = limits
    variables = boxes.shape[1] // 2
    contraction = workspace(system, variables)
    distance = np.empty(variables)
    least = 0.0
    for x in (0, 1):
        least = max(least, (np.max(boxes[:, variables + x]) - np.min(boxes[:, x])) * weights[x] / FINEST)
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
        widest, width = -1, 0.0
        for x in system.unknowns:
            middle = low[x] + 0.5 * (high[x] - low[x])
            size = (high[x] - low[x]) * weights[x]
            if size > width and low[x] < middle < high[x]:
                widest, width = x, size
        if widest < 0 or width < least:
            return top + 1
        middle = low[widest] + 0.5 * (high[widest] - low[widest])
        for k in range(len(box)):
            stack[top, k] = stack[top + 1, k] = box[k]
        stack[top, variables + widest] = middle
        stack[top + 1, widest] = middle
        top += 2
    return 0
