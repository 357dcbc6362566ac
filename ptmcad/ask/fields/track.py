"""One solution followed along a path over the window by Newton's method, in floating point."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import hypot

import numpy as np

from ptmcad.answer.motion import Place
from ptmcad.ask.fields.course import MIN_LENGTH
from ptmcad.ask.fields.descent import solution
from ptmcad.ask.fields.equations import Floats, ModelState, parameters_at, state_at
from ptmcad.question.slice import Slice

ALONG = 0.08
"""Radians, or units, that a solution may move in a part of a step, in which it is followed without
looking again.
"""
MIN_STEP = 1e-7
"""Of the path: a solution that cannot be followed so far has vanished."""


class Track:
    """A slice's model along a path, whose pieces are as long as shares of the window's sides.

    ``ends`` are the shares of the path at its corners, rounded to rational numbers.
    """

    def __init__(self, slice: Slice, corners: tuple[Place, ...]):
        self.slice, self.model = slice, slice.model
        sides = [axis.width for axis in slice.axes]
        lengths = [
            hypot(*(float((b - a) / side) for a, b, side in zip(p, q, sides, strict=True)))
            for p, q in pairwise(corners)
        ]
        kept = [k for k, length in enumerate(lengths) if length > MIN_LENGTH * max(lengths)]
        total, done, ends = sum(lengths[k] for k in kept), 0.0, [Fraction(0)]
        for k in kept:
            done += lengths[k]
            ends.append(Fraction(done / total).limit_denominator(10**9))
        self.corners = corners[kept[0]], *(corners[k + 1] for k in kept)
        self.ends = *ends[:-1], Fraction(1)

    def place(self, share: Fraction | float) -> Place:
        """The point where a share of the path is done."""
        share = Fraction(share)
        k = max(i for i, end in enumerate(self.ends[:-1]) if end <= share)
        part = (share - self.ends[k]) / (self.ends[k + 1] - self.ends[k])
        (a, b), (c, d) = self.corners[k], self.corners[k + 1]
        return a + (c - a) * part, b + (d - b) * part

    def state(self, at: Place, unknowns: Floats) -> ModelState:
        """The model at a point of the slice, and unknowns of shape (n, k)."""
        x, y = (np.array([float(value)]) for value in at)
        return state_at(self.model, parameters_at(self.slice, x, y), unknowns)

    def at(self, share: float, unknowns: Floats) -> ModelState:
        """The same where a share of the path is done."""
        return self.state(self.place(share), unknowns)

    def solved(self, share: float, start: Floats) -> tuple[Floats, ModelState] | None:
        """Where Newton's method leads from unknowns of shape (n,), with the model there."""
        return solution(lambda at: self.at(share, at), start)


def followed(
    track: Track, at: Floats, done: float, to: float, own: int
) -> tuple[Floats, float, bool]:
    """The solution further along the path, and how far: to where it should go, or to where it
    vanishes or, as the last entry says, goes on as one that does not count.

    Parameters
    ----------
    own : the number of negative eigenvalues, which stays while it is the same solution.
    """
    step = to - done
    while done < to:
        further = to if to - done <= step * (1 + 1e-9) else done + step
        found = track.solved(further, at)
        same = found and int(found[1].negatives[0]) == own and np.linalg.norm(found[0] - at) < ALONG
        if found and same and found[1].counts.all():
            at, done, step = found[0], further, step * 2
        elif further - done <= MIN_STEP * 1.001:
            return at, done, bool(same)
        else:
            step = max((further - done) / 2, MIN_STEP)
    return at, done, False
