"""The energy that it takes to leave a stable pose for another: to the lowest pass on the way, over
all ways.

Method: from each saddle of index one a path leads down on either side to a stable pose. Each step
is Newton's with the moduli of the curvatures (Dauphin et al., NIPS 2014), shortened until the
energy falls from its start over its middle to its end; which poses a path joins below its saddle's
energy is all that matters, not its shape. Saddles, lowest first, then join poses until the chosen
one is joined to another.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ptmcad.ask.fields.equations import Flags, Floats, Integers, ModelState, apart, eigenvalues

STEPS = 200
"""Of a descent."""
ASIDE = 1e-2
"""Radians from the saddle, or units, at which a descent begins."""
MAX_STEP = 0.3
"""Of a step, in the same."""
NEAR = 0.05
"""Of a stable pose: there the descent ends, where the energy is convex."""

Evaluate = Callable[[Integers, Floats], ModelState]
"""The model at pixels, given by their numbers, and points of shape (n, pixels), or (n, pixels, k).
"""


def barriers(evaluate: Evaluate, at: Floats, chosen: Integers, angles: int) -> Floats:
    """For each pixel the energy above the chosen pose; nan where there is no other stable pose, or
    no way was found.

    Parameters
    ----------
    at : all solutions, shape (n, pixels, most); nan where there are fewer.
    chosen : the pose from which one leaves.
    angles : so many unknowns, the first ones, are angles.
    """
    known = ~np.isnan(at[0])
    pixels, most = known.shape
    own, there = np.arange(pixels), np.nan_to_num(at)
    state = evaluate(own, there)
    energy = np.where(known, state.known_energy, np.inf)
    stable = (state.negatives == 0) & known
    saddle = (state.negatives == 1) & known & (stable.sum(axis=1) > 1)[:, None]
    ends = _ends(evaluate, there, state, saddle, stable, angles)
    # of each solution the lowest number of those that it is joined to
    joined = np.broadcast_to(np.arange(most), (pixels, most))
    found, certain = np.full(pixels, np.nan), np.ones(pixels, dtype=np.bool_)
    order = np.argsort(np.where(saddle, energy, np.inf), axis=1, kind="stable")
    for rank in range(most):
        k = order[:, rank]
        a, b = ends[0, own, k], ends[1, own, k]
        use = saddle[own, k] & (a >= 0) & (b >= 0)
        # above a saddle of which an end was not found nothing is certain: it may be a lower pass
        certain &= use | ~saddle[own, k] | ~np.isnan(found)
        one, other = (joined[own, np.maximum(end, 0)][:, None] for end in (a, b))
        both = use[:, None] & ((joined == one) | (joined == other))
        joined = np.where(both, np.minimum(one, other), joined)
        with_chosen = stable & (joined == joined[own, chosen][:, None])
        now = use & np.isnan(found) & (with_chosen.sum(axis=1) > 1)
        found[now] = (energy[own, k] - energy[own, chosen])[now]
    return np.where(certain, found, np.nan)


def _ends(
    evaluate: Evaluate, at: Floats, state: ModelState, saddle: Flags, stable: Flags, angles: int
) -> Integers:
    """The stable solutions below each saddle on its two sides, shape (2, pixels, most); -1 where
    none was reached.
    """
    ends = np.full((2, *saddle.shape), -1, dtype=np.int64)
    pixel, number = np.nonzero(saddle)
    if not len(pixel):
        return ends
    directions = np.linalg.eigh(np.moveaxis(state.jacobian[:, :, pixel, number], (0, 1), (-2, -1)))[
        1
    ][..., 0].T
    for side, sign in enumerate((1, -1)):
        active = np.arange(len(pixel))
        point = at[:, pixel, number] + sign * ASIDE * directions
        for _ in range(STEPS):
            here = evaluate(pixel[active], point)
            near = _nearest(at, stable, pixel[active], point, angles)
            reached = (near >= 0) & (eigenvalues(here.jacobian)[0] > 0)
            ends[side, pixel[active[reached]], number[active[reached]]] = near[reached]
            active, point = active[~reached], point[:, ~reached]
            if not len(active):
                break
            step = _downhill(here)[:, ~reached]
            point = point + _falling(
                evaluate, pixel[active], point, step, here.known_energy[~reached]
            )
    return ends


def _downhill(state: ModelState) -> Floats:
    """Newton's step with the moduli of the curvatures, of at most the largest length."""
    values, vectors = np.linalg.eigh(np.moveaxis(state.jacobian, (0, 1), (-2, -1)))
    size = np.maximum(np.abs(values), 1e-12 * (1e-300 + np.abs(values).max(axis=-1, keepdims=True)))
    along = np.einsum("pij,ip->pj", vectors, state.residuals) / size
    step = -np.einsum("pij,pj->ip", vectors, along)
    length = np.sqrt((step**2).sum(axis=0))
    found: Floats = step * np.minimum(1.0, MAX_STEP / np.maximum(length, 1e-300))
    return found


def _falling(
    evaluate: Evaluate, pixels: Integers, point: Floats, step: Floats, start: Floats
) -> Floats:
    """The step, halved until the energy falls over its middle to its end; zero where it never does."""
    for _ in range(12):
        middle = evaluate(pixels, point + step / 2).known_energy
        end = evaluate(pixels, point + step).known_energy
        falls = (middle <= start) & (end <= middle)
        if falls.all():
            return step
        step = np.where(falls, step, step / 2)
    return np.where(falls, step, 0.0)


def _nearest(at: Floats, stable: Flags, pixels: Integers, point: Floats, angles: int) -> Integers:
    """The stable solution near each point; -1 where there is none."""
    gap = apart(point[:, :, None], at[:, pixels], angles)
    near = stable[pixels] & (np.sqrt((gap**2).sum(axis=0)) < NEAR)
    return np.where(near.any(axis=1), near.argmax(axis=1), -1)
