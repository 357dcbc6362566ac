"""Polynomials near a curve of solutions, and how small the equations are along them.

Guarantee: `residual` bounds the equations' absolute values along polynomials, for the whole
interval of their variable; nothing is proved of the polynomials themselves, which Newton's method
finds on power series.
"""

from __future__ import annotations

import numpy as np

from ptmcad.certified.contraction import Workspace, precondition
from ptmcad.certified.equationsystem import Arguments
from ptmcad.formulas.compilation import ZERO, compiled, inlined
from ptmcad.formulas.intervalarithmetic import Floats, run
from ptmcad.formulas.rounding import down, magnitude, multiply, up
from ptmcad.formulas.taylor import extend, series

NEWTON_STEPS = 12
MAX_STEP = 1.0
"""Newton's method that steps farther is lost."""
SMALL_STEP = 1e-15


@inlined
def eliminated(system: Arguments, work: Workspace) -> bool:
    """Row operations from the middles of the Jacobian that was run last, columns weighted by the
    radii; False where there are none."""
    jacobian = system.jacobian
    for i in range(jacobian.shape[0]):
        for j in range(jacobian.shape[1]):
            place = jacobian[i, j]
            work.matrix[i, j] = 0.5 * (work.low[place] + work.high[place])
            if not abs(work.matrix[i, j]) < 1e150:
                return False
    precondition(work, work.radius)
    for i in range(len(work.pivots)):
        if work.pivots[i] < 0:
            return False
    return True


@compiled
def approach(system: Arguments, point: Floats, work: Workspace) -> bool:
    """Move a point near to a zero of the equations, along all unknowns but u, in place; False where
    that fails.
    """
    equations, unknowns = system.equations, system.unknowns
    for _ in range(NEWTON_STEPS):
        run(system.program, point, point, work.low, work.high, ZERO, system.stages[3])
        if not eliminated(system, work):
            return False
        change = 0.0
        for i in range(len(equations)):
            step = 0.0
            for k in range(len(equations)):
                step += (
                    work.inverse[i, k] * 0.5 * (work.low[equations[k]] + work.high[equations[k]])
                )
            if not abs(step) < MAX_STEP:
                return False
            point[unknowns[work.pivots[i]]] -= step
            change = max(change, abs(step))
        if change < SMALL_STEP:
            break
    return True


@compiled
def expanded(
    system: Arguments, point: Floats, u: int, radius: float, order: int, work: Workspace
) -> Floats:
    """Coefficients of a curve of zeros through a point, about, in t = (u - middle)/radius; shape
    (variables, order+2).

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
    """Enclosures of the polynomials' coefficients about every point of [-1, 1]: of p(s + t) for all
    s there.
    """
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
def residual(system: Arguments, z: Floats) -> Floats:
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
