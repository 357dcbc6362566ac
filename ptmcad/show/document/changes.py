"""The changes of a family as a part of its JSON document.

Guarantee: numbers are exact; `changes_from` gives what was written, and refuses what contradicts itself.
"""

from __future__ import annotations

from typing import Any

from ptmcad.answer.arrangement import SIDES, Arrangement
from ptmcad.answer.changes import TOLERANCE, Change, Changes
from ptmcad.question.slice import Axis
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.numerals import fraction_of, integer_of, integer_text, text_of


def written_changes(found: Changes) -> dict[str, Any]:
    """As objects and lists of texts and small integers."""
    return {
        "complete": found.complete,
        "reason": found.reason,
        "tolerance": text_of(found.tolerance),
        "found": [{"value": number_data(change.value), "words": list(change.words)} for change in found.changes],
        "between": [
            {"value": text_of(value), "arrangement": _written_arrangement(arrangement)}
            for value, arrangement in zip(found.between, found.arrangements, strict=True)
        ],
        "others": [number_data(number) for number in found.others],
        "at_ends": [list(words) for words in found.at_ends],
    }


def changes_from(data: Any, free: Axis) -> Changes:
    """What `written_changes` gave.

    Parameters
    ----------
    free : the free parameter of the document.

    Raises
    ------
    ValueError, KeyError, TypeError, AttributeError
        When the data are not of this kind.
    """
    found = tuple(Change(number_from(change["value"]), _words(change["words"])) for change in data["found"])
    others = tuple(number_from(number) for number in data["others"])
    low, high = data["at_ends"]
    if not isinstance(data["complete"], bool):
        raise ValueError("complete is neither true nor false")
    exact = [number for number in others if isinstance(number, AlgebraicNumber)]
    if len(exact) != len(others) or (data["complete"] and not all(change.is_exact for change in found)):
        raise ValueError("a value that is not exact stands where one has to be")
    between = tuple(fraction_of(part["value"]) for part in data["between"])
    ends = [free.low, *(end for change in found for end in (change.value.low, change.value.high)), free.high]
    if len(between) != len(found) + 1 or any(
        not low <= value <= high for low, value, high in zip(ends[::2], between, ends[1::2], strict=True)
    ):
        raise ValueError("the values between the changes do not lie between them")
    return Changes(
        free,
        found,
        between,
        tuple(_arrangement(part["arrangement"]) for part in data["between"]),
        tuple(exact),
        (_words(low), _words(high)),
        data["complete"],
        str(data["reason"]),
        fraction_of(data["tolerance"]) if "tolerance" in data else TOLERANCE,
    )


def number_data(value: AlgebraicNumber | Enclosure) -> dict[str, Any]:
    """A number for JSON: what `number_from` reads."""
    ends = {"low": text_of(value.low), "high": text_of(value.high)}
    if isinstance(value, AlgebraicNumber):
        return {"polynomial": [integer_text(c) for c in value.polynomial], **ends}
    return ends


def number_from(data: Any) -> AlgebraicNumber | Enclosure:
    """An algebraic number, or an enclosure where there is no polynomial.

    Raises
    ------
    ValueError, KeyError, TypeError, AttributeError
        When the data are not of this kind.
    """
    low, high = fraction_of(data["low"]), fraction_of(data["high"])
    if low > high:
        raise ValueError("the ends of an interval are exchanged")
    if "polynomial" not in data:
        return Enclosure(low, high)
    polynomial = tuple(map(_integer, data["polynomial"]))
    if len(polynomial) < 2 or polynomial[-1] <= 0:
        raise ValueError("a number's polynomial has no degree")
    return AlgebraicNumber(polynomial, low, high)


def _integer(text: Any) -> int:
    digits = text.removeprefix("-")
    if not (digits.isascii() and digits.isdecimal()):
        raise ValueError("a coefficient is no integer")
    return -integer_of(digits) if text.startswith("-") else integer_of(digits)


def _written_arrangement(arrangement: Arrangement) -> dict[str, Any]:
    return {
        "counts": [list(key) for key in arrangement.keys],
        "neighbours": [list(pair) for pair in sorted(arrangement.neighbours)],
        "sides": {name: list(side) for name, side in zip(SIDES, arrangement.sides, strict=True)},
    }


def _arrangement(data: Any) -> Arrangement:
    keys = tuple(tuple(int(n) for n in key) for key in data["counts"])
    pairs = frozenset((int(a), int(b)) for a, b in data["neighbours"])
    sides = tuple(tuple(int(n) for n in data["sides"][name]) for name in SIDES)
    named = {n for group in (*pairs, *sides) for n in group}
    if any(not 0 <= n < len(keys) for n in named) or any(a >= b for a, b in pairs):
        raise ValueError("an arrangement names a region that there is not")
    if len(pairs) < len(data["neighbours"]):
        raise ValueError("an arrangement names two neighbours twice")
    return Arrangement(keys, pairs, sides)


def _words(data: Any) -> tuple[str, ...]:
    if not isinstance(data, list) or not all(isinstance(text, str) and text.isprintable() for text in data):
        raise ValueError("expected a list of sentences")
    return tuple(data)
