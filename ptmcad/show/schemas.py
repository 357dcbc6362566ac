"""The JSON Schemas of all documents, made of the codecs that write and read them.

Guarantee: what is written is valid, and what is valid has the keys and types that are read. What
keys mean, for people, is written in the published files, docs/*.schema.json, and taken over from
there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.show.document import designdocument, mapdocument, posedocument
from ptmcad.show.ranges import rangedocument as ranges
from ptmcad.show.varietytext import FORMAT as VARIETY
from ptmcad.show.varietytext import variety_codec
from ptmcad.text.documents import Schema, document_schema

PROSE = ("$schema", "title", "description")


def schemas() -> dict[str, dict[str, Any]]:
    """The schema of each kind of document by the name of its published file, without prose."""
    made: dict[str, tuple[str, Schema]] = {
        "region-map": (mapdocument.FORMAT, mapdocument.schema()),
        "poses": (posedocument.FORMAT, posedocument.poses_codec(1).schema),
        "design": (designdocument.FORMAT, designdocument.design_codec("x").schema),
        "range": (ranges.FORMAT, ranges.schema()),
        "variety": (VARIETY, variety_codec(("x", "y")).schema),
    }
    return {name: document_schema(*parts) for name, parts in made.items()}


def with_prose(schema: Any, published: Any) -> Any:
    """A schema with what a published one says for people in the same places."""
    if isinstance(schema, list) and isinstance(published, list) and len(schema) == len(published):
        return [with_prose(*pair) for pair in zip(schema, published, strict=True)]
    if not isinstance(schema, Mapping) or not isinstance(published, Mapping):
        return schema
    said = {key: published[key] for key in PROSE if isinstance(published.get(key), str)}
    return said | {key: with_prose(value, published.get(key)) for key, value in schema.items()}
