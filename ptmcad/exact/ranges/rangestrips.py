"""Strips: where, over an open interval of the other axis, one operation range lies between two
branches.

Guarantee: over the strip's whole base interval the two ends are the branches (or the window's
edges) that are named, and the number of stable solutions between them is that of an operation range
but for points of the variety where no count changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, groupby
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.polynomials import RationalUnivariate
from ptmcad.algebra.real_roots import Interval, RealRoot, has_root_between, isolate, refine
from ptmcad.answer.counts import operation_number
from ptmcad.exact.cad.crossings import Crossing, cross
from ptmcad.exact.cad.projection import FibredCurve, by_component
from ptmcad.exact.cad.stacks import BaseEnd, StackData
from ptmcad.exact.ranges.exactline import runs
from ptmcad.exact.stages import counts_of, decomposition_of, problem_of
from ptmcad.question.slice import Slice, without_free_lengths
from ptmcad.text.flint_numbers import simplest_between

RANGE_END_WIDTH = fmpq(1, 2**120)
"""To which irrational ends and values of branches are known, where nothing else is asked for."""


@dataclass(frozen=True, slots=True)
class RangeEnd:
    """The ``root``-th real root of a curve over a strip, or an edge of the window when ``curve`` is
    None.
    """

    curve: FibredCurve | None
    root: int
    edge: fmpq


@dataclass(frozen=True, slots=True)
class RangeStrip:
    """An operation range over an open interval of the base axis.

    Attributes
    ----------
    left, right : ends of the base interval.
    sample : a rational abscissa in it.
    low, high : the branches that bound the range; fibre is the window of the axis along which it
        lies.
    """

    left: BaseEnd
    right: BaseEnd
    sample: fmpq
    low: RangeEnd
    high: RangeEnd
    fibre: Interval

    @property
    def branches(self) -> tuple[RangeEnd, RangeEnd]:
        return self.low, self.high


class RangeStrips(NamedTuple):
    """The strips of a slice over one of its axes.

    Attributes
    ----------
    found : from the left.
    working : the number of stable solutions in them.
    special : the values of the axis at which a range may be another one than the limit of a strip:
        those at which the whole line is in the variety, those at which two ranges meet at a point,
        and the window's edges.
    """

    found: tuple[RangeStrip, ...]
    working: int
    special: tuple[BaseEnd, ...]


def strips(slice: Slice, along: str, working: int | None = None) -> RangeStrips:
    """The strips of a slice over the axis that is not ``along``.

    Parameters
    ----------
    working : the number of stable solutions in a range; by `operation_number` when None.

    Raises
    ------
    ConfigError
        When springs have a free length.
    HypothesisError
        When the slice is degenerate or leaves the domain of the geometry.
    """
    base = 1 - slice.axis_names.index(along)
    without_free_lengths(
        slice.model,
        slice.parameters,
        "the widest operation range is",
        "ptmcad range --over tabulates widths",
    )
    problem = problem_of(slice)
    cut = decomposition_of(problem, base)
    counts = [found.counts for found in counts_of(problem, cut).found]
    if working is None:
        working = operation_number(slice.model, counts)
    inside = cut.rows(found.working == working for found in counts)
    curves, fibre = by_component(cut.variety.curves), cut.fibre
    found = [
        _over(stack, here, curves, fibre) for stack, here in zip(cut.stacks, inside, strict=True)
    ]
    special = [cut.stacks[0].left]
    for k, line in enumerate(cut.lines_across):
        left, right = cut.stacks[k : k + 2]
        if line is not None or (
            min(len(found[k]), len(found[k + 1])) > 1
            and _ranges_meet(
                cross(cut.variety.curves, left, right, fibre), inside[k], inside[k + 1]
            )
        ):
            special.append(left.right)
    special.append(cut.stacks[-1].right)
    return RangeStrips(tuple(chain.from_iterable(found)), working, tuple(special))


def _ranges_meet(crossing: Crossing, left: Sequence[bool], right: Sequence[bool]) -> bool:
    """Whether over a critical abscissa two ranges of either side are parted by points of the curves
    alone.
    """
    for here, group in groupby(crossing.separators, lambda s: left[s.left] and right[s.right]):
        joined = list(group)
        if here and not (
            all(left[joined[0].left : joined[-1].left + 1])
            or all(right[joined[0].right : joined[-1].right + 1])
        ):
            return True
    return False


def _over(
    stack: StackData, inside: Sequence[bool], curves: dict[int, FibredCurve], fibre: Interval
) -> list[RangeStrip]:
    """The strips of a stack, given which of its cells are in the operation range."""
    walls = [RangeEnd(curves[wall.component], wall.root, fibre[0]) for wall in stack.walls]
    ends = [RangeEnd(None, 0, fibre[0]), *walls, RangeEnd(None, 0, fibre[1])]
    return [
        RangeStrip(stack.left, stack.right, stack.sample, ends[first], ends[end], fibre)
        for first, end in runs(inside)
    ]


def at_abscissa(branch: RangeEnd, u: fmpq, fibre: Interval, width: fmpq) -> RealRoot:
    """The branch's value at a rational abscissa of the strip, isolated within ``width``."""
    if branch.curve is None:
        return RealRoot.of(branch.edge)
    p = branch.curve.polynomial_over(u)
    return refine(isolate(p, *fibre)[branch.root], width)


