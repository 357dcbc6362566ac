"""Pictures: what is drawn is what the map says, nothing is hidden, and the bytes are the same every
time.
"""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import combinations, pairwise, product
from pathlib import Path
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from support.maps import shipped
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import (
    Cell,
    Component,
    Kind,
    Region,
    RegionMap,
    Stack,
    Status,
    System,
    Wall,
)
from ptmcad.model import known_of
from ptmcad.question.slice import Axis, Count, Point, Slice
from ptmcad.show.render import draw
from ptmcad.show.render.axes import heading_of, symbol
from ptmcad.show.render.colours import ONE_MAXIMUM, TWO_MAXIMA, fill_of, fill_of_index
from ptmcad.show.render.labels import Label, overlap, place
from ptmcad.show.render.outline import outline
from ptmcad.show.render.slivers import zooms
from ptmcad.show.render.view import View
from ptmcad.show.units import unit
from ptmcad.text.plane import PlanePolynomial

ROOT = Path(__file__).resolve().parents[2]
MAPS = [
    ("fig2", "stable"),
    ("fig3", "stable"),
    ("fig3", "index"),
    ("fig4", "index"),
    ("forces", "total"),
]
HALF = Fraction(1, 2)


def classified(name: str, count: str) -> RegionMap:
    return shipped(name, None if count == "stable" else count)


def bands(
    heights: list[Fraction],
    slope: Fraction = HALF,
    counts: list[int] | None = None,
    window: tuple[tuple[Fraction, Fraction], tuple[Fraction, Fraction]] = (
        (Fraction(0), Fraction(1)),
    )
    * 2,
    title: str = "",
    names: tuple[str, str] = ("a", "b"),
    base: int = 0,
) -> RegionMap:
    """A map whose walls are parallel lines, v = height + slope u in fractions of the window's
    sides.

    Its regions' areas are those of the bands in fractions of the window (where the bands do not
    leave it).
    """
    (p, q), (r, t) = window[base], window[1 - base]
    lines = []
    for h in heights:
        m = (t - r) * slope / (q - p)
        c = r + (t - r) * h - m * p
        d = m.denominator * c.denominator
        terms = [(0, 1, d), (1, 0, -m * d), (0, 0, -c * d)]
        turned = PlanePolynomial.of((j, i, int(k)) if base else (i, j, int(k)) for i, j, k in terms)
        lines.append(Component(turned, Kind.CRITICAL, "", True))
    levels = [-slope / 2, *heights, 1 - slope / 2]
    counts = counts or [1 + k % 2 for k in range(len(heights) + 1)]

    def sample(k: int) -> Point:
        u, v = (p + q) / 2, r + (t - r) * ((levels[k] + levels[k + 1]) / 2 + slope / 2)
        return Point(names, *((v, u) if base else (u, v)))

    numbers = range(len(counts))
    return RegionMap(
        slice=Slice(
            "bands",
            known_of("other"),
            (Axis(names[0], *window[0]), Axis(names[1], *window[1])),
            {},
            title=title,
        ),
        status=Status.EXACT,
        system=System((), (), "0", (), ()),
        base=base,
        components=tuple(lines),
        stacks=(
            Stack(
                None,
                None,
                (p + q) / 2,
                tuple(Wall(k, 0) for k in range(len(heights))),
                tuple(numbers),
            ),
        ),
        cells=tuple(Cell(0, k, sample(k), k, None, counts[k], None) for k in numbers),
        regions=tuple(
            Region(counts[k], None, None, (levels[k + 1] - levels[k],) * 2, (k,), sample(k))
            for k in numbers
        ),
        undetermined=Fraction(0),
        versions={},
    )


def svg(result: RegionMap, folder: Path, **options: object) -> str:
    draw(result, folder / "map.svg", **options)  # type: ignore[arg-type]
    return (folder / "map.svg").read_text(encoding="utf-8")


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


# ------------------------------------------------------------------------------------------------------ the outline


