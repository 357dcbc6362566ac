"""Pictures of a stated size and style: everything is on the page, nothing is too small to be read
on paper.
"""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Annotation, Text
from support.maps import CONFIGS, shipped
from support.replacing import replace
from test_render import bands

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.question.slice import Count
from ptmcad.show.render import draw
from ptmcad.show.render.colours import GREYS, filler
from ptmcad.show.render.fitting import rewrapped
from ptmcad.show.render.legend import Type, entries
from ptmcad.show.render.mappicture import MapDrawing, left_out
from ptmcad.show.render.printing import settings
from ptmcad.show.render.slivers import told_apart
from ptmcad.show.style import MIN_FONT, PRESETS, LegendPlace, PictureStyle, styled

SLIVERS = [Fraction(k // 2 + 1, 8) + (k % 2) * Fraction(1, 10**5) for k in range(6)]
MAPS = {
    "fig2": lambda: shipped("fig2"),
    "fig4": lambda: shipped("fig4"),
    "index": lambda: shipped("fig4", "index"),
    "slivers": lambda: bands(SLIVERS, title="word " * 30),
    "large numbers": lambda: bands(
        [Fraction(1, 2)], window=((Fraction(10**9), Fraction(10**9 + 1)),) * 2
    ),
}
JOURNALS = tuple(name for name in PRESETS if name != "default")
PAGES = [
    # every preset and every map with either place of the legend, and what has least room in the
    # smallest preset
    pytest.param(
        legend, preset, name, id=f"{legend}-{preset}-{name}",
        marks=() if (k - j) % len(MAPS) == i or (preset, name) == ("ieee", "slivers") else pytest.mark.slow,
    )
    for i, legend in enumerate((None, "below")) for j, preset in enumerate(JOURNALS) for k, name in enumerate(MAPS)
]  # fmt: skip


def figure(result: RegionMap, style: PictureStyle) -> Figure:
    with settings(style):
        made = MapDrawing(result, style, 100, samples=True).figure()
        FigureCanvasAgg(made).draw()
    return made


def texts(made: Figure) -> list[Text]:
    return [t for t in made.findobj(Text) if t.get_text() and t.get_visible()]


@pytest.mark.parametrize(("legend", "preset", "name"), PAGES)
@pytest.mark.slow_cases(
    "None-ieee-fig2",
    "None-ieee-slivers",
    "None-beamer-slivers",
    "below-ieee-slivers",
    "below-elsevier-index",
    "None-elsevier-fig4",
    "None-poster-large numbers",
    "below-ieee-fig4",
    "below-springer-slivers",
)
def test_everything_is_on_the_page_apart_and_legible(
    legend: str | None, preset: str, name: str
) -> None:
    style = styled(preset, legend=legend)
    if legend == "below" and style.size is not None:
        style = style._replace(size=(style.size[0], 1.5 * style.size[1]))
    with settings(style):
        made = MapDrawing(MAPS[name](), style, 100, samples=True).figure()
        canvas = FigureCanvasAgg(made)
        canvas.draw()
        renderer = canvas.get_renderer()
        assert style.size == pytest.approx(tuple(made.get_size_inches()))
        assert min(t.get_fontsize() for t in texts(made)) >= MIN_FONT
        boxes = [t.get_window_extent(renderer) for t in made.texts]
        found = [a.get_tightbbox(renderer, bbox_extra_artists=[a.title]) for a in made.axes]
        boxes += [box for box in found if box is not None]
        width, height = canvas.get_width_height()
        for box in boxes:
            assert (
                box.x0 >= -0.5
                and box.y0 >= -0.5
                and box.x1 <= width + 0.5
                and box.y1 <= height + 0.5
            )
        for first, second in combinations(boxes, 2):
            overlap = first.intersection(first, second)
            assert overlap is None or min(overlap.width, overlap.height) < 1.5


@pytest.mark.parametrize(
    ("text", "inches"), [("3.5x2.6in", (3.5, 2.6)), ("90x70mm", (90 / 25.4, 70 / 25.4))]
)
@pytest.mark.slow_cases("3.5x2.6in-inches0")
def test_the_picture_has_the_size_that_is_asked_for(
    text: str, inches: tuple[float, float], tmp_path: Path
) -> None:
    draw(shipped("fig2"), tmp_path / "map.png", dpi=200, style=styled(size=text))
    rows, columns = imread(tmp_path / "map.png").shape[:2]
    assert (columns, rows) == tuple(int(200 * side) for side in inches)
    draw(shipped("fig2"), tmp_path / "map.svg", style=styled(size=text))
    found = re.search(r'width="([\d.]+)pt" height="([\d.]+)pt"', (tmp_path / "map.svg").read_text())
    assert found is not None
    assert (float(found[1]), float(found[2])) == pytest.approx(
        tuple(72 * side for side in inches), abs=0.01
    )


def legend_of(made: Figure) -> str:
    return " ".join(t.get_text() for t in made.texts)


def test_without_a_legend_there_is_none() -> None:
    made = figure(shipped("fig4"), styled("ieee", legend=LegendPlace.NONE))
    assert not made.texts
    assert made.axes[0].get_position().width > 0.75


def test_what_does_not_fit_is_refused_with_the_least_size_that_does() -> None:
    style = styled(size=(1.5, 1.2), font_size=8)
    with pytest.raises(ConfigError, match="least size") as caught:
        figure(shipped("fig4"), style)
    found = re.search(r"does is ([\d.]+x[\d.]+in)", caught.value.message)
    assert found is not None
    assert figure(shipped("fig4"), styled(style, size=found[1], font_size=8)).axes


def test_a_title_of_ones_own_or_none() -> None:
    assert "My title" in legend_of(figure(shipped("fig4"), styled("ieee", title="My title")))
    with settings():
        assert (
            MapDrawing(shipped("fig4"), dpi=100)
            .figure()
            .texts[0]
            .get_text()
            .startswith("Equal loads")
        )
        untitled = MapDrawing(shipped("fig4"), styled(title=""), 100).figure()
    assert "Equal loads" not in legend_of(untitled)


def test_colours_of_ones_own_are_those_of_the_counts_in_order(tmp_path: Path) -> None:
    draw(
        shipped("fig4"), tmp_path / "map.png", style=styled(palette="#123456, orange", size="3x3in")
    )
    image = imread(tmp_path / "map.png")[:, :, :3].reshape(-1, 3)
    colours, numbers = np.unique(np.round(image * 255).astype(int), axis=0, return_counts=True)
    found = {tuple(int(v) for v in c): n for c, n in zip(colours, numbers, strict=True)}
    first, second = (found[tuple(round(255 * v) for v in to_rgb(c))] for c in ("#123456", "orange"))
    assert first > 2 * second > 1000, "3.25 and 0.75 of the area"


def test_the_grey_palette_is_grey_and_tells_counts_apart(tmp_path: Path) -> None:
    draw(shipped("fig4", "index"), tmp_path / "map.png", style=styled("ieee", palette="grey"))
    image = imread(tmp_path / "map.png")[:, :, :3]
    assert np.ptp(image, axis=2).max() == 0
    steps = [int(face[1:3], 16) for face in GREYS]
    assert all(a - b >= 25 for a, b in pairwise(steps))
    many = bands([Fraction(k, 20) for k in range(1, 16)], counts=[2 * k for k in range(16)])
    for palette in ("grey", ("#ffffff", "#ff0000")):
        fill = filler(many.regions, many.slice.count, palette)
        assert len({fill(region) for region in many.regions}) == len(
            {r.stable for r in many.regions}
        )


def test_the_command_line_draws_in_a_style(tmp_path: Path) -> None:
    folder = str(tmp_path)
    assert (
        run(
            [
                "classify",
                "--slice",
                "L2,rho",
                "--out",
                folder,
                "--format",
                "json,png",
                "--style",
                "ieee",
            ]
        )
        == 0
    )
    assert imread(tmp_path / "slice-L2-rho.png").shape[:2] == (390, 525)
    assert (
        run(
            [
                "plot",
                str(tmp_path / "slice-L2-rho.json"),
                "--style",
                "ieee",
                "--size",
                "100x50mm",
                "--dpi",
                "254",
            ]
        )
        == 0
    )
    assert imread(tmp_path / "slice-L2-rho.png").shape[:2] == (500, 1000)


def test_a_map_is_plotted_as_objects_of_matplotlib(tmp_path: Path) -> None:
    result = shipped("fig4")
    made = result.plot(style="ieee", title="own")
    assert isinstance(made, Figure) and tuple(made.get_size_inches()) == (3.5, 2.6)
    made.savefig(tmp_path / "saved.png", dpi=100)
    assert imread(tmp_path / "saved.png").shape[:2] == (260, 350)
    with pytest.raises(ConfigError, match="no 'colour'"):
        result.plot(colour="red")


def test_a_map_is_drawn_into_axes_in_the_units_of_its_own(tmp_path: Path) -> None:
    result = shipped("fig4")
    page = Figure(figsize=(6, 3), dpi=100)
    left, right = page.subplots(1, 2)
    assert result.plot(ax=left, legend="none", palette="#123456,#ffa500") is left
    result.plot(ax=right, title="second")
    assert (left.get_xlim(), left.get_ylabel(), left.get_legend()) == ((0, 2), "L₂ (length)", None)
    assert [t.get_text() for t in right.get_legend().get_texts()] == ["1", "2"]
    many = replace(
        result, regions=tuple(replace(r, stable=8 + (r.stable or 0)) for r in result.regions)
    )
    legend = many.plot(ax=Figure().subplots()).get_legend()
    assert [t.get_text() for t in legend.get_texts()] == ["9", "10"]  # as numbers, not as texts
    left.set_xlim(0.5, 1.0)
    canvas = FigureCanvasAgg(page)
    canvas.draw()
    image = np.asarray(canvas.buffer_rgba())[::-1]
    for at, colour in (((0.6, 1.0), "#ffa500"), ((0.95, 0.5), "#123456")):
        column, row = left.transData.transform(at)
        assert tuple(image[int(row), int(column), :3] / 255) == pytest.approx(
            to_rgb(colour), abs=0.01
        )
        assert result.locate(rho=at[0], L2=at[1]).stable == (2 if colour == "#ffa500" else 1)


def test_a_thin_part_in_which_unstable_equilibria_differ_is_zoomed_and_named() -> None:
    made = figure(shipped("fig4"), styled(size="6x4in", font_size=9))
    (inset,) = made.axes[1:]
    assert inset.get_title(loc="left") == "1 of 6\nunstable ones differ, zoomed"
    assert any(str(artist.get_gid()).endswith("-thin") for artist in inset.findobj(LineCollection))
    (arrow,) = [t for t in made.findobj(Annotation) if str(t.get_gid()).startswith("arrow")]
    assert arrow.get_text() == "1 of 6"
    told = told_apart(shipped("fig4"))
    index = shipped("fig4", "index")
    assert sorted((r.stable, r.total, len(r.cells)) for r in told.regions) == sorted(
        (r.stable, r.total, len(r.cells)) for r in index.regions
    )


def thin_curves(made: Figure) -> list[object]:
    return [a for a in made.findobj(LineCollection) if str(a.get_gid()).endswith("-thin")]


def test_a_line_in_the_legend_has_something_to_show_and_what_is_shown_has_a_line() -> None:
    result = shipped("fig4")
    thin = replace(result, slice=replace(result.slice, count=Count.TOTAL))
    plain = figure(thin, styled(size="6x4in", font_size=9))
    assert "another curve" not in legend_of(plain) and not thin_curves(plain)
    # where the part's label has no room either, the curve's trace at the frame is left out, and
    # that is said
    drawing = MapDrawing(result, styled("ieee"), 100)
    seen, layout = drawing.fit()
    bare = replace(seen, views=(), thin_lines=False, unnamed=1)
    page = Figure(figsize=layout.size)
    with settings():
        drawing.draw_parts(page, bare, layout)
    assert not thin_curves(page)
    assert left_out(bare, layout) == (
        "1 inset of parts that are too thin to be seen", "labels of such parts, in which unstable ones differ"
    )  # fmt: skip
    tiny = seen.with_room((30.0, 30.0), 8.0)
    assert tiny.unnamed == 1 and not tiny.thin_lines and not tiny.views


@pytest.mark.parametrize("size", ["3.5x3in", "8x5in"])
@pytest.mark.slow_cases("8x5in")
def test_no_text_is_smaller_than_is_read_on_paper(size: str) -> None:
    """Even where the legend's own text is as small as that: details, numbers at insets and labels
    of arrows.
    """
    made = figure(bands(SLIVERS), styled(size=size, font_size=6))
    assert min(t.get_fontsize() for t in texts(made)) == MIN_FONT
    assert (len(made.axes) > 1) == (size == "8x5in")


@pytest.mark.parametrize("palette", ["red,red", "red,#FF0000", "red,blue,#f00"])
def test_a_palette_with_one_colour_twice_is_refused(palette: str) -> None:
    with pytest.raises(ConfigError, match="each once"):
        styled("default", palette=palette)


def test_a_heading_of_two_lines_is_in_one_size() -> None:
    chain = ptmcad.load(CONFIGS / "mechanisms" / "three-bar-chain.yaml")
    result = replace(shipped("fig2"), slice=replace(chain, count=Count.INDEX))
    with settings():
        told = next(entries(result, False, False, 0))
        assert len(told.lines) == told.heads == 2
        assert rewrapped(told, 3.0, Type()).heads == len(rewrapped(told, 3.0, Type()).lines)
