"""The keys that a JSON document has, to be held against a schema and a reader."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator
from typing import Any, NamedTuple


class Changed(NamedTuple):
    """A document with a key of an object dropped, or one more than there should be."""

    path: tuple[Any, ...]
    key: str
    dropped: bool
    data: Any


def changed_keys(text: str, free: Collection[str]) -> Iterator[Changed]:
    """The document with each key changed that is fixed: of one object in each list, and not below
    the free keys.
    """
    for path, key in _entries(json.loads(text), free):
        for dropped in (True, False):
            place = data = json.loads(text)
            for step in path:
                place = place[step]
            if dropped:
                del place[key]
            else:
                place["one more"] = 1
            yield Changed(path, key, dropped, data)


def _entries(
    data: Any, free: Collection[str], path: tuple[Any, ...] = ()
) -> Iterator[tuple[tuple[Any, ...], str]]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield path, key
            if key not in free:
                yield from _entries(value, free, (*path, key))
    elif isinstance(data, list) and data:
        yield from _entries(data[0], free, (*path, 0))
