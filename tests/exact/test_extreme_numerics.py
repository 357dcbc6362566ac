"""What keeps extreme maps cheap: clusters of roots, branches that nearly meet, strips and cuts that
follow scales.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import pytest
from flint import arb, ctx, fmpq, fmpq_poly, fmpz_poly
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

import ptmcad
from ptmcad.algebra import descartes
from ptmcad.algebra.chords import arc_integral
from ptmcad.algebra.real_roots import RealRoot, isolate
from ptmcad.answer.regionmap import Status
from ptmcad.question.config import slice_from_mapping
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.verification.rootcounts import roots_between


def polynomial(roots: list[Fraction]) -> fmpz_poly:
    """With these rational roots, each once."""
    product = fmpz_poly([1])
    for r in set(roots):
        product *= fmpz_poly([-r.numerator, r.denominator])
    return product


@settings(max_examples=examples(60), deadline=None)
@given(
    st.fractions(-3, 3, max_denominator=50),
    st.lists(
        st.tuples(st.sampled_from([0, 1, 7, 30, 80]), st.integers(-9, 9)), min_size=1, max_size=6
    ),
    st.lists(st.fractions(-4, 4, max_denominator=9), max_size=3),
)
def test_clusters_are_isolated(
    center: Fraction, near: list[tuple[int, int]], others: list[Fraction]
) -> None:
    """Roots known by construction, some as near to each other as 10^-80."""
    roots = sorted({center + n * Fraction(1, 10**e) for e, n in near} | set(others))
    low, high = fmpq(-5), fmpq(5)
    inside = [r for r in roots if -5 < r < 5]
    found = isolate(polynomial(roots), low, high)
    assert len(found) == len(inside)
    for root, known in zip(found, inside, strict=True):
        exact = from_fraction(known)
        assert root.low == exact if root.is_rational else root.low < exact < root.high
    for a, b in pairwise(found):
        assert a.high <= b.low


@pytest.fixture
def tests_made(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The degree of the polynomial in each test by Descartes' rule."""
    made: list[int] = []
    bound = descartes.descartes_bound

    def counted(q: fmpz_poly, degree: int) -> int:
        made.append(degree)
        return bound(q, degree)

    monkeypatch.setattr(descartes, "descartes_bound", counted)
    return made


def far_cluster(center: int, pairs: list[tuple[int, int]], real: list[int]) -> fmpz_poly:
    """Roots center + r and center + a +- b i, and the same mirrored, as the fibres of a map in a
    vast window have.
    """
    p = polynomial([Fraction(center + r) for r in real])
    for a, b in set(pairs):
        p *= fmpz_poly([(center + a) ** 2 + b * b, -2 * (center + a), 1])
    return p * p(fmpz_poly([0, -1]))


@settings(max_examples=examples(40), deadline=None)
@given(
    st.integers(2, 30),
    st.integers(1, 10**6),
    st.lists(st.tuples(st.integers(-5, 5), st.integers(1, 5)), max_size=3),
    st.lists(st.integers(-5, 5), min_size=1, max_size=3),
    st.booleans(),
)
def test_clusters_far_out_are_isolated(
    e: int, n: int, pairs: list[tuple[int, int]], real: list[int], both: bool
) -> None:
    """Real and complex roots together, 10^e away from their mirrored ones: known by construction,
    and Sturm's count.
    """
    center = n * 10 ** max(e - 6, 1)
    p = far_cluster(center, pairs, real)
    low, high = fmpq(-(10**31) if both else 0), fmpq(10**31)
    known = sorted({s * (center + r) for r in real for s in ((1, -1) if both else (1,))})
    found = isolate(p, low, high)
    assert len(found) == len(known) == roots_between(p, low, high)
    for root, value in zip(found, known, strict=True):
        assert root.low == value if root.is_rational else root.low < value < root.high


