"""All equilibria in a part of the torus, for all parameters in a box at once: exclusion, Krawczyk's test, bisection.

Guarantee: for every choice of the parameters in the balls of the `Energy`, each of the equilibria that are returned
exists, exactly once in its box, and there is no further one in the squares of the start; when only minima are asked
for, none that is a minimum or degenerate without a negative eigenvalue. What cannot be proved raises `Unproved`.

The test (Krawczyk 1969; Neumaier, Interval Methods for Systems of Equations, 5.1): with C near the inverse of e' at the
middle m of a square X of half width R, let b bound the norm of I - C e'(X). If b < 1 then X has at most one equilibrium
for each choice; and if, with d bounding |C e(m)|, d + b r < r for some r <= R, then the square of half width r around m
has one.

Both ask for one formula on all of X. On a crease (`ptmcad.verification.certified.energy`) there are two, one for each
side, so no existence or uniqueness is proved in a square that meets one. It may only be discarded, when neither formula
has a zero in all of the square, and is halved otherwise. What lies on the crease itself is no equilibrium, but the
search does not end where a formula has a zero on it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from math import isfinite, pi

from flint import arb

from ptmcad.verification.certified.energy import Derivatives, Energy

Square = tuple[float, float, float, float]
"""Middle and half width in th1, then in th2; exact dyadic numbers."""
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


class Unproved(Exception):
    """The number of equilibria could not be proved; the message says why."""


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """The only equilibrium within ``alone`` of (th1, th2), and it is within ``radius``; for each choice of parameters.

    ``signs`` are those of the Hessian's eigenvalues, ``within`` the balls of the two angles.
    """

    th1: float
    th2: float
    radius: float
    alone: float
    signs: str

    @property
    def within(self) -> tuple[arb, arb]:
        return arb(self.th1, self.radius), arb(self.th2, self.radius)


def equilibria(
    energy: Energy,
    minima: bool,
    start: Iterable[Square] = (TORUS,),
    budget: int = 60_000,
    smallest: float = MIN_HALF_WIDTH,
    near: Iterable[Equilibrium] = (),
) -> tuple[list[Equilibrium], int]:
    """The equilibria in the squares, and how many squares were looked at.

    Parameters
    ----------
    minima : whether only stable equilibria are asked for; others may then be missing.
    budget : number of squares after which the search gives up.
    smallest : half width of a square that is not halved again.
    near : equilibria for one choice of the parameters; those near them are proved first, which saves a hopeless search.

    Raises
    ------
    Unproved
        When an equilibrium is degenerate or nearly so for some parameters, or the budget was spent.
    """
    waiting = list(start)
    found = [_persisting(energy, e) for e in near]
    if not all(_disjoint(one, two) for one, two in combinations(found, 2)):
        raise Unproved("two equilibria may meet")
    used = 0
    while waiting:
        m1, r1, m2, r2 = square = waiting.pop()
        used += 1
        if used > budget:
            raise Unproved(f"{budget} squares were not enough")
        th1, th2 = arb(m1, r1), arb(m2, r2)
        d = energy(th1, th2)
        if _excluded(energy, square, d, minima) or any(_inside(square, e) for e in found):
            continue
        ways = energy.one_sided(th1, th2)
        if ways:
            if all(_without_zero(way, square, minima) for way in ways):
                continue
        elif d.short == 0:
            inverse = _inverse(d)
            if inverse is not None:
                if _off_middle(energy, square, d, inverse):
                    continue
                new = _settled(energy, square, found)
                if new is not None and all(_disjoint(new, e) for e in found):
                    found.append(new)
                    if _inside(square, new):
                        continue
        if max(r1, r2) < smallest:
            raise Unproved(f"an equilibrium near ({m1:.6g}, {m2:.6g}) may be degenerate")
        if _first(d, r1, r2):
            waiting += [(m1 - r1 / 2, r1 / 2, m2, r2), (m1 + r1 / 2, r1 / 2, m2, r2)]
        else:
            waiting += [(m1, r1, m2 - r2 / 2, r2 / 2), (m1, r1, m2 + r2 / 2, r2 / 2)]
    return found, used


def _excluded(energy: Energy, square: Square, d: Derivatives, minima: bool) -> bool:
    """Whether no equilibrium that is asked for lies in the square."""
    if d.e1 > 0 or d.e1 < 0 or d.e2 > 0 or d.e2 < 0:
        return True
    m1, r1, m2, r2 = square
    if minima:
        if d.short == 0 and (d.e11 < 0 or d.e22 < 0 or d.e11 * d.e22 - d.e12 * d.e21 < 0):
            return True
        if d.bare is not None and energy.peaks(arb(m1, r1), arb(m2, r2), d):
            return True
    if not energy.free3:
        return False
    if d.rest is None and r1 + r2 > 0.25:
        return False
    th1, th2 = arb(m1, r1), arb(m2, r2)
    if not energy.cone(th1, th2).contains(0):
        return True
    return minima and d.short == 3 and energy.bends_down(th1, th2, d)


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


def _settled(energy: Energy, square: Square, found: list[Equilibrium]) -> Equilibrium | None:
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
        step = max(abs(step1), abs(step2))
        if step < _CONVERGED_STEP:
            break
    if step > _MAX_STEP:
        return None
    if any(_within(x, y, e.th1, e.th2, e.alone) for e in found):
        return None
    return _proved(energy, x, y)


def _persisting(energy: Energy, e: Equilibrium) -> Equilibrium:
    """The equilibrium for all parameters that one for some parameters belongs to."""
    persisting = _proved(energy, e.th1, e.th2)
    if persisting is None:
        raise Unproved(f"the equilibrium near ({e.th1:.6g}, {e.th2:.6g}) may not persist")
    return persisting


def _proved(energy: Energy, x: float, y: float) -> Equilibrium | None:
    middle = energy(arb(x), arb(y))
    for size in _SIZES:
        d = energy(arb(x, size), arb(y, size))
        if d.short:
            continue
        inverse = _inverse(d)
        if inverse is None:
            continue
        p, q, r, s = inverse
        i11, i12, i21, i22 = _rows(d, inverse)
        norm = float(max(i11.abs_upper() + i12.abs_upper(), i21.abs_upper() + i22.abs_upper()).upper()) * 1.0001
        if not norm < 0.9:
            continue
        off = max((p * middle.e1 + q * middle.e2).abs_upper(), (r * middle.e1 + s * middle.e2).abs_upper())
        radius = float(off.upper()) * 1.01 / (1 - norm) + 2.0**-50
        if radius > size:
            return None
        if not off + arb(norm) * radius < radius:
            return None
        near = energy(arb(x, radius), arb(y, radius))
        signs = _signs(near)
        return None if signs is None else Equilibrium(x, y, radius, size, signs)
    return None


def _signs(d: Derivatives) -> str | None:
    determinant = d.e11 * d.e22 - d.e12 * d.e21
    if determinant < 0:
        return "+-"
    if determinant > 0:
        if d.e11 > 0:
            return "++"
        if d.e11 < 0:
            return "--"
    return None


def _turned(difference: float) -> int:
    """The number of whole turns next to a difference of angles."""
    return round(difference / (2 * pi))


def _within(x: float, y: float, th1: float, th2: float, radius: float) -> bool:
    """Whether two points of the torus are surely nearer than a radius in both angles."""
    turns1, turns2 = _turned(x - th1), _turned(y - th2)
    if turns1 == 0 == turns2:
        return bool(abs(arb(x) - arb(th1)) < radius and abs(arb(y) - arb(th2)) < radius)
    full = 2 * arb.pi()
    return bool(abs(arb(x) - arb(th1) - turns1 * full) < radius and abs(arb(y) - arb(th2) - turns2 * full) < radius)


def _inside(square: Square, e: Equilibrium) -> bool:
    """Whether the square is within the part of the torus in which the equilibrium is alone."""
    m1, r1, m2, r2 = square
    room = e.alone - max(r1, r2)
    return room > 0 and _within(m1, m2, e.th1, e.th2, room)


def _disjoint(one: Equilibrium, two: Equilibrium) -> bool:
    """Whether the boxes of two equilibria are surely disjoint on the torus."""
    reach = arb(one.radius) + arb(two.radius)
    full = 2 * arb.pi()
    for x, y in ((one.th1, two.th1), (one.th2, two.th2)):
        difference = arb(x) - arb(y)
        turns = _turned(x - y)
        if all(abs(difference - (turns + k) * full) > reach for k in (-1, 0, 1)):
            return True
    return False


def _first(d: Derivatives, r1: float, r2: float) -> bool:
    """Whether the first angle is to be halved: the one that the derivatives vary with more."""
    if d.short == 1:
        return r1 > 64 * r2
    if d.short == 2:
        return 64 * r1 > r2
    by1 = float(d.e11.abs_upper() + d.e21.abs_upper()) * r1
    by2 = float(d.e12.abs_upper() + d.e22.abs_upper()) * r2
    if d.short or not (isfinite(by1) and isfinite(by2)):
        return r1 >= r2
    return by1 >= by2 if max(r1, r2) < 32 * min(r1, r2) else r1 >= r2


__all__ = ["MIN_HALF_WIDTH", "TORUS", "Equilibrium", "Square", "Unproved", "equilibria"]
