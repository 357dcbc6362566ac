"""Ranges of axes, and the members of a family, as they are written in a record."""

from __future__ import annotations

from typing import NamedTuple

from ptmcad.errors import Place
from ptmcad.model.reading import MAX_NAME
from ptmcad.question.config.scalars import names_in_scalar, number_text
from ptmcad.question.examples import AXES
from ptmcad.text.entry import Scalar, Sequence, Tree, Written
from ptmcad.text.node import Node
from ptmcad.text.syntax import NAME, NOT_NUMBERS

AXIS_NAME = {"pattern": f"^{NAME.pattern}$", "maxLength": MAX_NAME}
MAX_MEMBERS = 400
"""Of a family."""
MAX_VALUES = 10_000
"""Of a record: more than a file may have."""


class Window(NamedTuple):
    """The range of an axis as written."""

    low: Scalar
    high: Scalar
    place: Place


def axes_in(entry: Node) -> dict[str, Window]:
    axes = with_ranges(entry, "two axes with their ranges", AXES)
    if len(axes) != 2:
        entry.note(
            entry.fault(f"{len(axes)} axes are given: a slice has two, the horizontal one first")
        )
    return dict(entry.gathered(lambda axis: (axis.name, _window(axis)), axes.values()))


def free_in(entry: Node) -> tuple[str, Window]:
    """The third parameter of a family with its range."""
    what, like = "one parameter with its range", "{F: [-20, 0]}"
    free = [*with_ranges(entry, what, like).values()]
    if len(free) != 1:
        raise entry.fault(f"expected {what}, such as {like}")
    return free[0].name, _window(free[0])


def with_ranges(entry: Node, what: str, like: str) -> dict[str, Node]:
    """The entries of a mapping of names to ranges; where there are names alone, a fault says that.

    Parameters
    ----------
    what, like : it is, and an example, for messages.
    """
    parts = entry.value.items if isinstance(entry.value, Sequence) else (entry.value,)
    texts = [part.text if isinstance(part, Scalar) and not part.is_null else "" for part in parts]
    names = [name.strip() for text in texts for name in text.split(",")]
    if names and all(map(NAME.fullmatch, names)):
        raise entry.fault(
            f"expected {what}, such as {like}; no range is given for {' and '.join(names)}"
        )
    return entry.mapping(MAX_VALUES, expected=f"expected {what}, such as {like}")


def _window(entry: Node) -> Window:
    check_axis_name(entry.name, entry.place)
    return window_of(entry, "a range", "[0, 2]")


def window_of(entry: Node, what: str, like: str) -> Window:
    """The range that a list of two ends is; what it is, and an example, are for messages."""
    low, high = entry.pair(what, like)
    return Window(number_text(low), number_text(high), entry.place)


def check_members(node: Written) -> Written:
    """The members of a family as written; refuses what can neither be a list of values nor a number
    of members.
    """
    if isinstance(node, Tree):
        raise node.place.error(
            "expected a list of values such as [-20, -10, 0], or how many, such as 9"
        )
    if isinstance(node, Scalar) and (names := names_in_scalar(number_text(node))):
        raise node.place.error(
            f"{names[0][:40]} is neither how many members there are, 2 to {MAX_MEMBERS}, nor a list of values such as "
            "-20,-10,0, nor 'between', which --changes finds"
        )
    return node


def check_axis_name(name: str, place: Place) -> None:
    if not NAME.fullmatch(name) or len(name) > MAX_NAME or name.lower() in NOT_NUMBERS:
        raise place.error(
            f"{name[:40]!r} cannot name an axis: use ASCII letters, digits and '_', starting with a letter"
        )
