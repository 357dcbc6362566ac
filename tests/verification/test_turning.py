"""Integrals of branches by one series about a critical value, and by a mirror image, against known antiderivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import pytest
from flint import arb, ctx, fmpq, fmpz_poly

from ptmcad.text.plane import PlanePolynomial
from ptmcad.verification import roots, sturm, turning
from ptmcad.verification.branches import Branch, Effort
from ptmcad.verification.claims import PlaneCurve
from ptmcad.verification.disks import disk
from ptmcad.verification.places import Place, at_edge, beyond
from ptmcad.verification.roots import numbered_root
from ptmcad.verification.turning import Beside, integral_beside
from ptmcad.verification.walls import Wall, image_of, reflection

HEIGHTS = (fmpq(-3), fmpq(3))
EFFORT = Effort(arb(2) ** -60, fmpq(1, 10**9), fmpq(1, 10**12), HEIGHTS, (2, 10))
NEAR, FAR = fmpq(1, 10**14), fmpq(1, 2)
Terms = list[tuple[int, int, int]]

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
    "upright inflection: v^3 = 2 u": ([(0, 3, 1), (1, 0, -2)], 0, lambda u: (2 * u).root(3) * u * 3 / 4),
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

AFAR: dict[str, tuple[Terms, int, int, Callable[[arb], arb]]] = {
    "one over u: u v = 1": ([(1, 1, 1), (0, 0, -1)], 1, 0, lambda u: u.log()),
    "its left half": ([(1, 1, 1), (0, 0, -1)], -1, 0, lambda u: (-u).log()),
    "a power: v^3 = u^2": ([(0, 3, 1), (2, 0, -1)], 1, 0, lambda u: (u**5).root(3) * 3 / 5),
    "a hyperbola: v^2 = u^2 + 2": (
        [(0, 2, 1), (2, 0, -1), (0, 0, -2)],
        1,
        1,
        lambda u: (u * (u * u + 2).sqrt()) / 2 + (u + (u * u + 2).sqrt()).log(),
    ),
    "parallels: (v - u)^2 = 1 + 1 / u": (
        [(1, 2, 1), (2, 1, -2), (3, 0, 1), (1, 0, -1), (0, 0, -1)],
        1,
        1,
        lambda u: u * u / 2 + (u * (u + 1)).sqrt() + (u.sqrt() + (u + 1).sqrt()).log(),
    ),
    "branches that come closer: (v - u)^2 u = 1": (
        [(1, 2, 1), (2, 1, -2), (3, 0, 1), (0, 0, -1)],
        1,
        0,
        lambda u: u * u / 2 - 2 * u.sqrt(),
    ),
}
"""By what they are: terms, the side of zero, the root's number, an antiderivative."""


def branch_of(terms: Terms, root: int) -> Branch:
    return Branch.of(PlaneCurve.of(0, PlanePolynomial.of(terms), 0), root)


@pytest.mark.parametrize("name", POINTS)
def test_one_series_holds_the_integral_from_beside_a_critical_value(name: str) -> None:
    terms, root, antiderivative = POINTS[name]
    with ctx.workprec(128):
        found = integral_beside(branch_of(terms, root), Beside(lambda _: arb(0), NEAR, FAR), NEAR, EFFORT)
        assert found is not None
        integral, reached = found
        assert NEAR < reached <= FAR
        expected = antiderivative(arb(reached)) - antiderivative(arb(NEAR))
        assert integral.overlaps(expected)
        assert integral.rad() < arb(2) ** -50


@pytest.mark.parametrize("name", AFAR)
def test_one_series_holds_the_integral_from_afar(name: str) -> None:
    """From 10^30 as near to zero as one series reaches, with an error of 2^-50 units; four of them are enough."""
    terms, sign, root, antiderivative = AFAR[name]
    near, far = sign * fmpq(10) ** 30, sign * fmpq(1)
    effort = replace(EFFORT, heights=(-(fmpq(10) ** 31), fmpq(10) ** 31))
    with ctx.workprec(320):
        found = integral_beside(branch_of(terms, root), Beside(None, near, far), fmpq(1, 10**30), effort)
        assert found is not None
        integral, reached = found
        assert 1 <= abs(reached) <= 16**2
        expected = sign * (antiderivative(arb(near)) - antiderivative(arb(reached)))
        assert integral.overlaps(expected)
        assert integral.rad() < arb(2) ** -50


