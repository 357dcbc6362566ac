"""Real roots parted by halving and enclosed by Newton's interval method."""

from __future__ import annotations

import random
from itertools import pairwise

import pytest
from flint import arb, arb_poly, ctx, fmpq, fmpz_poly

from ptmcad.algebra.fibre_algebra import newton_ball
from ptmcad.algebra.real_roots import RealRoot, isolate, sign_at


def _squarefree(source: random.Random) -> fmpz_poly:
    """With small and large coefficients, and rational roots, dyadic ones among them."""
    while True:
        if source.random() < 0.5:
            bits = source.choice((3, 60, 400))
            p = fmpz_poly(
                [source.randint(-(2**bits), 2**bits) for _ in range(source.randint(2, 25))]
            )
        else:
            p = fmpz_poly([1])
            for _ in range(source.randint(1, 8)):
                bottom = source.choice((1, 2, 3, 16, 10**6))
                p *= fmpz_poly([source.randint(-2 * bottom, 2 * bottom), bottom])
        if p.degree() > 0 and p.gcd(p.derivative()).degree() == 0:
            return p


def _holds(ball: arb, p: fmpz_poly) -> bool:
    low, high = (end.fmpq() for end in (ball.lower(), ball.upper()))
    return sign_at(p, low) * sign_at(p, high) <= 0


def ball_of(root: RealRoot) -> arb:
    p = root.polynomial
    return newton_ball(arb_poly(p), arb_poly(p.derivative()), root)


@pytest.mark.parametrize("bits", [64, 128])
def test_a_ball_holds_the_root_and_is_as_narrow_as_the_precision_allows(bits: int) -> None:
    source = random.Random(bits)
    for _ in range(60):
        p = _squarefree(source)
        with ctx.workprec(bits):
            balls = [ball_of(root) for root in isolate(p, fmpq(-(10**5)), fmpq(10**5))]
        with ctx.workprec(4 * bits):
            for ball in balls:
                assert _holds(ball, p)
                assert ball.rad() * 2 ** (bits // 2) <= abs(ball.mid()) + 1


def test_roots_that_nearly_coincide_are_in_balls_of_their_own_once_the_precision_suffices() -> None:
    near = fmpz_poly([-(10**40) - 1, 10**40]) * fmpz_poly([-1, 1]) * fmpz_poly([-2, 0, 1])
    roots = isolate(near, fmpq(-2), fmpq(2))
    with ctx.workprec(400):
        balls = [ball_of(root) for root in roots]
        assert len(balls) == 4
        assert not any(a.overlaps(b) for a, b in pairwise(balls))
        assert all(_holds(ball, near) for ball in balls)
