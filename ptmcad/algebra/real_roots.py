"""Real roots of integer polynomials: isolation by Descartes' rule, refinement, rational points between.

Guarantee: exact. Isolation finds every root in the open interval; isolating intervals have rational ends, are disjoint
and contain one root each, an interval of length zero being the root itself.

Intervals are bisected; where several bisections in a row have not parted some roots, Newton's method is run on to where
their cluster may be, Taylor coefficients show how long it may be, and Descartes' rule whether it is. Where the roots
keep to one end of the interval, but too near to others for that, steps towards the end get longer while they are right.
So the steps that a cluster takes grow with the logarithm of its number of leading digits, not with that number.

References: Collins & Akritas, SYMSAC 1976; Rouillier & Zimmermann, J. Comput. Appl. Math. 162 (2004); Sagraloff &
Mehlhorn, Computing real roots of real polynomials, J. Symb. Comp. 73 (2016).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flint import arb, arb_poly, ctx, fmpq, fmpz, fmpz_poly

_SHIFT = fmpz_poly([1, 1])
_CLUSTER_CUTS = 3
"""Cuts without a change of Descartes' bound after which the roots are taken for a cluster."""
_CLUSTER_BITS = 8
"""Bits with which a cluster is looked for at first."""
_CLUSTER_MARGIN = 4
"""How much longer than the estimate an interval around a cluster is: Descartes' rule sees complex roots in a lens."""
_MAX_CLUSTER_RADIUS = fmpq(1, 16)
"""Half the length up to which such an interval is better than bisection."""
_LONG_BITS = 1000
"""Bits of coefficients from which on values are not computed exactly where a ball will do."""
_MIN_SPEED = 2
"""The first step towards an end is to the part 2^-4 of the interval; each further one is twice as many bits long."""


@dataclass(frozen=True, slots=True)
class RealRoot:
    """The only root of the squarefree ``polynomial`` in the open interval (low, high), or low itself if low == high."""

    polynomial: fmpz_poly
    low: fmpq
    high: fmpq

    @property
    def is_rational(self) -> bool:
        """Whether the root is known to be the rational ``low``."""
        return bool(self.low == self.high)

    @property
    def middle(self) -> fmpq:
        return (self.low + self.high) / 2


def sign(value: fmpq | fmpz) -> int:
    """-1, 0 or 1."""
    return (value > 0) - (value < 0)


def sign_at(p: fmpz_poly, at: fmpq) -> int:
    """The sign of p at a rational point."""
    return sign(fmpq(p(at)))


def squarefree_part(p: fmpz_poly) -> fmpz_poly:
    """p divided by gcd(p, p')."""
    if p.degree() < 1:
        return p
    common = p.gcd(p.derivative())
    return p if common.degree() == 0 else p // common


def variations(p: fmpz_poly) -> int:
    """The number of sign changes in the sequence of coefficients."""
    count, last = 0, 0
    for c in p.coeffs():
        if c:
            s = 1 if c > 0 else -1
            count += s == -last
            last = s
    return count


def _on_unit_interval(p: fmpz_poly, low: fmpq, high: fmpq) -> fmpz_poly:
    """A positive multiple of p(low + (high - low) t)."""
    width = high - low
    scale = int(low.q) * int(width.q)
    offset, step = int(low.p) * int(width.q), int(width.p) * int(low.q)
    n = p.degree()
    power, scaled = 1, []
    for c in reversed(p.coeffs()):
        scaled.append(c * power)
        power *= scale
    return fmpz_poly(scaled[::-1])(fmpz_poly([offset, step])) if n >= 0 else p


def _descartes_bound(q: fmpz_poly, degree: int) -> int:
    """Sign changes of (1 + t)^n q(1/(1 + t)): a bound for the number of roots of q in (0, 1), exact when 0 or 1."""
    coefficients = q.coeffs()
    coefficients += [fmpz(0)] * (degree + 1 - len(coefficients))
    return variations(fmpz_poly(coefficients[::-1])(_SHIFT))


