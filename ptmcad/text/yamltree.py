"""A YAML text as a tree whose every scalar and key knows the file, the line and the key path it
stands at.

Guarantee: scalars keep the text that was written (``0.1`` stays ``0.1``, never a float); no tag,
anchor, alias or second document is accepted, no key occurs twice, and bytes, depth, number of
values and length of keys are bounded, so that reading ends in a fraction of a second and bounded
memory. Every refusal is a `ConfigError` that names the place.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from ptmcad.errors import ConfigError, Place, shown
from ptmcad.text import textfile
from ptmcad.text.entry import MAX_DEPTH, Scalar, Sequence, Tree, Written

MAX_BYTES = 200_000
MAX_VALUES = 10_000
MAX_KEY = 100
"""Longer keys make no sense; every place in a tree holds the path of keys to it."""
_DIRECTIVE = re.compile(r"^%", re.MULTILINE)
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_file(path: str | Path) -> Tree:
    """Read a YAML file whose root is a mapping.

    Raises
    ------
    ConfigError
        If the file is missing, is no regular file, cannot be read, is larger than `MAX_BYTES`, is
        not UTF-8 text, is not YAML, or uses what the module's docstring excludes.
    """
    return read_text(
        textfile.read_text(path, MAX_BYTES, "a problem record (a YAML file)"), str(path)
    )


def read_text(text: str, file: str | None = None) -> Tree:
    """Read a YAML text whose root is a mapping; `file` is named in messages. Raises `ConfigError`."""
    root = Place(file=file)
    directive = _DIRECTIVE.search(text)
    if directive is not None:  # the parser's time is quadratic in their number
        line = text.count("\n", 0, directive.start()) + 1
        raise Place(file=file, line=line).error("a line that starts with % is not accepted: YAML would take it for a "
                                                "directive")  # fmt: skip
    try:
        node = _document(_counted(yaml.parse(text, Loader=_LOADER), root), root)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        problem = shown(" ".join(filter(None, (error.context, error.problem))), 300)
        if mark is not None and "cannot start any token" in problem:
            problem = _cannot_start(text, mark) or problem
        if "maximum nesting depth" in problem:  # a limit that some builds of libyaml have
            raise Place(file=file, line=mark.line + 1 if mark else None).error(
                f"more than {MAX_DEPTH} levels of nesting"
            ) from error
        raise ConfigError(
            f"is not YAML: {problem}", file=file, line=mark.line + 1 if mark else None
        ) from error
    except yaml.YAMLError as error:
        raise ConfigError(
            "is not YAML: it has a character that text does not have (is it a binary file?)",
            file=file,
        ) from error
    if not isinstance(node, Tree):
        found = (
            "is empty"
            if isinstance(node, Scalar) and node.is_null
            else "is not a mapping of keys to values"
        )
        raise ConfigError(f"{found}: a problem record has lines such as 'count: stable'", file=file)
    return node


def _cannot_start(text: str, mark: Any) -> str:
    """What is said where a text cannot go on so, in words of a character that has a name; else
    empty.
    """
    lines = text.splitlines()
    line = lines[mark.line] if mark.line < len(lines) else ""
    character = line[mark.column : mark.column + 1]
    if character == "\t":
        return "a tab stands where YAML takes spaces only: write spaces in its place"
    return (
        f"the character {character!r} cannot stand at the beginning of a value: put the value in quotation marks"
        if (character.isprintable() and character)
        else ""
    )


def _document(events: Iterator[Any], root: Place) -> Written:
    """The only document's root node."""
    node: Written = Scalar("", root)
    documents = 0
    for event in events:
        if isinstance(event, yaml.DocumentStartEvent):
            documents += 1
            if documents > 1:
                raise root._replace(line=_line(event)).error(
                    "a second document starts here: one record a file"
                )
        elif isinstance(event, yaml.NodeEvent):
            node = _node(event, events, root, 0)
    return node


def _counted(events: Iterator[Any], root: Place) -> Iterator[Any]:
    """The events, as long as they are not too many."""
    values = 0
    for event in events:
        values += isinstance(event, yaml.NodeEvent)
        if values > MAX_VALUES:
            raise root._replace(line=_line(event)).error(
                f"more than {MAX_VALUES} values: this is not a problem record"
            )
        yield event


def _node(event: Any, events: Iterator[Any], place: Place, depth: int) -> Written:
    """The node that starts with `event`; the rest of it is taken from `events`."""
    here = Place(place.key, place.file, _line(event))
    key_line = place.line or here.line  # where a block begins is below its key
    if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
        raise here.error(
            "anchors (&) and aliases (*) are not accepted: write the value out, or quote the text"
        )
    if event.tag is not None:
        raise here.error(f"the tag {shown(event.tag, 80)} is not accepted: leave it out")
    if depth > MAX_DEPTH:
        raise here.error(f"more than {MAX_DEPTH} levels of nesting")
    if isinstance(event, yaml.ScalarEvent):
        return Scalar(event.value, here, plain=bool(event.implicit[0]))
    if isinstance(event, yaml.SequenceStartEvent):
        items: list[Written] = []
        while not isinstance(event := next(events), yaml.SequenceEndEvent):
            item = place.below(str(len(items) + 1))._replace(line=None)
            items.append(_node(event, events, item, depth + 1))
        return Sequence(tuple(items), here._replace(line=key_line))
    entries: dict[str, Written] = {}
    lines: dict[str, int] = {}
    while not isinstance(event := next(events), yaml.MappingEndEvent):
        key = _node(event, events, place._replace(line=None), depth + 1)
        line = _line(event)
        if not isinstance(key, Scalar) or key.is_null:
            raise place._replace(line=line).error("a key must be a name")
        if len(key.text) > MAX_KEY:
            raise place._replace(line=line).error(f"a key has more than {MAX_KEY} characters")
        at = place.below(key.text, line)
        if key.text == "<<":
            raise at.error("merge keys are not accepted: write the entries out")
        if key.text in entries:
            raise at.error(f"the key occurs twice; first in line {lines[key.text]}: leave one out")
        lines[key.text] = line
        entries[key.text] = _node(next(events), events, at, depth + 1)
    return Tree(entries, here._replace(line=key_line))


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1
