"""The question as a terminal's answer begins with it: windows, values that are not defaults, and what is counted."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill

from ptmcad.errors import ExpressionError, shown
from ptmcad.mechanism import Model
from ptmcad.question.config.record import Record
from ptmcad.question.slice import Count, Slice, merged
from ptmcad.text.numerals import shortest_text
from ptmcad.text.parsing import rational

MAX_VALUE = 40
"""Characters of a value."""


def question_of(slice: Slice) -> str:
    """The question that a slice is."""
    windows = {axis.name: f"[{shortest_text(axis.low)}, {shortest_text(axis.high)}]" for axis in slice.axes}
    known, shorthands = merged(slice.text, slice.model), slice.model.shorthands
    values = {
        name: slice.text.get(name, text)  # of a shorthand what was written, not its own name
        for name, text in {**slice.text, **known}.items()
        if name in known or name in shorthands
    }
    return _lines(slice.name, windows, values, slice.model, slice.count)


def question_in(record: Record, name: str) -> str:
    """The question of a record of which a family, a sweep or a design is made: values as they are written."""
    windows = {name: f"[{window.low.text}, {window.high.text}]" for name, window in record.axes.items()}
    values = {name: scalar.text for name, scalar in record.values.items()}
    return _lines(name, windows, values, record.model, record.counting)


def _lines(
    name: str, windows: Mapping[str, str], values: Mapping[str, str], model: Model, count: Count | None
) -> str:  # fmt: skip
    fixed = [
        f"{parameter} = {shown(text, MAX_VALUE)}"
        for parameter, text in values.items()
        if parameter not in windows and not _is_default(parameter, text, model)
    ]
    counted = [f"count {count.value}"] if count else []
    parts = (", ".join(_unbroken(part) for part in some) for some in (
        (f"{axis} in {window}" for axis, window in windows.items()), fixed, counted
    ))  # fmt: skip
    text = f"{name}: {'; '.join(part for part in parts if part)}"
    return fill(
        text,
        80,
        initial_indent="question  ",
        subsequent_indent=" " * 10,
        break_long_words=False,
        break_on_hyphens=False,
    ).replace("\N{NO-BREAK SPACE}", " ")


def _unbroken(part: str) -> str:
    """What stands on one line."""
    return part.replace(" ", "\N{NO-BREAK SPACE}")


def _is_default(name: str, text: str, model: Model) -> bool:
    parameter = model.parameters.get(name)
    default = parameter.default if parameter else None
    try:
        return default is not None and (text == default or rational(text) == rational(default))
    except ExpressionError:  # an expression in other parameters
        return False
