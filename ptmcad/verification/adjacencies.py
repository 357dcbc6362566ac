"""Checks of adjacency: the pairs of cells that share an open arc, those that do not, and that none
is missing.

Guarantee: every stored segment joins its cells and meets no curve; every free interval between the
curves over a critical value belongs to a stored pair; every record of cells that are not adjacent
holds, and there is one wherever order alone would allow another pair.

Why no pair is missing. Let the line over a critical value cross the open window, and take away the
points of the curves on it, which are finitely many (no curve contains the line). The open intervals
that are left are its *free intervals*: at least one, whatever the curves do. Each of them lies in
the closure of exactly one cell on either side, so two cells are adjacent across the line exactly
when they have a free interval in common. A stored segment crosses the line in a free interval and
shows its pair. The segments cut the line into parts: between two of them, or between one and the
window's edge. Into a part run as many half-branches as the levels of its ends differ by, on both
sides together; an isolated point of the curves changes no pair. A part contains no pair but those
of the segments at its ends, if

* no half-branch runs into it, and there is a segment at one of its ends at least: all its free
  intervals have that segment's pair. (Between the two edges of the window, with no segment, the
  pair of all of them would be stored nowhere);
* two half-branches run into a part between two segments: through each point inside the window runs
  an even number of half-branches, so both end in one point, and the free intervals on either side
  of it have the segments' pairs;
* a single half-branch runs into a part between a segment and the window's edge: being alone, it
  ends on the edge, so that all free intervals have the segment's pair.

Any other part is settled by a free segment built in each of its free intervals, whose pair has to
be stored.
"""

from __future__ import annotations

from itertools import pairwise

from flint import fmpq

from ptmcad.answer.regionmap import Adjacency, Cell, NonAdjacency, Reason, Segment
from ptmcad.text.flint_numbers import from_fraction
from ptmcad.verification.claims import Claims, bracket, is_root, short
from ptmcad.verification.projections import Heights, inside_stack
from ptmcad.verification.report import Violation


def check_adjacencies(claims: Claims) -> str:
    """Every stored adjacency: its component, and the segment that proves it."""
    result = claims.result
    vertical, across = set(), []
    pairs = set()
    for number, a in enumerate(result.adjacencies):
        if (pair := frozenset((a.first, a.second))) in pairs:
            raise Violation(f"adjacency {number} is stored twice: cells {a.first} and {a.second}")
        pairs.add(pair)
        first, second = result.cells[a.first], result.cells[a.second]
        stack_number = _stack(first)
        if a.segment is None:
            if (second.stack, second.level) != (stack_number, first.level + 1):
                raise Violation(
                    f"adjacency {number} has no segment, but cells {a.first} and {a.second} are not "
                    "neighbours in one stack"
                )
            wall = result.stacks[stack_number].walls[first.level]
            if wall.component != a.component:
                raise Violation(
                    f"adjacency {number}: the wall between the cells is on component {wall.component}, "
                    f"not {a.component}"
                )
            vertical.add((a.first, a.second))
        else:
            _check_segment(claims, number, a)
            across.append(a)
    for stack in result.stacks:
        for one, two in pairwise(stack.cells):
            if (one, two) not in vertical:
                raise Violation(
                    f"the adjacency of cells {one} and {two}, neighbours in a stack, is missing"
                )
    return f"{len(vertical)} inside stacks, {len(across)} segments"


def _stack(cell: Cell) -> int:
    assert (
        cell.stack is not None
    )  # `ptmcad.verification.merging.check_shape` has compared it with the stacks
    return cell.stack


def _check_segment(claims: Claims, number: int, a: Adjacency) -> None:
    result = claims.result
    assert a.segment is not None
    first, second = result.cells[a.first], result.cells[a.second]
    if _stack(second) != _stack(first) + 1:
        raise Violation(
            f"adjacency {number}: cells {a.first} and {a.second} are not in neighbouring stacks"
        )
    _check_free(claims, f"adjacency {number}", a.segment, a.first, a.second)
    value = result.critical_values[_stack(first)]
    line = next((c.number for c in claims.lines if is_root(c.in_v[0], value)), None)
    if line != a.component:
        raise Violation(
            f"adjacency {number}: the segment crosses component {line}, not {a.component} (None: no component)"
        )


def _check_free(claims: Claims, what: str, segment: Segment, first: int, second: int) -> None:
    """A segment joins two cells of neighbouring stacks and meets no curve."""
    cells = claims.result.cells
    low, high, v = (from_fraction(q) for q in segment)
    ends = ((first, low), (second, high))
    if not all(inside_stack(claims, u, _stack(cells[n])) for n, u in ends):
        raise Violation(
            f"{what}: the segment from {short(low)} to {short(high)} does not join the cells' stacks"
        )
    if not claims.height[0] < v < claims.height[1]:
        raise Violation(f"{what}: the segment's height {short(v)} is outside the window")
    hit = claims.met_by(low, high, v)
    if hit is not None:
        raise Violation(
            f"{what}: component {hit.number} meets the segment [{low}, {high}] at height {v}"
        )
    for n, u in ends:
        if (level := claims.level(u, v)) != cells[n].level:
            raise Violation(
                f"{what}: the segment's end ({u}, {v}) has {level} roots below it, so it is not in cell {n}"
            )


