"""The HTML report without a browser: what is in it, what cannot get into it, and that it can be
posed again.
"""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from fractions import Fraction
from html import escape, unescape
from html.parser import HTMLParser
from math import atan2, hypot, pi
from pathlib import Path
from typing import Any

import pytest
import yaml
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st
from support.certified_map import certified_map
from support.pages import data_of
from support.replacing import replace
from support.shipped_records import OTHER

import ptmcad
from ptmcad.answer.regionmap import RegionMap, Solution, Status
from ptmcad.cli import run
from ptmcad.errors import ConfigError
from ptmcad.model import known_of
from ptmcad.question.config import load, slice_from_mapping, slice_from_options
from ptmcad.question.slice import Point
from ptmcad.show.render.axes import scale_of, ticks
from ptmcad.show.report import page
from ptmcad.show.report.equilibria import at_sample, decimal_text, degrees
from ptmcad.show.report.error_curve import read_error_curve
from ptmcad.show.report.reportpage import harmless
from ptmcad.show.report.reproduction import reproduction
from ptmcad.show.report.sections import question
from ptmcad.text.balls import ball_over, enclosure_of
from ptmcad.text.numerals import text_of

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
PAPER = ("fig2", "fig3", "fig4", "fig5-text", "fig5-caption")
Shipped = Callable[..., RegionMap]


class Elements(HTMLParser):
    """All start tags with their attributes, and the text within each named element."""

    def __init__(self, text: str):
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def with_class(self, name: str) -> list[dict[str, str | None]]:
        return [a for _, a in self.tags if name in (a.get("class") or "").split()]


@pytest.mark.parametrize("name", PAPER)
@pytest.mark.fast_cases("fig2", "fig3")
def test_every_cell_is_on_the_map_and_in_the_data(shipped: Shipped, name: str) -> None:
    result = shipped(name)
    text = page(result)
    elements = Elements(text)
    areas = [int(a["data-cell"] or "") for a in elements.with_class("cell")]
    chips = [int(number) for number in re.findall(r'<button class="chip">(\d+)</button>', text)]
    assert set(areas) == set(range(len(result.cells)))
    assert (
        sorted(chips)
        == sorted(n for r in result.regions for n in r.cells)
        == list(range(len(result.cells)))
    )
    data = data_of(text)
    for cell, told in zip(result.cells, data["cells"], strict=True):
        assert len(told["equilibria"]) == cell.total
        assert [e["kind"] for e in told["equilibria"]].count("stable") == cell.stable
        assert [both.split()[0] for both in told["sample"]] == [
            text_of(cell.sample[0]),
            text_of(cell.sample[1]),
        ]
    assert data["names"] == list(result.slice.axis_names)


def test_the_page_asks_for_nothing(shipped: Shipped) -> None:
    """No element that loads, no address, no style or event attribute; the policy names two hashes
    and nothing else.
    """
    text = page(shipped("fig4"))
    elements = Elements(text)
    assert not {
        "link",
        "img",
        "iframe",
        "object",
        "embed",
        "base",
        "form",
        "video",
        "audio",
        "image",
    } & {tag for tag, _ in elements.tags}
    for _, attributes in elements.tags:
        assert not {"src", "style", "srcset", "action"} & set(attributes)
        assert not any(name.startswith("on") for name in attributes)
        assert (attributes.get("href") or "#").startswith("#")
    policy = next(
        a["content"] for _, a in elements.tags if a.get("http-equiv") == "Content-Security-Policy"
    )
    assert re.fullmatch(
        r"default-src 'none'; style-src 'sha256-[\w+/=]+'; script-src 'sha256-[\w+/=]+'; base-uri 'none'; "
        r"form-action 'none'",
        policy or "",
    )
    assert not re.search(r"https?:(?!//www\.w3\.org/2000/svg)", text)


