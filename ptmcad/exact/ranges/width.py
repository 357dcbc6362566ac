"""The operation range's width against the other axis of a slice, and the proof of where it is
largest.

Guarantee: `Maximum.width` encloses the supremum of the width over all values of the other axis in
the window, its ends included, and `Maximum.at` where it is attained or approached: at all values
outside of it the width is smaller. What is proved beyond that `Maximum.place` and
`Maximum.attainment` say.

A limit at a critical value is the width there, unless the whole line is in the variety, or two
ranges meet on it at a point: then, and at the window's edges, what is counted on the line itself is
its width (`anyline`). For an open arc of the line that is off the variety has the count of the
cells on both sides of it, and the others are points.

Each strip (see `strips`) is cut into closed pieces, and each piece is settled in one of these ways.

* Below: levels that no curve crosses bound the range from both sides, and lie closer than a width
  that occurs.
* Monotone: the derivative of the width, enclosed over the piece, has one sign; the largest width is
  at an end of it.
* Concave: the second derivative is negative, the first one changes its sign: one maximum, enclosed
  by bisection.
* Chord: at a rational end y0 of the strip the limits a, b of the range are algebraic numbers. If
  for some s the lower end stays above a + s (y - y0), and the upper one below b + s (y - y0), the
  width stays under b - a. This also settles cusps, where derivatives are infinite.
* Narrowing: from an end of the strip on, the range's ends draw nearer to one another.

A piece that becomes too small remains, with the bounds that it has: then the place is only
enclosed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush
from typing import NamedTuple

from flint import arb, fmpq

from ptmcad.algebra.real_roots import Interval, algebraic_number, compare
from ptmcad.answer.intervals import End, Span
from ptmcad.answer.widths import Maximum, Place
from ptmcad.exact.cad.stacks import BaseEnd
from ptmcad.exact.ranges.anyline import SpecialLine, lines_of, number_at
from ptmcad.exact.ranges.rangestrips import (
    RANGE_END_WIDTH,
    RangeStrip,
    RangeStrips,
    at_abscissa,
    base_interval,
    bound_over,
    constant_width,
    end_interval,
)
from ptmcad.exact.ranges.striplimits import (
    Ends,
    chord_length,
    limits,
    narrowing_length,
    slope_sign,
    width_slopes,
)
from ptmcad.question.slice import Slice
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.flint_numbers import interval_of, to_fraction

_MIN_PIECE = fmpq(1, 2**50)
"""Length of a piece, against the strip's, that is not cut any more."""
_MAX_PIECES = 20_000


@dataclass(frozen=True, slots=True)
class _Candidate:
    """What may be the largest; of a plateau ``sides`` say whether it is attained at its strips'
    ends.
    """

    place: Place
    at: Interval
    width: Interval
    critical: AlgebraicNumber | None = None
    ends: Ends | None = None
    attained: bool | None = True
    sides: dict[End, bool | None] = field(default_factory=dict)


def widest(slice: Slice, along: str, found: RangeStrips) -> tuple[Maximum, ...]:
    """The largest width over a slice's strips and on the lines that have a width of their own."""
    return largest(found.found, lines_of(slice, along, found))


def largest(found: Sequence[RangeStrip], lines: Sequence[SpecialLine] = ()) -> tuple[Maximum, ...]:
    """The largest width over all strips and on lines; see the module."""
    search = _WidthSearch(lines)
    for line in lines:
        search.line(line)
    for strip in found:
        search.sample(strip)
    for strip in found:
        if constant_width(strip):
            search.plateau(strip)
        else:
            search.ends(strip)
    search.settle()
    return search.answer()


class _WidthPiece(NamedTuple):
    """A part [low, high] of a strip's base; ``open_left`` and ``open_right`` when it reaches an
    irrational end.
    """

    strip: RangeStrip
    low: fmpq
    high: fmpq
    open_left: bool
    open_right: bool
    smallest: fmpq


