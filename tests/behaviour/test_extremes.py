"""Where a range is widest: whether that is attained, by answers that were found by hand.

Each slice has lines on which the count is another one than beside them, or on which two ranges
become one: the count of such a line itself is the answer, and a limit is none.
"""

from __future__ import annotations

import csv
import json
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import jsonschema
import pytest

from ptmcad.cli import run

ROOT = Path(__file__).resolve().parents[2]
RANGE, DESIGN = (
    jsonschema.Draft202012Validator(
        json.loads((ROOT / "docs" / f"{name}.schema.json").read_text(encoding="utf-8"))
    )
    for name in ("range", "design")
)
ATTAINED, APPROACHED = "attained", "approached but not attained"
EXCEPT, UNDECIDED = "attained except at", "attainment not decided"


class Slice(NamedTuple):
    """A record and its answer.

    Attributes
    ----------
    system : the record's, as flow YAML.
    widths : the largest one as a decimal, and for each place the words; why is said beside them.
    """

    system: str
    width: str
    words: tuple[str, ...]
    attainment: str
    axes: str = "a: [-2, 2], b: [-1, 1]"


CRITICAL = ", a critical value of b"
EDGE = ", the edge of the window"
ROOT_2 = ", a root of a polynomial of degree 2"
WHOLE = "attained on the interval b from -1 to 1"
SLICES = {
    # a = x^2 + b/x on x > 0: for b > 0 two where a > 3 (b/2)^(2/3); x^2 = a has one positive
    # solution at b = 0
    "positive cubic": Slice(
        '{unknowns: {x: real}, equations: ["x^3 - a*x + b"], positive: ["x"]}',
        "2", (f"approached but not attained at b = 0{CRITICAL}",), APPROACHED,
    ),
    # the same at two places
    "cubic at two values": Slice(
        '{unknowns: {x: real}, equations: ["x^3 - a*x + b*(b - 1/2)"], positive: ["x"]}',
        "2", tuple(f"approached but not attained at b = {v}{CRITICAL}" for v in ("0", "0.5")), APPROACHED,
    ),
    # without a condition there are three on a > 0 at b = 0 itself
    "cusp of a potential": Slice(
        '{unknowns: {x: real}, potential: "x^4/4 - a*x^2/2 + b*x"}', "2", (f"attained at b = 0{CRITICAL}",), ATTAINED,
    ),
    # a > 3 (b^2/2)^(2/3), and with b^2 - 2 or (b^2 - 2)(b^2 - 3) for b: flat at 2, where nothing is
    # special
    "flat cusps at root 2 and root 3": Slice(
        '{unknowns: {x: real}, equations: ["x^3 - a*x + (b^2 - 2)^2*(b^2 - 3)^2"]}',
        "2", tuple(f"attained at b = {v}{CRITICAL}{ROOT_2}" for v in ("1.414213562", "1.732050808")), ATTAINED,
        "a: [-2, 2], b: [1, 2]",
    ),
    # 1 + 4 a b > 0: for all a in (-2, 2) where |b| <= 1/8; x = a is one solution at b = 0
    "quadratic that becomes linear": Slice(
        '{unknowns: {x: real}, equations: ["b*x^2 + x - a"]}',
        "4", ("attained on the interval b from -0.125 to 0.125 except at b = 0",), EXCEPT,
    ),
    # the same with b^2 - 2 and b^3 - 2: ends at the roots of 15/8 and 17/8
    "linear at the cube root of 2": Slice(
        '{unknowns: {x: real}, equations: ["(b^3 - 2)*x^2 + x - a"]}',
        "4", ("attained on the interval b from 1.233106037 to 1.285640795 except at b = 1.259921050",), EXCEPT,
        "a: [-2, 2], b: [1, 3/2]",
    ),
    # two where a > b^2 - 2 and b is not 0: x^2 = 0 at b = 0
    "parabola, the axes exchanged": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - b^2*(a + 2 - b^2)"]}',
        "4", (f"approached but not attained at b = 0{CRITICAL}",), APPROACHED, "b: [-1, 1], a: [-2, 2]",
    ),
    "parabola in two unknowns": Slice(
        '{unknowns: {x: real, y: real}, equations: ["x^2 - b^2*(a + 2 - b^2)", "y - x - a"]}',
        "4", (f"approached but not attained at b = 0{CRITICAL}",), APPROACHED,
    ),
    # between b^2 and 3/2, and between b + b^2 and 1 + b - b^2, which are parallel at b = 0
    "between a parabola and a line": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - b^2*(a - b^2)*(3/2 - a)"]}',
        "1.5", (f"approached but not attained at b = 0{CRITICAL}",), APPROACHED,
    ),
    # two where |a| > |b|: at b = 0 everywhere but at the point a = 0
    "two ranges that meet at root 2": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - (a^2 - (b^2 - 2)^2)"]}',
        "4", (f"attained at b = 1.414213562{CRITICAL}{ROOT_2}",), ATTAINED, "a: [-2, 2], b: [0, 2]",
    ),
    # a > -b^2: the ends of the window are in it
    "widest at both edges": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - (a + b^2)"]}',
        "3", tuple(f"attained at b = {v}{EDGE}" for v in (-1, 1)), ATTAINED,
    ),
    "widest where the derivative vanishes": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - (a + 1 - (b - 1/3)^2)"]}',
        "3.000000000", ("attained at b = 0.3333333333, where the derivative vanishes, once in the enclosure",),
        ATTAINED,
    ),
    # a line on which the equation is 0 = 0
    "all solutions on a line": Slice(
        '{unknowns: {x: real}, equations: ["b*(x^2 - a)"]}', "2", (f"{WHOLE} except at b = 0",), EXCEPT,
    ),
    "no energy of an angle on a line": Slice(
        '{unknowns: {th: angle}, potential: "-b^2*(a + 3)*cos(th)"}', "4", (f"{WHOLE} except at b = 0",), EXCEPT,
    ),
    # a line without a solution: b x^2 = a + 3, and b x^2 = a with either sign of b
    "no solution at the edge": Slice(
        '{unknowns: {x: real}, equations: ["b*x^2 - a - 3"]}',
        "4", ("attained on the interval b from 0 to 1 except at b = 0",), EXCEPT, "a: [-2, 2], b: [0, 1]",
    ),
    # double solutions that are real, complex, or excluded: three, two and two solutions at b = 0
    "one more solution on a line": Slice(
        '{unknowns: {x: real}, equations: ["(x^2 - a - 3)*((x - 3)^2 + b^2)"]}',
        "4", (f"{WHOLE} except at b = 0",), EXCEPT,
    ),
    "double complex solutions on a line": Slice(
        '{unknowns: {x: real}, equations: ["(x^2 - a - 2)*((x^2 + 1)^2 + b^2)"]}', "4", (WHOLE,), ATTAINED,
    ),
    "a double solution that is excluded": Slice(
        '{unknowns: {x: real}, equations: ["(x^2 - a - 3)*((x + 5)^2 + b^2)"], positive: ["x + 4"]}',
        "4", (WHOLE,), ATTAINED,
    ),
    # x^2 = b^2 (a + 1) from the edge on, and with the factor 1 - b^2
    "double at both edges": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - (1 - b^2)*(a + 3)"]}',
        "4", (f"{WHOLE} except at b = -1 and b = 1",), EXCEPT,
    ),
    "three exceptions": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - (b^3 - 2*b)^2*(a + 3)"]}',
        "4", ("attained on the interval b from -2 to 2 except at b = -1.414213562, b = 0 and b = 1.414213562",),
        EXCEPT, "a: [-2, 2], b: [-2, 2]",
    ),
    # a condition that is zero at b = 0: nothing counts there, or nothing is stable
    "a condition that is zero on a line": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - a - 2"], positive: ["b^2*(x + 5)"]}',
        "4", (f"{WHOLE} except at b = 0",), EXCEPT,
    ),
    "stability that is lost on a line": Slice(
        '{unknowns: {x: real}, equations: ["x*(x^2 - a - 3)"], stable: ["b^2*(3*x^2 - a - 3)"]}',
        "4", (f"{WHOLE} except at b = 0",), EXCEPT,
    ),
    # both solutions -s, s with s^2 = a + 3 are above b where a < b^2 - 3: for all a from
    # b = -5^(1/2) on
    "an interval to an irrational end": Slice(
        '{unknowns: {x: real}, equations: ["x^2 - a - 3"], positive: ["x - b"]}',
        "4", ("attained on the interval b from -3 to -2.236067977",), ATTAINED, "a: [-2, 2], b: [-3, 3]",
    ),
    # x^4 at b = 0 is degenerate, and a minimum all the same
    "a flat minimum": Slice(
        '{unknowns: {x: real}, potential: "x^4 + 2*x^2*b^2*(a + 3)"}',
        "4", (f"{WHOLE} (attainment not decided at b = 0)",), ATTAINED,
    ),
}  # fmt: skip


