"""Largest widths of ranges as parts of JSON documents, which documents of maps do not load.

Guarantee: as of `ptmcad.show.document.numbers`.
"""

from __future__ import annotations

from typing import Any

from ptmcad.answer.intervals import End
from ptmcad.answer.widths import Attainment, Maximum, Place
from ptmcad.show.document.numbers import (
    ALGEBRAIC,
    INTERVAL,
    algebraic_with_decimal,
    itself,
    with_decimal,
)
from ptmcad.text.codec import (
    Codec,
    Key,
    by_name,
    choice,
    converted,
    derived,
    listed,
    optional,
    record,
    record_of,
)
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure


def maximum(over: str, digits: int) -> Codec[Maximum]:
    """The codec of a largest width; attainment is not decided where it is not told, as in older
    documents.

    Parameters
    ----------
    over : the name of the other axis.
    """

    def text(value: End) -> str:
        return AlgebraicNumber.of(value).text(digits)

    def decimal(value: Enclosure) -> str:
        return next((value.text(n) for n in range(digits, 0, -1) if value.settles(n)), "")

    def made(attainment: Attainment, **entries: Any) -> Maximum:
        decided = attainment is not Attainment.UNDECIDED
        return Maximum(
            attained=attainment is not Attainment.APPROACHED if decided else None, **entries
        )

    number: Codec[End] = converted(
        algebraic_with_decimal(text),
        AlgebraicNumber.of,
        lambda n: n if n.exact is None else n.exact,
    )
    enclosed: Codec[Enclosure] = record(
        lambda enclosure: enclosure, decimal=derived(decimal), enclosure=Key(INTERVAL, itself)
    )
    return record_of(
        Maximum, {Enclosure: enclosed}, made, place=choice(Place, by_name), attained=None,
        attainment=Key(choice(Attainment), default=Attainment.UNDECIDED, always=True, checked=True),
        text=derived(lambda found: found.words(over, digits)), critical=optional(ALGEBRAIC),
        ends=optional(listed(with_decimal(text), 2)),
        **{"except": Key(listed(number), default=(), field="exceptions", always=True)},
        undecided=Key(listed(number), default=(), field="doubtful", always=True),
    )  # fmt: skip
