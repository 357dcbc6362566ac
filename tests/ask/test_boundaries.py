"""Boundaries as polylines and grids of labels, against the curves and `locate` themselves."""

from __future__ import annotations

import random
from fractions import Fraction

import numpy as np
import pytest
import sympy
import yaml
from support.certified_map import STEPS, certified_map
from support.maps import shipped

import ptmcad
from ptmcad.answer.boundaries import NONE
from ptmcad.answer.regionmap import RegionMap, Status
from ptmcad.errors import ConfigError

SLICES = ("fig2", "fig3", "fig4", "forces")


def distance_along_fibre(points: np.ndarray, at: float, height: float) -> float:
    """From a point to the polyline, over the same abscissa; the points are (along, across) in
    increasing order.
    """
    return abs(float(np.interp(at, points[:, 0], points[:, 1])) - height)


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        ("fig2", "1/50"),
        ("fig3", "1/2000"),
        ("forces", "1/2000"),
        pytest.param("fig4", "1/50", marks=pytest.mark.slow),
    ],
)
@pytest.mark.fast_cases("fig2-1/50")
def test_every_point_of_a_curve_is_as_near_as_is_said(name: str, tolerance: str) -> None:
    """Roots from SymPy at random abscissae: each is near one polyline of its component, and each
    polyline near one.
    """
    result, source = shipped(name), random.Random(name)
    base, names = result.base, result.slice.axis_names
    along, across = result.slice.axes[base], result.slice.axes[1 - base]
    pieces = result.boundaries(tolerance)
    symbols = sympy.symbols(names)
    for _ in range(3):
        at = along.low + (along.high - along.low) * Fraction(source.randint(1, 9972), 9973)
        for number, component in enumerate(result.components):
            if component.left_out or component.polynomial.degrees[1 - base] == 0:
                continue
            p = sum(
                sympy.Integer(c) * symbols[0] ** i * symbols[1] ** j
                for i, j, c in component.polynomial.terms
            )
            fibre = sympy.Poly(
                p.subs(symbols[base], sympy.Rational(at.numerator, at.denominator)),
                symbols[1 - base],
            )
            roots = [float(r) for r in fibre.real_roots() if across.low < r < across.high]
            over = [
                (q, q.points[:, [base, 1 - base]])
                for q in pieces
                if q.component == number and q.points[0, base] <= at <= q.points[-1, base]
            ]
            assert len(over) == len(roots)
            for root in roots:
                assert (
                    min(distance_along_fibre(c, float(at), root) - q.distance for q, c in over)
                    < 1e-12
                )
            for q, c in over:
                assert (
                    q.distance
                    <= float(Fraction(tolerance) * (across.high - across.low)) * 1.0000001
                )
                assert (
                    min(distance_along_fibre(c, float(at), r) for r in roots) <= q.distance + 1e-12
                )


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n == "fig4" else n for n in SLICES]
)
@pytest.mark.slow_cases("fig3")
def test_regions_at_the_left_and_right_hand(name: str) -> None:
    """Over the middle of chords, twice the distance above and below, where no other curve is near."""
    result = shipped(name)
    base, names = result.base, result.slice.axis_names
    pieces = [(b, b.points[:, [base, 1 - base]]) for b in result.boundaries("1/200")]
    fibre = result.slice.axes[1 - base]
    asked = 0
    for piece, chain in pieces:
        for k in range(0, len(chain) - 1, 1 + len(chain) // 8):
            at, height = ((chain[k] + chain[k + 1]) / 2).tolist()
            away = 2 * piece.distance + 1e-9
            others = [
                np.interp(at, c[:, 0], c[:, 1])
                for o, c in pieces
                if o is not piece and c[0, 0] < at < c[-1, 0]
            ]
            if any(abs(h - height) < 3 * away for h in others):
                continue
            for v, region in ((height + away, (piece.left, piece.right)[base]),
                              (height - away, (piece.right, piece.left)[base])):  # fmt: skip
                if fibre.low < v < fibre.high:
                    asked += 1
                    assert result.locate(**{names[base]: at, names[1 - base]: v}).region == region
    assert asked > 4


def across(order: str) -> RegionMap:
    """z^2 = x (y - x): the line x = 0 across one of the axes, and two regions in opposite corners."""
    return ptmcad.classify(
        ptmcad.slice_from_mapping(
            {
                "name": "across", "system": {"unknowns": {"z": "real"}, "equations": ["z^2 - x*(y - x)"]},
                "axes": {name: [-1, 1] for name in order},
            }
        )
    )  # fmt: skip


@pytest.mark.parametrize("order", ["xy", "yx"])
def test_lines_have_the_regions_on_their_sides(order: str) -> None:
    result = across(order)
    lines = [b for b in result.boundaries() if not b.points[:, order.index("x")].any()]
    assert len(lines) == 2
    for b in lines:
        middle, step = b.points[:2].mean(axis=0), b.points[1] - b.points[0]
        for side, region in ((1, b.left), (-1, b.right)):
            point = middle + side * 1e-6 * np.array([-step[1], step[0]]) / np.hypot(*step)
            at = dict(zip(result.slice.axis_names, map(float, point), strict=True))
            assert result.locate(**at).region == region


@pytest.mark.parametrize("name", SLICES)
def test_a_grid_says_what_locate_says(name: str) -> None:
    result, source = shipped(name), random.Random(name)
    grid = result.grid(37, 53)
    assert grid.region.shape == (53, 37)
    (x, y), names = result.slice.axes, result.slice.axis_names
    for _ in range(80):
        row, column = source.randrange(53), source.randrange(37)
        at = (
            x.low + (x.high - x.low) * Fraction(2 * column + 1, 74),
            y.low + (y.high - y.low) * Fraction(2 * row + 1, 106),
        )
        found = result.locate(**dict(zip(names, at, strict=True)))
        said = (grid.cell, grid.region, grid.stable, grid.total)
        expected = (found.cell, found.region, found.stable, found.total)
        assert [a[row, column] for a in said] == [NONE if v is None else v for v in expected]
        assert (grid.x[column], grid.y[row]) == tuple(map(float, at))


def test_centres_on_curves_and_critical_values_have_no_label_or_the_right_one() -> None:
    """2 (x^2 + y^2) = 1 on [-2, 2]^2: with 4 columns (1/2, 1/2) is a centre, an odd number has one
    over 0.
    """
    record = yaml.safe_load("""
        name: circle
        system: {unknowns: {z: real}, equations: [z^2 + 2*x^2 + 2*y^2 - 1]}
        axes: {x: [-2, 2], y: [-2, 2]}
    """)
    result = ptmcad.classify(ptmcad.slice_from_mapping(record))
    for n in (4, 7, 20):
        grid = result.grid(n)
        for row, v in enumerate(grid.y):
            for column, u in enumerate(grid.x):
                square = Fraction(2 * column + 1 - n) ** 2 + Fraction(2 * row + 1 - n) ** 2
                inside = square * 8 - n * n
                assert grid.total[row, column] == (
                    NONE if inside == 0 else 2 if inside < 0 else 0
                ), (u, v)
    assert (result.grid(4).total == NONE).sum() == 4


@pytest.mark.parametrize(("columns", "rows"), [(24, 18), (8, 8), (STEPS, 1), (5, 40)])
def test_a_grid_over_a_certified_map(columns: int, rows: int) -> None:
    """Of 8 x 8 centres each lies on a line of the lattice both ways, and touches closed rectangles
    there.
    """
    result = certified_map()
    grid = result.grid(columns, rows)
    (x, y), names = result.slice.axes, result.slice.axis_names
    for row in range(rows):
        for column in range(columns):
            at = (
                x.low + (x.high - x.low) * Fraction(2 * column + 1, 2 * columns),
                y.low + (y.high - y.low) * Fraction(2 * row + 1, 2 * rows),
            )
            found = result.locate(**dict(zip(names, at, strict=True)))
            assert grid.cell[row, column] == (NONE if found.cell is None else found.cell)
    assert (grid.cell == NONE).any()


def test_the_outlines_of_a_certified_map_enclose_its_cells() -> None:
    """By the shoelace formula: 80, 70 and 35 of 256 squares."""
    result = certified_map()
    pieces = result.boundaries()
    for b in pieces:
        assert (b.points[0] == b.points[-1]).all()
        assert (b.right, b.distance, b.component) == (None, 0.0, None)
    areas = {
        b.left: float(np.sum(p[:-1, 0] * p[1:, 1] - p[1:, 0] * p[:-1, 1])) / 2
        for b in pieces
        for p in [b.points]
    }
    assert areas == {n: squares / 64 for n, squares in enumerate((80, 70, 35))}


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: r.boundaries("0"), "tolerance: 0 is not between 0 and 1"),
        (lambda r: r.boundaries("x"), "x"),
        (lambda r: r.grid(0), "columns=0 is not a positive whole number"),
        (lambda r: r.grid(3, 2.5), "rows=2.5 is not a positive whole number"),
        (lambda r: r.grid(True), "columns=True is not a positive whole number"),
        (lambda r: r.grid(10**5), "more than 100000000"),
    ],
)
def test_bad_requests_are_refused(call: object, message: str) -> None:
    assert callable(call)
    with pytest.raises(ConfigError, match=message):
        call(shipped("fig2"))


def test_a_map_without_cells_has_neither() -> None:
    empty = RegionMap(
        slice=shipped("fig2").slice, status=Status.PARTIAL, system=shipped("fig2").system,
        undetermined=Fraction(1), versions={},
    )  # fmt: skip
    for ask in (empty.boundaries, empty.grid):
        with pytest.raises(ConfigError, match="stopped before it had cells"):
            ask()
