"""A JSON Schema as a page of tables: one table for each object, with keys, types and descriptions.

Guarantee: every key that the schema names is in a table; a keyword that this module does not know
is an error, so that nothing is left out silently.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

Schema = Mapping[str, Any]
_KNOWN = frozenset(
    [
        "$schema",
        "$id",
        "title",
        "description",
        "type",
        "properties",
        "additionalProperties",
        "required",
        "items",
        "$ref",
        "$defs",
        "enum",
        "const",
        "default",
        "pattern",
        "maxLength",
        "minLength",
        "minimum",
        "maximum",
        "exclusiveMinimum",
        "minItems",
        "maxItems",
        "minProperties",
        "maxProperties",
        "propertyNames",
        "anyOf",
        "oneOf",
        "prefixItems",
        # what excludes, or asks of one case only: the descriptions say it in words
        "not",
        "if",
        "then",
        "dependentRequired",
    ]
)


def page(title: str, file: str, schema: Schema) -> str:
    """The page as Markdown.

    Raises
    ------
    ValueError
        For a keyword that the tables could not show.
    """
    lines = [
        f"# {title}",
        "",
        str(schema.get("description", "")),
        "",
        f"The schema itself: [{file}]({file}).",
        "",
    ]
    lines += _object("", "The whole", schema)
    for name, definition in schema.get("$defs", {}).items():
        lines += [f"## {name}", "", *_definition(definition)]
    return "\n".join(lines).rstrip() + "\n"


def _definition(schema: Schema) -> Iterator[str]:
    if "properties" in schema:
        yield from _table(schema)
        yield from _inner(schema, "")
    else:
        yield f"{_type(schema)}{_dash(schema)}"
        yield ""


def _object(path: str, heading: str, schema: Schema) -> Iterator[str]:
    """The table of an object and, after it, those of the objects inside."""
    yield f"## {heading}"
    yield ""
    yield from _table(schema)
    yield from _inner(schema, path)


def _inner(schema: Schema, path: str) -> Iterator[str]:
    for key, value in schema.get("properties", {}).items():
        yield from _below(f"{path}.{key}" if path else key, value)


def _below(place: str, schema: Schema) -> Iterator[str]:
    """The objects in a value: in the entries of a list or mapping, or in one of several shapes that
    it may have.
    """
    if "properties" in schema:
        yield from _object(place, f"`{place}`", schema)
        return
    for keyword, end in (("items", "[]"), ("additionalProperties", ".*")):
        if isinstance(schema.get(keyword), Mapping):
            yield from _below(place + end, schema[keyword])
    for part in (*schema.get("anyOf", ()), *schema.get("oneOf", ())):
        yield from _below(place, part)


def _table(schema: Schema) -> Iterator[str]:
    _check(schema)
    required = set(schema.get("required", ()))
    yield "| key | value | meaning |"
    yield "|---|---|---|"
    for key, value in schema.get("properties", {}).items():
        must = "" if key in required else " (optional)" if required else ""
        yield f"| `{key}`{must} | {_cell(_type(value))} | {_cell(_meaning(value))} |"
    yield ""


def _meaning(schema: Schema) -> str:
    text = str(schema.get("description", ""))
    if "default" in schema:
        text += f" Default: `{schema['default']}`."
    return text.strip()


def _type(schema: Schema) -> str:
    """What values a schema allows, in words."""
    _check(schema)
    if "$ref" in schema:
        name = str(schema["$ref"]).rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "const" in schema:
        return f"`{schema['const']}`"
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    for keyword in ("anyOf", "oneOf"):
        if keyword in schema:
            return " or ".join(_type(part) for part in schema[keyword])
    kinds = schema.get("type", "any")
    text = (" or ".join(kinds) if isinstance(kinds, list) else str(kinds)) + _bounds(schema)
    if "array" in kinds:
        text += _items(schema)
    if (
        "object" in kinds
        and isinstance(schema.get("additionalProperties"), Mapping)
        and "properties" not in schema
    ):
        text += f", each value {_type(schema['additionalProperties'])}"
    return text


def _items(schema: Schema) -> str:
    if "prefixItems" in schema:
        return " of " + ", ".join(_type(part) for part in schema["prefixItems"])
    return f" of {_type(schema['items'])}" if isinstance(schema.get("items"), Mapping) else ""


_LIMITS = {
    "minimum": "from {}",
    "exclusiveMinimum": "above {}",
    "maximum": "to {}",
    "maxLength": "up to {} characters",
    "pattern": "of the form `{}`",
}


def _bounds(schema: Schema) -> str:
    low = schema.get("minItems", schema.get("minProperties"))
    high = schema.get("maxItems", schema.get("maxProperties"))
    notes = []
    if low is not None:
        notes.append(f"{low} entries" if low == high else f"at least {low}")
    notes += [
        words.format(schema[keyword]) for keyword, words in _LIMITS.items() if keyword in schema
    ]
    return f" ({', '.join(notes)})" if notes else ""


def _dash(schema: Schema) -> str:
    return f" - {_meaning(schema)}" if _meaning(schema) else ""


def _cell(text: str) -> str:
    """Text in a table's cell: no line breaks, and no bar that would end the cell."""
    return " ".join(text.split()).replace("|", r"\|")


def _check(schema: Schema) -> None:
    unknown = set(schema) - _KNOWN
    if unknown:
        raise ValueError(f"the tables cannot show {', '.join(sorted(unknown))}")
