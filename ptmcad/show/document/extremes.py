"""Where a range is widest, and whether it is attained there, as JSON data and back.

Guarantee: numbers are exact; reading what was written gives an equal `Maximum`.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from ptmcad.answer.intervals import End
from ptmcad.answer.widths import Attainment, Maximum, Place
from ptmcad.show.document.changes import number_data, number_from
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.numerals import fraction_of, text_of


def maximum_data(found: Maximum, over: str, digits: int) -> dict[str, Any]:
    """A maximum as JSON data.

    Parameters
    ----------
    over : the name of the other axis.
    """
    return {
        "place": found.place.name.lower(),
        "attainment": found.attainment.value,
        "text": found.words(over, digits),
        "at": _enclosure_data(found.at, digits),
        "width": _enclosure_data(found.width, digits),
        "critical": None if found.critical is None else number_data(found.critical),
        "ends": None if found.ends is None else [_end_data(end, digits) for end in found.ends],
        "except": [_value_data(value, digits) for value in found.exceptions],
        "undecided": [_value_data(value, digits) for value in found.doubtful],
    }


def maximum_from(data: Mapping[str, Any], over: str, digits: int) -> Maximum:
    """What `maximum_data` wrote; attainment is not decided where it is not told, as in older documents.

    Raises
    ------
    ValueError, KeyError, TypeError, AttributeError
        When the data are not of this kind, or words and decimals are not those of the numbers.
    """
    attainment = Attainment(data.get("attainment", Attainment.UNDECIDED.value))
    ends = data["ends"]
    found = Maximum(
        Place[data["place"].upper()],
        _enclosure_from(data["at"]),
        _enclosure_from(data["width"]),
        None if data["critical"] is None else _number_from(data["critical"]),
        None if ends is None else (_end_from(ends[0]), _end_from(ends[1])),
        None if attainment is Attainment.UNDECIDED else attainment is not Attainment.APPROACHED,
        tuple(map(_value_from, data.get("except", ()))),
        tuple(map(_value_from, data.get("undecided", ()))),
    )
    if "attainment" in data and maximum_data(found, over, digits) != data:
        raise ValueError("the words or the decimals of an extreme are not those of its numbers")
    return found


def _enclosure_data(value: Enclosure, digits: int) -> dict[str, Any]:
    settled = next((n for n in range(digits, 0, -1) if value.settles(n)), None)
    return {
        "decimal": "" if settled is None else value.text(settled),
        "enclosure": [text_of(value.low), text_of(value.high)],
    }


def _enclosure_from(data: Mapping[str, Any]) -> Enclosure:
    low, high = map(fraction_of, data["enclosure"])
    if low > high:
        raise ValueError("the ends of an interval are exchanged")
    return Enclosure(low, high)


def _end_data(end: End, digits: int) -> dict[str, Any]:
    if isinstance(end, Fraction):
        return {"window": text_of(end), "decimal": Enclosure(end, end).text(digits)}
    return {"decimal": end.text(digits), **number_data(end)}


def _end_from(data: Mapping[str, Any]) -> End:
    return fraction_of(data["window"]) if "window" in data else _number_from(data)


def _value_data(value: End, digits: int) -> dict[str, Any]:
    """A value of an axis as an algebraic number."""
    if isinstance(value, Fraction):
        value = AlgebraicNumber((-value.numerator, value.denominator), value, value)
    return _end_data(value, digits)


def _value_from(data: Mapping[str, Any]) -> End:
    found = _number_from(data)
    return found if found.exact is None else found.exact


def _number_from(data: Mapping[str, Any]) -> AlgebraicNumber:
    found = number_from(data)
    if not isinstance(found, AlgebraicNumber):
        raise TypeError("expected an algebraic number")
    return found