@settings(max_examples=examples(30), deadline=None)
@given(
    st.integers(5, 60),
    st.fractions(-1, 1, max_denominator=8),
    st.fractions(0, 1, max_denominator=8),
)
def test_arcs_enclose_the_integral_of_branches_that_nearly_meet(
    e: int, bend: Fraction, slope: Fraction
) -> None:
    """(v - s - b u - a u^2)^2 = 10^-e: both branches, whose integrals are known, by a tube that
    holds both or one.
    """
    gap = Fraction(1, 10 ** (e // 2 * 2))
    arc = fmpq_poly([fmpq(2), from_fraction(slope), from_fraction(bend)])
    scale = 64 * 10 ** (e // 2 * 2) * arc.denom() ** 2
    # p = (v - arc)^2 - gap, times a number that makes it integral
    square = arc * arc - from_fraction(gap)
    in_v = [(q * fmpq(scale)).numer() for q in (square, arc * fmpq(-2), fmpq_poly([1]))]
    integral = sum((to_fraction(c) * 2 / (k + 1) for k, c in enumerate(arc.coeffs()) if k % 2 == 0))
    fibre = (fmpq(-1), fmpq(5))
    half = Fraction(1, 10 ** (e // 2))
    for side, number in ((-1, 0), (1, 1)):

        def branch(u: fmpq, number: int = number) -> RealRoot:
            at = [c(u) for c in in_v]
            common = 1
            for value in at:
                common = common * int(fmpq(value).q)
            return isolate(fmpz_poly([int((fmpq(v) * common).p) for v in at]), *fibre)[number]

        with ctx.workprec(200):
            found = arc_integral(in_v, branch, fmpq(0), fmpq(1), fibre, fmpq(1, 1000))
            assert found is not None
            known = integral + side * half * 2
            assert found.contains(arb(from_fraction(known)))
            assert found.rad() < arb(fmpq(1, 20))


def test_arcs_prove_nothing_where_a_branch_runs_through_the_tube() -> None:
    """v (v - u) = 0: the two branches cross, so that neither arc is free of the curve."""
    in_v = [fmpz_poly([0]), fmpz_poly([0, -1]), fmpz_poly([1])]

    def branch(u: fmpq) -> RealRoot:
        return RealRoot(fmpz_poly([0, 1]), fmpq(0), fmpq(0))

    with ctx.workprec(100):
        assert (
            arc_integral(in_v, branch, fmpq(0), fmpq(1), (fmpq(-2), fmpq(2)), fmpq(1, 100)) is None
        )


def test_series_beside_a_critical_abscissa_that_is_found_to_be_rational() -> None:
    """Forces up to 1e9 on both sides of zero: F3 = 0 is critical, and known to be zero only when it
    is refined.
    """
    record = {
        "mechanism": "ptm",
        "parameters": {"L1": 1, "L2": "3/2", "rho": "3/4", "k": 100},
        "count": "stable",
    }
    axes = {"F3": ["-1e9", "1e9"], "F4": ["-1e9", "1e9"]}
    wide = ptmcad.classify(slice_from_mapping({"name": "wide", **record, "axes": axes}))
    assert wide.status is Status.EXACT
    assert all(high - low <= high / 10**4 for low, high in (region.area for region in wide.regions))


GERMS = {
    "two cubics": "(b - a^3)*(b - a^3 - a^5)",
    "a rhamphoid cusp": "(b - a^2 - a^3)^2 - a^7",
    "two parabolas": "(b - a^2)^2 - 3*a^6 - b^4",
}
"""Curves with branches that part slowly at the origin."""


@pytest.mark.parametrize("digits", [15, 40])
@pytest.mark.parametrize("name", GERMS)
@pytest.mark.slow_cases("two parabolas-40")
def test_areas_between_branches_that_part_slowly_are_those_in_other_units(
    name: str, digits: int
) -> None:
    """A window of size 10^-digits, and the unit square with the equation in these units: the
    thinnest region's share of the window is 10^-200 in one."""
    found = []
    for unit in (1, Fraction(1, 10**digits)):
        germ = (
            GERMS[name].replace("a", f"({unit}*a)").replace("b", f"({unit}*b)")
            if unit != 1
            else GERMS[name]
        )
        side = [0, str(Fraction(1, 10**digits) / unit)]
        system = {"unknowns": {"z": "real"}, "equations": [f"z^2 - ({germ})"]}
        whole = (Fraction(1, 10**digits) / unit) ** 2
        regions = ptmcad.classify(
            slice_from_mapping({"name": "germ", "system": system, "axes": {"a": side, "b": side}})
        ).regions
        found.append(
            sorted((r.total, *(bound / whole for bound in r.area)) for r in regions if r.area)
        )
    tiny, unitary = found
    assert len(tiny) == len(unitary) > 1
    for (count, low, high), (other, least, most) in zip(tiny, unitary, strict=True):
        assert count == other
        assert max(low, least) <= min(high, most)
        assert high - low <= low / 1000


def test_verify_reads_coefficients_of_fifty_digits() -> None:
    """A true map was called violated: its equations were said to be no formulas."""
    system = {
        "unknowns": {"z": "real"},
        "equations": [f"z^2 - (a^2 + b^2 - {10**50 + 1}/{10**50})"],
    }
    stored = ptmcad.classify(
        slice_from_mapping({"name": "long", "system": system, "axes": {"a": [0, 2], "b": [0, 2]}})
    )
    assert ptmcad.verify(stored).ok
