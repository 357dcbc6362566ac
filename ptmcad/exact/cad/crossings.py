"""Adjacency of cells of neighbouring stacks, with the open segment that proves each pair.

Guarantee: the pairs found are adjacent, and no pair is missing. Two cells on both sides of a
critical abscissa a are adjacent exactly when an open segment of the line u = a, free of the curves,
belongs to the closure of both.

A *separator* is a rational height e such that no curve meets the horizontal segment [l, r] x {e},
where l < a < r lie in the two stacks. It proves that the cells at (l, e) and (r, e) are adjacent;
what it separates are the points of the curves on the line u = a.
Between consecutive separators lies a *gap* that some branches enter from the left and some from the
right. All pairs are found once every gap contains at most one point of the line u = a that branches
run into, because then separators stand on both sides of each such point.

* A gap with at most two branches does: through every point of a real algebraic curve (no vertical
  line among them) runs an even number of half-branches, so two branches in a gap end at the same
  point. Only the point on the window's edge, if a curve passes there, may take an odd number: so a
  gap at the edge with one branch does.
* A gap with more branches is split, if it can be, by bracketing a more closely; if that fails, the
  points of the curves over a are enclosed (`criticalpoints`): heights between them are separators once the
  bracket is narrow enough.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from flint import fmpq

from ptmcad.algebra.real_roots import Interval, RealRoot, has_root_between, refine, vanishes_at
from ptmcad.algebra.resultants import Check, nothing
from ptmcad.answer.regionmap import Reason
from ptmcad.exact.cad.criticalpoints import PointsOver
from ptmcad.exact.cad.projection import FibredCurve, max_height_bits
from ptmcad.exact.cad.stacks import StackData, roots_over
from ptmcad.text.flint_numbers import simplest_between

ROUNDS = 4
"""Bracketings that are tried before the exact separation; each has twice as many bits as the one
before.
"""
_LONG_COEFFICIENT_BITS = 64
"""Long coefficients may bring branches very near to each other: one bracketing more is tried for
each doubling of their bits beyond ``_LONG_COEFFICIENT_BITS`` 2^ROUNDS, as the cost of the exact
separation grows with them far faster."""


class Separator(NamedTuple):
    """Cells ``left`` and ``right`` (levels in their stacks) joined by the open segment [low, high]
    x {height}.
    """

    left: int
    right: int
    low: fmpq
    high: fmpq
    height: fmpq


class StackGap(NamedTuple):
    """Heights between two separators, or a separator and the window's edge, or both edges.

    Attributes
    ----------
    below, above : the separators; None at the window's edge.
    left, right : the lowest and the highest level, in either stack, of the cells that reach into
        the gap.
    reason : why branches run into at most one point of the gap; None when that is not known.
    """

    bottom: fmpq
    top: fmpq
    below: Separator | None
    above: Separator | None
    left: tuple[int, int]
    right: tuple[int, int]
    reason: Reason | None = None

    @property
    def branches(self) -> int:
        """The number of half-branches that enter."""
        return self.left[1] - self.left[0] + self.right[1] - self.right[0]

    @property
    def edges(self) -> list[fmpq]:
        """The window's edges among the ends."""
        return [
            height
            for height, end in ((self.bottom, self.below), (self.top, self.above))
            if end is None
        ]


class Crossing(NamedTuple):
    """What happens between two neighbouring stacks: one separator for each adjacent pair, and the
    gaps between them.
    """

    separators: tuple[Separator, ...]
    gaps: tuple[StackGap, ...]


