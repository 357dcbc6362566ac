"""The page of a sweep and the film of its maps: what they say, in a browser too, and that nothing
is let in.
"""

from __future__ import annotations

import base64
import hashlib
import re
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from support import browser as chromium
from support.browser import Browser
from support.pages import corners

import ptmcad
from ptmcad.answer.sweep import CountedArea, Member, State, Summary, Sweep, Widest
from ptmcad.cli import run
from ptmcad.show.render.colours import Fill
from ptmcad.show.render.polylines import GRID
from ptmcad.show.report.atlas import (
    MAX_MAPS,
    SIDE,
    Thumbnail,
    atlas,
    chosen,
    sketch,
)

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\u2028"
CUBIC = {"unknowns": {"x": "real"}, "potential": "x^4/4 + (a + c)*x^2/2 + d*b*x"}
RECORD = {
    "name": "cusps",
    "system": CUBIC,
    "parameters": {"d": 2},
    "axes": {"a": [-2, 2], "b": [-1, 1]},
}
FRAME = ((("rho", "0", "2"), ("L2", "0", "2")), f"L1 = 1, {HOSTILE}", "stable")


def family(
    rows: int, columns: int, error: str = ""
) -> tuple[Sweep, list[Member], dict[int, Thumbnail]]:
    """A sweep over two parameters without a folder; its first member has failed."""
    members = []
    for k in range(rows * columns):
        place = {"F3": str(-(k // columns)), "F4": f"{k % columns}/3"}
        area = CountedArea("2", 1, (f"1.{k:03}", f"1.{k:03}1"))
        found = Summary(
            "exact", 9, 2, "0", (area,), Widest("rho", ("0.5", "0.6"), (("1", "1"),), "edge")
        )
        members.append(Member(k, place, State.DONE, found, file=f"results/000/{k:06}.json"))
    members[0] = Member(0, members[0].parameters, State.FAILED, error=error)
    states = {State.DONE: len(members) - 1, State.FAILED: 1}
    drawn = Thumbnail(
        Fill("#c7e4f6"),
        ((Fill("#eda43f", "////"), f"M0 0 {SIDE} 0 {SIDE} 9z"),),
        (("2", Fill("#eda43f", "////")),),
    )
    return (
        Sweep("family", Path("nowhere"), ("F3", "F4"), states),
        members,
        {m.number: drawn for m in members[1:]},
    )


def test_what_a_record_says_stays_text() -> None:
    """Names and errors close no element; the policy allows the page's own script and style alone."""
    text = atlas(family(2, 2)[0], FRAME, *family(2, 2, HOSTILE)[1:])
    assert text.count("<script") == 2 and text.count("</script>") == 2
    assert "<img" not in text
    (data,) = re.findall(
        r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL
    )
    assert "alert(1)" in data and not set("<>&\u2028") & set(data)
    (script,) = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    (style,) = re.findall(r"<style>(.*?)</style>", text, re.DOTALL)
    for part in (script, style):
        assert f"sha256-{base64.b64encode(hashlib.sha256(part.encode()).digest()).decode()}" in text
    assert "style=" not in text.replace("style-src", "")
    assert not re.findall(r"(?:src|href)=\"(?!#)", text)
    assert "Of 4 members 1 failed: these have no map." in text
    assert atlas(family(2, 2)[0], FRAME, *family(2, 2, HOSTILE)[1:]) == text


def test_a_large_sweep_is_shown_in_part() -> None:
    sweep = Sweep("many", Path(), ("F",), {State.DONE: 10 * MAX_MAPS + 1})
    numbers = chosen(sweep)
    assert len(numbers) <= MAX_MAPS and numbers[1] == 11
    members = [Member(n, {"F": str(n)}, State.WAITING) for n in numbers]
    assert f"one of 11 members; the index has all {len(sweep)}" in atlas(sweep, FRAME, members, {})


def test_a_drawing_is_the_map() -> None:
    """The share of its paths' area, by the shoelace formula, is that of the regions that are not
    the plate's.
    """
    result = ptmcad.classify(RECORD | {"parameters": {"c": 0, "d": 1}})
    drawn = sketch(result)
    area = 0.0
    for _, data in drawn.paths:
        for part in data.removesuffix("z").split("z"):
            points = corners(f"{part}z")
            pairs = zip(points, points[1:] + points[:1], strict=True)
            area += abs(sum(x * v - u * y for (x, y), (u, v) in pairs)) / 2
    areas = sorted(float(region.area[0]) for region in result.regions)
    assert area / (SIDE / GRID) ** 2 == pytest.approx(sum(areas[:-1]) / sum(areas), abs=2e-3)
    assert {text for text, _ in drawn.legend} == {"1", "2"}


@pytest.fixture(scope="module", name="swept")
def swept_fixture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a small sweep with its page and film, by the command."""
    import yaml

    folder = tmp_path_factory.mktemp("atlas")
    record = folder / "cusps.yaml"
    sweep = {"c": [0, 1, "1/2"], "d": {"from": 1, "to": 2, "steps": 3}}
    record.write_text(yaml.safe_dump(RECORD | {"parameters": {}, "sweep": sweep}), encoding="utf-8")
    assert (
        run(
            [
                "sweep",
                str(record),
                "--jobs",
                "1",
                "--out",
                str(folder / "out"),
                "--format",
                "html,gif",
            ]
        )
        == 0
    )
    return folder / "out"


def test_the_film_shows_each_map(swept: Path) -> None:
    with Image.open(swept / "cusps.gif") as film:
        assert (film.n_frames, film.size) == (9, (700, 520))


@pytest.mark.skipif(chromium.PROGRAM is None, reason=chromium.MISSING)
def test_the_page_in_a_browser(one: Browser, swept: Path) -> None:
    """Sliders in the order of the values, the sheet, curves to choose on; on a phone nothing is
    wider than it.
    """
    one.size(1200, 900)
    one.open(swept / "cusps.html")

    def facts() -> Any:
        return one.run("document.getElementById('facts').innerText")

    assert "c = 0, d = 1" in facts() and "Member 0: 2 regions" in facts()
    one.run(
        "(() => { const s = document.getElementById('slider-0'); s.value = 2; s.dispatchEvent(new Event('input')); })()"
    )
    assert "c = 1, d = 1" in facts() and "Member 3" in facts()
    assert one.run("document.getElementById('large').innerHTML") == one.run(
        "document.querySelector('[data-m=\"3\"] svg').innerHTML"
    )
    assert one.run("document.querySelectorAll('.small[aria-pressed=\"true\"]').length") == 1
    assert one.run("document.querySelectorAll('#curves figure').length") == 3
    one.run("document.querySelectorAll('#against button')[1].click()")
    assert "against d" in one.run("document.querySelector('#curves figcaption').textContent")
    one.run("document.querySelectorAll('#curves .hit')[2].dispatchEvent(new Event('click'))")
    assert "c = 1, d = 2" in facts()
    one.run("document.querySelector('[data-m=\"7\"]').click()")
    assert "c = 0.5, d = 1.5" in facts()
    one.picture("atlas-desktop.png")
    one.size(390, 844, phone=True)
    assert one.run("document.documentElement.scrollWidth") <= 390
    one.picture("atlas-phone.png")
    assert one.complaints() == []
    assert [r.rpartition("/")[2] for r in one.requests()] == ["cusps.html"]
