"""The report's point that mouse, finger, slider and keys move: what the browser follows, against
exact poses.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import pairwise
from math import pi, radians
from pathlib import Path

import numpy as np
import pytest
import yaml
from support import browser as chromium
from support.browser import Browser
from support.certified_maps import crossing, cusp
from support.few import few
from support.maps import CONFIGS, part_of_free02
from support.maps import shipped as computed
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.ask.fields.equations import state_at
from ptmcad.show.report import page
from ptmcad.show.report.mapsvg import SIDE, SLACK
from ptmcad.show.report.reportpage import tape
from ptmcad.workbench.fields.quantityfield import exact_at

pytestmark = pytest.mark.skipif(chromium.PROGRAM is None, reason=chromium.MISSING)

STATUS = "live.status.textContent"
SHARE = "live.share"


@pytest.fixture(name="view")
def page_of_a_map(one: Browser, tmp_path: Path) -> Iterator[Callable[..., Browser]]:
    """Opens a map's page; afterwards nothing may have complained or asked for anything else."""

    def open_page(
        result: RegionMap, width: int = 1200, height: int = 1000, phone: bool = False
    ) -> Browser:
        file = tmp_path / "live.html"
        file.write_text(page_of(result), encoding="utf-8")
        one.media(prefers_color_scheme="light", prefers_reduced_motion="reduce")
        one.size(width, height, phone)
        one.open(file)
        return one

    yield open_page
    assert one.complaints() == []
    assert len(one.requests()) == 1


PAGES: list[tuple[RegionMap, str]] = []


def page_of(result: RegionMap) -> str:
    """A map's page, written once for all tests that open it."""
    found = next((text for known, text in PAGES if known is result), None)
    if found is None:
        PAGES.append((result, found := page(result)))
    return found


def move(view: Browser, x: float, y: float) -> None:
    view.run(f"moveProbe([{x!r}, {y!r}]); 0")


def spot(view: Browser, x: float, y: float) -> tuple[float, float]:
    """Where a point of the map, by its shares of the window, is on the screen."""
    left, top, width, height = view.run(
        "(() => { const box = document.querySelector('#map .frame').getBoundingClientRect();"
        " return [box.left, box.top, box.width, box.height]; })()"
    )
    return left + x * width, top + (1 - y) * height


def exact(result: RegionMap, x: float, y: float) -> list[tuple[str, tuple[float, ...]]]:
    """Kinds and angles of all poses by exact computation, at shares of the window that are doubles
    exactly.
    """
    at = [
        axis.low + Fraction(s) * (axis.high - axis.low)
        for axis, s in zip(result.slice.axes, (x, y), strict=True)
    ]
    kinds = ("stable", "saddle", "maximum")
    return [
        (kinds[pose.index or 0], tuple(float(angle.center) for angle in pose.angles))
        for pose in exact_at(result, *at).equilibria
    ]


def followed(view: Browser) -> list[tuple[str, tuple[float, ...]]]:
    return [
        (kind, tuple(at)) for kind, at in view.run("live.found.map((one) => [one.kind, one.at])")
    ]


def same(a: tuple[float, ...], b: tuple[float, ...], slack: float = 1e-6) -> bool:
    return all(abs((x - y + pi) % (2 * pi) - pi) < slack for x, y in zip(a, b, strict=True))


def agrees(
    one: list[tuple[str, tuple[float, ...]]], other: list[tuple[str, tuple[float, ...]]]
) -> bool:
    """Whether each is in the other, with its kind."""
    return len(one) == len(other) and all(
        any(k == m and same(p, q) for m, q in other) for k, p in one
    )


def test_what_is_followed_anywhere_are_the_exact_poses(view: Callable[..., Browser]) -> None:
    result = computed("fig4")
    b = view(result)
    chance = random.Random(7)
    seen = set()
    for _ in range(12):
        shares = (chance.randrange(1, 64) / 64, chance.randrange(1, 64) / 64)
        move(b, *shares)
        assert agrees(followed(b), exact(result, *shares)), b.run(STATUS)
        seen.add(len(followed(b)))
    assert seen == {4, 6}


