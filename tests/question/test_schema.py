"""The published JSON Schemas agree with what reads records and results."""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from importlib.resources import files
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from support.shipped_records import EXACT

from ptmcad import RegionMap, classify, load
from ptmcad.errors import LimitReached
from ptmcad.question.config import slice_from_mapping
from ptmcad.question.config.schema import record_schema
from ptmcad.question.config.starters import NAMES, starter_text
from ptmcad.show.document.mapdocument import FORMAT
from ptmcad.show.schemas import schemas, with_prose

SCHEMA = json.loads(files("ptmcad").joinpath("record.schema.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(
    SCHEMA
)  # `jsonschema.validate` would check the schema each time
CONFIGS = sorted((Path(__file__).resolve().parents[2] / "configs").glob("*.yaml"))


def test_the_schema_is_valid() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_the_published_schema_is_made_of_what_reads_records() -> None:
    """``scripts/schemas`` writes it anew."""
    assert record_schema() == SCHEMA


@pytest.mark.parametrize("name", NAMES)
def test_starters_validate(name: str) -> None:
    VALIDATOR.validate(yaml.safe_load(starter_text(name)))


MECHANISM = yaml.safe_load(starter_text("platform"))


def test_whatever_a_description_may_say_validates_and_is_read() -> None:
    record = deepcopy(MECHANISM)
    record["mechanism"] |= {
        "torsion": [
            {"angle": "phi - th", "k": 1, "rest": {"cos": "3/5", "sin": "4/5"}},
            {"angle": "th", "k": "k", "at": "P"},
        ],
        "moments": {"th": "W/2"},
        "symmetries": [{"W": "W", "th": "th"}],
    }
    record["mechanism"]["springs"][0]["free"] = "1/2"
    VALIDATOR.validate(record)
    slice_from_mapping(record)


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_shipped_records_validate(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.startswith("# yaml-language-server: $schema=../ptmcad/record.schema.json\n")
    VALIDATOR.validate(yaml.safe_load(text))


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
        VALIDATOR.validate(record)


DOCS = Path(__file__).resolve().parents[2] / "docs"
RESULT = json.loads((DOCS / "region-map.schema.json").read_text(encoding="utf-8"))


QUICK = ("fig2", "fig4", "forces", "rods")
"""Of the paper's mechanism, without loads and with them, and of others."""


def test_the_schema_of_results_is_valid_and_names_the_format() -> None:
    jsonschema.Draft202012Validator.check_schema(RESULT)
    assert RESULT["properties"]["format"]["const"] == FORMAT


@pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=() if p.stem in QUICK else pytest.mark.slow, id=p.stem) for p in EXACT],
)
def test_shipped_results_validate(path: Path, shipped: Callable[..., RegionMap]) -> None:
    jsonschema.validate(
        json.loads(shipped(path.stem).to_json()), RESULT, cls=jsonschema.Draft202012Validator
    )


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
    jsonschema.validate(
        json.loads(partial_map().to_json()), RESULT, cls=jsonschema.Draft202012Validator
    )


def test_one_is_not_true_to_either(shipped: Callable[..., RegionMap]) -> None:
    data = json.loads(shipped("fig2").to_json())
    data["components"][0]["separates"] = 1
    assert not jsonschema.Draft202012Validator(RESULT).is_valid(data)
    with pytest.raises(ValueError, match="is not true or false"):
        RegionMap.from_json(json.dumps(data))


@pytest.mark.parametrize("name", ["region-map", "poses", "design", "range", "variety"])
def test_published_schemas_are_those_of_the_codecs(name: str) -> None:
    """``scripts/schemas`` writes them anew."""
    published = json.loads((DOCS / f"{name}.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(published)
    assert with_prose(schemas()[name], published) == published


EARLIER = Path(__file__).resolve().parents[1] / "data" / "written-by-0.1.0"


@pytest.mark.parametrize("path", sorted(EARLIER.rglob("*.json")), ids=lambda path: path.stem)
def test_earlier_documents_validate(path: Path) -> None:
    document = json.loads(path.read_text(encoding="utf-8"))
    kind = document["format"].removeprefix("ptmcad-").partition("/")[0]
    if kind in schemas():
        jsonschema.Draft202012Validator(schemas()[kind]).validate(document)