@pytest.mark.parametrize(("name", "count"), MAPS)
@pytest.mark.slow_cases("fig4-index", "forces-total")
def test_polygons_have_the_certified_areas(name: str, count: str) -> None:
    result = classified(name, count)
    whole = outline(result)
    sides = [a.high - a.low for a in result.slice.axes]
    for number, region in enumerate(result.regions):
        parts = [area(p) for p in whole.polygons()[number]]
        assert all(a >= 0 for a in parts) or all(a <= 0 for a in parts), (
            "all parts turn the same way"
        )
        drawn = abs(sum(parts)) * float(sides[0] * sides[1])
        assert drawn == pytest.approx(
            float(region.area[0]), rel=2e-3, abs=2e-4 * float(sides[0] * sides[1])
        )


@pytest.mark.parametrize(
    "view", [None, View((Fraction(0), Fraction(1, 300)), (Fraction(4, 5), Fraction(6, 5)))]
)
def test_vertices_lie_on_the_curve(view: View | None) -> None:
    """The stored polynomial changes its sign near every vertex."""
    result = classified("fig4", "index")
    seen = outline(result, view)
    (left, right), (bottom, top) = seen.view.x, seen.view.y
    e = 3e-5
    tested = 0
    for component, _, line in seen.walls():
        polynomial = result.components[component].polynomial
        for x, y in line[2:-2]:
            if 0.01 < x < 0.99 and 0.01 < y < 0.99:
                signs = {
                    polynomial(
                        left + Fraction(x + dx) * (right - left), bottom + Fraction(y + dy) * (top - bottom)
                    ) > 0
                    for dx in (-e, e)
                    for dy in (-e, e)
                }  # fmt: skip
                assert len(signs) == 2
                tested += 1
    assert tested > 20


@pytest.mark.parametrize(("name", "count"), MAPS)
@pytest.mark.slow_cases("forces-total")
def test_the_raster_agrees_with_locate(name: str, count: str) -> None:
    result = classified(name, count)
    image = outline(result).raster(23, 19)
    assert image.shape == (19, 23)
    (x, y) = result.slice.axes
    names = result.slice.axis_names
    for row in range(0, 19, 2):
        for column in range(0, 23, 3):
            at = (
                x.low + (x.high - x.low) * Fraction(2 * column + 1, 46),
                y.low + (y.high - y.low) * Fraction(2 * row + 1, 38),
            )
            located = result.locate(**dict(zip(names, at, strict=True)))
            if located.region is not None:
                assert image[row, column] == located.region


# ------------------------------------------------------------------------------------------------------ the slivers


def test_no_sliver_where_all_is_seen(tmp_path: Path) -> None:
    text = svg(classified("fig2", "stable"), tmp_path)
    assert 'id="sliver-' not in text
    assert 'id="arrow-' not in text


@pytest.mark.parametrize(("name", "x_end"), [("fig3", "0.004"), ("fig4", "0.004")])
@pytest.mark.slow_cases("fig4-0.004")
def test_the_sliver_has_an_arrow_and_an_inset(name: str, x_end: str, tmp_path: Path) -> None:
    result = classified(name, "index")
    thin = [n for n, r in enumerate(result.regions) if r.index == (1, 3, 2)]
    text = svg(result, tmp_path)
    assert len(thin) == 1
    assert f'id="sliver-{thin[0]}"' in text
    assert f'id="sliver-{thin[0]}-region-{thin[0]}"' in text
    assert f'id="arrow-{thin[0]}"' in text
    ((seen, slivers),) = zooms(outline(result), thin)
    assert seen.view.x[1] < Fraction(x_end)
    assert (
        result.locate(**dict(zip(result.slice.axis_names, slivers[0].at, strict=True))).region
        == thin[0]
    )


def test_every_region_can_be_zoomed() -> None:
    result = classified("fig4", "index")
    whole = outline(result)
    found = zooms(whole, range(len(result.regions)))
    assert sorted(s.region for _, slivers in found for s in slivers) == list(
        range(len(result.regions))
    )


def test_labels_of_crowded_tips_are_apart() -> None:
    labels = [Label("A: (1, 3, 2)", (166 + 3.3 * k, 166.0), (27.0, 7.8)) for k in range(8)]
    found = place(labels, (), (), (0.0, 0.0, 331.2, 331.2))
    assert not any(overlap(a.box, b.box) for a, b in combinations(found, 2))


