"""Where a range is widest, and whether it is attained there, as JSON data and back.

Guarantee: numbers are exact; reading what was written gives an equal `Maximum`, and refuses words and decimals that are
not those of the numbers.
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

    def enclosed(value: Enclosure) -> dict[str, Any]:
        texts = (value.text(n) for n in range(digits, 0, -1) if value.settles(n))
        return {"decimal": next(texts, ""), "enclosure": [text_of(value.low), text_of(value.high)]}

    def number(value: End) -> dict[str, Any]:
        return {"decimal": AlgebraicNumber.of(value).text(digits), **number_data(AlgebraicNumber.of(value))}

    def end(value: End) -> dict[str, Any]:
        if isinstance(value, Fraction):
            return {"window": text_of(value), "decimal": AlgebraicNumber.of(value).text(digits)}
        return number(value)

    return {
        "place": found.place.name.lower(),
        "attainment": found.attainment.value,
        "text": found.words(over, digits),
        "at": enclosed(found.at),
        "width": enclosed(found.width),
        "critical": found.critical and number_data(found.critical),
        "ends": found.ends and [*map(end, found.ends)],
        "except": [*map(number, found.exceptions)],
        "undecided": [*map(number, found.doubtful)],
    }


def maximum_from(data: Mapping[str, Any], over: str, digits: int) -> Maximum:
    """What `maximum_data` wrote; attainment is not decided where it is not told, as in older documents.

    Raises
    ------
    ValueError, KeyError, TypeError, AttributeError
        When the data are not of this kind.
    """

    def end(value: Mapping[str, Any]) -> Any:
        return fraction_of(value["window"]) if "window" in value else number_from(value)

    def number(value: Mapping[str, Any]) -> Any:
        found: Any = number_from(value)
        return found if found.exact is None else found.exact

    at, width = (end(dict(zip(("low", "high"), data[key]["enclosure"], strict=True))) for key in ("at", "width"))
    attainment = data.get("attainment", Attainment.UNDECIDED.value)
    found = Maximum(
        Place[data["place"].upper()],
        at,
        width,
        data["critical"] and end(data["critical"]),
        data["ends"] and tuple(map(end, data["ends"])),
        None if attainment == Attainment.UNDECIDED.value else attainment != Attainment.APPROACHED.value,
        tuple(map(number, data.get("except", ()))),
        tuple(map(number, data.get("undecided", ()))),
    )
    if "attainment" in data and maximum_data(found, over, digits) != data:
        raise ValueError("the words or the decimals of an extreme are not those of its numbers")
    return found
