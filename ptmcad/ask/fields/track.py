"""A path over a map's window, straight pieces between corners that are given as values of the two
axes; and one solution followed along it by Newton's method, in floating point.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from math import hypot
from typing import Any

import numpy as np

from ptmcad.answer.motion import Place
from ptmcad.ask.fields.descent import solution
from ptmcad.ask.fields.equations import Floats, ModelState, parameters_at, state_at
from ptmcad.errors import ConfigError, shown
from ptmcad.question.shipped import FIRST, SECOND
from ptmcad.question.slice import Slice
from ptmcad.text.parsing import number_for

OPTION = "--path"
MAX_CORNERS = 100
MIN_LENGTH = 1e-6
"""Of a piece, against the longest: shorter ones are left out."""


def corners_of(slice: Slice, path: str | Mapping[str, Any]) -> tuple[Place, ...]:
    """The corners of a path such as ``rho=1/2:6/5,L2=3/2``, where each axis has one value or one
    for each corner.

    Parameters
    ----------
    path : a text, or a mapping of the two axes to a value or a sequence of values.

    Raises
    ------
    ConfigError
        When the names are not the two axes, a value is not an exact number inside the window, the
        numbers of values do not fit together, or the path leads nowhere.
    """
    given = _of_text(path) if isinstance(path, str) else {n: _listed(v) for n, v in path.items()}
    names = slice.axis_names
    if set(given) != set(names):
        raise ConfigError(
            f"give values of both axes, as in {names[0]}=FROM:TO,{names[1]}=VALUE", key=OPTION
        )
    values = [[number_for(OPTION, value) for value in given[name]] for name in names]
    for axis, own in zip(slice.axes, values, strict=True):
        outside = [value for value in own if not axis.holds(value)]
        if outside:
            raise ConfigError(
                f"{axis.name} = {shown(str(outside[0]), 40)} is not inside the window, {axis.low} to {axis.high}",
                key=OPTION,
            )
    most = max(map(len, values))
    if most > MAX_CORNERS:
        raise ConfigError(f"a path has at most {MAX_CORNERS} corners", key=OPTION)
    if any(len(own) not in (1, most) for own in values):
        raise ConfigError(
            f"{names[0]} has {len(values[0])} values and {names[1]} {len(values[1])}: give one, or as many for both",
            key=OPTION,
        )
    x, y = (own * most if len(own) == 1 else own for own in values)
    corners = tuple(zip(x, y, strict=True))
    if len(set(corners)) < 2:
        raise ConfigError(f"the path leads nowhere: write {names[0]}=FROM:TO", key=OPTION)
    return corners


def _of_text(text: str) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for part in text.split(","):
        name, equals, values = (piece.strip() for piece in part.partition("="))
        listed = [value.strip() for value in values.split(":")]
        if not (name and equals and all(listed)) or name in found:
            raise ConfigError(
                f"'{shown(part, 60)}' is neither NAME=VALUE nor NAME=FROM:TO, as in {SECOND}=1/2:6/5,{FIRST}=3/2",
                key=OPTION,
            )
        found[name] = listed
    return found


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, Sequence) and not isinstance(value, str) else [value]


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
