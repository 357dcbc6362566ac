"""The explorer's page in a real headless Chromium: dragging, keys, touch, two tabs, a server that
is killed.

Screenshots go where PTMCAD_TESTS_SCREENSHOTS says, if it does; nothing is compared with them.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import pytest
from support import browser as chromium
from support.browser import Browser
from support.explorer import Explorer, explorer
from support.maps import CONFIGS

import ptmcad

pytest.importorskip("aiohttp")
pytestmark = pytest.mark.skipif(chromium.PROGRAM is None, reason=chromium.MISSING)
RECORD = CONFIGS / "families" / "equal-loads.yaml"
FIRST = "document.querySelector('#sliders input[type=range]')"
SETTLED = "view.shown !== null && sameValues(view.of, view.values) && view.shown.regions.every((r) => r.area)"
SOLVED = "view.poses !== null && sameValues(view.poses.values, view.values) && !points.under"


@pytest.fixture(scope="module", name="own")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explorer]:
    with explorer(RECORD, "--out", tmp_path_factory.mktemp("explored")) as found:
        yield found


@pytest.fixture(name="view")
def fresh_view(one: Browser, own: Explorer) -> Browser:
    one.media(prefers_color_scheme="light")
    one.size(1300, 1000)
    one.visit(own.address, f"{SETTLED} && {SOLVED}")
    return one


def at(view: Browser, selector: str) -> tuple[float, float, float, float]:
    box = view.run(f"(() => {{ const b = document.querySelector({selector!r}).getBoundingClientRect();"
                   " return [b.left, b.top, b.width, b.height]; })()")  # fmt: skip
    return box[0], box[1], box[2], box[3]


def expected(value: str, areas: bool = True) -> list[list[Any]]:
    alone = ptmcad.family(RECORD, values=[value], areas=areas).members[0]
    return [[r.stable, r.total, len(r.cells)] for r in alone.regions]


def test_the_first_map_is_there_with_areas_and_poses(view: Browser) -> None:
    assert view.run("view.of.F") == "-20"
    assert view.run("view.shown.digest") == expected("-20")
    assert view.run("state.textContent") == "Shown: F = -20 (exact, 2 regions). "
    assert view.run("[...document.querySelectorAll('#regions li')].map((li) => li.textContent)") == [
        "1 stable, area 3.5619", "2 stable of 6 equilibria, area 0.4381"]  # fmt: skip
    assert (
        view.run("document.querySelectorAll('#poses .pose').length")
        == view.run("view.poses.data.total")
        == 4
    )
    assert view.run("location.href.includes('token')") is False
    assert view.complaints() == []
    assert {r.split("/")[2] for r in view.requests()} == {view.run("location.host")}
    view.picture("explore-desktop.png", whole=False)


def test_dragging_redraws_and_every_map_is_exact(view: Browser) -> None:
    left, top, width, height = at(view, "#sliders input[type=range]")
    view.run("view.seen = []; const whole = drawMap; drawMap = (data, question) => { whole(data, question);"
             " view.seen.push([question.values.F, data.digest]); }; 0")  # fmt: skip
    places = [
        (left + 8 + (width - 16) * k / 30, top + height / 2) for k in (15, 17, 20, 24, 26, 27)
    ]
    view.drag(*places)
    view.until(SETTLED)
    assert Fraction(view.run("view.of.F")) > -8
    seen = view.run("view.seen")
    assert len(seen) >= 2  # areas come in an answer of their own
    for value, digest in {value: digest for value, digest in seen}.items():
        assert digest == expected(value, areas=False), value
    assert view.run("document.querySelector('#map').classList.contains('late')") is False
    assert view.complaints() == []


def test_while_a_map_is_computed_the_old_one_stays_and_the_page_says_so(view: Browser) -> None:
    before = view.run("document.querySelector('#strong').getAttribute('d')")
    view.run("strong = byId('strong')")
    said = view.run(f"{FIRST}.value = -250; {FIRST}.dispatchEvent(new Event('input')); [state.textContent,"
                    " strong.getAttribute('d'), byId('map').classList.contains('late')]")  # fmt: skip
    assert said == ["Shown: F = -20 (exact, 2 regions). Computing F = -25.0 …", before, True]
    assert view.run("document.querySelector('h1').textContent") == "equal-loads: F = -25.0"
    view.until(SETTLED)
    assert view.run("state.textContent") == "Shown: F = -25.0 (exact, 2 regions). "
    assert view.run("document.querySelector('#strong').getAttribute('d')") != before


@pytest.mark.slow
def test_the_keyboard_moves_sliders_and_the_point(view: Browser) -> None:
    view.run(f"{FIRST}.focus()")
    view.press("ArrowRight", "ArrowRight")
    view.until(SETTLED)
    assert view.run("view.of.F") == "-19.8"
    view.run("document.querySelector('.probe').focus()")
    view.press("ArrowLeft", shift=True)
    view.until(SOLVED)
    found = view.run("view.poses")
    assert found["at"] == {"rho": "1.020", "L2": "0.920"}
    poses = ptmcad.solve(rho="1.020", L2="0.920", F3="-19.8", F4="-19.8")
    assert (found["data"]["total"], found["data"]["stable"]) == (
        len(poses.equilibria),
        poses.stable,
    )


def test_the_point_under_the_pointer_agrees_with_the_region_beside_it(view: Browser) -> None:
    left, top, width, height = at(view, "#frame .frame")
    for x, y, stable in ((0.3, 0.5, 2), (0.8, 0.2, 1), (0.5, 0.9, 2), (0.05, 0.9, 1)):
        view.point_at(left + x * width, top + (1 - y) * height)
        view.until(
            f"Math.abs(view.share[0] - {x}) < 0.01 && {SOLVED} && view.poses.at.rho === pointText().rho"
        )
        assert (
            view.run("view.poses.data.stable")
            == view.run("Number(regionAt(view.share).words[0])")
            == stable
        )
        assert f"{stable} stable" in view.run("document.querySelector('#where').textContent")
        assert view.run("document.querySelectorAll('#poses .pose.stable').length") == stable
    view.click(left + 0.3 * width, top + 0.5 * height)  # fixes it
    view.point_at(left + 0.9 * width, top + 0.1 * height)
    assert abs(view.run("view.share[0]") - 0.3) < 0.01
    view.click(left + 0.9 * width, top + 0.9 * height)  # frees it
    view.point_at(left + 0.8 * width, top + 0.5 * height)
    assert abs(view.run("view.share[0]") - 0.8) < 0.01


@pytest.mark.slow
def test_two_tabs_do_not_disturb_each_other(view: Browser, own: Explorer) -> None:
    other = view.tab()
    try:
        view.size(1300, 1000)
        view.visit(own.address, SETTLED)  # the same address once more, in the same browser
        view.run(f"{FIRST}.value = -50; {FIRST}.dispatchEvent(new Event('input'))")
        here = view.switch(other)
        view.run(f"{FIRST}.value = -350; {FIRST}.dispatchEvent(new Event('input'))")
        for session, value in ((here, "-5.0"), (other, "-35.0")):
            view.switch(session)
            view.until(SETTLED)
            assert view.run("view.of.F") == value and view.run("view.shown.digest") == expected(
                value
            )
    finally:
        view.switch(other)


@pytest.mark.slow
def test_a_killed_server_is_told(one: Browser) -> None:
    with explorer(CONFIGS / "fig4.yaml") as own:
        one.visit(own.address, SETTLED)
        own.process.send_signal(signal.SIGKILL)
        own.process.wait(10)
        end = time.monotonic() + 20
        while one.run("document.querySelector('#gone').hidden"):
            one.run(
                f"{FIRST}.value = Number({FIRST}.value) + 1; {FIRST}.dispatchEvent(new Event('input'))"
            )
            assert time.monotonic() < end
            time.sleep(0.1)
        assert "The program has ended" in one.run("document.querySelector('#gone').textContent")


@pytest.mark.slow
def test_springs_with_free_lengths_are_coarse_first_and_then_refined(one: Browser) -> None:
    pytest.importorskip("numba")
    with explorer(CONFIGS / "free02.yaml") as own:
        chromium.PATIENCE, before = 120.0, chromium.PATIENCE
        try:
            one.visit(own.address, "view.shown !== null")
            assert "% undetermined" in one.run("state.textContent")
            first = one.run("Number(view.shown.undetermined)")
            one.until(f"Number(view.shown.undetermined) < {first / 2}")
        finally:
            chromium.PATIENCE = before
