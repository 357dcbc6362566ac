"""The values along a line of a slice at which counts change, enclosed, and the counts between them, proved.

Guarantee: on each interval of the result the numbers of minima, saddles, maxima and cones are constant. What was not
decided lies in one of the gaps between them; a gap that is `proved` holds nothing but isolated critical values.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain, pairwise

import numpy as np
from flint import ctx

from ptmcad.answer.intervals import CertifiedChange, CertifiedInterval
from ptmcad.certified.arb_isolation import Box, refined
from ptmcad.certified.curve import CriticalCurve
from ptmcad.certified.plain.curves import curves
from ptmcad.certified.plain.points import plain_counter
from ptmcad.certified.points import PointCount
from ptmcad.certified.search import Boxes, isolate
from ptmcad.certified.system import EquationSystem
from ptmcad.formulas.balls import ball, lower, upper
from ptmcad.formulas.tape import enclosing_floats
from ptmcad.question.slice import Count, Slice
from ptmcad.text.enclosure import Enclosure

MIN_BOX_WIDTH = 1e-8
BUDGET, MAX_OPEN_BOXES = 20_000, 400
"""Boxes to treat, and boxes to leave open, before a part of the line is halved."""
MAX_BOXES = 600_000
"""Boxes for one curve after which nothing is halved any more."""
START_PARTS = 16
MIN_PART = Fraction(1, 2**16)
"""Parts of the line of this share are not halved."""


def line_counts(
    slice: Slice, varying: int, value: Fraction, bits: int
) -> tuple[tuple[CertifiedInterval, ...], tuple[CertifiedChange, ...]]:
    """The counts on the line on which axis ``varying`` runs over its window and the other one has a value.

    Intervals and the changes between them, both in increasing order.

    Parameters
    ----------
    bits : precision to which critical values are enclosed.
    """
    axis = slice.axes[varying]
    wanted = curves(slice, Count.INDEX)
    found: list[list[CertifiedChange]] = [[] for _ in wanted]
    # what is quick to search comes first: what it leaves undecided need not be looked at closely again
    for k in sorted(range(len(wanted)), key=lambda k: len(wanted[k].system.tape)):
        undecided = _joined([gap for gaps in found for gap in gaps if not gap.proved])
        found[k] = list(_gaps(slice, wanted[k], varying, value, bits, [gap.at for gap in undecided]))
    gaps = _joined([g for some in found for g in some if g.at.high > axis.low and g.at.low < axis.high])
    counter = plain_counter(slice)
    intervals = []
    for before, after in pairwise([_point(axis.low), *(gap.at for gap in gaps), _point(axis.high)]):
        if before.high < after.low:
            sample = _simple(before.high, after.low)
            x, y = (sample, value) if varying == 0 else (value, sample)
            counts = counter.at(x, y, Count.INDEX)
            numbers = _numbers(slice, counts)
            intervals.append(CertifiedInterval(before, after, counts.index, counts.cones, sample, *numbers))
    return tuple(intervals), tuple(gaps)


def _point(value: Fraction) -> Enclosure:
    return Enclosure(value, value)


def _numbers(slice: Slice, counts: PointCount) -> tuple[int | None, int | None]:
    """All equilibria and the stable ones; nothing where it is known what is stable, but not of each of them."""
    if counts.index is not None:
        return sum(counts.index), counts.index[0]
    if counts.total is None or not slice.model.tells_stability:
        return counts.total, None
    if not all(solution.signs for solution in counts.solutions):
        return None, None
    return counts.total, sum(not solution.signs.strip("+") for solution in counts.solutions)


def _gaps(
    slice: Slice, curve: CriticalCurve, varying: int, value: Fraction, bits: int, undecided: Sequence[Enclosure]
) -> Iterator[CertifiedChange]:
    """Where the line meets a curve; parts of it that are too hard as a whole are halved while the budget lasts, but for
    what is ``undecided`` in them."""
    system = on_line(curve.system, varying)
    equations = replace(system, vanishing=(_NONE, _NONE, _NONE), nonnegative=_NONE)
    axis = slice.axes[varying]
    step = (axis.high - axis.low) / START_PARTS
    waiting = [(axis.low + k * step, axis.low + (k + 1) * step) for k in range(START_PARTS)]
    smallest = (axis.high - axis.low) * MIN_PART
    total = 0
    while waiting:
        low, high = waiting.pop()
        along, fixed = (enclosing_floats(low)[0], enclosing_floats(high)[1]), enclosing_floats(value)
        ranges = (along, fixed) if varying == 0 else (fixed, along)
        start = curve.start(np.array([[ranges[0][0], ranges[1][0], ranges[0][1], ranges[1][1]]]))
        limits = MIN_BOX_WIDTH, BUDGET, MAX_OPEN_BOXES
        found = isolate(system.arguments(), equations.arguments(), start, limits, curve.importance())
        total += found.used
        left, variables = found.left(), start.shape[1] // 2
        if (found.used >= BUDGET or len(left) > MAX_OPEN_BOXES) and high - low > smallest and total < MAX_BOXES:
            inside = [(max(low, g.low), min(high, g.high)) for g in undecided if g.high > low and g.low < high]
            yield from (CertifiedChange(Enclosure(*ends), (curve.name,), False) for ends in inside)
            middle = (low + high) / 2
            edges = [low, *chain.from_iterable(inside or [(middle, middle)]), high]
            waiting += [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if a < b]
            continue
        for box in left:
            ends = Fraction(float(box[varying])), Fraction(float(box[variables + varying]))
            yield CertifiedChange(Enclosure(*ends), (curve.name,), False)
        # ``narrow`` was contracted with the equations alone; its number can be enclosed to any precision
        for row in found.narrow:
            with ctx.workprec(bits):
                box = _balls(row, varying, value)
            exact = refined(equations, box, bits)[varying]
            yield CertifiedChange(Enclosure(lower(exact), upper(exact)), (curve.name,), True)


_NONE = np.empty(0, np.int64)


def _balls(row: Boxes, varying: int, value: Fraction) -> Box:
    variables = len(row) // 2
    box = [ball(Fraction(float(row[k])), Fraction(float(row[variables + k]))) for k in range(variables)]
    box[1 - varying] = ball(value, value)
    return tuple(box)


def on_line(system: EquationSystem, varying: int) -> EquationSystem:
    """The square system that is left when the other axis has a value."""
    kept = np.array([k for k, unknown in enumerate(system.unknowns) if unknown != 1 - varying], np.int64)
    # the value is fixed: what the equations say of it must not narrow the floats around it
    solved = system.solved[system.solved[:, 0] == varying]
    jacobian = np.ascontiguousarray(system.jacobian[:, kept])
    return replace(system, unknowns=system.unknowns[kept], jacobian=jacobian, solved=solved)


def _joined(gaps: Sequence[CertifiedChange]) -> list[CertifiedChange]:
    """Gaps that touch become one."""
    joined: list[CertifiedChange] = []
    for gap in sorted(gaps, key=lambda g: (g.at.low, g.at.high)):
        if not joined or gap.at.low > joined[-1].at.high:
            joined.append(gap)
            continue
        last = joined.pop()
        names = tuple(dict.fromkeys((*last.names, *gap.names)))
        at = Enclosure(last.at.low, max(last.at.high, gap.at.high))
        joined.append(CertifiedChange(at, names, last.proved and gap.proved))
    return joined


def _simple(low: Fraction, high: Fraction) -> Fraction:
    """A rational number of few digits in the middle third."""
    width = (high - low) / 3
    places = 0
    while Fraction(1, 10**places) > width:
        places += 1
    return Fraction(round((low + high) / 2 * 10**places), 10**places)
