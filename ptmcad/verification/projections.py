"""Checks of the decomposition: critical values, stacks, walls and samples; and the heights of the
curves' points over a critical value.

Guarantee: over each stack the curves' roots between the window's edges are constant in number and
order (discriminants, resultants and edge values have no root there but the stored ones); over its
sample they are the stored walls. Counts of heights are exact, every point counted once. Roots are
counted by Sturm sequences; the decomposition isolates them by Descartes' rule.

Heights. Let P(u, v) be the product of the curves' polynomials and a the critical value. Where
deg_v P is the same at a, the Sturm sequence of P(a, v) is computed with balls for the coefficients:
remainder by remainder, each of the degree before less one, until a linear one is left whose leading
coefficient is certainly not zero. The next remainder would be a constant. It is zero exactly when
P(a, v) has a multiple root, which is when a is a root of a curve's discriminant or of the resultant
of two: that is decided in integers. Either way the sequence is known to its end, and its changes of
sign count the different real roots (Sturm; for the multiple root all terms are divided by their
last one).

Otherwise, where several roots are multiple, roots are counted of the polynomials in v among whose
roots all points are (`points_over`), but for those that balls show to be on no curve; this takes
long for values of high degree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import combinations, pairwise
from math import gcd, prod

from flint import arb, arb_poly, ctx, fmpq, fmpz, fmpz_poly

from ptmcad.answer.regionmap import CriticalValue
from ptmcad.text.flint_numbers import from_fraction, interval_of
from ptmcad.text.numerals import text_of
from ptmcad.verification.claims import Claims, PlaneCurve, ball, is_root, polynomial, short, side
from ptmcad.verification.planecurves import discriminant, resultant
from ptmcad.verification.report import Violation
from ptmcad.verification.rootcounts import (
    Interval,
    ball_chain,
    ends_of,
    isolated,
    isolating_intervals,
    parting,
    real_roots,
    roots_between,
    roots_within,
    squarefree,
)


def projection_of_one(curve: PlaneCurve, height: Interval) -> list[tuple[fmpz_poly, str]]:
    """Irreducible polynomials outside whose roots the curve's roots in the open interval are
    constant in number.

    Each with its origin, in the words of `ptmcad.answer.regionmap.CriticalValue`.
    """
    m, name = curve.exponent_gcd(1), f"component {curve.number}"
    found = [(curve.along(edge), f"{name}: crosses the window's edge") for edge in height]
    if curve.degrees[1] > m:
        found.append((_turning(curve), f"{name}: turning or singular point"))
    if m > 1 and height[0] < 0 < height[1]:
        found.append((curve.in_v[0], f"{name}: turning point on the axis"))
    return [(f, origin) for p, origin in found for f in _factors(p)]


def _turning(curve: PlaneCurve) -> fmpz_poly:
    """The discriminant in powers of u and v; where a power of v is zero, and v is a multiple root,
    it need not vanish.
    """
    k, m = curve.exponent_gcd(0), curve.exponent_gcd(1)
    return discriminant(curve.deflated(k, m)).inflate(k)


def _meeting(one: PlaneCurve, other: PlaneCurve) -> fmpz_poly:
    """The resultant in powers of u and v that both curves have."""
    k, m = (gcd(one.exponent_gcd(axis), other.exponent_gcd(axis)) for axis in (0, 1))
    return resultant(one.deflated(k, m), other.deflated(k, m)).inflate(k)


def points_over(curve: PlaneCurve, value: CriticalValue) -> fmpz_poly:
    """A squarefree polynomial in v among whose roots are all points of the curve over a critical
    value.
    """
    q = polynomial(value)
    if value.low == value.high:
        q = fmpz_poly([-value.low.numerator, value.low.denominator])
    k = gcd(curve.exponent_gcd(0), int(q.deflation()[1]))
    m = curve.exponent_gcd(1)
    # eliminated is the second variable, so u and v change places
    constant = tuple((0, i // k, int(a)) for i, a in enumerate(q.coeffs()) if a)
    swapped = tuple((j, i, c) for i, j, c in curve.deflated(k, m))
    return squarefree(resultant(swapped, constant).inflate(m))


def _factors(p: fmpz_poly) -> tuple[fmpz_poly, ...]:
    return _factors_of(tuple(p.coeffs())) if p.degree() > 0 else ()


@lru_cache(maxsize=256)
def _factors_of(coefficients: tuple[fmpz, ...]) -> tuple[fmpz_poly, ...]:
    return tuple(f for f, _ in fmpz_poly(list(coefficients)).factor()[1])


def _projection(claims: Claims) -> dict[tuple[int, ...], tuple[fmpz_poly, set[str]]]:
    """The irreducible polynomials of the projection, each with all its origins."""
    found: list[tuple[fmpz_poly, str]] = []
    for line in claims.lines:
        found += [(f, "vertical line") for f in _factors(line.in_v[0])]
    for i, c in enumerate(claims.curves):
        found += projection_of_one(c, claims.height)
        for d in claims.curves[i + 1 :]:
            meet = f"components {c.number} and {d.number} meet"
            found += [(f, meet) for f in _factors(_meeting(c, d))]
    merged: dict[tuple[int, ...], tuple[fmpz_poly, set[str]]] = {}
    for f, origin in found:
        merged.setdefault(tuple(int(c) for c in f.coeffs()), (f, set()))[1].add(origin)
    return merged


def check_critical_values(claims: Claims) -> str:
    """Isolation, order, and completeness of the critical values."""
    values = claims.result.critical_values
    previous = claims.base[0]
    factors = _projection(claims)
    for n, value in enumerate(values):
        if value.polynomial not in factors:
            raise Violation(
                f"critical value {n}: its polynomial is no irreducible factor of a discriminant, resultant "
                "or edge value"
            )
        low, high = interval_of(value)
        between = f"[{text_of(value.low)}, {text_of(value.high)}]"
        p = polynomial(value)
        if not previous < low <= high < claims.base[1]:
            raise Violation(
                f"critical value {n} in {between} is not above the one before it and in the window"
            )
        if (roots := roots_within(p, low, high)) != 1:
            raise Violation(f"critical value {n}: its polynomial has {roots} roots in {between}")
        previous = high
    origins: list[set[str]] = [set() for _ in values]
    for coefficients, (f, whence) in factors.items():
        matching = [n for n, value in enumerate(values) if value.polynomial == coefficients]
        for n in matching:
            origins[n] |= whence
        if (roots := roots_between(f, *claims.base)) != len(matching):
            where = [f"({short(a)}, {short(b)})" for a, b in _unmatched(f, claims, matching)]
            raise Violation(
                f"a polynomial of the projection of degree {f.degree()} has {roots} roots in the window, "
                f"but {len(matching)} of them are stored; not stored: {', '.join(where)}"
            )
    for n, (value, true) in enumerate(zip(values, origins, strict=True)):
        if value.origin not in true:
            raise Violation(
                f"the origin of critical value {n} is not {value.origin[:80]!r}, but {', '.join(sorted(true))}"
            )
    return f"{len(values)} values, {len(factors)} irreducible discriminants, resultants and edge values"


def _unmatched(f: fmpz_poly, claims: Claims, matching: Sequence[int]) -> list[Interval]:
    stored = [claims.result.critical_values[n] for n in matching]
    return [
        (a, b)
        for a, b in isolating_intervals(f, *claims.base)
        if not any(side(a, value) < 0 < side(b, value) for value in stored)
    ]


def inside_stack(claims: Claims, u: fmpq, stack: int) -> bool:
    """Whether u lies in the stack's open interval."""
    values = claims.result.critical_values
    above = u > claims.base[0] if stack == 0 else side(u, values[stack - 1]) > 0
    below = u < claims.base[1] if stack == len(values) else side(u, values[stack]) < 0
    return above and below


