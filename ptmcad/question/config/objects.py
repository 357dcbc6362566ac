"""Mechanisms and systems from Python's objects: strings, numbers and SymPy expressions, in mappings as YAML has them.

Guarantee: SymPy is never imported; an object of it is taken as the text that it prints, with exact numbers as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.mechanism import Mechanism, Model, System, built_in
from ptmcad.question.config.model import model_of
from ptmcad.text.yamltree import Place, Tree, from_python


def make_mechanism(description: Mapping[Any, Any] | None = None, /, **entries: Any) -> Mechanism:
    """A planar mechanism from the entries of its description, as a record has them under ``mechanism:``.

    >>> pendulum = make_mechanism(
    ...     parameters={"W": {"kind": "force"}, "k": {"kind": "stiffness"}},
    ...     unknowns={"th": "angle"},
    ...     points={"O": [0, 0], "A": [0, 2], "P": ["sin(th)", "cos(th)"]},
    ...     bars=[["O", "P"]],
    ...     springs=[{"between": ["A", "P"], "k": "k"}],
    ...     loads={"P": ["1/10", "-W"]},
    ... )
    >>> pendulum.angles, pendulum.variables
    (('th',), ('W', 'k'))

    Parameters
    ----------
    description : a mapping with such entries; further ones may be added by name.

    Raises
    ------
    ConfigError
        With the key of what is wrong; its ``faults`` are all there are.
    """
    found = _model("mechanism", description, entries)
    assert isinstance(found, Mechanism)
    return found


def make_system(description: Mapping[Any, Any] | None = None, /, **entries: Any) -> System:
    """A parametric system from the entries of its description, as a record has them under ``system:``.

    >>> make_system(unknowns={"x": "real"}, equations=["x^3 - a*x + b"]).variables
    ('a', 'b')

    Takes entries, and raises, as `make_mechanism` does.
    """
    found = _model("system", description, entries)
    assert isinstance(found, System)
    return found


def plain(value: object) -> object:
    """A value as `ptmcad.text.yamltree.from_python` takes it: models as their descriptions, SymPy's objects as text."""
    if isinstance(value, Model):
        return value.name if value.name in built_in() else {"name": value.name, **value.source}
    if isinstance(value, Mapping):
        return {str(key) if _is_symbolic(key) else key: plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return str(value) if _is_symbolic(value) else value


def _is_symbolic(value: object) -> bool:
    """Whether it is an object of SymPy, which nobody has who has not imported it."""
    return type(value).__module__.partition(".")[0] == "sympy"


def _model(kind: str, description: Mapping[Any, Any] | None, entries: Mapping[str, Any]) -> Model:
    if description is not None and not isinstance(description, Mapping):
        raise ConfigError("expected a mapping, or the entries by name", key=kind)
    given = {**(description or {}), **entries}
    if kind == "mechanism" and {"equations", "potential"} & given.keys():
        raise ConfigError("equations or a potential describe a system: use ptmcad.System", key=kind)
    node = from_python({kind: plain(given)}, Place())
    assert isinstance(node, Tree)
    return model_of(node)