def test_a_branch_that_is_not_analytic_up_to_there_is_not_taken_from_afar() -> None:
    """(v - u)^2 = u^2 - 10^6 has no real branch near zero, v^2 = u^2 - u + 1000 one with complex turning points."""
    with ctx.workprec(128):
        effort = replace(EFFORT, heights=(fmpq(0), fmpq(10) ** 7))
        beside = Beside(None, fmpq(10) ** 6, fmpq(1))
        none = branch_of([(0, 2, 1), (1, 1, -2), (0, 0, 10**6)], 0)
        assert integral_beside(none, beside, fmpq(1, 10**6), effort) is None
        far = branch_of([(0, 2, 1), (2, 0, -1), (1, 0, 1), (0, 0, -1000)], 0)
        assert integral_beside(far, beside, fmpq(1, 10**6), effort) is None
        found = integral_beside(far, beside._replace(far=fmpq(2**8)), fmpq(2**16, 10**6), effort)
        assert found is not None
        assert found[1] ** 2 > 1000


def test_a_critical_value_known_in_a_ball_is_enough() -> None:
    """Of v^2 = u^2 - 2 to the right of sqrt 2."""
    branch = branch_of([(0, 2, 1), (2, 0, -1), (0, 0, 2)], 1)
    with ctx.workprec(128):
        near, far = fmpq(1414213562373096, 10**15), fmpq(3, 2)

        def known(width: fmpq) -> arb:
            return arb(2).sqrt() + arb(width) * arb(0).union(arb(1)) / 4

        found = integral_beside(branch, Beside(known, near, far), fmpq(1, 10**15), EFFORT)
        assert found is not None

        def antiderivative(u: arb) -> arb:
            root = (u * u - 2).sqrt()
            return (u * root - 2 * (u + root).log()) / 2

        assert found[0].overlaps(antiderivative(arb(found[1])) - antiderivative(arb(near)))
        assert found[0].rad() < arb(2) ** -40


def test_another_branch_is_not_taken_for_the_one_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """The series belongs to the upper branch, whose height is asked for first; at the cut the height is another."""
    terms, root, _ = POINTS["turning point: v^2 = u"]
    branch, other = branch_of(terms, root), branch_of(terms, 0)
    with ctx.workprec(128):
        heights = [branch.height(NEAR, *HEIGHTS), branch.height(FAR, *HEIGHTS), other.height(FAR, *HEIGHTS)]
        given = iter(heights)
        monkeypatch.setattr(Branch, "height", lambda *_: next(given))
        assert turning._enclosed(branch, Beside(lambda _: arb(0), NEAR, FAR), EFFORT) is None


def test_what_is_left_out_of_the_polynomial_counts_as_error() -> None:
    """A disk for p that holds with an addition of up to 1/1000 contains the root of p with one."""
    branch = branch_of([(0, 2, 1), (1, 0, -1), (0, 0, -1)], 1)  # v^2 = 1 + u
    with ctx.workprec(128):
        alone = disk(branch.value, fmpq(1, 8), arb(1), 2)
        found = disk(branch.value, fmpq(1, 8), arb(1), 2, (arb(1) / 1000, arb(4)))
        assert alone is not None
        assert found is not None
        assert alone.reach < found.reach
        for addition in (arb(1) / 1000, -arb(1) / 1000):
            moved = abs((1 - addition).sqrt() - 1)
            assert moved < found.reach
            assert moved < 2 * found.spread / 1000
        assert disk(branch.value, fmpq(1, 8), arb(1), 2, (arb(10), arb(4))) is None


def wall(branch: Branch, span: tuple[fmpq, fmpq], places: tuple[Sequence[Place], Sequence[Place]] = ((), ())) -> Wall:
    image = image_of(branch, (span[0] + span[1]) / 2, HEIGHTS)
    return Wall(branch, span, places, fmpq(1, 10**9), arb(2) ** -60, image, fmpq(1))


def test_the_image_of_a_wall_has_the_integral_that_its_own_series_has() -> None:
    """(v - u)^2 = 1 + u^2, which (u, v) to (u, 2 u - v) maps to itself."""
    terms = [(0, 2, 1), (1, 1, -2), (0, 0, -1)]
    span = fmpq(1, 4), fmpq(1, 2)
    with ctx.workprec(128):
        lower, upper = (wall(branch_of(terms, n), span) for n in (0, 1))
        assert lower.image is not None
        assert lower.image[0] == 1
        first = upper.parts(*span, EFFORT, {})
        own = lower.parts(*span, EFFORT, {})
        mirrored = lower.parts(*span, EFFORT, {(0, 1, *span): first})
        assert [(p.left, p.right, p.tried) for p in mirrored] == [(p.left, p.right, p.tried) for p in own]
        for a, b in zip(mirrored, own, strict=True):
            assert a.integral.overlaps(b.integral)
            assert a.integral.rad() < arb(2) ** -50