def test_with_free_lengths_too(view: Callable[..., Browser]) -> None:
    """A certified map's stable poses: at its samples those that it stores, and elsewhere those of
    `ptmcad.solve`.
    """
    result = part_of_free02()
    b = view(result)
    for number, cell in enumerate(result.cells):
        b.run(f"choose({number}, false)")
        stored = [tuple(float(c) for c in s.center) for s in cell.solutions]
        assert (
            b.run("document.querySelectorAll('#poses .pose.stable').length")
            == len(stored)
            == cell.stable
        )
        texts = b.run(f"DATA.cells[{number}].equilibria.map((pose) => pose.unknowns)")
        shown = [
            tuple(radians(float(t.replace("−", "-").rstrip("°"))) for t in row) for row in texts
        ]
        slack = radians(
            10 ** -min(len(t.rstrip("°").partition(".")[2]) for row in texts for t in row)
        )
        assert max(float(s.radius) for s in cell.solutions) / 10 < slack < 1e-3
        assert sum(same(p, q, slack) for p in shown for q in stored) == len(stored)
    assert b.run("document.querySelectorAll('#poses .landscape').length") == 1
    b.picture("free02-light.png")
    chance = random.Random(3)
    compared = 0
    while compared < 2:
        shares = (chance.randrange(1, 64) / 64, chance.randrange(1, 64) / 64)
        move(b, *shares)
        if b.run("live.cell") < 0:
            assert b.run("live.found.length") == 0 and "not determined" in b.run(STATUS)
            continue
        assert agrees(followed(b), [pose for pose in exact(result, *shares) if pose[0] == "stable"])
        compared += 1


@pytest.mark.parametrize(
    "result", few([crossing(7), cusp(9)], crossing(7)), ids=["crossing", "cusp"]
)
def test_no_point_is_said_to_be_in_a_cell_that_it_is_not_in(
    view: Callable[..., Browser], result: RegionMap
) -> None:
    """However near to a rim; and away from the rims every point has its cell."""
    b = view(result)
    assert result.cover is not None
    chance, slack = random.Random(5), SLACK / SIDE
    points: list[tuple[float, float]] = []
    for left, right, bottom, top in chance.choices(
        result.cover.rectangles, k=400
    ):  # across a side of each
        x = chance.choice((left, right)) / result.cover.steps + chance.uniform(-2, 2) * slack
        y = chance.uniform(bottom, top) / result.cover.steps
        points += [point for point in ((x, y), (y, x)) if all(0.01 < v < 0.99 for v in point)]
    points += [(chance.uniform(0.01, 0.99), chance.uniform(0.01, 0.99)) for _ in range(100)]
    ringed, near = b.run(f"{json.dumps(points)}.map(cellAt)"), 0
    for (x, y), ring in zip(points, ringed, strict=True):
        true = result.locate(rho=2 * x, L2=2 * y).cell
        around = {result.locate(rho=2 * (x + dx), L2=2 * (y + dy)).cell for dx in (-2 * slack, 0, 2 * slack)
                  for dy in (-2 * slack, 0, 2 * slack)}  # fmt: skip
        near += len(around) > 1
        assert ring == (-1 if true is None else true) or (ring == -1 and len(around) > 1), (x, y)
    assert near > 15


def test_at_a_sample_the_cell_is_known_however_near_its_rims_are(
    view: Callable[..., Browser],
) -> None:
    b = view(part_of_free02())
    b.run("DATA.slack = 600; choose(0, false)")
    assert "exact count of this region" in b.run(STATUS) and len(followed(b)) > 0
    b.run("moveProbe(live.share.map((value) => value + 1e-6))")
    assert "not determined" in b.run(STATUS)


TURNED = yaml.safe_load("""
name: turned
mechanism:
  parameters: {M: {}, F: {kind: force}, k: {kind: stiffness, default: 3}}
  unknowns: {th: angle, ph: angle, s: length}
  points:
    O: [0, 0]
    W: [2, 1]
    P: [cos(th), sin(th)]
    Q: [cos(th) + cos(ph)/2 + s, sin(th) + sin(ph)/2]
  springs: [{between: [W, Q], k: k, free: 1/3}, {between: [W, P], k: k/2}]
  torsion: [{angle: th, k: 2}, {angle: ph - 2*th, k: 1}]
  moments: {th: M, ph: 1/5}
  loads: {Q: [F, -F/7]}
axes: {M: [1, 2], F: [0, 1]}
""")


