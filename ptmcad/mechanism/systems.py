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
from ptmcad.mechanism.reading import (
    Reader,
    faulty_entries,
    name_of,
    new_name,
    parameters_of,
    parsed,
    title_of,
    unknowns_of,
)
from ptmcad.mechanism.sizes import check_sizes
from ptmcad.text.entry import MAX_ENTRIES, Entry, Place
from ptmcad.text.tree import Tree, names_of

SYSTEM_KEYS = ("name", "title", "parameters", "unknowns", "equations", "potential", "positive", "stable")
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
    whole = Entry(record, Place(), faults).fields(SYSTEM_KEYS)
    name = whole.read("name", name_of, DEFAULT_NAME)
    title = whole.read("title", lambda entry: title_of(entry.value), "")
    parameters: dict[str, Parameter] = {}
    with faults:
        parameters = parameters_of(whole)
    unknowns = unknowns_of(whole, parameters)
    # a key that nobody knows has been told, and may be meant for one of these
    misspelt = not {"equations", "potential"} & record.keys() and any(key not in SYSTEM_KEYS for key in record)
    with faults:
        if ("equations" in record) is ("potential" in record) and not misspelt:
            raise ConfigError("give either equations or a potential", key="equations")
    texts = _texts(whole)
    trees: dict[str, Tree] = {}
    for key, entry in texts.items():
        with faults:
            trees[key] = parsed(entry)
    for key, tree in trees.items():
        _add_names(tree, key, parameters, unknowns, faults)
    with faults:
        if len(parameters) > MAX_ENTRIES:
            raise ConfigError(f"{len(parameters)} names of parameters, more than {MAX_ENTRIES}", key="equations")
    reader = Reader(parameters, unknowns, faulty_entries(faults, "unknowns"))
    for key in trees:
        with faults:
            trees[key] = tree = reader.tree(texts[key], moving=True)
            if key.startswith("positive.") and not names_of(tree) and value_at(tree, {}) <= 0:
                raise ConfigError("is never positive: no solution would be counted", key=key)
    equations, positive, stable = (
        tuple(tree for key, tree in trees.items() if key.startswith(f"{part}.")) for part in _LISTS
    )
    system = System(
        name, parameters, unknowns, equations, trees.get("potential"), positive, stable, source=record, title=title
    )
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


def _add_names(
    tree: Tree, key: str, parameters: dict[str, Parameter], unknowns: Mapping[str, UnknownKind], faults: Faults
) -> None:
    """Add the names in an expression that are new to the parameters."""
    for name in names_of(tree):
        with faults:
            if name != PI and name not in parameters and name not in unknowns:
                parameters[new_name(name, key, {})] = Parameter(name, Kind.NUMBER, "", None)


def _texts(record: Entry) -> dict[str, Entry]:
    """The expressions as written, by their keys."""
    found = [entry for key in _LISTS for entry in record.at(key, ()).each_item(lambda entry: entry, _LIKE[key])]
    if record.has("potential"):
        found.append(record.at("potential"))
    return {entry.key: entry for entry in found}


def _check_unknowns(system: System, faults: Faults) -> None:
    """Note each unknown that stands in no equation."""
    equations = system.equations if system.potential is None else (system.potential,)
    held = {name for tree in equations for name in names_of(tree)}
    for unknown in system.unknowns:
        with faults:
            if unknown not in held:
                raise ConfigError("no equation holds this unknown", key=f"unknowns.{unknown}")
