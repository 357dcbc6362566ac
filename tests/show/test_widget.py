"""A notebook's living map: what Python knows of its point, and the page in a frame that a browser
drives.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from support import browser as chromium
from support.browser import Browser
from support.maps import shipped

from ptmcad import extras
from ptmcad.errors import ConfigError, PtmcadError
from ptmcad.show.report import page
from ptmcad.workbench.fields.quantityfield import exact_at

SCRIPT = Path(chromium.__file__).parents[2] / "ptmcad" / "show" / "widget.js"
needs_anywidget = pytest.mark.skipif(
    find_spec("anywidget") is None, reason="anywidget is not installed"
)


@needs_anywidget
def test_the_point_has_its_exact_poses() -> None:
    result = shipped("fig4")
    widget: Any = result.explore()
    assert (widget.point, widget.poses) == ({}, None)
    widget.point = {"rho": 0.7, "L2": 1.5}
    poses = exact_at(result, Fraction(7, 10), Fraction(3, 2))
    assert [p.angles for p in widget.poses.equilibria] == [p.angles for p in poses.equilibria]
    assert widget._answer.startswith("Exact solutions at the point:\n")
    widget.point = {"L2": 1, "rho": "1.25"}
    assert widget.point == {"rho": 1.25, "L2": 1.0}
    assert widget.poses.stable == 1


@needs_anywidget
def test_points_elsewhere_are_refused() -> None:
    from traitlets import TraitError

    widget: Any = shipped("fig4").explore()
    widget.point = {"rho": 0.7, "L2": 1.5}
    for point, message in (
        ({"rho": 1}, "a point has numbers for rho and L2"),
        ({"rho": "x", "L2": 1}, "a point has numbers for rho and L2"),
        ({"rho": 2, "L2": 1}, "rho = 2.0 is not inside the window, 0 to 2"),
        ({"rho": float("nan"), "L2": 1}, "rho = nan is not inside the window"),
    ):
        with pytest.raises(TraitError, match=message):
            widget.point = point
    assert widget.point == {"rho": 0.7, "L2": 1.5}
    with pytest.raises(TraitError):
        widget.poses = None


@needs_anywidget
def test_where_there_is_no_answer_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    widget: Any = shipped("fig4").explore()
    widget.point = {"rho": 0.7, "L2": 1.5}

    def refuse(*_: object) -> None:
        raise PtmcadError("not here")

    monkeypatch.setattr(widget, "_solve", refuse)
    widget.point = {"rho": 0.8, "L2": 1.5}
    assert (widget.poses, widget._answer) == (None, "not here")


def test_without_anywidget_the_message_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    with pytest.raises(
        ConfigError, match=r"anywidget, which is not installed: pip install 'ptmcad\[notebook\]'"
    ):
        shipped("fig4").explore()


MODEL = """
const values = { _page: document.getElementById("page").textContent, _names: ["rho", "L2"], _answer: "", point: {} };
const heard = {};
const saved = [];
const model = {
  get: (name) => values[name],
  set: (name, value) => { values[name] = value; (heard[`change:${name}`] || []).forEach((call) => call()); },
  save_changes: () => saved.push({ ...values.point }),
  on: (name, call) => { (heard[name] ||= []).push(call); },
  off: (name, call) => { heard[name] = heard[name].filter((other) => other !== call); },
};
const leave = widget.render({ model, el: document.getElementById("here") });
"""


@pytest.fixture(scope="module", name="view")
def notebook(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The widget in a page made by hand, with a model that keeps what it is told."""
    if chromium.PROGRAM is None:
        pytest.skip(chromium.MISSING)
    script = SCRIPT.read_text(encoding="utf-8").replace("export default", "const widget =")
    text = json.dumps(page(shipped("fig4"))).replace("<", "\\u003c")
    file = tmp_path_factory.mktemp("widget") / "notebook.html"
    file.write_text(
        '<!DOCTYPE html><meta charset="utf-8"><div id="here"></div><script id="page" type="text/plain"></script>'
        f'<script>document.getElementById("page").textContent = {text};</script><script>{script}{MODEL}</script>',
        encoding="utf-8",
    )
    with chromium.browser() as found:
        found.size(900, 900)
        found.open(file)
        found.until("saved.length > 0")
        yield found
        assert found.complaints() == []
        assert len(found.requests()) == 1


def inside(view: Browser, expression: str) -> Any:
    """The value of an expression in the widget's frame, which is a process of its own."""
    (frame,) = [t for t in view.call("Target.getTargets")["targetInfos"] if t["type"] == "iframe"]
    outer = view.session
    view.session = view.call("Target.attachToTarget", targetId=frame["targetId"], flatten=True)[
        "sessionId"
    ]
    try:
        return view.run(expression)
    finally:
        view.session = outer


def test_the_frame_shows_the_map_alone_and_says_where_its_point_is(view: Browser) -> None:
    assert view.run("saved[0]") == pytest.approx({"rho": 1.12, "L2": 0.92})
    assert inside(view, "getComputedStyle(document.querySelector('header')).display") == "none"
    assert inside(view, "getComputedStyle(document.querySelector('#cells')).display") == "block"
    # nothing of the notebook is within its reach
    assert (
        inside(view, "(() => { try { return String(parent.document); } catch { return 'no'; } })()")
        == "no"
    )
    assert view.run("document.querySelector('iframe').sandbox.value") == "allow-scripts"
    view.until("document.querySelector('iframe').style.height.endsWith('px')")
    assert (
        300
        < float(view.run("document.querySelector('iframe').style.height").removesuffix("px"))
        <= 720
    )


@pytest.mark.slow
def test_a_drag_tells_python_where_it_rests(view: Browser) -> None:
    before = view.run("saved.length")
    x, y, side = inside(view, "(() => { const b = document.querySelector('#map .frame').getBoundingClientRect();"
                              " return [b.left, b.top, b.width]; })()")  # fmt: skip
    left, top = view.run("(() => { const b = document.querySelector('iframe').getBoundingClientRect();"
                         " return [b.left, b.top]; })()")  # fmt: skip
    ring = inside(view, "live.share")
    places = [
        (left + x + s * side, top + y + (1 - t) * side) for s, t in (ring, (0.5, 0.6), (0.35, 0.75))
    ]
    view.drag(*places)
    view.until(f"saved.length > {before}")
    told = view.run("saved.at(-1)")
    assert (told["rho"], told["L2"]) == pytest.approx((0.7, 1.5), abs=0.02)
    assert inside(view, "pointOf(live.share)") == pytest.approx([told["rho"], told["L2"]])
