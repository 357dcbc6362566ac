"""Checks of the decomposition: critical values, stacks, walls, samples and adjacencies.

Guarantee: over each stack the curves' roots between the window's edges are constant in number and order (discriminants,
resultants and edge values have no root there but the stored ones); over its sample they are the stored walls; the
adjacent pairs are those stored, and no pair is missing.

Discriminants and resultants are FLINT's own in Z[u, v], roots are counted by Sturm sequences; the decomposition
computes them by evaluation and interpolation, and isolates by Descartes' rule.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import gcd

from flint import fmpq, fmpz_poly

from ptmcad.regionmap import Adjacency, CriticalValue
from ptmcad.verification.claims import Claims, PlaneCurve, polynomial, side, univariate
from ptmcad.verification.fibre import rational
from ptmcad.verification.report import Violation
from ptmcad.verification.sturm import isolating_intervals, points_apart, roots_between, roots_within


def projection_of_one(curve: PlaneCurve, height: tuple[fmpq, fmpq]) -> list[fmpz_poly]:
    """Irreducible polynomials outside whose roots the curve's roots in the open interval are constant in number."""
    k, m = curve.exponent_gcd(0), curve.exponent_gcd(1)
    found = [curve.along(edge) for edge in height]
    if curve.degrees[1] > m:
        found.append(univariate(curve.flint(k, m).discriminant("v"), 0).inflate(k))
    if m > 1 and height[0] < 0 < height[1]:
        found.append(curve.in_v[0])
    return [f for p in found for f in _factors(p)]


def _factors(p: fmpz_poly) -> list[fmpz_poly]:
    return [f for f, _ in p.factor()[1]] if p.degree() > 0 else []


def _projection(claims: Claims) -> dict[tuple[int, ...], fmpz_poly]:
    found: list[fmpz_poly] = []
    for line in claims.lines:
        found += _factors(line.in_v[0])
    for i, c in enumerate(claims.curves):
        found += projection_of_one(c, claims.height)
        for d in claims.curves[i + 1 :]:
            k = gcd(c.exponent_gcd(0), d.exponent_gcd(0))
            m = gcd(c.exponent_gcd(1), d.exponent_gcd(1))
            resultant = univariate(c.flint(k, m).resultant(d.flint(k, m), "v"), 0)
            found += _factors(resultant.inflate(k))
    return {tuple(int(c) for c in f.coeffs()): f for f in found}


def check_critical_values(claims: Claims) -> str:
    """Isolation, order, and completeness of the critical values."""
    values = claims.result.critical_values
    previous = claims.base[0]
    for n, value in enumerate(values):
        low, high = rational(value.low), rational(value.high)
        p = polynomial(value)
        if p.degree() < 1 or not previous < low <= high < claims.base[1]:
            raise Violation(f"critical value {n} in [{value.low}, {value.high}] is not above the one before it and in "
                            "the window")  # fmt: skip
        if (roots := roots_within(p, low, high)) != 1:
            raise Violation(f"critical value {n}: its polynomial has {roots} roots in [{value.low}, {value.high}]")
        previous = high
    explained = [False] * len(values)
    factors = _projection(claims)
    for f in factors.values():
        matching = [n for n, value in enumerate(values) if _is_root(f, value)]
        for n in matching:
            explained[n] = True
        if (roots := roots_between(f, *claims.base)) != len(matching):
            where = [f"({float(a):.9g}, {float(b):.9g})" for a, b in map(_floats, _unmatched(f, claims, matching))]
            raise Violation(f"a polynomial of the projection of degree {f.degree()} has {roots} roots in the window, "
                            f"but {len(matching)} of them are stored; not stored: {', '.join(where)}")  # fmt: skip
    if False in explained:
        raise Violation(
            f"critical value {explained.index(False)} is a root of no discriminant, resultant or edge value"
        )
    return f"{len(values)} values, {len(factors)} irreducible discriminants, resultants and edge values"


def _floats(interval: tuple[fmpq, fmpq]) -> tuple[float, float]:
    return tuple(int(q.p) / int(q.q) for q in interval)  # type: ignore[return-value]


