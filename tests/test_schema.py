"""The published JSON Schema and `config` agree."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from ptmcad.config import PARAMETERS, RECORD_KEYS
from ptmcad.slice import Count

SCHEMA = json.loads(files("ptmcad").joinpath("record.schema.json").read_text(encoding="utf-8"))
CONFIGS = sorted((Path(__file__).parent.parent / "configs").glob("*.yaml"))


def test_the_schema_is_valid() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_the_keys_are_those_of_config() -> None:
    properties = SCHEMA["properties"]
    assert tuple(properties) == RECORD_KEYS
    assert tuple(properties["parameters"]["properties"]) == tuple(PARAMETERS)
    assert properties["count"]["enum"] == [member.value for member in Count]
    defaults = {name: str(entry["default"]) for name, entry in properties["parameters"]["properties"].items()}
    assert defaults == {name: parameter.default for name, parameter in PARAMETERS.items()}


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