def test_a_pole_beyond_the_end_of_a_stack_is_what_its_series_is_about() -> None:
    """v^2 (u + 10^-9) = 1: up to the pole's neighbourhood there would be a panel for each doubling of the distance."""
    branch = branch_of([(1, 2, 10**9), (0, 2, 1), (0, 0, -(10**9))], 0)
    span, effort = (fmpq(0), fmpq(1)), replace(EFFORT, heights=(fmpq(0), fmpq(10**5)))
    poles = [*beyond(branch.curve, span, 0)]
    assert len(poles) == 1
    assert poles[0].abscissa(fmpq(1, 10**20)).overlaps(arb(fmpq(-1, 10**9)))
    assert poles[0].gap == 0
    assert not [*beyond(branch.curve, span, 1)]
    with ctx.workprec(192):
        found = wall(branch, span, (poles, ())).parts(*span, effort, {})
        proved = [p for p in found if p.tried]
        assert min(p.left for p in proved) == 0
        rest = sum((p.right - p.left for p in found if not p.tried), fmpq(0))
        assert rest < fmpq(9, 10)
        for p in proved:
            expected = 2 * (arb(p.right + fmpq(1, 10**9)).sqrt() - arb(p.left + fmpq(1, 10**9)).sqrt())
            assert p.integral.overlaps(expected)
            assert p.integral.rad() < arb(2) ** -40


def test_an_edge_of_the_window_is_such_a_place_where_branches_meet_over_it() -> None:
    curve = branch_of([(0, 2, 1), (1, 0, -1)], 0).curve  # v^2 = u
    (place,) = at_edge(curve, fmpq(0), fmpq(1, 10**12))
    assert place.abscissa(fmpq(1)) == 0
    assert place.gap == fmpq(1, 10**12)
    assert at_edge(curve, fmpq(1), fmpq(1, 10**12)) == []
    assert at_edge(branch_of([(1, 1, 1), (0, 0, -1)], 0).curve, fmpq(0), fmpq(1, 10**12))  # u v = 1


def test_a_root_is_found_in_a_window_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """In few steps: the window is cut to what may hold roots at first."""
    asked = []

    def changes_of(p: fmpz_poly) -> Callable[[fmpq], int]:
        changes = sturm.changes_of(p)

        def counted(at: fmpq) -> int:
            asked.append(at)
            return changes(at)

        return counted

    monkeypatch.setattr(roots, "changes_of", changes_of)
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
            roots._changes_of.cache_clear()
            found = numbered_root(p, -far, far, number)
            assert found is not None
            assert abs(found - value) < arb(2) ** -40 * abs(arb(value)) + arb(2) ** -400
            assert len(asked) < 12
            assert numbered_root(p, value, far, len(expected) - number - 1) is None
        assert numbered_root(p, -far, far, len(expected)) is None
        assert numbered_root(p, far / 2, far, 0) is None


def test_curves_that_are_not_their_own_images_have_no_reflection() -> None:
    near = PlanePolynomial.of([(0, 2, 1), (1, 1, -2), (0, 0, -1)])
    assert reflection(PlaneCurve.of(0, near, 0)) is not None
    for terms in ([(0, 3, 1), (1, 1, -1), (0, 0, 1), (1, 0, 1)], [(1, 2, 1), (0, 1, 1), (0, 0, -1)]):
        assert reflection(PlaneCurve.of(0, PlanePolynomial.of(terms), 0)) is None


def test_an_image_beyond_the_window_is_none() -> None:
    terms = [(0, 2, 1), (1, 1, -2), (0, 0, -1)]
    with ctx.workprec(128):
        assert image_of(branch_of(terms, 0), fmpq(1, 2), (fmpq(0), fmpq(3))) is None


def test_precision_that_rounding_uses_up_is_asked_for() -> None:
    """At 40 bits, branches 1e-6 apart; with more bits the panel is proved."""
    apart = 10**12  # (v - u)^2 = 1 / apart
    branch = branch_of([(0, 2, apart), (1, 1, -2 * apart), (2, 0, apart), (0, 0, -1)], 1)
    span = fmpq(1, 4), fmpq(1, 2)
    with ctx.workprec(40):
        found = wall(branch, span).parts(*span, replace(EFFORT, share=arb(2) ** -30), {})
    expected = fmpq(3, 32) + fmpq(1, 4 * 10**6) + 3 * fmpq(1, 4)
    assert [p.tried for p in found] == [True]
    assert abs(found[0].integral - expected) < fmpq(1, 10**8)
