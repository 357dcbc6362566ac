"""All equilibria in a part of the torus, for all parameters in a box at once: exclusion, Krawczyk's test, bisection.

Guarantee: for every choice of the parameters in the balls of the `Energy`, each of the equilibria that are returned
exists, exactly once in its box, and there is no further one in the squares of the start; when only minima are asked
for, none that is a minimum or degenerate without a negative eigenvalue. What cannot be proved raises `Unproved`.

The test (Krawczyk 1969; Neumaier, Interval Methods for Systems of Equations, 5.1): with C near the inverse of e' at the
middle m of a square X of half width R, let b bound the norm of I - C e'(X). If b < 1 then X has at most one equilibrium
for each choice; and if, with d bounding |C e(m)|, d + b r < r for some r <= R, then the square of half width r around m
has one. Where the second derivatives are of different sizes, as next to a place where a spring is short, the unit of
one angle is a smaller one, and squares are rectangles.

Both ask for one formula on all of X. On a crease (`ptmcad.verification.certified.energy`) there are two, one for each
side, so no existence or uniqueness is proved in a square that meets one. It may only be discarded, when neither formula
has a zero in all of the square, and is halved otherwise. What lies on the crease itself is no equilibrium, but the
search does not end where a formula has a zero on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from math import isfinite

from flint import arb

from ptmcad.verification.certified.boxes import Zero, disjoint, same, within
from ptmcad.verification.certified.energy import Derivatives, Energy
from ptmcad.verification.certified.vectors import SPRINGS

Pair = tuple[float, float]
"""A number for each angle."""
Square = tuple[float, float, float, float]
"""Middle and half width in the first angle, then in the second."""
CIRCLES = (True, True)
_HALF_WIDTH = 101 / 32
"""A little more than pi, so that the first square has the whole torus."""
TORUS: Square = (0.0, _HALF_WIDTH, 0.0, _HALF_WIDTH)
MIN_HALF_WIDTH = 2.0**-34
"""Half the width of squares that are not halved again, unless another one is asked for."""
_SIZES = tuple(2.0**-k for k in (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 18, 21, 25, 30, 35, 40, 43, 46))
_CONVERGED_STEP = 2.0**-48
"""Steps of Newton's method below it are not worth another one ..."""
_MAX_STEP = 2.0**-20
"""... and above it there is nothing to be proved; rounding may keep them between."""
_MAX_RATIO = 2.0**10
"""Of second derivatives whose angles have one unit."""
_NARROWING = 4
"""Steps by which a rectangle around an equilibrium is made narrower, where units differ."""


class Unproved(Exception):
    """The number of equilibria could not be proved; the message says why."""


def is_same(one: Zero, two: Zero, circles: Sequence[bool]) -> bool:
    """Whether a solution lies where another one is alone.

    Raises
    ------
    Unproved
        When it may or may not be the other one.
    """
    if same(one, two, circles):
        return True
    if disjoint(one, two, circles):
        return False
    raise Unproved("a stored box may have one of two solutions")


def equilibria(
    energy: Energy,
    minima: bool,
    start: Iterable[Square] = (TORUS,),
    budget: int = 300_000,
    smallest: Pair = (MIN_HALF_WIDTH, MIN_HALF_WIDTH),
    near: Iterable[Zero] = (),
) -> tuple[list[Zero], int]:
    """The equilibria in the squares, and how many squares were looked at.

    Parameters
    ----------
    minima : whether only stable equilibria are asked for; others may then be missing.
    budget : number of squares after which the search gives up.
    smallest : half widths below which an angle is not halved again.
    near : equilibria for one choice of the parameters; those near them are proved first, which saves a hopeless search.

    Raises
    ------
    Unproved
        When an equilibrium is degenerate or nearly so for some parameters, or the budget was spent.
    """
    waiting = list(start)
    found = [_persisting(energy, e) for e in near]
    if not all(disjoint(one, two, CIRCLES) for one, two in combinations(found, 2)):
        raise Unproved("two equilibria may meet")
    used = 0
    while waiting:
        m1, r1, m2, r2 = square = waiting.pop()
        used += 1
        if used > budget:
            raise Unproved(f"{budget} squares were not enough")
        at = arb(m1, r1), arb(m2, r2)
        d = energy(*at)
        if _excluded(energy, square, d, minima) or any(_inside(square, e) for e in found):
            continue
        ways = energy.one_sided(*at)
        if ways:
            if all(_without_zero(way, square, minima) for way in ways):
                continue
        elif not d.short:
            inverse = _inverse(d)
            if inverse is not None:
                if _off_middle(energy, square, d, inverse):
                    continue
                new = _settled(energy, square, found)
                if new is not None and all(disjoint(new, e, CIRCLES) for e in found):
                    found.append(new)
                    if _inside(square, new):
                        continue
        halves = _halves(square, _first(d, r1, r2), smallest)
        if halves is None:
            raise Unproved(f"an equilibrium near ({m1:.6g}, {m2:.6g}) may be degenerate")
        waiting += halves
    return found, used