def check_stacks(claims: Claims) -> str:
    """Stacks tile the base; over each sample the stored walls are all roots, in order, and part the
    cells' samples.
    """
    result = claims.result
    walls = 0
    for s, stack in enumerate(result.stacks):
        u = from_fraction(stack.sample)
        if not inside_stack(claims, u, s):
            raise Violation(
                f"the sample {text_of(stack.sample)} of stack {s} is not between its ends"
            )
        heights = [from_fraction(result.cells[n].sample[1 - result.base]) for n in stack.cells]
        levels = [claims.height[0], *heights, claims.height[1]]
        if any(a >= b for a, b in pairwise(levels)):
            raise Violation(f"the samples of stack {s} are not in order inside the window")
        over = {c.number: c.over(u) for c in claims.curves}
        for n, v in zip(stack.cells, heights, strict=True):
            if from_fraction(result.cells[n].sample[result.base]) != u:
                raise Violation(f"the sample of cell {n} is not over the sample of its stack {s}")
            on = next((k for k, p in over.items() if p(v) == 0), None)
            if on is not None:
                raise Violation(f"the sample of cell {n} lies on component {on}")
        found = dict.fromkeys(over, 0)
        for gap, (low, high) in enumerate(pairwise(levels)):
            here = {k: roots for k, p in over.items() if (roots := roots_between(p, low, high))}
            # below the first and above the last sample nothing may lie; between two samples exactly
            # one wall
            expected = {} if gap in (0, len(heights)) else {stack.walls[gap - 1].component: 1}
            if here != expected:
                raise Violation(
                    f"over {text_of(stack.sample)} (stack {s}) between heights {low} and {high} there are "
                    f"roots of components {here}, not {expected} (component: number)"
                )
            if expected:
                wall = stack.walls[gap - 1]
                if wall.root != found[wall.component]:
                    raise Violation(
                        f"wall {gap - 1} of stack {s} is root {found[wall.component]} of component "
                        f"{wall.component}, not root {wall.root}"
                    )
                found[wall.component] += 1
                walls += 1
    return f"{len(result.stacks)} stacks, {walls} walls, {len(result.cells)} samples"


