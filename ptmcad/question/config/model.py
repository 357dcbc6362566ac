"""The model that a record is about: built in by name, written in the record, or in a file of its own beside it.

Guarantee: what is wrong with a description is a `ConfigError` with file, line and key. Only regular files in the
record's folder, or in folders below, are read.
"""

from __future__ import annotations

from pathlib import Path

from ptmcad.errors import ConfigError
from ptmcad.mechanism import Model, built_in, described, described_system, mechanism_of, ptm, recognised
from ptmcad.question.config.starters import NAMES, starter_mechanism
from ptmcad.text.syntax import did_you_mean
from ptmcad.text.yamltree import Node, Place, Scalar, Sequence, Tree, plain_data, read_file


def model_of(record: Tree) -> Model:
    """The mechanism or system of a record; the paper's mechanism where it says nothing."""
    mechanism, system = (record.entries.get(key) for key in ("mechanism", "system"))
    if mechanism is not None and system is not None:
        raise system.place.error("a record is about a mechanism or about another system: leave one out")
    if system is not None:
        if not isinstance(system, Tree):
            raise system.place.error("expected a mapping with unknowns and equations, or a potential")
        # what has points is meant for a mechanism; anything else that is not right is wrong with a system
        return _read(system, record.place.file, "points" not in system.entries)
    if mechanism is None:
        return ptm()
    if isinstance(mechanism, Tree):
        return _read(mechanism, record.place.file)
    if not isinstance(mechanism, Scalar):
        raise mechanism.place.error("expected a mechanism's name, a mapping that describes one, or a file that does")
    if mechanism.text in built_in():
        return mechanism_of(mechanism.text)
    if _is_file(mechanism):
        return _from_file(mechanism, record.place.file)
    known = starter_mechanism(mechanism.text)
    if isinstance(known, Tree):
        return _read(known, None)
    names = tuple(name for name in NAMES if starter_mechanism(name) is not None)
    hint = did_you_mean(mechanism.text, names) or f"; built in are {', '.join(names)}"
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
        return _from_tree(read_file(name.text))
    return model_of(Tree({"mechanism": name}, name.place))


def _is_file(name: Scalar) -> bool:
    return Path(name.text).suffix.lower() in (".yaml", ".yml")


def _from_file(name: Scalar, record: str | None) -> Model:
    try:
        folder = (Path(record).parent if record else Path()).resolve()
        path = (folder / name.text).resolve()
        itself = Path(record).resolve() if record else None
    except (OSError, ValueError, RuntimeError) as error:  # a null character, a circle of links
        raise name.place.error(f"{name.text!r:.60} cannot name a file: {error}") from error
    if not path.is_relative_to(folder):
        raise name.place.error("the file is not in the record's folder nor below it: move it there")
    if path == itself:
        raise name.place.error("the record names itself as its mechanism's file")
    return _from_tree(read_file(path))


def _from_tree(tree: Tree) -> Model:
    """The model of a file: a description, a record with one, or a system."""
    inner = tree.entries.get("mechanism") or tree.entries.get("system") or tree
    if not isinstance(inner, Tree):
        raise inner.place.error("a mechanism's file describes it: it does not name another one")
    return _read(inner, tree.place.file)


def _read(node: Tree, file: str | None, is_system: bool = False) -> Model:
    """What a mapping describes; a fault is put where it stands in the file."""
    is_system = is_system or "equations" in node.entries or "potential" in node.entries
    data = {key: _plain(entry) for key, entry in node.entries.items()}
    try:
        # written down again, the built-in one is the same one
        return described_system(data) if is_system else recognised(described(data))
    except ConfigError as error:
        raise ConfigError.of([_placed(fault, node, file) for fault in error.faults]) from error


def _placed(fault: ConfigError, node: Node, file: str | None) -> ConfigError:
    place = _place(node, fault.key or "")
    return ConfigError(fault.message, key=place.key, file=file, line=place.line)


def _plain(node: Node) -> object:
    """As `plain_data`, but refusing an empty value, which a description has no meaning for."""
    if isinstance(node, Scalar) and node.is_null:
        raise node.place.error("has no value")
    return plain_data(node)


def _place(node: Node, key: str) -> Place:
    """Where a key of a description stands: the nearest entry above it that is there."""
    place = node.place
    for step in key.split(".") if key else ():
        if isinstance(node, Tree) and step in node.entries:
            node = node.entries[step]
        elif isinstance(node, Sequence) and step.isdecimal() and 1 <= int(step) <= len(node.items):
            node = node.items[int(step) - 1]
        else:
            return Place(f"{place.key}.{step}" if place.key else step, place.file, place.line)
        place = Place(f"{place.key}.{step}" if place.key else step, place.file, node.place.line or place.line)
    return place