def asked(arguments: list[str], folder: Path, text: str, status: int = 0) -> None:
    path = folder / "record.yaml"
    path.write_text(text, encoding="utf-8")
    assert run([arguments[0], str(path), *arguments[1:], "--out", str(folder / "out")]) == status


def document(folder: Path) -> Any:
    (path,) = (folder / "out").glob("*.json")
    return json.loads(path.read_text(encoding="utf-8"))


def value(number: dict[str, Any]) -> float:
    return float(Fraction(number["low"]) + Fraction(number["high"])) / 2


@pytest.mark.parametrize("name", SLICES)
@pytest.mark.fast_cases(
    "positive cubic",
    "cusp of a potential",
    "flat cusps at root 2 and root 3",
    "quadratic that becomes linear",
    "linear at the cube root of 2",
    "parabola in two unknowns",
    "between a parabola and a line",
    "two ranges that meet at root 2",
    "widest at both edges",
    "all solutions on a line",
    "no energy of an angle on a line",
    "no solution at the edge",
    "one more solution on a line",
    "double complex solutions on a line",
    "a double solution that is excluded",
    "double at both edges",
    "three exceptions",
    "a condition that is zero on a line",
    "stability that is lost on a line",
    "an interval to an irrational end",
    "a flat minimum",
)
def test_range_says_whether_the_widest_range_is_attained(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    slice = SLICES[name]
    record = f"system: {slice.system}\naxes: {{{slice.axes}}}\n"
    asked(
        ["range", "--along", "a", "--over", "b", "--rows", "1", "--format", "json"],
        tmp_path,
        record,
    )
    told = [line for line in capsys.readouterr().out.splitlines() if line.startswith("widest ")]
    assert [line.partition(": ")[2] for line in told] == [
        f"width {slice.width}, {words}" for words in slice.words
    ]
    data = document(tmp_path)
    RANGE.validate(data)
    maxima = data["over"]["maxima"]
    assert [m["text"] for m in maxima] == list(slice.words)
    assert {m["attainment"] for m in maxima} == {slice.attainment}
    for m, words in zip(maxima, slice.words, strict=True):
        excepted = words.partition(" except at ")[2]
        shown = [
            part.split(" = ")[1] for part in excepted.replace(" and ", ", ").split(", ") if part
        ]
        assert [e["decimal"] for e in m["except"]] == shown
        assert [value(e) for e in m["except"]] == pytest.approx(list(map(float, shown)))


def test_what_is_not_known_of_a_continuum_is_not_decided(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """At b = 0 the unknown x is free and y is 1."""
    record = 'system: {unknowns: {x: real, y: real}, equations: ["b*(x^2 - a)", "y - 1"]}\naxes: {a: [-2, 2], b: [-1, 1]}'
    asked(
        ["range", "--along", "a", "--over", "b", "--rows", "1", "--format", "json"],
        tmp_path,
        record,
    )
    assert f"{UNDECIDED} at b = 0{CRITICAL}" in capsys.readouterr().out
    assert UNDECIDED in {m["attainment"] for m in document(tmp_path)["over"]["maxima"]}


DESIGNS = {
    # as above; the second with one solution: everywhere on b = 0, nowhere on an interval of another
    # line
    "approached": (
        '"x^3 - a*x + b"], positive: ["x"',
        2,
        "2",
        f"approached but not attained at b = 0{CRITICAL}",
    ),
    "on a line alone": ('"b*x^2 + x - a"', 1, "4", f"attained at b = 0{CRITICAL}"),
    "on an interval": (
        '"b*x^2 + x - a"',
        2,
        "4",
        "attained on the interval b from -0.125 to 0.125 except at b = 0",
    ),
    "where ranges meet": ('"x^2 - (a^2 - b^2)"', 2, "4", f"attained at b = 0{CRITICAL}"),
}


def designed(folder: Path, name: str) -> Any:
    """The document of a design."""
    equation, count, *_ = DESIGNS[name]
    record = (
        f"system: {{unknowns: {{x: real}}, equations: [{equation}]}}\naxes: {{a: [-2, 2], b: [-1, 1]}}\n"
        f"design: {{maximise: range, along: a, over: {{b: [-1, 1]}}, where: {{stable: {count}}}}}\n"
    )
    asked(["design", "--format", "json", "--evaluations", "5"], folder, record)
    return document(folder)


@pytest.mark.parametrize("name", DESIGNS)
def test_design_says_whether_its_bound_is_attained(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    *_, bound, words = DESIGNS[name]
    data = designed(tmp_path, name)
    out = capsys.readouterr().out
    assert (
        f"no design has more than {bound}" in out and f"by exact critical values: {words}\n" in out
    )
    DESIGN.validate(data)
    assert data["bound"] == bound and [e["text"] for e in data["extremes"]] == [words]
    reached = Fraction(data["value"][0]) == Fraction(bound)
    assert reached == (data["extremes"][0]["attainment"] != APPROACHED)
    if reached:
        at = Fraction(data["best"]["b"])
        assert at not in [Fraction(e["low"]) for e in data["extremes"][0]["except"]]


def test_a_line_in_the_variety_counts_under_conditions_too(tmp_path: Path) -> None:
    """With one solution the range is the whole line b = 0, and no line beside it has any."""
    record = (
        'system: {unknowns: {x: real}, equations: ["b*x^2 + x - a"]}\naxes: {a: [-2, 2], b: [-1, 1]}\n'
        "design: {maximise: range, along: a, over: {b: [-1, 1]}, where: {stable: 1, conditions: [b <= 1/2]}}\n"
    )
    asked(
        ["design", "--format", "json", "--evaluations", "5"], tmp_path, record, status=3
    )  # not found, but bounded
    data = document(tmp_path)
    assert data["bound"] == "4" and not data["proved"]


def test_sweep_says_whether_it_is_attained(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """At b = 0 the cubic has x = 0, which counts where d > 0 alone: there are then three on
    0 < a < d^2.
    """
    record = (
        'system: {unknowns: {x: real}, equations: ["x^3 - a*x + b"], positive: ["x + d"]}\n'
        "axes: {a: [-1, 2], b: [-1, 1]}\nsweep: {d: [0, 1/2]}\ncount: total\n"
    )
    asked(["sweep", "--along", "a", "--format", "csv,html"], tmp_path, record)
    shown = capsys.readouterr().out
    assert "2, approached but not attained" in shown and "0.25, attained" in shown
    (path,) = (tmp_path / "out").glob("*.csv")
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    words = [f"approached but not attained at b = 0{CRITICAL}", f"attained at b = 0{CRITICAL}"]
    assert [(row["attainment"], row["proof"]) for row in rows] == list(
        zip((APPROACHED, ATTAINED), words, strict=True)
    )
    (page,) = (tmp_path / "out").glob("*.html")
    assert all(text in page.read_text(encoding="utf-8") for text in words)


def test_sweep_says_attained_where_one_of_several_places_has_it(tmp_path: Path) -> None:
    """Two solutions on d < a where d = b^2 (b - 2)^2: on the line b = 0 one, on the edge b = 2 two."""
    record = (
        'system: {unknowns: {x: real}, equations: ["x^2 - c*b^2*(a - b^2*(b - 2)^2)"]}\n'
        "axes: {a: [0, 2], b: [-1, 2]}\nsweep: {c: [1]}\ncount: total\n"
    )
    asked(["sweep", "--along", "a", "--format", "csv"], tmp_path, record)
    (path,) = (tmp_path / "out").glob("*.csv")
    (row,) = csv.DictReader(path.read_text(encoding="utf-8").splitlines())
    assert (row["width_low"], row["width_high"], row["attainment"]) == ("2", "2", ATTAINED)
    assert row["proof"] == f"{APPROACHED} at b = 0{CRITICAL}; {ATTAINED} at b = 2{EDGE}"


def test_the_picture_says_it(tmp_path: Path) -> None:
    slice = SLICES["positive cubic"]
    record = f"system: {slice.system}\naxes: {{{slice.axes}}}\n"
    asked(
        ["range", "--along", "a", "--over", "b", "--rows", "1", "--format", "svg"], tmp_path, record
    )
    (path,) = (tmp_path / "out").glob("*.svg")
    assert "approached but not attained at b = 0" in path.read_text(encoding="utf-8")


def verdict(folder: Path, data: Any, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    path = folder / "altered.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    capsys.readouterr()
    status = run(["verify", str(path)])
    return status, capsys.readouterr().out


@pytest.mark.parametrize("name", DESIGNS)
@pytest.mark.slow_cases("approached", "where ranges meet", "on an interval")
def test_verify_checks_what_a_design_says_of_attainment(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The true document holds; with the other word, or without the exception, it is false."""
    data = designed(tmp_path, name)
    status, out = verdict(tmp_path, data, capsys)
    assert status == 0 and "FALSE" not in out
    (extreme,) = data["extremes"]
    before = extreme["text"]
    if extreme["except"]:
        extreme |= {"except": [], "attainment": ATTAINED, "text": before.partition(" except")[0]}
    else:
        other = ATTAINED if extreme["attainment"] == APPROACHED else APPROACHED
        extreme |= {"attainment": other, "text": before.replace(extreme["attainment"], other)}
    data["reason"] = data["reason"].replace(before, extreme["text"])
    status, out = verdict(tmp_path, data, capsys)
    assert status == 1 and "FALSE        extremes" in out


def test_verify_checks_it_at_irrational_values_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two solutions where a > c^2 - 2 with c = 2 b^2 - 1, and one where c is 0."""
    record = (
        'system: {unknowns: {x: real}, equations: ["x^2 - (2*b^2 - 1)^2*(a + 2 - (2*b^2 - 1)^2)"]}\n'
        "axes: {a: [-2, 2], b: [0, 1]}\ndesign: {maximise: range, along: a, over: {b: [0, 1]}, where: {stable: 2}}\n"
    )
    asked(["design", "--format", "json", "--evaluations", "5"], tmp_path, record)
    data = document(tmp_path)
    status, out = verdict(tmp_path, data, capsys)
    assert status == 0 and "FALSE" not in out
    (extreme,) = data["extremes"]
    before = extreme["text"]
    assert before == f"{APPROACHED} at b = 0.7071067812{CRITICAL}{ROOT_2}"
    extreme |= {"attainment": ATTAINED, "text": before.replace(APPROACHED, ATTAINED)}
    data["reason"] = data["reason"].replace(APPROACHED, ATTAINED)
    status, out = verdict(tmp_path, data, capsys)
    assert status == 1 and "FALSE        all of the extremes" in out


def test_words_that_are_not_those_of_the_numbers_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = designed(tmp_path, "approached")
    data["extremes"][0]["text"] = f"attained at b = 0{CRITICAL}"
    assert verdict(tmp_path, data, capsys)[0] == 2
    del data["extremes"]  # as older documents, which say nothing that could be wrong
    assert verdict(tmp_path, data, capsys)[0] == 0
