"""The codec of a model: a built-in mechanism by its name, any other one by its whole description.

Guarantee: reading what was written gives an equal model.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from ptmcad.errors import ConfigError
from ptmcad.mechanism import Model, built_in, described, described_system, known_of, recognised, without_loops
from ptmcad.question.slice import Slice
from ptmcad.show.document.codec import Codec, Key
from ptmcad.show.document.node import Node

if TYPE_CHECKING:
    from ptmcad.answer.poses import Poses

MAX_NAME = 100


def either(mechanism: Model | None, system: Model | None) -> Model:
    """The one that a document holds.

    Raises
    ------
    ValueError
        When it holds none, or both.
    """
    if mechanism is not None and system is not None:
        raise ValueError("it holds both a mechanism and a system")
    model = mechanism or system
    if model is None:
        raise ValueError("it lacks the key 'mechanism'")
    return model


def _as_it_is(value: Any) -> Any:
    return value


def _mechanism(node: Node) -> Model:
    """The built-in mechanism of a name, one of which nothing is known, or a description."""
    if isinstance(node.value, str):
        return known_of(node.line(MAX_NAME))
    return _described(node, lambda data: without_loops(recognised(described(data))))


def _described(node: Node, read: Callable[[Mapping[str, Any]], Model]) -> Model:
    try:
        return read(node.data())
    except ConfigError as error:
        raise node.fault(f"is wrong: {error}") from error


def _stored(holder: Slice | Poses, key: str) -> Any:
    """The model's name where that says all, else its description; None for a model of the other kind."""
    model = holder.model
    if model.record_key != key:
        return None
    return {"name": model.name, **model.source} if model.source and model.name not in built_in() else model.name


MODEL = {
    "mechanism": Key(Codec(_as_it_is, _mechanism), partial(_stored, key="mechanism"), None),
    "system": Key(Codec(_as_it_is, partial(_described, read=described_system)), partial(_stored, key="system"), None),
}
"""The keys of a record that holds a model: one of them is there."""
