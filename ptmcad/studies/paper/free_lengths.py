"""Equilibria with springs of a free length, proved to exist one by one by Krawczyk's test in ball arithmetic.

Guarantee: each `ProvedEquilibrium` is a box of angles with exactly one zero of the gradient, at which the Hessian is
nonsingular, and the boxes are disjoint on the torus; so their number is a lower bound of the number of equilibria.

Not guaranteed: that none is missed. The boxes start from floating-point guesses, which prove nothing.

Reference: Krawczyk, Computing 4 (1969); Neumaier, Interval Methods for Systems of Equations (1990), theorem 5.1.8.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import cos, hypot, pi, sin

from flint import arb, ctx, fmpq

GRID = 24
"""Starting points of Newton's method along each angle."""
RADIUS = fmpq(1, 10**9)
BITS = 200


@dataclass(frozen=True, slots=True)
class FreeLengthDesign:
    """rho, L1, L2 and the springs' common free length l0, in one unit; f3 = F3/k and f4 = F4/k, lengths too."""

    rho: Fraction
    length1: Fraction
    length2: Fraction
    free: Fraction
    f3: Fraction
    f4: Fraction


@dataclass(frozen=True, slots=True)
class ProvedEquilibrium:
    """A zero of the gradient within 10^-9 of ``angles``.

    Attributes
    ----------
    negative : number of the Hessian's negative eigenvalues.
    tense : whether every spring is longer than its free length; None when the box does not show it.
    """

    angles: tuple[Fraction, Fraction]
    negative: int
    tense: bool | None

    @property
    def stable(self) -> bool:
        return self.negative == 0


@dataclass(frozen=True, slots=True)
class _Derivatives:
    gradient: tuple[arb, arb]
    h11: arb
    h12: arb
    h22: arb
    lengths: tuple[arb, ...]


def _derivatives(design: FreeLengthDesign, a: arb, b: arb) -> _Derivatives:
    """Gradient and Hessian of U/k over a box of angles."""
    rho, p, q, l0, f3, f4 = (
        arb(fmpq(v.numerator, v.denominator))
        for v in (design.rho, design.length1, design.length2, design.free, design.f3, design.f4)
    )
    sa, ca, sb, cb = a.sin(), a.cos(), b.sin(), b.cos()
    zero = arb(0)
    # the vectors along the springs and their first and second derivatives; the mixed second ones are zero
    springs = (
        ((rho - q * cb, q * sb), (zero, zero), (q * sb, q * cb), (zero, zero), (q * cb, -q * sb)),
        ((rho - p * ca, -p * sa), (p * sa, -p * ca), (zero, zero), (p * ca, p * sa), (zero, zero)),
        (
            (rho - p * ca - q * cb, q * sb - p * sa),
            (p * sa, -p * ca), (q * sb, q * cb), (p * ca, p * sa), (q * cb, -q * sb),
        ),
    )  # fmt: skip
    g1, g2 = -f3 * p * ca, -f4 * q * cb
    h11, h12, h22 = f3 * p * sa, zero, f4 * q * sb
    lengths = tuple(_dot(d, d).sqrt() for d, *_ in springs)
    for (d, da, db, daa, dbb), length in zip(springs, lengths, strict=True):
        m, n = 1 - l0 / length, l0 / (length * length * length)
        along1, along2 = _dot(d, da), _dot(d, db)
        g1, g2 = g1 + m * along1, g2 + m * along2
        h11 += m * (_dot(da, da) + _dot(d, daa)) + n * along1 * along1
        h22 += m * (_dot(db, db) + _dot(d, dbb)) + n * along2 * along2
        h12 += m * _dot(da, db) + n * along1 * along2
    return _Derivatives((g1, g2), h11, h12, h22, lengths)


def _dot(u: Sequence[arb], v: Sequence[arb]) -> arb:
    return u[0] * v[0] + u[1] * v[1]


def proved_equilibrium(design: FreeLengthDesign, angles: tuple[float, float]) -> ProvedEquilibrium | None:
    """The equilibrium near two angles, proved; None when the test does not prove one."""
    with ctx.workprec(BITS):
        middle = tuple(fmpq(*x.as_integer_ratio()) for x in angles)
        radius = arb(0, arb(RADIUS))
        box = [arb(m) + radius for m in middle]
        at, over = _derivatives(design, *(arb(m) for m in middle)), _derivatives(design, *box)
        # Y is a rough inverse of the Hessian; any matrix is right, a good one lets the test succeed
        y11, y12, y22 = _rough_inverse(at)
        k1 = (1 - y11 * over.h11 - y12 * over.h12) * radius - (y11 * over.h12 + y12 * over.h22) * radius
        k2 = (1 - y12 * over.h12 - y22 * over.h22) * radius - (y12 * over.h11 + y22 * over.h12) * radius
        k1 -= y11 * at.gradient[0] + y12 * at.gradient[1]
        k2 -= y12 * at.gradient[0] + y22 * at.gradient[1]
        determinant = over.h11 * over.h22 - over.h12 * over.h12
        inside = abs(k1) < arb(RADIUS) and abs(k2) < arb(RADIUS)
        if not inside:
            return None
        if determinant < 0:
            negative = 1
        elif determinant > 0 and (over.h11 > 0 or over.h11 < 0):
            negative = 0 if over.h11 > 0 else 2
        else:
            return None
        tense = _tense(over.lengths, arb(fmpq(design.free.numerator, design.free.denominator)))
    first, second = (Fraction(int(m.p), int(m.q)) for m in middle)
    return ProvedEquilibrium((first, second), negative, tense)


