"""A parametric system's description read from a record: equations or a potential, inequalities,
stability conditions.

Guarantee: what is wrong is a `ConfigError` with its key, which knows all other faults.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ptmcad.errors import ConfigError, Faults, Place
from ptmcad.model.description import System
from ptmcad.model.evaluate import value_at
from ptmcad.model.reading import VALUE, Context, new_name, parsed
from ptmcad.model.termbounds import check_sizes
from ptmcad.model.trees import PI
from ptmcad.text.codec import Codec, listed, part, reading, record
from ptmcad.text.entry import from_python
from ptmcad.text.node import MAX_ENTRIES, Node
from ptmcad.text.tree import Tree, names_of

DEFAULT_NAME = "system"
_HOLDING = frozenset({"unknowns", "equations", "potential"})


def described_system(record: Mapping[str, Any]) -> System:
    """The parametric system of a record, which is a mapping as YAML gives it.

    Names that are no unknowns are its parameters; those that the record does not list are numbers
    without a default.

    Raises
    ------
    ConfigError
        With the key of what is wrong; also where there are not as many equations as unknowns, or
        where an unknown stands in no equation. Its ``faults`` are all that is wrong.
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
    system = System(**{**found, "parameters": context.parameters}, source=record)
    # an unknown key has been reported, and may be meant for one of these
    misspelt = (
        not {"equations", "potential"} & record.keys()
        and not record.keys() <= codec.schema["properties"].keys()
    )
    equations = record.get("equations")
    written = len(equations) if isinstance(equations, list | tuple) else 0
    number, unknowns = len(system.parameters), len(system.unknowns)
    for wrong, key, problem in (
        (
            ("equations" in record) is ("potential" in record) and not misspelt,
            "equations", "give either equations or a potential",
        ),
        (number > MAX_ENTRIES, "equations", f"{number} names of parameters, more than {MAX_ENTRIES}"),
        (
            "potential" in record and system.stability,
            "stable", "of a potential the Hessian decides what is stable: leave this out",
        ),
        (
            "potential" not in record and unknowns > 0 and written not in (0, unknowns),
            "equations", f"{written} equations for {unknowns} unknowns: give as many as there are unknowns",
        ),
    ):  # fmt: skip
        with faults:
            if wrong:
                raise ConfigError(problem, key=key)
    faulty = faults.parts
    if not faulty & (_HOLDING | {"positive", "stable"}):
        check_sizes(system, faults)
    if not misspelt and not faulty & _HOLDING:
        _check_unknowns(system, faults)
    return system


def system_codec(context: Context) -> Codec[dict[str, Any]]:
    """A system's keys, read in this order; names in expressions that are no unknowns become
    parameters.
    """

    def read(entry: Node) -> Tree:
        for name in names_of(parsed(entry)):
            if name not in (PI, *context.parameters, *context.unknowns):
                context.add(new_name(name, entry.key, {}))
        return context.tree(entry, moving=True)

    def read_positive(entry: Node) -> Tree:
        tree = read(entry)
        if not names_of(tree) and value_at(tree, {}) <= 0:
            raise entry.fault("is never positive: no solution would be counted")
        return tree

    tree, positive = reading(read, **VALUE), reading(read_positive, **VALUE)
    whole: Codec[dict[str, Any]] = record(
        dict,
        **context.start(
            DEFAULT_NAME, "Kinds, defaults and ranges; other names in the equations are numbers."
        ),
        equations=part(listed(tree, None, MAX_ENTRIES, '["x^3 - a*x + b"]'), "Each is zero.", ()),
        positive=part(
            listed(positive, None, MAX_ENTRIES, "[x]"),
            "Strict inequalities that a counted solution satisfies.",
            (),
        )._replace(field="inequalities"),
        stable=part(
            listed(tree, None, MAX_ENTRIES, '["3*x^2 - a"]'),
            "A solution is stable where all are positive.",
            (),
        )._replace(field="stability"),
        potential=part(tree, "Solutions are its critical points.", None),
    )
    return whole.narrowed(oneOf=[{"required": ["equations"]}, {"required": ["potential"]}])


def _check_unknowns(system: System, faults: Faults) -> None:
    """Note each unknown that stands in no equation."""
    equations = system.equations if system.potential is None else (system.potential,)
    held = {name for tree in equations for name in names_of(tree)}
    for unknown in system.unknowns:
        with faults:
            if unknown not in held:
                raise ConfigError("no equation holds this unknown", key=f"unknowns.{unknown}")
