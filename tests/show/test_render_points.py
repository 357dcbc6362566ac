"""Points on a map's picture: with the stable poses there, or measured by somebody."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import combinations, pairwise
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.path import Path as Course
from matplotlib.text import Text
from support.maps import shipped

from ptmcad.cli import run
from ptmcad.cli.plot import measured, places, poses_at
from ptmcad.errors import ConfigError
from ptmcad.show.render.around import draw_around
from ptmcad.show.render.labels import crosses
from ptmcad.show.render.mappicture import MapDrawing
from ptmcad.show.render.painting import Agreement
from ptmcad.show.render.printing import settings
from ptmcad.show.style import MIN_FONT, PAGE_HEIGHT, PictureStyle, styled

AT = ("rho=1,L2=3/2", "rho=3/2,L2=1/2", "rho=0.1,L2=1.8", "rho=1/4,L2=1/4")


@pytest.fixture
def stored(tmp_path: Path) -> str:
    path = tmp_path / "fig4.json"
    path.write_text(shipped("fig4").to_json())
    return str(path)


def around(texts: tuple[str, ...], style: PictureStyle) -> Figure:
    result = shipped("fig4")
    points = [(at, poses_at(result, at)) for at in places(result, texts)]
    with settings(style):
        made, _ = draw_around(MapDrawing(result, style, 100), points)
        FigureCanvasAgg(made).draw()
    return made


@pytest.mark.parametrize(("texts", "size"), [
    pytest.param(texts, size, marks=() if (len(texts), size) in ((1, None), (len(AT), "13x7in")) else pytest.mark.slow)
    for texts in (AT[:1], AT[:2], AT) for size in (None, "13x7in")
])  # fmt: skip
@pytest.mark.slow_cases("texts5-13x7in")
def test_poses_stand_beside_the_map_each_led_to_its_point(
    texts: tuple[str, ...], size: str | None
) -> None:
    made = around(texts, styled(size=size))
    if size is not None:
        assert tuple(made.get_size_inches()) == (13, 7)
    panels = [axes for axes in made.axes if str(axes.get_gid()).startswith("pose-")]
    assert len(panels) == sum(2 if text == AT[0] else 1 for text in texts)
    (chart,) = (axes for axes in made.axes if axes.get_gid() == "map")
    for number, text in enumerate(texts, 1):
        (mark,) = [a for a in made.findobj(Line2D) if a.get_gid() == f"point-{number}"]
        (leader,) = [a for a in made.findobj(Line2D) if a.get_gid() == f"leader-{number}"]
        end = (leader.get_xdata()[-1], leader.get_ydata()[-1])
        assert end == (mark.get_xdata()[0], mark.get_ydata()[0])
        at = chart.transData.inverted().transform(made.dpi_scale_trans.transform(end))
        assert tuple(at) == pytest.approx(
            [float(v) for v in places(shipped("fig4"), [text])[0]], abs=1e-9
        )
    boxes = [axes.get_window_extent() for axes in (*panels, chart)]
    width, height = made.bbox.width, made.bbox.height
    assert all(b.x0 >= 0 and b.y0 >= 0 and b.x1 <= width and b.y1 <= height for b in boxes)
    assert not any(a.overlaps(b) for a, b in combinations([b.shrunk(0.98, 0.98) for b in boxes], 2))
    assert min(t.get_fontsize() for t in made.texts) >= MIN_FONT


def test_poses_without_room_are_refused_with_the_least_width(
    stored: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["plot", stored, "--at", AT[0], "--size", "3x4in"]) == 2
    said = capsys.readouterr().err
    assert "--size: poses beside the map need a width of 3.05 inches, and there are 3.00" in said
    assert run(["plot", stored, "--at", AT[0], "--size", "5.6x4in"]) == 0
    assert imread(tmp_path / "fig4.png").shape[:2] == (600, 840)


@pytest.mark.slow
def test_poses_that_are_too_tall_are_refused_by_the_option_with_a_size_that_does(
    stored: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = [word for text in AT[:2] for word in ("--at", text)]
    assert run(["plot", stored, "--style", "beamer", *points]) == 2
    said = capsys.readouterr().err
    assert re.search(
        r"error: --size: poses at 2 points need a height of [\d.]+ inches, and there are 2.76", said
    )
    (size,) = re.findall(r"such as ([\d.]+x[\d.]+in)", said)
    assert run(["plot", stored, "--style", "beamer", "--size", size, "--dpi", "50", *points]) == 0


def test_in_a_journals_style_poses_are_as_wide_as_two_columns(
    stored: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = [word for text in ("rho=1,L2=3/2", "rho=1/2,L2=1/2", "rho=3/2,L2=1/2", "rho=1/2,L2=7/4")
              for word in ("--at", text)]  # fmt: skip
    assert run(["plot", stored, *points, "--style", "ieee", "--dpi", "100"]) == 0
    assert "over two columns, 7.16 inches wide" in capsys.readouterr().err
    high, wide = imread(tmp_path / "fig4.png").shape[:2]
    assert wide == 716 and 400 < high <= 100 * PAGE_HEIGHT


@pytest.mark.slow
def test_lines_to_points_do_not_cross_and_hardly_cover_text() -> None:
    # for points in a row from above, straight lines from blocks beside them cross; and some lie
    # beside the legend
    texts = (
        "rho=1,L2=3/2",
        "rho=3/2,L2=1/2",
        "rho=1/2,L2=1/2",
        "rho=1/2,L2=7/4",
        "rho=7/4,L2=7/4",
        "rho=4/5,L2=1",
    )
    made = around(texts, styled())
    leaders = {
        a.get_gid(): a for a in made.findobj(Line2D) if str(a.get_gid()).startswith("leader-")
    }
    courses = [tuple(zip(*leader.get_data(), strict=True)) for leader in leaders.values()]
    assert len(courses) == len(texts)
    lines = [Course(course) for course in courses]
    assert not any(a.intersects_path(b, filled=False) for a, b in combinations(lines, 2))
    renderer = made.canvas.get_renderer()  # type: ignore[attr-defined]
    said = [text for text in made.findobj(Text) if text.get_text().strip() and text.get_visible()]
    boxes = [
        text.get_window_extent(renderer)
        for text in said
        if text.axes is None or text.axes.get_gid() == "map"
    ]
    strokes = [(*pair, 0.0) for course in courses for pair in pairwise(course)]
    covering = [
        s
        for s in strokes
        if any(crosses(s, tuple(v / made.dpi for v in (b.x0, b.y0, b.x1, b.y1))) for b in boxes)
    ]
    assert len(covering) <= 1


@pytest.mark.parametrize(
    ("text", "words"), [("rho=1", "rho and L2"), ("rho=1,L2=9", "outside"), ("rho=x,L2=1", "x")]
)
def test_a_bad_point_is_refused(
    text: str, words: str, stored: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["plot", stored, "--at", text]) == 2
    said = capsys.readouterr().err
    assert "--at" in said and words in said


def test_measured_points_are_compared_with_the_map(tmp_path: Path) -> None:
    table = tmp_path / "points.csv"
    table.write_text("L2,rho,label,count\n1.5,0.7,a,2\n1,1.5,b,2\n0.5,1.2,,\n9,9,out,1\n")
    found, outside = measured(shipped("fig4"), table)
    assert [agreement for _, _, agreement in found] == [
        Agreement.SAME,
        Agreement.OTHER,
        Agreement.UNTOLD,
    ]
    assert [label for _, label, _ in found] == ["a", "b", ""]
    assert found[0][0] == (Fraction(7, 10), Fraction(3, 2)) and outside == 1
    with settings():
        made = MapDrawing(shipped("fig4"), styled(size="6x4in"), 100, overlay=found).figure()
    said = [t.get_text() for t in made.texts]
    assert {"measured point", "measured, another count", "1 point"} <= set(said)
    marks = {
        a.get_gid(): a
        for a in made.axes[0].findobj(Line2D)
        if str(a.get_gid()).startswith("measured")
    }
    assert [float(v) for v in marks["measured-other"].get_data()[0]] == [0.75]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("rho,x\n1,2\n", "must name the axes"),
        ("rho,L2\n1,two\n", r"points.csv:2: unknown name 'two'"),
        ("", "must name"),
        ("rho,L2,count\n1,1,1\n\n1,1,x\n", r"points.csv:4: 'x' is not a count such as 2"),
        ("rho,L2,count\n1,1,-1\n", "is not a count"),
        ("rho,L2\n", "has no points"),
        ("rho,L2\n\n\n", "has no points"),
    ],
)
def test_a_bad_table_is_refused(content: str, words: str, tmp_path: Path) -> None:
    table = tmp_path / "points.csv"
    table.write_text(content)
    with pytest.raises(ConfigError, match=words):
        measured(shipped("fig4"), table)


def test_counts_are_compared_as_numbers(tmp_path: Path) -> None:
    table = tmp_path / "points.csv"
    table.write_text("rho,L2,count\n0.7,1.5,2.0\n0.7,1.5,02\n0.7,1.5,1\n")
    found, _ = measured(shipped("fig4"), table)
    assert [agreement for _, _, agreement in found] == [
        Agreement.SAME,
        Agreement.SAME,
        Agreement.OTHER,
    ]
    by_index = shipped("fig4", "index")
    table.write_text('rho,L2,count\n0.7,1.5,"2,3,1"\n0.7,1.5,"(2,  3, 1)"\n0.7,1.5,"(1,2,1)"\n')
    found, _ = measured(by_index, table)
    assert [agreement for _, _, agreement in found] == [
        Agreement.SAME,
        Agreement.SAME,
        Agreement.OTHER,
    ]
    table.write_text("rho,L2,count\n0.7,1.5,2\n0.7,1.5,2 of 6\n")
    with pytest.raises(ConfigError, match=r"points.csv:3: '2 of 6' is not a count by index"):
        measured(by_index, table)


def test_the_command_line_draws_measured_points(
    stored: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "points.csv"
    table.write_text("rho,L2,count,label\n1,1,,\n5,5,,\n1/2,1,2,a\n1,1,2,b\n3/2,1/3,2,\n")
    assert run(["plot", stored, "--format", "svg", "--overlay", str(table)]) == 0
    said = capsys.readouterr()
    assert "1 of 5 points are outside" in said.err
    assert said.out.splitlines()[:2] == [
        "another count than in the map: b, at rho = 1, L2 = 1",
        "another count than in the map: at rho = 1.5, L2 = 1/3",
    ]
    assert 'id="measured-untold"' in (tmp_path / "fig4.svg").read_text()
