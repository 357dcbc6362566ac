"""False documents made from true ones: entries changed or left out, and lists with an entry less,
twice or turned.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

Place = tuple[str | int, ...]


def leaves(data: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Every entry of a JSON document with its place, objects and lists among them."""
    yield place, data
    if isinstance(data, dict | list):
        for key, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from leaves(value, (*place, key))


def changes(value: Any) -> Iterator[Any]:
    """What may stand in an entry's place."""
    if isinstance(value, bool):
        yield not value
    elif isinstance(value, int):
        yield value + 1
    elif isinstance(value, str):
        try:
            number = Fraction(value)
        except (ValueError, ZeroDivisionError):
            yield value + "x"
            return
        yield str(number + 1)
        yield str(number * (1 + Fraction(1, 10**9)) if number else Fraction(1, 10**9))
    elif value is None:
        yield 1
    elif isinstance(value, list) and value:
        yield value[1:]
        yield [*value, value[-1]]
        if value[::-1] != value:
            yield value[::-1]


def forged(data: Any) -> Iterator[tuple[Place, Any]]:
    """Documents that differ from a true one in one entry, with its place."""
    for place, value in leaves(data):
        for other in changes(value) if place else ():
            false = copy.deepcopy(data)
            node = false
            for key in place[:-1]:
                node = node[key]
            node[place[-1]] = other
            yield place, false
        if place and isinstance(place[-1], str):
            false = copy.deepcopy(data)
            node = false
            for key in place[:-1]:
                node = node[key]
            del node[place[-1]]
            yield place, false
