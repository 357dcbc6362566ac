"""One solution followed along a course by Newton's method, in floating point."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ptmcad.answer.motion import Place
from ptmcad.ask.fields.course import Course
from ptmcad.ask.fields.descent import solution
from ptmcad.ask.fields.equations import Floats, ModelState, parameters_at, state_at
from ptmcad.question.slice import Slice

ALONG = 0.08
"""Radians, or units, that a solution may move in a part of a step, in which it is followed without
looking again.
"""
MIN_STEP = 1e-7
"""Of the course: a solution that cannot be followed so far has vanished."""


class Track:
    """A slice's model along a course."""

    def __init__(self, slice: Slice, course: Course):
        self.slice, self.course, self.model = slice, course, slice.model

    def state(self, at: Place, unknowns: Floats) -> ModelState:
        """The model at a point of the slice, and unknowns of shape (n, k)."""
        x, y = (np.array([float(value)]) for value in at)
        return state_at(self.model, parameters_at(self.slice, x, y), unknowns)

    def at(self, share: float, unknowns: Floats) -> ModelState:
        """The same where a share of the course is done."""
        return self.state(self.course.at(Fraction(share)), unknowns)

    def solved(self, share: float, start: Floats) -> tuple[Floats, ModelState] | None:
        """Where Newton's method leads from unknowns of shape (n,), with the model there."""
        return solution(lambda at: self.at(share, at), start)


def followed(
    track: Track, at: Floats, done: float, to: float, own: int
) -> tuple[Floats, float, bool]:
    """The solution further along the course, and how far: to where it should go, or to where it
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
