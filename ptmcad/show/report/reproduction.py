"""The problem record and the command lines that pose a result's question again.

Guarantee: a record or command line that is returned, read by `ptmcad.question.config`, gives the
result's slice, parameter for parameter: that is tried before it is returned. What cannot be posed
again is None.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import replace

import yaml

from ptmcad.errors import ConfigError
from ptmcad.model import Kind, built_in, mechanism_of
from ptmcad.question.config import slice_from_mapping, slice_from_options
from ptmcad.question.counts import USUAL
from ptmcad.question.slice import Slice
from ptmcad.text.entry import plain_data
from ptmcad.text.numerals import text_of
from ptmcad.text.yamltree import read_text


def reproduction(slice: Slice) -> tuple[str | None, str | None]:
    """Ways to the same slice: a record in YAML, and a command line that needs none (it cannot set
    the title).
    """
    # what the user wrote, if that gives the same functions; else the functions themselves
    for values in (_given(slice, slice.text), _given(slice, {})):
        record = _yaml(_mapping(slice, values))
        if _same(slice, record):
            return record, _command(slice, values)
    return None, None


def _given(slice: Slice, written: Mapping[str, str]) -> dict[str, str]:
    """The values that a record has to give: not those of the axes, nor the defaults."""
    names = slice.axis_names
    mechanism = slice.model
    always = (
        mechanism.first(Kind.LENGTH),
        mechanism.first(Kind.STIFFNESS),
    )  # what the reader compares others with
    # shorthands are no parameters where the springs do not have them, but other texts may name them
    alone = {name: text for name, text in written.items() if name not in slice.parameters}
    values = {
        name: text for name, text in alone.items()
        if mechanism.kind(name) is not Kind.FREE_LENGTH or text != mechanism.parameters[name].default
    }  # fmt: skip
    for name, expression in slice.parameters.items():
        text = written.get(name, expression.to_text(names))
        known = mechanism.parameters.get(name)
        if (
            known is not None
            and name not in names
            and known.alias_of in alone
            and known.kind is Kind.STIFFNESS
        ):
            values[name] = text  # else the shorthand would be that spring's too
            continue
        if name in names or (known is not None and text == known.default and name not in always):
            continue
        if known is not None and expression == slice.parameters.get(known.alias_of):
            continue
        values[name] = text
    for shorthand, own in mechanism.shorthands.items():
        if mechanism.kind(shorthand) is Kind.FREE_LENGTH and shorthand not in (*names, *alone):
            free = {values.get(name, "") for name in own}
            if len(free) == 1 and (text := free.pop()) and shorthand not in text:
                values = {name: value for name, value in values.items() if name not in own} | {
                    shorthand: text
                }
    return values


def _mapping(slice: Slice, values: Mapping[str, str]) -> dict[str, object]:
    return {
        "name": slice.name,
        **({"title": slice.title} if slice.title else {}),
        **_model(slice),
        "parameters": dict(values),
        "axes": {axis.name: [text_of(axis.low), text_of(axis.high)] for axis in slice.axes},
        "count": slice.count.value,
    }


def _model(slice: Slice) -> dict[str, object]:
    """The key of the model: a built-in mechanism by its name, others as they were described."""
    key = slice.model.record_key
    if slice.mechanism in built_in() and mechanism_of(slice.mechanism) == slice.model:
        return {key: slice.mechanism}
    return {key: dict(slice.model.source) or slice.mechanism}


def _same(slice: Slice, record: str) -> bool:
    try:
        found = slice_from_mapping(plain_data(read_text(record)))
    except ConfigError:  # then this way does not lead to the slice, which is what is asked
        return False
    return _core(found) == _core(slice)


def _core(slice: Slice) -> Slice:
    """The slice without what does not bear on the computation."""
    return replace(slice, reference={}, text={})


def _command(slice: Slice, values: Mapping[str, str]) -> str | None:
    axes = ",".join(slice.axis_names)
    ranges = [f"{a.name}={text_of(a.low)}:{text_of(a.high)}" for a in slice.axes]
    sets = [f"{name}={value}" for name, value in values.items()]
    try:
        found = slice_from_options(slice=axes, sets=sets, ranges=ranges, count=slice.count)
    except ConfigError:
        return None
    if replace(_core(found), name="", title="") != replace(_core(slice), name="", title=""):
        return None
    words = ["ptmcad", "classify", "--slice", axes]
    for text in ranges:
        words += ["--range", text]
    for text in sets:
        words += ["--set", text]
    if slice.count is not USUAL:
        words += ["--count", slice.count.value]
    return shlex.join(words)


def _yaml(mapping: Mapping[str, object]) -> str:
    """The record as YAML, in which every number is a text."""
    text: str = yaml.safe_dump(
        _plain(mapping), sort_keys=False, default_flow_style=None, allow_unicode=True, width=100
    )
    return text


def _plain(value: object) -> object:
    """The same of texts, lists and mappings alone."""
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    return str(value)