@pytest.mark.parametrize("name", ["fig4", "free", "turned", "kuramoto", "escape", "schloegl"])
def test_the_script_has_the_equations_of_the_description(
    view: Callable[..., Browser], name: str
) -> None:
    """Residuals and their derivatives at random points, against NumPy's from the same description."""
    if name in ("fig4", "free"):
        slice = ptmcad.load(CONFIGS / ("fig4.yaml" if name == "fig4" else "free02.yaml"))
    elif name == "turned":
        slice = ptmcad.slice_from_mapping(TURNED)
    else:
        slice = ptmcad.load(CONFIGS / "systems" / f"{name}.yaml")
    base = computed("fig4")
    result = replace(base, slice=slice)
    data = tape(result)
    assert data is not None
    b = view(base)
    chance = np.random.default_rng(5)
    parameters = {n: e for n, e in slice.parameters.items() if n in slice.model.variables}
    for _ in range(3):
        x, y = (float(a.low) + float(a.high - a.low) * chance.random() for a in slice.axes)
        at = chance.uniform(-3, 3, len(slice.model.unknowns))
        values = {n: float(e.evaluate(Fraction(x), Fraction(y))) for n, e in parameters.items()}
        state = state_at(slice.model, values, at.reshape(-1, 1))
        found = b.run(
            f"(() => {{ const own = {{ ...FOLLOW }}; Object.assign(FOLLOW, {json.dumps(data)});"
            f" try {{ const {{ residuals, jacobian }} = equationsAt(parametersAt([{x!r}, {y!r}]), {at.tolist()});"
            " return [residuals, jacobian]; } finally { Object.assign(FOLLOW, own); } })()"
        )
        assert found[0] == pytest.approx(state.residuals[:, 0].tolist(), rel=1e-9, abs=1e-9)
        assert np.allclose(found[1], state.jacobian[:, :, 0], rtol=1e-9, atol=1e-9)


def test_the_mouse_drags_the_point(view: Callable[..., Browser]) -> None:
    result = computed("fig4")
    b = view(result)
    move(b, 0.5, 0.5)
    b.run("document.querySelector('#map').scrollIntoView({ behavior: 'instant' })")
    start, end = spot(b, 0.5, 0.5), spot(b, 0.3125, 0.5625)
    way = [
        (start[0] + (end[0] - start[0]) * k / 8, start[1] + (end[1] - start[1]) * k / 8)
        for k in range(9)
    ]
    b.drag(*way)
    b.until(f"Math.abs({SHARE}[0] - 0.3125) < 0.004 && Math.abs({SHARE}[1] - 0.5625) < 0.004")
    assert "2 stable of 6 equilibria" in b.run(STATUS) and "floating point" in b.run(STATUS)
    assert b.run("document.querySelectorAll('#live .grid-of-poses .pose').length") == 6
    assert agrees(followed(b), exact(result, *b.run(SHARE)))
    b.point_at(*spot(b, 0.8, 0.8))  # it has been let go
    b.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert abs(b.run(SHARE)[0] - 0.3125) < 0.004
    b.until("document.querySelector('#live .landscape') !== null")
    assert b.run("document.querySelectorAll('#live .equilibrium.followed').length") == 1
    b.picture("fig4-live.png")


def test_a_finger_drags_the_point_and_scrolls_beside_it(view: Callable[..., Browser]) -> None:
    b = view(computed("fig4"), 390, 844, True)
    move(b, 0.5, 0.5)
    b.run("document.querySelector('#map').scrollIntoView({ behavior: 'instant' })")
    scrolled = b.run("scrollY")
    start = spot(b, 0.5, 0.5)
    b.swipe(start, *((start[0] - 8 * k, start[1] - 6 * k) for k in range(1, 8)))
    b.until(f"{SHARE}[0] < 0.4 && {SHARE}[1] > 0.5")
    assert b.run("scrollY") == scrolled
    assert b.run("document.documentElement.scrollWidth") == 390
    assert b.run("getComputedStyle(document.querySelector('#map .cell')).touchAction") == "auto"
    b.tap(*spot(b, 0.75, 0.25))
    b.until(f"Math.abs({SHARE}[0] - 0.75) < 0.02 && Math.abs({SHARE}[1] - 0.25) < 0.02")
    b.picture("fig4-live-phone.png")


