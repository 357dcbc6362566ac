"""The values along a line of a slice at which counts change, enclosed, and the counts between them, proved.

Guarantee: on each interval of the result the numbers of minima, saddles, maxima and cones are constant. What was not
decided lies in one of the gaps between them; a gap that is `proved` holds nothing but isolated critical values.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain, pairwise

import numpy as np
from flint import ctx

from ptmcad.certified.arb_evaluation import ball, lower, upper
from ptmcad.certified.arb_isolation import Box, refined
from ptmcad.certified.curve import Curve
from ptmcad.certified.plain.curves import curves
from ptmcad.certified.plain.points import plain_counter
from ptmcad.certified.points import PointCount
from ptmcad.certified.search import Boxes, isolate
from ptmcad.certified.system import System
from ptmcad.certified.tape import enclosing_floats
from ptmcad.question.counts import Count
from ptmcad.question.slice import Slice

MIN_BOX_WIDTH = 1e-8
BUDGET, MAX_OPEN_BOXES = 20_000, 400
"""Boxes to treat, and boxes to leave open, before a part of the line is halved."""
MAX_BOXES = 600_000
"""Boxes for one curve after which nothing is halved any more."""
START_PARTS = 16
MIN_PART = Fraction(1, 2**16)
"""Parts of the line of this share are not halved."""


@dataclass(frozen=True, slots=True)
class Gap:
    """Values among which counts may change: [low, high], and the names of the curves of which it holds points.

    ``proved``: each of these points was proved to be the only one near it. Otherwise the gap may hold none.
    """

    low: Fraction
    high: Fraction
    names: tuple[str, ...]
    proved: bool


@dataclass(frozen=True, slots=True)
class Stretch:
    """An open interval on which ``counts``, found at ``sample``, hold; undecided counts are not known."""

    low: Fraction
    high: Fraction
    sample: Fraction
    counts: PointCount


@dataclass(frozen=True, slots=True)
class LineCounts:
    """Stretches and the gaps between them, both in increasing order."""

    stretches: tuple[Stretch, ...]
    gaps: tuple[Gap, ...]


def line_counts(slice: Slice, varying: int, value: Fraction, bits: int) -> LineCounts:
    """The counts on the line on which axis ``varying`` runs over its window and the other one has a value.

    Parameters
    ----------
    bits : precision to which critical values are enclosed.
    """
    axis = slice.axes[varying]
    wanted = curves(slice, Count.INDEX)
    found: list[list[Gap]] = [[] for _ in wanted]
    # what is quick to search comes first: what it leaves undecided need not be looked at closely again
    for k in sorted(range(len(wanted)), key=lambda k: len(wanted[k].system.tape)):
        undecided = _joined([gap for gaps in found for gap in gaps if not gap.proved])
        found[k] = list(_gaps(slice, wanted[k], varying, value, bits, undecided))
    gaps = _joined([g for some in found for g in some if g.high > axis.low and g.low < axis.high])
    counter = plain_counter(slice)
    stretches = []
    for low, high in pairwise([axis.low, *(end for gap in gaps for end in (gap.low, gap.high)), axis.high]):
        if not any((gap.low, gap.high) == (low, high) for gap in gaps) and low < high:
            sample = _simple(low, high)
            x, y = (sample, value) if varying == 0 else (value, sample)
            stretches.append(Stretch(low, high, sample, counter.at(x, y, Count.INDEX)))
    return LineCounts(tuple(stretches), tuple(gaps))


def _gaps(
    slice: Slice, curve: Curve, varying: int, value: Fraction, bits: int, undecided: Sequence[Gap]
) -> Iterator[Gap]:
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
            yield from (Gap(*ends, (curve.name,), False) for ends in inside)
            middle = (low + high) / 2
            edges = [low, *chain.from_iterable(inside or [(middle, middle)]), high]
            waiting += [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if a < b]
            continue
        for box in left:
            yield Gap(Fraction(float(box[varying])), Fraction(float(box[variables + varying])), (curve.name,), False)
        # ``narrow`` was contracted with the equations alone; its number can be enclosed to any precision
        for row in found.narrow:
            with ctx.workprec(bits):
                box = _balls(row, varying, value)
            exact = refined(equations, box, bits)[varying]
            yield Gap(lower(exact), upper(exact), (curve.name,), True)


_NONE = np.empty(0, np.int64)


def _balls(row: Boxes, varying: int, value: Fraction) -> Box:
    variables = len(row) // 2
    box = [ball(Fraction(float(row[k])), Fraction(float(row[variables + k]))) for k in range(variables)]
    box[1 - varying] = ball(value, value)
    return tuple(box)


def on_line(system: System, varying: int) -> System:
    """The square system that is left when the other axis has a value."""
    kept = np.array([k for k, unknown in enumerate(system.unknowns) if unknown != 1 - varying], np.int64)
    # the value is fixed: what the equations say of it must not narrow the floats around it
    solved = system.solved[system.solved[:, 0] == varying]
    jacobian = np.ascontiguousarray(system.jacobian[:, kept])
    return replace(system, unknowns=system.unknowns[kept], jacobian=jacobian, solved=solved)


def _joined(gaps: list[Gap]) -> list[Gap]:
    """Gaps that touch become one."""
    joined: list[Gap] = []
    for gap in sorted(gaps, key=lambda g: (g.low, g.high)):
        if not joined or gap.low > joined[-1].high:
            joined.append(gap)
            continue
        last = joined.pop()
        names = tuple(dict.fromkeys((*last.names, *gap.names)))
        joined.append(Gap(last.low, max(last.high, gap.high), names, last.proved and gap.proved))
    return joined


def _simple(low: Fraction, high: Fraction) -> Fraction:
    """A rational number of few digits in the middle third."""
    width = (high - low) / 3
    places = 0
    while Fraction(1, 10**places) > width:
        places += 1
    return Fraction(round((low + high) / 2 * 10**places), 10**places)
