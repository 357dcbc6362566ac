"""Every shipped slice against the answers under `reference:` in its record; the tests' ids name
their source.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from flint import fmpq
from support import oracle
from support.maps import shipped
from support.shipped_records import EXACT
from support.structure import check_structure, key

import ptmcad
from ptmcad import Count, RegionMap, load
from ptmcad.algebra.polynomials import from_plane
from ptmcad.algebra.real_roots import disjoint, isolate, refine, squarefree_part
from ptmcad.answer.regionmap import Status
from ptmcad.exact.cad.projection import curve
from ptmcad.text.expressions import axis
from ptmcad.text.flint_numbers import from_fraction, to_fraction
from ptmcad.text.parsing import parse
from ptmcad.text.plane import PlanePolynomial

SLICES = {path.stem: load(path) for path in EXACT}
LARGE = ("fig5-text", "fig5-caption", "horizontal", "stiffness", "unequal-springs")


def cases(field: str, each: Callable[[Any], list[Any]] = lambda v: [v]) -> list[Any]:
    """One test for each value of a field, named by the slice and the source of its answers."""
    found = []
    for name, slice in SLICES.items():
        if field in slice.reference:
            source = str(slice.reference["source"]).split(";")[0]
            if field in slice.reference.get("computed", []):
                source = (
                    "computed by ptmcad"  # an answer that keeps what was found, not a published one
                )
            for value in each(slice.reference[field]):
                found.append(pytest.param(name, value, id=f"{name} [{source}]"))
    return found


def test_every_record_has_its_answers() -> None:
    for name, slice in SLICES.items():
        missing = {
            "source",
            "regions",
            "regions_index",
            "area_stable_2",
            "intervals",
        } - slice.reference.keys()
        assert not missing, name
        assert {"variety", "curves"} & slice.reference.keys(), name


@pytest.mark.parametrize(("name", "regions"), cases("regions"))
@pytest.mark.slow_cases("stiffness [no published answer, but at k = 100 a cut of fig. 4]")
def test_number_of_regions(name: str, regions: str) -> None:
    assert len(shipped(name).regions) == int(regions)


@pytest.mark.parametrize(("name", "regions"), cases("regions_index"))
@pytest.mark.slow_cases(
    "fig5-caption [computed by ptmcad]",
    "horizontal [no published answer to the paper's section 5.1]",
    "stiffness [no published answer, but at k = 100 a cut of fig. 4]",
    "unequal-springs [no published answer]",
)
def test_number_of_regions_by_index(name: str, regions: str) -> None:
    result = shipped(name, "index", "1/10")
    assert len(result.regions) == int(regions)
    assert all(region.index is not None for region in result.regions)


@pytest.mark.parametrize(("count", "name"), [
    # maps of total counts are those of index counts with fewer walls
    pytest.param(count, name, marks=pytest.mark.slow if count == "total" and name in LARGE else ())
    for count in ("stable", "total", "index") for name in SLICES
])  # fmt: skip
@pytest.mark.slow_cases(
    "total-forces",
    "index-fig5-caption",
    "index-horizontal",
    "index-stiffness",
    "index-unequal-springs",
)
def test_structure(count: str, name: str) -> None:
    check_structure(shipped(name, count, "1/10") if count != "stable" else shipped(name))


def area_of(result: RegionMap, stable: int) -> tuple[Fraction, Fraction]:
    areas = [region.area for region in result.regions if region.stable == stable]
    return sum((a for a, _ in areas), Fraction(0)), sum((b for _, b in areas), Fraction(0))


def check_area(result: RegionMap, printed: str, tolerance: Fraction) -> None:
    low, high = area_of(result, 2)
    if "." in printed:  # rounded in the last digit
        half = Fraction(1, 2 * 10 ** len(printed.partition(".")[2]))
        assert low <= Fraction(printed) + half
        assert Fraction(printed) - half <= high
    else:
        assert low <= Fraction(printed) <= high
    for region in result.regions:
        assert region.area[1] - region.area[0] <= tolerance * region.area[0]


@pytest.mark.parametrize(("name", "printed"), cases("area_stable_2"))
def test_area(name: str, printed: str) -> None:
    check_area(shipped(name), printed, Fraction(1, 10**4))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "printed"), cases("area_stable_2"))
def test_area_to_nine_digits(name: str, printed: str) -> None:
    result = shipped(name, area_tolerance="1e-9")
    check_area(result, printed, Fraction(1, 10**9))
    low, high = area_of(result, 2)
    half = Fraction(1, 2 * 10 ** len(printed.partition(".")[2])) if "." in printed else Fraction(0)
    assert (
        Fraction(printed) - half - (high - low)
        <= low
        <= high
        <= Fraction(printed) + half + (high - low)
    )


def proportional(p: PlanePolynomial, text: str, names: tuple[str, str]) -> bool:
    """Whether a component is the written polynomial up to a constant."""
    written = parse(text, dict(zip(names, (axis(0), axis(1)), strict=True)))
    assert written.is_polynomial
    terms = {(i, j): c for i, j, c in written.numerator}
    ours = {(i, j): Fraction(c) for i, j, c in p.terms}
    if terms.keys() != ours.keys():
        return False
    return len({terms[m] / ours[m] for m in terms}) == 1


def visible(name: str) -> list[PlanePolynomial]:
    return [c.polynomial for c in shipped(name).components if not c.left_out]


@pytest.mark.parametrize(("name", "written"), cases("variety"))
def test_variety_is_the_written_one(name: str, written: list[str]) -> None:
    """The components in the window are the published ones, each once, and no other."""
    names = SLICES[name].axis_names
    found = visible(name)
    matches = [[proportional(p, text, names) for p in found] for text in written]
    assert all(sum(row) == 1 for row in matches)
    assert len(found) == len(written)


@pytest.mark.parametrize(("name", "curves"), cases("curves"))
def test_curves_have_the_recorded_size(name: str, curves: list[dict[str, Any]]) -> None:
    names = SLICES[name].axis_names
    recorded = [({n: int(d) for n, d in c["degrees"].items()}, int(c["terms"])) for c in curves]
    found = [(dict(zip(names, p.degrees, strict=True)), len(p.terms)) for p in visible(name)]
    assert sorted(found, key=str) == sorted(recorded, key=str)


# ------------------------------------------------------------------------------------------------------- interval ends


def half_unit(printed: str) -> Fraction:
    """Half a unit of the last printed digit; next to nothing for a fraction, which is meant
    exactly.
    """
    return (
        Fraction(1, 2 * 10 ** len(printed.partition(".")[2]))
        if "." in printed
        else Fraction(1, 10**20)
    )


@pytest.mark.parametrize(("name", "interval"), cases("intervals", list))
def test_interval_ends(name: str, interval: dict[str, Any]) -> None:
    """At each printed end the count changes within half a unit of the last digit; located, and by
    the oracle.
    """
    slice = SLICES[name]
    count = Count(interval.get("count", slice.count.value))
    (fixed, value), along = next(iter(interval["at"].items())), interval["along"]
    edge = Fraction(value) in [b for a in slice.axes if a.name == fixed for b in (a.low, a.high)]
    for printed in interval["ends"]:
        here = []
        for side in (-1, 1):
            at = {along: Fraction(printed) + side * half_unit(printed), fixed: Fraction(value)}
            point = [at[n] for n in slice.axis_names]
            truth = oracle.count({n: e.evaluate(*point) for n, e in slice.parameters.items()})
            if edge:  # the window is open: its edge has no cell, so the oracle answers alone
                here.append(_number(count, truth))
                continue
            location = shipped(name).locate(**at)
            assert location.status is Status.EXACT
            assert location.index == truth
            here.append(key(location, count))  # type: ignore[arg-type]
        assert here[0] != here[1], printed
        if "." not in printed and not edge:
            exact = shipped(name).locate(**{along: Fraction(printed), fixed: Fraction(value)})
            assert exact.status is Status.ON_VARIETY


def _number(count: Count, index: tuple[int, int, int]) -> object:
    return {Count.STABLE: index[0], Count.TOTAL: sum(index), Count.INDEX: index}[count]


@pytest.mark.parametrize(("name", "interval"), cases("intervals", list))
def test_no_other_end(name: str, interval: dict[str, Any]) -> None:
    """Between the printed ends the count does not change: asked between all points of the variety
    on the line.
    """
    slice = SLICES[name]
    count = Count(interval.get("count", slice.count.value))
    (_, value), along = next(iter(interval["at"].items())), interval["along"]
    base = 1 - slice.axis_names.index(along)
    window = slice.axes[1 - base]
    low, high = from_fraction(window.low), from_fraction(window.high)
    fibres = [
        curve(n, from_plane(p), base).polynomial_over(from_fraction(Fraction(value)))
        for n, p in enumerate(visible(name))
    ]
    roots = disjoint(
        [refine(r, fmpq(1, 10**12)) for p in fibres for r in isolate(squarefree_part(p), low, high)]
    )
    levels = [window.low, *(to_fraction(q) for r in roots for q in (r.low, r.high)), window.high]
    found = []
    for k in range(0, len(levels), 2):
        point = [Fraction(value)] * 2
        point[1 - base] = (levels[k] + levels[k + 1]) / 2
        found.append(
            _number(
                count, oracle.count({n: e.evaluate(*point) for n, e in slice.parameters.items()})
            )
        )
    assert sum(a != b for a, b in pairwise(found)) == len(interval["ends"])


# -------------------------------------------------------------------------------------------------- single statements


def test_unloaded_regions_touch_only_at_the_edge() -> None:
    """REFERENCE: 4 regions; no two lines of the variety meet inside the window."""
    result = shipped("fig2")
    lines = visible("fig2")
    x, y = result.slice.axes
    for k, p in enumerate(lines):
        for q in lines[k + 1 :]:
            (a, b, c), (d, e, f) = (
                tuple(
                    next((t for i, j, t in r.terms if (i, j) == m), 0)
                    for m in ((1, 0), (0, 1), (0, 0))
                )
                for r in (p, q)
            )
            det = a * e - b * d
            if det:
                meet = Fraction(b * f - c * e, det), Fraction(c * d - a * f, det)
                assert p(*meet) == q(*meet) == 0
                assert not (x.low < meet[0] < x.high and y.low < meet[1] < y.high)
    one = {n for n, region in enumerate(result.regions) if region.stable == 1}
    assert len(one) == 3
    links = {
        frozenset((result.cells[a.first].region, result.cells[a.second].region))
        for a in result.adjacencies
    }
    assert not any(len(link) == 2 and link <= one for link in links)


@pytest.mark.parametrize("far", ["1e6", "1e14", "1e300"])
@pytest.mark.slow_cases("1e6", "1e14")
def test_unloaded_areas_in_a_window_of_any_height(far: str) -> None:
    """REFERENCE: between the three lines; the regions of area 1/4 and 9/4 are lost in the window's
    rounding error.
    """
    axes = {"L2": [0, 4], "rho": [0, far]}
    record = {"name": "far", "mechanism": "ptm", "parameters": {"L1": 1, "k": 100}, "axes": axes}
    result = ptmcad.classify(ptmcad.slice_from_mapping(record))
    whole = 4 * Fraction(far)
    known = [Fraction(1, 4), Fraction(7, 2), whole - 6, Fraction(9, 4)]
    assert [r.stable for r in result.regions] == [1, 2, 1, 1]
    for region, area in zip(result.regions, known, strict=True):
        assert region.area[0] <= area <= region.area[1] <= area * Fraction(10001, 10000)
    assert ptmcad.verify(result).ok


@pytest.mark.parametrize(
    "far",
    [
        "1e20",
        pytest.param("1e100", marks=pytest.mark.slow),
        pytest.param("1e300", marks=pytest.mark.slow),
    ],
)
def test_loaded_areas_in_a_window_of_any_width(far: str) -> None:
    """REFERENCE, fig. 4: the region of two stable equilibria has area .74635, and none of it is
    beyond rho = 2.
    """
    record = {
        "name": "far", "mechanism": "ptm", "parameters": {"L1": 1, "k": 100, "F3": -10, "F4": -10},
        "axes": {"rho": [0, far], "L2": [0, 2]},
    }  # fmt: skip
    (one,), (two,) = (
        [r for r in ptmcad.classify(ptmcad.slice_from_mapping(record)).regions if r.stable == n]
        for n in (1, 2)
    )
    assert Fraction("0.7463") < two.area[0] <= two.area[1] < Fraction("0.7465")
    assert (
        one.area[0] <= 2 * Fraction(far) - Fraction("0.7464")
        and 2 * Fraction(far) - Fraction("0.7463") <= one.area[1]
    )


@pytest.mark.parametrize("numerator", range(1, 40, 3))
def test_unloaded_region_of_two(numerator: int) -> None:
    """REFERENCE: stable 2 exactly where |L2 - 1| < 2 rho < L2 + 1."""
    length = Fraction(numerator, 10)
    for k in range(1, 20):
        rho = Fraction(k, 5) + Fraction(1, 1000)
        expected = 2 if abs(length - 1) < 2 * rho < length + 1 else 1
        if rho < 4:
            assert shipped("fig2").locate(L2=length, rho=rho).stable == expected


def test_symmetric_regions_by_index() -> None:
    """REFERENCE: (4,1) in the rose and outside the astroid; between them (6,2) for x > y and (6,1)
    for x < y.
    """
    result = shipped("fig3", "index", "1/10")
    assert sorted((r.total, r.stable) for r in result.regions) == [(4, 1), (4, 1), (6, 1), (6, 2)]
    for k in range(1, 40):
        for j in range(1, 20):
            rho, load = Fraction(k, 20) - Fraction(1, 700), -Fraction(j, 2)
            x, y = 2 * rho, -load / 100
            rose = (x**2 + y**2) ** 3 - 4 * x**2 * y**2
            astroid = (x**2 + y**2 - 4) ** 3 + 108 * x**2 * y**2
            expected = (4, 1) if rose < 0 or astroid > 0 else (6, 2) if x > y else (6, 1)
            at = result.locate(rho=rho, F=load)
            assert (at.total, at.stable) == expected


def test_symmetric_sliver() -> None:
    """The (6,1) sliver at rho < 0.0025 is there, its own region by index, and merged by stable
    count.
    """
    for count, same in (("index", False), ("stable", True)):
        result = shipped("fig3", count, "1/10" if count == "index" else "1e-4")
        sliver = result.locate(rho="0.0012", F="-9.9")
        rose = result.locate(rho="0.1", F="-9.9")
        assert (sliver.total, sliver.stable) == (6, 1)
        assert (rose.total, rose.stable) == (4, 1)
        assert (sliver.region == rose.region) == same


def test_rods_are_symmetric() -> None:
    """Exchanging L1 and L2 under equal loads changes nothing."""
    result = shipped("rods")
    for k in range(1, 15):
        for j in range(1, k):
            a, b = Fraction(k, 5) + Fraction(1, 99), Fraction(j, 5) + Fraction(1, 77)
            if a < 3:
                assert result.locate(L1=a, L2=b).index == result.locate(L1=b, L2=a).index


def test_stiffness_cuts_fig4() -> None:
    """The same mechanism on two slices: at k = 100, L2 = 3/2 both answer alike."""
    for k in range(1, 40):
        rho = Fraction(k, 20) + Fraction(1, 333)
        if rho < 2:
            expected = shipped("fig4").locate(rho=rho, L2="3/2").index
            assert shipped("stiffness").locate(k=100, rho=rho).index == expected


# ------------------------------------------------------------------------------ independent of the engine altogether
