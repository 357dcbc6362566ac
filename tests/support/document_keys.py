"""The keys that a JSON document has, to be held against a schema and a reader."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any


def entries(data: Any, free: Collection[str], path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], str]]:
    """Places of all entries of JSON objects whose keys are fixed: one in each list, none below the free keys."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield path, key
            if key not in free:
                yield from entries(value, free, (*path, key))
    elif isinstance(data, list) and data:
        yield from entries(data[0], free, (*path, 0))
