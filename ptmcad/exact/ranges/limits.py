"""The limits of an operation range at a rational end of a strip, and chords from them that bound its width.

Guarantee: `limit` is the branch's limit, and over `chord_length` the range stays between two parallel chords from its
limits; None means that this was not proved.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.chords import side_of_chord
from ptmcad.algebra.numbers import as_interval, fibre_roots, refined, root_of
from ptmcad.algebra.real_roots import simplest_between
from ptmcad.algebra.window import Interval
from ptmcad.answer.intervals import End
from ptmcad.exact.ranges.strips import Branch, Strip, at_abscissa, bound_over
from ptmcad.text.flint_numbers import from_fraction, to_fraction


def ends_of(end: End) -> Interval:
    """An interval that holds a limit: of length zero when it is rational."""
    if isinstance(end, Fraction):
        return from_fraction(end), from_fraction(end)
    return as_interval(end)


def limit(branch: Branch, strip: Strip, end: fmpq, width: fmpq) -> End | None:
    """The limit of a branch at a rational end of its strip; None when it could not be separated from other points."""
    if branch.curve is None:
        return to_fraction(branch.edge)
    margin = strip.fibre[1] - strip.fibre[0]
    wide = (strip.fibre[0] - margin, strip.fibre[1] + margin)
    distance = strip.sample - end
    fibre = branch.curve.fibre(end)
    for _ in range(60):
        u = end + distance
        over = (min(u, end), max(u, end))
        at = at_abscissa(branch, u, strip.fibre, abs(distance) / 2**10)
        top = bound_over(branch, at.high, 1, over, wide)
        bottom = bound_over(branch, at.low, -1, over, wide)
        if top is not None and bottom is not None:
            found = fibre_roots(fibre, bottom, top)
            if len(found) == 1:
                return refined(found[0], to_fraction(width))
        distance = distance / 4
    return None


def chord_length(strip: Strip, end: fmpq, direction: int, limits: tuple[End, End]) -> fmpq | None:
    """A length within which the range keeps between parallel chords from its limits at an end; None if not proved."""
    length = abs(strip.sample - end)
    branches, starts = (strip.low, strip.high), [ends_of(e) for e in limits]
    for _ in range(40):
        run = direction * length
        tips = [at_abscissa(b, end + run, strip.fibre, length / 2**40) for b in branches]
        rises = [
            ((tip.low + tip.high) / 2 - (start[0] + start[1]) / 2) / run
            for tip, start in zip(tips, starts, strict=True)
        ]
        # the lower end rises more than the upper one where the range gets narrower
        if (rises[0] - rises[1]) * direction > 0:
            third = (rises[0] - rises[1]) / 3
            slope = simplest_between(*sorted((rises[1] + third, rises[0] - third)))
            if all(
                _keeps_to(side, branch, strip.fibre, _Chord(end, limit, slope, run))
                for side, branch, limit in zip((1, -1), branches, limits, strict=True)
            ):
                return length
        length = length / 4
    return None


class _Chord(NamedTuple):
    """From a limit at the end of a strip as far as ``run``, which is negative towards the left."""

    end: fmpq
    limit: End
    slope: fmpq
    run: fmpq


def _keeps_to(side: int, branch: Branch, fibre: Interval, chord: _Chord) -> bool:
    """Whether a branch is proved to stay above (side 1) or below (side -1) the chord from its limit."""
    low, high = (end + chord.slope * chord.run for end in ends_of(chord.limit))
    tip = at_abscissa(branch, chord.end + chord.run, fibre, abs(chord.run) / 2**60)
    if not (tip.low > high if side > 0 else tip.high < low):
        return False
    if branch.curve is None:
        return True  # the edge is level and, as the tip shows, the chord leaves it to the right side
    if isinstance(chord.limit, Fraction):
        return False
    return side_of_chord(branch.curve.in_v, chord.end, root_of(chord.limit), chord.slope, chord.run)
