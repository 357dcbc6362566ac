"""Pictures of poses, of the energy over the torus, and of a map with poses: all is drawn, clear,
and the same again.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise

import matplotlib
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from support.examples import examples
from support.replacing import replace

import ptmcad
from ptmcad.answer.poses import Poses
from ptmcad.answer.regionmap import Status
from ptmcad.ask.solving import poses_at, solve
from ptmcad.errors import ConfigError
from ptmcad.show.render import printing
from ptmcad.show.render.energy import Energy
from ptmcad.show.render.labels import Label, crosses, overlap, place, polyline
from ptmcad.show.render.landscape import contour_levels, draw_landscape
from ptmcad.show.render.mechanism import PALE, STRONG
from ptmcad.show.render.posepicture import draw_poses
from ptmcad.show.render.posewords import printed_number, value_text
from ptmcad.show.render.sketch import (
    BAR_WIDTHS,
    PIN,
    SPIRAL,
    arrow_lengths,
    frame_of,
)
from ptmcad.text.enclosure import Enclosure

POINTS = {
    "paper, fig. 2": {"rho": "1", "L2": "3/2"},
    "paper, fig. 3": {"rho": "3/4", "F3": "-10", "F4": "-10"},
    "paper, fig. 4": {"rho": "7/10", "L2": "3/2", "F3": "-10", "F4": "-10"},
    "flat, springs of no length": {"rho": "1"},
    "fold": {"rho": "5/4", "L2": "3/2"},
    "all loads": {"rho": "4/5", "F3": "-3", "F4": "7", "F3x": "20", "F4x": "-1"},
    "rho = 1e-12": {"rho": "1e-12", "L2": "3/2", "F3": "-10", "F4": "-10", "F3x": "3"},
    "lengths 1e9 apart, loads 1e30": {"L2": "1e9", "F3": "1e30", "F4": "-1e29", "F4x": "1e30"},
    "lengths of 1e400": {"L1": "1e400", "L2": "2e400", "rho": "1e400"},
}
CASES = pytest.mark.parametrize("name", POINTS)
IN_DOUBLES = pytest.mark.parametrize(
    "name", [name for name in POINTS if name != "lengths of 1e400"]
)
DRAWN: list[Callable[[Poses], Figure]] = [draw_poses, draw_landscape]


@cache
def poses(name: str) -> Poses:
    return solve(**POINTS[name])


@cache
def picture(draw: Callable[[Poses], Figure], name: str) -> Figure:
    """A drawing for tests that look at it only."""
    return draw(poses(name))


def identifiers(figure: Figure, start: str) -> list[str]:
    return [a.get_gid() for a in figure.findobj() if a.get_gid() and a.get_gid().startswith(start)]  # type: ignore[misc]


# ------------------------------------------------------------------------------------------------------ the poses


@CASES
@pytest.mark.fast_cases("flat, springs of no length", "fold")
def test_every_pose_has_a_panel_with_all_its_parts(name: str) -> None:
    found, figure = poses(name), picture(draw_poses, name)
    assert len(figure.axes) == len(found.equilibria) >= 4 or found.status is Status.ON_VARIETY
    for number, axes in enumerate(figure.axes, 1):
        prefix = f"pose-{number}-"
        parts = [a.get_gid() for a in axes.get_children() if a.get_gid()]
        assert sum(p.startswith(f"{prefix}bar-") for p in parts) == 2
        assert sum(p.startswith(f"{prefix}spring-") for p in parts) == 3
        assert sum(p.startswith(f"{prefix}node-") for p in parts) == 4
        loads = {p.removeprefix(f"{prefix}load-") for p in parts if p.startswith(f"{prefix}load-")}
        assert loads == {n for n, v in found.parameters.items() if n.startswith("F") and v}
        labels = "".join(
            p.removeprefix(f"{prefix}label-") for p in parts if p.startswith(f"{prefix}label-")
        )
        assert sorted(labels.replace(", ", "")) == sorted("A₁A₂A₃A₄")


def test_stable_ones_come_first_and_are_strong() -> None:
    figure = picture(draw_poses, "paper, fig. 4")
    colours = [
        next(a.get_color() for a in axes.get_children() if str(a.get_gid()).endswith("bar-A1A3"))
        for axes in figure.axes
    ]
    assert colours == [STRONG["bar-0"]] * 2 + [PALE["bar-0"]] * 4
    texts = [t.get_text() for t in figure.texts]
    kinds = ["stable (minimum)"] * 2 + ["saddle"] * 3 + ["maximum"]
    assert [t for t in texts if t[0].isdigit() and "  " in t[:3]] == [
        f"{n}  {k}" for n, k in enumerate(kinds, 1)
    ]


def test_a_degenerate_pose_is_named_with_its_multiplicity() -> None:
    figure = picture(draw_poses, "fold")
    assert any("degenerate, multiplicity 3, flat" in t.get_text() for t in figure.texts)


@CASES
@pytest.mark.slow_cases("paper, fig. 3", "paper, fig. 4", "all loads", "rho = 1e-12")
def test_labels_are_clear_of_all_strokes_and_of_each_other(name: str) -> None:
    labels_are_clear(poses(name))


def labels_are_clear(found: Poses) -> None:
    if not found.equilibria:
        return
    frame, arrows = frame_of(found.equilibria), arrow_lengths(found)
    for pose in found.equilibria:
        seen = frame.sketch(found.model, pose, arrows)
        strokes = [(a, b, w / 2) for (a, b), w in zip(seen.bars, BAR_WIDTHS, strict=True)]
        strokes += [s for line in seen.coils.values() for s in polyline(line, 0.4)]
        strokes += [(start, end, 2.0) for _, start, end in seen.arrows]
        boxes = [placed.box for placed in seen.labels]
        for box in boxes:
            assert not any(crosses(stroke, box) for stroke in strokes)
            assert not any(
                overlap(box, (x - PIN, y - PIN, x + PIN, y + PIN)) for x, y in seen.nodes.values()
            )
            assert box[0] >= 0 and box[1] >= 0 and box[2] <= frame.width and box[3] <= frame.height
        assert not any(overlap(a, b) for a, b in combinations(boxes, 2))
        inside = [*seen.nodes.values(), *(p for line in seen.coils.values() for p in line)]
        inside += [p for _, *ends in seen.arrows for p in ends]
        assert all(0 <= x <= frame.width and 0 <= y <= frame.height for x, y in inside)


def test_springs_on_bars_are_drawn_aside() -> None:
    """In a flat pose all is on one line, but no spring hides under a bar or on another spring."""
    found = poses("paper, fig. 2")
    frame = frame_of(found.equilibria)
    flat = [p for p in found.equilibria if p.flat]
    assert len(flat) == 4
    for pose in flat:
        seen = frame.sketch(found.model, pose, {})
        middles = [
            np.mean(line[1:-1], axis=0)[1] - seen.nodes["A1"][1] for line in seen.coils.values()
        ]
        bars = [(min(a[0], b[0]), max(a[0], b[0])) for a, b in seen.bars]
        for line, middle in zip(seen.coils.values(), middles, strict=True):
            if any(low < np.mean(line, axis=0)[0] < high for low, high in bars):
                assert abs(middle) > 5


def test_arrows_are_as_long_as_forces() -> None:
    lengths = arrow_lengths(solve(rho="1", F3="-10", F4="5", F3x="1e-20"))
    assert lengths["F3"] == -2 * lengths["F4"]
    assert 5 < lengths["F3x"] < lengths["F4"], "short ones are lengthened"
    assert "F4x" not in lengths


@settings(max_examples=examples(60), deadline=None)
@given(st.lists(st.tuples(st.floats(5, 195), st.floats(5, 145)), min_size=1, max_size=5))
def test_labels_of_any_points_are_apart(points: list[tuple[float, float]]) -> None:
    labels = [Label("A₁", at, (7, 6), (1.0, 0.0)) for at in points]
    boxes = [p.box for p in place(labels, [], [], (0, 0, 200, 150))]
    assert not any(overlap(a, b) for a, b in combinations(boxes, 2))


@given(st.tuples(*[st.floats(-9, 9)] * 4), st.floats(0, 2))
def test_a_stroke_meets_a_box_where_one_of_its_points_does(
    ends: tuple[float, ...], half: float
) -> None:
    box = (-3.0, -2.0, 3.0, 2.0)
    a, b = ends[:2], ends[2:]
    points = np.linspace(a, b, 400)
    inner = (np.abs(points) < np.array([3.0, 2.0]) + half - 0.06).all(axis=1)
    outer = (np.abs(points) < np.array([3.0, 2.0]) + half + 0.06).all(axis=1)
    hit = crosses(((a[0], a[1]), (b[0], b[1]), half), box)
    if a != b:
        assert hit or not inner.any()
        assert outer.any() or not hit


# -------------------------------------------------------------------------------------------------- the landscape


@IN_DOUBLES
@pytest.mark.fast_cases("flat, springs of no length")
def test_every_equilibrium_is_marked_and_numbered_once(name: str) -> None:
    found, figure = poses(name), picture(draw_landscape, name)
    n = len(found.equilibria)
    assert sorted(identifiers(figure, "equilibrium-")) == [
        f"equilibrium-{k}" for k in range(1, n + 1)
    ]
    assert sorted(identifiers(figure, "number-")) == [f"number-{k}" for k in range(1, n + 1)]
    markers = {
        a.get_gid(): a for a in figure.findobj() if str(a.get_gid()).startswith("equilibrium-")
    }
    symbols = {0: "o", 1: "X", 2: "^", None: "*"}
    for number, pose in enumerate(found.in_order, 1):
        marker = markers[f"equilibrium-{number}"]
        assert marker.get_marker() == symbols[pose.index]
        for shown, degrees in zip(
            (marker.get_xdata()[0], marker.get_ydata()[0]), pose.degrees, strict=True
        ):
            assert min(abs(shown - float(degrees) + turn) for turn in (-360, 0, 360)) < 0.3


def test_a_landscape_of_what_is_beyond_doubles_is_refused() -> None:
    with pytest.raises(ConfigError, match="too large"):
        draw_landscape(poses("lengths of 1e400"))


@IN_DOUBLES
def test_the_drawn_energy_is_that_of_the_poses(name: str) -> None:
    """Two ways to the same number: the potential over the torus, and the certified energy of each
    equilibrium.
    """
    found = poses(name)
    energy = Energy(found.model, found.parameters)
    h = 1e-4
    for pose in found.equilibria:
        th1, th2 = (np.radians(float(d)) for d in pose.degrees)
        value = float(energy(np.array(th1), np.array(th2)))
        size = max(1.0, abs(float(pose.energy.center)))
        assert value == pytest.approx(float(pose.energy.center), rel=1e-9, abs=1e-9)
        for d1, d2 in ((h, 0), (0, h)):
            slope = energy(np.array(th1 + d1), np.array(th2 + d2)) - energy(
                np.array(th1 - d1), np.array(th2 - d2)
            )
            assert abs(float(slope)) / (2 * h) < 1e-6 * size


def test_contours_pass_through_saddles() -> None:
    found, figure = poses("paper, fig. 4"), picture(draw_landscape, "paper, fig. 4")
    saddles = sorted(float(p.energy.center) for p in found.equilibria if p.index == 1)
    drawn = [list(c.levels) for c in figure.findobj() if hasattr(c, "levels")]
    assert any(levels == pytest.approx(saddles) for levels in drawn)


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=6))
def test_levels_separate_critical_energies(critical: list[float]) -> None:
    levels = contour_levels(sorted(set(critical)), -1.0, 1.0)
    assert all(a < b for a, b in pairwise(levels))
    assert levels[0] == -1 and levels[-1] == pytest.approx(1, abs=1e-8)
    for value in critical:
        assert min(abs(value - level) for level in levels) <= 2e-9


def test_equilibria_on_the_same_place_stay_visible() -> None:
    """At 1e-20 from the fold of fig. 2: two stable ones and a saddle, drawn over each other with
    falling sizes.
    """
    figure = draw_landscape(solve(rho=Fraction(5, 4) - Fraction(1, 10**20), L2="3/2"))
    found = {
        a.get_gid(): a for a in figure.findobj() if str(a.get_gid()).startswith("equilibrium-")
    }
    sizes = [found[f"equilibrium-{k}"].get_markersize() for k in (1, 2, 3)]
    assert sizes[0] > sizes[1] + 3 > sizes[2] + 6


# -------------------------------------------------------------------------------------------------- all of them


def boxes_of(figure: Figure) -> list[matplotlib.transforms.Bbox]:
    with printing.settings():
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        renderer = canvas.get_renderer()
        return [
            t.get_window_extent(renderer)
            for t in figure.texts + [t for a in figure.axes for t in a.texts]
        ]


@pytest.mark.parametrize("draw", DRAWN)
@CASES
@pytest.mark.fast_cases(
    "paper, fig. 4-draw_landscape", "lengths 1e9 apart, loads 1e30-draw_landscape"
)
def test_texts_do_not_overlap_and_are_on_the_page(
    name: str, draw: Callable[[Poses], Figure]
) -> None:
    if draw is draw_landscape and name == "lengths of 1e400":
        return
    figure = picture(draw, name)
    boxes = boxes_of(figure)
    width, height = figure.canvas.get_width_height()
    assert not [1 for a, b in combinations(boxes, 2) if a.overlaps(b)]
    for box in boxes:
        assert box.x0 >= 0 and box.y0 >= 0 and box.x1 <= width and box.y1 <= height


@pytest.mark.parametrize("draw", DRAWN)
def test_infinitely_many_equilibria_are_said_so(draw: Callable[[Poses], Figure]) -> None:
    found = solve(rho="0")
    assert found.status is Status.UNDECIDED and not found.equilibria
    figure = draw(replace(found, remark="infinitely many equilibria"))
    assert not figure.axes
    assert any("infinitely many" in t.get_text() for t in figure.texts)


@pytest.mark.parametrize(
    ("text", "printed"),
    [("-1.5", "−1.5"), ("1e-12", "10⁻¹²"), ("-2.5e30", "−2.5·10³⁰"), ("-1e3", "−10³")],
)
def test_numbers_are_printed(text: str, printed: str) -> None:
    assert printed_number(text) == printed


def test_rounded_values_say_so() -> None:
    assert value_text(Fraction(1, 4)).startswith("=")
    assert value_text(1 + Fraction(1, 10**20)).startswith("≈")
    assert Enclosure(Fraction(1, 3), Fraction(1, 3)).text(7) in value_text(
        Fraction(10**30 + 1, 3 * 10**30)
    )


def test_the_legend_tells_loads_apart_and_names_torsion_springs() -> None:
    """A parameter that acts at several points goes by these, and a number by direction and point."""
    mechanism = ptmcad.Mechanism(
        parameters={"W": {"kind": "force"}, "G": {"kind": "force"}},
        unknowns={"th": "angle", "ph": "angle"},
        points={"P": ["cos(th)", "sin(th)"], "Q": ["cos(ph)", "sin(ph)"]},
        springs=[{"between": ["P", "Q"], "k": 1}],
        torsion=[{"angle": "th", "k": 1}, {"angle": "ph - th", "k": 2}],
        loads={"P": ["W", -1], "Q": ["W", "G"]},
    )
    at = {"W": Fraction(1, 2), "G": Fraction(1, 3)}
    text = " ".join(t.get_text() for t in draw_poses(poses_at(mechanism, at, 6)).texts).replace(
        "\N{NO-BREAK SPACE}", " "
    )
    assert "torsion springs on θ, ph − θ; not drawn" in text
    assert "W at P, Q = 0.5,  Fy at P = −1," in text and "G = 1/3" in text and "G at" not in text


@cache
def jaw() -> Poses:
    """A bar and a body on torsion springs, two of them at one joint and one at none that is known."""
    mechanism = ptmcad.Mechanism(
        parameters={"W": {"kind": "force"}},
        unknowns={"th": "angle", "phi": "angle"},
        points={"O": [0, 0], "P": ["cos(th)", "sin(th)"]},
        bodies={"tip": {"at": "P", "angle": "phi", "points": {"Q": [1, 0], "R": ["1/2", "1/2"]}}},
        bars=[["O", "P"], ["P", "Q"], ["Q", "R"], ["P", "R"]],
        supports={"O": "pin"},
        torsion=[
            {"angle": "phi - th", "k": 1, "rest": "pi/2"}, {"angle": "th", "k": 2, "rest": "pi/2"},
            {"angle": "2*th", "k": "1/5"}, {"angle": "phi - 3*th", "k": "1/9", "at": "P"},
        ],
        loads={"Q": {"weight": "W"}},
    )  # fmt: skip
    return solve(model=mechanism, W="1/2")


def test_torsion_springs_are_spirals_at_their_joints_in_every_pose() -> None:
    """From the pin's rim outwards to a point on the arm; those of one joint lie around each other."""
    figure = draw_poses(jaw())
    shown = jaw().in_order
    scene = frame_of(shown)
    for number, pose in enumerate(shown, 1):
        lines = {
            line.get_gid(): line.get_xydata()
            for line in figure.axes[number - 1].lines
            if line.get_gid()
        }
        assert {gid for gid in lines if "torsion" in gid} == {
            f"pose-{number}-torsion-{k}" for k in (1, 2, 4)
        }
        nodes = scene.sketch(jaw().model, pose, {}).nodes
        for k, joint, arm, least in (
            (1, "P", "Q", PIN),
            (2, "O", "P", PIN),
            (4, "P", "O", SPIRAL[1]),
        ):
            line = lines[f"pose-{number}-torsion-{k}"] - np.array(nodes[joint])
            radii = np.hypot(*line.T)
            assert (np.diff(radii) > 0).all(), "it opens"
            assert radii[0] > least, "clear of the pin, and of another one"
            along = np.array(nodes[arm]) - np.array(nodes[joint])
            assert line[-1] == pytest.approx(along / np.hypot(*along) * radii[-1]), (
                "its end is on the arm"
            )


def test_the_legend_says_where_torsion_springs_are() -> None:
    text = " ".join(t.get_text() for t in draw_poses(jaw()).texts).replace(
        "\N{NO-BREAK SPACE}", " "
    )
    assert "torsion springs on φ − θ at P, θ at O, φ − 3*θ at P" in text
    assert "torsion spring on 2*θ; not drawn" in text
