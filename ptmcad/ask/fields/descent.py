"""The way down from where a pose has vanished: steepest descent of the energy less moments' work,
in floating point.

Method: implicit steps of the gradient's flow, which stay in narrow valleys, twice as long as the
last where they are short, and a third where they would go up or too far; Newton's method at the
end.
"""

from __future__ import annotations

import numpy as np

from ptmcad.ask.fields.equations import Evaluation, Floats, ModelState, newton

STRIDE = 0.05
"""The longest step, in radians or units."""
STEPS = 5000
ASIDE = 1e-4
"""By how much the start is moved along the softest direction, to the lower side: at a place of
symmetry nothing else says where to go."""

STEPS_TO_SOLUTION, NEAR = 16, 1e-10
"""Of Newton's method at one place, and its last one against the solution's size."""


def descent(evaluate: Evaluation, start: Floats) -> Floats | None:
    """Places on the way down from a start of shape (n,), the minimum at its end: shape (number, n).

    None where no minimum is reached, as under a moment that turns a bar for ever.
    """
    at = start + _aside(evaluate, start)
    way = [start, at]
    time, here = 1e-3, evaluate(at[:, None])
    for _ in range(STEPS):
        hessian, slope = here.jacobian[..., 0], here.residuals[:, 0]
        values = np.linalg.eigvalsh(hessian)
        step = None
        if np.all(np.isfinite(values)) and values[0] + 1 / time > 0:
            step = np.linalg.solve(hessian + np.eye(len(at)) / time, slope)
        length = np.inf if step is None else float(np.linalg.norm(step))
        below = here if step is None else evaluate((at - step)[:, None])
        if (
            step is None
            or not length <= STRIDE
            or not _height(below) <= _height(here) + _rounding(here)
        ):
            time /= 3
            if time < 1e-15:
                return None
            continue
        at, here = at - step, below
        if np.linalg.norm(at - way[-1]) > STRIDE / 3:
            way.append(at)
        if length < STRIDE / 2:
            time *= 2
        if length < 1e-7 and values[0] * time > 100:
            end = solution(evaluate, at)
            return None if end is None else np.array([*way, end[0]])
    return None


def _aside(evaluate: Evaluation, start: Floats) -> Floats:
    """A short step along the softest direction, to the side where it is lower."""
    direction = np.linalg.eigh(evaluate(start[:, None]).jacobian[..., 0])[1][:, 0]
    sides = [sign * ASIDE * direction for sign in (1.0, -1.0)]
    chosen: Floats = min(sides, key=lambda side: _height(evaluate((start + side)[:, None])))
    return chosen


def _height(state: ModelState) -> float:
    assert state.height is not None  # what has no energy does not descend
    return float(state.height[0])


def _rounding(state: ModelState) -> float:
    return 1e-12 * (1 + abs(_height(state)))


def solution(evaluate: Evaluation, start: Floats) -> tuple[Floats, ModelState] | None:
    """The solution to which Newton's method leads, with the model there; None where it does not
    converge.
    """
    at, length = newton(
        evaluate, start[:, None], STEPS_TO_SOLUTION, NEAR * (1 + float(np.linalg.norm(start)))
    )
    if not length[0] <= NEAR * (1 + float(np.linalg.norm(at))):
        return None
    return at[:, 0], evaluate(at)
