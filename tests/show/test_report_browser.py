"""The HTML report in a real headless Chromium: pointer, touch, keyboard, themes, phones, print, no
network, no errors.

Screenshots go where PTMCAD_TESTS_SCREENSHOTS says, if it does; nothing is compared with them.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from pathlib import Path

import pytest
import yaml
from support import browser as chromium
from support.browser import Browser
from support.certified_maps import certified
from support.maps import CONFIGS
from support.maps import shipped as computed
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import RegionMap
from ptmcad.cover.rectangles import Cover
from ptmcad.show.report import page

pytestmark = pytest.mark.skipif(chromium.PROGRAM is None, reason=chromium.MISSING)

FEW = """(() => { const shown = document.querySelector('#poses');
  return { head: (shown.querySelector('h3') || {}).textContent || '',
    poses: shown.querySelectorAll('.pose').length, stable: shown.querySelectorAll('.pose.stable').length,
    marks: shown.querySelectorAll('.equilibrium').length, contours: shown.querySelectorAll('.contour').length }; })()"""


@pytest.fixture(scope="module", name="pages")
def written_pages(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    folder = tmp_path_factory.mktemp("pages")

    def file(name: str, count: str | None = None) -> Path:
        path = folder / f"{name}-{count}.html"
        if not path.exists():
            path.write_text(page(computed(name, count)), encoding="utf-8")
        return path

    return file


@pytest.fixture(name="view")
def fresh_view(one: Browser, pages: Callable[..., Path]) -> Callable[..., Browser]:
    """Opens a page on a desktop in light colours; afterwards nothing may have complained or asked
    for anything else.
    """

    def open_page(name: str, count: str | None = None) -> Browser:
        one.media(prefers_color_scheme="light")
        one.size(1200, 900)
        one.open(pages(name, count))
        return one

    return open_page


def quiet(view: Browser, name: str, count: str | None = None) -> None:
    assert view.complaints() == []
    assert [r.rpartition("/")[2] for r in view.requests()] == [f"{name}-{count}.html"]


def place(view: Browser, number: int) -> tuple[float, float]:
    """Where a cell's sample is, in the window."""
    found = view.run(
        f"(() => {{ const box = document.querySelector('#map .frame').getBoundingClientRect();"
        f" const at = DATA.cells[{number}].at;"
        f" return [box.left + at[0] / DATA.side * box.width, box.top + at[1] / DATA.side * box.height]; }})()"
    )
    return found[0], found[1]


def test_pointing_at_a_cell_tells_what_it_is(view: Callable[..., Browser]) -> None:
    """Counts, sample, region and area; and the map is where the data says, at every sample."""
    b = view("fig4")
    result = computed("fig4")
    assert b.run("document.querySelector('#readout').textContent") == "No cell is pointed at."
    b.run("document.querySelector('#map').scrollIntoView({ behavior: 'instant' })")
    hit = 0
    for number, cell in enumerate(result.cells):
        x, y = place(b, number)
        around = {
            b.run(f"Number(document.elementFromPoint({x + dx}, {y + dy}).dataset.cell)")
            for dx, dy in ((0, 0), (2, 0), (-2, 0), (0, 2), (0, -2))
        }
        if len(around) > 1:
            continue  # so thin that the mouse can hardly hit it: its button in the table and the arrows reach it
        assert around == {number}
        hit += 1
        b.point_at(x, y)
        told = b.run("document.querySelector('#readout').textContent")
        assert f"Cell {number}, region {cell.region}: {cell.stable} stable of {cell.total}" in told
        assert f"rho = {cell.sample['rho']}" in told
        assert "Area of the region: " + {0: "3.2536", 1: "0.7464"}[cell.region] in told
    assert hit >= 12
    b.point_at(1, 1)
    assert b.run("document.querySelector('#readout').textContent") == "No cell is pointed at."
    quiet(b, "fig4")


