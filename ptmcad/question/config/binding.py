"""Numbers in place of names in a record: of a family's free parameter, or of what a sweep goes through.

Guarantee: the record that a person would get who typed the numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from ptmcad.errors import ExpressionError
from ptmcad.question.config.record import Record
from ptmcad.text.parsing import rational
from ptmcad.text.syntax import parse
from ptmcad.text.tree import Number, Tree, names_of, replaced, to_text
from ptmcad.text.yamltree import Place, Scalar


def with_numbers(record: Record, numbers: Mapping[str, Fraction], places: Mapping[str, Place]) -> Record:
    """The record with numbers as the values of parameters, and in place of other names in what it writes.

    Parameters
    ----------
    places : where the numbers are said, for messages about parameters.
    """
    known = record.model.parameters
    others = {name: number for name, number in numbers.items() if name not in known}
    values = {name: _with_numbers(scalar, others) for name, scalar in record.values.items()} if others else {}
    fixed = {
        name: Scalar(to_text(Number(number)), places.get(name, Place(name)))
        for name, number in numbers.items()
        if name in known
    }
    return replace(record, values={**record.values, **values, **fixed})


def _with_numbers(scalar: Scalar, numbers: Mapping[str, Fraction]) -> Scalar:
    """A text with numbers in it; what cannot be read or has no value stays as it is, to be refused with its place."""
    try:
        tree = other = parse(scalar.text)
    except ExpressionError:
        return scalar
    for name, number in numbers.items():
        other = replaced(other, name, Number(number))
    return scalar if other is tree else Scalar(_simplest(other), scalar.place)


def _simplest(tree: Tree) -> str:
    """A number as one number, so that slices that are the same say the same; other trees as they are."""
    text = to_text(tree)
    if names_of(tree):
        return text
    try:
        return to_text(Number(rational(text)))
    except ExpressionError:
        return text
