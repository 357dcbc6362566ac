"""Slices at the limits of the method: refused with the right exception, or answered; never wrong
and never a crash.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from support import oracle
from support.maps import CONFIGS
from support.structure import check_structure

import ptmcad
from ptmcad import RegionMap, classify, load, slice_from_mapping
from ptmcad.ask.checking import check
from ptmcad.errors import (
    ConfigError,
    DegenerateSliceError,
    GeometryError,
    InfiniteSolutionsError,
    LimitReached,
    NothingToCountError,
)

RHO_L2 = {"rho": [0, 2], "L2": [0, 2]}


def region_map(axes: dict[str, Any], count: str = "index", **parameters: Any) -> RegionMap:
    result = classify(
        slice_from_mapping(
            {"name": "case", "axes": axes, "parameters": parameters, "count": count}
        ),
        area_tolerance="1/10",
    )
    check_structure(result)
    check_against_oracle(result)
    return result


def check_against_oracle(result: RegionMap) -> None:
    for cell in result.cells:
        values = {n: e.evaluate(*cell.sample) for n, e in result.slice.parameters.items()}
        try:
            assert cell.index == oracle.count(values)
        except oracle.Untreated:
            continue


@pytest.mark.parametrize(
    ("axes", "parameters"),
    [({"L1": [1, 2], "L2": [1, 2]}, {"rho": "(L1+L2)/2"}), ({"L1": [2, 3], "L2": [0, 1]}, {"rho": "(L1-L2)/2"}),
     ({"L1": [1, 2], "k": [1, 100]}, {"L2": 1, "rho": "(L1+1)/2"})],
)  # fmt: skip
def test_slices_inside_the_variety(axes: dict[str, Any], parameters: dict[str, Any]) -> None:
    """Unloaded, 2 rho = L1 + L2 or 2 rho = |L1 - L2|: flat and singular at every point."""
    with pytest.raises(DegenerateSliceError, match=r"(?s).{20}"):
        region_map(axes, **parameters)


def test_infinitely_many_solutions_everywhere() -> None:
    """Unloaded with rho = 0: the crossed bars turn freely."""
    with pytest.raises(InfiniteSolutionsError, match=r"(?s).{20}"):
        region_map({"L1": [1, 2], "L2": [1, 2]}, rho=0)


X = {"x": "real"}


@pytest.mark.parametrize(
    ("system", "words"),
    [
        ({"unknowns": X, "equations": ["(x^2-a)^2 + 0*b"]}, "only 2 of 4 solutions are different"),
        ({"unknowns": X, "equations": ["(x^2-a)^2*(x-b)"]}, "only 3 of 5 solutions are different"),
        ({"unknowns": X, "equations": ["(x^2-a)^2*(x-b)"], "positive": ["x-b"]}, "only 2 of 4 solutions are different"),
        ({"unknowns": {"x": "angle", "y": "real"}, "equations": ["cos(x)-2-y", "(y-a)^2*(y-b)^2"]},
         "only 4 of 8 solutions are different"),
    ],
)  # fmt: skip
@pytest.mark.slow_cases(
    "system0-only 2 of 4 solutions are different",
    "system3-only 4 of 8 solutions are different",
    "system1-only 3 of 5 solutions are different",
)
def test_a_slice_inside_the_variety_is_shown_at_a_point_where_nothing_else_degenerates(
    system: dict[str, Any], words: str
) -> None:
    """By hand: a and b differ and are not zero there, and the roots of each factor are simple."""
    slice = slice_from_mapping({"system": system, "axes": {"a": [-2, 2], "b": [-2, 2]}})
    for ask in (classify, check):
        with pytest.raises(DegenerateSliceError) as caught:
            ask(slice)
        assert str(caught.value).endswith(f"for example at a = -2/21, b = 6/35 {words}")


def test_a_point_where_more_degenerates_is_passed_over() -> None:
    """At the first point that is tried a = b, so that solutions coincide that do not elsewhere."""
    system = {"unknowns": X, "equations": ["(x-a)^2*(x-b)"]}
    equal = slice_from_mapping({"system": system, "axes": {"a": [0, "399/10"], "b": [0, 35]}})
    words = "at a = 399/22, b = 140/13 only 2 of 3"
    with pytest.raises(DegenerateSliceError, match=words):
        classify(equal)


@pytest.mark.parametrize(
    ("system", "error", "words"),
    [
        ({"unknowns": X, "equations": ["x^2-a+0*b"], "positive": ["x^2-a"]}, NothingToCountError,
         "b = 6/35 the equations have 2 different solutions, all excluded"),
        ({"unknowns": X, "equations": ["1+0*a*b*x"]}, NothingToCountError, "b = 6/35 there is none"),
        ({"unknowns": {"x": "real", "y": "real"}, "equations": ["x*y-a*x", "x*(x-b)"]}, InfiniteSolutionsError,
         "b = 6/35 there are infinitely many solutions"),
    ],
)  # fmt: skip
@pytest.mark.slow_cases("system1-NothingToCountError-b = 6/35 there is none")
def test_nothing_to_count_and_infinitely_many_are_shown_at_a_point(
    system: dict[str, Any], error: type[Exception], words: str
) -> None:
    slice = slice_from_mapping({"system": system, "axes": {"a": [-2, 2], "b": [-2, 2]}})
    for ask in (classify, check):
        with pytest.raises(error) as caught:
            ask(slice)
        assert str(caught.value).endswith(f"for example at a = -2/21, {words}")


def test_a_check_that_does_not_prove_says_what_it_saw() -> None:
    system = {"unknowns": {"x": "real", "y": "real"}, "equations": ["(x^3-a*x+b)^2*(x-1)", "y^3-x"]}
    found = check(slice_from_mapping({"system": system, "axes": {"a": [-2, 2], "b": [-2, 2]}}))
    assert found.complex_solutions == 12
    assert found.cost.startswith("not known: at 5 points that were tried some solution is multiple")


def test_what_degenerates_at_the_checks_sample_only_is_no_fault() -> None:
    """x^2 = a - 10/21 has a double solution at the first point that is tried, and nowhere else."""
    system = {"unknowns": X, "equations": ["x^2 - a + 10/21 + 0*b"]}
    assert (
        check(
            slice_from_mapping({"system": system, "axes": {"a": [0, 1], "b": [0, 1]}})
        ).complex_solutions
        == 1
    )
    excluded = {"unknowns": X, "equations": ["(x^2-a)^2*(x-b)"], "positive": ["x^2-a"]}
    assert (
        check(
            slice_from_mapping({"system": excluded, "axes": {"a": [0, 1], "b": [0, 1]}})
        ).complex_solutions
        == 1
    )


def test_rho_zero_with_loads() -> None:
    """A base of length zero is degenerate only without loads."""
    result = region_map({"F3": [-30, 0], "F4": [-30, -1]}, rho=0, L2="3/2")
    assert all(cell.total in (4, 6) for cell in result.cells)


def test_rho_zero_at_the_edge() -> None:
    region_map(RHO_L2, F3=-10, F4=-10)


def test_a_length_that_becomes_negative() -> None:
    with pytest.raises((GeometryError, ConfigError), match="L2"):
        region_map({"rho": [0, 4], "F3": [-10, 0]}, L2="2-rho", F4=-10)


def test_a_length_that_is_zero_only_at_the_edge() -> None:
    region_map({"rho": [0, 2], "F3": [-10, 0]}, L2="2-rho", F4=-10)


def test_a_dip_below_zero_that_no_box_sees() -> None:
    """(rho - 1)^2 - 1e-14 is negative between 1 - 1e-7 and 1 + 1e-7: the cells there refuse."""
    with pytest.raises((GeometryError, ConfigError), match="L2"):
        region_map({"rho": [0, "5/2"], "F3": [-10, 0]}, L2="(rho-1)^2-1e-14", F4=-10)


def test_denominators() -> None:
    """L2 = 1/rho: the same points as on the slice with L2 as an axis."""
    result = region_map({"rho": ["1/2", 2], "F3": [-10, 0]}, L2="1/rho", F4=-10)
    assert {cell.stable for cell in result.cells} == {1, 2}


def test_a_pole_on_the_edge() -> None:
    region_map({"rho": [0, 2], "F": [-10, 0]}, L2="1/rho", F3="F", F4="F")


def test_stiffness_axes() -> None:
    region_map({"k": [0, 200], "F3": [-10, 0]}, F4=-10, L2="3/2", rho=1)
    region_map({"k1": [50, 150], "k3": [50, 150]}, k2=100, F3=-10, F4=-10, rho="3/4")


@pytest.mark.parametrize("base", ["1", "0.4981313"])
def test_a_window_of_width_1e_20(base: str) -> None:
    low = Fraction(base)
    axes = {
        "rho": [str(low), str(low + Fraction(1, 10**20))],
        "L2": ["3/2", str(Fraction(3, 2) + Fraction(1, 10**20))],
    }
    result = region_map(axes, F3=-10, F4=-10)
    assert len(result.regions) == 1


@pytest.mark.slow
def test_a_tiny_window_across_the_curve() -> None:
    """Around the end 0.498131... at L2 = 3/2, found by bisection with the oracle: two regions in a
    window of 1e-20.
    """
    fixed = {n: Fraction(v) for n, v in {"L1": 1, "L2": "3/2", "k1": 100, "k2": 100, "k3": 100, "F3": -10, "F4": -10,
                                         "F3x": 0, "F4x": 0}.items()}  # fmt: skip
    low, high = Fraction("0.49813"), Fraction("0.49814")
    while high - low > Fraction(1, 10**24):
        middle = (low + high) / 2
        low, high = (
            (middle, high) if oracle.count({**fixed, "rho": middle})[0] == 1 else (low, middle)
        )
    half = Fraction(1, 2 * 10**20)
    axes = {
        "rho": [str(low - half), str(low + half)],
        "L2": [str(Fraction(3, 2) - half / 100), str(Fraction(3, 2) + half / 100)],
    }
    result = region_map(axes, "stable", F3=-10, F4=-10)
    assert sorted(r.stable for r in result.regions) == [1, 2]  # type: ignore[type-var]


@pytest.mark.slow
def test_forty_digits() -> None:
    digits = "1.414213562373095048801688724209698078569"
    result = region_map(RHO_L2, L1=digits, F3="-10.000000000000000000000000000000000000001", F4=-10)
    assert result.slice.parameters["L1"].constant() == Fraction(digits)


def test_extreme_numbers() -> None:
    region_map(RHO_L2, F3="-1e-6", F4="-1e-6", count="total")
    region_map({"rho": ["1e-12", "2e-12"], "L2": ["1e-12", "2e-12"]}, F3=-10, F4=-10)


@pytest.mark.slow
def test_a_vast_window() -> None:
    """The sliver near the origin is some 10^-28 of the window."""
    result = region_map({"rho": [0, "1e12"], "L2": [0, "1e12"]}, F3=-10, F4=-10)
    assert sorted((r.total, r.stable) for r in result.regions) == [(4, 1), (6, 1), (6, 2)]  # type: ignore[type-var]


@pytest.mark.slow
@pytest.mark.parametrize("load", ["-1e-10", "-1e-30"])
def test_tiny_loads(load: str) -> None:
    region_map(RHO_L2, F3=load, F4=load)


@pytest.mark.parametrize(
    "high", ["0.50000000001", "0.5000000000000000000001", "0.49999999999", "1/2"]
)
@pytest.mark.parametrize("axes", [("L2", "rho"), ("rho", "L2")], ids=",".join)
@pytest.mark.slow_cases("L2,rho-0.5000000000000000000001", "rho,L2-0.50000000001")
def test_critical_values_at_the_windows_edge(high: str, axes: tuple[str, str]) -> None:
    """Unloaded lines meet at rho = 1/2, L2 = 0 and near it: just inside, on and just outside the
    edge.
    """
    windows = {"L2": [0, 4], "rho": [0, high]}
    result = region_map({n: windows[n] for n in axes}, "stable")
    assert sorted(r.stable for r in result.regions).count(2) == 1  # type: ignore[type-var]


def test_one_region() -> None:
    result = region_map({"rho": [3, 4], "L2": [1, 2]}, F3=-10, F4=-10)
    assert [(r.stable, r.area) for r in result.regions] == [(1, (Fraction(1), Fraction(1)))]


def test_opposite_loads() -> None:
    """P and Q of the oracle vanish together: loads under which a rod stands by itself."""
    region_map({"rho": [0, 2], "F": [-20, 20]}, F3="F", F4="-F", L2="3/2")


def test_a_time_limit_stops() -> None:
    with pytest.raises(LimitReached):
        classify(load(CONFIGS / "fig4.yaml"), timeout=0.001)


@pytest.mark.parametrize(
    "options",
    [
        {"engine": "guess"},
        {"count": "none"},
        {"area_tolerance": 0},
        {"area_tolerance": "x"},
        {"area_tolerance": 2},
    ],
)
def test_wrong_options(options: dict[str, Any]) -> None:
    with pytest.raises(ConfigError):
        classify(load(CONFIGS / "fig2.yaml"), **options)


@pytest.mark.parametrize(
    "stage",
    ["stages.discriminant_variety", "cad.decomposition.project", "areas.regionareas.region_areas"],
)
@pytest.mark.slow_cases("stages.discriminant_variety", "areas.regionareas.region_areas")
def test_a_limit_leaves_the_best_map_so_far(stage: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever was reached is a partial map that can be written, read and asked, and gives no
    undecided count.
    """
    record = load(CONFIGS / "stiffness.yaml")
    expected = classify(record, area_tolerance="1/10").locate(k=100, rho="7/10")

    def stop(*_arguments: object) -> None:
        raise LimitReached("the limit of this test")

    monkeypatch.setattr(f"ptmcad.exact.{stage}", stop)
    with pytest.raises(LimitReached) as stopped:
        classify(record)
    partial = stopped.value.partial
    if stage == "stages.discriminant_variety":
        assert partial is None
        return
    assert isinstance(partial, RegionMap)
    assert partial.status.value == "partial"
    assert RegionMap.from_json(partial.to_json()) == partial
    assert len(partial.table().splitlines()) == 5
    place = partial.locate(k=100, rho="7/10")
    if stage == "cad.decomposition.project":
        assert (place.status.value, place.stable) == ("undecided", None)
    else:
        assert place == expected
        assert all(r.area == (0, 400) for r in partial.regions)


