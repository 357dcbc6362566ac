"""Mechanisms and systems from Python's objects: strings, numbers and SymPy expressions, in mappings
as YAML has them.

Guarantee: neither SymPy nor numpy is imported; an object of SymPy is taken as the text that it
prints, with exact numbers as they are, an equation of it as its left side minus its right side, and
an array as the list of its entries.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from ptmcad.errors import A_RECORD, ConfigError, Place, expect
from ptmcad.model import ClosedMechanism, Mechanism, Model, System, built_in
from ptmcad.question.config.modelkeys import model_of
from ptmcad.question.shipped import record_tree
from ptmcad.text.entry import Tree, from_python


def make_mechanism(
    description: Mapping[Any, Any] | None = None, /, **entries: Any
) -> Mechanism | ClosedMechanism:
    """A planar mechanism from the entries of its description, as a record has them under
    ``mechanism:``.

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
    return cast("Mechanism | ClosedMechanism", _model("mechanism", description, entries))


def make_system(description: Mapping[Any, Any] | None = None, /, **entries: Any) -> System:
    """A parametric system from the entries of its description, as a record has them under
    ``system:``.

    >>> make_system(unknowns={"x": "real"}, equations=["x^3 - a*x + b"]).variables
    ('a', 'b')

    Takes entries, and raises, as `make_mechanism` does.
    """
    return cast("System", _model("system", description, entries))


def tree_of(question: object, key: str = "question", expected: str = A_RECORD) -> Tree:
    """The tree of a record's file, or of a mapping like a record.

    Parameters
    ----------
    key, expected : the argument's name and what it may be, for the message.

    Raises
    ------
    ConfigError
        For anything else, and for what cannot be read.
    """
    expect(question, (str, Path, Mapping), key, expected)
    if not isinstance(question, Mapping):
        assert isinstance(question, str | Path)
        return record_tree(question)
    node = from_python(question, Place(), plain)
    assert isinstance(node, Tree)
    return node


def plain(value: object) -> object:
    """A value as `ptmcad.text.entry.from_python` takes it: models as their descriptions, SymPy's
    objects as text.

    Raises
    ------
    ConfigError
        For what depends on an undefined function of SymPy's, such as ``q(t)``.
    """
    if isinstance(value, Model):
        return value.name if value.name in built_in() else {"name": value.name, **value.source}
    shape: Any = getattr(value, "shape", None)
    if (
        isinstance(shape, tuple) and shape
    ):  # an array of numpy's; SymPy's matrices give their entries row by row
        entries: Any = value
        return [*entries]
    return _text(value) if _is_symbolic(value) else value


def _text(value: Any) -> str:
    """An object of SymPy as the text of an expression."""
    function = _undefined_function(value)
    if function is not None:
        raise ConfigError(
            f"{function} is a function of SymPy's: use a symbol in its place, such as "
            f"sympy.Symbol({function.func.__name__!r})"
        )
    if getattr(value, "rel_op", None) == "==":
        return f"{value.lhs} - ({value.rhs})"
    return str(value)


def _undefined_function(value: Any) -> Any:
    """The first undefined function in an object of SymPy, such as one of its dynamicsymbols; None
    without any.
    """
    if type(value).__module__ is None:
        return value
    found = (_undefined_function(part) for part in getattr(value, "args", ()))
    return next((function for function in found if function is not None), None)


def _is_symbolic(value: object) -> bool:
    """Whether it is an object of SymPy, which nobody has who has not imported it."""
    # SymPy makes the class of an undefined function when it is named, in no module
    modules = (getattr(kind, "__module__", None) or "" for kind in type(value).__mro__)
    return any(module.partition(".")[0] == "sympy" for module in modules)


def _model(kind: str, description: Mapping[Any, Any] | None, entries: Mapping[str, Any]) -> Model:
    if description is not None and not isinstance(description, Mapping):
        raise ConfigError("expected a mapping, or the entries by name", key=kind)
    given = {**(description or {}), **entries}
    if kind == "mechanism" and {"equations", "potential"} & given.keys():
        raise ConfigError("equations or a potential describe a system: use ptmcad.System", key=kind)
    node = from_python({kind: given}, Place(), plain)
    assert isinstance(node, Tree)
    return model_of(node)