class _WidthSearch:
    """Branch and bound over the strips."""

    def __init__(self, lines: Sequence[SpecialLine]) -> None:
        self.lines = {line.value: line.ranges for line in lines}
        self.known = fmpq(0)  # a width that occurs, or is approached
        self.candidates: list[_Candidate] = []
        self.heap: list[tuple[fmpq, int, _WidthPiece]] = []
        self.number = 0

    # ---------------------------------------------------------------------------------------------------- the lines

    def line(self, line: SpecialLine) -> None:
        """Adopt what is counted on a line."""
        certain, possible = (max(spans, key=_width, default=None) for spans in line.ranges)
        if certain is not None:
            self.add_at(line.end, _width(certain), certain.exact, True)
            self.known = max(self.known, _width(certain)[0])
        if possible is not None and possible != certain:
            self.add_at(line.end, (fmpq(0), _width(possible)[1]), None, None)

    def add_at(
        self, end: BaseEnd, width: Interval, ends: Ends | None, attained: bool | None
    ) -> None:
        """A candidate at an end of a strip."""
        place = Place.EDGE if end.critical is None else Place.CRITICAL
        critical = None if end.critical is None else algebraic_number(end.root)
        at = end_interval(end)
        self.candidates.append(_Candidate(place, at, width, critical, ends, attained))

    def attains(self, end: BaseEnd, width: Interval, ends: Ends | None) -> bool | None:
        """Whether on the line at an end of a strip there is a range of a width that is its limit
        there.
        """
        ranges = self.lines.get(number_at(end))
        if ranges is None:
            return True
        certain, possible = ranges
        if any(
            (ends is not None and _within(ends, span)) or _width(span)[0] >= width[1]
            for span in certain
        ):
            return True
        return False if all(_width(span)[1] < width[0] for span in possible) else None

    # ------------------------------------------------------------------------------------------------ lower bounds

    def sample(self, strip: RangeStrip) -> None:
        (_, left), (right, _) = base_interval(strip)
        for k in range(1, 8):
            self.width_at(strip, left + (right - left) * fmpq(k, 8))

    def width_at(self, strip: RangeStrip, u: fmpq) -> Interval:
        low, high = (
            at_abscissa(b, u, strip.fibre, RANGE_END_WIDTH) for b in (strip.low, strip.high)
        )
        width = (high.low - low.high, high.high - low.low)
        self.known = max(self.known, width[0])
        return width

    # -------------------------------------------------------------------------------------------------- strips' ends

    def plateau(self, strip: RangeStrip) -> None:
        (left, _), (_, right) = base_interval(strip)
        width = self.width_at(strip, strip.sample)
        sides = {
            number_at(end): self.attains(end, width, limits(strip, end))
            for end in (strip.left, strip.right)
        }
        self.candidates.append(_Candidate(Place.PLATEAU, (left, right), width, sides=sides))

    def ends(self, strip: RangeStrip) -> None:
        """Settle neighbourhoods of ends with the largest limits, and list the rest as one piece."""
        left, right = base_interval(strip)
        low, high = left[0], right[1]
        for at, end in ((left, strip.left), (right, strip.right)):
            own = limits(strip, end)
            if own is None:
                continue
            width = _width(Span(*own))
            self.known = max(self.known, width[0])
            if width[1] < self.known:
                continue
            length = None
            if at[0] == at[1]:
                length = chord_length(strip, at[0], 1 if end is strip.left else -1, own)
            if length is None:
                length = narrowing_length(strip, end)
            if length is None:
                continue
            self.add_at(end, width, own, self.attains(end, width, own))
            if end is strip.left:
                low = at[0] + length
            else:
                high = at[0] - length
        self.add(
            _WidthPiece(
                strip,
                low,
                high,
                low == left[0],
                high == right[1],
                (right[1] - left[0]) * _MIN_PIECE,
            )
        )

    # -------------------------------------------------------------------------------------------------------- pieces

    def add(self, piece: _WidthPiece) -> None:
        if piece.low >= piece.high:
            return
        bound = self.bound(piece)
        if bound >= self.known:
            self.number += 1
            heappush(self.heap, (-bound, self.number, piece))

    def bound(self, piece: _WidthPiece) -> fmpq:
        """An upper bound for the width over the piece."""
        strip = piece.strip
        u = (piece.low + piece.high) / 2
        low, high = (
            at_abscissa(b, u, strip.fibre, (piece.high - piece.low) / 2**10)
            for b in (strip.low, strip.high)
        )
        top = bound_over(strip.high, high.high, 1, (piece.low, piece.high), strip.fibre)
        bottom = bound_over(strip.low, low.low, -1, (piece.low, piece.high), strip.fibre)
        return (strip.fibre[1] if top is None else top) - (
            strip.fibre[0] if bottom is None else bottom
        )

    def settle(self) -> None:
        count = 0
        while self.heap:
            negative, _, piece = heappop(self.heap)
            if -negative < self.known:
                return  # and so are all others
            count += 1
            if count > _MAX_PIECES or piece.high - piece.low < piece.smallest:
                width, strip = (self.known, -negative), piece.strip
                ends = [strip.left] * piece.open_left + [strip.right] * piece.open_right
                critical = next(
                    (algebraic_number(end.root) for end in ends if end.critical is not None), None
                )
                # a continuous function on a closed interval, but for ends at which the line has
                # another width
                attained = all(self.attains(end, width, None) for end in ends) or None
                self.candidates.append(
                    _Candidate(
                        Place.ENCLOSED, (piece.low, piece.high), width, critical, None, attained
                    )
                )
                continue
            middle = _cut(piece.low, piece.high)
            self.width_at(piece.strip, middle)
            if not piece.open_left and not piece.open_right and self.smooth(piece):
                continue
            self.add(piece._replace(high=middle, open_right=False))
            self.add(piece._replace(low=middle, open_left=False))

    def smooth(self, piece: _WidthPiece) -> bool:
        """Whether derivatives settle the piece: monotone, or concave with one maximum, which is
        then a candidate.
        """
        slopes = width_slopes(piece.strip, piece.low, piece.high)
        if slopes is None:
            return False
        first, second = slopes
        if first > 0 or first < 0:
            return True
        if not second < 0:
            return False
        low, high = piece.low, piece.high
        left, right = (slope_sign(piece.strip, u, piece.smallest) for u in (low, high))
        if left is None or right is None:
            return False
        if left == right:
            return True  # the derivative falls, so it has this sign all along
        if left < 0:
            return False
        steepest = first.abs_upper()
        while high - low > piece.smallest / 2**20:
            cuts = (_cut(low, high), low + (high - low) / 3)  # one of them is not the zero itself
            found = ((u, slope_sign(piece.strip, u, (high - low) / 2**20)) for u in cuts)
            middle, at = next(((u, sign) for u, sign in found if sign is not None), (low, None))
            if at is None:
                break
            low, high = (middle, high) if at > 0 else (low, middle)
        width = self.width_at(piece.strip, (low + high) / 2)
        slack = (steepest * arb(high - low)).upper().fmpq()
        self.candidates.append(_Candidate(Place.SMOOTH, (low, high), (width[0], width[1] + slack)))
        return True

    def answer(self) -> tuple[Maximum, ...]:
        """The candidates that may be the largest; those at the same place are one, a plateau takes
        in its ends.
        """
        kept = [c for c in self.candidates if c.width[1] >= self.known]
        plateaus = [c for c in kept if c.place is Place.PLATEAU]
        merged: list[_Candidate] = []
        for c in sorted(kept, key=lambda c: (c.at, c.place is not Place.PLATEAU)):
            if c.place is not Place.PLATEAU and any(
                _touches(c, p) and c.width[1] <= p.width[1] for p in plateaus
            ):
                continue
            if merged and _touches(merged[-1], c) and _is_one(merged[-1].place, c.place):
                merged.append(_joined(merged.pop(), c))
            else:
                merged.append(c)
        if len(merged) > 1:  # an enclosed width may be less than that of another place
            merged = [replace(c, attained=None) if c.place is Place.ENCLOSED else c for c in merged]
        return tuple(map(self.maximum, merged))

    def maximum(self, c: _Candidate) -> Maximum:
        """A candidate as data."""
        at, width = (
            Enclosure(to_fraction(low), to_fraction(high)) for low, high in (c.at, c.width)
        )
        if c.place is not Place.PLATEAU:
            return Maximum(c.place, at, width, c.critical, c.ends, c.attained)
        exceptions, doubtful = (
            tuple(v for v, known in c.sides.items() if known is kind) for kind in (False, None)
        )
        return Maximum(c.place, at, width, None, None, True, exceptions, doubtful)


