"""The best design as a JSON document, docs/design.schema.json, and back; with largest widths of ranges,
which documents of ranges have too.

Guarantee: numbers are exact; reading what was written gives an equal `BestDesign`.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from ptmcad.answer.design import BestDesign
from ptmcad.answer.intervals import End
from ptmcad.answer.widths import Attainment, Maximum, Place
from ptmcad.model import Model, built_in, known_of
from ptmcad.question.slice import Axis
from ptmcad.show.document.exactnumbers import (
    ALGEBRAIC,
    AXIS,
    INTERVAL,
    LINE,
    algebraic_with_decimal,
    itself,
    with_decimal,
)
from ptmcad.show.document.slicedocument import VERSIONS, model_from, stored_model
from ptmcad.text.codec import (
    WHOLE,
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
from ptmcad.text.documents import document_text
from ptmcad.text.enclosure import AlgebraicNumber, Enclosure
from ptmcad.text.node import Node, opened

FORMAT = "ptmcad-design/1"
MAX_DOCUMENT = 60_000_000
DIGITS = 10


def write_design(found: BestDesign) -> str:
    """The document as JSON text: an entry a line, and of designs and boxes one each."""
    return document_text(FORMAT, design_codec(found.over[0].name).write(found))


def read_design(text: str) -> BestDesign:
    """What `write_design` wrote.

    Raises
    ------
    ValueError
        When the text is not such a document, or contradicts itself.
    """
    document = opened(text, FORMAT, MAX_DOCUMENT, "ptmcad design")
    over = document.entry("over").each(AXIS.read)
    if not over:
        raise document.entry("over").fault("has no design parameter")
    return design_codec(over[0].name).read(document)


def design_codec(over: str) -> Codec[BestDesign]:
    """The codec of a design whose first parameter has this name."""
    return record_of(
        BestDesign, {Model: _MODEL, Axis: AXIS, Enclosure: INTERVAL, str: LINE}, _made,
        window=Key(listed(AXIS).narrowed(maxItems=2), field="fixed"),
        over=listed(AXIS).narrowed(minItems=1, maxItems=8), stable=Key(WHOLE, field="working"), seed=WHOLE,
        extremes=Key(extremes_codec(over), default=(), field="maxima", always=True), versions=VERSIONS,
    )  # fmt: skip


def extremes_codec(over: str) -> Codec[tuple[Maximum, ...]]:
    """The codec of where ranges over a parameter are longest."""
    return listed(maximum(over, DIGITS))


def _made(**entries: Any) -> BestDesign:
    """Refuse what contradicts itself."""
    found = BestDesign(**entries)
    names = [axis.name for axis in found.over]
    if (found.best is None) != (found.value is None) or (
        found.best is not None and list(found.best) != names
    ):
        raise ValueError("the best design is not one of the parameters that it is over")
    if found.best is not None:
        if not all(axis.low <= found.best[axis.name] <= axis.high for axis in found.over):
            raise ValueError("the best design is not within the bounds")
        if tuple(found.best.values()) not in {point.at for point in found.points}:
            raise ValueError("the best design is not among those that were evaluated")
    low = Fraction(0) if found.value is None else found.value.low
    claimed = (
        found.bound is not None
        and found.value is not None
        and found.bound <= (1 + found.tolerance) * low
    )
    if found.proved != claimed:
        raise ValueError("what is said to be proved does not follow from the bound")
    if (
        found.boxes
        and found.bound is not None
        and max(box.bound for box in found.boxes) > found.bound
    ):
        raise ValueError("a box has a larger bound than all of them")
    if any(len(box.ranges) != len(names) for box in found.boxes):
        raise ValueError("a box has not as many ranges as there are parameters")
    return found


def _model(model: Model) -> Any:
    """The name where that says all, else the description."""
    stored = stored_model(model)
    return stored if isinstance(stored, str) else {model.record_key: stored}


def _model_of(node: Node) -> Model:
    if not isinstance(node.value, str):
        kind = "system" if "system" in node.mapping() else "mechanism"
        place = node.record((kind,), (kind,))[kind]
        return place.made(model_from, kind, place.data())
    if node.value not in built_in():
        raise node.fault(f"is {node.value[:40]!r}, no mechanism that is known by its name")
    return known_of(node.value)


_MODEL: Codec[Model] = Codec(
    _model,
    _model_of,
    {"anyOf": [{"type": "string"}, {"type": "object", "minProperties": 1, "maxProperties": 1}]},
)


def maximum(over: str, digits: int) -> Codec[Maximum]:
    """The codec of a largest width; attainment is not decided where it is not stored, as in older
    documents.

    Parameters
    ----------
    over : the name of the other axis.
    """

    def text(value: End) -> str:
        return AlgebraicNumber.of(value).text(digits)

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
        lambda enclosure: enclosure,
        decimal=derived(lambda enclosure: enclosure.settled_text(digits) or ""),
        enclosure=Key(INTERVAL, itself),
    )
    return record_of(
        Maximum, {Enclosure: enclosed}, made, place=choice(Place, by_name), attained=None,
        attainment=Key(choice(Attainment), default=Attainment.UNDECIDED, always=True, checked=True),
        text=derived(lambda found: found.words(over, digits)), critical=optional(ALGEBRAIC),
        ends=optional(listed(with_decimal(text), 2)),
        **{"except": Key(listed(number), default=(), field="exceptions", always=True)},
        undecided=Key(listed(number), default=(), field="doubtful", always=True),
    )  # fmt: skip
