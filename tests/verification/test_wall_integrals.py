"""Integrals of branches whose antiderivatives are known, over panels beside points where a branch is not analytic."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from flint import arb, ctx, fmpq
from support.few import few

from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.branches import Branch, Effort, Part, integrals_over
from ptmcad.verification.claims import PlaneCurve

HEIGHTS = (fmpq(-3), fmpq(3))


def parabola(u: arb) -> arb:
    """Of sqrt(u)."""
    return u * u.sqrt() * 2 / 3


def half_circle(u: arb) -> arb:
    """Of sqrt(1 - u^2)."""
    return (u * (1 - u * u).sqrt() + u.asin()) / 2


def hyperbola(u: arb) -> arb:
    """Of sqrt(u^2 + 1/100)."""
    root = (u * u + arb(1) / 100).sqrt()
    return (u * root + (u + root).log() / 100) / 2


def cubic(u: arb) -> arb:
    """Of (2 u)^(1/3), whose polynomial is none in v^2."""
    return (2 * u).root(3) * u * 3 / 4


CURVES: dict[str, tuple[list[tuple[int, int, int]], Callable[[arb], arb]]] = {
    "v^2 = u": ([(0, 2, 1), (1, 0, -1)], parabola),
    "v^2 + u^2 = 1": ([(0, 2, 1), (2, 0, 1), (0, 0, -1)], half_circle),
    "100 v^2 = 100 u^2 + 1": ([(0, 2, 100), (2, 0, -100), (0, 0, -1)], hyperbola),
    "v^3 = 2 u": ([(0, 3, 1), (1, 0, -2)], cubic),
}
PANELS = [(fmpq(1, 4), fmpq(7, 4)), (fmpq(1, 100), fmpq(9, 10)), (fmpq(1, 2), fmpq(3, 5)), (fmpq(1, 10**6), fmpq(1, 2))]


def parts(name: str, sign: int, ends: tuple[fmpq, fmpq]) -> list[Part]:
    plane = PlanePolynomial.of(CURVES[name][0])
    branch = Branch.of(PlaneCurve.of(0, plane, 0), 1 if sign > 0 and name.startswith(("v^2", "100 v^2")) else 0)
    return integrals_over(branch, *ends, Effort(arb(2) ** -60, fmpq(1, 10**9), fmpq(1, 10**12), HEIGHTS, (2, 10)))


@pytest.mark.parametrize(
    ("name", "sign", "ends"),
    [
        (name, sign, ends)
        for name in CURVES
        for sign in (1, -1)
        for ends in PANELS
        if not (name == "v^2 + u^2 = 1" and ends[1] > 1) and not (name == "v^3 = 2 u" and sign < 0)
    ],
)
def test_integrals_contain_the_differences_of_antiderivatives(name: str, sign: int, ends: tuple[fmpq, fmpq]) -> None:
    with ctx.workprec(128):
        found = parts(name, sign, ends)
        assert found[0].tried
        assert min(p.left for p in found) == ends[0]
        assert max(p.right for p in found) == ends[1]
        assert sum((p.right - p.left for p in found), fmpq(0)) == ends[1] - ends[0]
        proved, *rest = found
        expected = sign * (CURVES[name][1](arb(proved.right)) - CURVES[name][1](arb(proved.left)))
        expected -= HEIGHTS[0] * (proved.right - proved.left)
        assert proved.integral.overlaps(expected)
        assert proved.integral.rad() < arb(2) ** -50
        assert not any(p.tried for p in rest)


@pytest.mark.parametrize("share", few([fmpq(k, 7) for k in range(1, 7)], fmpq(3, 7)))
def test_heights_are_the_roots_that_were_asked_for(share: fmpq) -> None:
    """Of (v^2 - u)(v^2 - 2)(v^2 - u - 1), which has six branches, from below."""
    plane = PlanePolynomial.of(
        [(0, 6, 1), (1, 4, -2), (0, 4, -3), (2, 2, 1), (1, 2, 5), (0, 2, 2), (2, 0, -2), (1, 0, -2)]
    )
    curve = PlaneCurve.of(0, plane, 0)
    with ctx.workprec(128):
        roots = [(arb(value)).sqrt() for value in (share, share + 1, fmpq(2))]
        expected = [-root for root in reversed(roots)] + roots
        for number, root in enumerate(expected):
            height = Branch.of(curve, number).height(share, fmpq(-3), fmpq(3))
            assert height is not None
            assert height.overlaps(root)
            assert height.rad() < 2**-60
        assert Branch.of(curve, 6).height(share, fmpq(-3), fmpq(3)) is None
        # from a height between them only those above it are counted
        above = Branch.of(curve, 0).height(share, fmpq(0), fmpq(3))
        assert above is not None
        assert above.overlaps(roots[0])