def isolate(p: fmpz_poly, low: fmpq, high: fmpq) -> tuple[RealRoot, ...]:
    """The roots of a squarefree polynomial in the open interval (low, high), in increasing order.

    Raises
    ------
    ValueError
        When the polynomial has a multiple root in the interval.
    """
    if p.degree() < 1:
        return ()
    beyond = root_bound(p)
    if high - low > 16 * beyond:
        # bisection of an interval much longer than needed would take a level for each bit
        low, high = max(low, -beyond), min(high, beyond)
        if low >= high:
            return ()
    width = high - low
    found: list[tuple[fmpq, fmpq]] = []
    squarefree = False
    stack = [_Part(_on_unit_interval(p, low, high), fmpq(0), fmpq(1), -1, 0, 0, _MIN_SPEED)]
    while stack:
        part = stack.pop()
        q, left, size = part.polynomial, part.left, part.width
        while q[0] == 0:
            q = q.right_shift(1)
        bound = _descartes_bound(q, q.degree())
        if bound == 0:
            continue
        if bound == 1:
            found.append((low + width * left, low + width * (left + size)))
            continue
        unchanged, run, speed = (
            (part.unchanged + 1, part.run, part.speed) if bound == part.bound else (0, 0, _MIN_SPEED)
        )
        if unchanged >= _CLUSTER_CUTS:
            if not squarefree and p.gcd(p.derivative()).degree() > 0:
                raise ValueError(f"a polynomial of degree {p.degree()} is not squarefree")
            squarefree = True
            narrow = _cluster(q, bound)
            if narrow is not None:
                unchanged, run = 0, 0
            elif abs(run) >= _CLUSTER_CUTS:
                narrow = _edge(q, bound, run > 0, 2**speed)
                if narrow is not None:
                    speed += 1
                elif speed > _MIN_SPEED:
                    speed -= 1
                else:
                    run = 0
            if narrow is not None:
                q, left, size = narrow[0], left + narrow[1] * size, narrow[2] * size
        n = q.degree()
        half = fmpz_poly([c << (n - i) for i, c in enumerate(q.coeffs())])
        other = half(_SHIFT)
        piece = size / 2
        middle = left + piece
        if other[0] == 0:
            found.append((low + width * middle, low + width * middle))
        stack.append(_Part(half, left, piece, bound, unchanged, min(run, 0) - 1, speed))
        stack.append(_Part(other, middle, piece, bound, unchanged, max(run, 0) + 1, speed))
    return tuple(_normalised(p, left, right) for left, right in sorted(found))


@dataclass(frozen=True, slots=True)
class _Part:
    """A part of the interval in which roots are isolated.

    Attributes
    ----------
    polynomial : a multiple of p on the part, which is mapped to (0, 1).
    left, width : of the part, the whole interval being (0, 1).
    bound : Descartes' bound for the part that it was cut from.
    unchanged : for how many cuts the bound has been the same.
    run : for how many cuts the part has been the right half (positive) or the left one (negative).
    speed : roots are looked for in the share 2^-(2^speed) beside an end of the part.
    """

    polynomial: fmpz_poly
    left: fmpq
    width: fmpq
    bound: int
    unchanged: int
    run: int
    speed: int


