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
_LIMITS = {
    "minimum": "from {}",
    "exclusiveMinimum": "above {}",
    "maximum": "to {}",
    "maxLength": "up to {} characters",
    "pattern": "of the form `{}`",
}


def page(title: str, file: str, schema: Schema) -> str:
    """The page as Markdown.

    Raises
    ------
    ValueError
        For a keyword that the tables could not show.
    """
    blocks = [f"# {title}", _meaning(schema), f"The schema itself: [{file}]({file})."]
    for name, part in {"The whole": schema, **schema.get("$defs", {})}.items():
        blocks.append(f"## {name}")
        if "properties" not in part:
            blocks.append(" - ".join(filter(None, (_type(part), _meaning(part)))))
        for place, own in _objects("", part):
            blocks += [f"## `{place[1:]}`"] * bool(place) + [_table(own)]
    return "\n\n".join(blocks) + "\n"


def _objects(place: str, schema: Schema) -> Iterator[tuple[str, Schema]]:
    """The objects in a value with their places: it may be one, and they may be in the entries of a
    list or mapping, or in one of several shapes that it may have.
    """
    if "properties" in schema:
        yield place, schema
    parts = {f"{place}.{key}": [part] for key, part in schema.get("properties", {}).items()}
    parts |= {
        f"{place}[]": [schema.get("items")],
        f"{place}.*": [schema.get("additionalProperties")],
    }
    parts[place] = [*schema.get("anyOf", ()), *schema.get("oneOf", ())]
    for at, shapes in parts.items():
        for shape in shapes:
            if isinstance(shape, Mapping):
                yield from _objects(at, shape)


def _table(schema: Schema) -> str:
    _check(schema)
    required = schema.get("required", ())
    lines = ["| key | value | meaning |", "|---|---|---|"]
    for key, value in schema["properties"].items():
        must = "" if key in required or not required else " (optional)"
        cells = (
            " ".join(text.split()).replace("|", r"\|") for text in (_type(value), _meaning(value))
        )
        lines.append(f"| `{key}`{must} | {' | '.join(cells)} |")
    return "\n".join(lines)


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
    if shapes := schema.get("anyOf", schema.get("oneOf")):
        return " or ".join(map(_type, shapes))
    kinds = schema.get("type", "any")
    text = kinds if isinstance(kinds, str) else " or ".join(kinds)
    low, high = (
        schema.get(f"{end}Items", schema.get(f"{end}Properties")) for end in ("min", "max")
    )
    notes = [
        words.format(schema[keyword]) for keyword, words in _LIMITS.items() if keyword in schema
    ]
    if low is not None:
        notes.insert(0, f"{low} entries" if low == high else f"at least {low}")
    if notes:
        text += f" ({', '.join(notes)})"
    parts = [p for p in schema.get("prefixItems", [schema.get("items")]) if isinstance(p, Mapping)]
    if parts:
        text += f" of {', '.join(map(_type, parts))}"
    if isinstance(schema.get("additionalProperties"), Mapping) and "properties" not in schema:
        text += f", each value {_type(schema['additionalProperties'])}"
    return text


def _check(schema: Schema) -> None:
    unknown = set(schema) - _KNOWN
    if unknown:
        raise ValueError(f"the tables cannot show {', '.join(sorted(unknown))}")
