"""The algebra under the engine: against constructions with known answers, and against FLINT's own
functions.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, pairwise
from math import prod

import pytest
from flint import Ordering, fmpq, fmpq_mat, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_mpoly_vec, fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.counting import system_of
from support.examples import examples
from support.maps import CONFIGS, shipped
from support.signatures import signature

from ptmcad import load
from ptmcad.algebra.bernstein import nowhere_zero
from ptmcad.algebra.fibre_algebra import own_quotient
from ptmcad.algebra.groebner import groebner_basis
from ptmcad.algebra.plane_determinants import determinant
from ptmcad.algebra.polynomials import (
    PLANE,
    coefficients_in,
    evaluate,
    from_expression,
    to_plane,
)
from ptmcad.algebra.quotient_algebra import (
    LINE,
    poles,
    quotient_algebra,
    trace_form,
)
from ptmcad.algebra.real_roots import (
    RealRoot,
    disjoint,
    has_root_between,
    isolate,
    order,
    refine,
    sign_at,
    squarefree_part,
)
from ptmcad.algebra.resultants import discriminant, resultant
from ptmcad.answer.regionmap import Kind
from ptmcad.exact.discriminant_variety import algebra_of
from ptmcad.exact.models.system import SliceSystem, on_slice
from ptmcad.text.flint_numbers import from_fraction, simplest_between, to_fraction

X, Y = PLANE.gens()
SYSTEM = system_of("ptm")

# ---------------------------------------------------------------------------------------------------------- real roots


def q(value: Fraction | int | str) -> fmpq:
    value = Fraction(value)
    return from_fraction(value)


def with_roots(roots: set[Fraction], squares: list[tuple[int, int]] = []) -> fmpz_poly:  # noqa: B006
    """The product of (b x - a) over the roots and of ((x - m)^2 + n^2) without real roots."""
    p = fmpz_poly([1])
    for r in roots:
        p *= fmpz_poly([-r.numerator, r.denominator])
    for m, n in squares:
        p *= fmpz_poly([m * m + n * n, -2 * m, 1])
    return p


def check_roots(p: fmpz_poly, roots: set[Fraction], low: Fraction, high: Fraction) -> None:
    found = isolate(p, q(low), q(high))
    inside = sorted(r for r in roots if low < r < high)
    assert len(found) == len(inside)
    for interval, r in zip(found, inside, strict=True):
        assert (
            interval.low == q(r) == interval.high
            if interval.is_rational
            else interval.low < q(r) < interval.high
        )
        if not interval.is_rational:
            assert sign_at(p, interval.low) * sign_at(p, interval.high) < 0
            assert sum(interval.low < q(s) < interval.high for s in roots) == 1
        narrow = refine(interval, fmpq(1, 10**30))
        assert narrow.low <= q(r) <= narrow.high
        assert narrow.high - narrow.low < fmpq(1, 10**30)
    apart = disjoint(found)
    assert all(a.high < b.low for a, b in pairwise(apart))


corner = st.sampled_from(
    [Fraction(c) for c in ("0", "1", "-1", "1/2", "-3/4", "1/1024", "1e-12", "1/3", "1e6", "7/8")]
)
rationals = st.one_of(corner, st.fractions(min_value=-4, max_value=4, max_denominator=50))


@given(
    st.sets(rationals, max_size=7),
    st.lists(st.tuples(st.integers(-3, 3), st.integers(1, 3)), max_size=2, unique=True),
    st.sampled_from([(-4, 4), (0, 1), (-1, 1), (-8, 10**7), (Fraction(1, 3), Fraction(7, 8))]),
)
@settings(max_examples=examples(150))
def test_roots_by_construction(
    roots: set[Fraction], squares: list[tuple[int, int]], window: tuple[int, int]
) -> None:
    check_roots(with_roots(roots, squares), roots, Fraction(window[0]), Fraction(window[1]))


@pytest.mark.parametrize("gap", ["1e-5", "1e-20", "1e-60"])
def test_clustered_roots(gap: str) -> None:
    roots = {Fraction(1, 3) + k * Fraction(gap) for k in range(5)} | {
        Fraction(1, 2),
        Fraction(1, 2) + Fraction(gap),
    }
    check_roots(with_roots(roots), roots, Fraction(0), Fraction(1))


def test_roots_of_wilkinson_and_mignotte() -> None:
    check_roots(with_roots({Fraction(k) for k in range(1, 31)}), {Fraction(k) for k in range(1, 31)}, Fraction(0),
                Fraction(31))  # fmt: skip
    mignotte = fmpz_poly(
        [-2 * 1, 4 * 1000, -2 * 1000**2] + [0] * 14 + [1]
    )  # x^17 - 2 (1000 x - 1)^2
    found = isolate(mignotte, fmpq(0), fmpq(1))
    assert len(found) == 2
    assert disjoint(found)[0].high < fmpq(1, 1000) < disjoint(found)[1].low


@pytest.mark.parametrize("reach", [10**9, 10**400, 10**5000], ids=("1e9", "1e400", "1e5000"))
@pytest.mark.parametrize("unit", [Fraction(1), Fraction(10**30), Fraction(1, 10**30)], ids=str)
def test_roots_in_intervals_of_any_length(reach: int, unit: Fraction) -> None:
    """Cut off by a bound for the roots, of which none may be lost, whichever part of them the
    interval holds.
    """
    known = [Fraction(k) * unit for k in (-7, -2, 0, 1, 5)]
    p = prod((fmpz_poly([-r.numerator, r.denominator]) for r in known), start=fmpz_poly([1]))
    ends = (
        (-reach, reach),
        (-reach, 0),
        (0, reach),
        (unit * 6, reach),
        (unit * 3, reach),
        (-reach, unit * -8),
    )
    for low, high in ((Fraction(a), Fraction(b)) for a, b in ends if a < b):
        found = isolate(p, from_fraction(low), from_fraction(high))
        inside = [r for r in known if low < r < high]
        assert len(found) == len(inside)
        for root, value in zip(found, inside, strict=True):
            assert to_fraction(root.low) <= value <= to_fraction(root.high)


def test_where_numbers_lie_against_a_root() -> None:
    """Also at the ends of its isolating interval, and where a rational root is not known as such."""
    (root,) = isolate(fmpz_poly([-2, 0, 1]), fmpq(1), fmpq(2))
    assert root.low < root.high
    for number in (fmpq(0), root.low, fmpq(141, 100), fmpq(142, 100), root.high, fmpq(3)):
        assert order(number, root) == (1 if number * number > 2 else -1)
    plain = RealRoot(fmpz_poly([-3, 2]), fmpq(1), fmpq(2))
    assert [order(fmpq(n, 2), plain) for n in (2, 3, 4)] == [-1, 0, 1]
    known = RealRoot(fmpz_poly([-3, 2]), fmpq(3, 2), fmpq(3, 2))
    assert [order(fmpq(n, 2), known) for n in (2, 3, 4)] == [-1, 0, 1]


def test_roots_at_the_ends_of_the_interval_are_outside() -> None:
    p = with_roots({Fraction(0), Fraction(1), Fraction(1, 2)})
    (only,) = isolate(p, fmpq(0), fmpq(1))
    assert only.low <= fmpq(1, 2) <= only.high
    assert only.low > 0
    assert only.high < 1


@given(st.lists(rationals, min_size=1, max_size=4), rationals, rationals)
def test_has_root_between_with_multiplicities(
    roots: list[Fraction], a: Fraction, b: Fraction
) -> None:
    assume(a < b)
    p = with_roots(set(roots)) * with_roots({roots[0]}) ** 2 * fmpz_poly([1, 0, 1])
    assert has_root_between(p, q(a), q(b)) == any(a <= r <= b for r in roots)
    assert squarefree_part(p).degree() == len(set(roots)) + 2


simple = st.fractions(min_value=-4, max_value=4, max_denominator=50)


@given(simple, simple)
def test_simplest_between(a: Fraction, b: Fraction) -> None:
    low, high = min(a, b), max(a, b)
    assume(low < high)
    found = simplest_between(q(low), q(high))
    value = to_fraction(found)
    assert low < value < high
    denominator = 1
    while True:  # the first denominator with a fraction inside
        first = low.numerator * denominator // low.denominator + 1
        if Fraction(first, denominator) < high:
            break
        denominator += 1
    last = -(-high.numerator * denominator // high.denominator) - 1
    nearest = min((k for k in (first, last, 0) if first <= k <= last), key=abs)
    assert value == Fraction(nearest, denominator)


# ---------------------------------------------------------------------------------------- resultants and discriminants

degree_3_by_3 = st.lists(st.integers(-3, 3), min_size=16, max_size=16).map(
    lambda c: sum((k * X ** (n // 4) * Y ** (n % 4) for n, k in enumerate(c)), 0 * X)
)


def in_x(p: fmpz_mpoly) -> fmpz_poly:
    assert p.is_zero() or p.degrees()[1] <= 0
    return coefficients_in(p, 1)[0] if not p.is_zero() else fmpz_poly([])


@given(degree_3_by_3)
@settings(max_examples=examples(100))
def test_discriminant_is_flints(p: fmpz_mpoly) -> None:
    assume(p.degrees()[1] >= 2)
    assert discriminant(coefficients_in(p, 1)) == in_x(p.discriminant("y"))


@given(degree_3_by_3, degree_3_by_3)
@settings(max_examples=examples(100))
def test_resultant_is_flints(p: fmpz_mpoly, r: fmpz_mpoly) -> None:
    assume(p.degrees()[1] >= 1 and r.degrees()[1] >= 1)
    ours, theirs = (
        resultant(coefficients_in(p, 1), coefficients_in(r, 1)),
        in_x(p.resultant(r, "y")),
    )
    assert ours in (theirs, -theirs)


def test_common_factors_give_zero() -> None:
    assert (
        resultant(
            coefficients_in((X + Y) * (Y**2 + 1), 1), coefficients_in((X + Y) * (Y - X**2), 1)
        )
        == 0
    )
    assert discriminant(coefficients_in((X + Y) ** 2 * (Y - 1), 1)) == 0


# ------------------------------------------------------------------------------------------- Groebner bases and fibres

SLICES = {
    name: load(CONFIGS / f"{name}.yaml")
    for name in ("fig2", "fig3", "fig4", "fig5-text", "horizontal")
}
POINTS = [
    (Fraction(7, 10), Fraction(13, 10)),
    (Fraction(1, 3), Fraction(-5, 2)),
    (Fraction(11, 7), Fraction(2, 9)),
]


def slice_system(name: str) -> tuple[dict[str, tuple[fmpz_mpoly, fmpz_mpoly]], SliceSystem]:
    parameters = {n: from_expression(SLICES[name].parameters[n]) for n in SYSTEM.ring.parameters}
    return parameters, on_slice(SYSTEM, parameters)


def specialised(
    p: dict[tuple[int, ...], fmpz_mpoly], x: Fraction, y: Fraction
) -> dict[tuple[int, ...], fmpq]:
    values = {m: evaluate(c, q(x), q(y)) for m, c in p.items()}
    return {m: v for m, v in values.items() if v}


def flint_basis(
    equations: list[dict[tuple[int, ...], fmpq]], unknowns: int
) -> list[dict[tuple[int, ...], fmpq]]:
    """FLINT's reduced Groebner basis, each element made monic."""
    context = fmpz_mpoly_ctx.get(tuple(f"u{k}" for k in range(unknowns)), Ordering.degrevlex)
    integral = []
    for e in equations:
        scale = prod(int(c.q) for c in e.values())
        integral.append(
            context.from_dict({m: int(c.p) * (scale // int(c.q)) for m, c in e.items()})
        )
    result = []
    for p in fmpz_mpoly_vec(integral, context).buchberger_naive().autoreduction():
        terms = [(tuple(int(i) for i in m), fmpq(c)) for m, c in p.terms()]
        result.append({m: c / terms[0][1] for m, c in terms})
    return result


@pytest.mark.parametrize("name", SLICES)
def test_basis_specialises_to_flints(name: str) -> None:
    """The basis over Q(x, y), specialised at rational points, is the basis that FLINT computes
    there.
    """
    _, equations = slice_system(name)
    order = tuple(range(equations.unknowns))
    basis = groebner_basis(equations.equations, order)
    for x, y in POINTS:
        ours = []
        for element, lead in zip(basis.elements, basis.leading, strict=True):
            values = specialised(element, x, y)
            assert lead in values, "the point is special"
            ours.append({m: c / values[lead] for m, c in values.items()})
        theirs = flint_basis(
            [specialised(e, x, y) for e in equations.equations], equations.unknowns
        )
        assert {frozenset((m, str(c)) for m, c in e.items()) for e in ours} == {
            frozenset((m, str(c)) for m, c in e.items()) for e in theirs
        }


def test_a_pole_that_the_line_does_not_show_is_found_in_the_plane() -> None:
    """The only root is (y - x - 1009)/f, and nothing on the line y = x + 1009: of f = x, so only a
    suspect is found.
    """
    basis = groebner_basis([{(1,): X, (0,): X + LINE - Y}], (0,))
    algebra = quotient_algebra(basis)
    assert algebra is not None
    assert poles(algebra, [X], (0,)) == [X]
    assert poles(algebra, [], (0,), [X]) == []


def test_a_pole_on_a_curve_that_does_not_meet_the_line_is_found() -> None:
    """The only root is 1/(x - y), which is constant on the line y = x + 1009."""
    basis = groebner_basis([{(1,): X - Y, (0,): X**0}], (0,))
    algebra = quotient_algebra(basis)
    assert algebra is not None
    assert poles(algebra, [], (0,), [X - Y]) == [X - Y]


@pytest.mark.parametrize("name", ["fig2", "fig3", "fig4", "fig5-text"])
@pytest.mark.slow_cases("fig5-text", "fig3", "fig4")
def test_hermite_determinant_has_every_critical_component(name: str) -> None:
    """REFERENCE: the numerator of the Hermite determinant has the curves as factors, with these
    multiplicities.
    """
    parameters, _ = slice_system(name)
    numerator, _ = determinant(trace_form(algebra_of(on_slice(SYSTEM, parameters))))
    factors = {to_plane(f): e for f, e in numerator.factor()[1]}
    critical = [
        c.polynomial for c in shipped(name).components if c.kind is Kind.CRITICAL and not c.left_out
    ]
    assert critical
    assert all(p in factors for p in critical)
    found = sorted(factors[p] for p in critical)
    assert found == {"fig2": [3, 3, 3], "fig3": [1, 3], "fig4": [1], "fig5-text": [1]}[name]


def test_six_complex_solutions(shipped) -> None:  # type: ignore[no-untyped-def]
    for name in ("fig2", "fig3", "fig4", "fig5-text", "fig5-caption", "horizontal"):
        assert shipped(name).complex_solutions == 6


@given(
    st.lists(st.integers(-4, 4), min_size=4, max_size=4),
    st.lists(st.integers(-2, 2), min_size=16, max_size=16),
)
@settings(max_examples=examples(60))
def test_signature_by_construction(diagonal: list[int], entries: list[int]) -> None:
    """Sylvester's law of inertia: P^T D P has the signs of D for invertible P."""
    change = fmpq_mat(4, 4, entries)
    assume(change.det() != 0)
    d = fmpq_mat(4, 4, [diagonal[i] if i == j else 0 for i in range(4) for j in range(4)])
    symmetric = change.transpose() * d * change
    assert signature(symmetric) == (sum(v > 0 for v in diagonal), sum(v < 0 for v in diagonal))


def test_infinite_fibre_is_none() -> None:
    assert own_quotient([{(1, 0): fmpq(1)}], 2) is None
    assert own_quotient([{(2, 0): fmpq(1), (0, 0): fmpq(-1)}, {(0, 1): fmpq(1)}], 2) is not None


# ---------------------------------------------------------------------------------------------------------- the window

BOTH = (fmpq(-1), fmpq(1))


@given(degree_3_by_3)
@settings(max_examples=examples(100))
def test_nowhere_zero_is_never_wrong(p: fmpz_mpoly) -> None:
    assume(p.total_degree() > 0)
    if nowhere_zero(p, (BOTH, BOTH)):
        grid = [fmpq(k, 9) for k in range(-8, 9)]
        values = [evaluate(p, a, b) for a in grid for b in grid]
        assert all(v > 0 for v in values) or all(v < 0 for v in values)


@given(degree_3_by_3, st.integers(-8, 8), st.integers(-8, 8))
@settings(max_examples=examples(60))
def test_a_zero_in_the_window_is_never_denied(p: fmpz_mpoly, a: int, b: int) -> None:
    x, y = fmpq(a, 9), fmpq(b, 9)
    value = evaluate(p, x, y)
    through = p * int(value.q) - int(value.p)  # has a zero at (x, y)
    assume(through.total_degree() > 0)
    assert not nowhere_zero(through, (BOTH, BOTH))


def test_pairs_of_components_are_different() -> None:
    for name in SLICES:
        assert all(
            a.polynomial != b.polynomial for a, b in combinations(shipped(name).components, 2)
        )
