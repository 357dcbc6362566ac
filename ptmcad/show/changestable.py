"""The changes of a family as text for the terminal: a line for each, with what is known of its
value.

Guarantee: the digits of an exact value are right; the ends of an enclosure are rounded outwards.
"""

from __future__ import annotations

from ptmcad.answer.changes import Change, Changes
from ptmcad.show.columns import aligned
from ptmcad.text.enclosure import AlgebraicNumber
from ptmcad.text.numerals import decimal, shortest_text

_DIGITS = 10
_OTHERS = 8
"""Values at which nothing changes that are listed; more are counted."""


def changes_table(found: Changes) -> str:
    """Value, how it is known, and what changes, line by line; then what is known of completeness."""
    free = found.free
    title = f"changes of the arrangement for {free.name} between {shortest_text(free.low)} and {shortest_text(free.high)}"
    rows = [(value_text(change), _kind(change), change.words) for change in found.changes]
    width = max((len(value) for value, _, _ in rows), default=0)
    cells = [
        ["", "" if number else value.rjust(width), "" if number else kind, text]
        for value, kind, words in rows
        for number, text in enumerate(words)
    ]
    lines = [f"{title}: {len(rows) or 'none'}", *aligned(cells)]
    for end, words in zip((free.low, free.high), found.at_ends, strict=True):
        if words:
            lines.append(f"  at {free.name} = {shortest_text(end)} itself: {'; '.join(words)}")
    lines.append(found.reason)
    if found.others:
        listed = ", ".join(number.text(6) for number in found.others[:_OTHERS])
        more = f" and {len(found.others) - _OTHERS} more" if len(found.others) > _OTHERS else ""
        lines.append(
            f"where curves meet or turn and the arrangement is the same on both sides: {listed}{more}"
        )
    return "\n".join(lines)


def value_text(change: Change) -> str:
    """The value with ten digits, or the two ends of its enclosure."""
    if isinstance(change.value, AlgebraicNumber):
        return change.value.text()
    low, high = change.value.low, change.value.high
    return f"{decimal(low, up=False, digits=_DIGITS)} to {decimal(high, up=True, digits=_DIGITS)}"


def _kind(change: Change) -> str:
    if not isinstance(change.value, AlgebraicNumber):
        return "enclosed"
    degree = change.value.degree
    return "exact" if degree == 1 else f"exact, of degree {degree}"