# ----------------------------------------------------------------------------------------------------- the picture


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
@pytest.mark.slow_cases("pdf", "png")
def test_the_same_bytes_twice(suffix: str, tmp_path: Path) -> None:
    for k in range(2):
        draw(classified("fig3", "index"), tmp_path / f"{k}.{suffix}")
    assert (tmp_path / f"0.{suffix}").read_bytes() == (tmp_path / f"1.{suffix}").read_bytes()


@pytest.mark.parametrize(("name", "count"), MAPS)
@pytest.mark.fast_cases("fig2-stable", "forces-total")
def test_svg_is_described_small_and_named(name: str, count: str, tmp_path: Path) -> None:
    result = classified(name, count)
    text = svg(result, tmp_path)
    assert len(text) < 400_000
    root = ElementTree.fromstring(text)
    namespace = "{http://www.w3.org/2000/svg}"
    assert root.findtext(f"{namespace}title") == heading_of(result.slice)
    assert "Regions of equal count" in (root.findtext(f"{namespace}desc") or "")
    identifiers = [e.get("id") for e in root.iter() if e.get("id")]
    assert len(identifiers) == len(set(identifiers))
    assert {f"region-{n}" for n in range(len(result.regions))} <= set(identifiers)
    assert any(re.fullmatch(r"curve-\d+", i) for i in identifiers)
    assert "dc:date" not in text and "Matplotlib v" not in text


def test_global_state_is_left_alone(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    draw(classified("fig2", "stable"), tmp_path / "map.svg")
    assert dict(matplotlib.rcParams) == before


def test_samples_are_drawn_when_asked_for(tmp_path: Path) -> None:
    result = classified("fig4", "stable")
    assert 'id="samples"' not in svg(result, tmp_path)
    text = svg(result, tmp_path, samples=True)
    samples = text[text.index('id="samples"') :].split("</g>\n  </g>")[0]
    assert samples.count("<use ") >= len(result.cells)


def test_walls_that_separate_nothing_are_thin(tmp_path: Path) -> None:
    """With counts of stable equilibria the (1, 3, 2) sliver's boundary separates nothing."""
    stable, index = (
        svg(classified("fig3", "stable"), tmp_path),
        svg(classified("fig3", "index"), tmp_path),
    )
    assert re.search(r'id="curve-\d+-thin"', stable)
    assert not re.search(r'id="curve-\d+-thin"', index)


def test_dollars_are_no_mathematics(tmp_path: Path) -> None:
    assert "Oblique" not in svg(bands([], title="$x_1$"), tmp_path), "the font of mathematics"


def test_another_format_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="gif"):
        draw(classified("fig2", "stable"), tmp_path / "map.gif")


@pytest.mark.parametrize("suffix", ["svg", "png", pytest.param("pdf", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "result",
    [
        pytest.param(bands([]), id="one region"),
        pytest.param(bands([Fraction(0)], slope=Fraction(1)), id="corner to corner"),
        pytest.param(
            bands([HALF], title="$5 & <b>x_1^{ \\frac \x07 ü ρ 弹 % #"), id="special characters"
        ),
        pytest.param(bands([HALF], names=("rho_very_long_" * 9, "b_$c")), id="long names"),
        pytest.param(bands([HALF], title="word " * 200), id="long title"),
        pytest.param(
            bands(
                [HALF / 2],
                window=(
                    (Fraction(0), Fraction(1, 10**20)),
                    (Fraction(-(10**20)), Fraction(10**20)),
                ),
            ),
            id="1e-20 and 1e20",
        ),
        pytest.param(
            bands(
                [HALF / 2],
                window=((Fraction(10**20), 10**20 + Fraction(1)), (Fraction(0), Fraction(10**400))),
            ),
            id="beyond floats",
        ),
        pytest.param(
            bands([Fraction(k, 40) for k in range(1, 20)], counts=list(range(20))), id="many counts"
        ),
    ],
)
@pytest.mark.slow_cases(
    "corner to corner-png",
    "special characters-png",
    "long names-svg",
    "long title-png",
    "1e-20 and 1e20-png",
    "beyond floats-png",
    "many counts-png",
)
def test_degenerate_maps_are_drawn(result: RegionMap, suffix: str, tmp_path: Path) -> None:
    draw(result, tmp_path / f"map.{suffix}", samples=True)
    assert (tmp_path / f"map.{suffix}").stat().st_size > 1000
    if suffix == "svg":
        ElementTree.parse(tmp_path / "map.svg")


# ------------------------------------------------------------------------------------------------ colours and names


def lightness(colour: str) -> float:
    """CIE L*."""
    channels = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)]
    return 116 * float(np.dot((0.2126, 0.7152, 0.0722), channels)) ** (1 / 3) - 16


