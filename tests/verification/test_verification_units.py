"""Parts of the verification, and of what it reads, by themselves."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import combinations
from typing import Any

import pytest
from flint import fmpz_poly
from hypothesis import given
from hypothesis import strategies as st
from support.few import few
from support.replacing import replace

import ptmcad
from ptmcad.algebra import resultants
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.errors import LimitReached
from ptmcad.verification.claims import Claims
from ptmcad.verification.planecurves import Terms, discriminant, resultant
from ptmcad.verification.report import check_anew
from ptmcad.verification.solutions import check_counts, check_solutions

polynomials = st.dictionaries(
    st.tuples(st.integers(0, 4), st.integers(0, 4)),
    st.integers(-9, 9).filter(bool),
    min_size=1,
    max_size=8,
).map(lambda terms: tuple((i, j, c) for (i, j), c in terms.items()))


def in_v(p: Terms) -> list[fmpz_poly]:
    rows = [[0] * 5 for _ in range(1 + max(j for _, j, _ in p))]
    for i, j, c in p:
        rows[j][i] = c
    return list(map(fmpz_poly, rows))


@given(polynomials, polynomials)
def test_resultants_agree_with_interpolation(p: Terms, q: Terms) -> None:
    """The engine's are found modulo primes."""
    expected = resultants.resultant(in_v(p), in_v(q))
    assert resultant(p, q) in (expected, -expected)


@given(polynomials.filter(lambda p: max(j for _, j, _ in p) > 1))
def test_discriminants_agree_with_interpolation(p: Terms) -> None:
    expected = resultants.discriminant(in_v(p))
    assert discriminant(p) in (expected, -expected)


# --------------------------------------------------------------------------------------------------- partial results


def stopped_at(stage: str) -> RegionMap:
    def progress(name: str, _done: int, _total: int) -> None:
        if name == stage:
            raise LimitReached("enough")

    with pytest.raises(LimitReached) as stopped:
        ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"), progress=progress)
    assert isinstance(stopped.value.partial, RegionMap)
    return RegionMap.from_json(stopped.value.partial.to_json())


@pytest.mark.parametrize(("stage", "unchecked"), [("projection", 10), ("areas", 0)])
def test_what_a_partial_result_has_is_checked(stage: str, unchecked: int) -> None:
    partial = stopped_at(stage)
    assert partial.status is Status.PARTIAL
    report = ptmcad.verify(partial)
    assert report.ok, report.violation
    assert (
        sum(c.detail == "not complete in this partial result" for c in report.checks) == unchecked
    )


def test_a_false_partial_result_is_rejected() -> None:
    partial = stopped_at("areas")
    cell = partial.cells[0]
    assert cell.total is not None
    wrong = replace(cell, total=cell.total + 2)
    assert not ptmcad.verify(replace(partial, cells=(wrong, *partial.cells[1:]))).ok
    assert not ptmcad.verify(replace(stopped_at("projection"), status=Status.EXACT)).ok


# ------------------------------------------------------------------------------------------------------- solutions


CUSP = {"L1": "1", "L2": "25/39", "rho": "28/169", "F3": "-22400/507", "F4": "-13440/169"}


@pytest.mark.parametrize("exponent", few([3, 12, 30], 12))
def test_boxes_near_a_cusp_are_disjoint_and_verified(exponent: int) -> None:
    """Three equilibria meet in the cusp; next to it their boxes need more digits."""
    stored = map_near_the_cusp(exponent)
    check_counts(Claims(stored))
    check_solutions(Claims(stored))


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [3, 12, 30])
def test_maps_near_a_cusp_are_verified(exponent: int) -> None:
    """In full where the areas are easiest, and where they need more than the usual precision."""
    report = ptmcad.verify(map_near_the_cusp(exponent))
    assert report.ok, report.violation


@cache
def map_near_the_cusp(exponent: int) -> RegionMap:
    width = Fraction(1, 10**exponent)
    axes = {
        n: [str(Fraction(CUSP[n]) - width), str(Fraction(CUSP[n]) + width)] for n in ("rho", "F4")
    }
    record = {"name": "cusp", "axes": axes, "count": "index",
              "parameters": {n: v for n, v in CUSP.items() if n not in axes}}  # fmt: skip
    result = ptmcad.classify(ptmcad.slice_from_mapping(record), area_tolerance="1/10")
    assert sorted(r.index for r in result.regions if r.index) == [(1, 2, 1), (1, 3, 2)]
    for cell in result.cells:
        assert len(cell.solutions) == cell.total
        for a, b in combinations(cell.solutions, 2):
            assert any(
                abs(x - y) > a.radius + b.radius for x, y in zip(a.center, b.center, strict=True)
            )
    return RegionMap.from_json(result.to_json())


def test_points_are_drawn_from_a_fresh_seed(shipped: Callable[..., RegionMap]) -> None:
    """No claims can be fitted to them; the seed is printed, and one given by hand is used."""
    details = []
    for seed in (None, None, 5, 5):
        report = ptmcad.verify(shipped("fig2"), seed=seed)
        details.append(
            next(c.detail for c in report.checks if c.name == "variety complete").split(";")[0]
        )
    assert details[2] == details[3]
    assert len(set(details)) == 3
    assert details[2].endswith("seed 5")
    assert int(details[0].rsplit(" ", 1)[1]) > 2**32


def test_enclosures_that_hold_are_not_called_false_since_others_are_found_now() -> None:
    """One that has the finer one holds; one beside it does not; of one that meets it nothing is
    said.
    """

    def line(
        low: str, high: str, decimal: str | None, version: str = "1", met: str = "fold"
    ) -> dict[str, Any]:
        return {
            "at": {"low": low, "high": high, "decimal": decimal},
            "met": [met],
            "versions": {"ptmcad": version},
        }

    now, finer = line("1.41", "1.42", "1.4"), line("1.414", "1.415", "1.41")
    for stored, passed in (
        (line("1.4", "1.42", "1.4"), True), (line("7/5", "3/2", None), True), (line("1.4", "1.4145", "1.4"), None),
        (line("1.416", "1.42", "1.4"), False), (line("1.4", "1.42", "1.43"), False), (line("3/2", "7/5", None), False),
        (line("1.4", "1.42", "1.4", met="cone"), False), (line("1.4", "1.42", "1.4", "0", "cone"), None),
        (line("1.4", "1.42", "1.4", "0"), True), (now, True),
    ):  # fmt: skip
        assert check_anew(stored, now, lambda: finer).passed is passed, stored
    assert check_anew(line("1.4", "1.42", "1.4"), now).passed is False
