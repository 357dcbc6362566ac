"""Branches beside places where they turn, meet or have a cusp: integrals that are known in closed
form.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import pytest
from flint import arb, ctx, fmpq, fmpz_poly

from ptmcad.algebra import puiseux
from ptmcad.algebra.puiseux import Beside, puiseux_integral
from ptmcad.algebra.real_roots import RealRoot, isolate, refine
from ptmcad.text.flint_numbers import from_fraction

FIBRE = (fmpq(-3), fmpq(3))
BITS = 220
# the curves are in t = u^2 - 2, so that t = 0 is at the irrational abscissa sqrt 2, or in t = u - 1
IRRATIONAL, RATIONAL = fmpz_poly([-2, 0, 1]), fmpz_poly([-1, 1])

FOLD = [{1: -1}, {}, {0: 1}]
CUSP = [{3: -1}, {}, {0: 1}]
UPRIGHT_CUSP = [{2: -1}, {}, {}, {0: 1}]
SLANTED_CUSP = [{2: 1, 3: -1}, {1: -2}, {0: 1}]
NODE = [{2: -1, 3: -1}, {}, {0: 1}]
INFLEXION = [{1: -1}, {}, {}, {0: 1}]
SIMPLE = [{1: -1}, {0: 1}]


def curve(rows: Sequence[dict[int, int]], t: fmpz_poly) -> list[fmpz_poly]:
    """Coefficients in Z[u], from those of powers of t."""
    return [sum((t**k * c for k, c in row.items()), fmpz_poly([0])) for row in rows]


def root_over(in_v: Sequence[fmpz_poly], u: fmpq, number: int) -> RealRoot:
    at = [fmpq(c(u)) for c in in_v]
    common = 1
    for value in at:
        common *= int(value.q)
    return isolate(fmpz_poly([int((v * common).p) for v in at]), *FIBRE)[number]


def beside(t: fmpz_poly, near: Fraction, far: Fraction) -> Beside:
    (c,) = isolate(t, fmpq(0), fmpq(3))
    c = refine(c, fmpq(1, 2**BITS))
    numbers = (from_fraction(x) for x in (near, far))
    return Beside(arb(c.low).union(arb(c.high)), *numbers)


def riemann(in_v: Sequence[fmpz_poly], low: fmpq, high: fmpq, number: int) -> tuple[arb, arb]:
    """Bounds of a monotone branch's integral, by rectangles."""
    parts = 400
    step = (high - low) / parts
    heights = [
        refine(root_over(in_v, low + step * k, number), fmpq(1, 10**9)).middle
        for k in range(parts + 1)
    ]
    sums = [sum(heights[:-1], fmpq(0)) * step, sum(heights[1:], fmpq(0)) * step]
    return arb(min(sums)) - arb(step) / 10**6, arb(max(sums)) + arb(step) / 10**6


@pytest.mark.parametrize("t", [IRRATIONAL, RATIONAL], ids=["irrational", "rational"])
@pytest.mark.parametrize(
    ("rows", "number", "right"),
    [
        (FOLD, 0, True),
        (FOLD, 1, True),
        (CUSP, 1, True),
        (UPRIGHT_CUSP, 0, True),
        (UPRIGHT_CUSP, 0, False),
        (SLANTED_CUSP, 0, True),
        (SLANTED_CUSP, 1, True),
        (NODE, 1, True),
        (NODE, 0, False),
        (INFLEXION, 0, False),
        (SIMPLE, 0, True),
    ],
)
@pytest.mark.fast_cases("rows10-0-True-irrational", "rows10-0-True-rational")
def test_integrals_beside_a_singular_point(
    rows: Sequence[dict[int, int]], number: int, right: bool, t: fmpz_poly
) -> None:
    in_v = curve(rows, t)
    c = Fraction(14142, 10000) if t == IRRATIONAL else Fraction(1)
    near, far = (
        (c + Fraction(1, 10**4), c + Fraction(6, 100))
        if right
        else (c - Fraction(1, 10**4), c - Fraction(6, 100))
    )
    with ctx.workprec(BITS):
        found = puiseux_integral(
            in_v, beside(t, near, far), lambda u: root_over(in_v, u, number), 24, fmpq(1, 10**9)
        )
        assert found is not None
        value, cut = found
        assert value.rad() < arb(fmpq(1, 10**9))
        low, high = sorted((from_fraction(near), cut))
        assert high - low > fmpq(1, 50)
        least, most = riemann(in_v, low, high, number)
        assert least < value < most


def test_another_branch_in_the_tube_is_not_taken_for_the_one_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever leads to a tube, the root over its far end decides."""
    in_v = curve(FOLD, IRRATIONAL)
    straightened = puiseux._straightened
    with ctx.workprec(BITS):
        place = beside(IRRATIONAL, Fraction(14143, 10000), Fraction(147, 100))
        other = straightened(in_v, place, lambda u: root_over(in_v, u, 0))
        monkeypatch.setattr(puiseux, "_straightened", lambda *_: other)
        assert (
            puiseux_integral(in_v, place, lambda u: root_over(in_v, u, 0), 24, fmpq(1, 10**9))
            is not None
        )
        assert (
            puiseux_integral(in_v, place, lambda u: root_over(in_v, u, 1), 24, fmpq(1, 10**9))
            is None
        )