def _width(span: Span) -> Interval:
    known = Span(
        *(AlgebraicNumber.of(e).refined(to_fraction(RANGE_END_WIDTH)) for e in span.exact)
    ).width
    return interval_of(known)


def _within(ends: Ends, span: Span) -> bool:
    """Whether limits are within a range, ends included."""
    low, high, first, last = map(AlgebraicNumber.of, (*ends, *span.exact))
    return compare(first, low) <= 0 <= compare(last, high)


def _is_one(first: Place, second: Place) -> bool:
    """Whether candidates at these places that touch are one.

    Beside a critical value at which the width is known the largest one may be anywhere in an
    enclosure.
    """
    return first is second or {first, second} == {Place.CRITICAL, Place.ENCLOSED}


def _joined(first: _Candidate, second: _Candidate) -> _Candidate:
    alike = first.place is second.place
    known = (first.attained, second.attained)
    return _Candidate(
        first.place if alike else Place.ENCLOSED,
        (first.at[0], max(first.at[1], second.at[1])),
        (max(first.width[0], second.width[0]), max(first.width[1], second.width[1])),
        first.critical or second.critical,
        first.ends if first.attained else second.ends,
        None if None in known or (not alike and False in known) else any(known),
        first.sides | {v: first.sides.get(v) or known for v, known in second.sides.items()},
    )


def _touches(first: _Candidate, second: _Candidate) -> bool:
    return bool(first.at[0] <= second.at[1] and second.at[0] <= first.at[1])


def _cut(low: fmpq, high: fmpq) -> fmpq:
    """A point near the middle: a short number, and yet not one at which a maximum is likely to be."""
    width = high - low
    unit = fmpq(2) ** (int(width.p).bit_length() - int(width.q).bit_length() - 7)
    return unit * (int(((low + width * fmpq(61, 128)) / unit).floor()) | 1)
