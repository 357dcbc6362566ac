"""JSON documents as text, and their JSON Schemas.

Guarantee: a document of the same data is the same text, a key a line; a schema has what a class has
in several places defined once.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from typing import Any

Schema = Mapping[str, Any]
RATIONAL_SCHEMA = {"type": "string", "pattern": r"^-?[0-9]+(/[0-9]+|(\.[0-9]+)?(e-?[0-9]{1,6})?)$"}
CLASS = "$class"
"""Which class a schema is of, until it is complete."""


def document_text(format: str, data: Mapping[str, Any], further: tuple[str, ...] = ()) -> str:
    """A document as JSON text: a key a line, and of lists of objects each on a line, so that
    differences stay small.

    Parameters
    ----------
    further : lines of keys that are written already.
    """
    lines = [f'  "format": {json.dumps(format)}']
    for key, value in data.items():
        text = json.dumps(value, ensure_ascii=False)
        if isinstance(value, list) and value and isinstance(value[0], dict):
            items = ",\n".join("    " + json.dumps(item, ensure_ascii=False) for item in value)
            text = f"[\n{items}\n  ]"
        lines.append(f"  {json.dumps(key)}: {text}")
    return "{\n" + ",\n".join((*lines, *further)) + "\n}\n"


def document_schema(format: str, schema: Schema) -> dict[str, Any]:
    """The JSON Schema of a document, without its prose; what a class has in several places is
    defined apart.
    """
    forms: dict[str, list[Schema]] = {}
    for found in _of_classes(schema):
        forms.setdefault(found[CLASS], []).append(found)
    shared = {
        name
        for name, found in forms.items()
        if len(found) > 1 and all(form == found[0] for form in found)
    }
    whole = _without(schema, shared)
    definitions = {name: _without({**forms[name][0], CLASS: ""}, shared) for name in sorted(shared)}
    return {
        **whole,
        "properties": {"format": {"const": format}, **whole["properties"]},
        "required": ["format", *whole["required"]],
        "$defs": {"rational": RATIONAL_SCHEMA, **definitions},
    }


def _of_classes(schema: Any) -> Iterator[Schema]:
    """The parts of a schema that are those of classes."""
    if isinstance(schema, Mapping):
        if CLASS in schema:
            yield schema
        schema = schema.values()
    for part in schema if not isinstance(schema, str | int) else ():
        yield from _of_classes(part)


def _without(schema: Any, shared: Collection[str]) -> Any:
    """A schema with references in place of the classes that are defined apart."""
    if isinstance(schema, list):
        return [_without(part, shared) for part in schema]
    if not isinstance(schema, Mapping):
        return schema
    if (name := schema.get(CLASS)) in shared:
        return {"$ref": f"#/$defs/{name}"}
    return {key: _without(part, shared) for key, part in schema.items() if key != CLASS}