_BITS = (256, 1024, 4096)
_FINEST = 512
"""Bits of candidates that are compared with the curves, besides twice those of their polynomial's
coefficients.
"""


@dataclass(frozen=True)
class Heights:
    """The points over one critical value."""

    curves: Sequence[PlaneCurve]
    value: CriticalValue

    def between(self, low: fmpq, high: fmpq) -> int:
        """The number of points, or of what may be points, with heights in the open interval (low,
        high).
        """
        if low >= high or not self.curves:
            return 0
        for bits in _BITS:
            with ctx.workprec(bits):
                below, above = self._changes(low, bits), self._changes(high, bits)
            if below is not None and above is not None:
                return below - above - self._is_point(high)
        return self._candidates_between(low, high)

    def _candidates_between(self, low: fmpq, high: fmpq) -> int:
        """The number of roots of the polynomial in v at which balls do not tell that no curve is
        there.

        It has the points over the conjugates of the critical value among its roots as well.
        """
        number, finest = 0, _FINEST + 2 * self._polynomial.height_bits()
        with ctx.workprec(2 * finest):
            value = ball(self.value, fmpq(1, 1 << finest))
            ends = [end for end in (low, high) if self._is_point(end)]
            for v in real_roots(tuple(int(c) for c in self._polynomial.coeffs()), finest):
                first, last = ends_of(v)
                if last < low or high < first or any(first <= end <= last for end in ends):
                    continue
                number += any(
                    arb_poly([c(value) for c in curve.in_v])(v).contains(0) for curve in self.curves
                )
        return number

    def separated(self, low: fmpq, high: fmpq) -> list[fmpq]:
        """A rational height in each open interval that the points leave of (low, high)."""
        return parting(isolated(self.between, self._is_point, low, high), low, high)

    def _is_point(self, v: fmpq) -> bool:
        return any(is_root(c.along(v), self.value) for c in self.curves)

    def _changes(self, v: fmpq, bits: int) -> int | None:
        """Changes of sign in the Sturm sequence at a height; None where the precision is too low."""
        if bits not in self._sequences:
            self._sequences[bits] = self._sequence(bits)
        sequence = self._sequences[bits]
        if sequence is None:
            return None
        # at a simple root the first term alone is zero; at a multiple one all are
        values = [q(arb(v)) for q in sequence[int(self._is_point(v)) :]]
        if any(x.contains(0) for x in values):
            return None
        return sum((x > 0) != (y > 0) for x, y in pairwise(values))

    @cached_property
    def _sequences(self) -> dict[int, list[arb_poly] | None]:
        return {}

    def _sequence(self, bits: int) -> list[arb_poly] | None:
        """The Sturm sequence, without its last term where that is zero; None where the precision is
        too low.
        """
        value = ball(self.value, fmpq(1, 1 << bits))
        product = prod(
            (arb_poly([c(value) for c in curve.in_v]) for curve in self.curves), start=arb_poly([1])
        )
        return ball_chain(
            product, sum(curve.degrees[1] for curve in self.curves), int(self._has_multiple_root)
        )

    @cached_property
    def _has_multiple_root(self) -> bool:
        """Whether one of the curves has a multiple root over the value, or two have one in common."""
        zeros = [_turning(curve) for curve in self.curves]
        zeros += [curve.in_v[0] for curve in self.curves if curve.exponent_gcd(1) > 1]
        zeros += [_meeting(c, d) for c, d in combinations(self.curves, 2)]
        return any(is_root(p, self.value) for p in zeros)

    @cached_property
    def _polynomial(self) -> fmpz_poly:
        """A polynomial in v among whose roots are all points."""
        return prod((points_over(c, self.value) for c in self.curves), start=fmpz_poly([1]))