_SETTLED = ((0, 2), (0, 1), ())
"""Numbers of half-branches with which a part has no further pair: between two segments, a segment
and an edge, two edges. See the module's text."""


def check_no_adjacency_missing(claims: Claims) -> str:
    """Every open segment of the line over a critical value joins a stored pair."""
    by_parity = by_points = 0
    for s in range(len(claims.result.stacks) - 1):
        marks = _marks(claims, s)
        pairs = {(left, right) for _, left, right, is_edge in marks if not is_edge}
        for (bottom, l0, r0, edge0), (top, l1, r1, edge1) in pairwise(marks):
            # half-branches that settle the part, by the number of its ends that are the window's
            # edges
            if (l1 - l0) + (r1 - r0) in _SETTLED[edge0 + edge1]:
                by_parity += 1
                continue
            _search(claims, s, bottom, top, pairs)
            by_points += 1
    return f"{by_parity} gaps by parity of half-branches, {by_points} by all points of the curves over the critical value"


def _marks(claims: Claims, s: int) -> list[tuple[fmpq, int, int, bool]]:
    """The stored segments over a critical value from below, between the window's edges: heights,
    levels on both sides, and whether it is an edge.
    """
    result = claims.result
    left, right = (len(stack.walls) for stack in result.stacks[s : s + 2])
    marks = [(claims.height[0], 0, 0, True), (claims.height[1], left, right, True)]
    for a in result.adjacencies:
        first, second = result.cells[a.first], result.cells[a.second]
        if a.segment is not None and first.stack == s:
            marks.append((from_fraction(a.segment[2]), first.level, second.level, False))
    return sorted(marks, key=lambda mark: fmpq(mark[0]))


def check_non_adjacencies(claims: Claims) -> str:
    """Every pair of cells that order would allow to be adjacent, and that is not, has a record that
    proves it.
    """
    result = claims.result
    expected = set()
    for s in range(len(result.stacks) - 1):
        left, right = result.stacks[s].cells, result.stacks[s + 1].cells
        for (_, l0, r0, _), (_, l1, r1, _) in pairwise(_marks(claims, s)):
            if (l0, r0) != (l1, r1):
                expected.add((s, left[l0 : l1 + 1], right[r0 : r1 + 1]))
    stored = [(a.critical_value, a.left, a.right) for a in result.non_adjacencies]
    if len(set(stored)) != len(stored):
        raise Violation("a record of cells that are not adjacent is stored twice")
    if set(stored) != expected:
        s, left, right = min(set(stored) ^ expected)
        how = "not stored" if (s, left, right) in expected else "stored, but does not follow"
        raise Violation(
            f"critical value {s}: that cells {left} and {right} are adjacent at most at their ends is {how}"
        )
    for number, a in enumerate(result.non_adjacencies):
        _check_non_adjacency(claims, number, a)
    return f"{len(stored)} records"


def _check_non_adjacency(claims: Claims, number: int, a: NonAdjacency) -> None:
    result = claims.result
    what = f"non-adjacency {number}"
    stacks = result.stacks[a.critical_value : a.critical_value + 2]
    heights, edges = [], 0
    for segment, k, edge in zip((a.below, a.above), (0, -1), claims.height, strict=True):
        n, m = a.left[k], a.right[k]
        if segment is not None:
            _check_free(claims, what, segment, n, m)
        elif [n, m] != [stack.cells[k] for stack in stacks]:
            raise Violation(
                f"{what}: a segment is missing, and the cells do not reach the window's edge"
            )
        edges += segment is None
        heights.append(edge if segment is None else from_fraction(segment[2]))
    branches = len(a.left) + len(a.right) - 2
    if a.reason is Reason.PAIR:
        holds = branches == 2 and not edges
    elif a.reason is Reason.EDGE:
        holds = branches == 1 and edges == 1
    else:
        points = Heights(claims.curves, result.critical_values[a.critical_value])
        # at the window's edge the branches may only run into its corner over the critical value
        holds = edges < 2 and points.between(*heights) <= 1 - edges
    if not holds:
        raise Violation(
            f"{what}: {branches} half-branches between cells {a.left} and {a.right} are not closed because "
            f"of {a.reason.value!r}"
        )


def _search(claims: Claims, s: int, bottom: fmpq, top: fmpq, pairs: set[tuple[int, int]]) -> None:
    """Try a free segment in each interval between the points of the curves over a critical value."""
    value = claims.result.critical_values[s]
    left, right = claims.result.stacks[s], claims.result.stacks[s + 1]
    for v in Heights(claims.curves, value).separated(bottom, top):
        low, high = from_fraction(left.sample), from_fraction(right.sample)
        width = high - low
        while claims.met_by(low, high, v) is not None:
            width /= 2
            below, above = bracket(value, width)
            low, high = max(low, below - width), min(high, above + width)
        pair = (claims.level(low, v), claims.level(high, v))
        if pair not in pairs:
            first, second = left.cells[pair[0]], right.cells[pair[1]]
            raise Violation(
                f"the adjacency of cells {first} and {second} is missing; the segment from {low} to {high} "
                f"at height {v} joins them"
            )
