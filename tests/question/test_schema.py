"""The published JSON Schemas agree with what reads records and results."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from support.shipped_records import EXACT

from ptmcad import RegionMap, classify, load
from ptmcad.errors import LimitReached
from ptmcad.mechanism import ptm
from ptmcad.question.config import RECORD_KEYS
from ptmcad.question.slice import Count
from ptmcad.show.document import FORMAT

SCHEMA = json.loads(files("ptmcad").joinpath("record.schema.json").read_text(encoding="utf-8"))
CONFIGS = sorted((Path(__file__).resolve().parents[2] / "configs").glob("*.yaml"))


def test_the_schema_is_valid() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_the_keys_are_those_of_config() -> None:
    properties = SCHEMA["properties"]
    assert tuple(properties) == RECORD_KEYS
    assert tuple(properties["parameters"]["properties"]) == tuple(ptm().parameters)
    assert properties["count"]["enum"] == [member.value for member in Count]
    defaults = {name: str(entry["default"]) for name, entry in properties["parameters"]["properties"].items()}
    assert defaults == {name: parameter.default for name, parameter in ptm().parameters.items()}


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_shipped_records_validate(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.startswith("# yaml-language-server: $schema=../ptmcad/record.schema.json\n")
    jsonschema.validate(yaml.safe_load(text), SCHEMA, cls=jsonschema.Draft202012Validator)


@pytest.mark.parametrize(
    "record",
    [
        {},
        {"axes": {"rho": [0, 2]}},
        {"axes": {"rho": [0, 2], "L2": [0]}},
        {"axes": {"rho": [0, 2], "L2": [0, 2]}, "parameters": {"F5": 1}},
        {"axes": {"rho": [0, 2], "L2": [0, 2]}, "parameters": {"F3": [1]}},
        {"axes": {"rho": [0, 2], "L2": [0, 2]}, "count": "all"},
        {"axes": {"rho": [0, 2], "L2": [0, 2]}, "name": "../x"},
        {"axes": {"rho": [0, 2], "L2": [0, 2]}, "more": 1},
    ],
    ids=str,
)
def test_wrong_records_do_not_validate(record: dict[str, Any]) -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(record, SCHEMA, cls=jsonschema.Draft202012Validator)


RESULT = json.loads(
    (Path(__file__).resolve().parents[2] / "docs" / "region-map.schema.json").read_text(encoding="utf-8")
)


def test_the_schema_of_results_is_valid_and_names_the_format() -> None:
    jsonschema.Draft202012Validator.check_schema(RESULT)
    assert RESULT["properties"]["format"]["const"] == FORMAT


@pytest.mark.parametrize("path", EXACT, ids=lambda path: path.stem)
def test_shipped_results_validate(path: Path, shipped: Callable[..., RegionMap]) -> None:
    jsonschema.validate(json.loads(shipped(path.stem).to_json()), RESULT, cls=jsonschema.Draft202012Validator)


def partial_map() -> RegionMap:
    with pytest.raises(LimitReached) as stopped:
        classify(load(EXACT[0]), progress=_stop_at("areas"))
    assert isinstance(stopped.value.partial, RegionMap)
    return stopped.value.partial


def _stop_at(name: str) -> Callable[[str, int, int], None]:
    def progress(stage: str, _done: int, _total: int) -> None:
        if stage == name:
            raise LimitReached("enough")

    return progress


def test_partial_results_validate() -> None:
    jsonschema.validate(json.loads(partial_map().to_json()), RESULT, cls=jsonschema.Draft202012Validator)


FREE_KEYS = {"axes", "parameters", "text", "reference", "versions", "precision", "timings", "sample"}


def objects(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], str]]:
    """Places of all entries of JSON objects whose keys are fixed: one in each list."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield path, key
            if key not in FREE_KEYS:
                yield from objects(value, (*path, key))
    elif isinstance(data, list) and data:
        yield from objects(data[0], (*path, 0))


def test_schema_and_reader_agree_on_the_keys(shipped: Callable[..., RegionMap]) -> None:
    """Each key of each record is required by both (but timings and savings), and no other one is allowed by either."""
    text = shipped("fig4").to_json()
    validator = jsonschema.Draft202012Validator(RESULT)
    for path, key in objects(json.loads(text)):
        for change in ("drop", "add"):
            data = json.loads(text)
            place = data
            for step in path:
                place = place[step]
            if change == "drop":
                del place[key]
            else:
                place["one more"] = 1
            if change == "drop" and ((path, key) == ((), "timings") or (path[:1], key) == (("plan",), "saving")):
                validator.validate(data)
                continue
            assert not validator.is_valid(data), (path, key, change)
            with pytest.raises(ValueError, match=r"lacks|unknown|format"):
                RegionMap.from_json(json.dumps(data))
