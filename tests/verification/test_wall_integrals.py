"""Integrals of branches whose antiderivatives are known, over panels beside points where a branch
is not analytic.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from flint import arb, ctx, fmpq, fmpz_poly

from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification import sturm
from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.sturm import numbered_root
from ptmcad.verification.wallintegrals import IntegralEffort, PanelPart, WallSeries, integrals_over

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
PANELS = [
    (fmpq(1, 4), fmpq(7, 4)),
    (fmpq(1, 100), fmpq(9, 10)),
    (fmpq(1, 2), fmpq(3, 5)),
    (fmpq(1, 10**6), fmpq(1, 2)),
]


def parts(name: str, sign: int, ends: tuple[fmpq, fmpq]) -> list[PanelPart]:
    plane = PlanePolynomial.of(CURVES[name][0])
    branch = WallSeries.of(
        PlaneCurve.of(0, plane, 0), 1 if sign > 0 and name.startswith(("v^2", "100 v^2")) else 0
    )
    return integrals_over(
        branch,
        *ends,
        IntegralEffort(arb(2) ** -60, fmpq(1, 10**12), HEIGHTS, (2, 10), ends),
    )


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
def test_integrals_contain_the_differences_of_antiderivatives(
    name: str, sign: int, ends: tuple[fmpq, fmpq]
) -> None:
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


Terms = list[tuple[int, int, int]]
EFFORT = IntegralEffort(arb(2) ** -30, fmpq(1, 10**12), HEIGHTS, (2, 10), HEIGHTS)
NEAR, FAR = fmpq(1, 10**9), fmpq(1, 2)
POINTS: dict[str, tuple[Terms, int, Callable[[arb], arb]]] = {
    "turning point: v^2 = u": ([(0, 2, 1), (1, 0, -1)], 1, lambda u: u * u.sqrt() * 2 / 3),
    "turning point, lower branch": ([(0, 2, 1), (1, 0, -1)], 0, lambda u: -u * u.sqrt() * 2 / 3),
    "turning point below another branch": (
        [(0, 3, 1), (1, 1, -1), (0, 2, -2), (1, 0, 2)],
        1,
        lambda u: u * u.sqrt() * 2 / 3,
    ),
    "node: v^2 = u^2 (1 + u)": (
        [(0, 2, 1), (2, 0, -1), (3, 0, -1)],
        1,
        lambda u: (1 + u) ** 2 * (1 + u).sqrt() * 2 / 5 - (1 + u) * (1 + u).sqrt() * 2 / 3,
    ),
    "cusp: (v - u)^2 = u^3": (
        [(0, 2, 1), (1, 1, -2), (2, 0, 1), (3, 0, -1)],
        1,
        lambda u: u * u / 2 + u * u * u.sqrt() * 2 / 5,
    ),
    "upright cusp: v^3 = u^2": ([(0, 3, 1), (2, 0, -1)], 0, lambda u: (u**5).root(3) * 3 / 5),
}


def branch_of(terms: Terms, root: int) -> WallSeries:
    return WallSeries.of(PlaneCurve.of(0, PlanePolynomial.of(terms), 0), root)


def test_a_root_is_found_in_a_window_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """In few steps: the window is cut to what may hold roots at first."""
    asked, true = [], sturm.roots_above

    def counted(coefficients: tuple[int, ...], at: fmpq) -> int:
        asked.append(at)
        return true(coefficients, at)

    monkeypatch.setattr(sturm, "roots_above", counted)
    far = fmpq(10) ** 300
    for p, expected in (
        (fmpz_poly([-1, 3]), [fmpq(1, 3)]),
        (fmpz_poly([-6, 11, -6, 1]), [fmpq(1), fmpq(2), fmpq(3)]),
        (fmpz_poly([0, -(10**40), 1]), [fmpq(0), fmpq(10**40)]),
        (fmpz_poly([-1, 0, 10**40]), [fmpq(-1, 10**20), fmpq(1, 10**20)]),
        (fmpz_poly([1, 0, 1]), []),
    ):
        for number, value in enumerate(expected):
            asked.clear()
            sturm._counted_above.cache_clear()
            found = numbered_root(p, -far, far, number)
            assert found is not None
            assert abs(found - value) < arb(2) ** -40 * abs(arb(value)) + arb(2) ** -400
            assert len(asked) < 12
            assert numbered_root(p, value, far, len(expected) - number - 1) is None
        assert numbered_root(p, -far, far, len(expected)) is None
        assert numbered_root(p, far / 2, far, 0) is None


def test_precision_that_rounding_uses_up_is_asked_for() -> None:
    """At 40 bits, branches 1e-6 apart; with more bits the panel is proved."""
    apart = 10**12  # (v - u)^2 = 1 / apart
    branch = branch_of([(0, 2, apart), (1, 1, -2 * apart), (2, 0, apart), (0, 0, -1)], 1)
    with ctx.workprec(40):
        found = integrals_over(branch, fmpq(1, 4), fmpq(1, 2), EFFORT)
    expected = fmpq(3, 32) + fmpq(1, 4 * 10**6) + 3 * fmpq(1, 4)
    assert [p.tried for p in found] == [True]
    assert abs(found[0].integral - expected) < fmpq(1, 10**8)


ROOM = fmpq(1, 10**12)
"""Beside the critical value, which `ROOM` is left out of, as of a stack."""


def part_beside(
    terms: Terms, root: int, at: fmpq, far: fmpq, error: fmpq, heights: tuple[fmpq, fmpq]
) -> list[PanelPart]:
    """What is proved from a critical value on of a branch, whose critical value is known but for an
    error.
    """
    near = at + ROOM * (1 if far > at else -1)
    effort = IntegralEffort(arb(2) ** -40, fmpq(1, 10**15), heights, (2,), (at + error, at + error))
    run = -2 if far > at else 2
    return integrals_over(branch_of(terms, root), min(near, far), max(near, far), effort, run)


@pytest.mark.parametrize("error", [fmpq(0), fmpq(1, 10**30), fmpq(-1, 10**30)])
@pytest.mark.parametrize("name", POINTS)
def test_one_series_reaches_a_point_at_which_branches_meet(name: str, error: fmpq) -> None:
    terms, root, antiderivative = POINTS[name]
    with ctx.workprec(128):
        first = part_beside(terms, root, fmpq(0), fmpq(1, 16), error, HEIGHTS)[0]
        assert (first.tried, first.left) == (True, ROOM)
        assert first.right > fmpq(1, 17)
        expected = antiderivative(arb(first.right)) - antiderivative(arb(first.left))
        assert first.integral.overlaps(expected - HEIGHTS[0] * (first.right - first.left))
        assert first.integral.rad() < 1e-9
