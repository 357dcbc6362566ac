"""The model that a record is about: built in by name, written in the record, or in a file of its
own beside it.

Guarantee: what is wrong with a description is a `ConfigError` with file, line and key. Only regular
files in the record's folder, or in folders below, are read.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from ptmcad.errors import ConfigError, ExpressionError, Faults, Place, quoted
from ptmcad.model import (
    Model,
    built_in,
    mechanism_of,
    ptm,
    read_mechanism,
    read_system,
    recognised,
)
from ptmcad.model.closed import without_loops
from ptmcad.model.proofs import check_numbers
from ptmcad.model.reading import faulty_entries
from ptmcad.question.config.starters import mechanism_names, starter_mechanism
from ptmcad.text.entry import Scalar, Tree, place_at, plain_data, scalars
from ptmcad.text.syntax import NAME, did_you_mean, names_in
from ptmcad.text.yamltree import read_file

_TOLD = frozenset({"parameters", "name", "title", "equations", "potential", "positive", "stable"})
"""The keys of a system below which no fault hides what a name is that an equation holds."""


class Described(NamedTuple):
    """A model and where each part of its description stands.

    Attributes
    ----------
    tree : the description; None where nobody has written it.
    doubtful : parameters of which nothing can be said, because what describes them is faulty.
    """

    model: Model
    tree: Tree | None = None
    doubtful: frozenset[str] = frozenset()

    def place_of(self, parameter: str) -> Place | None:
        """Where a parameter has its default, or else where it is declared or first used; None where
        nothing says it.
        """
        if self.tree is None:
            return None
        found = self.model.parameters[parameter]
        parameters = self.tree.entries.get("parameters")
        declared = (
            parameters.entries.get(found.alias_of or parameter)
            if isinstance(parameters, Tree)
            else None
        )
        if isinstance(declared, Tree):
            said = declared.entries.get("alias" if found.alias_of else "default")
            return declared.place if said is None else said.place
        return next(
            (s.place for s in scalars(self.tree) if parameter in NAME.findall(s.text)), None
        )

    def place_of_part(self, key: str) -> Place | None:
        """Where a key of the description stands; None where nobody has written it."""
        return None if self.tree is None else place_at(self.tree, key)

    def has_part(self, key: str) -> bool:
        """Whether the description has a key."""
        return self.tree is not None and key.partition(".")[0] in self.tree.entries


def model_of(record: Tree) -> Model:
    """The mechanism or system of a record; the paper's mechanism where it says nothing.

    Raises
    ------
    ConfigError
        For what is wrong with it; it knows all faults.
    """
    faults = Faults()
    with faults:
        found = described_in(record, faults)
    faults.check()
    return found.model


def described_in(record: Tree, faults: Faults) -> Described:
    """The same with its places; what is wrong inside of a description is noted, and left out or
    replaced.

    Raises
    ------
    ConfigError
        When there is no description.
    """
    mechanism, system = (record.entries.get(key) for key in ("mechanism", "system"))
    used = tuple(_names_in_values(record))
    if mechanism is not None and system is not None:
        for node, is_system in (mechanism, False), (system, True):
            with faults:
                if isinstance(node, Tree):
                    _read(node, faults, used, is_system)
        raise system.place.error(
            "a record is about a mechanism or about another system: leave one out"
        )
    if system is not None:
        if not isinstance(system, Tree):
            raise system.place.error(
                "expected a mapping with unknowns and equations, or a potential"
            )
        # what has points is meant for a mechanism; anything else that is not right is wrong with a
        # system
        return _read(system, faults, used, "points" not in system.entries)
    if mechanism is None:
        return Described(ptm())
    if isinstance(mechanism, Tree):
        return _read(mechanism, faults, used)
    if not isinstance(mechanism, Scalar):
        raise mechanism.place.error(
            "expected a mechanism's name, a mapping that describes one, or a file that does"
        )
    if mechanism.text in built_in():
        return Described(mechanism_of(mechanism.text))
    if _is_file(mechanism):
        return _read(_description(_file_of(mechanism, record.place.file)), faults, used)
    known = starter_mechanism(mechanism.text)
    if isinstance(known, Tree):
        return Described(_read(known, faults, used).model)
    hint = did_you_mean(mechanism.text, mechanism_names(), "; built in are ")
    raise mechanism.place.error(
        f"unknown mechanism{hint}; a file that holds one ends in .yaml, and a mapping describes one"
    )


def named_model(name: Scalar) -> Model:
    """The model of a name, or of a file that is wherever the user says it is: what an option gives.

    Raises
    ------
    ConfigError
        When there is none, or for what is wrong with it.
    """
    if _is_file(name):
        faults = Faults()
        found = _read(_description(read_file(name.text)), faults)
        faults.check()
        return found.model
    return model_of(Tree({"mechanism": name}, name.place))


def _is_file(name: Scalar) -> bool:
    return Path(name.text).suffix.lower() in (".yaml", ".yml")


def _file_of(name: Scalar, record: str | None) -> Tree:
    """The file that a record names."""
    try:
        folder = (Path(record).parent if record else Path()).resolve()
        path = (folder / name.text).resolve()
        itself = Path(record).resolve() if record else None
    except (OSError, ValueError, RuntimeError) as error:  # a null character, a circle of links
        raise name.place.error(f"{quoted(name.text)} cannot name a file: {error}") from error
    if not path.is_relative_to(folder):
        raise name.place.error("the file is not in the record's folder nor below it: move it there")
    if path == itself:
        raise name.place.error("the record names itself as its mechanism's file")
    try:
        return read_file(path)
    except ConfigError as error:
        if error.line is not None:  # a place in that file, where something is to be mended
            raise
        raise name.place.error(f"{quoted(name.text, 100)}: {error.message}") from error


def _description(tree: Tree) -> Tree:
    """The description in a file: itself, or that of a record."""
    inner = tree.entries.get("mechanism") or tree.entries.get("system") or tree
    if not isinstance(inner, Tree):
        raise inner.place.error("a mechanism's file describes it: it does not name another one")
    return inner


def _read(
    node: Tree, faults: Faults, used: Iterable[str] = (), is_system: bool = False
) -> Described:
    """What a mapping describes; a fault is put where it stands in the file.

    Parameters
    ----------
    used : names in the record's own expressions.
    """
    is_system = is_system or "equations" in node.entries or "potential" in node.entries
    data = plain_data(node)
    found = Faults()
    model: Model | None = None
    with suppress(
        ConfigError
    ):  # so many faults that no more are looked for: they still have to be put in their places
        model = _system(data, {*used}, found) if is_system else _mechanism(data, {*used}, found)
    placed = [place_at(node, fault.key or "").error(fault.message) for fault in found.found]
    if model is None:
        raise ConfigError.of(placed)
    for error in placed:
        with faults:
            raise error
    return Described(model, node, _doubtful(model, found, is_system) if placed else frozenset())


def _mechanism(data: Mapping[str, Any], used: set[str], faults: Faults) -> Model:
    model = read_mechanism(data, faults)
    if not faults.found:
        with faults:
            model = recognised(model)  # written down again, the built-in one is the same one
    _check_use(model, used, "a point, a spring or a load", faults)
    check_numbers(model, faults)
    if not faults.found:
        with faults:
            return without_loops(model)
    return model


def _system(data: Mapping[str, Any], used: set[str], faults: Faults) -> Model:
    model = read_system(data, faults)
    _check_use(model, used, "an equation", faults)
    return model


_WITHOUT_PARAMETERS = frozenset({"name", "title", "bars", "supports", "unknowns"})
"""Keys below which no parameter is used."""


def _check_use(model: Model, used: set[str], where: str, faults: Faults) -> None:
    """Note each parameter that nothing uses, neither the description nor the record's own
    expressions.

    Parameters
    ----------
    where : a description uses one.
    """
    if faults.parts - _WITHOUT_PARAMETERS:
        return  # what could not be read may use it
    for name in model.idle:
        with faults:
            if name not in used:
                parameter = model.parameters[name]
                raise ConfigError(
                    f"nothing uses {name}: leave it out, or use it in {where}, or in an expression under the record's "
                    "'parameters:'",
                    key=f"parameters.{parameter.alias_of}.alias"
                    if parameter.alias_of
                    else f"parameters.{name}",
                )


def _names_in_values(record: Tree) -> Iterator[str]:
    """The names in the expressions of a record's parameters."""
    values = record.entries.get("parameters")
    for name, value in values.entries.items() if isinstance(values, Tree) else ():
        if isinstance(value, Scalar):
            with suppress(ExpressionError):  # a fault of that value
                yield from (other for other in names_in(value.text) if other != name)


def _doubtful(model: Model, faults: Faults, is_system: bool) -> frozenset[str]:
    """The parameters of which nothing can be said with such faults."""
    if ["parameters"] in faults.steps:
        return frozenset(model.parameters)
    names = faulty_entries(faults, "parameters") | (
        _undeclared(model, faults) if is_system else frozenset()
    )
    return frozenset(names | {name for name, p in model.parameters.items() if p.alias_of in names})


def _undeclared(model: Model, faults: Faults) -> frozenset[str]:
    """The parameters of a system that are not listed: they may be something else, where faults hide
    what they are.
    """
    undeclared = model.parameters.keys() - model.source.get("parameters", {})
    clear = faults.parts <= _TOLD
    return frozenset(undeclared - {*model.variables} if clear else undeclared)
