"""Integrals of branches whose antiderivatives are known, over panels beside points where a branch
is not analytic.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import pytest
from flint import Ordering, arb, ctx, fmpq, fmpz_mpoly_ctx, fmpz_poly
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples
from support.few import few

from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.rootcounts import numbered_root
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
        IntegralEffort(arb(2) ** -60, fmpq(1, 10**12), HEIGHTS, ends),
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
            height = WallSeries.of(curve, number).height(share, fmpq(-3), fmpq(3))
            assert height is not None
            assert height.overlaps(root)
            assert height.rad() < 2**-60
        assert WallSeries.of(curve, 6).height(share, fmpq(-3), fmpq(3)) is None
        # from a height between them only those above it are counted
        above = WallSeries.of(curve, 0).height(share, fmpq(0), fmpq(3))
        assert above is not None
        assert above.overlaps(roots[0])


Terms = list[tuple[int, int, int]]
EFFORT = IntegralEffort(arb(2) ** -30, fmpq(1, 10**12), HEIGHTS, HEIGHTS)
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
    "upright inflection: v^3 = 2 u": (
        [(0, 3, 1), (1, 0, -2)],
        0,
        lambda u: (2 * u).root(3) * u * 3 / 4,
    ),
    "blunt cusp beside a line: (v + u)^3 = u^4": (
        [(0, 3, 1), (1, 2, 3), (2, 1, 3), (3, 0, 1), (4, 0, -1)],
        0,
        lambda u: -u * u / 2 + u * u * u.root(3) * 3 / 7,
    ),
    "cusp of branches that touch: (v - u^2)^2 = u^5": (
        [(0, 2, 1), (2, 1, -2), (4, 0, 1), (5, 0, -1)],
        0,
        lambda u: u**3 / 3 - u**3 * u.sqrt() * 2 / 7,
    ),
}


def branch_of(terms: Terms, root: int) -> WallSeries:
    return WallSeries.of(PlaneCurve.of(0, PlanePolynomial.of(terms), 0), root)


@pytest.mark.parametrize("name", POINTS)
def test_panels_that_are_halved_come_near_to_a_critical_value(name: str) -> None:
    """Where the branch is not analytic, or meets others: few panels are needed for 1e-7."""
    terms, root, antiderivative = POINTS[name]
    branch, total, number = branch_of(terms, root), arb(0), 0
    with ctx.workprec(128):
        waiting = [(NEAR, FAR, True)]
        while waiting:
            left, right, whole = waiting.pop()
            number += 1
            for part in integrals_over(branch, left, right, EFFORT):
                if part.integral.rad() < arb(2) ** -26:
                    total += part.integral + HEIGHTS[0] * (part.right - part.left)
                elif whole and part.tried:
                    middle = (part.left + part.right) / 2
                    waiting += [(part.left, middle, True), (middle, part.right, True)]
                else:
                    waiting.append((part.left, part.right, True))
        assert number < 200
        assert total.overlaps(antiderivative(arb(FAR)) - antiderivative(arb(NEAR)))
        assert total.rad() < 1e-6


def test_a_root_is_found_in_a_window_of_any_size() -> None:
    far = fmpq(10) ** 300
    for p, expected in (
        (fmpz_poly([-1, 3]), [fmpq(1, 3)]),
        (fmpz_poly([-6, 11, -6, 1]), [fmpq(1), fmpq(2), fmpq(3)]),
        (fmpz_poly([0, -(10**40), 1]), [fmpq(0), fmpq(10**40)]),
        (fmpz_poly([-1, 0, 10**40]), [fmpq(-1, 10**20), fmpq(1, 10**20)]),
        (fmpz_poly([1, 0, 1]), []),
    ):
        for number, value in enumerate(expected):
            found = numbered_root(p, -far, far, number)
            assert found is not None
            assert abs(found - value) < arb(2) ** -40 * abs(arb(value)) + arb(2) ** -400
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


MEETINGS = (
    "turning point",
    "turning point, lower branch",
    "turning point below another branch",
    "node",
    "cusp",
    "upright cusp",
)
ROOM = fmpq(1, 10**12)
"""Beside the critical value, which `ROOM` is left out of, as of a stack."""


def part_beside(
    terms: Terms, root: int, at: fmpq, far: fmpq, error: fmpq, heights: tuple[fmpq, fmpq]
) -> list[PanelPart]:
    """What is proved from a critical value on of a branch, whose critical value is known but for an
    error.
    """
    near = at + ROOM * (1 if far > at else -1)
    effort = IntegralEffort(arb(2) ** -40, fmpq(1, 10**15), heights, (at + error, at + error))
    run = -2 if far > at else 2
    return integrals_over(branch_of(terms, root), min(near, far), max(near, far), effort, run)


@pytest.mark.parametrize("error", [fmpq(0), fmpq(1, 10**30), fmpq(-1, 10**30)])
@pytest.mark.parametrize("name", [name for name in POINTS if name.split(":")[0] in MEETINGS])
def test_one_series_reaches_a_point_at_which_branches_meet(name: str, error: fmpq) -> None:
    terms, root, antiderivative = POINTS[name]
    with ctx.workprec(128):
        first = part_beside(terms, root, fmpq(0), fmpq(1, 16), error, HEIGHTS)[0]
        assert (first.tried, first.left) == (True, ROOM)
        assert first.right > fmpq(1, 17)
        expected = antiderivative(arb(first.right)) - antiderivative(arb(first.left))
        assert first.integral.overlaps(expected - HEIGHTS[0] * (first.right - first.left))
        assert first.integral.rad() < 1e-9


@pytest.mark.parametrize("error", [fmpq(0), fmpq(1, 10**30), fmpq(-1, 10**30)])
@pytest.mark.parametrize("number", range(4))
def test_branches_stay_near_to_a_point_at_which_many_meet(number: int, error: fmpq) -> None:
    """Two pairs that touch: v = +-u^3 +- u^(11/2)."""
    terms = [(0, 4, 1), (6, 2, -2), (11, 2, -2), (12, 0, 1), (17, 0, -2), (22, 0, 1)]
    outer, inner = (-1, 1)[number > 1], (-1, 1)[number in (1, 3)]
    far = arb(1) / 16
    with ctx.workprec(128):
        (part,) = part_beside(terms, number, fmpq(0), fmpq(1, 16), error, HEIGHTS)
        assert (part.left, part.right, part.run) == (ROOM, fmpq(1, 16), -1)
        expected = outer * far**4 / 4 + inner * far**6 * far.sqrt() * 2 / 13
        assert part.integral.contains(expected - HEIGHTS[0] * (part.right - part.left))
        assert part.integral.rad() < 1e-4


def turned(kind: str, a: int, b: int, c: int, d: int, p: int, q: int) -> tuple[Terms, fmpq, fmpq]:
    """A fold, node or cusp at (p/8, q/8) on a curve that goes on as a polynomial: its terms, and
    the point.

    In x and y, eight times the differences from the point: the fold is on x = y^2 (1 + a y/32)/8,
    the node on the product of the lines y = c x and y = d x, plus b/8 times the cube of x. The
    cusps are on (y - c x)^2 = x^3 (1 - b x)/8, and on y^3 (1 - a y/64) = x^2 (1 + b x/8)/8.
    """
    ring = fmpz_mpoly_ctx.get(("u", "v"), Ordering.lex)
    x, y = 8 * ring.gen(0) - p, 8 * ring.gen(1) - q
    curve = {
        "fold": 32 * 8 * x - 32 * y * y - a * y * y * y,
        "node": 8 * (y - c * x) * (y - d * x) + b * x * x * x,
        "cusp": 8 * (y - c * x) ** 2 - x**3 + b * x**4,
        "upright cusp": 64 * y**3 - a * y**4 - 8 * x * x - b * x * x * x,
    }[kind]
    return [(int(i), int(j), int(k)) for (i, j), k in curve.terms()], fmpq(p, 8), fmpq(q, 8)


@settings(deadline=None, max_examples=examples(40))
@given(
    a=st.integers(-8, 8), b=st.integers(-3, 3),
    slopes=st.lists(st.integers(-3, 3), min_size=2, max_size=2, unique=True),
    place=st.tuples(st.integers(-8, 8), st.integers(-8, 8)), side=st.sampled_from([1, -1]), lower=st.booleans(),
    error=st.sampled_from([0, 1, -1]), kind=st.sampled_from(["fold", "node", "cusp", "upright cusp"]),
)  # fmt: skip
def test_areas_beside_points_at_which_branches_meet_are_those_of_many_strips(
    a: int,
    b: int,
    slopes: list[int],
    place: tuple[int, int],
    side: int,
    lower: bool,
    error: int,
    kind: str,
) -> None:
    """Against sums of the branch's heights, each found by counting roots: bounds of an integral of
    what is monotone.
    """
    terms, u, v = turned(kind, a, b, *sorted(slopes), *place)
    side = 1 if kind in ("fold", "cusp") else side
    heights = (v - fmpq(1, 4), v + fmpq(1, 4))
    far, near, number = (
        u + side * fmpq(1, 64),
        u + side * ROOM,
        0 if lower or kind == "upright cusp" else 1,
    )
    with ctx.workprec(128):
        branch = branch_of(terms, number)
        found = part_beside(terms, number, u, far, fmpq(error, 10**30), heights)
        assert sum((p.right - p.left for p in found), fmpq(0)) == abs(far - near)
        first = found[0]
        strips = 64
        width = (first.right - first.left) / strips
        at = [
            height
            for k in range(strips + 1)
            if (height := branch.height(first.left + k * width, *heights)) is not None
        ]
        assert len(at) == strips + 1
        low, high = (
            sum((pick(*ends) for ends in pairwise(at)), arb(0)) * width for pick in (min, max)
        )
        floor = heights[0] * (first.right - first.left)
        assert not first.integral + floor < low
        assert not first.integral + floor > high
        assert near in (first.left, first.right)
        assert first.tried
        assert first.integral.rad() < 1e-9