def test_a_time_limit_of_no_time_stops_at_once() -> None:
    with pytest.raises(LimitReached):
        classify(load(CONFIGS / "fig4.yaml"), timeout=1e-9)


@pytest.mark.slow
def test_plain_decimals_with_long_coefficients() -> None:
    """F3 = -0.001 and a 40-digit rod: factors with coefficients longer than a machine word."""
    small = region_map(RHO_L2, F3="-0.001", F4="-10")
    assert {r.stable for r in small.regions} == {1, 2}
    record = {"axes": {"L2": ["0", "4e-30"], "rho": ["0", "4e-30"]}, "parameters": {"L1": "1e-30"}}
    scaled = classify(slice_from_mapping(record))
    assert len(scaled.regions) == 4
    assert (
        min(r.area[0] for r in scaled.regions)
        <= Fraction("0.25e-60")
        <= min(r.area[1] for r in scaled.regions)
    )


def test_equal_eigenvalues_with_another_that_is_rational() -> None:
    """The Hessian is diag(0, 0, 1), of which FLINT's enclosures separate nothing."""
    system = ptmcad.System(
        parameters={"a": {}, "b": {}},
        unknowns={"x": "real", "y": "real", "z": "real"},
        potential="x^4/4 - a*x^2/2 + y^4/4 - b*y^2/2 + z^2/2",
    )
    (pose,) = ptmcad.solve(model=system, a=0, b=0).equilibria
    assert [value.exact for value in pose.eigenvalues] == [0, 0, 1]
    assert pose.multiplicity == 9