def _halves(square: Square, first: bool, smallest: Pair) -> tuple[Square, Square] | None:
    """Two squares that cover a square, halved in its first or second angle; None when it is too small.

    The angle is the other one where the one that is asked for has been halved enough.
    """
    m1, r1, m2, r2 = square
    for one in (first, not first):
        m, r = (m1, r1) if one else (m2, r2)
        half, low, high = r / 2, m - r / 2, m + r / 2
        if m - low != half or high - m != half:
            # without this, doubles would leave a gap between the halves, or beside them
            half += 2.0**-51 * (abs(m) + r)
        if r >= smallest[not one] and half <= 0.75 * r:
            return ((low, half, m2, r2), (high, half, m2, r2)) if one else ((m1, r1, low, half), (m1, r1, high, half))
    return None


def _excluded(energy: Energy, square: Square, d: Derivatives, minima: bool) -> bool:
    """Whether no equilibrium that is asked for lies in the square."""
    if d.e1 > 0 or d.e1 < 0 or d.e2 > 0 or d.e2 < 0:
        return True
    m1, r1, m2, r2 = square
    at = arb(m1, r1), arb(m2, r2)
    if minima:
        if not d.short and (d.e11 < 0 or d.e22 < 0 or d.e11 * d.e22 - d.e12 * d.e21 < 0):
            return True
        if d.bare is not None and energy.peaks(*at, d):
            return True
    if not energy.between.pulls or (not d.crossing and r1 + r2 > 0.25):
        return False
    if not energy.cone(*at, d).contains(0):
        return True
    return minima and d.crossing and len(d.short) == 1 and energy.bends_down(*at, d)


def _without_zero(energy: Energy, square: Square, minima: bool) -> bool:
    """Whether a continued energy has no equilibrium that is asked for in a square that meets its crease."""
    m1, r1, m2, r2 = square
    d = energy(arb(m1, r1), arb(m2, r2))
    if _excluded(energy, square, d, minima):
        return True
    inverse = None if d.short else _inverse(d)
    return inverse is not None and _off_middle(energy, square, d, inverse)


def _inverse(d: Derivatives) -> tuple[float, float, float, float] | None:
    """An approximate inverse of the middle of the second derivatives."""
    a, b, c, e = (float(x.mid()) for x in (d.e11, d.e12, d.e21, d.e22))
    determinant = a * e - b * c
    if determinant == 0 or not isfinite(determinant):
        return None
    return e / determinant, -b / determinant, -c / determinant, a / determinant


def _rows(d: Derivatives, inverse: tuple[float, float, float, float]) -> tuple[arb, arb, arb, arb]:
    """I - C e' for the second derivatives in the balls."""
    p, q, r, s = inverse
    return (
        1 - (p * d.e11 + q * d.e21), -(p * d.e12 + q * d.e22),
        -(r * d.e11 + s * d.e21), 1 - (r * d.e12 + s * d.e22),
    )  # fmt: skip


def _off_middle(energy: Energy, square: Square, d: Derivatives, inverse: tuple[float, float, float, float]) -> bool:
    """Whether Krawczyk's image of the square misses it."""
    m1, r1, m2, r2 = square
    middle = energy(arb(m1), arb(m2))
    p, q, r, s = inverse
    i11, i12, i21, i22 = _rows(d, inverse)
    x, y = arb(0, r1), arb(0, r2)
    step1 = i11 * x + i12 * y - (p * middle.e1 + q * middle.e2)
    step2 = i21 * x + i22 * y - (r * middle.e1 + s * middle.e2)
    return bool(step1 > r1 or step1 < -r1 or step2 > r2 or step2 < -r2)


