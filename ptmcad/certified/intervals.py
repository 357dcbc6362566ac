"""The intervals of constant count along a line for springs with free lengths: the certified engine's answer as a table.

Guarantee: every digit is right; what was not decided is called undecided and has no counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ptmcad.answer.intervals import CertifiedChange, CertifiedInterval, CertifiedIntervals
from ptmcad.process.memory import loading
from ptmcad.question.domain import proved
from ptmcad.question.line import on_line, varying_axis
from ptmcad.question.slice import Axis, Slice
from ptmcad.text.enclosure import Enclosure

if TYPE_CHECKING:
    from ptmcad.certified.line import Stretch
    from ptmcad.certified.points import PointCount


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
        from ptmcad.certified.line import line_counts
    varying, other, value = varying_axis(slice, along, at)
    axes = slice.axes[varying], Axis(other, value, value)
    line = proved(replace(slice, axes=axes, parameters=on_line(slice, varying, value)))
    found = line_counts(line, 0, value, 64 + 4 * digits)
    ends = {gap.low: Enclosure(gap.low, gap.high) for gap in found.gaps}
    ends |= {gap.high: Enclosure(gap.low, gap.high) for gap in found.gaps}

    def end(place: Fraction) -> Enclosure:
        return ends.get(place, Enclosure(place, place))

    def interval(s: Stretch) -> CertifiedInterval:
        total, stable = _numbers(slice, s.counts)
        return CertifiedInterval(end(s.low), end(s.high), s.counts.index, s.counts.cones, s.sample, total, stable)

    return CertifiedIntervals(
        slice.axes[varying],
        {other: value},
        tuple(map(interval, found.stretches)),
        tuple(CertifiedChange(Enclosure(g.low, g.high), g.names, g.proved) for g in found.gaps),
    )


def _numbers(slice: Slice, counts: PointCount) -> tuple[int | None, int | None]:
    """All equilibria and the stable ones; nothing where it is known what is stable, but not of each of them."""
    if counts.index is not None:
        return sum(counts.index), counts.index[0]
    if counts.total is None or not slice.model.tells_stability:
        return counts.total, None
    if not all(solution.signs for solution in counts.solutions):
        return None, None
    return counts.total, sum(not solution.signs.strip("+") for solution in counts.solutions)