@pytest.mark.parametrize("row", [ONE_MAXIMUM, TWO_MAXIMA])
def test_the_palette_falls_in_lightness(row: tuple[str, ...]) -> None:
    for first, second in pairwise(row):
        assert lightness(first) - lightness(second) >= 6


@pytest.mark.parametrize("unknowns", [1, 2])
def test_indices_of_any_sum_have_different_fills(unknowns: int) -> None:
    """On lines, or where inequalities leave solutions out, the sum of the indices need not be zero."""
    fills = [fill_of_index(index) for index in product(range(4), repeat=unknowns + 1)]
    assert len(set(fills)) == len(fills)


@pytest.mark.parametrize("maxima", range(3))
def test_indices_of_three_unknowns_with_as_many_maxima_have_different_fills(maxima: int) -> None:
    fills = [
        fill_of_index((minima, saddles, 0, maxima)) for minima in range(5) for saddles in range(5)
    ]
    assert len(set(fills)) == len(fills)
    assert all(len(fill.hatch) < 20 for fill in fills)


def region(
    stable: int = 0, total: int = 0, index: tuple[int, int, int] = (0, 0, 0), admissible: int = 0
) -> Region:
    at = Point(("a", "b"), HALF, HALF)
    return Region(
        stable, total, index, (Fraction(1), Fraction(1)), (0,), at, {"admissible": admissible}
    )


@pytest.mark.parametrize("count", list(Count))
def test_different_counts_have_different_fills(count: Count) -> None:
    regions = {
        Count.STABLE: [region(stable=n) for n in range(40)],
        Count.TOTAL: [region(total=n) for n in range(40)],
        Count.ADMISSIBLE: [region(admissible=n) for n in range(40)],
        Count.INDEX: [
            region(index=(a, a + b, b)) for a in range(9) for b in range(9)
        ],  # on a torus
    }[count]
    fills = [fill_of(r, count) for r in regions]
    assert len(set(fills)) == len(fills)


def test_the_same_count_has_the_same_colour_in_every_picture() -> None:
    assert fill_of(region(stable=1), Count.STABLE) == fill_of(region(index=(1, 2, 1)), Count.INDEX)
    assert fill_of(region(stable=2), Count.STABLE) == fill_of(region(index=(2, 3, 1)), Count.INDEX)
    assert fill_of(region(stable=2), Count.STABLE) == fill_of(region(total=6), Count.TOTAL)


@pytest.mark.parametrize(
    ("name", "printed"),
    [("rho", "ρ"), ("L2", "L₂"), ("F3x", "F₃ₓ"), ("k", "k"), ("k1", "k₁"), ("load", "load")],
)
def test_symbols(name: str, printed: str) -> None:
    assert symbol(name) == printed


def test_units() -> None:
    assert [unit(ptmcad.load(ROOT / "configs" / "fig3.yaml"), k) for k in (0, 1)] == [
        "length",
        "force",
    ]
    assert [unit(ptmcad.load(ROOT / "configs" / "stiffness.yaml"), k) for k in (0, 1)] == [
        "force/length",
        "length",
    ]
    assert (
        unit(replace(ptmcad.load(ROOT / "configs" / "fig3.yaml"), model=known_of("other")), 0) == ""
    )