def _settled(energy: Energy, square: Square, found: list[Zero]) -> Zero | None:
    """An equilibrium that Newton's method reaches from the square's middle, proved to be one; None when none is."""
    m1, r1, m2, r2 = square
    x, y, step = m1, m2, 1.0
    for _ in range(10):
        d = energy(arb(x), arb(y))
        inverse = None if d.short else _inverse(d)
        if inverse is None:
            return None
        p, q, r, s = inverse
        u, v = float(d.e1.mid()), float(d.e2.mid())
        step1, step2 = p * u + q * v, r * u + s * v
        x, y = x - step1, y - step2
        if max(abs(x - m1) - r1, abs(y - m2) - r2) > max(r1, r2):
            return None
        unit1, unit2 = _units(d)
        step = max(abs(step1) / unit1, abs(step2) / unit2)
        if step < _CONVERGED_STEP:
            break
    if step > _MAX_STEP:
        return None
    if any(within((x, y), e.center, e.alone, CIRCLES) for e in found):
        return None
    return _proved(energy, (x, y))


def _persisting(energy: Energy, e: Zero) -> Zero:
    """The equilibrium for all parameters that one for some parameters belongs to."""
    x, y = e.center
    persisting = _proved(energy, (x, y))
    if persisting is None:
        raise Unproved(f"the equilibrium near ({x:.6g}, {y:.6g}) may not persist")
    return persisting


def _units(d: Derivatives) -> Pair:
    """The units of the two angles: unequal where the second derivatives are of very different sizes."""
    first, second = float(abs(d.e11.mid())), float(abs(d.e22.mid()))
    if first > _MAX_RATIO * second > 0:
        return second / first, 1.0
    if second > _MAX_RATIO * first > 0:
        return 1.0, first / second
    return 1.0, 1.0


def _proved(energy: Energy, center: Pair) -> Zero | None:
    x, y = center
    middle = energy(arb(x), arb(y))
    unit1, unit2 = (1.0, 1.0) if middle.short else _units(middle)
    ratio = unit2 / unit1
    for size in _SIZES:
        d = energy(arb(x, size * unit1), arb(y, size * unit2))
        if d.short:
            continue
        inverse = _inverse(d)
        if inverse is None:
            continue
        p, q, r, s = inverse
        i11, i12, i21, i22 = _rows(d, inverse)
        rows = i11.abs_upper() + i12.abs_upper() * ratio, i21.abs_upper() / ratio + i22.abs_upper()
        norm = float(max(rows).upper()) * 1.0001
        if not norm < 0.9:
            continue
        step1, step2 = p * middle.e1 + q * middle.e2, r * middle.e1 + s * middle.e2
        off = max(step1.abs_upper() / unit1, step2.abs_upper() / unit2)
        radius = float(off.upper()) * 1.01 / (1 - norm) + 2.0**-50
        if radius > size:
            return None
        if not off + arb(norm) * radius < radius:
            return None
        r1, r2 = radius * unit1, radius * unit2
        near = energy(arb(x, r1), arb(y, r2))
        signs = signs_of(near)
        if signs is None:
            return None
        if unit1 != unit2:
            # Krawczyk's image of the rectangle, which has the equilibrium too, is narrow in either angle
            i11, i12, i21, i22 = _rows(near, inverse)
            for _ in range(_NARROWING):
                r1, r2 = (
                    min(r, float((abs(step) + abs(i) * r1 + abs(j) * r2).abs_upper()) * 1.0001)
                    for r, step, i, j in ((r1, step1, i11, i12), (r2, step2, i21, i22))
                )
        return Zero(center, (r1, r2), (size * unit1, size * unit2), signs)
    return None


def signs_of(d: Derivatives) -> str | None:
    """The signs of the Hessian's eigenvalues all over a square; None where they are not told."""
    determinant = d.e11 * d.e22 - d.e12 * d.e21
    if determinant < 0:
        return "+-"
    if determinant > 0:
        if d.e11 > 0:
            return "++"
        if d.e11 < 0:
            return "--"
    return None


def _inside(square: Square, e: Zero) -> bool:
    """Whether the square is within the part of the torus in which the equilibrium is alone."""
    m1, r1, m2, r2 = square
    room = e.alone[0] - r1, e.alone[1] - r2
    return min(room) > 0 and within((m1, m2), e.center, room, CIRCLES)


def _first(d: Derivatives, r1: float, r2: float) -> bool:
    """Whether the first angle is to be halved: the one that the derivatives vary with more."""
    if d.short:
        angle = SPRINGS[d.short[0]].angle
        return r1 >= r2 if angle is None else 16 * r1 > r2 if angle == 0 else r1 > 16 * r2
    by1 = float(d.e11.abs_upper() + d.e21.abs_upper()) * r1
    by2 = float(d.e12.abs_upper() + d.e22.abs_upper()) * r2
    if not (isfinite(by1) and isfinite(by2)):
        return r1 >= r2
    return by1 >= by2 if max(r1, r2) < 32 * min(r1, r2) else r1 >= r2