SUSPENDED = yaml.safe_load("""
name: suspended
unknowns: {x: length, y: length}
points: {A: [-a, 0], B: [a, 0], P: [x, y]}
parameters: {a: {kind: base}, f: {kind: force}}
springs: [{between: [A, P], k: 1}, {between: [B, P], k: 1}]
loads: {P: [0, f]}
""")
CUBIC = {"name": "cubic", "unknowns": {"x": "real"}, "equations": ["x^3 - a*x - f"]}


@pytest.mark.parametrize(("key", "model"), [("mechanism", SUSPENDED), ("system", CUBIC)])
@pytest.mark.parametrize("title", ["", "a mass < 1 & its two\nsprings"])
def test_what_is_asked_of_has_its_own_title(key: str, model: dict[str, object], title: str) -> None:
    described = {**model, "title": title} if title else model
    result = ptmcad.classify(
        slice_from_mapping({key: described, "axes": {"a": [0, 2], "f": [-1, 1]}})
    )
    stored = RegionMap.from_json(result.to_json())
    shown = escape(" ".join(title.split())) or model["name"]
    assert stored.slice == result.slice
    assert question(result) == question(stored)
    assert f"<dt>{key.capitalize()}</dt><dd>{shown}</dd>" in question(stored)


def test_the_title_of_the_paper_s_mechanism(shipped: Shipped) -> None:
    shown = "<dt>Mechanism</dt><dd>the planar tensegrity mechanism of Wenger and Chablat</dd>"
    assert shown in question(shipped("fig2"))


HOSTILE = "</script><script>document.title='pwned'</script><img src=x onerror=alert(1)>\"'&amp;<!--"


def test_nothing_of_a_result_becomes_markup(shipped: Shipped) -> None:
    """Every text of the file that its reader lets pass is put where markup would hurt."""
    result = shipped("fig3")
    slice = replace(result.slice, title=HOSTILE)
    slices = (
        replace(slice, text={"F3": HOSTILE}),
        replace(slice, model=known_of(HOSTILE[:90]), text={}),
    )
    evil = replace(
        result,
        components=tuple(
            replace(c, left_out=HOSTILE) if c.left_out else c for c in result.components
        ),
        plan=tuple(replace(s, what=HOSTILE, reason=HOSTILE) for s in result.plan),
        versions={HOSTILE: HOSTILE},
        precision={HOSTILE: 3},
        timings={HOSTILE: 1.0},
    )
    clean = Elements(page(result))
    for slice in slices:
        text = page(
            RegionMap.from_json(replace(evil, slice=slice).to_json())
        )  # such a file is read
        dirty = Elements(text)
        assert {tag for tag, _ in dirty.tags} <= {tag for tag, _ in clean.tags}
        assert sum(tag == "script" for tag, _ in dirty.tags) == 2
        assert "<img" not in text
        assert {key for _, a in dirty.tags for key in a} <= {
            key for _, a in clean.tags for key in a
        }
        assert HOSTILE in unescape(text)


def test_the_data_can_not_close_its_element() -> None:
    """Whatever may ever come into it."""
    text = harmless({"a": HOSTILE + "\u2028\u2029"})
    assert not set("<>&\u2028\u2029") & set(text)
    assert json.loads(text) == {"a": HOSTILE + "\u2028\u2029"}


def test_the_same_result_gives_the_same_bytes(shipped: Shipped) -> None:
    """Times apart, which are reported only when asked for."""
    result = shipped("fig2")
    slower = replace(result, timings={"variety": 12.34567, "total": 99.0})
    assert page(result, timings=False) == page(slower, timings=False)
    assert page(result) != page(slower)
    assert "12.3457" in page(slower)
    assert page(RegionMap.from_json(slower.to_json()), timings=False) == page(result, timings=False)


# ------------------------------------------------------------------------------------------------- the same question


def core(slice: ptmcad.Slice) -> ptmcad.Slice:
    return replace(slice, reference={}, text={}, name="", title="")