def bound_over(
    branch: RangeEnd, start: fmpq, side: int, over: Interval, fibre: Interval
) -> fmpq | None:
    """A level above (side 1) or below (side -1) the branch on a closed interval of abscissae.

    Guarantee: the curve has no point on the horizontal segment at this level over the interval; so
    the branch, which is at the start's other side somewhere in it, stays there.

    Parameters
    ----------
    start : a bound for the branch at one abscissa of the interval, from that side.

    Returns
    -------
    None when no level inside ``fibre`` was found to be free.
    """
    if branch.curve is None:
        return branch.edge
    step = (over[1] - over[0]) / 8
    while True:
        level = start + side * step
        if not fibre[0] < level < fibre[1]:
            return None
        if not has_root_between(branch.curve.trace(level), *over):
            return level
        step = 2 * step


def base_interval(strip: RangeStrip) -> tuple[Interval, Interval]:
    """Intervals that hold the two ends of the strip's base, as `end_interval` says."""
    return end_interval(strip.left), end_interval(strip.right)


def end_interval(end: BaseEnd, width: fmpq = RANGE_END_WIDTH) -> Interval:
    """An interval that holds an end of a base interval: of length zero at a rational one, else
    within ``width``.
    """
    if end.root.polynomial.degree() == 1:
        value = fmpq(-end.root.polynomial[0], end.root.polynomial[1])
        return value, value
    root = refine(end.root, width)
    return root.low, root.high


def constant_width(strip: RangeStrip) -> bool:
    """Whether the range is of one width over the whole strip: its ends are level, or one curve and
    its translate.
    """
    curves = [
        b.curve for b in (strip.low, strip.high) if b.curve is not None and len(b.curve.in_u) > 1
    ]
    if len(curves) != 2:
        return not curves
    low, high = (
        at_abscissa(b, strip.sample, strip.fibre, _NARROW) for b in (strip.low, strip.high)
    )
    shift = RationalUnivariate(
        [simplest_between(high.low - low.high - _NARROW, high.high - low.low + _NARROW), 1]
    )
    isolated = at_abscissa(strip.high, strip.sample, strip.fibre, strip.fibre[1] - strip.fibre[0])
    if not isolated.low <= low.low + shift[0] <= low.high + shift[0] <= isolated.high:
        return False  # the translate of the lower branch is another branch of the upper one's curve
    lower, upper = (list(map(RationalUnivariate, curve.in_u)) for curve in curves)
    scale = lower[-1].coeffs()[-1] / upper[-1].coeffs()[-1]
    return len(lower) == len(upper) and all(
        p == q(shift) * scale for p, q in zip(lower, upper, strict=True)
    )


_NARROW = fmpq(1, 2**100)
