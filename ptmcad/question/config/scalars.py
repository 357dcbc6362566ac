"""Scalars of a record: numbers, expressions, texts, names of files; and ranges of axes and members of
a family, as they are written. What is wrong is a `ConfigError` at its place.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from ptmcad.errors import Faults, Place
from ptmcad.model.reading import MAX_NAME, text_in
from ptmcad.question.shipped import AXES
from ptmcad.text.entry import Scalar, Sequence, Tree, Written
from ptmcad.text.expressions import Expression, Expressions
from ptmcad.text.node import Node
from ptmcad.text.parsing import parse
from ptmcad.text.syntax import NAME, NOT_NUMBERS, did_you_mean, names_in

MAX_FILE_NAME = 100
_PORTS = tuple(f"{port}{digit}" for port in ("COM", "LPT") for digit in "0123456789¹²³")
_DEVICES = frozenset(("CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$", *_PORTS))
"""Windows takes a file of such a name, in any case and with any suffix, for a device."""


def number_text(entry: Node | Written) -> Scalar:
    """A scalar that may hold a number or an expression."""
    scalar = entry.value if isinstance(entry, Node) else entry
    if not isinstance(scalar, Scalar):
        raise entry.place.error("expected a number or an expression, not a list or a mapping")
    if scalar.is_null:
        raise scalar.place.error(
            "has no value: write a number or an expression, or leave the key out"
        )
    if scalar.is_boolean:
        raise scalar.place.error(
            f"'{scalar.text}' is a yes-or-no value: write a number or an expression"
        )
    return scalar


def number_of(scalar: Scalar, what: str = "the end of a range") -> Fraction:
    """The number that a scalar is."""
    names = names_in_scalar(scalar)
    if names and names[0].lower() not in ("nan", "inf", "infinity"):
        hint = did_you_mean(names[0], ())
        raise scalar.place.error(f"{what} is a number, not an expression in {names[0][:40]}{hint}")
    return parsed(scalar, {}).constant()


def names_in_scalar(scalar: Scalar) -> tuple[str, ...]:
    """The names in a scalar's text."""
    return scalar.place.read(scalar.text, names_in)


def parsed(scalar: Scalar, names: Expressions) -> Expression:
    """The function of the axes that a scalar is, where names are such functions."""
    return scalar.place.read(scalar.text, lambda text: parse(text, names))


# ------------------------------------------------------------------------------------------- texts and names of files


def file_name(name: str, option: str) -> str:
    """A name for files that an option gives.

    Raises
    ------
    ConfigError
        When it is not safe as the start of a file's name.
    """
    place = Place(option)
    return name_in(Node(Scalar(name, place), place, Faults()))


def name_in(entry: Node) -> str:
    """A name that is safe as the start of a file's name."""
    name = text_in(entry, MAX_FILE_NAME)
    if (
        not name
        or not name[0].isalnum()
        or not all(c.isalnum() or c in "._-" for c in name)
        or name.endswith(".")
    ):
        raise entry.fault(
            f"{name!r} cannot name a file: use letters, digits, '.', '_' and '-', starting with a letter or digit"
        )
    return _portable(name, entry.place)


def portable_file(file: str, option: str) -> str:
    """The name of a file that an option gives, with its suffix: any that no system gives another
    meaning.

    Raises
    ------
    ConfigError
        When Windows keeps the name for a device, or would drop its end.
    """
    if file.endswith((".", " ")):
        raise Place(option).error(
            f"{file!r} cannot name a file: Windows drops dots and spaces at the end"
        )
    return _portable(file, Place(option))


def _portable(name: str, place: Place) -> str:
    device = name.partition(".")[0].rstrip(" ").upper()
    if device in _DEVICES:
        raise place.error(
            f"{name!r} cannot name a file: Windows keeps {device} for a device, whatever the suffix"
        )
    return name


def name_of_file(file: str | None) -> str:
    """The file's stem, with characters that `name_in` refuses replaced; empty when there is no
    file.

    Raises
    ------
    ConfigError
        When Windows keeps the name for a device.
    """
    stem = Path(file).stem if file else ""
    name = "".join(c if c.isalnum() or c in "._-" else "-" for c in stem).strip(".-_")[
        :MAX_FILE_NAME
    ]
    return _portable(name, Place("name", file))


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
