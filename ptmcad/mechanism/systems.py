"""A parametric system's description read from a record: equations or a potential, inequalities, stability conditions.

Guarantee: what is wrong is a `ConfigError` with its key, which knows all other faults.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.errors import ConfigError, Faults
from ptmcad.mechanism.description import Kind, Parameter, System, UnknownKind
from ptmcad.mechanism.reading import (
    MAX_ENTRIES,
    PI,
    Reader,
    check_keys,
    listed,
    mapping,
    new_name,
    parameters_of,
    parsed,
    unknowns_of,
)
from ptmcad.text.tree import Tree, names_of

SYSTEM_KEYS = ("name", "parameters", "unknowns", "equations", "potential", "positive", "stable")
DEFAULT_NAME = "system"
_LISTS = ("equations", "positive", "stable")
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
    check_keys(record, SYSTEM_KEYS, "", faults)
    name = DEFAULT_NAME
    with faults:
        name = new_name(record.get("name", DEFAULT_NAME), "name", {})
    parameters: dict[str, Parameter] = {}
    with faults:
        parameters = parameters_of(mapping(record.get("parameters", {}), "parameters"), faults)
    unknowns: dict[str, UnknownKind] = {}
    with faults:
        if "unknowns" not in record:
            raise ConfigError("is missing", key="unknowns")
        unknowns = unknowns_of(record["unknowns"], parameters, faults)
    with faults:
        if ("equations" in record) is ("potential" in record):
            raise ConfigError("give either equations or a potential", key="equations")
    texts = _texts(record, faults)
    trees = {key: tree for key, text in texts.items() if (tree := _tree(text, key, faults)) is not None}
    faults.check()
    listed_ones = tuple(parameters)
    for key, tree in trees.items():
        for found in names_of(tree):
            if found not in parameters and found not in unknowns:
                with faults:
                    if found == PI:
                        raise ConfigError("pi is no rational number: name a parameter in its place", key=key)
                    parameters[new_name(found, key, {})] = Parameter(found, Kind.NUMBER, "", None)
    with faults:
        if len(parameters) > MAX_ENTRIES:
            raise ConfigError(f"{len(parameters)} names of parameters, more than {MAX_ENTRIES}", key="equations")
    faults.check()
    reader = Reader(parameters, unknowns)
    for key, text in texts.items():
        with faults:
            reader.tree(text, key, moving=True)
    equations, positive, stable = (
        tuple(tree for key, tree in trees.items() if key.startswith(f"{part}.")) for part in _LISTS
    )
    system = System(name, parameters, unknowns, equations, trees.get("potential"), positive, stable, source=record)
    _check(system, listed_ones, faults)
    faults.check()
    return system


def _texts(record: Mapping[str, Any], faults: Faults) -> dict[str, object]:
    """Keys to the expressions as written."""
    texts: dict[str, object] = {}
    for key in _LISTS:
        with faults:
            texts |= {f"{key}.{n}": text for n, text in enumerate(listed(record.get(key, ()), key, _LIKE[key]), 1)}
    if "potential" in record:
        texts["potential"] = record["potential"]
    return texts


def _tree(text: object, key: str, faults: Faults) -> Tree | None:
    with faults:
        return parsed(text, key)
    return None


def _check(system: System, listed_ones: tuple[str, ...], faults: Faults) -> None:
    """Note what the parts show together only."""
    with faults:
        if system.potential is not None and system.stability:
            raise ConfigError("of a potential the Hessian decides what is stable: leave this out", key="stable")
    with faults:
        if system.potential is None and len(system.equations) != len(system.unknowns):
            raise ConfigError(
                f"{len(system.equations)} equations for {len(system.unknowns)} unknowns: give as many as there are "
                "unknowns",
                key="equations",
            )
    equations = system.equations if system.potential is None else (system.potential,)
    held = {name for tree in equations for name in names_of(tree)}
    for unknown in system.unknowns:
        with faults:
            if unknown not in held:
                raise ConfigError("no equation holds this unknown", key=f"unknowns.{unknown}")
    used = {*system.variables, *system.shorthands}
    for parameter in listed_ones:
        with faults:
            if parameter not in used:
                raise ConfigError("nothing uses this parameter", key=f"parameters.{parameter}")
