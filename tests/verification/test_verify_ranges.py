"""Documents of lines and rows in which something is missing, doubled or of another line are refused.

Each says that another version made it, so that nothing is answered anew.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ptmcad.cli import run

CUBIC = 'name: cubic\nsystem: {unknowns: {x: real}, equations: ["x^3 - a*x + b"]}\naxes: {a: [-2, 2], b: [-2, 2]}\n'
BESIDE = (
    "name: beside\nsystem:\n  unknowns: {s: angle, t: angle}\n"
    '  equations: ["sin(2*s) - 1 + b*(a - 1/16)", "sin(t)*(4*(a - 1/16)*cos(t) + 1)"]\n'
    "axes: {a: [-1/8, 1/8], b: [1/2, 2]}\n"
)
"""At a = 1/16 two folds of s meet with two solutions t that leave every bounded set."""
BAR = (
    "name: bar\nmechanism:\n  parameters: {f: {kind: free length}, M: {kind: force}}\n"
    "  unknowns: {th: angle}\n  points: {O: [0, 0], A: [0, 2], P: [cos(th), sin(th)]}\n"
    "  bars: [[O, P]]\n  supports: {O: pin, A: pin}\n"
    "  springs: [{between: [A, P], k: 1, free: f}]\n  moments: {th: M}\n"
    "axes: {f: [3/2, 2], M: [-1/2, 1/2]}\n"
)
ASKED = {
    "line": (CUBIC, ["--along", "a", "--at", "b=1/4"]),
    "over": (CUBIC, ["--along", "a", "--over", "b", "--rows", "4"]),
    "beside": (BESIDE, ["--along", "a", "--at", "b=1"]),
    "enclosed": (BAR, ["--along", "M", "--at", "f=7/4"]),
}


@pytest.fixture(scope="module")
def documents(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Any]:
    folder = tmp_path_factory.mktemp("ranges")

    def document(kind: str) -> Any:
        path = folder / f"{kind}.json"
        if not path.exists():
            text, options = ASKED[kind]
            (folder / "record.yaml").write_text(text, encoding="utf-8")
            command = ["range", str(folder / "record.yaml"), *options, "--format", "json"]
            assert run([*command, "--out", str(folder), "--name", kind]) == 0
        return json.loads(path.read_text(encoding="utf-8"))

    return document


@pytest.fixture(autouse=True)
def engine(request: pytest.FixtureRequest) -> None:
    if request.node.callspec.params["kind"] == "enclosed":
        pytest.importorskip("numba")


def verified(data: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    path = tmp_path / "given.json"
    path.write_text(json.dumps(data | {"versions": {"ptmcad": "0.1.9"}}), encoding="utf-8")
    capsys.readouterr()
    return run(["verify", str(path), "--seed", "1"]), capsys.readouterr().err


@pytest.mark.parametrize("kind", ASKED)
def test_true_documents_hold(
    kind: str,
    documents: Callable[[str], Any],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert verified(documents(kind), tmp_path, capsys) == (0, "")


def no_ranges(data: Any) -> None:
    for row in data["over"]["rows"]:
        row["operation"] = []


def no_ranges_of_seven(data: Any) -> None:
    no_ranges(data)
    data["over"] |= {"stable": 7, "maxima": []}


def ranges_of_one(data: Any) -> None:
    no_ranges(data)
    data["over"] |= {"stable": 1, "maxima": []}


def no_maxima(data: Any) -> None:
    data["over"]["maxima"] = []


def a_shorter_maximum(data: Any) -> None:
    """Ranges are as long as is said on the rows, and longer between two of them."""
    (found,) = data["over"]["maxima"]
    found |= {
        "place": "edge",
        "at": {"decimal": "0.4", "enclosure": ["2/5", "2/5"]},
        "width": {"decimal": "1", "enclosure": ["487/500", "39/40"]},
        "critical": None,
        "ends": None,
        "text": "attained at b = 0.4, the edge of the window",
    }


def a_row_less(data: Any) -> None:
    del data["over"]["rows"][1]


def a_point_more(data: Any) -> None:
    first, last = data["line"]["intervals"]
    data["line"]["intervals"] = [
        first,
        last | {"high": last["low"], "total": 99, "stable": 98},
        last,
    ]


def overlapping(data: Any) -> None:
    first, last = data["line"]["intervals"]
    data["line"]["intervals"] = [first, last | {"low": first["low"], "high": first["low"]}, last]


def turned(data: Any) -> None:
    data["line"]["intervals"].reverse()


def a_short_one(data: Any) -> None:
    """An interval ends at the edge, which it does not reach."""
    data["line"]["intervals"][1]["low"] = {"window": "2", "decimal": "2"}


def halves(data: Any) -> None:
    """Nothing changes where the first interval is cut: a parameter alone is zero."""
    zero = {"polynomial": ["0", "1"], "low": "0", "high": "0", "decimal": "0"}
    first, last = data["line"]["intervals"]
    data["line"]["intervals"] = [
        first | {"high": zero, "sample": "-1"},
        first | {"low": zero, "sample": "1/2"},
        last,
    ]


def another_sample(data: Any) -> None:
    data["line"]["intervals"][0]["sample"] = "1"


def inverted(data: Any) -> None:
    """Between the ends, the greater one first, are both roots; at neither of them the counts are
    other than at 0."""
    end = {"polynomial": ["0", "-3", "4"], "low": "4/5", "high": "0", "decimal": "0"}
    first, last = data["line"]["intervals"]
    first["high"] = last["low"] = end


def of_two_roots(data: Any) -> None:
    first, last = data["line"]["intervals"]
    end = {"polynomial": ["0", "-3", "4"], "low": "1/2", "high": "4/5", "decimal": "0.75"}
    first["high"] = last["low"] = end


def along_nothing(data: Any) -> None:
    whole = data["line"]["intervals"][0]["low"], data["line"]["intervals"][1]["high"]
    data["line"]["along"]["name"] = "zzz"
    data["line"]["intervals"] = [
        data["line"]["intervals"][0] | {"low": whole[0], "high": whole[1]},
    ]


def along_a_part(data: Any) -> None:
    data["line"]["along"]["window"] = ["-2", "0"]
    edge = {"window": "0", "decimal": "0"}
    data["line"]["intervals"] = [data["line"]["intervals"][0] | {"high": edge, "sample": "-1"}]


def at_another_value(data: Any) -> None:
    data["line"]["at"] = {"b": "-1/4"}


def at_another_name(data: Any) -> None:
    data["line"]["at"] = {"c": "1/4"}


def no_line(data: Any) -> None:
    del data["line"]


def one_interval_where_two_meet(data: Any) -> None:
    first, last = data["line"]["intervals"]
    data["line"]["intervals"] = [last | {"low": first["low"], "sample": "0"}]


def no_change(data: Any) -> None:
    data["line"]["changes"] = []


def a_change_of_four(data: Any) -> None:
    data["line"]["changes"][0]["after"]["total"] = 5


def a_change_at_another_place(data: Any) -> None:
    data["line"]["changes"][0]["at"] = {
        "polynomial": ["-1", "2"],
        "low": "1/2",
        "high": "1/2",
        "decimal": "0.5",
    }


def nothing_enclosed(data: Any) -> None:
    data["enclosed"]["intervals"] = []


def an_enclosed_one_less(data: Any) -> None:
    del data["enclosed"]["intervals"][1]


def enclosed_ones_turned(data: Any) -> None:
    data["enclosed"]["intervals"].reverse()


def an_enclosed_one_twice(data: Any) -> None:
    data["enclosed"]["intervals"].append(data["enclosed"]["intervals"][-1])


def an_enclosed_one_shorter(data: Any) -> None:
    middle = {"low": "1/100", "high": "1/100", "decimal": "0.01"}
    data["enclosed"]["intervals"][1]["high"] = middle


def an_enclosed_one_backwards(data: Any) -> None:
    middle = data["enclosed"]["intervals"][1]
    middle["low"], middle["high"] = middle["high"], middle["low"]


def enclosed_by_nothing(data: Any) -> None:
    end = data["enclosed"]["changes"][0]["at"]
    end["low"], end["high"] = end["high"], end["low"]


@pytest.mark.parametrize(
    ("kind", "forge", "words"),
    [
        ("over", no_ranges, "0 of the intervals are at"),
        ("over", no_ranges_of_seven, "no range with 7 solutions"),
        ("over", ranges_of_one, "of the intervals are at"),
        ("over", no_maxima, "a longer range than"),
        ("over", a_shorter_maximum, "there is a longer range than is said"),
        ("over", a_row_less, "rows are not at 4 equal distances"),
        ("line", a_point_more, "2 intervals of equal counts, not 3"),
        ("line", overlapping, "2 intervals of equal counts, not 3"),
        ("line", turned, "the intervals are not in their order"),
        ("line", a_short_one, "0 of the intervals are at"),
        ("line", halves, "counts cannot change at"),
        ("line", another_sample, "is not in its interval"),
        ("line", inverted, "from 4/5 to 0"),
        ("line", of_two_roots, "is not irreducible"),
        ("line", along_nothing, "is not the axis a in [-2, 2]"),
        ("line", along_a_part, "is not the axis a in [-2, 2]"),
        ("line", at_another_value, "at another value than was asked for"),
        ("line", at_another_name, "at another value than was asked for"),
        ("line", no_line, "there is no answer enclosed or line"),
        ("line", no_change, "a change is missing"),
        ("line", a_change_of_four, "counts do not change as is said"),
        ("line", a_change_at_another_place, "counts cannot change near 0.5"),
        ("beside", one_interval_where_two_meet, "where there are 0 solutions"),
        ("enclosed", nothing_enclosed, "nothing is said of M next to -0.5"),
        ("enclosed", an_enclosed_one_less, "nothing is said of M next to -0.418"),
        ("enclosed", enclosed_ones_turned, "overlap, or are not in their order"),
        ("enclosed", an_enclosed_one_twice, "overlap, or are not in their order"),
        ("enclosed", an_enclosed_one_shorter, "ends where nothing changes"),
        ("enclosed", an_enclosed_one_backwards, "not in their order"),
        ("enclosed", enclosed_by_nothing, "an end is said to be from"),
    ],
)
def test_a_false_document_is_refused(
    kind: str,
    forge: Callable[[Any], None],
    words: str,
    documents: Callable[[str], Any],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    data = documents(kind)
    forge(data)
    status, told = verified(data, tmp_path, capsys)
    assert status == 1
    assert words in told
