"""The JSON Schema of a record, made of the codecs that read it; ``ptmcad/record.schema.json`` is
written by it.

Guarantee: it has the keys, types and limits that are read, with what they mean for people; a new
key is written once.
"""

from __future__ import annotations

from typing import Any

from ptmcad.errors import Faults, Place
from ptmcad.model import ptm
from ptmcad.model.builtinmechanisms import MEANINGS
from ptmcad.model.mechanismrecord import mechanism_codec
from ptmcad.model.reading import DEFINITIONS, MAX_NAME, VALUE, Context
from ptmcad.model.systemrecord import system_codec
from ptmcad.question.config.designkey import DESIGN
from ptmcad.question.config.problemrecord import record_codec
from ptmcad.question.config.starters import mechanism_names
from ptmcad.question.config.sweeps import DEFINITIONS as OF_SWEEPS
from ptmcad.question.config.sweeps import SWEEP
from ptmcad.text.entry import Scalar, plain_data
from ptmcad.text.syntax import MAX_TEXT, NAME
from ptmcad.text.tree import FUNCTIONS

_LEAVES = {
    "name": {
        "type": "string",
        "pattern": f"^{NAME.pattern}$",
        "maxLength": MAX_NAME,
        "not": {"enum": [*FUNCTIONS, "pi"]},
    },
    "number": {
        "description": "An exact number: 2, 0.1, 1e-30, 3/4.",
        "anyOf": [
            {"type": "number"},
            {"type": "string", "pattern": "^[-+*/^() 0-9.eE]+$", "maxLength": MAX_TEXT},
        ],
    },
    "value": {
        "anyOf": [
            {"type": "number"},
            {"type": "string", "pattern": "^[-+*/^() \tA-Za-z0-9_.]+$", "maxLength": MAX_TEXT},
        ],
    },
}


def _of_ptm() -> dict[str, Any]:
    """Each parameter of the paper's mechanism."""
    return {
        name: {
            **VALUE,
            "description": MEANINGS[name],
            "default": plain_data(Scalar(parameter.default, Place())),
        }
        for name, parameter in ptm().parameters.items()
    }


def record_schema() -> dict[str, Any]:
    """The schema; a record about the paper's mechanism knows its parameters only."""
    read = record_codec(None).schema
    parameters, nothing = _of_ptm(), Context(Faults())
    whole = read["properties"]
    models = [
        {"enum": [*mechanism_names()]},
        {"type": "string", "pattern": "[.](yaml|yml|YAML|YML)$"},
        {"$ref": "#/$defs/mechanism"},
    ]
    own: dict[str, Any] = {
        "mechanism": {"anyOf": models},
        "system": {"$ref": "#/$defs/system"},
        "parameters": {"properties": parameters},
        "sweep": SWEEP,
        "design": DESIGN.schema,
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "urn:ptmcad:record",
        "title": "ptmcad problem record",
        "description": "A two-parameter slice of a planar mechanism or of another parametric system. Numbers are "
        "exact: 0.1 is 1/10.",
        **read,
        "required": ["axes"],
        "properties": {name: {**said, **own.get(name, {})} for name, said in whole.items()},
        "not": {"required": ["mechanism", "system"]},
        "dependentRequired": {"members": ["free"]},
        "if": {"$ref": "#/$defs/ptm"},
        "then": {"$ref": "#/$defs/ptm-parameters"},
        "$defs": {
            "ptm": {
                "description": "A record about the mechanism ptm.",
                "properties": {"mechanism": {"const": ptm().name}},
                "not": {"required": ["system"]},
            },
            "ptm-parameters": {
                "description": "Such a record knows no other parameters.",
                "properties": {"parameters": {"propertyNames": {"enum": [*parameters]}}},
            },
            "mechanism": {
                "description": "A planar mechanism: points as expressions, bars, springs and loads.",
                **mechanism_codec(nothing).schema,
            },
            "system": {
                "description": "As many equations as unknowns, or a potential whose critical points are meant.",
                **system_codec(nothing).schema,
            },
            **DEFINITIONS,
            **OF_SWEEPS,
            **_LEAVES,
        },
    }