COUNTED = [
    *((path.stem, ptmcad.Count.STABLE) for path in sorted(CONFIGS.glob("*.yaml"))),
    *(("fig4", count) for count in ptmcad.Count if count is not ptmcad.Count.STABLE),
    ("free02", ptmcad.Count.ADMISSIBLE),
]


@pytest.mark.parametrize(("name", "count"), COUNTED)
def test_record_and_command_pose_the_slice_again(
    name: str, count: ptmcad.Count, tmp_path: Path
) -> None:
    slice = replace(load(CONFIGS / f"{name}.yaml"), count=count)
    posed, command = reproduction(slice)
    if count is ptmcad.Count.ADMISSIBLE and not slice.has_free_lengths:
        assert posed is None and command is None, "such a slice is refused"
        return
    assert posed is not None
    assert command is not None
    record = tmp_path / f"{slice.name}.yaml"
    record.write_text(posed, encoding="utf-8")
    again = load(record)
    assert core(again) == core(slice)
    assert (again.name, again.title) == (slice.name, slice.title)
    assert yaml.safe_load(posed)["name"] == slice.name  # any reader of YAML, not just ours
    words = shlex.split(command)
    assert words[:2] == ["ptmcad", "classify"]
    options: dict[str, list[str]] = {}
    for option, value in zip(words[2::2], words[3::2], strict=True):
        options.setdefault(option, []).append(value)
    assert core(slice_from_options(None, options["--slice"][0], options.get("--set", ()), options["--range"],
                                   options.get("--count", [None])[0])) == core(slice)  # fmt: skip


@pytest.mark.parametrize("path", OTHER, ids=lambda p: p.stem)
@pytest.mark.fast_cases("slider-crank", "two-x-joints", "platform-loop", "duffing")
def test_a_record_poses_the_slice_of_another_model_again(path: Path, tmp_path: Path) -> None:
    """With its whole description; no command line says as much."""
    slice = load(path)
    posed, command = reproduction(slice)
    assert posed is not None
    assert command is None
    record = tmp_path / "again.yaml"
    record.write_text(posed, encoding="utf-8")
    assert core(load(record)) == core(slice)