def _unmatched(f: fmpz_poly, claims: Claims, matching: Sequence[int]) -> list[tuple[fmpq, fmpq]]:
    stored = [claims.result.critical_values[n] for n in matching]
    return [
        (a, b)
        for a, b in isolating_intervals(f, *claims.base)
        if not any(side(a, value) < 0 < side(b, value) for value in stored)
    ]


def _is_root(f: fmpz_poly, value: CriticalValue) -> bool:
    common = f.gcd(polynomial(value))
    return common.degree() > 0 and roots_within(common, rational(value.low), rational(value.high)) > 0


def inside_stack(claims: Claims, u: fmpq, stack: int) -> bool:
    """Whether u lies in the stack's open interval."""
    values = claims.result.critical_values
    above = u > claims.base[0] if stack == 0 else side(u, values[stack - 1]) > 0
    below = u < claims.base[1] if stack == len(values) else side(u, values[stack]) < 0
    return above and below


def check_stacks(claims: Claims) -> str:
    """Stacks tile the base; over each sample the stored walls are all roots, in order, and part the cells' samples."""
    result = claims.result
    walls = 0
    for s, stack in enumerate(result.stacks):
        u = rational(stack.sample)
        if not inside_stack(claims, u, s):
            raise Violation(f"the sample {stack.sample} of stack {s} is not between its ends")
        heights = [rational(result.cells[n].sample[1 - result.base]) for n in stack.cells]
        levels = [claims.height[0], *heights, claims.height[1]]
        if any(a >= b for a, b in pairwise(levels)):
            raise Violation(f"the samples of stack {s} are not in order inside the window")
        over = {c.number: c.over(u) for c in claims.curves}
        for n, v in zip(stack.cells, heights, strict=True):
            if rational(result.cells[n].sample[result.base]) != u:
                raise Violation(f"the sample of cell {n} is not over the sample of its stack {s}")
            on = next((k for k, p in over.items() if p(v) == 0), None)
            if on is not None:
                raise Violation(f"the sample of cell {n} lies on component {on}")
        found = dict.fromkeys(over, 0)
        for gap, (low, high) in enumerate(pairwise(levels)):
            here = {k: roots for k, p in over.items() if (roots := roots_between(p, low, high))}
            # below the first and above the last sample nothing may lie; between two samples exactly one wall
            expected = {} if gap in (0, len(heights)) else {stack.walls[gap - 1].component: 1}
            if here != expected:
                raise Violation(f"over {stack.sample} (stack {s}) between the heights {low} and {high} there are roots "
                                f"of components {here}, not {expected} (component: number)")  # fmt: skip
            if expected:
                wall = stack.walls[gap - 1]
                if wall.root != found[wall.component]:
                    raise Violation(f"wall {gap - 1} of stack {s} is root {found[wall.component]} of component "
                                    f"{wall.component}, not root {wall.root}")  # fmt: skip
                found[wall.component] += 1
                walls += 1
    return f"{len(result.stacks)} stacks, {walls} walls, {len(result.cells)} samples"


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
        if a.segment is None:
            if (second.stack, second.level) != (first.stack, first.level + 1):
                raise Violation(f"adjacency {number} has no segment, but cells {a.first} and {a.second} are not "
                                "neighbours in one stack")  # fmt: skip
            wall = result.stacks[first.stack].walls[first.level]
            if wall.component != a.component:
                raise Violation(f"adjacency {number}: the wall between the cells is on component {wall.component}, "
                                f"not {a.component}")  # fmt: skip
            vertical.add((a.first, a.second))
        else:
            _check_segment(claims, number, a)
            across.append(a)
    for stack in result.stacks:
        for one, two in pairwise(stack.cells):
            if (one, two) not in vertical:
                raise Violation(f"the adjacency of cells {one} and {two}, neighbours in a stack, is missing")
    return f"{len(vertical)} inside stacks, {len(across)} segments"