def cross(
    curves: Sequence[FibredCurve],
    left: StackData,
    right: StackData,
    fibre: Interval,
    check: Check = nothing,
) -> Crossing:
    """All adjacent pairs of cells across the abscissa between two neighbouring stacks, with proof."""
    end = left.right.root
    reach, extent = min(end.middle - left.sample, right.sample - end.middle), fibre[1] - fibre[0]
    # the largest bracket, the branches' largest intervals, and the bits by which both shrink
    width, resolution, step = reach, extent, 8
    extra: tuple[fmpq, ...] = ()
    points: PointsOver | None = None  # costly, looked for if the rounds do not suffice
    attempt = 0
    rounds = max(ROUNDS, (max_height_bits(curves) // _LONG_COEFFICIENT_BITS).bit_length())
    while True:
        check()
        width, resolution = width / 2**step, resolution / 2 ** (step - 2)
        bracket = _bracket(end, width, left.sample, right.sample)
        sides = [
            [refine(root, resolution) for _, root in roots_over(curves, u, fibre)] for u in bracket
        ]
        found = _separators(curves, bracket, sides, fibre, extra)
        gaps = [
            gap._replace(reason=_reason(gap, curves, end, points))
            for gap in _open_gaps(found, len(sides[0]), len(sides[1]), fibre)
        ]
        # without any separator nothing is proved, even if no branch runs up to the line
        unresolved = [gap for gap in gaps if not found or gap.reason is None]
        if not unresolved:
            unique = {(p.left, p.right): p for p in reversed(found)}
            return Crossing(
                tuple(sorted(unique.values(), key=lambda p: (p.left, p.right))),
                tuple(gap for gap in gaps if gap.branches),
            )
        attempt += 1
        step = 2 * step
        if attempt >= rounds:
            if points is None:
                points = PointsOver(tuple(curves), end, check)
                # with the heights now known, wide brackets may do
                width, resolution, step = reach, extent, 8
            separating = (
                h for gap in unresolved for h in _between_points(points, gap, curves, end)
            )
            extra = tuple(sorted({*extra, *separating}))


def _bracket(end: RealRoot, width: fmpq, low: fmpq, high: fmpq) -> Interval:
    """Rational points on both sides of the critical abscissa, inside the neighbouring stacks."""
    root = refine(end, width)
    if root.is_rational:
        return max(root.low - width, low), min(root.low + width, high)
    return root.low, root.high


def _separators(
    curves: Sequence[FibredCurve], bracket: Interval, sides: Sequence[Sequence[RealRoot]], fibre: Interval,
    extra: Sequence[fmpq],
) -> list[Separator]:  # fmt: skip
    """The separators among the gaps between the branches and among the extra heights, from below.

    Parameters
    ----------
    bracket : abscissae on both sides of the critical one.
    sides : the branches over each, isolated, from below.
    """
    low, high = bracket
    occupied = sorted((r.low, r.high) for over in sides for r in over)
    heights = list(extra)
    top = fibre[0]
    for start, stop in [*occupied, (fibre[1], fibre[1])]:
        if start > top:
            quarter = (start - top) / 4
            heights.append(simplest_between(top + quarter, start - quarter))
        top = max(top, stop)
    result = []
    for height in sorted(set(heights)):
        if any(below <= height <= above for below, above in occupied):
            continue
        if any(has_root_between(c.trace(height), low, high) for c in curves):
            continue
        left, right = (sum(r.high < height for r in over) for over in sides)
        result.append(Separator(left, right, low, high, height))
    return result


def _open_gaps(
    found: Sequence[Separator], count_left: int, count_right: int, fibre: Interval
) -> list[StackGap]:
    """The gaps between consecutive separators, from below, the window's edges included."""
    ends: list[tuple[fmpq, int, int, Separator | None]] = [(fibre[0], 0, 0, None)]
    ends += [(p.height, p.left, p.right, p) for p in found]
    ends.append((fibre[1], count_left, count_right, None))
    return [StackGap(a[0], b[0], a[3], b[3], (a[1], b[1]), (a[2], b[2])) for a, b in pairwise(ends)]


def _reason(
    gap: StackGap, curves: Sequence[FibredCurve], end: RealRoot, points: PointsOver | None
) -> Reason | None:
    """Why branches run into at most one point of the gap; None when that is not known.

    ``points`` is None while the points on the line are not looked for. A gap without branches may
    be closed in any way. An odd number of branches between two separators cannot be: the case is
    treated as unknown all the same.
    """
    branches, edges = gap.branches, gap.edges
    if branches == 0:
        return Reason.POINT
    if (
        len(edges) == 2
        or (not edges and branches % 2 == 1)
        or (edges and not _meets(curves, end, edges[0]))
    ):
        return None
    if branches <= 2 - len(edges):
        return Reason.EDGE if edges else Reason.PAIR
    if points is None or len(points.between(gap.bottom, gap.top, edges)) > 1 - len(edges):
        return None
    return Reason.POINT


def _meets(curves: Sequence[FibredCurve], end: RealRoot, edge: fmpq) -> bool:
    """Whether a curve passes through the point of the window's edge over the critical abscissa."""
    return any(vanishes_at(c.trace(edge), end) for c in curves)


def _between_points(
    points: PointsOver, gap: StackGap, curves: Sequence[FibredCurve], end: RealRoot
) -> list[fmpq]:
    """Heights between all possible points in the gap."""
    met = [edge for edge in gap.edges if _meets(curves, end, edge)]
    inner = points.between(gap.bottom, gap.top, met)
    levels = [gap.bottom, *(x for interval in inner for x in interval), gap.top]
    return [simplest_between(levels[2 * k], levels[2 * k + 1]) for k in range(len(inner) + 1)]
