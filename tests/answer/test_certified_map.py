"""Certified maps as documents, tables and answers to points: on a map made by hand, without the
engine.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.certified_map import certified_map, free_slice
from support.replacing import replace

import ptmcad
from ptmcad.answer.regionmap import Location, RegionMap, Status
from ptmcad.cli import run
from ptmcad.cover.connectivity import union_area
from ptmcad.cover.rectangles import Cover
from ptmcad.errors import ConfigError
from ptmcad.exact.exactmap import exact_map
from ptmcad.exact.ranges.rangestrips import strips
from ptmcad.question.slice import Count, Slice

SCHEMA = json.loads(
    (Path(__file__).resolve().parents[2] / "docs" / "region-map.schema.json").read_text(
        encoding="utf-8"
    )
)


# ----------------------------------------------------------------------------------------------------- the document


@pytest.mark.parametrize("count", Count)
@pytest.mark.parametrize("status", [Status.CERTIFIED, Status.PARTIAL])
@pytest.mark.fast_cases("Status.PARTIAL-Count.TOTAL", "Status.PARTIAL-Count.INDEX")
def test_a_certified_map_comes_back_from_its_document(count: Count, status: Status) -> None:
    result = certified_map(count, status)
    text = result.to_json()
    assert RegionMap.from_json(text) == result
    assert RegionMap.from_json(text).to_json() == text
    jsonschema.validate(json.loads(text), SCHEMA, cls=jsonschema.Draft202012Validator)


def test_rectangles_take_a_line_each() -> None:
    lines = certified_map().to_json().splitlines()
    start = lines.index('  "cover": {"steps": 16, "rectangles": [')
    assert lines[start + 1 : start + 5] == ["0,16,7,8,", "10,11,0,16,", "10,11,3,5", "]}"]


def test_an_exact_map_has_no_word_of_it() -> None:
    result = ptmcad.classify(
        ptmcad.slice_from_options(slice="L2,rho", ranges=["L2=1:2", "rho=0:1/2"])
    )
    text = result.to_json()
    assert "cover" not in json.loads(text)
    assert "admissible" not in text
    assert "l0" not in text


@given(
    st.lists(
        st.tuples(*[st.integers(0, 15)] * 4).map(
            lambda q: (min(q[:2]), max(q[:2]) + 1, min(q[2:]), max(q[2:]) + 1)
        ),
        unique=True,
        max_size=20,
    )
)
def test_every_cover_comes_back(rectangles: list[tuple[int, int, int, int]]) -> None:
    result = replace(certified_map(), cover=Cover(16, tuple(sorted(rectangles))))
    assert RegionMap.from_json(result.to_json()) == result


def _put(data: dict[str, Any], path: str, value: Any) -> None:
    *keys, last = path.split(".")
    for key in keys:
        data = data[int(key) if key.isdigit() else key]  # type: ignore[call-overload]
    data[int(last) if last.isdigit() else last] = value  # type: ignore[call-overload]


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("cover.steps", 24, "cover.steps is not a power of two"),
        ("cover.steps", 2**41, "cover.steps is not a power of two"),
        ("cover.steps", True, "cover.steps is not a power of two"),
        ("cover.steps", 8, "a rectangle, number 0, that does not lie in the window"),
        ("cover.rectangles", [0, 1, 0], "four for each rectangle"),
        ("cover.rectangles", [0, 1, 0, 1.0], "is not a list of integers"),
        ("cover.rectangles", [0, 1, 0, True], "is not a list of integers"),
        ("cover.rectangles", "0,1,0,1", "is not a list of integers"),
        (
            "cover.rectangles",
            [0, 1, 0, 1, 0, 1, 0, 1],
            "not of distinct rectangles: see numbers 0 and 1",
        ),
        ("cover.rectangles", [1, 2, 0, 1, 0, 1, 0, 1], "is not sorted"),
        ("cover.rectangles", [0, 1, 0, 1, 3, 3, 0, 1], "number 1, that does not lie in the window"),
        ("cover.rectangles", [0, 1, -1, 1], "number 0, that does not lie in the window"),
        ("cover.more", 1, "cover has the unknown key 'more'"),
        ("status", "exact", "status is not that of a map with a cover"),
        ("cells.0.stack", 0, "cells[0].stack is not null"),
        ("cells.1.admissible", -1, "cells[1].admissible is not between"),
        ("stacks", [{}], "stacks is not empty"),
        ("undetermined", "9/8", "undetermined is more than the whole window"),
    ],
)
def test_damage_is_refused_with_its_place(path: str, value: Any, message: str) -> None:
    data = json.loads(certified_map().to_json())
    _put(data, path, value)
    with pytest.raises(ValueError, match=r".") as caught:
        RegionMap.from_json(json.dumps(data))
    assert message in str(caught.value)


@pytest.mark.parametrize(("change", "value"), [("status", "certified"), ("count", "admissible")])
def test_a_certified_map_without_its_cover_is_refused(change: str, value: str) -> None:
    data = json.loads(certified_map(status=Status.PARTIAL).to_json())
    del data["cover"]
    if change == "status":
        data["status"] = value
    else:
        data["slice"]["count"] = value
    with pytest.raises(ValueError, match="lacks the key 'cover'"):
        RegionMap.from_json(json.dumps(data))


# ------------------------------------------------------------------------------------------------- points and tables


@pytest.mark.parametrize(
    ("rho", "height", "cell"),
    [
        ("1/2", "3/2", 1),
        ("1/2", "2.000001", 0),
        ("3/2", "3/2", 2),
        ("7/5", "3/2", 2),
        ("3/2", "5/2", None),  # the quarter whose counts were not decided
        ("1/2", "15/8", None),  # on a rectangle's edge, which belongs to it
        ("5/4", "3/2", None),
        ("1.249999999999999999999999999", "3/2", 1),
        ("1/2", "1.874999999999999999999999999", 1),
    ],
)
def test_points_are_told_exactly_or_left_undecided(rho: str, height: str, cell: int | None) -> None:
    result = certified_map()
    found = result.locate(rho=rho, L2=height)
    if cell is None:
        assert found == Location(Status.UNDECIDED)
        return
    c = result.cells[cell]
    assert found == Location(
        Status.CERTIFIED, c.region, cell, c.total, c.stable, c.index, c.further
    )


def test_a_stopped_map_answers_too() -> None:
    assert certified_map(status=Status.PARTIAL).locate(rho=1, L2="2.1").status is Status.CERTIFIED


def test_two_samples_in_one_component_contradict_each_other() -> None:
    result = replace(certified_map(), cover=Cover(16, ()))
    with pytest.raises(ConfigError, match="the map contradicts itself: the sample of cell 1"):
        result.locate(rho=1, L2=2)


def test_the_table_tells_what_is_open() -> None:
    result = certified_map()
    assert result.undetermined == Fraction(union_area(result.cover) + 40, 256)  # type: ignore[arg-type]
    assert result.table().splitlines() == [
        "regions   3 of 3 cells, certified",
        "counts    1 stable: 1 region; 2 stable: 2 regions",
        "areas     1: 1.093 to 1.579; 2: 1.796 to 2.766",
        "cover     3 rectangles around the curves where counts change",
        "time      1.50 s; 28 % undetermined; area bounds at most 9.7e-01 apart",
    ]
    admissible = certified_map(Count.ADMISSIBLE).table()
    assert "1 stable and admissible: 2 regions; 2 stable and admissible: 1 region" in admissible


# --------------------------------------------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("options", "key", "part"),
    [
        (
            {"engine": "exact"},
            "engine",
            "an exact map is not computed for springs with a free length",
        ),
        ({"engine": "certifed"}, "engine", "did you mean 'certified'?"),
        ({"tolerance": 0}, "tolerance", "0 is not between 0 and 1"),
        ({"tolerance": "x"}, "tolerance", "unknown name 'x'"),
        ({"tolerance": float("nan")}, "tolerance", "is not a number"),
        ({"area_tolerance": "1e-3"}, "area_tolerance", "give tolerance instead"),
        ({"without": frozenset(("axis-order",))}, "without", "a saving of the exact engine"),
        ({"count": "most"}, "count", "most"),
    ],
    ids=str,
)
def test_options_that_do_not_fit_are_refused(options: dict[str, Any], key: str, part: str) -> None:
    with pytest.raises(ConfigError) as caught:
        ptmcad.classify(free_slice(), **options)
    assert caught.value.key == key
    assert part in caught.value.message


@pytest.mark.parametrize("engine", ["auto", "exact", "certified"])
def test_admissible_asks_for_free_lengths(engine: str) -> None:
    slice = ptmcad.slice_from_options(slice="L2,rho")
    with pytest.raises(ConfigError, match="choose stable"):
        ptmcad.classify(slice, engine=engine, count="admissible")


@pytest.mark.parametrize(
    ("earlier", "part"),
    [
        (replace(certified_map(), cover=None), "this is no certified map"),
        (certified_map(Count.TOTAL), "count differs"),
        (
            replace(certified_map(), slice=ptmcad.slice_from_options(slice="rho,L2")),
            "axes, F3, F4, l0_1, l0_2, l0_3 differ",
        ),
    ],
    ids=["exact", "count", "slice"],
)
def test_only_a_certified_map_of_the_same_slice_can_be_gone_on_from(
    earlier: RegionMap, part: str
) -> None:
    with pytest.raises(ConfigError) as caught:
        ptmcad.classify(free_slice(), resume=earlier)
    assert caught.value.key == "resume"
    assert part in caught.value.message


def test_the_exact_engine_does_not_resume() -> None:
    with pytest.raises(ConfigError, match="only the certified engine"):
        ptmcad.classify(ptmcad.slice_from_options(slice="L2,rho"), resume=certified_map())


def test_what_algebra_alone_answers_is_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It would leave the free lengths out, and answer for another mechanism."""
    monkeypatch.chdir(tmp_path)
    assert run(["variety", "--slice", "rho,L2", "--set", "l0=1/5", "--range", "rho=0:2"]) == 2
    message = capsys.readouterr().err
    assert message.startswith(
        "error: the discriminant variety is not computed for springs with a free length"
    )
    assert message.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "ask",
    [
        exact_map,
        ptmcad.slice_variety,
        lambda slice: strips(slice, "rho"),
    ],
    ids=["exact map", "variety", "strips"],
)
def test_no_function_of_the_exact_engine_leaves_free_lengths_out(
    ask: Callable[[Slice], object],
) -> None:
    with pytest.raises(ConfigError, match="not computed for springs with a free length"):
        ask(free_slice())


def test_a_line_on_which_the_free_lengths_are_zero_is_answered() -> None:
    """F3 = F4 = -10, L1 = L2 = 1, l0 = 0: a line of fig. 4."""
    free = ptmcad.intervals(
        ptmcad.slice_from_options(slice="rho,l0", sets=["F3=-10", "F4=-10"]), "rho", {"l0": 0}
    )
    fig4 = ptmcad.intervals(
        ptmcad.slice_from_options(slice="rho,L2", sets=["F3=-10", "F4=-10"]), "rho", {"L2": 1}
    )
    assert free.intervals == fig4.intervals