def test_a_slider_leads_to_the_snap(view: Callable[..., Browser]) -> None:
    """It is at the map's wall: exact poses have what vanishes there on one side, and where it goes
    to on the other.
    """
    result = computed("fig4")
    b = view(result)
    move(b, 0.3125, 0.625)
    poses = followed(b)
    number = next(k for k, (kind, at) in enumerate(poses) if kind == "stable" and at[0] > 0)
    b.run(
        f"document.querySelectorAll('#live .grid-of-poses .pose')[{number}].querySelector('.follow').click()"
    )
    assert b.run("document.querySelectorAll('#live .pose.followed').length") == 1
    b.run("live.sliders[0].input.focus()")
    before = 0
    while not b.run("live.fall !== null"):
        before += 1
        assert before < 100
        b.press("ArrowLeft")
    told = b.run("document.querySelector('.snap').textContent")
    assert told.startswith("Snap at ρ = ") and "vanished" in told
    fall = b.run("live.fall")
    rho, l2 = fall["point"]
    assert l2 == pytest.approx(1.25)

    def stable(shift: float) -> list[tuple[float, ...]]:
        found = exact_at(
            result, Fraction(round((rho + shift) * 10**6), 10**6), Fraction(5, 4)
        ).equilibria
        return [tuple(float(a.center) for a in pose.angles) for pose in found if pose.stable]

    # on one side there are two, a little further there is one, which is where it has gone
    left, right = stable(-1e-4), stable(1e-4)
    assert (len(left), len(right)) == (1, 2)
    assert any(same(fall["before"], pose, 0.05) for pose in right)
    assert same(fall["after"], left[0], 1e-3)
    levels = fall["levels"]
    assert levels[0] - levels[-1] > 1 and all(a >= b for a, b in pairwise(levels))
    assert b.run("document.querySelectorAll('.fall .marble').length") == 1
    assert b.run("document.querySelectorAll('.fall .level.fallen').length") == 1
    b.until("document.querySelector('#live .landscape .level.fallen') !== null")
    b.picture("fig4-snap.png")


def test_a_fall_is_shown_in_motion_unless_that_is_unwanted(view: Callable[..., Browser]) -> None:
    b = view(computed("fig4"))
    snap = "moveProbe([0.3125, 0.625]); followPose(live.found.findIndex((f) => f.at[0] > 0 && f.kind === 'stable')); "
    snap += "moveProbe([0.15, 0.625]); live.falling"
    assert b.run(snap) == 0
    b.media(prefers_color_scheme="light", prefers_reduced_motion="no-preference")
    marble = "Number(document.querySelector('.fall .marble').getAttribute('cx'))"
    assert b.run(snap) != 0
    first = b.run(marble)
    b.until("live.falling === 0")
    assert b.run(marble) > first


def test_it_says_so_where_fewer_solutions_are_found(view: Callable[..., Browser]) -> None:
    b = view(computed("fig4"))
    move(b, 0.3125, 0.5625)
    assert b.run("document.querySelectorAll('#live .pose').length") == 6
    b.run("DATA.cells.forEach((cell) => { cell.total += 1; }); 0")
    move(b, 0.3126, 0.5625)
    assert "only 6 different ones were found" in b.run(STATUS) and "none is drawn" in b.run(STATUS)
    assert b.run("document.querySelectorAll('#live .pose').length") == 0
    assert b.run("live.marble") is None


def test_at_a_degenerate_point_it_says_so(view: Callable[..., Browser]) -> None:
    """Where the exact poses are two, one of them triple, the count beside it is that of the region
    around.
    """
    result = computed("mechanisms/bistable-slider")
    b = view(result)
    move(b, 0.5, 0.5)
    assert exact_at(result, Fraction(0), Fraction(1, 2)).equilibria[0].multiplicity == 3
    assert "none is drawn" in b.run(STATUS) and b.run("live.found.length") == 0
    move(b, 0.53125, 0.5)
    assert b.run("live.found.length") == result.cells[b.run("live.cell")].total