def test_a_click_draws_poses_and_landscape(view: Callable[..., Browser]) -> None:
    b = view("fig4")
    b.run("document.querySelector('#map').scrollIntoView({ behavior: 'instant' })")
    cells = computed("fig4").cells
    number = next(n for n, c in enumerate(cells) if c.stable == 2 and c.sample["rho"] > 0.3)
    b.click(*place(b, number))
    shown = b.run(FEW)
    assert shown["head"] == f"Cell {number}: 2 stable of 6 equilibria"
    assert (shown["poses"], shown["stable"]) == (6, 2)
    assert shown["marks"] >= 6 + 3  # in the picture, and in the legend
    assert shown["contours"] >= 15 + 3
    assert (
        b.run(
            f"document.querySelector('#map [data-cell=\"{number}\"]').getAttribute('aria-pressed')"
        )
        == "true"
    )
    ink = "(() => { const c = document.querySelector('#poses canvas'); const d = c.getContext('2d')"
    ink += ".getImageData(0, 0, c.width, c.height).data; return new Set(d).size; })()"
    assert b.run(ink) > 10
    # each pose: two rods, three springs, four nodes, two loads
    for what, many in (("bar", 2), ("spring", 3), ("node", 4), ("load-head", 2)):
        assert (
            b.run(
                f"document.querySelectorAll('#poses .pose')[0].querySelectorAll('.{what}').length"
            )
            == many
        )
    b.picture("fig4-light.png")
    b.run("document.querySelector('#close').click()")
    assert b.run(FEW)["poses"] == 0
    quiet(b, "fig4")


def test_lowest_energy_is_where_the_picture_is_darkest(view: Callable[..., Browser]) -> None:
    """The landscape that the browser computes has its least value at the stable pose of least
    certified energy.
    """
    b = view("fig4")
    for number in (8, 21):
        b.run(f"choose({number}, false)")
        least, at, pose, level = b.run(
            f"""(() => {{
              const cell = DATA.cells[{number}], table = energyTable(cell, 360);
              let least = Infinity, at = [0, 0];
              for (const [j, row] of table.entries()) for (const [i, value] of row.entries()) {{
                if (value < least) {{ least = value; at = [i - 180, j - 180]; }}
              }}
              const [c1, s1, c2, s2] = cell.equilibria[0].at;
              const pose = [Math.atan2(s1, c1) * 180 / Math.PI, Math.atan2(s2, c2) * 180 / Math.PI];
              return [least, at, pose, cell.equilibria[0].level];
            }})()"""
        )
        assert least == pytest.approx(level, rel=1e-3)
        assert at == pytest.approx(pose, abs=2)


def test_the_keyboard_does_all_of_it(view: Callable[..., Browser]) -> None:
    b = view("fig4")
    stops = []
    for _ in range(6):
        b.press("Tab")
        stops.append(
            b.run("document.activeElement.getAttribute('class') || document.activeElement.id")
        )
        if stops[-1].startswith("cell"):
            break
    assert stops[-1].startswith("cell"), stops
    assert (
        b.run("getComputedStyle(document.activeElement).strokeWidth") == "4px"
    )  # the focus is seen
    visited = {b.run("Number(document.activeElement.dataset.cell)")}
    # every cell can be reached with the arrows
    stacks = computed("fig4").stacks
    for stack in range(len(stacks)):
        for _ in stacks[stack].cells:
            b.press("ArrowDown")
        for _ in stacks[stack].cells:
            visited.add(b.run("Number(document.activeElement.dataset.cell)"))
            b.press("ArrowUp")
        b.press("ArrowRight")
    assert visited == set(range(len(computed("fig4").cells)))
    assert b.run("document.querySelectorAll('.cell[tabindex=\"0\"]').length") == 1
    b.press("Home", "Enter")
    assert b.run(FEW)["head"].startswith("Cell 0:")
    b.press("End", " ")
    assert b.run(FEW)["head"].startswith("Cell 21:")
    assert b.run("document.activeElement.dataset.cell") == "21"
    b.press("Tab")
    b.press("Escape")
    assert b.run(FEW)["poses"] == 0
    quiet(b, "fig4")


@pytest.mark.parametrize(("axes", "base"), [("rho,L2", 0), ("L2,rho", 1)])
@pytest.mark.slow_cases("L2,rho-1")
def test_the_arrows_follow_the_map(one: Browser, tmp_path: Path, axes: str, base: int) -> None:
    """Also where the stacks stand over the vertical axis: up is up; and samples are drawn within
    their cells.
    """
    result = ptmcad.classify(ptmcad.slice_from_options(CONFIGS / "fig4.yaml", slice=axes))
    assert result.base == base
    file = tmp_path / "map.html"
    file.write_text(page(result), encoding="utf-8")
    one.media(prefers_color_scheme="light")
    one.size(1200, 900)
    one.open(file)
    moves = 0
    for number in range(len(result.cells)):
        for key, axis, sign in (
            ("ArrowRight", 0, 1),
            ("ArrowLeft", 0, -1),
            ("ArrowUp", 1, -1),
            ("ArrowDown", 1, 1),
        ):
            step = one.run(
                f"(() => {{ const n = neighbour({number}, '{key}');"
                f" return n === undefined ? null : DATA.cells[n].at[{axis}] - DATA.cells[{number}].at[{axis}]; }})()"
            )
            if step is not None:
                assert step * sign > 0
                moves += 1
        inside = f"""(() => {{
          const area = document.querySelector('#map [data-cell="{number}"]');
          const [x, y] = DATA.cells[{number}].at;
          const {{ width, height }} = area.getBBox();
          return Math.min(width, height) < 3 * DATA.grid || cellAt([x / DATA.side, 1 - y / DATA.side]) === {number};
        }})()"""
        assert one.run(inside)
    assert moves >= 2 * (len(result.cells) - 1)
    assert one.complaints() == []