def _cluster(q: fmpz_poly, bound: int) -> tuple[fmpz_poly, fmpq, fmpq] | None:
    """A much shorter interval in (0, 1) which holds all roots of q there: q on it, its start and its width.

    None when that is not proved. It is when Descartes' bound for the interval is that for (0, 1), as the sum of the
    bounds for disjoint parts never exceeds the bound for the whole. Where the interval may be is found by Newton's
    method, to which roots that lie together look like a multiple one, from the left end as from the right; how long,
    by the Taylor coefficients there, whose first ones are those of a polynomial with about these roots only.
    """
    slope = q.derivative()
    # in whole numbers: reducing fractions of thousands of bits would take most of the time
    values = [(q(end), slope(end)) for end in (0, 1)]
    if any(value == 0 or derivative == 0 for value, derivative in values):
        return None
    steps = [int((bound * value << _CLUSTER_BITS) // derivative) for value, derivative in values]
    targets = -steps[0], 2**_CLUSTER_BITS - steps[1]
    if abs(targets[0] - targets[1]) > 2**_CLUSTER_BITS // 4 or not -1 < targets[0] >> (_CLUSTER_BITS - 2) < 5:
        return None
    last, centre = min((abs(step), target) for step, target in zip(steps, targets, strict=True))
    bits, contracted = _CLUSTER_BITS, False
    while True:
        at = fmpq(centre, 2**bits)
        value, derivative = fmpq(q(at)), fmpq(slope(at))
        if value == 0 or derivative == 0:
            break
        more = 2 * (bits - last.bit_length()) + _CLUSTER_BITS
        step = int((bound * value.p * derivative.q << more) // (value.q * derivative.p))
        if 2 * abs(step) > last << (more - bits):
            break
        centre, last, bits, contracted = (centre << (more - bits)) - step, abs(step), more, True
    if not contracted:
        return None
    centre, unit = at, fmpq(2) ** (last.bit_length() - bits)
    around = _on_unit_interval(q, centre, centre + unit)
    radius = _CLUSTER_MARGIN * unit * root_bound(fmpz_poly(around.coeffs()[: bound + 1]))
    if radius > _MAX_CLUSTER_RADIUS:
        return None
    left, right = max(centre - radius, fmpq(0)), min(centre + radius, fmpq(1))
    return _holding(q, bound, left, right) if left < right else None


def _edge(q: fmpz_poly, bound: int, right: bool, bits: int) -> tuple[fmpz_poly, fmpq, fmpq] | None:
    """The same for the part 2^-bits of (0, 1) at its right or left end, unless it does not hold all the roots."""
    share = fmpq(1, 2**bits)
    return _holding(q, bound, 1 - share if right else fmpq(0), fmpq(1) if right else share)


def _holding(q: fmpz_poly, bound: int, left: fmpq, right: fmpq) -> tuple[fmpz_poly, fmpq, fmpq] | None:
    """q on (left, right), its start and its width, if that is proved to hold all roots of q in (0, 1)."""
    narrow = _on_unit_interval(q, left, right)
    held = narrow[0] != 0 and _descartes_bound(narrow, q.degree()) == bound
    return (narrow, left, right - left) if held else None


def root_bound(p: fmpz_poly) -> fmpq:
    """A power of two above the moduli of all complex roots: 2 max |a_{n-i} / a_n|^(1/i), rounded up (Fujiwara)."""
    leading, *lower = (int(c).bit_length() for c in reversed(p.coeffs()))
    bits = max((-((leading - 1 - b) // i) for i, b in enumerate(lower, 1) if b), default=0)
    return fmpq(2) ** (1 + bits)


def _normalised(p: fmpz_poly, low: fmpq, high: fmpq) -> RealRoot:
    """The isolating interval with ends that are no roots, so that signs at its ends differ."""
    if low == high:
        return RealRoot(p, low, high)
    derivative = p.derivative()
    while True:
        s, t = sign_at(p, low), sign_at(p, high)
        s = s or sign_at(derivative, low)
        t = t or -sign_at(derivative, high)
        if s == 0 or t == 0:
            raise ValueError(f"a polynomial of degree {p.degree()} is not squarefree")
        if sign_at(p, low) and sign_at(p, high):
            return RealRoot(p, low, high)
        middle = (low + high) / 2
        u = sign_at(p, middle)
        if u == 0:
            return RealRoot(p, middle, middle)
        if u == s:
            low = middle
        else:
            high = middle


def halve(root: RealRoot) -> RealRoot:
    """The same root in an interval half as long."""
    if root.is_rational:
        return root
    middle = root.middle
    at_middle = sign_at(root.polynomial, middle)
    if at_middle == 0:
        return RealRoot(root.polynomial, middle, middle)
    if at_middle == sign_at(root.polynomial, root.low):
        return RealRoot(root.polynomial, middle, root.high)
    return RealRoot(root.polynomial, root.low, middle)


def refine(root: RealRoot, width: fmpq) -> RealRoot:
    """The same root in an interval shorter than ``width``, by quadratic interval refinement.

    Reference: Abbott, Quadratic interval refinement for real roots, ACM Commun. Comput. Algebra 48 (2014).
    """
    p, low, high = root.polynomial, root.low, root.high
    if low == high or high - low < width:
        return root
    value_at = _values(p, low, high, width)
    pieces = 4
    at_low, at_high = value_at(low, pieces), value_at(high, pieces)
    while high - low >= width:
        step = (high - low) / pieces
        slope = at_low / (at_low - at_high)
        k = (slope * pieces + fmpq(1, 2)).floor()
        left = low + step * k
        value = at_low if k == 0 else at_high if k == pieces else value_at(left, pieces)
        if value == 0:
            return RealRoot(p, left, left)
        right = left + step if sign(value) == sign(at_low) else left - step
        if low <= right <= high:
            other = at_low if right == low else at_high if right == high else value_at(right, pieces)
            if other == 0:
                return RealRoot(p, right, right)
            if sign(other) != sign(value):
                if right > left:
                    low, at_low, high, at_high = left, value, right, other
                else:
                    low, at_low, high, at_high = right, other, left, value
                pieces *= pieces
                continue
        pieces = 4
        middle = (low + high) / 2
        value = value_at(middle, pieces)
        if value == 0:
            return RealRoot(p, middle, middle)
        if sign(value) == sign(at_low):
            low, at_low = middle, value
        else:
            high, at_high = middle, value
    return RealRoot(p, low, high)


def _values(p: fmpz_poly, low: fmpq, high: fmpq, width: fmpq) -> Callable[[fmpq, int], fmpq]:
    """p at points of [low, high], for so many pieces: exact, or with the right sign and short if p is long.

    A short value comes from a ball that does not contain zero and is known more precisely than one piece of the secant.
    """

    def exact(at: fmpq, pieces: int) -> fmpq:
        return fmpq(p(at))

    bits = p.height_bits()
    if bits < _LONG_BITS:
        return exact
    depth = int((max(abs(low), abs(high)) / width).ceil()).bit_length()
    precision = 3 * depth + 64
    if bits < 2 * precision:
        return exact
    with ctx.workprec(precision):
        rounded = arb_poly(p)

    def value_at(at: fmpq, pieces: int) -> fmpq:
        with ctx.workprec(precision):
            ball = rounded(arb(at))
        if ball.rel_accuracy_bits() < pieces.bit_length() + 8:
            return fmpq(p(at))
        return ball.mid().fmpq()

    return value_at


def has_root_between(p: fmpz_poly, low: fmpq, high: fmpq) -> bool:
    """Whether p has a root in the closed interval [low, high]; p need not be squarefree."""
    if sign_at(p, low) == 0 or sign_at(p, high) == 0:
        return True
    if p.degree() < 1:
        return False
    bound = _descartes_bound(_on_unit_interval(p, low, high), p.degree())
    if bound % 2 == 1:
        return True
    return bound > 0 and bool(isolate(squarefree_part(p), low, high))


def disjoint(roots: Sequence[RealRoot]) -> tuple[RealRoot, ...]:
    """Different real numbers in increasing order, with closed isolating intervals that are pairwise disjoint."""
    ordered = sorted(roots, key=lambda r: (r.low, r.high))
    changed = True
    while changed:
        changed = False
        for i in range(len(ordered) - 1):
            a, b = ordered[i], ordered[i + 1]
            while a.high >= b.low:
                a, b = (halve(a), b) if a.high - a.low >= b.high - b.low else (a, halve(b))
                changed = True
                if a.low > b.high or (a.is_rational and b.is_rational):
                    break
            ordered[i], ordered[i + 1] = a, b
        if changed:
            ordered.sort(key=lambda r: (r.low, r.high))
    return tuple(ordered)


def inside(roots: Sequence[RealRoot], interval: tuple[fmpq, fmpq]) -> tuple[RealRoot, ...]:
    """The same roots, in order, all inside an open interval, with closed isolating intervals inside it too."""
    inner = list(roots)
    while inner and inner[0].low <= interval[0]:
        inner[0] = halve(inner[0])
    while inner and inner[-1].high >= interval[1]:
        inner[-1] = halve(inner[-1])
    return tuple(inner)


def simplest_between(low: fmpq, high: fmpq) -> fmpq:
    """The rational with the smallest denominator strictly between low and high, the one nearest to zero of these."""
    if low < 0 < high:
        return fmpq(0)
    if high <= 0:
        return -simplest_between(-high, -low)
    # continued fraction descent in integers: no fraction has to be reduced on the way
    numerator, denominator, upper, lower = int(low.p), int(low.q), int(high.p), int(high.q)
    a, b, c, d = 1, 0, 0, 1
    while True:
        whole, rest = divmod(numerator, denominator)
        excess = upper - whole * lower
        if excess > lower:  # whole + 1 lies below the upper end
            return fmpq(a * (whole + 1) + b, c * (whole + 1) + d)
        a, b, c, d = a * whole + b, a, c * whole + d, c
        if rest == 0:  # the smallest 1/t below the rest of the upper end, t integer
            t = lower // excess + 1
            return fmpq(a * t + b, c * t + d)
        # both in (0, 1]; take reciprocals
        numerator, denominator, upper, lower = lower, excess, denominator, rest
