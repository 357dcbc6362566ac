"""The question as a terminal's answer begins with it: windows, values that are not defaults, and
what is counted.
"""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill

from ptmcad.errors import shown
from ptmcad.model import Model
from ptmcad.question.config.record import Record
from ptmcad.question.slice import Slice, merged
from ptmcad.text.numerals import shortest_text

MAX_VALUE = 40
"""Characters of a value."""


def question_of(slice: Slice) -> str:
    """The question that a slice is."""
    known, written = merged(slice.text, slice.model), slice.text
    # of a shorthand that a text names what was written, not its own name
    values = {
        n: written.get(n, known.get(n, ""))
        for n in (*written, *known)
        if n in known or n in slice.model.shorthands
    }
    windows = {
        axis.name: f"{shortest_text(axis.low)}, {shortest_text(axis.high)}" for axis in slice.axes
    }
    return _lines(slice.name, windows, values, slice.model, f"; count {slice.count.value}")


def question_in(record: Record, name: str) -> str:
    """The question of a record of which a family, a sweep or a design is made: values as they are
    written.
    """
    values = {name: scalar.text for name, scalar in record.values.items()}
    windows = {
        name: f"{window.low.text}, {window.high.text}" for name, window in record.axes.items()
    }
    return _lines(
        name,
        windows,
        values,
        record.model,
        f"; count {record.counting.value}" if record.counting else "",
    )


def _lines(
    name: str, windows: Mapping[str, str], values: Mapping[str, str], model: Model, counted: str
) -> str:
    defaults = {name: parameter.default for name, parameter in model.parameters.items()}
    fixed = [
        f"{n} = {shown(v, MAX_VALUE)}"
        for n, v in values.items()
        if n not in windows and v != defaults.get(n)
    ]
    axes = ", ".join(f"{axis} in [{window}]" for axis, window in windows.items())
    text = f"{name}: {axes}{'; ' * bool(fixed)}{', '.join(fixed)}{counted}"
    for inside in (" = ", " in [", "count "):  # a line does not end there
        text = text.replace(inside, inside.replace(" ", "\N{NO-BREAK SPACE}"))
    lines = fill(
        text, 80, initial_indent="question  ", subsequent_indent=" " * 10, break_long_words=False
    )
    return lines.replace("\N{NO-BREAK SPACE}", " ")