def _check_segment(claims: Claims, number: int, a: Adjacency) -> None:
    result = claims.result
    assert a.segment is not None
    first, second = result.cells[a.first], result.cells[a.second]
    low, high, v = (rational(q) for q in a.segment)
    if second.stack != first.stack + 1:
        raise Violation(f"adjacency {number}: cells {a.first} and {a.second} are not in neighbouring stacks")
    if not (inside_stack(claims, low, first.stack) and inside_stack(claims, high, second.stack)):
        raise Violation(f"adjacency {number}: the segment from {low} to {high} does not join the cells' stacks")
    if not claims.height[0] < v < claims.height[1]:
        raise Violation(f"adjacency {number}: the segment's height {v} is outside the window")
    hit = claims.free(low, high, v)
    if hit is not None:
        raise Violation(f"adjacency {number}: component {hit.number} meets the segment [{low}, {high}] at height {v}")
    for n, cell, u in ((a.first, first, low), (a.second, second, high)):
        if (level := claims.level(u, v)) != cell.level:
            raise Violation(f"adjacency {number}: the segment's end ({u}, {v}) has {level} roots below it, "
                            f"so it is not in cell {n}")  # fmt: skip
    value = result.critical_values[first.stack]
    line = next((c.number for c in claims.lines if _is_root(c.in_v[0], value)), None)
    if line != a.component:
        raise Violation(
            f"adjacency {number}: the segment crosses component {line}, not {a.component} (None: no component)"
        )


def check_no_adjacency_missing(claims: Claims) -> str:
    """Every open segment of the line over a critical value joins a stored pair."""
    result = claims.result
    by_parity = by_points = 0
    for s in range(len(result.stacks) - 1):
        left, right = result.stacks[s], result.stacks[s + 1]
        stored = sorted(
            (a for a in result.adjacencies if a.segment is not None and result.cells[a.first].stack == s),
            key=lambda a: (result.cells[a.first].level, result.cells[a.second].level),
        )
        pairs = {(result.cells[a.first].level, result.cells[a.second].level) for a in stored}
        marks = [(claims.height[0], 0, 0, True)]
        for a in stored:
            assert a.segment is not None
            marks.append((rational(a.segment[2]), result.cells[a.first].level, result.cells[a.second].level, False))
        marks.append((claims.height[1], len(left.walls), len(right.walls), True))
        marks.sort(key=lambda m: fmpq(m[0]))
        for (bottom, l0, r0, edge0), (top, l1, r1, edge1) in pairwise(marks):
            branches = (l1 - l0) + (r1 - r0)
            edge = edge0 or edge1
            # through an inner point runs an even number of half-branches; a single one ends on the window's edge
            if branches == 0 or (branches == 2 and not edge) or (branches == 1 and edge0 != edge1):
                by_parity += 1
                continue
            _search(claims, s, bottom, top, pairs)
            by_points += 1
    return (
        f"{by_parity} gaps by parity of half-branches, {by_points} by all points of the curves over the critical value"
    )


def _search(claims: Claims, s: int, bottom: fmpq, top: fmpq, pairs: set[tuple[int, int]]) -> None:
    """Try a free segment in each gap between the points of the curves over a critical value."""
    value = claims.result.critical_values[s]
    left, right = claims.result.stacks[s], claims.result.stacks[s + 1]
    product = fmpz_poly([1])
    for c in claims.curves:
        q = polynomial(value)
        if value.low == value.high:
            q = fmpz_poly([-value.low.numerator, value.low.denominator])
        k = gcd(c.exponent_gcd(0), int(q.deflation()[1]))
        m = c.exponent_gcd(1)
        constant = PlaneCurve(-1, tuple((i, 0, int(a)) for i, a in enumerate(q.coeffs()) if a))
        resultant = c.flint(k, m).resultant(constant.flint(k, 1), "u")
        points = univariate(resultant, 1).inflate(m)
        product = product * (points // points.gcd(points.derivative()))
    for v in points_apart(product, bottom, top):
        low, high = rational(left.sample), rational(right.sample)
        while claims.free(low, high, v) is not None:
            low, high = _closer(low, high, value)
        pair = (claims.level(low, v), claims.level(high, v))
        if pair not in pairs:
            first, second = left.cells[pair[0]], right.cells[pair[1]]
            raise Violation(f"the adjacency of cells {first} and {second} is missing; the segment from {low} to {high} "
                            f"at height {v} joins them")  # fmt: skip


def _closer(low: fmpq, high: fmpq, value: CriticalValue) -> tuple[fmpq, fmpq]:
    """A bracket of the critical value at most three quarters as wide."""
    middle = (low + high) / 2
    where = side(middle, value)
    if where == 0:
        return (low + middle) / 2, (middle + high) / 2
    return (middle, high) if where < 0 else (low, middle)