def test_light_dark_and_the_button(view: Callable[..., Browser]) -> None:
    b = view("fig3", "index")
    background = "getComputedStyle(document.body).backgroundColor"
    light = b.run(background)
    b.run("choose(0, false)")
    shade = "(() => { const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true });"
    shade += "copy.drawImage(document.querySelector('#poses canvas'), 0, 0);"
    shade += "return copy.getImageData(128, 128, 1, 1).data[0]; })()"
    light_shade = b.run(shade)
    b.media(prefers_color_scheme="dark")
    dark = b.run(background)
    assert light == "rgb(255, 255, 255)" != dark
    b.until(f"{shade} !== {light_shade}")
    b.picture("fig3-index-dark.png")
    switch = "document.querySelector('#theme')"
    shown, face = (
        f"[{switch}.ariaPressed, {switch}.textContent]",
        f"getComputedStyle({switch}).backgroundColor",
    )
    assert b.run(shown) == ["true", "Dark: on"]
    pressed = b.run(face)
    b.run("document.querySelector('#theme').click()")
    assert b.run(background) == light
    assert b.run(shown) == ["false", "Dark: off"] and b.run(face) != pressed
    b.media(prefers_color_scheme="light")
    b.run("document.querySelector('#theme').click()")
    assert b.run(background) == dark
    quiet(b, "fig3", "index")