def _tense(lengths: Sequence[arb], free: arb) -> bool | None:
    if any(length < free for length in lengths):
        return False
    return True if all(length > free for length in lengths) else None


def _rough_inverse(at: _Derivatives) -> tuple[arb, arb, arb]:
    h11, h12, h22 = at.h11.mid(), at.h12.mid(), at.h22.mid()
    determinant = (h11 * h22 - h12 * h12).mid()
    return (h22 / determinant).mid(), (-h12 / determinant).mid(), (h11 / determinant).mid()


def _distinct(a: ProvedEquilibrium, b: ProvedEquilibrium) -> bool:
    """Whether the two boxes are disjoint on the torus, proved: chords of the angles' differences exceed the boxes."""
    with ctx.workprec(BITS):
        for x, y in zip(a.angles, b.angles, strict=True):
            difference = x - y
            half = arb(fmpq(difference.numerator, difference.denominator)) / 2
            if abs(half.sin()) > arb(2 * RADIUS):
                return True
    return False


def proved_equilibria(design: FreeLengthDesign) -> tuple[ProvedEquilibrium, ...]:
    """Different equilibria, each proved, in the order of their angles; a lower bound of what there is."""
    found: list[ProvedEquilibrium] = []
    for guess in approximate_equilibria(design):
        proved = proved_equilibrium(design, guess)
        if proved is not None and all(_distinct(proved, other) for other in found):
            found.append(proved)
    return tuple(sorted(found, key=lambda e: e.angles))


def approximate_equilibria(design: FreeLengthDesign) -> list[tuple[float, float]]:
    """Guesses by Newton's method in floating point from a grid; they prove nothing."""
    guesses: list[tuple[float, float]] = []
    for i in range(GRID):
        for j in range(GRID):
            guess = _newton(design, (i + 0.3) * 2 * pi / GRID, (j + 0.6) * 2 * pi / GRID)
            if guess is not None and all(
                hypot(sin((guess[0] - a) / 2), sin((guess[1] - b) / 2)) > 1e-6 for a, b in guesses
            ):
                guesses.append(guess)
    return guesses


def _newton(design: FreeLengthDesign, a: float, b: float) -> tuple[float, float] | None:
    rho, p, q, l0, f3, f4 = (
        float(v) for v in (design.rho, design.length1, design.length2, design.free, design.f3, design.f4)
    )
    for _ in range(40):
        sa, ca, sb, cb = sin(a), cos(a), sin(b), cos(b)
        springs = (
            ((rho - q * cb, q * sb), (0.0, 0.0), (q * sb, q * cb), (0.0, 0.0), (q * cb, -q * sb)),
            ((rho - p * ca, -p * sa), (p * sa, -p * ca), (0.0, 0.0), (p * ca, p * sa), (0.0, 0.0)),
            ((rho - p * ca - q * cb, q * sb - p * sa), (p * sa, -p * ca), (q * sb, q * cb), (p * ca, p * sa),
             (q * cb, -q * sb)),
        )  # fmt: skip
        g1, g2, h11, h12, h22 = -f3 * p * ca, -f4 * q * cb, f3 * p * sa, 0.0, f4 * q * sb
        for d, da, db, daa, dbb in springs:
            length = hypot(*d)
            if length == 0:
                return None
            m, n = 1 - l0 / length, l0 / length**3
            u, v = d[0] * da[0] + d[1] * da[1], d[0] * db[0] + d[1] * db[1]
            g1, g2 = g1 + m * u, g2 + m * v
            h11 += m * (da[0] ** 2 + da[1] ** 2 + d[0] * daa[0] + d[1] * daa[1]) + n * u * u
            h22 += m * (db[0] ** 2 + db[1] ** 2 + d[0] * dbb[0] + d[1] * dbb[1]) + n * v * v
            h12 += m * (da[0] * db[0] + da[1] * db[1]) + n * u * v
        determinant = h11 * h22 - h12 * h12
        if determinant == 0:
            return None
        step1, step2 = (h22 * g1 - h12 * g2) / determinant, (h11 * g2 - h12 * g1) / determinant
        if not hypot(step1, step2) < 1e6:
            return None
        a, b = a - step1, b - step2
        if hypot(step1, step2) < 1e-13:
            return (a + pi) % (2 * pi) - pi, (b + pi) % (2 * pi) - pi
    return None
