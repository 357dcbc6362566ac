"""Scalars of a record: numbers, expressions, texts, names of files; what is wrong is a
`ConfigError` at its place.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from ptmcad.errors import Faults, Place
from ptmcad.model.reading import text_in
from ptmcad.text.entry import Scalar, Written
from ptmcad.text.expressions import Expression, Expressions
from ptmcad.text.node import Node
from ptmcad.text.parsing import parse
from ptmcad.text.syntax import did_you_mean, names_in

MAX_NAME = 100
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
    name = text_in(entry, MAX_NAME)
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
    name = "".join(c if c.isalnum() or c in "._-" else "-" for c in stem).strip(".-_")[:MAX_NAME]
    return _portable(name, Place("name", file))