CONTRAST = """(() => {
  const parts = (c) => c.match(/[\\d.]+/g).map(Number);
  const light = (c) => { const [r, g, b] = parts(c).map((v) => { v /= 255;
    return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  let least = Infinity, where = '';
  const texts = 'p, dt, dd, th, td, li, small, h1, h2, button, summary, code, figcaption';
  for (const e of document.querySelectorAll(texts)) {
    let own = e, back = 'rgba(0, 0, 0, 0)';
    while (own && parts(back)[3] === 0) { back = getComputedStyle(own).backgroundColor; own = own.parentElement; }
    const [a, b] = [light(getComputedStyle(e).color), light(back)];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < least) { least = ratio; where = e.outerHTML.slice(0, 80); }
  }
  return [least, where]; })()"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_contrast(view: Callable[..., Browser], scheme: str) -> None:
    """At least the 4.5 that the Web Content Accessibility Guidelines ask for."""
    b = view("fig4")
    b.media(prefers_color_scheme=scheme)
    b.run("choose(8, false)")
    least, where = b.run(CONTRAST)
    assert least >= 4.5, where


@pytest.mark.parametrize(
    "width", [320, *(pytest.param(w, marks=pytest.mark.slow) for w in (360, 768))]
)
def test_narrow_screens_need_no_sideways_scrolling(
    view: Callable[..., Browser], width: int
) -> None:
    b = view("fig4")
    b.size(width, 740, phone=True)
    b.run("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    b.run("document.querySelector('#map').scrollIntoView({ behavior: 'instant' })")
    number = next(
        n for n, c in enumerate(computed("fig4").cells) if c.stable == 2 and c.sample["rho"] > 0.3
    )
    b.tap(*place(b, number))
    b.until("document.querySelectorAll('#poses .pose').length === 6")
    assert f"Cell {number}, " in b.run("document.querySelector('#readout').textContent")
    assert b.run("document.documentElement.scrollWidth") == width
    small = b.run(
        "[...document.querySelectorAll('.number, .name')].map((t) => "
        "parseFloat(getComputedStyle(t).fontSize) * t.ownerSVGElement.getScreenCTM().a)"
    )
    assert min(small) > 9.0  # CSS pixels
    b.run("document.querySelectorAll('details').forEach((d) => { d.open = false; })")
    b.picture(f"fig4-phone-{width}.png")
    quiet(b, "fig4")


CROWDED = """[...document.querySelectorAll('svg.map')].flatMap((map) => {
  const window = map.getBoundingClientRect();
  const all = [...map.querySelectorAll('.number, .name')];
  const texts = all.map((text) => [text.textContent, text.getBoundingClientRect()]);
  const out = texts.filter(([, box]) => box.left < window.left - 1 || box.right > window.right + 1
    || box.top < window.top - 1 || box.bottom > window.bottom + 1).map(([text]) => text);
  const meet = (a, b) => Math.min(Math.min(a.right, b.right) - Math.max(a.left, b.left),
    Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
  return [...out, ...texts.flatMap(([one, a], k) => texts.slice(0, k).filter(([, b]) => meet(a, b) > 2.5)
    .map(([other]) => `${one} on ${other}`))];
})"""


def strips() -> RegionMap:
    """A region that is too thin to be seen, between two upright strips."""
    steps, left = 2**20, 2**19
    sides = ((left, left + 64, 0, steps), (left + 2000, left + 2064, 0, steps))
    return certified(Cover(steps, sides), lambda x, y: 3 if 0.5 < x < 0.502 else 1)


@pytest.mark.parametrize("width", [320, 390, 1200])
@pytest.mark.parametrize("name", ["fig5-text", "stiffness", "views of thin regions"])
@pytest.mark.fast_cases(
    "views of thin regions-320", "views of thin regions-390", "views of thin regions-1200"
)
def test_numbers_and_names_stand_beside_each_other(
    one: Browser, tmp_path: Path, name: str, width: int
) -> None:
    """Within the picture, also where there are many digits and the type is large."""
    result = strips() if name.startswith("views") else computed(name)
    file = tmp_path / "map.html"
    file.write_text(page(result), encoding="utf-8")
    one.media(prefers_color_scheme="light")
    one.size(width, 900, phone=width < 600)
    one.open(file)
    assert one.run("document.querySelectorAll('.details svg').length") == name.startswith("views")
    assert one.run(CROWDED) == []


def test_copy_buttons_copy_what_stands_below_them(view: Callable[..., Browser]) -> None:
    """By the clipboard's interface where it is allowed, and by the older way where it is not."""
    b = view("fig4")
    b.run("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    many = b.run("document.querySelectorAll('button.copy').length")
    assert many >= 5 + 4
    b.run("window.seen = []; Object.defineProperty(navigator, 'clipboard', { configurable: true, value: "
          "{ writeText: async (t) => { window.seen.push(t); } } })")  # fmt: skip
    b.run(
        "(async () => { for (const c of document.querySelectorAll('button.copy')) { c.click(); await 0; } })()"
    )
    b.until(f"window.seen.length === {many}")
    expected = b.run("[...document.querySelectorAll('button.copy')].map((c) => "
                     "c.parentElement.querySelector('code').textContent)")  # fmt: skip
    assert sorted(b.run("window.seen")) == sorted(expected)
    assert any("sympy.symbols" in t for t in expected)
    b.run("Object.defineProperty(navigator, 'clipboard', { configurable: true, value: undefined });"
          "document.addEventListener('copy', () => { const a = document.activeElement;"
          " window.old = a.value.slice(a.selectionStart, a.selectionEnd); })")  # fmt: skip
    b.call(
        "Runtime.evaluate",
        expression="document.querySelector('button.copy').click()",
        userGesture=True,
    )
    b.until("document.querySelector('button.copy').textContent === 'Copied'")
    assert b.run("window.old") == expected[0]
    quiet(b, "fig4")


HOSTILE = "</script><script>window.pwned=1</script><img src=x onerror='window.pwned=2'>\"'`${window.pwned=3}"


def test_hostile_texts_run_nowhere(one: Browser, tmp_path: Path) -> None:
    result = computed("fig3")
    evil = replace(
        result,
        slice=replace(result.slice, title=HOSTILE),
        plan=tuple(replace(s, what=HOSTILE, reason=HOSTILE) for s in result.plan),
        versions={HOSTILE: HOSTILE},
    )
    file = tmp_path / "evil.html"
    file.write_text(page(evil), encoding="utf-8")
    one.media(prefers_color_scheme="light")
    one.size(1200, 900)
    one.open(file)
    one.run("choose(0, false)")
    assert one.run("window.pwned") is None
    assert one.run("document.querySelector('h1').textContent") == HOSTILE
    assert one.run("document.title") == HOSTILE
    assert one.complaints() == []
    assert len(one.requests()) == 1


def test_the_policy_stops_what_is_not_the_pages_own(view: Callable[..., Browser]) -> None:
    """Scripts and pictures that were smuggled in would not run or load."""
    b = view("fig3")
    before = len(b.requests())
    b.run("document.body.insertAdjacentHTML('beforeend', '<img src=\"https://example.invalid/x.png\">');"
          "const s = document.createElement('script'); s.textContent = 'window.pwned = 1'; document.body.append(s);"
          "fetch('https://example.invalid/').catch(() => {}); 0")  # fmt: skip
    assert b.run("window.pwned") is None
    b.until("document.images.length === 1 && document.images[0].complete")
    assert any("Content Security Policy" in text for text in b.complaints())
    sent = [r for r in b.requests()[before:] if "example.invalid" in r]
    assert b.run("document.images[0].naturalWidth") == 0
    blocked = [e for e in b.events if e.get("method") == "Network.loadingFailed"]
    assert len(sent) == sum(e["params"].get("blockedReason") == "csp" for e in blocked)


def test_reduced_motion_and_print(view: Callable[..., Browser], tmp_path: Path) -> None:
    b = view("fig4")
    assert b.run("getComputedStyle(document.documentElement).scrollBehavior") == "smooth"
    b.media(prefers_reduced_motion="reduce")
    assert b.run("getComputedStyle(document.documentElement).scrollBehavior") == "auto"
    b.run("choose(8, false)")
    b.run("document.querySelector('#theme').click()")
    b.media(media="print")
    assert b.run("getComputedStyle(document.body).color") == "rgb(0, 0, 0)"
    assert b.run("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert b.run("getComputedStyle(document.querySelector('#close')).display") == "none"
    for part in (".pose", ".grid-of-poses", "#live", "#readout"):  # are not split over two pages
        assert b.run(f"getComputedStyle(document.querySelector('{part}')).breakInside") == "avoid"
    # nothing is folded on paper, and afterwards all is as it was
    opened = "document.querySelectorAll('details[open]').length"
    b.run(
        "window.atPrint = 0; window.addEventListener('beforeprint', () => { window.atPrint = "
        + opened
        + "; })"
    )
    before = b.run(opened)
    b.printed(tmp_path / "fig4-print.pdf")
    assert (
        b.run("window.atPrint")
        == b.run("document.querySelectorAll('details').length")
        > before
        == b.run(opened)
    )
    assert (tmp_path / "fig4-print.pdf").read_bytes().startswith(b"%PDF")
    quiet(b, "fig4")


def test_a_landscape_under_a_moment_is_level_at_the_equilibria(
    one: Browser, tmp_path: Path
) -> None:
    """The browser's table of what is drawn, by differences around each equilibrium, against the
    moment left out.
    """
    record = yaml.safe_load("""
        name: turned
        mechanism:
          parameters: {M: {}, F: {kind: force}}
          unknowns: {th: angle, ph: angle}
          points: {O: [0, 0], P: [cos(th), sin(th)], Q: [cos(th) + cos(ph)/2, sin(th) + sin(ph)/2]}
          torsion: [{angle: th, k: 2}, {angle: ph - th, k: 1}]
          moments: {th: M, ph: 1/5}
          loads: {Q: [F, 0]}
        axes: {M: [1, 2], F: [0, 1]}
    """)
    result = ptmcad.classify(ptmcad.slice_from_mapping(record), area_tolerance="1/10")
    path = tmp_path / "turned.html"
    path.write_text(page(result), encoding="utf-8")
    one.size(1200, 900)
    one.open(path)
    number = next(n for n, cell in enumerate(result.cells) if cell.total)
    one.run(f"choose({number}, false)")
    found = one.run(
        f"(() => {{ const cell = DATA.cells[{number}]; const steps = 1440; const table = energyTable(cell, steps);"
        " const at = (c, s) => Math.round((Math.atan2(s, c) + Math.PI) / (2 * Math.PI) * steps);"
        " return { title: landscapeTitle(cell), rises: cell.equilibria.map((pose) => {"
        " const [i, j] = [at(pose.at[0], pose.at[1]), at(pose.at[2], pose.at[3])];"
        " return [table[j][i + 1] - table[j][i - 1], table[j + 1][i] - table[j - 1][i],"
        " table[j][i] - levelOf(cell, pose)]; }) }; })()"
    )
    assert "not periodic" in found["title"] and len(found["rises"]) == result.cells[number].total
    step = 2 * pi / 1440
    for rises in found["rises"]:
        # a grid's point is at most half a step away, and second derivatives are below 5; the
        # moments are 1 / 5 and more
        assert all(abs(rise) / (2 * step) < 5 * step for rise in rises[:2]) and abs(rises[2]) < 1e-3
    assert one.complaints() == []
