"""A parametric system's description read from a record: equations or a potential, inequalities, stability conditions.

Guarantee: what is wrong is a `ConfigError` with its key, which knows all other faults.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.errors import ConfigError, Faults
from ptmcad.mechanism.angles import PI
from ptmcad.mechanism.description import Kind, Parameter, System, UnknownKind
from ptmcad.mechanism.evaluate import value_at
from ptmcad.mechanism.reading import VALUE, Context, new_name, parsed
from ptmcad.mechanism.sizes import check_sizes
from ptmcad.text.codec import Codec, listed, part, reading, record
from ptmcad.text.entry import Place, from_python
from ptmcad.text.node import MAX_ENTRIES, Node
from ptmcad.text.tree import Tree, names_of

DEFAULT_NAME = "system"
_LISTS = ("equations", "positive", "stable")
_HOLDING = frozenset({"unknowns", "equations", "potential"})
_LIKE = {"equations": '["x^3 - a*x + b"]', "positive": "[x]", "stable": '["3*x^2 - a"]'}
"""Examples for messages."""


def described_system(record: Mapping[str, Any]) -> System:
    """The parametric system of a record, which is a mapping as YAML gives it.

    Names that are no unknowns are its parameters; those that the record does not list are numbers without a default.

    Raises
    ------
    ConfigError
        With the key of what is wrong; also where there are not as many equations as unknowns, or where an unknown
        stands in no equation. Its ``faults`` are all that is wrong.
    """
    faults = Faults()
    found = read_system(record, faults)
    faults.check()
    return found


def read_system(record: Mapping[str, Any], faults: Faults) -> System:
    """As `described_system`, but what is wrong is noted, and left out or replaced."""
    context = Context(faults)
    codec = system_codec(context)
    found = codec.read(Node.of(from_python(record, Place()), faults))
    # a key that nobody knows has been told, and may be meant for one of these
    misspelt = not {"equations", "potential"} & record.keys() and not record.keys() <= codec.schema["properties"].keys()
    with faults:
        if ("equations" in record) is ("potential" in record) and not misspelt:
            raise ConfigError("give either equations or a potential", key="equations")
    texts: dict[str, Node] = {entry.key: entry for key in (*_LISTS, "potential") for entry in found.pop(key)}
    parameters, unknowns = context.parameters, context.unknowns
    trees: dict[str, Tree] = {}
    for key, entry in texts.items():
        with faults:
            trees[key] = parsed(entry)
    for key, tree in trees.items():
        _add_names(tree, key, parameters, unknowns, faults)
    with faults:
        if len(parameters) > MAX_ENTRIES:
            raise ConfigError(f"{len(parameters)} names of parameters, more than {MAX_ENTRIES}", key="equations")
    for key in trees:
        with faults:
            trees[key] = tree = context.reader.tree(texts[key], moving=True)
            if key.startswith("positive.") and not names_of(tree) and value_at(tree, {}) <= 0:
                raise ConfigError("is never positive: no solution would be counted", key=key)
    equations, positive, stable = (
        tuple(tree for key, tree in trees.items() if key.startswith(f"{part}.")) for part in _LISTS
    )
    system = System(
        **{**found, "parameters": parameters}, equations=equations, potential=trees.get("potential"),
        inequalities=positive, stability=stable, source=record,
    )  # fmt: skip
    with faults:
        if system.potential is not None and system.stability:
            raise ConfigError("of a potential the Hessian decides what is stable: leave this out", key="stable")
    with faults:
        written = sum(key.startswith("equations.") for key in texts)
        if "potential" not in record and written and written != len(unknowns):
            raise ConfigError(
                f"{written} equations for {len(unknowns)} unknowns: give as many as there are unknowns", key="equations"
            )
    faulty = {(fault.key or "").partition(".")[0] for fault in faults.found}
    if not faulty & (_HOLDING | {*_LISTS}):
        check_sizes(system, faults)
    if not misspelt and not faulty & _HOLDING:
        _check_unknowns(system, faults)
    return system


def system_codec(context: Context) -> Codec[dict[str, Any]]:
    """A system's keys, read in this order; its expressions are left as they are written, one after another."""
    text = reading(lambda entry: entry, **VALUE)
    potential = reading(lambda entry: (entry,), **VALUE)
    equations, positive, stable = (listed(text, None, MAX_ENTRIES, _LIKE[key]) for key in _LISTS)
    whole: Codec[dict[str, Any]] = record(
        dict,
        **context.start(DEFAULT_NAME, "Kinds, defaults and ranges; other names in the equations are numbers."),
        equations=part(equations, "Each is zero.", ()),
        potential=part(potential, "Solutions are its critical points.", ()),
        positive=part(positive, "Strict inequalities that a counted solution satisfies.", ()),
        stable=part(stable, "A solution is stable where all are positive.", ()),
    )
    return whole.narrowed(oneOf=[{"required": ["equations"]}, {"required": ["potential"]}])


def _add_names(
    tree: Tree, key: str, parameters: dict[str, Parameter], unknowns: Mapping[str, UnknownKind], faults: Faults
) -> None:
    """Add the names in an expression that are new to the parameters."""
    for name in names_of(tree):
        with faults:
            if name != PI and name not in parameters and name not in unknowns:
                parameters[new_name(name, key, {})] = Parameter(name, Kind.NUMBER, "", None)


def _check_unknowns(system: System, faults: Faults) -> None:
    """Note each unknown that stands in no equation."""
    equations = system.equations if system.potential is None else (system.potential,)
    held = {name for tree in equations for name in names_of(tree)}
    for unknown in system.unknowns:
        with faults:
            if unknown not in held:
                raise ConfigError("no equation holds this unknown", key=f"unknowns.{unknown}")
