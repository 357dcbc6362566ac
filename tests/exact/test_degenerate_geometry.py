"""Degenerate geometry of the variety, by name, on slices of the mechanism: classified, located and
verified.

Without loads and with L1 = rho = 1 there are two stable equilibria where 1 < L2 < 3 and one
elsewhere. So L2 = 1 + g(x, y)/1000 makes any plane curve g = 0 the variety, with two stable
equilibria where g > 0. Loaded slices have rational singular points too (see
`random_slices.singular`): cusps, and the point where the whole Hessian vanishes, which is isolated.
The synthetic curves of `test_topology` have the same names.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any

import pytest
from support import oracle
from support.random_slices import paper_cusp
from support.structure import check_structure
from test_topology import KNOWN

from ptmcad import RegionMap, classify, slice_from_mapping, verify
from ptmcad.answer.regionmap import Merge, Status

TINY = Fraction(1, 10**40)
SQUARE = ("-2", "2", "-2", "2")
THIN = ("-5e-31", "5e-31", "-4e-31", "5e-31")
"""A window of width 1e-30 around the origin, which is off its middle."""

Window = tuple[str, str, str, str]
Ring = tuple[int, ...]

CURVES: dict[str, tuple[str, Window, Ring, int, str]] = {
    # name in the issue: the curve g = 0, the window, the regions' stable counts, the number of
    # pairs of regions that share a wall, and what the origin is: on the variety, outside the
    # window, or in a cell ("exact")
    "node": ("y^2-x^2*(x+1)", SQUARE, (1, 1, 2), 2, "on"),
    "node with one branch vertical": ("x*(y-x^2)", SQUARE, (1, 1, 2, 2), 4, "on"),
    "cusp": ("y^2-x^3", SQUARE, (1, 2), 1, "on"),
    "cusp that opens upward": ("y^3-x^2", SQUARE, (1, 2), 1, "on"),
    "rhamphoid cusp": ("(y-x^2)^2-x^5", ("-1", "1/2", "-1", "1"), (1, 2), 1, "on"),
    "isolated point": ("y^2-x^2*(x-1)", ("-1", "3", "-2", "2"), (1, 2), 1, "on"),
    "isolated point alone": ("x^2+2*y^2+x^4", SQUARE, (2,), 0, "on"),
    "vertical line": ("x", SQUARE, (1, 2), 1, "on"),
    "vertical lines at irrational abscissae": ("x^2-2", SQUARE, (1, 2, 2), 2, "exact"),
    "vertical line through a node": ("x*(y^2-x^2*(x+1))", SQUARE, (1, 1, 2, 2, 2), 5, "on"),
    "vertical line through a cusp": ("x*(y^2-x^3)", SQUARE, (1, 1, 2, 2), 4, "on"),
    "vertical tangents": ("(x-1)^2+y^2-1", ("-1", "3", "-2", "2"), (1, 2), 1, "on"),
    "vertical tangent at an inflection": ("x-y^3", SQUARE, (1, 2), 1, "on"),
    "vertical line along a vertical tangent": ("x*((x-1)^2+y^2-1)", ("-1", "3", "-2", "2"), (1, 1, 2), 2, "on"),
    "two curves touching": ("y*(y-x^2)", SQUARE, (1, 1, 2, 2), 4, "on"),
    "two curves touching, one inside the other": (
        "((x-1)^2+y^2-1)*((x-1/2)^2+y^2-1/4)", ("-1", "3", "-2", "2"), (1, 2, 2), 2, "on"),
    "two curves touching with a third order contact": ("y*(y-x^3)", SQUARE, (1, 1, 2, 2), 4, "on"),
    "a curve along the window's edge": ("y*(y-x+1)", ("-2", "2", "0", "2"), (1, 2), 1, "on the edge"),
    "curves along all edges": ("(x^2-4)*(y^2-4)", SQUARE, (2,), 0, "exact"),
    "triple point": ("x*y*(x-y)", SQUARE, (1, 1, 1, 2, 2, 2), 6, "on"),
    "triple point of curves with two tangents in common": ("x*(y-x^2)*(y+x^2)", SQUARE, (1, 1, 1, 2, 2, 2), 6, "on"),
    "curves through a window corner": ("(x-y)*(y-2*x)", ("0", "2", "0", "2"), (1, 1, 2), 2, "on the edge"),
    "a circle through all window corners": ("2-x^2-y^2", ("-1", "1", "-1", "1"), (2,), 0, "exact"),
    "a cusp in the window's corner": ("y^2-x^3", ("0", "2", "0", "2"), (1, 2), 1, "on the edge"),
    "a window of width 1e-30 around a cusp": ("y^2-x^3*1e30", THIN, (1, 2), 1, "on"),
    "a window of width 1e-30 around a node": ("y^2-x^2*(x+1)", THIN, (1, 1, 2, 2), 4, "on"),
    "a window of width 1e-30 around a smooth point": ("y-x-x^2", THIN, (1, 2), 1, "on"),
    "a window of width 1e-30 around a vertical tangent": ("x-1e29*y^2", THIN, (1, 2), 1, "on"),
    "a window of width 1e-30 around a triple point": ("1e60*x*y*(x-y)", THIN, (1, 1, 1, 2, 2, 2), 6, "on"),
    "a window of width 1e-30 around an isolated point": ("1e30*(x^2+y^2)", THIN, (2,), 0, "on"),
}  # fmt: skip
TWINS = ("a triple point", "a vertical tangent", "a node", "a smooth point")
THIN_TWINS = tuple(f"a window of width 1e-30 around {place}" for place in TWINS)
"""Points around which wider windows are tried too."""


def region_map(
    axes: dict[str, Any], parameters: dict[str, Any], count: str = "stable"
) -> RegionMap:
    record = {"name": "case", "axes": axes, "parameters": parameters, "count": count}
    result = classify(slice_from_mapping(record), area_tolerance="1/10")
    check_structure(result)
    report = verify(result)
    assert report.ok, report.violation
    return result


def separated(result: RegionMap) -> set[frozenset[int]]:
    """Pairs of regions that share a wall."""
    regions = [c.region for c in result.cells]
    return {
        frozenset((regions[a.first], regions[a.second]))
        for a in result.adjacencies
        if a.merge is Merge.SEPARATED
    }


def check_around(result: RegionMap, x: Fraction, y: Fraction, steps: tuple[Fraction, ...]) -> None:
    """In eight directions: the oracle's counts, or on the variety where the oracle finds a singular
    equilibrium.
    """
    names = result.slice.axis_names
    found = 0
    for step, (a, b) in product(steps, product((-1, 0, 1), repeat=2)):
        at = {names[0]: x + a * step, names[1]: y + b * step}
        place = result.locate(**at)
        if place.status in (Status.OUTSIDE, Status.ON_EDGE):
            assert any(not axis.low < at[axis.name] < axis.high for axis in result.slice.axes)
            continue
        values = {
            n: e.evaluate(at[names[0]], at[names[1]]) for n, e in result.slice.parameters.items()
        }
        if place.status is Status.ON_VARIETY:
            with pytest.raises(oracle.Degenerate):
                oracle.count(values)
        else:
            assert place.index == oracle.count(values), at
        found += 1
    assert found >= 2


@pytest.mark.parametrize(
    "swap", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["x,y", "y,x"]
)
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n in THIN_TWINS else n for n in CURVES]
)
@pytest.mark.fast_cases(
    "node with one branch vertical-x,y",
    "cusp that opens upward-x,y",
    "rhamphoid cusp-x,y",
    "isolated point-x,y",
    "vertical lines at irrational abscissae-x,y",
    "vertical line through a cusp-x,y",
    "two curves touching with a third order contact-x,y",
    "curves along all edges-x,y",
    "triple point-x,y",
    "a circle through all window corners-x,y",
    "a window of width 1e-30 around an isolated point-x,y",
)
def test_degenerate(name: str, swap: bool) -> None:
    g, (a, b, c, d), stable, pairs, origin = CURVES[name]
    axes = {"x": [a, b], "y": [c, d]}
    if swap:
        axes = {"y": axes["y"], "x": axes["x"]}
    # k does not matter without loads: it stands for a y that the curve does not use
    k = "100" if "y" in g else "100+y"
    result = region_map(axes, {"L1": 1, "rho": 1, "k": k, "L2": f"1+({g})/1000"})
    assert tuple(sorted(r.stable for r in result.regions)) == stable  # type: ignore[type-var]
    assert len(separated(result)) == pairs
    status = {"on": Status.ON_VARIETY, "on the edge": Status.ON_EDGE, "exact": Status.EXACT}[origin]
    assert result.locate(x=0, y=0).status is status
    width = Fraction(b) - Fraction(a)
    check_around(result, Fraction(0), Fraction(0), (width / 10, width * TINY))
    for cell in result.cells:
        values = {n: e.evaluate(*cell.sample) for n, e in result.slice.parameters.items()}
        assert cell.stable == (2 if values["L2"] > 1 else 1)


def test_the_synthetic_curves_have_these_names_too() -> None:
    for word in ("node", "cusp", "isolated", "vertical line", "vertical tangent", "tangent", "along the edge",
                 "lines through a point", "corner", "1e-30 around a cusp"):  # fmt: skip
        assert any(word in name for name in KNOWN), word


# ------------------------------------------------------------------------------------- singular points of loaded slices

Q = Fraction
SYMMETRIC = "fig. 4 with F = -60"


def exchanged(*axes: str) -> Any:
    """Axes of a case that is in the fast suite the other way round."""
    return pytest.param(axes, marks=pytest.mark.slow)


CUSPS = {
    SYMMETRIC: {"L1": Q(1), "L2": Q(24, 25), "rho": Q(2, 5), "F3": Q(-60), "F4": Q(-60)},
    "sines 3/5 and 5/13": paper_cusp((Q(4, 5), Q(3, 5)), (Q(12, 13), Q(5, 13))),
}
"""Rational cusps of the fold curve with k = 100 and vertical loads."""


def around(values: dict[str, Fraction], width: Fraction, *names: str) -> dict[str, list[str]]:
    return {n: [str(values[n] - width / 2), str(values[n] + width / 2)] for n in names}


def fixed(values: dict[str, Fraction], *axes: str) -> dict[str, str]:
    return {n: str(v) for n, v in values.items() if n not in axes}


@pytest.mark.parametrize(
    "axes", [("rho", "L2"), exchanged("L2", "rho"), ("F3", "F4")], ids=",".join
)
@pytest.mark.parametrize(
    "cusp", [pytest.param(c, marks=[pytest.mark.slow] * (c != SYMMETRIC)) for c in CUSPS]
)
@pytest.mark.slow_cases("fig. 4 with F = -60-F3,F4")
def test_a_cusp_of_the_fold_curve(cusp: str, axes: tuple[str, str]) -> None:
    """Two more equilibria, one of them a saddle, in a tongue that ends in the cusp."""
    values = CUSPS[cusp]
    width = Q(1, 50) if axes[0] in ("rho", "L2") else Q(1)
    check_cusp(values, axes, width)


@pytest.mark.slow
@pytest.mark.parametrize("axes", [("rho", "L2"), ("L2", "rho"), ("F3", "F4")], ids=",".join)
@pytest.mark.parametrize("cusp", CUSPS)
def test_a_window_of_width_1e_30_around_a_cusp_of_the_fold_curve(
    cusp: str, axes: tuple[str, str]
) -> None:
    check_cusp(CUSPS[cusp], axes, Q(1, 10**30))


def check_cusp(values: dict[str, Fraction], axes: tuple[str, str], width: Fraction) -> None:
    result = region_map(around(values, width, *axes), fixed(values, *axes), "index")
    assert sorted(r.total for r in result.regions) == [4, 6]  # type: ignore[type-var]
    assert len(separated(result)) == 1
    x, y = (values[n] for n in axes)
    assert result.locate(**{axes[0]: x, axes[1]: y}).status is Status.ON_VARIETY
    check_around(result, x, y, (width / 3, width * TINY))


@pytest.mark.parametrize(("axes", "width"), [
    (("rho", "L2"), "1e-30"),
    pytest.param(("F3", "F4"), "1/10", marks=pytest.mark.slow),
    pytest.param(("rho", "L2"), "1/10", marks=pytest.mark.slow),
    pytest.param(("F3", "F4"), "1e-30", marks=pytest.mark.slow),
], ids=lambda given: given if isinstance(given, str) else ",".join(given))  # fmt: skip
def test_an_isolated_point_where_the_whole_hessian_vanishes(
    axes: tuple[str, str], width: str
) -> None:
    """th1 + th2 = pi/2, sines 3/5 and 4/5, 2 rho = L1 c1 = L2 c2: an elliptic umbilic, cut where it
    has no width.
    """
    values = {"L1": Q(1), "L2": Q(4, 3), "rho": Q(2, 5), "F3": Q(-320, 3), "F4": Q(-60)}
    result = region_map(around(values, Q(width), *axes), fixed(values, *axes), "index")
    assert [r.index for r in result.regions] == [(1, 2, 1)]
    x, y = (values[n] for n in axes)
    assert result.locate(**{axes[0]: x, axes[1]: y}).status is Status.ON_VARIETY
    check_around(result, x, y, (Q(width) / 3, Q(width) * TINY))


@pytest.mark.parametrize("axes", [("rho", "F"), exchanged("F", "rho")], ids=",".join)
@pytest.mark.slow
def test_two_curves_touching_rose_and_astroid(axes: tuple[str, str]) -> None:
    """fig. 3: they touch at 2 rho = -F/k = 1/sqrt(2); the regions in both and in neither share that
    point only.
    """
    windows = {"rho": ["3/10", "2/5"], "F": [-80, -60]}
    result = region_map(
        {n: windows[n] for n in axes}, {"L1": 1, "L2": 1, "F3": "F", "F4": "F"}, "index"
    )
    assert sorted(r.index for r in result.regions) == [(1, 2, 1), (1, 2, 1), (1, 3, 2), (2, 3, 1)]  # type: ignore[type-var]
    assert len(separated(result)) == 4
    middle = {
        "rho": Q("0.35355339059327376220042218105242451964"),
        "F": Q("-70.710678118654752440084436210484903928"),
    }
    check_around(result, *(middle[n] for n in axes), (Q(1, 10**37), Q(1, 10**4)))


@pytest.mark.parametrize("axes", [("rho", "k"), exchanged("k", "rho")], ids=",".join)
def test_vertical_line_of_an_unloaded_slice(axes: tuple[str, str]) -> None:
    """Equal rods without loads, whatever k: two stable equilibria where rho < 1."""
    windows = {"rho": ["1/2", 2], "k": [50, 200]}
    result = region_map({n: windows[n] for n in axes}, {"L1": 1, "L2": 1})
    one, two = sorted(result.regions, key=lambda r: r.stable or 0)
    assert (one.stable, two.stable) == (1, 2)
    assert one.area[0] <= 150 <= one.area[1]
    assert two.area[0] <= 75 <= two.area[1]
    assert result.locate(rho=1, k=100).status is Status.ON_VARIETY
    assert result.locate(rho=1 - TINY, k=100).stable == 2
    assert result.locate(rho=1 + TINY, k=100).stable == 1