def test_the_commands_on_the_page_give_the_same_result(
    shipped: Shipped,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """They are run as they stand on the page, all of them, in an empty folder."""
    result = ptmcad.classify(load(CONFIGS / "fig2.yaml"))
    boxes = [unescape(t) for t in re.findall(r"<code>([^<]*)</code></pre>", page(result))]
    record = next(t for t in boxes if t.startswith("name:"))
    commands = [t for t in boxes if t.startswith("ptmcad ")]
    assert [shlex.split(c)[1] for c in commands] == ["classify", "classify", "verify", "locate"]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fig2.yaml").write_text(record, encoding="utf-8")
    for command in commands:
        arguments = shlex.split(command)[1:]
        extra = ["--format", "json", "--no-timings"] if arguments[0] == "classify" else []
        assert run([*arguments, *extra]) == 0, command
    again = RegionMap.from_json((tmp_path / "fig2.json").read_text(encoding="utf-8"))
    assert replace(again, slice=result.slice) == RegionMap.from_json(result.to_json())
    without = RegionMap.from_json((tmp_path / "slice-L2-rho.json").read_text(encoding="utf-8"))
    assert replace(without, slice=result.slice) == RegionMap.from_json(result.to_json())
    assert "1 stable" in capsys.readouterr().out


def test_a_slice_that_no_record_gives_is_said_to_be_so(shipped: Shipped) -> None:
    result = shipped("fig4")
    odd = replace(result, slice=replace(result.slice, model=known_of("another")))
    assert reproduction(odd.slice)[0] is None
    assert "No problem record gives this slice" in page(odd)


# ------------------------------------------------------------------------------------------------- numbers


@given(
    low=st.fractions(min_value=-1000, max_value=1000),
    width=st.fractions(min_value=0, max_value=1),
    exponent=st.integers(-12, 3),
)
def test_decimals_are_within_a_unit_of_both_bounds(
    low: Fraction, width: Fraction, exponent: int
) -> None:
    text = decimal_text((low, low + width), exponent).replace("−", "-")
    mantissa, _, power_of_ten = text.partition("e")
    decimals = len(mantissa.partition(".")[2])
    unit = Fraction(10) ** (int(power_of_ten or 0) - decimals)
    value = Fraction(mantissa) * Fraction(10) ** int(power_of_ten or 0)
    assert max(abs(value - low), abs(low + width - value)) <= max(unit, Fraction(10) ** exponent)


@given(degree=st.integers(-179, 180), slack=st.sampled_from([0, 9, 7, 5]))
def test_angles_contain_the_true_one(degree: int, slack: int) -> None:
    """Against the floating-point angle, with the boxes' width from none to 1e-5."""
    import mpmath

    with mpmath.workdps(40):
        c, s = (
            Fraction(str(f(mpmath.mpf(degree) * mpmath.pi / 180))) for f in (mpmath.cos, mpmath.sin)
        )
    radius = Fraction(1, 10**slack) if slack else Fraction(1, 10**20)
    with ctx.workprec(128):
        angle = degrees(*(ball_over(v - radius, v + radius) for v in (c, s)))
        assert angle is not None
        found = enclosure_of(angle)
    turns = min((degree, degree - 360, degree + 360), key=lambda t: abs(t - found.low))
    assert found.low <= turns <= found.high
    assert found.high - found.low <= 400 * radius + Fraction(1, 10**15)


@pytest.mark.parametrize(
    "solution",
    [
        Solution((Fraction(1),), Fraction(0), "++"),
        Solution((Fraction(1), Fraction(10**400)), Fraction(0), "++"),
        Solution((Fraction(1), Fraction(1)), Fraction(10**400), "++"),
    ],
    ids=["one angle", "many turns", "a box without end"],
)
def test_boxes_of_angles_that_are_none_are_refused(solution: Solution) -> None:
    result = certified_map()
    with pytest.raises(ConfigError, match="no box around the unknowns"):
        at_sample(result, replace(result.cells[0], solutions=(solution,)))


def test_boxes_that_tell_no_angle() -> None:
    assert degrees(arb(0, 1), arb(0, 1)) is None
    assert degrees(arb(0), arb(0)) is None


def unit_of(text: str) -> float:
    """The unit of a decimal's last digit, and a little for the floating-point number that it is
    compared with.
    """
    return 10.0 ** -len(text.partition(".")[2]) + 1e-7


def test_poses_satisfy_the_mechanism(shipped: Shipped) -> None:
    """Lengths, energy and angles against plain floating point from the geometry of method.md."""
    result = shipped("fig4")
    for cell, told in zip(result.cells, data_of(page(result))["cells"], strict=True):
        rho, second = float(cell.sample["rho"]), float(cell.sample["L2"])
        for e in told["equilibria"]:
            c1, s1, c2, s2 = e["at"]
            a3, a4 = (c1, s1), (rho - second * c2, second * s2)
            assert e["nodes"] == [pytest.approx(p, abs=1e-8) for p in ((0, 0), (rho, 0), a3, a4)]
            lengths = (hypot(*a4), hypot(a3[0] - rho, a3[1]), hypot(a4[0] - a3[0], a4[1] - a3[1]))
            for text, length in zip(e["lengths"], lengths, strict=True):
                assert float(text) == pytest.approx(length, abs=unit_of(text), rel=0)
            for text, length in zip(e["forces"], lengths, strict=True):
                assert float(text) == pytest.approx(100 * length, abs=unit_of(text), rel=0)
            energy = 50 * sum(x * x for x in lengths) + 10 * (a3[1] + a4[1])
            assert float(e["energy"].replace("−", "-")) == pytest.approx(
                energy, abs=unit_of(e["energy"]), rel=0
            )
            for text, angle in zip(e["unknowns"], (atan2(s1, c1), atan2(s2, c2)), strict=True):
                digits = text.replace("−", "-").rstrip("°")
                assert float(digits) == pytest.approx(angle * 180 / pi, abs=unit_of(digits), rel=0)


@given(
    low=st.fractions(min_value=-(10**6), max_value=10**6),
    width=st.fractions(min_value=Fraction(1, 10**9), max_value=10**6),
)
def test_ticks_are_few_and_where_they_say(low: Fraction, width: Fraction) -> None:
    scale = scale_of(low, low + width)
    found = ticks((low, low + width), scale)
    assert 2 <= len(found) <= 7
    for text, position in found:
        value = Fraction(text.replace("−", "-")) * Fraction(10) ** scale.exponent + scale.offset
        assert value == low + width * position
        assert 0 <= position <= 1


# ------------------------------------------------------------------------------------------------- formulas


def test_the_sympy_form_on_the_page_runs(shipped: Shipped) -> None:
    import sympy

    result = shipped("fig4")
    code = next(
        unescape(t)
        for t in re.findall(r"<code>([^<]*)</code></pre>", page(result))
        if "sympy.symbols" in t
    )
    scope: dict[str, Any] = {"sympy": sympy}
    exec(code, scope)
    used = next(c for c in result.components if not c.left_out)
    assert sympy.expand(scope["p"] - used.polynomial.to_sympy(("rho", "L2"))) == 0


# ------------------------------------------------------------------------------------------------- stopped, damaged


def test_partial_results_say_that_they_are(shipped: Shipped) -> None:
    stages: list[RegionMap] = []
    from ptmcad.ask.classification import classify

    classify(load(CONFIGS / "fig2.yaml"), partial=stages.append)
    assert [m.status for m in stages[:-1]] == [Status.PARTIAL] * (len(stages) - 1)
    for stage in stages[:-1]:
        assert "Partial result." in page(stage)
    assert "No regions are known yet" in page(stages[0])
    assert "Partial result." not in page(stages[-1])


def damaged(result: RegionMap, kind: str) -> RegionMap:
    cells, stacks, regions = result.cells, result.stacks, result.regions
    match kind:
        case "cell of no region":
            return replace(result, cells=(replace(cells[0], region=99), *cells[1:]))
        case "stack of no cell":
            return replace(
                result, stacks=(replace(stacks[0], cells=(*stacks[0].cells[:-1], 999)), *stacks[1:])
            )
        case "wall too many":
            return replace(
                result, stacks=(replace(stacks[0], walls=stacks[0].walls * 2), *stacks[1:])
            )
        case "root that is not there":
            walls = tuple(replace(w, root=w.root + 9) for w in stacks[0].walls)
            return replace(result, stacks=(replace(stacks[0], walls=walls), *stacks[1:]))
        case "a million equilibria":
            return replace(result, regions=(replace(regions[0], stable=10**6), *regions[1:]))
        case "a sample far away":
            far = Point(result.slice.axis_names, Fraction(10**400), Fraction(1))
            return replace(result, cells=(replace(cells[0], sample=far), *cells[1:]))
        case "an area upside down":
            return replace(
                result, regions=(replace(regions[0], area=regions[0].area[::-1]), *regions[1:])
            )
        case "a box without end":
            wide = replace(cells[0].solutions[0], radius=Fraction(10**400))
            return replace(result, cells=(replace(cells[0], solutions=(wide,)), *cells[1:]))
        case _:
            wrong = replace(cells[0].solutions[0], center=(Fraction(5),) * 4)
            return replace(result, cells=(replace(cells[0], solutions=(wrong,)), *cells[1:]))


KINDS = ("cell of no region", "stack of no cell", "wall too many", "root that is not there", "a million equilibria",
         "a sample far away", "an area upside down", "a box without end",
         "an equilibrium off the circle")  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_damaged_results_are_refused(
    shipped: Shipped, kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "bad.json"
    file.write_text(damaged(shipped("fig4"), kind).to_json(), encoding="utf-8")
    older = tmp_path / "fig4.html"
    older.write_text("older")
    assert run(["report", str(file)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"error: {file}: ")
    assert error.count("\n") == 1
    assert older.read_text() == "older"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.json", "fig4.html"]


# ------------------------------------------------------------------------------------------------- the command


def test_the_command_writes_one_file(
    shipped: Shipped, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "fig3.json"
    file.write_text(shipped("fig3").to_json(), encoding="utf-8")
    assert run(["report", str(file)]) == 0
    assert (tmp_path / "fig3.html").read_text(encoding="utf-8") == page(
        RegionMap.from_json(file.read_text())
    )
    assert (
        run(
            [
                "report",
                str(file),
                "--out",
                str(tmp_path / "new"),
                "--name",
                "other.html",
                "--no-timings",
            ]
        )
        == 0
    )
    assert [p.name for p in (tmp_path / "new").iterdir()] == ["other.html"]
    assert "other.html" in capsys.readouterr().out


@pytest.mark.parametrize(
    "name", ["../x", "", "a/b", ".hidden", "x" * 101, "a\nb", "nul", "Aux.html", "a. "]
)
def test_names_that_are_no_file_names(shipped: Shipped, tmp_path: Path, name: str) -> None:
    file = tmp_path / "fig3.json"
    file.write_text(shipped("fig3").to_json(), encoding="utf-8")
    assert run(["report", str(file), "--name", name]) == 2
    assert [p.name for p in tmp_path.iterdir()] == ["fig3.json"]


CURVE = {
    "format": "ptmcad-error-time/1",
    "error": "relative width of the areas' bounds",
    "series": [
        {"name": "exact <b>", "points": [[0.3, 1e-3], [0.5, 1e-9]]},
        {"name": "grid", "points": [[1, 0.1]]},
    ],
}


def test_the_error_curve_is_shown_when_there_is_one(shipped: Shipped, tmp_path: Path) -> None:
    file = tmp_path / "fig3.json"
    file.write_text(shipped("fig3").to_json(), encoding="utf-8")
    html = tmp_path / "fig3.html"
    assert run(["report", str(file)]) == 0
    assert "Error against time" not in html.read_text(encoding="utf-8")
    (tmp_path / "fig3.error-time.json").write_text(json.dumps(CURVE))
    assert run(["report", str(file)]) == 0
    beside = html.read_text(encoding="utf-8")
    assert "Error against time" in beside
    assert "exact &lt;b&gt;" in beside
    assert len(Elements(beside).with_class("point")) == 3 + 2  # in the picture, and in the legend
    (tmp_path / "fig3.error-time.json").rename(tmp_path / "curve.json")
    assert run(["report", str(file), "--bench", str(tmp_path / "curve.json")]) == 0
    assert html.read_text(encoding="utf-8") == beside


@pytest.mark.parametrize(
    "change",
    [
        {"format": "x"},
        {"series": []},
        {"series": [{"name": "a", "points": []}]},
        {"series": [{"name": "a", "points": [[1, 0]]}]},
        {"series": [{"name": "a", "points": [[1, 2, 3]]}]},
        {"series": [{"name": "a\n", "points": [[1, 2]]}]},
        {"error": 3},
        {"more": 1},
    ],
    ids=str,
)
def test_other_files_are_no_error_curve(tmp_path: Path, change: dict[str, Any]) -> None:
    file = tmp_path / "curve.json"
    file.write_text(json.dumps({**CURVE, **change}))
    with pytest.raises(ConfigError):
        read_error_curve(file)
