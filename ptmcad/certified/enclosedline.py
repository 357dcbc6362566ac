"""The values along a line of a slice at which counts change, enclosed, and the counts between them,
proved.

Guarantee: on each interval of the result the numbers of minima, saddles, maxima and cones are
constant. What was not decided lies in one of the changes between them; one that is `proved` holds
nothing but isolated critical values, each proved to be the only one near it. Another one may hold
none.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain, pairwise

import numpy as np
from flint import ctx

from ptmcad.answer.counts import Counts
from ptmcad.answer.intervals import Change, CountInterval
from ptmcad.certified.arb_isolation import refined
from ptmcad.certified.branchandprune import isolate
from ptmcad.certified.equationsystem import EquationSystem
from ptmcad.certified.plain.criticalcurves import curves
from ptmcad.certified.plain.pointcounts import plain_counter
from ptmcad.certified.plain.zeros import PointCount
from ptmcad.certified.refinement import CriticalCurve
from ptmcad.formulas.ballarithmetic import ball, balls, lower, upper
from ptmcad.formulas.tape import enclosing_floats
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice
from ptmcad.text.enclosure import Enclosure

MIN_BOX_WIDTH = 1e-8
BUDGET, MAX_OPEN_BOXES = 20_000, 400
"""Boxes to treat, and boxes to leave open, before a part of the line is halved."""
MAX_BOXES = 600_000
"""Boxes for one curve after which nothing is halved any more."""
START_PARTS = 16
MIN_PART = Fraction(1, 2**16)
"""Parts of the line of this share are not halved."""


def intervals_and_changes(
    slice: Slice, bits: int
) -> tuple[tuple[CountInterval, ...], tuple[Change, ...]]:
    """The counts on the line of a slice's first axis, and what lies between them; the other axis
    has one value.

    Intervals and the changes between them, both in increasing order.

    Parameters
    ----------
    bits : precision to which critical values are enclosed.
    """
    axis, value = slice.axes[0], slice.axes[1].low
    wanted = curves(slice, Count.INDEX)
    met: list[list[Change]] = [[] for _ in wanted]
    # what is quick to search comes first: what it leaves undecided need not be looked at closely
    # again
    for k in sorted(range(len(wanted)), key=lambda k: len(wanted[k].system.tape)):
        undecided = _joined([change for some in met for change in some if not change.proved])
        met[k] = list(_changes(slice, wanted[k], bits, undecided))
    changes = _joined(
        [c for some in met for c in some if c.at.high > axis.low and c.at.low < axis.high]
    )
    counter = plain_counter(slice)
    first, last = (Enclosure(end, end) for end in (axis.low, axis.high))
    ends = (first, *(change.at for change in changes), last)
    found: list[CountInterval | None] = []
    for low, high in pairwise(ends):
        if low.high < high.low:
            sample = _simple(low.high, high.low)
            counts = counter.at(sample, value, Count.INDEX)
            found.append(CountInterval(low, high, _numbers(slice, counts), sample, counts.cones))
        else:
            found.append(None)
    counted = [None if interval is None else interval.counts for interval in found]
    sides = zip(changes, pairwise(counted), strict=True)
    return (
        tuple(interval for interval in found if interval is not None),
        tuple(replace(change, before=before, after=after) for change, (before, after) in sides),
    )


def _numbers(slice: Slice, counts: PointCount) -> Counts | None:
    """Of all equilibria and of the stable ones; None where it is known what is stable, but not of
    each of them.
    """
    if counts.total is None:
        return None
    criterion = slice.model.criterion
    found = [criterion.is_stable(solution.signs) for solution in counts.solutions]
    stable = criterion.number(found)
    if counts.stable is not None or stable is None:
        return Counts(counts.total, counts.stable, counts.index)
    return None if None in found else Counts(counts.total, stable, counts.index)


def _changes(
    slice: Slice, curve: CriticalCurve, bits: int, undecided: Sequence[Change]
) -> Iterator[Change]:
    """Where the line meets a curve; parts of it that are too hard as a whole are halved while the
    budget lasts, but for what is ``undecided`` in them."""
    system = on_line(curve.system, 0)
    alone = system.arguments._replace(cheap=_NONE, rest=_NONE, costly=_NONE, nonnegative=_NONE)
    equations = replace(system, arguments=alone)
    axis, value = slice.axes[0], slice.axes[1].low
    step = (axis.high - axis.low) / START_PARTS
    waiting = [(axis.low + k * step, axis.low + (k + 1) * step) for k in range(START_PARTS)]
    smallest = (axis.high - axis.low) * MIN_PART
    fixed = enclosing_floats(value)
    total = 0
    while waiting:
        low, high = waiting.pop()
        ends = enclosing_floats(low)[0], enclosing_floats(high)[1]
        start = curve.start(np.array([[ends[0], fixed[0], ends[1], fixed[1]]]))
        limits = MIN_BOX_WIDTH, BUDGET, MAX_OPEN_BOXES
        found = isolate(system.arguments, equations.arguments, start, limits, curve.weights)
        total += found.used
        left, variables = found.left(), start.shape[1] // 2
        if (
            (found.used >= BUDGET or len(left) > MAX_OPEN_BOXES)
            and high - low > smallest
            and total < MAX_BOXES
        ):
            inside = [
                (max(low, change.at.low), min(high, change.at.high))
                for change in undecided
                if change.at.high > low and change.at.low < high
            ]
            yield from (_met(Enclosure(*ends), curve, False) for ends in inside)
            middle = (low + high) / 2
            edges = [low, *chain.from_iterable(inside or [(middle, middle)]), high]
            waiting += [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if a < b]
            continue
        for box in left:
            open_part = Enclosure(Fraction(float(box[0])), Fraction(float(box[variables])))
            yield _met(open_part, curve, False)
        # ``narrow`` was contracted with the equations alone; its number can be enclosed to any
        # precision
        for row in found.narrow:
            with ctx.workprec(bits):
                along, _, *others = balls(*np.split(row, 2))
                box = along, ball(value, value), *others
            exact = refined(equations, box, bits)[0]
            yield _met(Enclosure(lower(exact), upper(exact)), curve, True)


def _met(at: Enclosure, curve: CriticalCurve, proved: bool) -> Change:
    """Where a curve is met; the counts on the sides are not known yet."""
    return Change(at, None, None, names=(curve.name,), proved=proved)


_NONE = np.empty(0, np.int64)


def on_line(system: EquationSystem, varying: int) -> EquationSystem:
    """The square system that is left when the other axis has a value."""
    own = system.arguments
    kept = np.flatnonzero(own.unknowns != 1 - varying)
    # the value is fixed: what the equations say of it must not narrow the floats around it
    solved = own.solved[own.solved[:, 0] == varying]
    jacobian = np.ascontiguousarray(own.jacobian[:, kept])
    own = own._replace(unknowns=own.unknowns[kept], jacobian=jacobian, solved=solved)
    return replace(system, arguments=own)


def _joined(changes: Sequence[Change]) -> tuple[Change, ...]:
    """Changes whose enclosures touch become one."""
    joined: list[Change] = []
    for change in sorted(changes, key=lambda c: (c.at.low, c.at.high)):
        if not joined or change.at.low > joined[-1].at.high:
            joined.append(change)
            continue
        last = joined.pop()
        names = tuple(dict.fromkeys((*last.names, *change.names)))
        at = Enclosure(last.at.low, max(last.at.high, change.at.high))
        joined.append(replace(last, at=at, names=names, proved=last.proved and change.proved))
    return tuple(joined)


def _simple(low: Fraction, high: Fraction) -> Fraction:
    """A rational number of few digits in the middle third."""
    width = (high - low) / 3
    places = 0
    while Fraction(1, 10**places) > width:
        places += 1
    return Fraction(round((low + high) / 2 * 10**places), 10**places)
