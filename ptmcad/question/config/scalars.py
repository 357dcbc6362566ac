"""Scalars of a record as numbers and expressions; what is wrong with one is a `ConfigError` at its place."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ptmcad.errors import ExpressionError
from ptmcad.text.entry import Entry, Node, Scalar
from ptmcad.text.expressions import Expression
from ptmcad.text.parsing import names_in, parse
from ptmcad.text.syntax import did_you_mean


def number_text(entry: Entry | Node) -> Scalar:
    """A scalar that may hold a number or an expression."""
    scalar = entry.value if isinstance(entry, Entry) else entry
    if not isinstance(scalar, Scalar):
        raise entry.place.error("expected a number or an expression, not a list or a mapping")
    if scalar.is_null:
        raise scalar.place.error("has no value: write a number or an expression, or leave the key out")
    if scalar.is_boolean:
        raise scalar.place.error(f"'{scalar.text}' is a yes-or-no value: write a number or an expression")
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
    try:
        return names_in(scalar.text)
    except ExpressionError as error:
        raise scalar.place.located(error, scalar.text) from error


def parsed(scalar: Scalar, names: Mapping[str, Expression]) -> Expression:
    """The function of the axes that a scalar is, where names are such functions."""
    try:
        return parse(scalar.text, names)
    except ExpressionError as error:
        raise scalar.place.located(error, scalar.text) from error
