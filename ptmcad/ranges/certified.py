"""The intervals of constant count along a line for springs with free lengths: the certified engine's answer as a table.

Guarantee: every digit is right; what was not decided is called undecided and has no counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from ptmcad.domain import prove
from ptmcad.enclosure import Enclosure
from ptmcad.errors import ExpressionError
from ptmcad.expressions import rational
from ptmcad.memory import check_room, loading
from ptmcad.numerals import shortest_text
from ptmcad.ranges.line import restricted, varying_axis
from ptmcad.ranges.table import aligned
from ptmcad.regionmap import MorseIndex
from ptmcad.slice import FREE_LENGTHS, Axis, Slice


@dataclass(frozen=True, slots=True)
class CertifiedInterval:
    """An open interval, its ends' enclosures (exact at the window's edge), and the counts on it.

    ``index`` and ``cones`` are None when nothing could be decided at ``sample``.
    """

    low: Enclosure
    high: Enclosure
    index: MorseIndex | None
    cones: int | None
    sample: Fraction


@dataclass(frozen=True, slots=True)
class CertifiedChange:
    """What lies between two intervals: the curves met there; ``proved`` when each was proved to be met exactly."""

    at: Enclosure
    names: tuple[str, ...]
    proved: bool


@dataclass(frozen=True, slots=True)
class CertifiedIntervals:
    """The answer for a line, from the window's lower edge to its upper one."""

    along: Axis
    at: Mapping[str, Fraction]
    intervals: tuple[CertifiedInterval, ...]
    changes: tuple[CertifiedChange, ...]


def has_free_lengths(slice: Slice, along: str, at: Mapping[str, Any]) -> bool:
    """Whether a spring has a free length on the line; where none has, algebra answers, or refuses the line."""
    if along not in slice.axis_names:
        return False
    varying = slice.axis_names.index(along)
    other = slice.axis_names[1 - varying]
    if other not in at:
        return False
    try:
        value = rational(at[other])
        return any(
            restricted(slice.parameters[name], varying, value).numerator
            for name in FREE_LENGTHS
            if name in slice.parameters
        )
    except ExpressionError:
        return False


def certified_intervals(slice: Slice, along: str, at: Mapping[str, Any], digits: int) -> CertifiedIntervals:
    """The intervals of constant count on a line of a slice whose springs have free lengths.

    Parameters
    ----------
    along : the axis that varies, over its window.
    at : the other axis with its value: text, int or Fraction.
    digits : significant digits to which critical values are enclosed.

    Raises
    ------
    ConfigError
        When ``along`` is no axis, or ``at`` does not name exactly the other one with an exact number.
    GeometryError
        When a parameter is not on the whole line what the proofs ask for, or that could not be proved. The line need
        not lie in the slice's window, so nothing that is known of the window is used.
    """
    with loading("the certified engine"):
        from ptmcad.interval.line import line_counts
    check_room("the certified engine")
    varying, other, value = varying_axis(slice, along, at)
    on_line = {name: restricted(e, varying, value) for name, e in slice.parameters.items()}
    prove(on_line, (slice.axes[varying], Axis(other, value, value)))
    line = replace(slice, axes=(slice.axes[varying], Axis(other, value, value)), parameters=on_line)
    found = line_counts(line, 0, value, 64 + 4 * digits)
    ends = {gap.low: Enclosure(gap.low, gap.high) for gap in found.gaps}
    ends |= {gap.high: Enclosure(gap.low, gap.high) for gap in found.gaps}

    def end(place: Fraction) -> Enclosure:
        return ends.get(place, Enclosure(place, place))

    return CertifiedIntervals(
        slice.axes[varying],
        {other: value},
        tuple(
            CertifiedInterval(end(s.low), end(s.high), s.counts.index, s.counts.cones, s.sample)
            for s in found.stretches
        ),
        tuple(CertifiedChange(Enclosure(g.low, g.high), g.names, g.proved) for g in found.gaps),
    )


def table(found: CertifiedIntervals, digits: int) -> str:
    """One row for each interval, then what lies between them."""
    fixed = ", ".join(f"{n} = {shortest_text(v)}" for n, v in found.at.items())
    rows = [["from", "to", "total", "stable", "min-saddle-max", "peaks", "sample"]]
    for i in found.intervals:
        counts = ["undecided", "", "", ""]
        if i.index is not None:
            counts = [str(sum(i.index)), str(i.index[0]), "-".join(map(str, i.index)), str(i.cones)]
        rows.append([_text(i.low, digits, up=True), _text(i.high, digits), *counts, shortest_text(i.sample)])
    lines = [f"{found.along.name} in ({shortest_text(found.along.low)}, {shortest_text(found.along.high)}) at {fixed}"]
    lines += ["", *aligned(rows)]
    if found.changes:
        changes = [["at", "what is met"]]
        for change in found.changes:
            place = _text(change.at, digits)
            if not change.at.settles(digits):
                place = f"{place} to {_text(change.at, digits, up=True)}"
            note = "" if change.proved else "undecided whether there is a "
            changes.append([place, note + " and a ".join(change.names)])
        lines += ["", *aligned(changes)]
    lines += ["", "peaks: configurations without length of spring A3A4 in which the energy has a peak"]
    return "\n".join(lines)


def _text(end: Enclosure, digits: int, up: bool = False) -> str:
    """The end rounded; where its digits are not settled, its outer side, rounded outwards."""
    if end.settles(digits):
        return end.text(digits)
    value = end.high if up else end.low
    scale = Fraction(10) ** digits
    rounded = (-((-value * scale) // 1) if up else (value * scale) // 1) / scale
    return Enclosure(rounded, rounded).text(digits + 20)
